//! The columns of the regression, filtered, thinned and advanced by the delay.
//!
//! A delayed force `F(t) = f(t + delay)` is met by reading the model's columns later, not by moving
//! the force: the force stays as measured, and relative errors keep one denominator. The columns
//! are read after their anti-alias low-pass, which makes interpolation between samples exact to far
//! below the noise, and lets a new delay cost no filtering. A force from behind a low-pass is met the
//! same way, by columns from behind it.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::AxisStructure;
use super::friction_curve::{FrictionCurve, Levels};
use super::rows::{Reading, Rows};
use super::shape::{Late, PositionScale, Shape, ShapeTerm};
use super::start::{FORGOTTEN, Starts};
use super::waves::Place;
use crate::IdentError;
use crate::conditioning::Conditioned;
use crate::zero_phase::LANES;

/// Times the largest force of the motion that a level of friction may be. Where sticks are left out,
/// the force that made the axis start may be too.
const FAR_BEYOND: f64 = 2.0;

/// The columns that a nonlinear parameter changes, with the values they were made for.
#[derive(Debug, Clone, Default)]
struct Group {
    made_for: Option<[f64; 4]>,
    columns: Vec<Vec<f64>>,
    /// What is left of how a bristle began, where that is not forgotten; else empty.
    begun: Vec<f64>,
}

/// That a regression has too few rows.
fn too_few(needed: usize, found: usize) -> IdentError {
    let what = "the regression, after trimming and decimation,";
    IdentError::TooFewSamples { what, needed, found, lower: Some("the trim or the decimation") }
}

