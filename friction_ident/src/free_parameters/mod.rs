//! Which numbers of a model are estimated, and the coordinates in which a search moves them.
//!
//! A search wants a box; the parameters of a model have conditions between them. So the search
//! moves coordinates: the static friction as its excess over the kinetic one, a break-away
//! deflection `z_ba` as its share of `f_c / sigma0`, the last share of elements as what the others
//! leave. The estimates are turned back into parameters, with their covariance.

mod numbers;

use friction_model::{AnyModel, AnyParameters, ModelName, Parameter, Range, Real, Unit, VisitorIn};
use nalgebra::DMatrix;

use crate::bounded::{Bound, Minimum};
use crate::estimate::Unknown;
use crate::finite::finite;
use crate::parameter_id::{ParameterId, Side};

/// How a coordinate becomes the number.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Coordinate {
    /// It is the number.
    Itself,
    /// Its logarithm: stiffnesses, dampings, times and speeds may be wrong by decades at first.
    Logarithm,
    /// What `f_s` has above `f_c`.
    Excess,
    /// `z_ba` as a share of `f_c / sigma0`.
    ShareOfDeflection,
}

/// The numbers that are estimated, of a model whose other numbers stay.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeParameters {
    template: AnyParameters,
    ids: Vec<ParameterId>,
    coordinates: Vec<Coordinate>,
}

/// How far the logarithm of a number may be from the template's: a factor of a thousand.
const DECADES: f64 = 3.0 * std::f64::consts::LN_10;
/// The same for the stiffnesses of elements, a factor of thirty: an element so soft that it never
/// slips is no element.
const ELEMENT_DECADES: f64 = 1.5 * std::f64::consts::LN_10;

/// Names of the lists whose elements sum to one.
const SHARES: [&str; 2] = ["alpha", "lambda"];

impl FreeParameters {
    /// The numbers of `template` whose parameter `wanted` accepts. Shares of elements are free but
    /// for the last, which is what the others leave.
    pub fn new(template: &AnyModel, wanted: impl Fn(&Parameter) -> bool) -> Self {
        let parameters = template.parameters();
        let sides = Side::of(matches!(parameters, AnyParameters::Asymmetric(_)));
        let mut free = Self { template: parameters, ids: Vec::new(), coordinates: Vec::new() };
        for &side in sides {
            for row in parameters.table().iter().filter(|row| wanted(row)) {
                let count = free.read_all(row.name, side).len();
                let list = is_list(parameters.name(), row.name);
                let last = if list && SHARES.contains(&row.name) {
                    count.saturating_sub(1)
                } else {
                    count
                };
                for element in 0..last {
                    let id = ParameterId::new(row.name).side(side);
                    free.ids.push(if list { id.element(element) } else { id });
                    free.coordinates.push(free.coordinate(row.name));
                }
            }
        }
        free
    }

    /// Everything but shape exponents and what a file may leave out without harm: forces,
    /// stiffnesses, dampings, speeds, times, and the shares of elements.
    pub fn usual(template: &AnyModel) -> Self {
        Self::new(template, |row| row.unit != Unit::None || SHARES.contains(&row.name))
    }

    /// The numbers that are free, in order.
    pub fn ids(&self) -> &[ParameterId] {
        &self.ids
    }

    /// The model these are numbers of.
    pub fn name(&self) -> ModelName {
        self.template.name()
    }

    /// The template's own values of the free numbers.
    pub fn values(&self) -> Vec<f64> {
        self.ids.iter().map(|id| self.read(id)).collect()
    }

    /// The coordinates of the template's own values.
    pub fn start(&self) -> Vec<f64> {
        let inverse = |(id, coordinate): (&ParameterId, &Coordinate)| match coordinate {
            Coordinate::Itself => self.read(id),
            Coordinate::Logarithm => self.read(id).ln(),
            Coordinate::Excess => self.read(id) - self.companion("f_c", id.side),
            Coordinate::ShareOfDeflection => {
                self.read(id) * self.companion("sigma0", id.side) / self.companion("f_c", id.side)
            }
        };
        self.ids.iter().zip(&self.coordinates).map(inverse).collect()
    }

    /// Where each coordinate may lie: its parameter's own range, for positive numbers within a
    /// factor of a thousand to a million of the template's.
    pub fn bounds(&self) -> Vec<Bound> {
        let table = self.template.table();
        let bound = |(id, coordinate): (&ParameterId, &Coordinate)| {
            let size = self.read(id).abs().max(f64::MIN_POSITIVE);
            let range =
                table.iter().find(|row| row.name == id.name).map_or(Range::Any, |row| row.range);
            match (coordinate, range) {
                (Coordinate::Logarithm, _) => {
                    let middle = size.ln();
                    let stiffness =
                        table.iter().any(|row| row.name == id.name && row.unit == Unit::Stiffness);
                    let reach =
                        if id.element.is_some() && stiffness { ELEMENT_DECADES } else { DECADES };
                    Bound::within(middle - reach, middle + reach, 0.1).reaching(1.0)
                }
                (Coordinate::ShareOfDeflection, _) => Bound::within(1e-3, 0.999, 1.0),
                (Coordinate::Excess, _) => Bound::within(0.0, 1e6 * size, 0.1 * size),
                (_, Range::Positive) if SHARES.contains(&id.name) => Bound::within(1e-6, 1.0, 0.1),
                (_, Range::Positive) => Bound::within(1e-6 * size, 1e6 * size, size),
                (_, Range::NonNegative) => Bound::within(0.0, 1e6 * size.max(1e-6), size.max(1e-6)),
                (_, Range::Within(low, high)) | (_, Range::FromTo(low, high)) => {
                    Bound::within(low.max(1e-9), high, size)
                }
                _ => Bound::free(size),
            }
        };
        self.ids.iter().zip(&self.coordinates).map(bound).collect()
    }

