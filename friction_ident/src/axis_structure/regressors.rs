//! The columns of the regression, filtered, thinned and advanced by the delay.
//!
//! A delayed force `F(t) = f(t + delay)` is met by reading the model's columns later, not by moving
//! the force: the force stays as measured, and relative errors keep one denominator. The columns
//! are read after their anti-alias low-pass, which makes interpolation between samples exact to far
//! below the noise, and lets a new delay cost no filtering.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::AxisStructure;
use super::shape::{LONGEST_DELAY, PositionScale, Shape, ShapeTerm};
use crate::IdentError;
use crate::conditioning::{Conditioned, Piece};
use crate::zero_phase::LowPass;

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
    scale: PositionScale,
    filter: Option<LowPass>,
    /// Inertia, viscous friction, offset, force along the axis, gravity.
    fixed: Vec<Vec<f64>>,
    friction: Group,
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
            _ => Some(LowPass::chebyshev(8, 0.05, 0.4 / factor as f64, 1.0)?),
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
        let mut made = Self {
            recording,
            structure,
            scale,
            filter,
            fixed: Vec::new(),
            friction: Group::default(),
            harmonic: Group::default(),
            force: DVector::zeros(0),
        };
        let force = made.smooth(recording.force.clone())?;
        made.force = DVector::from_vec(made.read(&force, 0.0));
        made.fixed = made.fixed_columns()?;
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

    /// Derivative of the predicted force with respect to a nonlinear parameter, from its change
    /// between two shapes that differ in it alone. The change is filtered once, whatever the number
    /// of columns.
    pub fn slope(
        &mut self,
        term: ShapeTerm,
        before: &Shape,
        after: &Shape,
        linear: &DVector<f64>,
    ) -> Result<DVector<f64>, IdentError> {
        let width = term.value(after) - term.value(before);
        if term == ShapeTerm::Delay {
            return Ok((self.matrix(after)? - self.matrix(before)?) * linear / width);
        }
        let (a, b) = (self.shaped_columns(before, term), self.shaped_columns(after, term));
        let first = match term {
            ShapeTerm::Period => linear.len() - b.len(),
            _ => self.fixed.len(),
        };
        let mut change = vec![0.0; self.recording.velocity.len()];
        for (j, (a, b)) in a.iter().zip(&b).enumerate() {
            let weight = linear[first + j] / width;
            change.iter_mut().zip(a).zip(b).for_each(|((sum, a), b)| *sum += weight * (b - a));
        }
        let change = self.smooth(change)?;
        Ok(DVector::from_vec(self.read(&change, self.advance(before))))
    }

    /// The unfiltered columns that a nonlinear parameter changes.
    fn shaped_columns(&self, shape: &Shape, term: ShapeTerm) -> Vec<Vec<f64>> {
        match term {
            ShapeTerm::Delay => Vec::new(),
            ShapeTerm::StribeckVelocity | ShapeTerm::Displacement => self.friction_columns(shape),
            ShapeTerm::Period => self.harmonic_columns(shape),
        }
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

    /// What the axis does at each row.
    pub fn motion(&self, shape: &Shape) -> Vec<Vec<f64>> {
        let delay = self.advance(shape);
        self.recording.motion().iter().map(|column| self.read(column, delay)).collect()
    }

    /// A column on the kept rows, read `delay` samples later, never beyond its own stretch.
    fn read(&self, column: &[f64], delay: f64) -> Vec<f64> {
        let factor = self.recording.decimate;
        let of = |piece: &Piece| {
            let own = column.get(piece.kept.clone()).unwrap_or_default();
            (0..rows_of(piece, factor)).map(move |k| read(own, (k * factor) as f64 + delay))
        };
        self.recording.pieces.iter().flat_map(of).collect()
    }

    fn smooth(&self, column: Vec<f64>) -> Result<Vec<f64>, IdentError> {
        match &self.filter {
            Some(filter) => self.recording.by_piece(&column, |piece| filter.filter(piece)),
            None => Ok(column),
        }
    }

    fn fixed_columns(&self) -> Result<Vec<Vec<f64>>, IdentError> {
        let Conditioned { acceleration, velocity, .. } = self.recording;
        let mut columns = vec![acceleration.clone()];
        columns.extend(self.sides(velocity.clone()));
        if !self.structure.asymmetric {
            columns.push(vec![1.0; velocity.len()]);
        }
        if self.structure.position {
            columns.push(self.place());
        }
        if self.structure.gravity {
            let angles = self.recording.position.as_deref().unwrap_or_default();
            columns.push(angles.iter().map(|q| q.sin()).collect());
            columns.push(angles.iter().map(|q| q.cos()).collect());
        }
        columns.into_iter().map(|column| self.smooth(column)).collect()
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

    /// Position from -1 to 1 over the estimation recording.
    fn place(&self) -> Vec<f64> {
        let position = self.recording.position.as_deref().unwrap_or_default();
        position.iter().map(|&x| self.scale.normalised(x)).collect()
    }

    fn update_friction(&mut self, shape: &Shape) -> Result<(), IdentError> {
        let key = [shape.v_s, shape.displacement];
        if self.friction.made_for != Some(key) {
            let columns =
                self.friction_columns(shape).into_iter().map(|column| self.smooth(column));
            let columns = columns.collect::<Result<_, _>>()?;
            self.friction = Group { made_for: Some(key), columns };
        }
        Ok(())
    }

    fn friction_columns(&self, shape: &Shape) -> Vec<Vec<f64>> {
        let sign = self.sign(shape.displacement);
        let mut columns = Vec::new();
        if self.structure.stribeck {
            let near: Vec<f64> =
                self.recording.velocity.iter().map(|v| (-(v / shape.v_s).powi(2)).exp()).collect();
            let kinetic = sign.iter().zip(&near).map(|(sign, near)| sign * (1.0 - near)).collect();
            let rest = sign.iter().zip(&near).map(|(sign, near)| sign * near).collect();
            columns.extend(self.sides(kinetic));
            columns.extend(self.sides(rest));
        } else {
            columns.extend(self.sides(sign.clone()));
        }
        if self.structure.position {
            let place = self.place();
            columns.push(sign.iter().zip(&place).map(|(sign, x)| sign * x).collect());
            columns.push(sign.iter().zip(&place).map(|(sign, x)| sign * x * x).collect());
        }
        columns
    }

    /// Direction of motion, -1 to 1: the sign of the velocity, or the deflection of a bristle over
    /// its limit.
    ///
    /// The bristle is Dahl's (1968), `z' = (v - |v| z) / displacement`, solved exactly over a
    /// sample of constant velocity.
    fn sign(&self, displacement: f64) -> Vec<f64> {
        let Conditioned { velocity, velocity_floor, time_step, .. } = self.recording;
        let sign = |v: f64| if v.abs() <= *velocity_floor { 0.0 } else { v.signum() };
        if !self.structure.presliding {
            return velocity.iter().map(|&v| sign(v)).collect();
        }
        // The bristle of each stretch begins at its own end of the curve, and keeps its deflection
        // while the axis stands.
        let lived = self.recording.history.as_deref().unwrap_or(velocity);
        let mut along = Vec::with_capacity(velocity.len());
        let mut at: Option<(usize, usize, f64)> = None;
        for piece in &self.recording.pieces {
            let Range { start, end } = piece.origin;
            let (from, mut z) = match at {
                Some((stretch, done, z)) if stretch == piece.stretch => (done, z),
                _ => (start, lived.get(start).map_or(0.0, |&v| sign(v))),
            };
            for (k, v) in lived.iter().enumerate().take(end).skip(from) {
                let limit = v.signum();
                z = limit + (z - limit) * (-v.abs() * time_step / displacement).exp();
                if k >= start {
                    along.push(z);
                }
            }
            at = Some((piece.stretch, end, z));
        }
        along
    }

    fn update_harmonic(&mut self, shape: &Shape) -> Result<(), IdentError> {
        let key = [shape.period, 0.0];
        if !self.structure.harmonic || self.harmonic.made_for == Some(key) {
            return Ok(());
        }
        let columns = self.harmonic_columns(shape).into_iter().map(|column| self.smooth(column));
        let columns = columns.collect::<Result<_, _>>()?;
        self.harmonic = Group { made_for: Some(key), columns };
        Ok(())
    }

    fn harmonic_columns(&self, shape: &Shape) -> Vec<Vec<f64>> {
        let position = self.recording.position.as_deref().unwrap_or_default();
        let angle = |x: &f64| std::f64::consts::TAU * x / shape.period;
        vec![
            position.iter().map(|x| angle(x).cos()).collect(),
            position.iter().map(|x| angle(x).sin()).collect(),
        ]
    }
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
    let (a, b, c, d) = (value(i.saturating_sub(1)), value(i), value(i + 1), value(i + 2));
    -t * (t - 1.0) * (t - 2.0) / 6.0 * a + (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0 * b
        - (t + 1.0) * t * (t - 2.0) / 2.0 * c
        + (t + 1.0) * t * (t - 1.0) / 6.0 * d
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
