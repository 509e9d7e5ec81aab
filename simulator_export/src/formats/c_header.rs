//! A C header for firmware: the step of [`Scheme::Held`](friction_model::Scheme::Held), the same
//! formulas in the same order.
//!
//! Real numbers are `float` unless whoever includes the header says otherwise. The period is an
//! argument, so that one header serves any loop; the exact step is stable at any period. A velocity
//! that is no number counts as zero, and one beyond 1e6 is cut to it, as in the library.

use std::fmt::Write;

use friction_model::{AnyModel, AnyParameters, ModelName};

use super::{Drive, identifier, number};
use crate::head::Comments;

/// Whether there is a step of the model itself.
pub(super) fn has(model: &AnyModel) -> bool {
    match model.name() {
        ModelName::Coulomb
        | ModelName::Viscous
        | ModelName::CoulombViscous
        | ModelName::Stribeck
        | ModelName::LuGre => true,
        ModelName::Dahl => {
            let (forward, backward) = model.parameters().sides();
            [forward, backward].iter().all(|side| side.values("delta") == [1.0])
        }
        _ => false,
    }
}

/// One direction's numbers, as LuGre has them; a contact without pre-sliding has no stiffness.
struct Side {
    f_s: f64,
    f_c: f64,
    v_s: f64,
    delta: f64,
    sigma0: f64,
    sigma1: f64,
    v_d: f64,
    f_v: f64,
}

impl Side {
    fn of(parameters: &AnyParameters) -> Self {
        let value = |name: &str| parameters.values(name).first().copied();
        let f_c = value("f_c").unwrap_or(0.0);
        let is_dahl = parameters.name() == ModelName::Dahl;
        Self {
            f_s: value("f_s").unwrap_or(f_c),
            f_c,
            v_s: value("v_s").unwrap_or(1.0),
            delta: value("delta").filter(|_| !is_dahl).unwrap_or(2.0),
            sigma0: value("sigma0").unwrap_or(0.0),
            sigma1: value("sigma1").unwrap_or(0.0),
            v_d: value("v_d").unwrap_or(0.0),
            f_v: value("f_v").unwrap_or(0.0),
        }
    }

    fn values(&self) -> [(&'static str, f64, &'static str); 8] {
        [
            ("f_s", self.f_s, "static level"),
            ("f_c", self.f_c, "kinetic level"),
            ("v_s", self.v_s, "Stribeck velocity"),
            ("delta", self.delta, "exponent of the Stribeck curve"),
            ("sigma0", self.sigma0, "stiffness in pre-sliding; 0: none"),
            ("sigma1", self.sigma1, "micro-damping"),
            ("v_d", self.v_d, "speed at which the micro-damping has fallen to 1/e; 0: constant"),
            ("f_v", self.f_v, "viscous coefficient"),
        ]
    }
}

pub(super) fn render(drive: &Drive<'_>) -> String {
    let model = drive.contact.model().unwrap_or(drive.given.model);
    let (forward, backward) = model.parameters().sides();
    let asymmetric = matches!(model.parameters(), AnyParameters::Asymmetric(_));
    let prefix = identifier(&drive.options.joint);
    let guard = format!("FRICTION_{}_H", prefix.to_uppercase());
    let axis = drive.given.axis;
    let mut head = drive.head.clone();
    head.push(format!(
        "Units: {}, {}, s. Friction opposes motion: to compensate it, add it to what drives the joint.",
        axis.effort(),
        axis.travel()
    ));
    head.push(
        "Real numbers are float; define FRICTION_REAL, FRICTION_EXP, FRICTION_POW and FRICTION_ABS for others."
            .to_owned(),
    );
    let mut text = Comments::C.around(&head);
    // Writing to a string cannot fail.
    let _ = write!(text, "#ifndef {guard}\n#define {guard}\n\n{PRELUDE}\n");
    let mut side = |name: &str, parameters: &AnyParameters| {
        let _ = writeln!(text, "/* {name} */\nstatic const friction_side {prefix}_{name} = {{");
        for (field, value, meaning) in Side::of(parameters).values() {
            let _ =
                writeln!(text, "    (FRICTION_REAL){}, /* {field}: {meaning} */", number(value));
        }
        text.push_str("};\n\n");
    };
    if asymmetric {
        side("forward", &forward);
        side("backward", &backward);
    } else {
        side("both", &forward);
    }
    text.push_str(&if asymmetric { ASYMMETRIC } else { SYMMETRIC }.replace("PREFIX", &prefix));
    let _ = writeln!(text, "\n#endif /* {guard} */");
    text
}

