//! The columns of the regression, filtered, thinned and advanced by the delay.
//!
//! A delayed force `F(t) = f(t + delay)` is met by reading the model's columns later, not by moving
//! the force: the force stays as measured, and relative errors keep one denominator. The columns
//! are read after their anti-alias low-pass, which makes interpolation between samples exact to far
//! below the noise, and lets a new delay cost no filtering.

use nalgebra::{DMatrix, DVector};

use super::AxisStructure;
use super::friction_curve::{FrictionCurve, Levels};
use super::shape::{LONGEST_DELAY, PositionScale, Shape, ShapeTerm};
use super::waves::Place;
use crate::IdentError;
use crate::conditioning::{Conditioned, Piece};
use crate::zero_phase::{LANES, LowPass};

/// Where the low-pass of the thinning ends, as a share of the rate of the rows.
const PASS: f64 = 0.4;

/// The columns that a nonlinear parameter changes, with the values they were made for.
#[derive(Debug, Clone, Default)]
struct Group {
    made_for: Option<[f64; 2]>,
    columns: Vec<Vec<f64>>,
}

/// Regressors of one structure along one recording.
pub(super) struct Regressors<'a> {
    recording: &'a Conditioned,
    structure: AxisStructure,
    /// Position from -1 to 1 over the estimation recording, where the structure needs it.
    place: Vec<f64>,
    filter: Option<LowPass>,
    /// Inertia, viscous friction, offset, force along the axis, gravity.
    fixed: Vec<Vec<f64>>,
    friction: Group,
    /// Columns of friction for shapes that are likely to be asked for.
    prepared: Vec<Group>,
    /// What the friction columns were made of, where that is known.
    curve: Option<FrictionCurve>,
    harmonic: Group,
    /// Measured force on the kept rows.
    pub force: DVector<f64>,
}

impl<'a> Regressors<'a> {
    pub fn new(
        recording: &'a Conditioned,
        structure: AxisStructure,
        scale: PositionScale,
    ) -> Result<Self, IdentError> {
        let factor = recording.decimate;
        let filter = match factor {
            1 => None,
            _ => Some(LowPass::chebyshev(8, 0.05, PASS / factor as f64, 1.0)?),
        };
        if recording.force.iter().all(|&force| force == 0.0) {
            return Err(IdentError::ZeroForce);
        }
        if structure.needs_position() && recording.position.is_none() {
            return Err(IdentError::NoPosition { structure });
        }
        let rows: usize = recording.pieces.iter().map(|piece| rows_of(piece, factor)).sum();
        let needed = 4 * structure.parameters();
        if rows < needed {
            return Err(IdentError::TooFewSamples {
                what: "the regression, after trimming and decimation,",
                needed,
                found: rows,
                lower: Some("the trim or the decimation"),
            });
        }
        let position = recording.position.as_deref().filter(|_| structure.position);
        let place = position.unwrap_or_default().iter().map(|&x| scale.normalised(x)).collect();
        let mut made = Self {
            recording,
            structure,
            place,
            filter,
            fixed: Vec::new(),
            friction: Group::default(),
            prepared: Vec::new(),
            curve: None,
            harmonic: Group::default(),
            force: DVector::zeros(0),
        };
        let mut columns = made.fixed_columns();
        columns.push(recording.force.clone());
        made.fixed = made.smoothed(columns)?;
        let force = made.fixed.pop().unwrap_or_default();
        made.force = DVector::from_vec(made.read(&force, 0.0));
        Ok(made)
    }

    pub fn rows(&self) -> usize {
        self.force.len()
    }

    /// Rows of each stretch.
    pub fn pieces(&self) -> Vec<usize> {
        let factor = self.recording.decimate;
        self.recording.pieces.iter().map(|piece| rows_of(piece, factor)).collect()
    }

    /// One row a kept sample, one column a linear parameter.
    pub fn matrix(&mut self, shape: &Shape) -> Result<DMatrix<f64>, IdentError> {
        self.update_friction(shape)?;
        self.update_harmonic(shape)?;
        let delay = self.advance(shape);
        let columns = self.fixed.iter().chain(&self.friction.columns).chain(&self.harmonic.columns);
        let columns: Vec<&Vec<f64>> = columns.collect();
        let mut matrix = DMatrix::zeros(self.rows(), columns.len());
        for (mut to, from) in matrix.column_iter_mut().zip(columns) {
            to.copy_from_slice(&self.read(from, delay));
        }
        Ok(matrix)
    }

