//! Times written as dates and times of day: `2024-03-01T12:00:00.001`.

use chrono::{DateTime, NaiveDateTime, NaiveTime};

/// Forms of a date with a time of day, without an offset from UTC.
const DATES: [&str; 3] = ["%Y-%m-%dT%H:%M:%S%.f", "%Y-%m-%d %H:%M:%S%.f", "%Y/%m/%d %H:%M:%S%.f"];
/// The same with an offset.
const WITH_OFFSET: [&str; 2] = ["%Y-%m-%dT%H:%M:%S%.f%#z", "%Y-%m-%d %H:%M:%S%.f%#z"];

/// Nanoseconds since 1970, or since midnight where there is no date; none for what is no such time.
/// The order of day and month differs from land to land, so that only dates that begin with the
/// year are read.
pub(super) fn nanoseconds(cell: &str, decimal_comma: bool) -> Option<i64> {
    let text = if decimal_comma { cell.replace(',', ".") } else { cell.to_owned() };
    let text = text.strip_suffix(['Z', 'z']).unwrap_or(&text).trim_end();
    let date = || {
        let found = DATES.iter().find_map(|form| NaiveDateTime::parse_from_str(text, form).ok());
        found?.and_utc().timestamp_nanos_opt()
    };
    let with_offset = || {
        let found = WITH_OFFSET.iter().find_map(|form| DateTime::parse_from_str(text, form).ok());
        found?.timestamp_nanos_opt()
    };
    let time = || {
        let found = NaiveTime::parse_from_str(text, "%H:%M:%S%.f").ok()?;
        (found - NaiveTime::MIN).num_nanoseconds()
    };
    // Every form has the colon.
    text.contains(':').then(|| date().or_else(with_offset).or_else(time)).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_and_times_of_day_are_read_to_the_nanosecond() {
        let at = |text: &str| nanoseconds(text, false);
        let noon = 1_709_294_400_000_000_000;
        for text in [
            "2024-03-01T12:00:00",
            "2024-03-01 12:00:00.000",
            "2024-03-01T12:00:00Z",
            "2024-03-01 12:00:00+00:00",
            "2024-03-01T13:00:00+0100",
            "2024/03/01 12:00:00",
        ] {
            assert_eq!(at(text), Some(noon), "{text}");
        }
        assert_eq!(at("2024-03-01 12:00:00.000000007"), Some(noon + 7));
        assert_eq!(nanoseconds("2024-03-01 12:00:00,5", true), Some(noon + 500_000_000));
        assert_eq!(at("00:01:00.25"), Some(60_250_000_000));
        for text in ["", "12", "1.5", "01.03.2024 12:00:00", "noon", "25:00:00", "a:b"] {
            assert_eq!(at(text), None, "{text}");
        }
    }
}