/// What every such header has, once for all that are included.
const PRELUDE: &str = "\
#include <math.h>

#ifndef FRICTION_REAL
#define FRICTION_REAL float
#define FRICTION_EXP expf
#define FRICTION_POW powf
#define FRICTION_ABS fabsf
#endif

#ifndef FRICTION_STEP
#define FRICTION_STEP

/* One direction's parameters. */
typedef struct {
    FRICTION_REAL f_s, f_c, v_s, delta, sigma0, sigma1, v_d, f_v;
} friction_side;

/* The deflection of the contact; all zero is at rest and unloaded. */
typedef struct {
    FRICTION_REAL z[2];
} friction_state;

/* A velocity that the formulas take: no number counts as 0, more than 1e6 as 1e6. */
static inline FRICTION_REAL friction_bounded(FRICTION_REAL v)
{
    const FRICTION_REAL most = (FRICTION_REAL)1e6;
    if (v != v) {
        return (FRICTION_REAL)0;
    }
    return v > most ? most : v < -most ? -most : v;
}

/* The friction of one contact now at v; its deflection then moves on by dt under v. */
static inline FRICTION_REAL friction_contact(const friction_side *p, FRICTION_REAL *z, FRICTION_REAL v,
                                             FRICTION_REAL dt)
{
    const FRICTION_REAL zero = (FRICTION_REAL)0;
    const FRICTION_REAL speed = FRICTION_ABS(v);
    FRICTION_REAL r = v / p->v_s;
    const FRICTION_REAL power =
        p->delta == (FRICTION_REAL)2 ? r * r : FRICTION_POW(FRICTION_ABS(r), p->delta);
    const FRICTION_REAL g = p->f_c + (p->f_s - p->f_c) * FRICTION_EXP(-power);
    FRICTION_REAL rate, steady, damping, now;
    if (p->sigma0 <= zero) {
        return (v > zero ? g : v < zero ? -g : zero) + p->f_v * v;
    }
    rate = p->sigma0 * speed / g;
    steady = v < zero ? -g / p->sigma0 : g / p->sigma0;
    damping = p->sigma1;
    if (p->v_d > zero) {
        r = v / p->v_d;
        damping *= FRICTION_EXP(-r * r);
    }
    now = *z;
    *z = steady + (now - steady) * FRICTION_EXP(-rate * dt);
    return p->sigma0 * now + damping * (v - rate * now) + p->f_v * v;
}

#endif /* FRICTION_STEP */
";

const SYMMETRIC: &str = "\
/* The friction now at the velocity v; the state then moves on by dt [s]. Call it once a period. */
static inline FRICTION_REAL PREFIX_friction_step(friction_state *state, FRICTION_REAL v, FRICTION_REAL dt)
{
    return friction_contact(&PREFIX_both, &state->z[0], friction_bounded(v), dt);
}
";

const ASYMMETRIC: &str = "\
/* The friction now at the velocity v; the state then moves on by dt [s]. Call it once a period. Two
 * contacts run under the same motion: one carries the positive forces, the other the negative. */
static inline FRICTION_REAL PREFIX_friction_step(friction_state *state, FRICTION_REAL v, FRICTION_REAL dt)
{
    const FRICTION_REAL zero = (FRICTION_REAL)0, speed = friction_bounded(v);
    const FRICTION_REAL forward = friction_contact(&PREFIX_forward, &state->z[0], speed, dt);
    const FRICTION_REAL backward = friction_contact(&PREFIX_backward, &state->z[1], speed, dt);
    return (forward > zero ? forward : zero) + (backward < zero ? backward : zero);
}
";
