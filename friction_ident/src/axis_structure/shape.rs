//! The parameters that enter the axis model nonlinearly, and where they may lie.

use serde::Serialize;

use super::AxisStructure;
use crate::bounded::Bound;
use crate::conditioning::Conditioned;

/// Longest delay that is considered, and longest lag of the recorded force, in samples.
pub(crate) const LONGEST_DELAY: usize = 10;

/// Share of the largest speed up to which a Stribeck velocity is looked for, and how much further the
/// search may go from there.
const LIKELY: f64 = 0.25;
const BROADEST: f64 = 2.0;

/// The least `f_s` over `f_c` that a bristle that lags follows, and one over the largest.
const LEAST_RATIO: f64 = 0.2;

/// What made a recorded force late.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Late {
    /// All of it by the same time.
    #[default]
    Delayed,
    /// A low-pass of the first order, as drives have for their measured current or torque; the time is
    /// its time constant.
    LowPassed,
}

/// Values of the nonlinear parameters; those that a structure does not have have no effect.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Shape {
    /// How much later the force acts than it was recorded \[s\]; below zero, it was recorded late.
    pub delay: f64,
    /// What made it late, where it was.
    pub late: Late,
    /// Stribeck velocity v_s \[m/s or rad/s\].
    pub v_s: f64,
    /// Displacement over which the bristle force rises to 63 % of its limit \[m or rad\]: Coulomb
    /// level over stiffness.
    pub displacement: f64,
    /// Length along the axis after which the harmonic force repeats \[m or rad\].
    pub period: f64,
    /// `f_s` over `f_c` that the limit of a bristle that lags is made of: no parameter of its own, it
    /// follows the levels as they are fitted.
    pub ratio: f64,
    /// `sigma1` over `f_c` of such a bristle \[s/m or s/rad\], which follows the fit as the ratio does.
    pub damped: f64,
}

impl Shape {
    /// Values for structures that have none of them.
    pub const UNUSED: Self = Self {
        delay: 0.0,
        late: Late::Delayed,
        v_s: 1.0,
        displacement: 1.0,
        period: 1.0,
        ratio: 1.0,
        damped: 0.0,
    };
}

/// One nonlinear parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ShapeTerm {
    Delay,
    StribeckVelocity,
    Displacement,
    Period,
    /// Of the levels of a dip that lags, while it is searched; what is told are the levels.
    Ratio,
}

impl ShapeTerm {
    /// Those of a structure that are parameters of it.
    pub fn of(structure: &AxisStructure) -> Vec<Self> {
        let all = [
            (structure.delay, Self::Delay),
            (structure.stribeck, Self::StribeckVelocity),
            (structure.presliding, Self::Displacement),
            (structure.harmonic, Self::Period),
        ];
        all.into_iter().filter_map(|(has, term)| has.then_some(term)).collect()
    }

    pub fn value(self, shape: &Shape) -> f64 {
        match self {
            Self::Delay => shape.delay,
            Self::StribeckVelocity => shape.v_s,
            Self::Displacement => shape.displacement,
            Self::Period => shape.period,
            Self::Ratio => shape.ratio,
        }
    }

    pub fn set(self, shape: &mut Shape, value: f64) {
        match self {
            Self::Delay => shape.delay = value,
            Self::StribeckVelocity => shape.v_s = value,
            Self::Displacement => shape.displacement = value,
            Self::Period => shape.period = value,
            Self::Ratio => shape.ratio = value,
        }
    }

    /// The unknown that the search moves: the delay itself, else the logarithm.
    pub fn unknown(self, value: f64) -> f64 {
        if self == Self::Delay { value } else { value.ln() }
    }

    /// Derivative of the value with respect to the unknown.
    pub fn stretch(self, value: f64) -> f64 {
        if self == Self::Delay { 1.0 } else { value }
    }