    /// Derivatives of the predicted force with respect to nonlinear parameters, the linear ones kept;
    /// for that of the delay between two delays \[s\].
    pub fn slopes(
        &mut self,
        terms: &[ShapeTerm],
        shape: &Shape,
        delays: [f64; 2],
        linear: &DVector<f64>,
    ) -> Result<Vec<DVector<f64>>, IdentError> {
        // That of the delay is made of smooth columns, the others become smooth together.
        let smooth = terms.iter().filter(|term| **term != ShapeTerm::Delay);
        let rough = smooth.map(|&term| self.rough_slope(term, shape, linear));
        let rough = rough.collect::<Result<_, _>>()?;
        let mut slopes = self.smoothed(rough)?.into_iter();
        let delay = self.advance(shape);
        let [before, after] = delays.map(|delay| Shape { delay, ..*shape });
        let mut slope = |term: &ShapeTerm| match term {
            ShapeTerm::Delay => {
                let change = self.matrix(&after)? - self.matrix(&before)?;
                Ok(change * linear / (after.delay - before.delay))
            }
            _ => Ok(DVector::from_vec(self.read(&slopes.next().unwrap_or_default(), delay))),
        };
        terms.iter().map(&mut slope).collect()
    }

    /// A derivative sample by sample, before the low-pass; none for the delay.
    fn rough_slope(
        &mut self,
        term: ShapeTerm,
        shape: &Shape,
        linear: &DVector<f64>,
    ) -> Result<Vec<f64>, IdentError> {
        let levels = self.levels(linear);
        Ok(match term {
            ShapeTerm::Delay => vec![],
            ShapeTerm::StribeckVelocity => self.friction_curve(shape)?.by_velocity(&levels),
            ShapeTerm::Displacement => {
                let place = std::mem::take(&mut self.place);
                let slope = self.friction_curve(shape)?.by_displacement(&levels, &place);
                self.place = place;
                slope
            }
            ShapeTerm::Period => {
                let [cos, sin] = [linear.len() - 2, linear.len() - 1].map(|j| linear[j]);
                let position = self.recording.position.as_deref().unwrap_or_default();
                let change = |x: &f64| {
                    let angle = std::f64::consts::TAU * x / shape.period;
                    let (s, c) = angle.sin_cos();
                    (cos * s - sin * c) * angle / shape.period
                };
                position.iter().map(change).collect()
            }
        })
    }

    /// The levels of friction among the linear parameters.
    fn levels(&self, linear: &DVector<f64>) -> Levels {
        let AxisStructure { asymmetric, stribeck, position, damping, .. } = self.structure;
        let value = |j: usize| linear.get(self.fixed.len() + j).copied().unwrap_or(0.0);
        let sides = if asymmetric { 2 } else { 1 };
        let level = |first: usize| [value(first), value(first + sides - 1)];
        let kinetic = level(0);
        let rest = if stribeck { level(sides) } else { kinetic };
        let first = if stribeck { 2 * sides } else { sides };
        let along = if position { [value(first), value(first + 1)] } else { [0.0; 2] };
        let damping = if damping { value(if position { first + 2 } else { first }) } else { 0.0 };
        Levels { kinetic, rest, along, damping }
    }

    /// The delay in samples.
    fn advance(&self, shape: &Shape) -> f64 {
        if self.structure.delay { shape.delay / self.recording.time_step } else { 0.0 }
    }

    /// Time since the recording's first sample \[s\], of each row.
    pub fn time(&self) -> Vec<f64> {
        let Conditioned { time_step, first, decimate, .. } = *self.recording;
        let of = |piece: &Piece| {
            let start = piece.start;
            (0..rows_of(piece, decimate))
                .map(move |k| start + (first + k * decimate) as f64 * time_step)
        };
        self.recording.pieces.iter().flat_map(of).collect()
    }

    /// Velocity of each row, as it is when the force acts.
    pub fn velocity(&self, shape: &Shape) -> Vec<f64> {
        self.read(&self.recording.velocity, self.advance(shape))
    }

    /// Where the axis is at each row, and how fast, as the force acts.
    pub fn places(&self, shape: &Shape) -> Vec<Place> {
        let position = self.recording.position.as_deref().unwrap_or_default();
        let position = self.read(position, self.advance(shape));
        let places = position.into_iter().zip(self.velocity(shape));
        places.map(|(position, velocity)| Place { position, speed: velocity.abs() }).collect()
    }

