//! Low-pass filters run forwards and backwards, so that nothing is delayed.
//!
//! Butterworth for smoothing, Chebyshev (type I, 0.05 dB) before decimation. Both are kept as
//! second-order sections: an eighth-order filter at a twelfth of the sampling rate already loses
//! half its digits as one polynomial. That, and the missing Chebyshev, is why this is not done with
//! a ready-made Butterworth crate.
//!
//! The conventions are those of MATLAB's `filtfilt`: the signal is extended at both ends by its
//! point reflection over three times the order, and each pass starts in the steady state of its
//! first sample. The resulting gain is the square of the filter's, so the cutoff lies at -6 dB for
//! Butterworth.

use std::f64::consts::PI;

use friction_lanes::elementary::{fuses, mul_add};
use pulp::{Arch, Simd, WithSimd};

use crate::IdentError;

/// Signals that are filtered side by side. Eight would fit the widest instructions, but a minute at
/// 1 kHz would then not stay in the second cache.
pub(crate) const LANES: usize = 4;

/// Samples that are brought into the lanes, and out of them, before the next lane's are.
const PIECE: usize = 256;

/// A digital low-pass of gain one at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct LowPass {
    sections: Vec<Section>,
    order: usize,
}

/// One second-order section, `y = gain (1 + b1/z + b2/z^2) / (1 + a1/z + a2/z^2) u`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Section {
    gain: f64,
    b: [f64; 2],
    a: [f64; 2],
}

impl LowPass {
    /// A Butterworth low-pass of `order` 1 to 12 with `cutoff` \[Hz\] at `rate` samples a second.
    ///
    /// # Errors
    /// [`IdentError::Order`], [`IdentError::Cutoff`], [`IdentError::TimeStep`].
    pub fn butterworth(order: usize, cutoff: f64, rate: f64) -> Result<Self, IdentError> {
        Self::from_prototype(order, cutoff, rate, |angle| (-angle.sin(), angle.cos()))
    }

    /// A Chebyshev low-pass of type I with `ripple` \[dB\] in the pass band; `cutoff` is where the
    /// band ends.
    ///
    /// The gain at rest is one (the ripple then lies above it for even orders), so that filtering
    /// leaves a constant as it is.
    ///
    /// # Errors
    /// As for [`butterworth`](Self::butterworth).
    pub fn chebyshev(
        order: usize,
        ripple: f64,
        cutoff: f64,
        rate: f64,
    ) -> Result<Self, IdentError> {
        let epsilon = (10f64.powf(ripple.abs() / 10.0) - 1.0).sqrt();
        let mu = (1.0 / epsilon).asinh() / order.max(1) as f64;
        Self::from_prototype(order, cutoff, rate, |angle| {
            (-mu.sinh() * angle.sin(), mu.cosh() * angle.cos())
        })
    }

    /// Bilinear transform of the analog poles that `pole` places at the angles
    /// `pi (2k+1) / (2 order)`.
    fn from_prototype(
        order: usize,
        cutoff: f64,
        rate: f64,
        pole: impl Fn(f64) -> (f64, f64),
    ) -> Result<Self, IdentError> {
        if !(1..=12).contains(&order) {
            return Err(IdentError::Order(order));
        }
        if !(rate > 0.0 && rate.is_finite()) {
            return Err(IdentError::TimeStep(1.0 / rate));
        }
        if !(cutoff > 0.0 && cutoff < rate / 2.0) {
            return Err(IdentError::Cutoff { cutoff, nyquist: rate / 2.0 });
        }
        let warped = (PI * cutoff / rate).tan();
        let sections = (0..order.div_ceil(2))
            .map(|k| {
                let (re, im) = pole(PI * (2 * k + 1) as f64 / (2 * order) as f64);
                let (re, im) = (re * warped, im * warped);
                // The pole of z is (1 + p) / (1 - p).
                let denominator = (1.0 - re).powi(2) + im.powi(2);
                let magnitude = ((1.0 + re).powi(2) + im.powi(2)) / denominator;
                let real = (1.0 - re.powi(2) - im.powi(2)) / denominator;
                if 2 * k + 1 == order {
                    let gain = (1.0 - real) / 2.0;
                    Section { gain, b: [1.0, 0.0], a: [-real, 0.0] }
                } else {
                    let gain = (1.0 - 2.0 * real + magnitude) / 4.0;
                    Section { gain, b: [2.0, 1.0], a: [-2.0 * real, magnitude] }
                }
            })
            .collect();
        Ok(Self { sections, order })
    }