    /// The model at these coordinates; none where it does not accept them.
    pub fn model(&self, coordinates: &[f64]) -> Option<AnyModel> {
        let (mut forward, mut backward) = self.template.sides();
        for moved in self.numbers(coordinates).moved {
            let parameters =
                if moved.side == Side::Backward { &mut backward } else { &mut forward };
            parameters.set_at(moved.name, moved.index, moved.value);
        }
        self.template.with_sides(forward, backward).ok()
    }

    /// Does something with the model at these coordinates in numbers of another kind; none where
    /// the model does not accept them.
    pub(crate) fn visit_in<T: Real, V: VisitorIn<T>>(
        &self,
        coordinates: &[T],
        visitor: V,
    ) -> Option<V::Output> {
        let numbers = self.numbers(coordinates);
        let number = &mut |backward, name, index, value| {
            numbers
                .moved
                .iter()
                .rev()
                .find(|moved| {
                    (moved.side == Side::Backward) == backward
                        && (moved.name, moved.index) == (name, index)
                })
                .map_or(T::of(value), |moved| moved.value)
        };
        self.template.visit_in(number, visitor)
    }

    /// Whether every free number may be differentiated by: models treat whole numbers among shape
    /// exponents apart from others.
    pub(crate) fn are_smooth(&self) -> bool {
        let table = self.template.table();
        self.ids.iter().all(|id| {
            let shape = |row: &Parameter| row.name == id.name && row.unit == Unit::None;
            SHARES.contains(&id.name) || !table.iter().any(shape)
        })
    }

    /// The minimum in terms of parameters instead of coordinates: values, and derivatives by the
    /// chain rule. Unknowns beyond its own coordinates stay as they are. None where the model does
    /// not accept the coordinates.
    pub fn in_parameters(&self, mut minimum: Minimum) -> Option<Minimum> {
        let at = |coordinates: &[f64]| {
            Some(Self { template: self.model(coordinates)?.parameters(), ..self.clone() }.values())
        };
        let n = minimum.x.len();
        let (own, beyond) = minimum.x.split_at_checked(self.ids.len())?;
        let (own, beyond) = (own.to_vec(), beyond.to_vec());
        let values = at(&own)?;
        let mut inverse = DMatrix::identity(n, n);
        for (j, bound) in self.bounds().iter().enumerate() {
            if self.coordinates[j] == Coordinate::Itself && !self.others_refer_to(j) {
                continue;
            }
            let h = 1e-6 * own[j].abs().max(bound.scale);
            let mut moved = own.clone();
            moved[j] += if moved[j] + h <= bound.high { h } else { -h };
            let there = at(&moved)?;
            for (i, (a, b)) in there.iter().zip(&values).enumerate() {
                inverse[(i, j)] = (a - b) / (moved[j] - own[j]);
            }
        }
        minimum.jacobian *= finite(inverse)?.try_inverse().and_then(finite)?;
        minimum.x = [values, beyond].concat();
        Some(minimum)
    }

    /// Names, units and what to measure where a number stays unknown; `rotary` decides the units.
    pub fn unknowns(&self, rotary: bool) -> Vec<Unknown> {
        let unit = |name: &str| {
            let unit = self
                .template
                .table()
                .iter()
                .find(|row| row.name == name)
                .map_or(Unit::None, |row| row.unit);
            if rotary { unit.rotary() } else { unit.linear() }
        };
        self.ids
            .iter()
            .map(|id| Unknown { id: *id, unit: unit(id.name), remedy: remedy(id.name) })
            .collect()
    }

    fn coordinate(&self, name: &str) -> Coordinate {
        let has = |other: &str| !self.template.values(other).is_empty();
        let row = self.template.table().iter().find(|row| row.name == name);
        let decades = row.is_some_and(|row| {
            row.range == Range::Positive && !matches!(row.unit, Unit::Force | Unit::None)
        });
        match name {
            "f_s" if has("f_c") => Coordinate::Excess,
            "z_ba" if has("f_c") && has("sigma0") => Coordinate::ShareOfDeflection,
            _ if decades => Coordinate::Logarithm,
            _ => Coordinate::Itself,
        }
    }