/// Regressors of one structure along one recording.
pub(super) struct Regressors<'a> {
    pub recording: &'a Conditioned,
    structure: AxisStructure,
    /// Exponent of a further viscous friction that goes with a power of the velocity.
    power: Option<f64>,
    /// Position from -1 to 1 over the estimation recording, where the structure needs it.
    place: Vec<f64>,
    /// How samples become rows.
    pub rows: Rows<'a>,
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
        Self::with_power(recording, structure, scale, None)
    }

    /// The same beside `|v|^p sign(v)`, the last of the fixed columns.
    pub fn with_power(
        recording: &'a Conditioned,
        structure: AxisStructure,
        scale: PositionScale,
        power: Option<f64>,
    ) -> Result<Self, IdentError> {
        let rows = Rows::of(recording)?;
        if recording.force.iter().all(|&force| force == 0.0) {
            return Err(IdentError::ZeroForce);
        }
        if structure.needs_position() && recording.position.is_none() {
            return Err(IdentError::NoPosition { structure });
        }
        if rows.count() == 0 {
            return Err(too_few(1, 0));
        }
        let position = recording.position.as_deref().filter(|_| structure.position);
        let place = position.unwrap_or_default().iter().map(|&x| scale.normalised(x)).collect();
        let mut made = Self {
            recording,
            structure,
            power,
            place,
            rows,
            fixed: Vec::new(),
            friction: Group::default(),
            prepared: Vec::new(),
            curve: None,
            harmonic: Group::default(),
            force: DVector::zeros(0),
        };
        let mut columns = made.fixed_columns();
        columns.push(recording.force.clone());
        made.fixed = made.rows.smoothed(columns)?;
        let force = made.fixed.pop().unwrap_or_default();
        made.force = DVector::from_vec(made.rows.read(&force, Reading::Later(0.0)));
        Ok(made)
    }

    /// Whether there are rows enough for a fit; a prediction needs none.
    pub fn enough(&self) -> Result<(), IdentError> {
        let (found, needed) = (self.count(), 4 * self.structure.parameters());
        if found < needed { Err(too_few(needed, found)) } else { Ok(()) }
    }

    /// How many rows there are.
    pub fn count(&self) -> usize {
        self.force.len()
    }

    /// One row a kept sample, one column a linear parameter.
    pub fn matrix(&mut self, shape: &Shape) -> Result<DMatrix<f64>, IdentError> {
        self.update_friction(shape)?;
        self.update_harmonic(shape)?;
        let reading = self.reading(shape);
        let columns = self.fixed.iter().chain(&self.friction.columns).chain(&self.harmonic.columns);
        let columns: Vec<&Vec<f64>> = columns.collect();
        let mut matrix = DMatrix::zeros(self.count(), columns.len());
        for (mut to, from) in matrix.column_iter_mut().zip(columns) {
            to.copy_from_slice(&self.rows.read(from, reading));
        }
        Ok(matrix)
    }

    /// What the unknown deflection of the bristle adds at the start of each stretch, on the rows that
    /// count.
    pub fn starts(&mut self, shape: &Shape, rows: Option<&[usize]>) -> Result<Starts, IdentError> {
        self.update_friction(shape)?;
        let reading = self.reading(shape);
        if self.friction.begun.is_empty() {
            return Ok(Starts::default());
        }
        let left = self.rows.read(&self.friction.begun, reading);
        Ok(Starts::of(&left, &self.rows.stretches(), rows))
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
        let mut slopes = self.rows.smoothed(rough)?.into_iter();
        let reading = self.reading(shape);
        let [before, after] = delays.map(|delay| Shape { delay, ..*shape });
        let mut slope = |term: &ShapeTerm| match term {
            ShapeTerm::Delay => {
                let change = self.matrix(&after)? - self.matrix(&before)?;
                Ok(change * linear / (after.delay - before.delay))
            }
            _ => {
                let slope = slopes.next().unwrap_or_default();
                Ok(DVector::from_vec(self.rows.read(&slope, reading)))
            }
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
            ShapeTerm::StribeckVelocity | ShapeTerm::Displacement | ShapeTerm::Ratio => {
                let begun = match term {
                    ShapeTerm::Displacement => self.begun(shape, linear)?,
                    _ => Vec::new(),
                };
                let place = std::mem::take(&mut self.place);
                let curve = self.friction_curve(shape)?;
                let slope = match term {
                    ShapeTerm::Displacement => {
                        let mut slope = curve.by_displacement(&levels, &place);
                        for (samples, amount) in begun {
                            let own = slope.get_mut(samples.clone()).unwrap_or_default();
                            let left = curve.left[1].get(samples).unwrap_or_default();
                            own.iter_mut().zip(left).for_each(|(to, left)| *to += amount * left);
                        }
                        slope
                    }
                    ShapeTerm::Ratio => curve.by_ratio(&levels, &place),
                    _ => curve.by_velocity(&levels, &place),
                };
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

    /// How far the bristle was from where it is taken to begin \[N or N m\], of each stretch in whose
    /// rows that is not forgotten, with its samples.
    fn begun(
        &mut self,
        shape: &Shape,
        linear: &DVector<f64>,
    ) -> Result<Vec<(Range<usize>, f64)>, IdentError> {
        let starts = self.starts(shape, None)?;
        if starts.is_empty() {
            return Ok(Vec::new());
        }
        let predicted = self.matrix(shape)? * linear;
        let rest = &self.force - predicted;
        let amounts = starts.amounts(rest.as_slice());
        let stretches = self.rows.stretches();
        let samples = |row: usize| {
            let index = stretches.iter().position(|stretch| stretch.start == row)?;
            self.rows.samples().get(index).cloned()
        };
        let all = amounts.into_iter().filter_map(|(row, amount)| Some((samples(row)?, amount)));
        Ok(all.collect())
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

    /// Where the force of a power of the velocity is among the linear parameters.
    pub fn of_power(&self) -> Option<usize> {
        self.power.and(self.fixed.len().checked_sub(1))
    }

    /// The linear parameters that may not be below zero, as friction at rest would then drive the axis:
    /// its levels there. Where a dip lags, their ratio has bounds of its own.
    pub fn not_below_zero(&self) -> Range<usize> {
        let AxisStructure { stribeck, lag, .. } = self.structure;
        if stribeck && !lag { self.levels_at_rest() } else { 0..0 }
    }

    /// Where the levels at rest are among the linear parameters, behind as many kinetic ones.
    pub fn levels_at_rest(&self) -> Range<usize> {
        let sides = if self.structure.asymmetric { 2 } else { 1 };
        let first = self.fixed.len() + sides;
        first..first + sides
    }

    /// The largest level at rest beside the largest force of the motion \[N or N m\], where it is far
    /// beyond that: an axis that starts has overcome its friction at rest, and a dip that is only told
    /// by what is left of it at some speed may come out at any height.
    pub fn level_beyond(&self, linear: &DVector<f64>) -> Option<(f64, f64)> {
        if !self.structure.stribeck {
            return None;
        }
        let Levels { rest, .. } = self.levels(linear);
        let level = rest[0].abs().max(rest[1].abs());
        let force = self.recording.force.iter().fold(0.0f64, |most, force| most.max(force.abs()));
        (level > FAR_BEYOND * force).then_some((level, force))
    }

    /// `f_s` over `f_c`, of both directions together; none where no bristle lags.
    pub fn ratio(&self, linear: &DVector<f64>) -> Option<f64> {
        let Levels { kinetic, rest, .. } = self.levels(linear);
        let sum = |level: [f64; 2]| level[0] + level[1];
        self.structure.lag.then(|| sum(rest) / sum(kinetic).max(0.0))
    }

    /// `sigma1` over `f_c`, of both directions together; zero where nothing is damped.
    pub fn damped(&self, linear: &DVector<f64>) -> f64 {
        let Levels { kinetic, damping, .. } = self.levels(linear);
        let mean = 0.5 * (kinetic[0] + kinetic[1]);
        if self.structure.damping && mean > 0.0 { damping / mean } else { 0.0 }
    }

    /// How the columns are read for a shape.
    fn reading(&self, shape: &Shape) -> Reading {
        let samples = shape.delay / self.recording.time_step;
        match shape.late {
            _ if !self.structure.delay => Reading::Later(0.0),
            Late::LowPassed if samples < 0.0 => Reading::LowPassed(-samples),
            _ => Reading::Later(samples),
        }
    }

    /// Velocity of each row, as it is when the force acts.
    pub fn velocity(&self, shape: &Shape) -> Vec<f64> {
        self.rows.read(&self.recording.velocity, self.reading(shape))
    }

    /// Where the axis is at each row, and how fast, as the force acts.
    pub fn places(&self, shape: &Shape) -> Vec<Place> {
        let position = self.recording.position.as_deref().unwrap_or_default();
        let position = self.rows.read(position, self.reading(shape));
        let places = position.into_iter().zip(self.velocity(shape));
        places.map(|(position, velocity)| Place { position, speed: velocity.abs() }).collect()
    }

    /// What the axis does at each row.
    pub fn motion(&self, shape: &Shape) -> Vec<Vec<f64>> {
        let reading = self.reading(shape);
        self.recording.motion().iter().map(|column| self.rows.read(column, reading)).collect()
    }

    /// The columns that no nonlinear parameter changes, before the low-pass.
    fn fixed_columns(&self) -> Vec<Vec<f64>> {
        let Conditioned { acceleration, velocity, .. } = self.recording;
        let mut columns = vec![acceleration.clone()];
        columns.extend(self.sides(velocity.clone(), velocity));
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
        if let Some(power) = self.power {
            columns.push(velocity.iter().map(|v| v.abs().powf(power).copysign(*v)).collect());
        }
        columns
    }

    /// A column where `way` is forward and where it is backward, or the whole where the directions
    /// share a parameter.
    fn sides(&self, column: Vec<f64>, way: &[f64]) -> Vec<Vec<f64>> {
        let part = |forward: bool| {
            let rows = column.iter().zip(way);
            rows.map(|(value, way)| if (*way > 0.0) == forward { *value } else { 0.0 }).collect()
        };
        if self.structure.asymmetric { vec![part(true), part(false)] } else { vec![column] }
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
        let columns = self.rows.smoothed(self.friction_columns(&curve))?;
        let begun = self.rows.smoothed_start(&curve.left[0], FORGOTTEN)?;
        self.friction = Group { made_for: Some(key), columns, begun };
        self.curve = Some(curve);
        Ok(())
    }

    /// Makes the columns of several shapes at once, which is quicker than one after the other. They
    /// are used up as each shape is asked for.
    pub fn prepare(&mut self, shapes: &[Shape]) -> Result<(), IdentError> {
        let of = |shape| FrictionCurve::of(self.recording, &self.structure, shape);
        let curves: Vec<FrictionCurve> = shapes.iter().map(of).collect();
        let columns: Vec<_> = curves.iter().map(|curve| self.friction_columns(curve)).collect();
        let begun = curves.iter().map(|curve| self.rows.smoothed_start(&curve.left[0], FORGOTTEN));
        let begun = begun.collect::<Result<Vec<_>, _>>()?;
        let each = columns.first().map_or(0, Vec::len);
        let smooth = self.rows.smoothed(columns.into_iter().flatten().collect())?;
        let groups = smooth.chunks(each.max(1)).zip(shapes).zip(begun);
        self.prepared = groups
            .map(|((columns, shape), begun)| Group {
                made_for: Some(friction_key(shape)),
                columns: columns.to_vec(),
                begun,
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
        let FrictionCurve { sign, rate, .. } = curve;
        let mut columns = Vec::new();
        if let Some([kinetic, rest]) = curve.levels() {
            columns.extend(self.sides(kinetic, sign));
            columns.extend(self.sides(rest, sign));
        } else {
            columns.extend(self.sides(sign.clone(), sign));
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
        let key = [shape.period, 0.0, 0.0, 0.0];
        if !self.structure.harmonic || self.harmonic.made_for == Some(key) {
            return Ok(());
        }
        let columns = self.rows.smoothed(self.harmonic_columns(shape))?;
        self.harmonic = Group { made_for: Some(key), columns, begun: Vec::new() };
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
fn friction_key(shape: &Shape) -> [f64; 4] {
    [shape.v_s, shape.displacement, shape.ratio, shape.damped]
}
