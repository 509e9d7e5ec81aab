//! The speeds of the recordings, for whoever wants to know where a model was identified.

use recording::AxisKind;
use simulator_export::Axis;
use simulator_export::annotations::speeds_line;

/// The line of a parameter file that says which speeds were recorded \[rad/s or m/s\]; none where
/// nothing moved.
pub fn line(velocities: impl Iterator<Item = f64>, axis: AxisKind) -> Option<String> {
    let axis = match axis {
        AxisKind::Rotary => Axis::Rotary,
        AxisKind::Linear => Axis::Linear,
    };
    range(velocities).map(|[low, high]| speeds_line(low, high, axis))
}

/// The lowest and the highest speed that was recorded \[rad/s or m/s\]; none where nothing moved.
pub fn range(velocities: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let (mut low, mut high) = (f64::INFINITY, 0.0);
    for velocity in velocities.filter(|velocity| velocity.is_finite()) {
        low = f64::min(low, velocity.abs());
        high = f64::max(high, velocity.abs());
    }
    // Three digits are what a range deserves: outwards, so that it holds all speeds.
    let outwards = |value: f64, up: bool| {
        if value == 0.0 {
            return value;
        }
        let unit = 10f64.powi(value.log10().floor() as i32 - 2);
        let count = if up { (value / unit - 1e-9).ceil() } else { (value / unit + 1e-9).floor() };
        format!("{:.2e}", count * unit).parse().unwrap_or(value)
    };
    // Where the recordings come to rest, noise is what is left of the speed.
    let low = if low < 1e-4 * high { 0.0 } else { outwards(low, false) };
    (high > 0.0).then(|| [low, outwards(high, true)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_holds_all_speeds() {
        let said = line([-0.051_23, 1.0, 2.998_7].into_iter(), AxisKind::Rotary).unwrap();
        assert_eq!(said, "Speeds of the recordings: 0.0512 to 3.0 rad/s");
        let said = line([1e-9, 0.1].into_iter(), AxisKind::Linear).unwrap();
        assert_eq!(said, "Speeds of the recordings: 0.0 to 0.1 m/s");
        assert_eq!(line([0.0, f64::NAN].into_iter(), AxisKind::Linear), None);
    }
}