    /// Inverse of [`unknown`](Self::unknown).
    pub fn natural(self, unknown: f64) -> f64 {
        if self == Self::Delay { unknown } else { unknown.exp() }
    }
}

/// Where the nonlinear parameters may lie for one recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limits {
    pub low: Shape,
    pub high: Shape,
    time_step: f64,
}

impl Limits {
    pub fn of(recording: &Conditioned) -> Self {
        let fastest = recording.velocity.iter().fold(0.0f64, |most, v| most.max(v.abs()));
        let (mut low, mut high, mut x) = (0.0f64, 0.0f64, 0.0f64);
        for v in &recording.velocity {
            x += v * recording.time_step;
            (low, high) = (low.min(x), high.max(x));
        }
        let travel = (high - low).max(f64::MIN_POSITIVE);
        let fastest = fastest.max(f64::MIN_POSITIVE);
        Self {
            low: Shape {
                delay: -(LONGEST_DELAY as f64) * recording.time_step,
                late: Late::Delayed,
                v_s: 5e-3 * fastest,
                displacement: 1e-6 * travel,
                period: travel / 200.0,
                ratio: LEAST_RATIO,
                damped: 0.0,
            },
            high: Shape {
                delay: LONGEST_DELAY as f64 * recording.time_step,
                late: Late::Delayed,
                v_s: BROADEST * LIKELY * fastest,
                displacement: 0.1 * travel,
                period: 2.0 * travel,
                ratio: 1.0 / LEAST_RATIO,
                damped: 0.0,
            },
            time_step: recording.time_step,
        }
    }

    /// Where a search begins that knows nothing.
    pub fn start(&self) -> Shape {
        let middle = |low: f64, high: f64| (low * high).sqrt();
        Shape {
            delay: 0.5 * self.time_step,
            late: Late::Delayed,
            v_s: middle(self.low.v_s, self.high.v_s / BROADEST),
            displacement: middle(self.low.displacement, self.high.displacement),
            period: middle(self.low.period, self.high.period),
            ratio: 1.0,
            damped: 0.0,
        }
    }

    /// `count` values from end to end: evenly in the logarithm, or in turns per length for a
    /// period. Of Stribeck velocities the likely ones.
    pub fn grid(&self, term: ShapeTerm, count: usize) -> Vec<f64> {
        let (low, mut high) = (term.value(&self.low), term.value(&self.high));
        if term == ShapeTerm::StribeckVelocity {
            high /= BROADEST;
        }
        let part = |i: usize| i as f64 / count.saturating_sub(1).max(1) as f64;
        (0..count)
            .map(|i| match term {
                ShapeTerm::Delay => low + part(i) * (high - low),
                ShapeTerm::Period => 1.0 / (1.0 / high + part(i) * (1.0 / low - 1.0 / high)),
                _ => low * (high / low).powf(part(i)),
            })
            .collect()
    }

    pub fn bound(&self, term: ShapeTerm) -> Bound {
        let scale = if term == ShapeTerm::Delay { self.time_step } else { 1.0 };
        Bound::within(
            term.unknown(term.value(&self.low)),
            term.unknown(term.value(&self.high)),
            scale,
        )
    }
}

/// How positions are scaled for the polynomials: -1 to 1 over the estimation recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PositionScale {
    /// Middle of the stretch \[m or rad\].
    pub middle: f64,
    /// Half its length \[m or rad\].
    pub half: f64,
}

impl PositionScale {
    pub(super) fn of(recording: &Conditioned) -> Self {
        let position = recording.position.as_deref().unwrap_or_default();
        let low = position.iter().copied().fold(f64::INFINITY, f64::min);
        let high = position.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if high > low {
            Self { middle: 0.5 * (low + high), half: 0.5 * (high - low) }
        } else {
            Self { middle: 0.0, half: 1.0 }
        }
    }

    pub(super) fn normalised(&self, x: f64) -> f64 {
        (x - self.middle) / self.half
    }
}
