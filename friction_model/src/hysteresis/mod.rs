//! Hysteresis with non-local memory: a virgin curve, Masing's doubling and a stack of reversal
//! points.
//!
//! From a reversal point `(z_r, f_r)` the force follows the virgin curve `f` doubled in both
//! directions, in direction `s = +-1`:
//!
//! ```text
//! F = f_r + 2 s f( s (z - z_r) / 2 )                          (thesis eq. 3.53)
//! ```
//!
//! until the branch meets the point from which the previous one started; there the inner loop is
//! closed and forgotten (wiping-out), and the outer branch goes on as if nothing had happened. The
//! first branch closes at the mirror image of its reversal point, on the virgin curve. Loops
//! therefore close exactly, and congruent loops have the same shape wherever they lie. The operator
//! equals a Prandtl-Ishlinskii operator with weight `w(r) = -f''(r)`.

use crate::Real;
use crate::arithmetic::saturate;

/// A concave odd curve that a contact follows when it is loaded for the first time.
pub trait VirginCurve<T: Real = f64> {
    /// Force on the virgin curve at deflection `z`, for `|z| <= limit`.
    fn force(&self, z: T) -> T;

    /// `stretch f(shrink z)`; both factors are powers of two, or their negatives.
    #[inline]
    fn stretched(&self, stretch: T, shrink: T, z: T) -> T {
        stretch * self.force(shrink * z)
    }

    /// Slope `f'(z)`, for `|z| <= limit`; even, and falling with `|z|`.
    fn slope(&self, z: T) -> T;

    /// `int_0^z f`, for `|z| <= limit`; even.
    fn integral(&self, z: T) -> T;

    /// Largest deflection: beyond it the contact slides and the memory is empty.
    fn limit(&self) -> T;
}

/// Deepest nesting kept. A noisy sine of 200 000 samples reaches a depth of 19; only a strictly
/// nested sequence grows without end.
pub const CAPACITY: usize = 120;

#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Point<T: Real = f64> {
    z: T,
    f: T,
}

/// A branch between two turns: the virgin curve, or its double from a reversal on. Along it the
/// force is `F = f_r + stretch f(shrink (z - z_r))`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Course<T: Real = f64> {
    /// Direction: -1, 0 before the first motion, or 1.
    s: T,
    /// The reversal from which it starts; zero for the virgin curve.
    origin: Point<T>,
    /// Where it meets the point from which the previous branch started; infinitely far for the
    /// virgin curve.
    closes_at: T,
    /// `s` for the virgin curve, `2 s` for a doubled one; and the inverse.
    stretch: T,
    shrink: T,
}

impl<T: Real> Course<T> {
    /// The branch in direction `s` with the reversals `points` behind it.
    #[inline]
    fn behind(points: &[Point<T>], s: T) -> Self {
        match points {
            [] => Self {
                s,
                origin: Point::default(),
                closes_at: s * T::infinity(),
                stretch: s,
                shrink: s,
            },
            [origin] => Self::from(*origin, -origin.z, s),
            [.., start, origin] => Self::from(*origin, start.z, s),
        }
    }

    #[inline]
    fn from(origin: Point<T>, closes_at: T, s: T) -> Self {
        Self { s, origin, closes_at, stretch: T::TWO * s, shrink: T::HALF * s }
    }

    /// Whether it is still open at `z`; false before the first motion.
    #[inline(always)]
    fn is_open_at(&self, z: T) -> bool {
        self.s * (z - self.closes_at) < T::ZERO
    }

    /// Direction in which it is followed: -1, 0 before the first motion, or 1.
    #[must_use]
    pub const fn direction(&self) -> T {
        self.s
    }

    /// Deflection \[m or rad\] and force \[N or N m\] of the reversal `(z_r, f_r)` from which it
    /// starts; zero for the virgin curve.
    #[must_use]
    pub const fn origin(&self) -> (T, T) {
        (self.origin.z, self.origin.f)
    }

