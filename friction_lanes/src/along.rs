//! Many sets along a motion: which of them share a block, and the loop over the samples.

use std::{array, mem};

use friction_model::arithmetic::{bounded, mean};
use friction_model::{
    AnyModel, AnyParameters, FrictionModel, ModelVisitor, Scheme, Stepper, TimeStep,
};
use pulp::{Arch, Simd, WithSimd};

pub use crate::block::WIDTH;
use crate::contact::Contact;
use crate::elementary::fuses;
use crate::gms::GmsLanes;
use crate::lugre::LuGreLanes;
use crate::proposed::ProposedLanes;
use crate::xiong::XiongLanes;

/// Samples whose forces are kept together before they go to the rows of their sets.
const TILE: usize = 64;

/// The friction \[N or N m\] of each model along velocities \[m/s or rad/s\] that are a period apart,
/// from rest: all samples of the first into `rows`, then of the second, ... A row is as long as
/// `velocity`; what has no room in `rows` is left out.
///
/// A velocity beyond [`MAX_SPEED`](friction_model::MAX_SPEED) is cut to it; one that is not a number
/// counts as zero. `stop` is asked now and then: once it says so, the rest is left as it is.
///
/// Neighbours of the same kind are computed [`WIDTH`] at a time. A set's forces do not depend on its
/// neighbours.
pub fn forces(
    models: &[AnyModel],
    velocity: &[f64],
    (dt, scheme): (TimeStep, Scheme),
    rows: &mut [f64],
    stop: impl Fn() -> bool,
) {
    if velocity.is_empty() {
        return;
    }
    let how = How { velocity, dt, scheme, stop: &stop };
    let mut rest = rows;
    let alike = |a: &AnyModel, b: &AnyModel| kind(&a.parameters()) == kind(&b.parameters());
    for few in models.chunk_by(alike).flat_map(|models| models.chunks(WIDTH)) {
        let room = rest.len().min(few.len() * velocity.len());
        let (rows, others) = mem::take(&mut rest).split_at_mut(room);
        rest = others;
        how.block(few, rows);
    }
}

/// What models of a block have in common: those with lanes, and their number of elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    LuGre,
    Gms(usize),
    Xiong(usize),
    Proposed,
    /// Without lanes.
    Other,
}

fn kind(parameters: &AnyParameters) -> Kind {
    match parameters {
        AnyParameters::LuGre(_) => Kind::LuGre,
        AnyParameters::Gms(p) => Kind::Gms(p.alpha.len()),
        AnyParameters::Xiong(p) => Kind::Xiong(p.lambda.len()),
        AnyParameters::Proposed(_) => Kind::Proposed,
        _ => Kind::Other,
    }
}

/// The parameters of all lanes, where they are those of one model.
macro_rules! of_all {
    ($sets:expr, $variant:ident) => {{
        let first = &$sets[0];
        let AnyParameters::$variant(first) = first else { return false };
        $sets.each_ref().map(|set| match set {
            AnyParameters::$variant(parameters) => parameters,
            _ => first,
        })
    }};
}

/// A motion, and how it is stepped through.
#[derive(Clone, Copy)]
struct How<'a> {
    velocity: &'a [f64],
    dt: TimeStep,
    scheme: Scheme,
    stop: &'a dyn Fn() -> bool,
}

impl How<'_> {
    /// At most [`WIDTH`] models of one kind.
    fn block(self, models: &[AnyModel], rows: &mut [f64]) {
        let Some(last) = models.last() else { return };
        if self.in_lanes(models, last, rows) {
            return;
        }
        for (model, row) in models.iter().zip(rows.chunks_mut(self.velocity.len())) {
            if !(self.stop)() {
                model.visit(Alone { how: self, row });
            }
        }
    }

    /// In lanes, where the model has them. Lanes that are left over repeat the last model.
    fn in_lanes(self, models: &[AnyModel], last: &AnyModel, rows: &mut [f64]) -> bool {
        let dt = self.dt.seconds();
        let sets: [AnyParameters; WIDTH] =
            array::from_fn(|lane| models.get(lane).unwrap_or(last).parameters());
        match kind(&sets[0]) {
            Kind::LuGre => self.run(LuGreLanes::new(of_all!(sets, LuGre), dt), rows),
            Kind::Gms(_) => self.run(GmsLanes::new(of_all!(sets, Gms), dt), rows),
            Kind::Xiong(_) => self.run(XiongLanes::new(of_all!(sets, Xiong), dt), rows),
            Kind::Proposed => self.run(ProposedLanes::new(of_all!(sets, Proposed), dt), rows),
            Kind::Other => return false,
        }
        true
    }

    fn run<C: Contact>(self, contact: C, rows: &mut [f64]) {
        Arch::new().dispatch(Run { how: self, contact, rows });
    }
}