    fn others_refer_to(&self, j: usize) -> bool {
        let ParameterId { name, side, .. } = self.ids[j];
        let refers = |i: usize| {
            matches!(self.coordinates[i], Coordinate::Excess | Coordinate::ShareOfDeflection)
                && self.ids[i].side == side
        };
        (name == "f_c" || name == "sigma0") && (0..self.ids.len()).any(refers)
    }

    fn is_free(&self, name: &str, side: Side) -> bool {
        self.ids.iter().any(|id| id.name == name && id.side == side)
    }

    fn read(&self, id: &ParameterId) -> f64 {
        self.read_all(id.name, id.side).get(id.index()).copied().unwrap_or(f64::NAN)
    }

    fn read_all(&self, name: &str, side: Side) -> Vec<f64> {
        let (forward, backward) = self.template.sides();
        if side == Side::Backward { backward.values(name) } else { forward.values(name) }
    }

    fn companion(&self, name: &str, side: Side) -> f64 {
        self.read_all(name, side).first().copied().unwrap_or(f64::NAN)
    }
}

/// Whether the parameter is a list: GMS and Xiong have lists, and there a name stands for one
/// number an element.
fn is_list(model: ModelName, name: &str) -> bool {
    !AnyParameters::test_bed(model).clone().set(name, 1.0)
}

/// What to measure where a parameter stays unknown.
pub fn remedy(name: &str) -> &'static str {
    match name {
        "f_s" | "v_s" => "more and slower constant velocities below the dip, averaged longer",
        "f_c" => "constant velocities above the dip, in both directions",
        "f_v" => {
            "faster constant velocities: the viscous part must stand out from the Coulomb level"
        }
        "delta" => "constant velocities spaced closely through the dip",
        "sigma0" | "z_b" | "k" | "alpha" | "lambda" | "z_ba" => {
            "pre-sliding: slow torque ramps to breakaway and nested reversals below it, with a finer encoder or averaging"
        }
        "sigma" | "sigma1" => {
            "fast small motions below breakaway; or compute it from the damping ratio with the inertia"
        }
        "tau" | "c" => {
            "velocity that varies quickly without reversing (experiment 2), with a torque sensor of low noise"
        }
        _ => "a recording in which this effect changes the friction by more than the noise",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;

    const MODELS: [ModelName; 8] = [
        ModelName::LuGre,
        ModelName::Proposed,
        ModelName::Gms,
        ModelName::Xiong,
        ModelName::Dahl,
        ModelName::ElastoPlastic,
        ModelName::Stribeck,
        ModelName::CoulombViscous,
    ];

    #[test]
    fn the_start_is_the_template_in_every_model_and_both_directions() {
        for name in MODELS {
            let model = AnyModel::test_bed(name);
            let other = model.scaled("f_v", 1.3).unwrap();
            for template in [model, AnyModel::asymmetric(&model, &other).unwrap()] {
                let free = FreeParameters::usual(&template);
                let back = free.model(&free.start()).unwrap();
                let again = FreeParameters::usual(&back);
                assert_eq!(free.ids(), again.ids());
                for (a, b) in free.values().iter().zip(again.values()) {
                    assert!((a - b).abs() <= 1e-12 * a.abs(), "{name}: {a} {b}");
                }
                for (value, bound) in free.start().iter().zip(free.bounds()) {
                    assert!((bound.low..=bound.high).contains(value), "{name}: {value} {bound:?}");
                }
            }
        }
    }

    #[test]
    fn labels_name_element_and_direction() {
        let gms = AnyModel::test_bed(ModelName::Gms);
        let free = FreeParameters::usual(&AnyModel::asymmetric(&gms, &gms).unwrap());
        let labels: Vec<_> = free.ids().iter().map(ToString::to_string).collect();
        assert!(
            labels.contains(&"sigma0[3].backward".to_owned())
                && labels.contains(&"f_s.forward".to_owned())
        );
        assert!(
            !labels.contains(&"alpha[3].forward".to_owned()),
            "the last share is what the others leave"
        );
    }

    /// Derivatives with respect to (f_s, f_c) from those with respect to (f_s - f_c, f_c): at
    /// constant f_s, more f_c is less excess.
    #[test]
    fn derivatives_are_turned_back_into_parameters() {
        let free = FreeParameters::new(&AnyModel::test_bed(ModelName::Stribeck), |row| {
            ["f_s", "f_c"].contains(&row.name)
        });
        let minimum = Minimum {
            x: free.start(),
            residuals: DVector::zeros(1),
            jacobian: DMatrix::from_row_slice(1, 2, &[3.0, 5.0]),
            held: vec![false; 2],
            sum: 0.0,
            evaluations: 0,
            ending: crate::bounded::Ending::Converged,
        };
        let turned = free.in_parameters(minimum).unwrap();
        assert!(
            (turned.jacobian[(0, 0)] - 3.0).abs() < 1e-8
                && (turned.jacobian[(0, 1)] - 2.0).abs() < 1e-8
        );
        assert_eq!(turned.x, free.values());
    }
}