    /// How many waves a second pass the low-pass of the thinning.
    pub fn fastest_wave(&self) -> f64 {
        let Conditioned { decimate, time_step, .. } = *self.recording;
        if decimate == 1 { f64::INFINITY } else { PASS / (decimate as f64 * time_step) }
    }

    /// What the axis does at each row.
    pub fn motion(&self, shape: &Shape) -> Vec<Vec<f64>> {
        let delay = self.advance(shape);
        self.recording.motion().iter().map(|column| self.read(column, delay)).collect()
    }

    /// A column on the kept rows, read `delay` samples later, never beyond its own stretch.
    fn read(&self, column: &[f64], delay: f64) -> Vec<f64> {
        let factor = self.recording.decimate;
        let mut rows = Vec::with_capacity(self.recording.pieces.len() * 8);
        let (later, t) = (delay.floor() as usize, delay - delay.floor());
        let weights = cubic(t);
        for piece in &self.recording.pieces {
            let own = column.get(piece.kept.clone()).unwrap_or_default();
            rows.extend((0..rows_of(piece, factor)).map(|k| {
                let at = k * factor + later;
                match own.get(at.wrapping_sub(1)..at + 3) {
                    Some(near) if t > 0.0 => near.iter().zip(&weights).map(|(y, w)| y * w).sum(),
                    _ => read(own, at as f64 + t),
                }
            }));
        }
        rows
    }

    /// Columns after the low-pass of the thinning.
    fn smoothed(&self, columns: Vec<Vec<f64>>) -> Result<Vec<Vec<f64>>, IdentError> {
        let Some(filter) = &self.filter else { return Ok(columns) };
        let mut smooth = vec![Vec::new(); columns.len()];
        for piece in &self.recording.pieces {
            let kept = || piece.kept.clone();
            let own: Vec<&[f64]> =
                columns.iter().map(|column| column.get(kept()).unwrap_or_default()).collect();
            for (all, own) in smooth.iter_mut().zip(filter.filter_all(&own)?) {
                if all.is_empty() { *all = own } else { all.extend(own) }
            }
        }
        Ok(smooth)
    }

    /// The columns that no nonlinear parameter changes, before the low-pass.
    fn fixed_columns(&self) -> Vec<Vec<f64>> {
        let Conditioned { acceleration, velocity, .. } = self.recording;
        let mut columns = vec![acceleration.clone()];
        columns.extend(self.sides(velocity.clone()));
        if !self.structure.asymmetric {
            columns.push(vec![1.0; velocity.len()]);
        }
        if self.structure.position {
            columns.push(self.place.clone());
        }
        if self.structure.gravity {
            let angles = self.recording.position.as_deref().unwrap_or_default();
            columns.push(angles.iter().map(|q| q.sin()).collect());
            columns.push(angles.iter().map(|q| q.cos()).collect());
        }
        columns
    }

    /// The positive and the negative part of a column, or the whole where the directions share a
    /// parameter.
    fn sides(&self, column: Vec<f64>) -> Vec<Vec<f64>> {
        if self.structure.asymmetric {
            vec![
                column.iter().map(|value| value.max(0.0)).collect(),
                column.iter().map(|value| value.min(0.0)).collect(),
            ]
        } else {
            vec![column]
        }
    }

    fn update_friction(&mut self, shape: &Shape) -> Result<(), IdentError> {
        let key = friction_key(shape);
        if self.friction.made_for == Some(key) {
            return Ok(());
        }
        let prepared = self.prepared.iter().position(|group| group.made_for == Some(key));
        if let Some(index) = prepared {
            self.friction = self.prepared.swap_remove(index);
            self.curve = None;
            return Ok(());
        }
        let curve = FrictionCurve::of(self.recording, &self.structure, shape);
        let columns = self.smoothed(self.friction_columns(&curve))?;
        self.friction = Group { made_for: Some(key), columns };
        self.curve = Some(curve);
        Ok(())
    }

    /// Makes the columns of several shapes at once, which is quicker than one after the other. They
    /// are used up as each shape is asked for.
    pub fn prepare(&mut self, shapes: &[Shape]) -> Result<(), IdentError> {
        let of = |shape| {
            self.friction_columns(&FrictionCurve::of(self.recording, &self.structure, shape))
        };
        let columns: Vec<Vec<Vec<f64>>> = shapes.iter().map(of).collect();
        let each = columns.first().map_or(0, Vec::len);
        let smooth = self.smoothed(columns.into_iter().flatten().collect())?;
        let groups = smooth.chunks(each.max(1)).zip(shapes);
        self.prepared = groups
            .map(|(columns, shape)| Group {
                made_for: Some(friction_key(shape)),
                columns: columns.to_vec(),
            })
            .collect();
        Ok(())
    }

