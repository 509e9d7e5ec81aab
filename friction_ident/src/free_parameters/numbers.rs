//! What the numbers of a model are at given coordinates.

use friction_model::Real;

use super::{Coordinate, FreeParameters, SHARES};
use crate::parameter_id::Side;

/// A number that is no longer the template's.
pub(super) struct Moved<T> {
    pub side: Side,
    pub name: &'static str,
    pub index: usize,
    pub value: T,
}

/// The numbers of a model some of which have moved.
pub(super) struct Numbers<'a, T> {
    free: &'a FreeParameters,
    /// The latest value of a number stands last.
    pub moved: Vec<Moved<T>>,
}

impl<T: Real> Numbers<'_, T> {
    /// A number as it is now; not a number where there is none.
    fn get(&self, side: Side, name: &str, index: usize) -> T {
        let is = |moved: &&Moved<T>| (moved.side, moved.name, moved.index) == (side, name, index);
        self.moved.iter().rev().find(is).map_or_else(
            || {
                let all = self.free.read_all(name, side);
                T::of(all.get(index).copied().unwrap_or(f64::NAN))
            },
            |moved| moved.value,
        )
    }

    fn set(&mut self, side: Side, name: &'static str, index: usize, value: T) {
        self.moved.push(Moved { side, name, index, value });
    }
}

impl FreeParameters {
    /// The free numbers at these coordinates, and those that follow from them.
    pub(super) fn numbers<T: Real>(&self, coordinates: &[T]) -> Numbers<'_, T> {
        let mut numbers = Numbers { free: self, moved: Vec::new() };
        for side in [Side::Both, Side::Forward, Side::Backward] {
            // Plain numbers first: excesses and shares refer to them.
            for pass in [true, false] {
                for ((id, coordinate), &value) in
                    self.ids.iter().zip(&self.coordinates).zip(coordinates)
                {
                    let plain = matches!(coordinate, Coordinate::Itself | Coordinate::Logarithm);
                    if id.side != side || plain != pass {
                        continue;
                    }
                    let get = |name| numbers.get(side, name, 0);
                    let number = match coordinate {
                        Coordinate::Itself => value,
                        Coordinate::Logarithm => value.exp(),
                        Coordinate::Excess => get("f_c") + value,
                        Coordinate::ShareOfDeflection => value * get("f_c") / get("sigma0"),
                    };
                    numbers.set(side, id.name, id.index(), number);
                }
            }
            self.keep_together(&mut numbers, side);
        }
        numbers
    }

    /// What follows from the free numbers: the last share, and a `z_ba` that is not free keeps its
    /// share of `f_c / sigma0`.
    fn keep_together<T: Real>(&self, numbers: &mut Numbers<T>, side: Side) {
        for shares in SHARES {
            let last = self.read_all(shares, side).len().saturating_sub(1);
            if self.is_free(shares, side) {
                let others = (0..last).map(|i| numbers.get(side, shares, i)).sum();
                numbers.set(side, shares, last, T::ONE - others);
            }
        }
        let levels_move = self.is_free("f_c", side) || self.is_free("sigma0", side);
        if levels_move && !self.is_free("z_ba", side) && !self.read_all("z_ba", side).is_empty() {
            let share = self.companion("z_ba", side) * self.companion("sigma0", side)
                / self.companion("f_c", side);
            let get = |name| numbers.get(side, name, 0);
            let deflection = T::of(share) * get("f_c") / get("sigma0");
            numbers.set(side, "z_ba", 0, deflection);
        }
        // Static friction that is not free moves with the kinetic one where it would fall below.
        if self.is_free("f_c", side) && !self.is_free("f_s", side) {
            let (f_s, f_c) = (numbers.get(side, "f_s", 0), numbers.get(side, "f_c", 0));
            if f_s < f_c {
                numbers.set(side, "f_s", 0, f_c);
            }
        }
    }
}
