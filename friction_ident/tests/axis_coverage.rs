//! How often the 95 % intervals of an axis fit hold the truth where the residual is coloured or the
//! axis has what the model lacks. The truth is then what the same model finds over very long
//! recordings of the same kind.
//!
//! `FRICTION_COVERAGE` sets the number of seeded repetitions, 200 if unset;
//! `cargo xtask test --full` sets 2000.

use friction_ident::{AxisFit, AxisModel, Conditioning, Signals, condition, fit_axis};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

const DT: f64 = 4e-3;

/// What an axis has besides inertia, viscous and Coulomb friction.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Beside {
    Colour(f64),
    Ripple,
    Stribeck,
    Backlash,
}

/// An axis for `seconds` on six sines of the same frequencies with other phases, whose sum repeats
/// nothing.
fn recorded(seed: u64, seconds: f64, beside: Beside) -> AxisFit {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let base = 1.3;
    let ratios = [1.081, 1.197, 2.218, 2.511, 2.714, 3.128];
    let amplitudes = [0.5, 0.4, 0.3, 0.2, 0.14, 0.1];
    let phases: [f64; 6] = std::array::from_fn(|_| std::f64::consts::TAU * rng.random::<f64>());
    let n = (seconds / DT) as usize;
    let (mut place, mut force) = (Vec::with_capacity(n), Vec::with_capacity(n));
    let (mut colour, mut side) = (0.0, 0.0);
    for k in 0..n {
        let t = k as f64 * DT;
        let (mut q, mut v, mut a) = (0.0, 0.0, 0.0);
        for i in 0..6 {
            let w = base * ratios[i];
            let (sin, cos) = (w * t + phases[i]).sin_cos();
            q += amplitudes[i] * sin;
            v += amplitudes[i] * w * cos;
            a -= amplitudes[i] * w * w * sin;
        }
        let noise = rng.sample::<f64, _>(StandardNormal);
        let extra = match beside {
            Beside::Colour(c) => {
                colour = c * colour + (1.0 - c * c).sqrt() * noise;
                colour
            }
            Beside::Ripple => 0.8 * (40.0 * q).sin() + 0.2 * noise,
            Beside::Stribeck => 1.2 * v.signum() * (-(v / 0.15).powi(2)).exp() + 0.2 * noise,
            Beside::Backlash => {
                side += (0.25 * v * DT / 0.01) - 0.25 * v.abs() * DT / 0.01 * side;
                1.5 * (side - v.signum()) + 0.2 * noise
            }
        };
        place.push(q);
        force.push(2.0 * a + 1.5 * v + 3.0 * v.signum() + 0.4 + extra);
    }
    let signals = Signals {
        time_step: DT,
        position: Some(&place),
        readings: None,
        velocity: None,
        force: &force,
    };
    let recording = condition(&signals, &Conditioning::for_time_step(DT)).unwrap();
    fit_axis(&recording, AxisModel::SYMMETRIC).unwrap()
}

/// Long recordings, of which the mean is the truth.
fn truth(beside: Beside) -> Vec<f64> {
    if matches!(beside, Beside::Colour(_)) {
        return vec![2.0, 1.5, 3.0, 0.4];
    }
    let fits: Vec<AxisFit> =
        (0..8).map(|seed| recorded(1_000_000 + seed, 1500.0, beside)).collect();
    (0..4).map(|j| fits.iter().map(|fit| fit.terms[j].value).sum::<f64>() / 8.0).collect()
}

/// Both lengths of recording against one truth, which the long recordings tell.
fn intervals_hold_the_truth(beside: Beside) {
    let text = std::env::var("FRICTION_COVERAGE").ok();
    let repetitions: u64 = text.and_then(|text| text.parse().ok()).unwrap_or(200);
    // Four standard deviations of chance beside 92 to 97 %.
    let chance = 4.0 * (0.05 * 0.95 / repetitions as f64).sqrt();
    let truth = truth(beside);
    for seconds in [15.0, 60.0] {
        let mut inside = vec![0.0; truth.len()];
        let mut trusted = 0;
        for seed in 0..repetitions {
            let fit = recorded(seed, seconds, beside);
            for ((term, truth), inside) in fit.terms.iter().zip(&truth).zip(&mut inside) {
                trusted += u64::from(term.doubt.is_none());
                let holds = (term.value - truth).abs() <= term.half_width;
                // An interval that is not trusted claims nothing.
                *inside += f64::from(u8::from(holds || term.doubt.is_some())) / repetitions as f64;
            }
        }
        println!("{beside:?} {seconds} s: {inside:.3?}, {trusted} of {} trusted", 4 * repetitions);
        let all = inside.iter().sum::<f64>() / inside.len() as f64;
        assert!(
            (0.92 - chance..=0.985 + chance).contains(&all),
            "{beside:?} {seconds} s: {inside:?}"
        );
        for share in inside {
            assert!(share >= 0.90 - chance, "{beside:?} {seconds} s: {share}");
        }
    }
}

#[test]
fn intervals_hold_the_truth_under_white_noise() {
    intervals_hold_the_truth(Beside::Colour(0.0));
}

#[test]
fn intervals_hold_the_truth_under_colour() {
    intervals_hold_the_truth(Beside::Colour(0.9));
}

#[test]
fn intervals_hold_the_truth_under_slow_colour() {
    intervals_hold_the_truth(Beside::Colour(0.99));
}

#[test]
fn intervals_hold_the_truth_of_an_axis_with_a_ripple() {
    intervals_hold_the_truth(Beside::Ripple);
}

#[test]
fn intervals_hold_the_truth_of_an_axis_with_a_dip() {
    intervals_hold_the_truth(Beside::Stribeck);
}

#[test]
fn intervals_hold_the_truth_of_an_axis_with_backlash() {
    intervals_hold_the_truth(Beside::Backlash);
}