    /// How many shapes are worth preparing together: as many as fill the lanes of the low-pass.
    pub fn at_once(&self) -> usize {
        let AxisStructure { asymmetric, stribeck, position, damping, .. } = self.structure;
        let sides = if asymmetric { 2 } else { 1 };
        let extra = [position, position, damping].into_iter().filter(|has| *has).count();
        let columns = sides * if stribeck { 2 } else { 1 } + extra;
        LANES.div_ceil(columns)
    }

    /// What friction is made of for a shape, beside its columns.
    fn friction_curve(&mut self, shape: &Shape) -> Result<&FrictionCurve, IdentError> {
        self.update_friction(shape)?;
        let (recording, structure) = (self.recording, &self.structure);
        Ok(self.curve.get_or_insert_with(|| FrictionCurve::of(recording, structure, shape)))
    }

    fn friction_columns(&self, curve: &FrictionCurve) -> Vec<Vec<f64>> {
        let FrictionCurve { sign, near, rate, .. } = curve;
        let mut columns = Vec::new();
        if self.structure.stribeck {
            let kinetic = sign.iter().zip(near).map(|(sign, near)| sign * (1.0 - near)).collect();
            let rest = sign.iter().zip(near).map(|(sign, near)| sign * near).collect();
            columns.extend(self.sides(kinetic));
            columns.extend(self.sides(rest));
        } else {
            columns.extend(self.sides(sign.clone()));
        }
        if self.structure.position {
            let place = &self.place;
            columns.push(sign.iter().zip(place).map(|(sign, x)| sign * x).collect());
            columns.push(sign.iter().zip(place).map(|(sign, x)| sign * x * x).collect());
        }
        if self.structure.damping {
            columns.push(rate.clone());
        }
        columns
    }

    fn update_harmonic(&mut self, shape: &Shape) -> Result<(), IdentError> {
        let key = [shape.period, 0.0];
        if !self.structure.harmonic || self.harmonic.made_for == Some(key) {
            return Ok(());
        }
        let columns = self.smoothed(self.harmonic_columns(shape))?;
        self.harmonic = Group { made_for: Some(key), columns };
        Ok(())
    }

    fn harmonic_columns(&self, shape: &Shape) -> Vec<Vec<f64>> {
        let position = self.recording.position.as_deref().unwrap_or_default();
        let angle = |x: &f64| std::f64::consts::TAU * x / shape.period;
        let (sin, cos) = position.iter().map(|x| angle(x).sin_cos()).unzip();
        vec![cos, sin]
    }
}

/// What the columns of friction depend on.
fn friction_key(shape: &Shape) -> [f64; 2] {
    [shape.v_s, shape.displacement]
}

/// Rows that a stretch gives: its end is left to the longest delay.
pub(crate) fn rows_of(piece: &Piece, factor: usize) -> usize {
    piece.kept.len().saturating_sub(LONGEST_DELAY + 2).div_ceil(factor)
}

/// A column between its samples, by the cubic through the four around it.
pub(crate) fn read(column: &[f64], at: f64) -> f64 {
    let i = at.floor() as usize;
    let t = at - i as f64;
    let value =
        |k: usize| column.get(k.min(column.len().saturating_sub(1))).copied().unwrap_or(0.0);
    if t == 0.0 {
        return value(i);
    }
    let near = [value(i.saturating_sub(1)), value(i), value(i + 1), value(i + 2)];
    near.iter().zip(cubic(t)).map(|(y, weight)| y * weight).sum()
}

/// Weights of four samples in the value of their cubic at `t` between the second and the third.
fn cubic(t: f64) -> [f64; 4] {
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::read;

    /// A cubic is met exactly inside.
    #[test]
    fn a_cubic_is_read_exactly_between_samples() {
        let cubic = |t: f64| 1.0 + t * (2.0 - t * (0.5 - 0.25 * t));
        let column: Vec<f64> = (0..8).map(|i| cubic(f64::from(i))).collect();
        for at in [1.0, 1.3, 2.5, 4.999, 5.5] {
            assert!((read(&column, at) - cubic(at)).abs() < 1e-12, "{at}");
        }
    }
}