    /// The deflection at which it has closed \[m or rad\]; infinitely far for the virgin curve.
    #[must_use]
    pub const fn closes_at(&self) -> T {
        self.closes_at
    }

    /// Factor of the virgin curve's force, and of its deflection.
    #[must_use]
    pub const fn factors(&self) -> (T, T) {
        (self.stretch, self.shrink)
    }

    #[inline(always)]
    fn force(&self, curve: &impl VirginCurve<T>, z: T) -> T {
        self.origin.f + curve.stretched(self.stretch, self.shrink, z - self.origin.z)
    }
}

/// The memory of reversal points. Starts unloaded, with nothing to remember.
///
/// When the stack is full the two innermost points, one closed loop, are dropped: the error is at
/// most that loop.
#[derive(Debug, Clone)]
pub struct Hysteresis<T: Real = f64> {
    last: Point<T>,
    /// The present branch. It follows from the points, and is kept because most moves stay on it.
    course: Course<T>,
    /// Number of reversal points remembered.
    depth: usize,
    points: [Point<T>; CAPACITY],
}

impl<T: Real> Default for Hysteresis<T> {
    fn default() -> Self {
        let (last, course) = (Point::default(), Course::default());
        Self { last, course, depth: 0, points: [Point::default(); CAPACITY] }
    }
}

impl<T: Real> PartialEq for Hysteresis<T> {
    /// Two memories are equal when they remember the same points; what lies above the stack's top
    /// does not count.
    fn eq(&self, other: &Self) -> bool {
        self.course.s == other.course.s
            && self.last == other.last
            && self.reversals() == other.reversals()
    }
}

impl<T: Real> Hysteresis<T> {
    /// Force at deflection `z`, which is cut to the curve's limit. The memory does not change: for
    /// the stages of an integrator.
    #[inline(always)]
    #[must_use]
    pub fn peek(&self, curve: &impl VirginCurve<T>, z: T) -> T {
        let z = saturate(curve.limit(), z);
        if z == self.last.z {
            self.last.f
        } else if self.goes_on_to(z) {
            self.course.force(curve, z)
        } else {
            self.turn(z).0.force(curve, z)
        }
    }

    /// Moves to deflection `z`, remembers reversals, forgets closed loops, and returns the force
    /// there.
    #[inline(always)]
    pub fn commit(&mut self, curve: &impl VirginCurve<T>, z: T) -> T {
        let z = saturate(curve.limit(), z);
        if z == self.last.z {
            return self.last.f;
        }
        if !self.goes_on_to(z) {
            self.take_turn(z);
        }
        let f = self.course.force(curve, z);
        self.last = Point { z, f };
        f
    }

    /// Whether a move to `z` stays on the present branch.
    #[inline(always)]
    fn goes_on_to(&self, z: T) -> bool {
        self.course.s * (z - self.last.z) > T::ZERO && self.course.is_open_at(z)
    }

    #[inline(never)]
    fn take_turn(&mut self, z: T) {
        let (course, depth) = self.turn(z);
        (self.course, self.depth) = (course, depth);
        // The reversal from which the new branch starts; an old one stands there already.
        if let Some(top) = depth.checked_sub(1).and_then(|top| self.points.get_mut(top)) {
            *top = course.origin;
        }
    }

    /// The branch on which `z` lies, which differs from the last deflection, and how many reversals
    /// are behind it: a branch that has reached the point where it closes is forgotten together
    /// with the one that it closes.
    #[inline(never)]
    fn turn(&self, z: T) -> (Course<T>, usize) {
        let s = if z > self.last.z { T::ONE } else { -T::ONE };
        let mut points = self.reversals();
        if self.course.s == -s {
            // The branch that starts here, then those that are open behind it. A full stack loses
            // its innermost loop for it.
            if points.len() == CAPACITY {
                points = without(points, 2);
            }
            let closes_at = points.last().map_or(-self.last.z, |point| point.z);
            let course = Course::from(self.last, closes_at, s);
            if course.is_open_at(z) {
                return (course, points.len() + 1);
            }
            points = without(points, 1);
        }
        loop {
            let course = Course::behind(points, s);
            if points.is_empty() || course.is_open_at(z) {
                return (course, points.len());
            }
            points = without(points, 2);
        }
    }