/// A block along the motion.
struct Run<'a, 'b, C> {
    how: How<'a>,
    contact: C,
    rows: &'b mut [f64],
}

impl<C: Contact> WithSimd for Run<'_, '_, C> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        if fuses::<S>() {
            self.by_scheme::<true>();
        } else {
            self.by_scheme::<false>();
        }
    }
}

impl<C: Contact> Run<'_, '_, C> {
    #[inline(always)]
    fn by_scheme<const FUSED: bool>(self) {
        match self.how.scheme {
            Scheme::Held => self.along::<FUSED, true>(),
            Scheme::Mean => self.along::<FUSED, false>(),
        }
    }

    /// Steps through the motion, and hands the forces of each lane to its row.
    #[inline(always)]
    fn along<const FUSED: bool, const HELD: bool>(self) {
        let Self { how, mut contact, rows } = self;
        let mut tile = [[0.0; WIDTH]; TILE];
        let mut before = None;
        for (part, velocities) in how.velocity.chunks(TILE).enumerate() {
            if (how.stop)() {
                return;
            }
            for (forces, velocity) in tile.iter_mut().zip(velocities) {
                let v = bounded(*velocity);
                *forces = if HELD {
                    contact.step::<FUSED>(v)
                } else {
                    if let Some(before) = before.replace(v) {
                        contact.advance::<FUSED>(mean(before, v));
                    }
                    contact.force::<FUSED>(v)
                };
            }
            for (lane, row) in rows.chunks_mut(how.velocity.len()).enumerate().take(WIDTH) {
                let places = row.iter_mut().skip(part * TILE).take(velocities.len());
                for (place, forces) in places.zip(&tile) {
                    *place = forces[lane];
                }
            }
        }
    }
}

/// One set along the motion, in code that knows its model.
struct Alone<'a, 'b> {
    how: How<'a>,
    row: &'b mut [f64],
}

impl ModelVisitor for Alone<'_, '_> {
    type Output = ();

    fn visit<M: FrictionModel>(self, model: M) {
        let mut contact = Stepper::by(self.how.scheme, model, self.how.dt);
        for (force, velocity) in self.row.iter_mut().zip(self.how.velocity) {
            *force = contact.step(*velocity);
        }
    }
}

#[cfg(test)]
mod tests {
    use friction_model::presets::Presets;
    use friction_model::{GmsParameters, LuGreParameters, ProposedParameters, XiongParameters};

    use super::*;

    /// The forces of both ways to round, one of which this processor would not take.
    fn both_ways<C: Contact + Clone>(contact: &C, how: How<'_>) -> [Vec<f64>; 2] {
        let mut rows = [0, 1].map(|_| vec![0.0; how.velocity.len() * WIDTH]);
        let [apart, fused] = &mut rows;
        Run { how, contact: contact.clone(), rows: apart }.by_scheme::<false>();
        Run { how, contact: contact.clone(), rows: fused }.by_scheme::<true>();
        rows
    }

    #[test]
    fn a_processor_that_fuses_nothing_finds_the_same_to_rounding() {
        let velocity: Vec<f64> = (0..2000).map(|k| 0.2 * (0.01 * f64::from(k)).sin()).collect();
        let dt = TimeStep::new(1e-3).unwrap();
        for scheme in [Scheme::Held, Scheme::Mean] {
            let how = How { velocity: &velocity, dt, scheme, stop: &|| false };
            let check = |[apart, fused]: [Vec<f64>; 2]| {
                for (a, b) in apart.iter().zip(&fused) {
                    assert!((a - b).abs() < 1e-13, "{a} {b}");
                }
            };
            check(both_ways(&LuGreLanes::new([&LuGreParameters::test_bed(); WIDTH], 1e-3), how));
            check(both_ways(&GmsLanes::new([&GmsParameters::test_bed(); WIDTH], 1e-3), how));
            check(both_ways(&XiongLanes::new([&XiongParameters::test_bed(); WIDTH], 1e-3), how));
            let proposed = ProposedParameters::test_bed();
            check(both_ways(&ProposedLanes::new([&proposed; WIDTH], 1e-3), how));
        }
    }
}
