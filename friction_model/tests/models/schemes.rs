//! What each way to step a model once a period is worth: the error along one motion against the
//! same model stepped sixty times as often, for every model with states. The table in the book is
//! held to it; `UPDATE_DOCS=1 cargo test -p friction_model --test models schemes` writes it.

use std::f64::consts::PI;
use std::fmt::Write as _;

use friction_model::{
    AnyModel, AnyParameters, LeuvenParameters, ModelName, Scheme, TimeStep, presets::Presets,
};

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/reference/model-steps.md");

/// The models with states whose force does not jump.
const SMOOTH: [ModelName; 8] = [
    ModelName::Dahl,
    ModelName::BlimanSorine,
    ModelName::LuGre,
    ModelName::ElastoPlastic,
    ModelName::Leuven,
    ModelName::Xiong,
    ModelName::Proposed,
    ModelName::ProposedLinear,
];

/// Those whose states jump, switch or are random: no scheme is of second order for them.
const SWITCHING: [ModelName; 4] =
    [ModelName::Wojewoda, ModelName::Armstrong, ModelName::ResetIntegrator, ModelName::Gms];

/// Sliding and reversals with pre-sliding between \[rad/s\]. What a reversal costs depends on where
/// it lies within a step, so several phases are taken.
fn velocity(t: f64, phase: f64) -> f64 {
    0.3 * (2.0 * PI * 0.7 * t + phase).sin() + 0.06 * (2.0 * PI * 3.1 * t + 0.4).sin()
}

const PHASES: [f64; 10] = [0.0, 0.31, 0.55, 0.77, 1.2, 1.53, 1.9, 2.2, 2.6, 3.05];

const SECONDS: f64 = 1.0;

/// Forces at every 10 ms, in all phases.
fn forces(model: &AnyModel, scheme: Scheme, per_10_ms: u32) -> Vec<f64> {
    PHASES.iter().flat_map(|&phase| in_phase(model, scheme, per_10_ms, phase)).collect()
}

fn in_phase(model: &AnyModel, scheme: Scheme, per_10_ms: u32, phase: f64) -> Vec<f64> {
    let dt = 0.01 / f64::from(per_10_ms);
    let mut stepper = model.start_by(scheme, TimeStep::new(dt).unwrap());
    let count = (SECONDS / 0.01) as u32;
    let mut kept = Vec::new();
    for k in 0..=count * per_10_ms {
        let force = stepper.step(velocity(f64::from(k) * dt, phase));
        if k % per_10_ms == 0 {
            kept.push(force);
        }
    }
    kept
}

fn root_mean_square(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    (sum / a.len() as f64).sqrt()
}

/// The level at which a contact breaks away \[N m\].
fn level(model: &AnyModel) -> f64 {
    model.parameter("f_s").or(model.parameter("f_c")).unwrap_or(0.0994)
}

/// The error relative to the static level, with 10 steps in 10 ms, and the order between that and
/// 80.
fn worth(model: &AnyModel, scheme: Scheme, truth: &[f64]) -> (f64, f64) {
    let error = |per_10_ms| root_mean_square(&forces(model, scheme, per_10_ms), truth);
    let (coarse, fine) = (error(10), error(80));
    (coarse / level(model), (coarse / fine).log2() / 3.0)
}

struct Row {
    model: AnyModel,
    title: String,
    held: (f64, f64),
    mean: (f64, f64),
}

fn rows() -> Vec<Row> {
    let sharp = LeuvenParameters { n: 20.0, ..LeuvenParameters::test_bed() };
    let sharp = AnyModel::try_from(AnyParameters::Leuven(sharp)).unwrap();
    let named = |name: ModelName| (AnyModel::test_bed(name), name.title().to_owned());
    let mut all: Vec<_> = SMOOTH.into_iter().map(named).collect();
    all.push((sharp, "Leuven, n = 20".to_owned()));
    all.extend(SWITCHING.into_iter().map(named));
    let row = |(model, title): (AnyModel, String)| {
        let truth = forces(&model, Scheme::Mean, 600);
        let [held, mean] = [Scheme::Held, Scheme::Mean].map(|by| worth(&model, by, &truth));
        Row { model, title, held, mean }
    };
    all.into_iter().map(row).collect()
}

