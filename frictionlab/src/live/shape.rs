//! The reference of a live run, which changes while it runs: a change is blended in, so that
//! neither position nor velocity nor acceleration jumps.

use std::f64::consts::TAU;

use controller::Reference;

/// Shortest time in which a change is blended in \[s\].
const BLEND: f64 = 1.0;
/// Mean speed at which a change of place is blended in \[rad/s\].
const PACE: f64 = 0.5;

/// What a reference looks like.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, strum::EnumString, strum::IntoStaticStr, strum::VariantNames,
)]
#[strum(serialize_all = "snake_case")]
pub(super) enum Kind {
    /// A velocity that is a sine about an offset [rad/s].
    VelocitySine,
    /// A position that is a sine about an offset \[rad\].
    PositionSine,
    /// A velocity that stays: the offset [rad/s].
    ConstantVelocity,
}

/// A reference with its numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shape {
    pub(super) kind: Kind,
    /// Of the sine [rad/s] or \[rad\].
    pub(super) amplitude: f64,
    /// Angular frequency of the sine, above zero [rad/s].
    pub(super) frequency: f64,
    /// What it is about [rad/s] or \[rad\].
    pub(super) offset: f64,
}

/// A shape that began at some time.
#[derive(Debug, Clone, Copy)]
struct Begun {
    shape: Shape,
    /// When \[s\].
    at: f64,
    /// Where it began \[rad\].
    position: f64,
    /// Phase of the sine then \[rad\].
    phase: f64,
}

/// The reference over time.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course {
    now: Begun,
    /// What was before, while it is still blended out.
    blend: Option<Blend>,
    /// What it becomes once that is done.
    wanted: Option<Shape>,
}

/// A change that is underway.
#[derive(Debug, Clone, Copy)]
struct Blend {
    from: Begun,
    /// How long it takes \[s\].
    duration: f64,
    by: By,
}

/// What is blended.
#[derive(Debug, Clone, Copy)]
enum By {
    /// The place: velocity and acceleration follow from it.
    Place,
    /// The velocity. The place follows from it: where the reference was last \[rad\], when \[s\] and
    /// how fast [rad/s].
    Velocity { place: f64, time: f64, velocity: f64 },
}

impl Shape {
    /// The fastest that it ever is [rad/s].
    pub(super) fn fastest(&self) -> f64 {
        match self.kind {
            Kind::VelocitySine => self.amplitude.abs() + self.offset.abs(),
            Kind::PositionSine => (self.amplitude * self.frequency).abs(),
            Kind::ConstantVelocity => self.offset.abs(),
        }
    }
}

impl Begun {
    fn at(&self, time: f64) -> Reference {
        let Shape { kind, amplitude, frequency: w, offset } = self.shape;
        let t = time - self.at;
        let (sin, cos) = (w * t + self.phase).sin_cos();
        match kind {
            Kind::VelocitySine => Reference {
                position: self.position + amplitude / w * (self.phase.cos() - cos) + offset * t,
                velocity: amplitude * sin + offset,
                acceleration: amplitude * w * cos,
            },
            Kind::PositionSine => Reference {
                position: self.position + amplitude * sin + offset,
                velocity: amplitude * w * cos,
                acceleration: -amplitude * w * w * sin,
            },
            Kind::ConstantVelocity => Reference {
                position: self.position + offset * t,
                velocity: offset,
                acceleration: 0.0,
            },
        }
    }

    /// Another shape from that time on. A sine goes on where it was; a position that was none begins
    /// where the reference is.
    fn followed_by(&self, shape: Shape, time: f64, position: f64) -> Self {
        let is_sine = |kind| kind != Kind::ConstantVelocity;
        let goes_on =
            self.shape.kind == shape.kind || is_sine(self.shape.kind) && is_sine(shape.kind);
        let phase = (self.shape.frequency * (time - self.at) + self.phase).rem_euclid(TAU);
        let of_places = (self.shape.kind, shape.kind) == (Kind::PositionSine, Kind::PositionSine);
        Self {
            shape,
            at: time,
            position: if of_places { self.position } else { position },
            phase: if goes_on { phase } else { 0.0 },
        }
    }
}

impl Course {
    /// A shape from time zero and place zero on.
    pub(super) const fn new(shape: Shape) -> Self {
        let now = Begun { shape, at: 0.0, position: 0.0, phase: 0.0 };
        Self { now, blend: None, wanted: None }
    }

    /// The reference at a time \[s\], no earlier than the one asked for before.
    pub(super) fn at(&mut self, time: f64) -> Reference {
        if let Some(blend) = self.blend
            && time - self.now.at >= blend.duration
        {
            self.blend = None;
            if let By::Velocity { place, time: last, velocity } = blend.by {
                // It goes on from where it came to.
                let now = self.now.at(time);
                let there = place + 0.5 * (velocity + now.velocity) * (time - last);
                self.now.position += there - now.position;
            }
        }
        if self.blend.is_none()
            && let Some(shape) = self.wanted.take()
        {
            self.begin(shape, time);
        }
        let now = self.now.at(time);
        let Some(Blend { from, duration, by }) = &mut self.blend else { return now };
        let s = ((time - self.now.at) / *duration).clamp(0.0, 1.0);
        let from = from.at(time);
        match by {
            By::Place => blended(&from, &now, s, *duration),
            By::Velocity { place, time: last, velocity } => {
                let (share, rate, _) = shares(s, *duration);
                let drift = now.velocity - from.velocity;
                let fast = from.velocity + share * drift;
                *place += 0.5 * (*velocity + fast) * (time - *last);
                (*last, *velocity) = (time, fast);
                Reference {
                    position: *place,
                    velocity: fast,
                    acceleration: from.acceleration
                        + share * (now.acceleration - from.acceleration)
                        + rate * drift,
                }
            }
        }
    }