    /// The reversal points remembered, the latest one last.
    #[inline]
    fn reversals(&self) -> &[Point<T>] {
        self.points.get(..self.depth).unwrap_or(&self.points)
    }

    /// Slope at the last committed deflection towards `direction`: of the present branch, or of a
    /// new one where that turns.
    #[inline]
    #[must_use]
    pub fn slope(&self, curve: &impl VirginCurve<T>, direction: T) -> T {
        if self.course.s * direction > T::ZERO {
            curve.slope(self.course.shrink * (self.last.z - self.course.origin.z))
        } else {
            curve.slope(T::ZERO)
        }
    }

    /// The present branch.
    #[must_use]
    pub const fn course(&self) -> &Course<T> {
        &self.course
    }

    /// Takes it that the present branch was followed to the deflection `z` \[m or rad\], where its
    /// force is `f` \[N or N m\]: for whoever follows a branch himself, and calls
    /// [`commit`](Self::commit) where it ends.
    pub const fn follow(&mut self, z: T, f: T) {
        self.last = Point { z, f };
    }

    /// Force at the last committed deflection.
    #[must_use]
    pub const fn force(&self) -> T {
        self.last.f
    }

    /// The last committed deflection.
    #[must_use]
    pub const fn deflection(&self) -> T {
        self.last.z
    }

    /// Energy stored \[J\]: that of the Prandtl-Ishlinskii stops, `1/2 int w(r) s_r^2 dr` with
    /// `w = -f''`.
    ///
    /// The stop of threshold `r` was last cut at the latest reversal whose branch is longer than
    /// `2 r`; since then it has moved with the deflection. So the reversals divide the thresholds
    /// into intervals on which `s_r` is linear in `r`.
    #[must_use]
    pub fn stored_energy(&self, curve: &impl VirginCurve<T>) -> T {
        let limit = curve.limit();
        // 1/2 int_r0^r1 w(r) (offset + side r)^2 dr, by parts.
        let share = |r0: T, r1: T, side: T, offset: T| {
            let at = |r: T| {
                let stop = offset + side * r;
                -curve.slope(r) * stop * stop + T::TWO * side * curve.force(r) * stop
                    - T::TWO * side * side * curve.integral(r)
            };
            if r1 > r0 { T::HALF * (at(r1) - at(r0)) } else { T::ZERO }
        };
        let z = self.last.z;
        let mut side = self.course.s;
        let mut energy = T::ZERO;
        let (mut from, mut cut_at) = (T::ZERO, z);
        for &Point { z: reversal, .. } in self.reversals().iter().rev() {
            let to = T::HALF * (cut_at - reversal).abs();
            energy += share(from, to, side, z - cut_at);
            (from, cut_at, side) = (to, reversal, -side);
        }
        let virgin = cut_at.abs();
        energy += share(from, virgin, side, z - cut_at);
        // Stops that were never cut, and those at the curve's end with what slope is left there.
        energy + share(virgin, limit, T::ZERO, z) + T::HALF * curve.slope(limit) * z * z
    }

    /// Number of reversal points remembered.
    #[must_use]
    pub const fn depth(&self) -> usize {
        self.depth
    }
}

/// `points` without its last `n`; all are gone where there are fewer.
#[inline]
fn without<T: Real>(points: &[Point<T>], n: usize) -> &[Point<T>] {
    points.get(..points.len().saturating_sub(n)).unwrap_or(&[])
}

#[cfg(test)]
mod tests;