    /// Samples the signal must have more than: the length of its extension at each end.
    pub fn padding(&self) -> usize {
        3 * self.order
    }

    /// Filters forwards and backwards; the result is as long as `signal`.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] unless the signal is longer than [`padding`](Self::padding).
    pub fn filter(&self, signal: &[f64]) -> Result<Vec<f64>, IdentError> {
        let mut filtered = self.filter_all(&[signal])?;
        Ok(filtered.swap_remove(0))
    }

    /// Filters signals of one length side by side: one costs as much as [`LANES`].
    ///
    /// # Errors
    /// As for [`filter`](Self::filter).
    pub(crate) fn filter_all(&self, signals: &[&[f64]]) -> Result<Vec<Vec<f64>>, IdentError> {
        let mut filtered = Vec::with_capacity(signals.len());
        for few in signals.chunks(LANES) {
            filtered.extend(match few.len() {
                // One alone is slower than two.
                0..=2 => self.in_lanes::<2>(few)?,
                _ => self.in_lanes::<LANES>(few)?,
            });
        }
        Ok(filtered)
    }

    /// Up to `L` signals; the lanes that are left over stay zero.
    fn in_lanes<const L: usize>(&self, few: &[&[f64]]) -> Result<Vec<Vec<f64>>, IdentError> {
        let pad = self.padding();
        let n = few.iter().map(|signal| signal.len()).min().unwrap_or(0);
        if n <= pad {
            return Err(IdentError::TooFewSamples {
                what: "the zero-phase low-pass",
                needed: pad + 1,
                found: n,
                lower: Some("the filter order"),
            });
        }
        let mut extended = vec![[0.0; L]; n + 2 * pad];
        let (before, inner) = extended.split_at_mut(pad);
        let (inner, after) = inner.split_at_mut(n);
        for (lane, signal) in few.iter().enumerate() {
            let (first, last) = (2.0 * signal[0], 2.0 * signal[n - 1]);
            let starts = before.iter_mut().rev().zip(&signal[1..]);
            starts.for_each(|(to, from)| to[lane] = first - from);
            let ends = after.iter_mut().zip(signal[..n - 1].iter().rev());
            ends.for_each(|(to, from)| to[lane] = last - from);
        }
        // Piece by piece, so that what the lanes share stays in the first cache.
        for (k, piece) in inner.chunks_mut(PIECE).enumerate() {
            for (lane, signal) in few.iter().enumerate() {
                let own = piece.iter_mut().zip(&signal[k * PIECE..]);
                own.for_each(|(to, from)| to[lane] = *from);
            }
        }
        // By fours and fewer: more sections do not fit the registers.
        for sections in self.sections.chunks(4) {
            pass(sections, extended.first().copied(), extended.iter_mut());
        }
        for sections in self.sections.chunks(4) {
            pass(sections, extended.last().copied(), extended.iter_mut().rev());
        }
        let mut filtered: Vec<Vec<f64>> = few.iter().map(|_| Vec::with_capacity(n)).collect();
        for piece in extended[pad..pad + n].chunks(PIECE) {
            for (lane, to) in filtered.iter_mut().enumerate() {
                to.extend(piece.iter().map(|values| values[lane]));
            }
        }
        Ok(filtered)
    }
}

/// One pass of up to four sections in place, from the steady state of the first sample on.
fn pass<'s, const L: usize>(
    sections: &[Section],
    first: Option<[f64; L]>,
    signals: impl Iterator<Item = &'s mut [f64; L]>,
) {
    let (arch, first) = (Arch::new(), first.unwrap_or([0.0; L]));
    match *sections {
        [a] => arch.dispatch(Pass { sections: [a], first, signals }),
        [a, b] => arch.dispatch(Pass { sections: [a, b], first, signals }),
        [a, b, c] => arch.dispatch(Pass { sections: [a, b, c], first, signals }),
        [a, b, c, d] => arch.dispatch(Pass { sections: [a, b, c, d], first, signals }),
        _ => {}
    }
}