    fn begin(&mut self, shape: Shape, time: f64) {
        let Reference { position: place, velocity, .. } = self.now.at(time);
        let now = self.now.followed_by(shape, time, place);
        let (duration, by) = if shape.kind == Kind::PositionSine {
            let gap = (now.at(time).position - place).abs();
            (BLEND.max(gap / PACE), By::Place)
        } else {
            (BLEND, By::Velocity { place, time, velocity })
        };
        self.blend = Some(Blend { from: self.now, duration, by });
        self.now = now;
    }

    /// Becomes another shape, once the change before it is done; of several the last.
    pub(super) fn change(&mut self, shape: Shape) {
        self.wanted = Some(shape);
    }
}

/// How much of a change is done after `s` of its time, how fast that grows [1/s], and how fast that
/// does [1/s^2]: a curve that begins and ends at rest (as
/// [`MovePosition`](experiment_runner::waveform::Waveform::MovePosition)).
fn shares(s: f64, duration: f64) -> (f64, f64, f64) {
    let rest = 1.0 - s;
    let share = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    let rate = 30.0 * s * s * rest * rest / duration;
    let bend = 60.0 * s * rest * (1.0 - 2.0 * s) / (duration * duration);
    (share, rate, bend)
}

/// `s` of the way from one place to another.
fn blended(from: &Reference, to: &Reference, s: f64, duration: f64) -> Reference {
    let (share, rate, bend) = shares(s, duration);
    let gap = to.position - from.position;
    let drift = to.velocity - from.velocity;
    Reference {
        position: from.position + share * gap,
        velocity: from.velocity + share * drift + rate * gap,
        acceleration: from.acceleration
            + share * (to.acceleration - from.acceleration)
            + 2.0 * rate * drift
            + bend * gap,
    }
}

#[cfg(test)]
mod tests {
    use experiment_runner::waveform::Waveform;

    use super::*;

    const SINE: Shape =
        Shape { kind: Kind::VelocitySine, amplitude: 0.3, frequency: 0.7, offset: 0.0 };

    #[test]
    fn before_any_change_it_is_the_waveform_to_the_last_bit() {
        let (amplitude, angular_frequency) = (0.3, 0.7);
        let cases = [
            (SINE, Waveform::SineVelocity { amplitude, angular_frequency }),
            (
                Shape { kind: Kind::PositionSine, ..SINE },
                Waveform::SinePosition { amplitude, angular_frequency },
            ),
            (
                Shape { kind: Kind::ConstantVelocity, offset: 1.5, ..SINE },
                Waveform::ConstantVelocity { velocity: 1.5 },
            ),
        ];
        for (shape, waveform) in cases {
            let mut course = Course::new(shape);
            for step in 0..5000 {
                let time = f64::from(step) * 1e-3;
                assert_eq!(course.at(time), waveform.at(time), "{shape:?} at {time}");
            }
        }
    }

    /// Whatever is changed, and however often: position, velocity and acceleration never jump, and
    /// each is the derivative of the one before it.
    #[test]
    fn a_change_never_jumps() {
        const STEP: f64 = 1e-3;
        let mut course = Course::new(SINE);
        let changes = [
            (700, Shape { amplitude: 1.0, ..SINE }),
            (900, Shape { kind: Kind::PositionSine, amplitude: 0.5, frequency: 2.0, offset: 0.0 }),
            (1200, Shape { kind: Kind::PositionSine, amplitude: 0.5, frequency: 2.0, offset: 3.0 }),
            (9000, Shape { kind: Kind::PositionSine, amplitude: 0.2, frequency: 5.0, offset: 3.0 }),
            (12_000, Shape { kind: Kind::ConstantVelocity, offset: -1.0, ..SINE }),
            (
                14_000,
                Shape { kind: Kind::VelocitySine, amplitude: 1.0, frequency: 1.0, offset: 0.5 },
            ),
        ];
        let mut before = course.at(0.0);
        for step in 1..20_000 {
            for (_, shape) in changes.iter().filter(|(at, _)| *at == step) {
                course.change(*shape);
            }
            let now = course.at(f64::from(step) * STEP);
            let mean = 0.5 * (now.velocity + before.velocity);
            assert!(((now.position - before.position) / STEP - mean).abs() < 1e-4, "{step}");
            let mean = 0.5 * (now.acceleration + before.acceleration);
            assert!(((now.velocity - before.velocity) / STEP - mean).abs() < 1e-2, "{step}");
            assert!((now.acceleration - before.acceleration).abs() < 0.1, "{step}");
            // A far place is gone to no faster than so.
            assert!(now.velocity.abs() < 4.0, "{step}: {now:?}");
            before = now;
        }
        // From one constant velocity to another there is nothing beyond either.
        let constant = |offset| Shape { kind: Kind::ConstantVelocity, offset, ..SINE };
        let mut level = Course::new(constant(-1.0));
        level.at(0.0);
        level.change(constant(0.5));
        let between = |velocity: f64| (-1.0..=0.5).contains(&velocity);
        assert!((1..2000).all(|step| between(level.at(f64::from(step) * STEP).velocity)));
        // The last one counts, and goes on where the shaft was to be.
        let peak = (20_000..30_000).map(|step| course.at(f64::from(step) * STEP).velocity);
        let peak = peak.fold(0.0, f64::max);
        assert!((peak - 1.5).abs() < 1e-3, "{peak}");
    }
}
