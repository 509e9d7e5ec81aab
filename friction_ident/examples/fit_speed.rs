//! Time of the lag stage for the proposed model, LuGre and GMS (9425 points) and of the joint fit
//! (6000 points), for `cargo xtask bench-fits`.
//!
//! `fit_speed FOLDER ROUNDS` writes `lag.csv`, `joint.csv` and `start.json` into the folder if they
//! are not there, fits each ROUNDS times and prints one line of JSON a fit, as the SciPy peer
//! (`tests/peers/scipy_fits.py`) does on the same files. The data are made by RK4 at a hundredth of
//! the sampling period from the analytic velocity, with white noise of 0.0029 N m (the printed mean
//! square of the lag stage).

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use friction_ident::frictional_lag::{
    LagOptions, LagRecording, Relaxation, fit_lag, fit_relaxation,
};
use friction_ident::output_error::OutputErrorOptions;
use friction_ident::{FreeParameters, Measured, Stretch, fit_output_error};
use friction_model::{AnyModel, AnyParameters, FrictionModel, ModelName, ModelVisitor, rk4};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

const DT: f64 = 1e-3;
const FINE: usize = 100;

fn truth() -> Result<AnyModel, Box<dyn Error>> {
    let mut parameters = AnyParameters::test_bed(ModelName::Proposed);
    parameters.set("tau", 0.0111);
    Ok(parameters.try_into()?)
}

/// Sliding one way with a chirp to 10 rad/s: experiment 2.
fn lag_velocity(t: f64) -> f64 {
    1.0 - 0.95 * (0.53 * t * t).cos()
}

/// Reversals, slow and fast, small and large.
fn joint_velocity(t: f64) -> f64 {
    0.4 * (1.3 * t).sin() * (0.37 * t).cos() + 0.03 * (11.0 * t).sin()
}

/// Friction along an analytic velocity, sampled.
struct Fine {
    samples: usize,
    velocity: fn(f64) -> f64,
    slid: bool,
}

impl ModelVisitor for Fine {
    type Output = Vec<f64>;

    fn visit<M: FrictionModel>(self, model: M) -> Vec<f64> {
        let mut state = model.rest();
        let h = DT / FINE as f64;
        if self.slid {
            let v = (self.velocity)(0.0);
            for _ in 0..200 * FINE {
                rk4::step(&model, &mut state, [v; 3], h);
            }
        }
        let mut out = Vec::with_capacity(self.samples);
        for k in 0..self.samples {
            let t = k as f64 * DT;
            out.push(model.evaluate(&state.continuous, &state.memory, (self.velocity)(t)).force);
            for i in 0..FINE {
                let t = t + i as f64 * h;
                rk4::step(&model, &mut state, [t, t + 0.5 * h, t + h].map(self.velocity), h);
            }
        }
        out
    }
}

/// A recording as the peer reads it.
struct Table {
    velocity: Vec<f64>,
    torque: Vec<f64>,
}

impl Table {
    fn make(path: &Path, fine: Fine, seed: u64) -> Result<(), Box<dyn Error>> {
        let velocity = fine.velocity;
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut text = String::from("t_s,velocity_rad_s,torque_Nm\n");
        for (k, force) in truth()?.visit(fine).into_iter().enumerate() {
            let t = k as f64 * DT;
            let noisy = force + 0.0029 * rng.sample::<f64, _>(StandardNormal);
            writeln!(text, "{t},{},{noisy}", velocity(t))?;
        }
        Ok(fs::write(path, text)?)
    }

    fn read(path: &Path) -> Result<Self, Box<dyn Error>> {
        let text = fs::read_to_string(path)?;
        let mut table = Self { velocity: Vec::new(), torque: Vec::new() };
        for line in text.lines().skip(1) {
            let mut cells = line.split(',').skip(1);
            table.velocity.push(cells.next().ok_or("a column is missing")?.parse()?);
            table.torque.push(cells.next().ok_or("a column is missing")?.parse()?);
        }
        Ok(table)
    }
}

/// Start of the joint fit, up to a fifth from the truth.
const JOINT: [(&str, f64); 7] = [
    ("f_s", 0.115),
    ("f_c", 0.080),
    ("v_s", 0.155),
    ("sigma", 0.29),
    ("tau", 0.0117),
    ("z_b", 0.0057),
    ("f_v", 0.0443),
];

