//! Numbers in JSON that come back bit for bit, those that are no number too, for which JSON has no
//! word.

/// A column of numbers as one text, sixteen digits each: `#[serde(with = "exact::column")]`.
pub(crate) mod column {
    use std::fmt::Write;

    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    /// Digits of a number.
    const DIGITS: usize = 16;

    pub(crate) fn serialize<S: Serializer>(values: &[f64], to: S) -> Result<S::Ok, S::Error> {
        let mut text = String::with_capacity(DIGITS * values.len());
        for value in values {
            // Writing to a string cannot fail.
            let _ = write!(text, "{:016x}", value.to_bits());
        }
        to.serialize_str(&text)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
        let text = String::deserialize(from)?;
        if !text.len().is_multiple_of(DIGITS) {
            return Err(D::Error::custom("a column of numbers was cut"));
        }
        let digits = text.as_bytes().chunks_exact(DIGITS).map(|digits| {
            let digits = std::str::from_utf8(digits).map_err(D::Error::custom)?;
            u64::from_str_radix(digits, 16).map(f64::from_bits).map_err(D::Error::custom)
        });
        digits.collect()
    }
}

/// Reads the `null` that JSON has for what is no number:
/// `#[serde(deserialize_with = "exact::or_nan")]`.
pub(crate) fn or_nan<'de, D: serde::Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    <Option<f64> as serde::Deserialize>::deserialize(from).map(|value| value.unwrap_or(f64::NAN))
}

#[cfg(test)]
mod tests {
    use serde::{Deserialize, Serialize};

    #[derive(Serialize, Deserialize)]
    struct Both {
        #[serde(with = "super::column")]
        column: Vec<f64>,
        #[serde(deserialize_with = "super::or_nan")]
        one: f64,
    }

    #[test]
    fn every_number_comes_back_bit_for_bit() {
        let column =
            vec![0.0, -0.0, 0.1, f64::MIN_POSITIVE / 8.0, f64::MAX, f64::NAN, f64::NEG_INFINITY];
        let text = serde_json::to_string(&Both { column: column.clone(), one: f64::NAN }).unwrap();
        let back: Both = serde_json::from_str(&text).unwrap();
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back.column), bits(&column));
        assert!(back.one.is_nan());
        for wrong in ["", "0", "é0000000000000é", "zzzzzzzzzzzzzzzz"]
            .map(|column| format!("{{\"column\":\"{column}\",\"one\":1}}"))
        {
            let read = serde_json::from_str::<Both>(&wrong);
            assert!(read.is_err() || read.is_ok_and(|both| both.column.is_empty()), "{wrong}");
        }
    }
}
