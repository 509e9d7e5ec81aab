//! Whether the chosen model explains the recordings, or lacks something that acts in them.

use friction_ident::adequacy::{Quantity, doubts_of};
use friction_ident::one_speed::one_speed;
use friction_ident::staged::residuals_of_kind;
use friction_ident::{FrictionData, Stretch, StretchKind};

use recording::AxisKind;

use super::{ModelResult, wording};

/// What is wrong with a model as a whole, in sentences; from the motion that slides.
pub(super) fn doubts(chosen: &ModelResult, data: &FrictionData, axis: AxisKind) -> Vec<String> {
    let kinds = [StretchKind::Lag, StretchKind::Mixed];
    let by = chosen.found.predictor();
    let residual: Vec<f64> =
        kinds.iter().flat_map(|&kind| residuals_of_kind(&by, data, kind)).collect();
    if residual.is_empty() {
        return Vec::new();
    }
    let stretches = || data.lag.iter().chain(&data.mixed);
    let measured: Vec<f64> = stretches().flat_map(|stretch| &stretch.friction).copied().collect();
    let velocity: Vec<f64> = stretches().flat_map(|stretch| &stretch.velocity).copied().collect();
    let one_speed = one_speed(&velocity).filter(|_| data.points.is_empty()).map(|speed| {
        format!(
            "The sliding has one speed, {} {}, and its turns: how friction changes with speed hangs on the turns alone. \
             Add steady points, or motion at other speeds.",
            wording::significant(speed), axis.velocity_unit()
        )
    });
    let position: Option<Vec<&Vec<f64>>> =
        stretches().map(|stretch: &Stretch| stretch.position.as_ref()).collect();
    let position = position.map(|all| all.into_iter().flatten().copied().collect());
    let columns: Vec<(Quantity, Vec<f64>)> = position
        .map(|position| (Quantity::Position, position))
        .into_iter()
        .chain([(Quantity::Velocity, velocity)])
        .collect();
    let name = chosen.found.name;
    let near_rest = chosen
        .found
        .stages
        .last()
        .and_then(|last| last.left)
        .map(|left| format!("{name}: {left}. Its parameters near rest are not to be trusted."));
    doubts_of(&residual, &measured, &columns)
        .into_iter()
        .map(|doubt| format!("{name} {doubt}."))
        .chain(near_rest)
        .chain(one_speed)
        .collect()
}