fn report(
    what: &str,
    times: &[f64],
    evaluations: usize,
    mse: f64,
    parameters: &BTreeMap<String, f64>,
) {
    println!(
        "{{\"what\": \"{what}\", \"milliseconds\": {times:?}, \"evaluations\": {evaluations}, \"mse\": {mse:e}, \"parameters\": {parameters:?}}}"
    );
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("expected a folder and a number of rounds")?;
    let rounds: usize = arguments.next().unwrap_or("5".to_owned()).parse()?;
    let folder = Path::new(&folder);
    let [lag, joint] = ["lag.csv", "joint.csv"].map(|name| folder.join(name));
    if !joint.exists() {
        fs::create_dir_all(folder)?;
        Table::make(&lag, Fine { samples: 9425, velocity: lag_velocity, slid: true }, 1)?;
        Table::make(&joint, Fine { samples: 6000, velocity: joint_velocity, slid: false }, 2)?;
        let joint: BTreeMap<_, _> = JOINT.into();
        // LuGre and GMS begin with a lag of some 10 ms at the Stribeck velocity.
        let relaxation: BTreeMap<_, _> =
            JOINT.into_iter().chain([("sigma0", 60.0), ("sigma1", 0.01), ("c", 0.2)]).collect();
        let starts =
            format!("{{\"lag\": {joint:?}, \"joint\": {joint:?}, \"relaxation\": {relaxation:?}}}");
        fs::write(folder.join("start.json"), starts)?;
    }

    let table = Table::read(&lag)?;
    let recording = LagRecording { velocity: &table.velocity, torque: &table.torque, dt: DT };
    let mut times = Vec::new();
    let mut last = None;
    for _ in 0..=rounds {
        let begin = Instant::now();
        let fit = fit_lag(std::slice::from_ref(&recording), &LagOptions::default())?;
        times.push(1e3 * begin.elapsed().as_secs_f64());
        last = Some(fit);
    }
    if let Some(fit) = last {
        let parameters =
            fit.estimates.parameters.iter().map(|e| (e.id.to_string(), e.value)).collect();
        // The first round warms up.
        report("lag", &times[1..], fit.passes, fit.mse, &parameters);
    }

    let gms = Relaxation::Gms {
        alpha: &[0.25; 4],
        sigma0: &[15.0, 12.0, 9.0, 6.0],
        sigma1: &[0.0686; 4],
    };
    for (what, model) in [("lag, LuGre", Relaxation::LuGre), ("lag, GMS(4)", gms)] {
        let mut times = Vec::new();
        let mut last = None;
        for _ in 0..=rounds {
            let begin = Instant::now();
            let fit =
                fit_relaxation(std::slice::from_ref(&recording), &LagOptions::default(), model)?;
            times.push(1e3 * begin.elapsed().as_secs_f64());
            last = Some(fit);
        }
        if let Some(fit) = last {
            let parameters =
                fit.estimates.parameters.iter().map(|e| (e.id.to_string(), e.value)).collect();
            report(what, &times[1..], fit.evaluations, fit.mse, &parameters);
        }
    }

    let table = Table::read(&joint)?;
    let stretch = Stretch::new(DT, table.velocity, None, table.torque)?;
    let mut parameters = truth()?.parameters();
    for (name, value) in JOINT {
        parameters.set(name, value);
    }
    let free = FreeParameters::usual(&parameters.try_into()?);
    let data = Measured { stretches: std::slice::from_ref(&stretch), ..Measured::default() };
    let mut options = OutputErrorOptions { restarts: 0, ..OutputErrorOptions::default() };
    (options.patience.sum, options.patience.step) = (1e-8, 1e-8);
    let mut times = Vec::new();
    let mut last = None;
    for _ in 0..=rounds {
        let begin = Instant::now();
        let fit =
            fit_output_error(&free, &data, &[], &options, &mut |_| ControlFlow::Continue(()))?;
        times.push(1e3 * begin.elapsed().as_secs_f64());
        last = Some(fit);
    }
    if let Some(fit) = last {
        let parameters =
            fit.estimates.parameters.iter().map(|e| (e.id.to_string(), e.value)).collect();
        report("joint", &times[1..], fit.evaluations, fit.rms * fit.rms, &parameters);
    }
    Ok(())
}
