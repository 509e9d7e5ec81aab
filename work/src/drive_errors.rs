//! `--drive-errors K,R,J`: how well the constants of a drive are known.

use crate::BadInput;

/// Standard errors of torque constant, armature resistance and inertia as fractions, from
/// percentages.
///
/// # Errors
/// [`BadInput`] for a percentage outside 0 to 100, or not three of them.
pub fn fractions(percentages: &[f64]) -> Result<[f64; 3], BadInput> {
    let expected =
        "--drive-errors takes three percentages from 0 to 100, as in --drive-errors 1,2,2";
    if let Some(percent) = percentages.iter().find(|percent| !(0.0..=100.0).contains(*percent)) {
        return Err(BadInput(format!("{expected}, but one is {percent}")));
    }
    let three = <[f64; 3]>::try_from(percentages)
        .map_err(|_| BadInput(format!("{expected}, but there are {}", percentages.len())))?;
    Ok(three.map(|percent| 0.01 * percent))
}
