//! The gains of a feedforward `u = kS sgn(v) + kV v + kA a`, as JSON: as torque, or as volts.

use serde_json::{Map, Value, json};

use super::{Drive, coulomb_viscous};

pub(super) fn render(drive: &Drive<'_>) -> String {
    let (f_c, f_v) = coulomb_viscous(drive.contact);
    let axis = drive.given.axis;
    let options = drive.options;
    let scale = options.volts.map_or(1.0, |volts| volts.per_effort);
    let back_emf = options.volts.map_or(0.0, |volts| volts.back_emf);
    let unit = if options.volts.is_some() || drive.given.volts { "V" } else { axis.effort() };
    let travel = axis.travel();
    let mut tree = Map::new();
    tree.insert("about".to_owned(), json!(drive.head));
    let mut gain = |name: &str, value: f64, unit: String| {
        tree.insert(name.to_owned(), json!(value));
        tree.insert(format!("{name}_unit"), json!(unit));
    };
    gain("kS", scale * f_c, unit.to_owned());
    gain("kV", scale * f_v + back_emf, format!("{unit} s/{travel}"));
    if let Some(inertia) = options.inertia {
        gain("kA", scale * inertia, format!("{unit} s^2/{travel}"));
    }
    let cost = &drive.cost;
    tree.insert(
        "error_percent_of_coulomb_level".to_owned(),
        json!({
            "sliding_rms": cost.percent(cost.sliding.rms),
            "sliding_worst": cost.percent(cost.sliding.worst),
            "swings_rms": cost.percent(cost.swings.rms),
            "swings_worst": cost.percent(cost.swings.worst),
        }),
    );
    format!("{:#}\n", Value::Object(tree))
}
