//! Friction in volts from stiction limit cycles: what `frictionlab identify-stiction` does between
//! reading and printing.

pub mod document;
pub mod page;
pub mod terminal;

use friction_ident::statistics::Quartiles;
use friction_ident::stiction_cycle::{
    Breakaway, BreakawayOptions, Phase, PhaseKind, SlipFriction, SlipOptions, StictionRecording,
    breakaways, median, segment, slip_friction,
};
use friction_ident::{Estimate, IdentError, ParameterId, Side};

use recording::stiction_table::StictionTable;

/// How it is done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// One count of the encoder \[rad\].
    pub resolution: f64,
    /// The limit cycle begins here \[s\]: the start-up is left out.
    pub from: f64,
    /// The limit cycle ends and the driven motion begins here \[s\].
    pub until: f64,
    /// Counts further apart than this belong to two slips \[s\].
    pub gap: f64,
    /// Breakaways.
    pub breakaway: BreakawayOptions,
    /// The regression over the driven motion.
    pub slip: SlipOptions,
}

impl Settings {
    /// For an encoder with `counts` a turn and a limit cycle that lasts until `until` \[s\].
    pub fn new(counts: f64, from: f64, until: f64) -> Self {
        Self {
            resolution: 2.0 * std::f64::consts::PI / counts,
            from,
            until,
            gap: 0.03,
            breakaway: BreakawayOptions::default(),
            slip: SlipOptions::default(),
        }
    }
}

/// What one recording says.
#[derive(Debug, Clone, PartialEq)]
pub struct Episode {
    /// Its stick and slip phases, start-up left out.
    pub phases: Vec<Phase>,
    /// Its breakaways.
    pub breakaways: Vec<Breakaway>,
    /// Quartiles of the breakaway voltage forwards and backwards \[V\].
    pub quartiles: [Option<Quartiles>; 2],
    /// Share of the limit cycle at rest.
    pub rest_share: f64,
    /// Friction while it slides in the driven motion; or why there is none.
    pub slip: Result<SlipFriction, IdentError>,
}

/// What all recordings say.
#[derive(Debug, Clone, PartialEq)]
pub struct StictionIdentification {
    /// How it was done.
    pub settings: Settings,
    /// One a recording.
    pub episodes: Vec<Episode>,
    /// Median breakaway voltage forwards and backwards over all recordings, with intervals \[V\].
    pub breakaway: Vec<Estimate>,
}

const MORE_CYCLES: &str = "record a longer limit cycle";

/// Works it out.
///
/// # Errors
/// [`IdentError`] for recordings that cannot be used.
pub fn identify(
    tables: &[StictionTable],
    settings: &Settings,
) -> Result<StictionIdentification, IdentError> {
    let episodes =
        tables.iter().map(|table| episode(table, settings)).collect::<Result<Vec<_>, _>>()?;
    let breakaway = [(1.0, Side::Forward), (-1.0, Side::Backward)]
        .into_iter()
        .filter_map(|(direction, side)| {
            let all: Vec<f64> = episodes
                .iter()
                .flat_map(|episode| voltages(&episode.breakaways, direction))
                .collect();
            median(ParameterId::new("breakaway").side(side), &all, MORE_CYCLES)
        })
        .collect();
    Ok(StictionIdentification { settings: *settings, episodes, breakaway })
}

/// Voltages of the breakaways in one direction.
pub fn voltages(of: &[Breakaway], direction: f64) -> Vec<f64> {
    of.iter().filter(|b| b.direction == direction).map(|b| b.voltage).collect()
}

/// The recording as the science sees it.
pub fn recording<'a>(table: &'a StictionTable, settings: &Settings) -> StictionRecording<'a> {
    StictionRecording {
        time_step: table.time_step,
        angle: &table.angle,
        resolution: settings.resolution,
        voltage: &table.voltage,
        pendulum: table.pendulum.as_deref(),
    }
}

fn episode(table: &StictionTable, settings: &Settings) -> Result<Episode, IdentError> {
    let recording = recording(table, settings);
    recording.check()?;
    let sample = |time: f64| ((time / table.time_step).round() as usize).min(table.angle.len());
    let (from, until) = (sample(settings.from), sample(settings.until));
    let phases: Vec<Phase> = segment(&recording, settings.gap)
        .into_iter()
        .filter(|phase| phase.start >= from && phase.end <= until)
        .collect();
    let breakaways = breakaways(&recording, &phases, &settings.breakaway);
    let length = |kind: fn(&Phase) -> bool| -> usize {
        phases.iter().filter(|phase| kind(phase)).map(|phase| phase.end - phase.start).sum()
    };
    let rest_share =
        length(|phase| phase.kind == PhaseKind::Stick) as f64 / length(|_| true).max(1) as f64;
    Ok(Episode {
        quartiles: [1.0, -1.0].map(|direction| Quartiles::of(&voltages(&breakaways, direction))),
        rest_share,
        slip: slip_friction(&recording, until..table.angle.len(), &settings.slip),
        phases,
        breakaways,
    })
}

/// What recordings of angle and voltage cannot say, for whoever reads the numbers.
pub const UNKNOWN: [&str; 6] = [
    "Friction in newton metres: only voltages were recorded. Torque is the torque constant over the resistance times the voltage, \
     and neither is known here.",
    "The inertia: the coefficient of the acceleration is inertia times resistance over torque constant.",
    "Viscous friction: the back-EMF acts on the voltage exactly as viscous friction does. Their sum is the coefficient of the speed; \
     it takes a current measurement, or the motor's constant, to part them.",
    "The coefficient of the speed to better than its interval: where a controller balances a pendulum, a little more delay and a little \
     less speed explain the voltage about as well. Its interval runs over all such delays.",
    "The static level itself: the axis lets go while the controller moves the voltage in jumps of one count of the sensors. A breakaway \
     voltage is the largest one that stood before the first count of motion, an upper value; the largest one withstood before in \
     the same rest is a lower value. The push of a pendulum that leans, and the offset, are part of both.",
    "Whether static friction exceeds the Coulomb level, where a pendulum or a noisy controller shakes the axis at rest: shaking releases it early \
     and hides the difference.",
];
