//! `--want`: how well the friction is to be known.

use std::fmt;
use std::str::FromStr;

use super::Curve;
use crate::Ranged;

/// A parameter of the friction curve in volts.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    PartialOrd,
    Ord,
    serde::Serialize,
    serde::Deserialize,
    strum::Display,
    strum::EnumString,
)]
pub enum CurveParameter {
    /// Coulomb friction \[V\].
    #[serde(rename = "f_c")]
    #[strum(serialize = "f_c")]
    FC,
    /// Static friction \[V\].
    #[serde(rename = "f_s")]
    #[strum(serialize = "f_s")]
    FS,
    /// Stribeck velocity \[rad/s\].
    #[serde(rename = "v_s")]
    #[strum(serialize = "v_s")]
    VS,
    /// Slope of back-EMF and viscous friction together, 1/K \[V s/rad\].
    #[serde(rename = "slope")]
    #[strum(serialize = "slope")]
    Slope,
}

impl CurveParameter {
    /// Its value in a curve.
    #[must_use]
    pub const fn of(self, curve: &Curve) -> Ranged {
        match self {
            Self::FC => curve.f_c,
            Self::FS => curve.f_s,
            Self::VS => curve.v_s,
            Self::Slope => curve.slope,
        }
    }

    /// Its unit.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::FC | Self::FS => "V",
            Self::VS => "rad/s",
            Self::Slope => "V s/rad",
        }
    }
}

/// Which half widths of 95 % intervals are wanted, as shares of the values.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Wanted(Vec<(CurveParameter, f64)>);

/// A text that says no wishes.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{part}` is no wish: {why}; expected NAME:PERCENT% parted by commas, as in f_c:2%,f_s:3%,v_s:20%, with the names f_c, f_s, v_s, slope"
)]
pub struct WantedError {
    part: String,
    why: &'static str,
}

impl Default for Wanted {
    /// What a compensation needs: the levels to a few per cent, and the Stribeck velocity roughly.
    fn default() -> Self {
        Self(vec![
            (CurveParameter::FC, 0.02),
            (CurveParameter::FS, 0.03),
            (CurveParameter::VS, 0.2),
        ])
    }
}

impl Wanted {
    /// Each parameter and the share.
    pub fn iter(&self) -> impl Iterator<Item = (CurveParameter, f64)> + '_ {
        self.0.iter().copied()
    }

    /// The same without the parameters of a dip, which have no meaning where there is none.
    #[must_use]
    pub fn without_dip(&self) -> Self {
        let of_a_dip = |parameter| matches!(parameter, CurveParameter::FS | CurveParameter::VS);
        Self(self.iter().filter(|(parameter, _)| !of_a_dip(*parameter)).collect())
    }

    /// What is not met yet: the parameter and how many times too wide its interval is; infinite
    /// where it has no end.
    #[must_use]
    pub fn missing(&self, curve: &Curve) -> Vec<(CurveParameter, f64)> {
        let times = |(parameter, share): (CurveParameter, f64)| {
            let width = parameter.of(curve).relative().unwrap_or(f64::INFINITY);
            (parameter, width / share)
        };
        self.iter().map(times).filter(|(_, times)| *times > 1.0).collect()
    }
}

impl FromStr for Wanted {
    type Err = WantedError;

    fn from_str(text: &str) -> Result<Self, WantedError> {
        let mut wanted: Vec<(CurveParameter, f64)> = Vec::new();
        for part in text.split(',') {
            let refused = |why| WantedError { part: part.to_owned(), why };
            let (name, share) =
                part.split_once(':').ok_or_else(|| refused("the colon is missing"))?;
            let name: CurveParameter =
                name.trim().parse().map_err(|_| refused("there is no such parameter"))?;
            let percent: f64 = share
                .trim()
                .trim_end_matches('%')
                .parse()
                .map_err(|_| refused("the per cent are no number"))?;
            if !(0.01..=100.0).contains(&percent) {
                return Err(refused("from 0.01 to 100 % can be wanted"));
            }
            if wanted.iter().any(|(known, _)| *known == name) {
                return Err(refused("it is said twice"));
            }
            wanted.push((name, 0.01 * percent));
        }
        Ok(Self(wanted))
    }
}

impl fmt::Display for Wanted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<String> =
            self.iter().map(|(name, share)| format!("{name}:{}%", share * 100.0)).collect();
        f.write_str(&parts.join(","))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wishes_are_read_and_what_is_none_is_refused_with_a_reason() {
        let wanted: Wanted = "f_c:5%, v_s:30".parse().unwrap();
        assert_eq!(wanted.iter().count(), 2);
        assert_eq!(wanted.to_string().parse::<Wanted>().unwrap(), wanted);
        for (text, why) in [
            ("f_c", "colon"),
            ("f_x:5%", "no such"),
            ("f_c:much", "no number"),
            ("f_c:0%", "0.01"),
            ("f_c:NaN", "0.01"),
            ("f_c:5%,f_c:6%", "twice"),
            ("", "colon"),
        ] {
            let said = text.parse::<Wanted>().unwrap_err().to_string();
            assert!(said.contains(why) && said.contains("f_c:2%"), "{said}");
        }
    }
}