/// One pass in place over signals side by side, each started in the steady state of its first
/// sample. All `N` sections take a sample before the next one comes: that is several times faster than
/// one section after the other, because they then do not wait for themselves. How many sections there
/// are is known to the compiler, so that their states stay in registers: four times as fast again.
/// The gains of the sections are taken together, which spares each a product.
struct Pass<I, const N: usize, const L: usize> {
    sections: [Section; N],
    first: [f64; L],
    signals: I,
}

impl<'s, I: Iterator<Item = &'s mut [f64; L]>, const N: usize, const L: usize> Pass<I, N, L> {
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let Self { sections, first, signals } = self;
        let gain: f64 = sections.iter().map(|section| section.gain).product();
        let mut states = steady(&sections, first.map(|value| gain * value));
        for values in signals {
            let mut input = values.map(|value| gain * value);
            for (Section { b, a, .. }, [s1, s2]) in sections.iter().zip(&mut states) {
                let mut output = [0.0; L];
                for lane in 0..L {
                    output[lane] = input[lane] + s1[lane];
                }
                for lane in 0..L {
                    let fresh = mul_add::<FUSED>(b[0], input[lane], s2[lane]);
                    s1[lane] = mul_add::<FUSED>(-a[0], output[lane], fresh);
                }
                for lane in 0..L {
                    s2[lane] = mul_add::<FUSED>(-a[1], output[lane], b[1] * input[lane]);
                }
                input = output;
            }
            *values = input;
        }
    }
}

/// The states in which sections rest at a constant input.
#[inline(always)]
fn steady<const N: usize, const L: usize>(
    sections: &[Section; N],
    mut input: [f64; L],
) -> [[[f64; L]; 2]; N] {
    let mut states = [[[0.0; L]; 2]; N];
    for (Section { b, a, .. }, [s1, s2]) in sections.iter().zip(&mut states) {
        let at_rest = (1.0 + b[0] + b[1]) / (1.0 + a[0] + a[1]);
        for lane in 0..L {
            let output = at_rest * input[lane];
            s2[lane] = b[1] * input[lane] - a[1] * output;
            s1[lane] = b[0] * input[lane] - a[0] * output + s2[lane];
            input[lane] = output;
        }
    }
    states
}

impl<'s, I: Iterator<Item = &'s mut [f64; L]>, const N: usize, const L: usize> WithSimd
    for Pass<I, N, L>
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        if fuses::<S>() {
            self.run::<true>();
        } else {
            self.run::<false>();
        }
    }
}