fn table(rows: &[Row]) -> String {
    let mut table = "| model | `held`: error at 1 ms | order | `mean`: error at 1 ms | order | \
                     smaller by |\n|---|---|---|---|---|---|\n"
        .to_owned();
    for Row { title, held, mean, .. } in rows {
        let ratio = held.0 / mean.0;
        let times = if ratio < 10.0 { format!("{ratio:.1}") } else { format!("{ratio:.0}") };
        let (a, p, b, q) = (held.0, held.1, mean.0, mean.1);
        writeln!(table, "| {title} | {a:.1e} | {p:.1} | {b:.1e} | {q:.1} | {times} |").unwrap();
    }
    table
}

#[test]
fn the_mean_is_of_second_order_and_the_book_says_what_it_is_worth() {
    let rows = rows();
    let table = table(&rows);
    for Row { model, title, held, mean } in &rows {
        if SMOOTH.contains(&model.name()) {
            assert!(mean.1 > 1.5, "{title}: order {} of the mean\n{table}", mean.1);
            assert!(held.0 > 1.5 * mean.0, "{title}: {held:?} held, {mean:?} mean\n{table}");
        } else {
            assert!(mean.0 < 1.2 * held.0, "{title}: {held:?} held, {mean:?} mean\n{table}");
        }
    }
    let page = std::fs::read_to_string(PAGE).unwrap();
    let (start, end) = ("<!-- made: schemes -->\n", "<!-- end -->");
    let from = page.find(start).unwrap() + start.len();
    let to = from + page[from..].find(end).unwrap();
    if std::env::var_os("UPDATE_DOCS").is_some() {
        let made = format!("{}\n{table}\n{}", page[..from].trim_end_matches(' '), &page[to..]);
        std::fs::write(PAGE, made).unwrap();
    } else {
        assert_eq!(page[from..to].trim(), table.trim(), "run with UPDATE_DOCS=1");
    }
}

/// A sharp transition used to be softened in pre-sliding, where the contact is a spring.
#[test]
fn leuvens_fixed_step_does_not_soften_pre_sliding() {
    for n in [2.0, 5.0, 20.0] {
        let parameters = LeuvenParameters { n, ..LeuvenParameters::test_bed() };
        let model = AnyModel::try_from(AnyParameters::Leuven(parameters)).unwrap();
        for scheme in [Scheme::Held, Scheme::Mean] {
            let at_constant_speed = |per_10_ms: u32| {
                let dt = TimeStep::new(0.01 / f64::from(per_10_ms)).unwrap();
                let mut stepper = model.start_by(scheme, dt);
                (0..=per_10_ms * 3).map(|_| stepper.step(0.1)).last().unwrap()
            };
            let (coarse, truth) = (at_constant_speed(10), at_constant_speed(4000));
            assert!((coarse / truth - 1.0).abs() < 0.01, "n {n}, {scheme:?}: {coarse} {truth}");
        }
    }
}

/// A small generator of normal noise: twelve uniform numbers.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            sum += (self.0 >> 11) as f64 / (1u64 << 53) as f64;
        }
        sum
    }
}

/// A tachometer's noise of 0.001 rad/s leaves the mean its lead; with 0.01 rad/s the noise makes the
/// error. Where the force jumps when the motion turns, the contact then sticks and slips with the
/// noise of the newest sample, which the mean takes in at once.
#[test]
fn with_measurement_noise_the_mean_is_not_worse() {
    for name in SMOOTH.into_iter().chain(SWITCHING) {
        let model = AnyModel::test_bed(name);
        let truths = PHASES.map(|phase| in_phase(&model, Scheme::Mean, 500, phase));
        let error = |scheme, size: f64| {
            let mut noise = Noise(7);
            let mut squares = 0.0;
            for (truth, phase) in truths.iter().zip(PHASES) {
                let mut stepper = model.start_by(scheme, TimeStep::new(1e-3).unwrap());
                let mut seen = Vec::new();
                for k in 0..=(SECONDS / 1e-3) as u32 {
                    let v = velocity(f64::from(k) * 1e-3, phase) + size * noise.next();
                    let force = stepper.step(v);
                    if k % 10 == 0 {
                        seen.push(force);
                    }
                }
                squares += root_mean_square(&seen, truth).powi(2);
            }
            squares.sqrt()
        };
        let with = |size| error(Scheme::Mean, size) / error(Scheme::Held, size);
        let [small, large] = [1e-3, 1e-2].map(with);
        let jumps = matches!(name, ModelName::Armstrong | ModelName::ResetIntegrator);
        let most = if jumps { 1.2 } else { 1.03 };
        let said = format!("{name}: {small} and {large} times the error of held");
        println!("{said}");
        assert!(small < 0.95 && large < most, "{said}");
    }
}