/// Keeps every `factor`-th sample, the first one included, after a zero-phase Chebyshev low-pass of
/// order 8 that ends at 0.8 of the new Nyquist frequency (what MATLAB's `decimate` does). A factor
/// of one changes nothing.
///
/// # Errors
/// [`IdentError::Decimation`] for a factor outside 1 to 1000, [`IdentError::TooFewSamples`].
pub fn decimate(signal: &[f64], factor: usize) -> Result<Vec<f64>, IdentError> {
    match factor {
        1 => Ok(signal.to_vec()),
        2..=1000 => {
            let filter = LowPass::chebyshev(8, 0.05, 0.4 / factor as f64, 1.0)?;
            Ok(filter.filter(signal)?.into_iter().step_by(factor).collect())
        }
        _ => Err(IdentError::Decimation(factor)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(got: &[f64], expected: &[f64], tolerance: f64) {
        for (index, (a, b)) in got.iter().zip(expected).enumerate() {
            assert!((a - b).abs() < tolerance, "{index}: {a} instead of {b}");
        }
    }

    /// A signal without symmetry, and samples of it filtered by SciPy 1.17 (`sosfiltfilt`,
    /// `padlen = 3 order`).
    fn signal() -> Vec<f64> {
        (0..40).map(f64::from).map(|i| (0.3 * i).sin() + 0.005 * i.powf(1.5)).collect()
    }

    const PICKED: [usize; 5] = [0, 1, 20, 38, 39];

    fn picked(filter: &LowPass) -> Vec<f64> {
        let out = filter.filter(&signal()).unwrap();
        PICKED.iter().map(|&i| out[i]).collect()
    }

    #[test]
    fn signals_side_by_side_are_each_as_alone() {
        let filter = LowPass::chebyshev(8, 0.05, 0.04, 1.0).unwrap();
        let signals: Vec<Vec<f64>> = (1..=11)
            .map(|k| signal().iter().map(|x| x * f64::from(k) + x.powi(k)).collect())
            .collect();
        for count in 0..=11 {
            let some: Vec<&[f64]> = signals[..count].iter().map(Vec::as_slice).collect();
            let alone: Vec<_> = some.iter().map(|signal| filter.filter(signal).unwrap()).collect();
            assert_eq!(filter.filter_all(&some).unwrap(), alone, "{count}");
        }
    }

    #[test]
    fn agrees_with_scipy() {
        let expected =
            [-0.0001972263906, 0.3054733474651, 0.1673908583355, 0.3267403526174, 0.4809730805705];
        assert_close(&picked(&LowPass::butterworth(4, 100.0, 1000.0).unwrap()), &expected, 1e-10);
        let expected =
            [0.079614821957, 0.2523290386253, 0.2673539692787, 0.4138480103193, 0.3926274122155];
        assert_close(&picked(&LowPass::butterworth(3, 50.0, 1000.0).unwrap()), &expected, 1e-10);
        let expected =
            [-0.0668923468282, -0.0134906894499, 0.3508902299256, 1.0442065591553, 1.048175289436];
        assert_close(
            &picked(&LowPass::chebyshev(8, 0.05, 40.0, 1000.0).unwrap()),
            &expected,
            1e-10,
        );
    }

    #[test]
    fn leaves_straight_lines_alone() {
        // The point reflection at the ends continues a line, and the gain at rest is one.
        let line: Vec<f64> = (0..400).map(|i| 3.0 - 0.25 * f64::from(i)).collect();
        for order in 1..=12 {
            // The higher the order, the longer it rings.
            let filter = LowPass::butterworth(order, 100.0, 1000.0).unwrap();
            let out = filter.filter(&line).unwrap();
            assert_close(&out[150..250], &line[150..250], 1e-5);
        }
        assert_close(&decimate(&[2.5; 300], 10).unwrap(), &[2.5; 30], 1e-9);
    }

    #[test]
    fn halves_the_amplitude_at_the_cutoff() {
        let wave = |hertz: f64| -> Vec<f64> {
            (0..4000).map(|i| (2.0 * PI * hertz * f64::from(i) / 1000.0).sin()).collect()
        };
        let filter = LowPass::butterworth(4, 80.0, 1000.0).unwrap();
        let out = filter.filter(&wave(80.0)).unwrap();
        let peak = out[1000..3000].iter().fold(0.0f64, |peak, v| peak.max(v.abs()));
        assert!((peak - 0.5).abs() < 1e-3, "{peak}");
        let out = decimate(&wave(80.0), 10).unwrap();
        assert!(out[50..350].iter().all(|v| v.abs() < 2e-3), "80 Hz would fold onto 20 Hz");
    }

    #[test]
    fn refuses_what_it_cannot_do() {
        assert!(matches!(LowPass::butterworth(0, 1.0, 10.0), Err(IdentError::Order(0))));
        assert!(matches!(LowPass::butterworth(13, 1.0, 10.0), Err(IdentError::Order(13))));
        for cutoff in [0.0, -1.0, 5.0, 6.0, f64::NAN] {
            assert!(
                matches!(LowPass::butterworth(4, cutoff, 10.0), Err(IdentError::Cutoff { .. })),
                "{cutoff}"
            );
        }
        assert!(LowPass::butterworth(4, 1.0, f64::NAN).is_err());
        let filter = LowPass::butterworth(4, 1.0, 10.0).unwrap();
        assert!(matches!(
            filter.filter(&[0.0; 12]),
            Err(IdentError::TooFewSamples { needed: 13, .. })
        ));
        assert!(filter.filter(&[]).is_err());
        assert!(decimate(&[0.0; 100], 0).is_err());
    }
}
