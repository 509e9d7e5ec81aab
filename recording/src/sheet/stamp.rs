//! Times written as dates and times of day: `2024-03-01T12:00:00.001`.
//!
//! The order of day and month differs from land to land. With points the day comes first, as in
//! `13.02.2026`; with strokes whichever is no month. Where both may be months it is not known, and
//! the date counts as the day alone.

use chrono::{DateTime, NaiveDate, NaiveDateTime, NaiveTime};

/// Forms of a date with a time of day, without an offset from UTC.
const DATES: [&str; 3] = ["%Y-%m-%dT%H:%M:%S%.f", "%Y-%m-%d %H:%M:%S%.f", "%Y/%m/%d %H:%M:%S%.f"];
/// The same with an offset.
const WITH_OFFSET: [&str; 2] = ["%Y-%m-%dT%H:%M:%S%.f%#z", "%Y-%m-%d %H:%M:%S%.f%#z"];
/// Forms of a time of day.
const TIMES: [&str; 3] = ["%H:%M:%S%.f", "%I:%M:%S%.f %p", "%I:%M:%S%.f%p"];

/// A moment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Stamp {
    /// Since 1970, or since midnight where there is no date \[ns\].
    pub nanoseconds: i64,
    /// The date as it is written, where its day and month may be either.
    pub unsure: Option<Written>,
}

/// The numbers of a date as they are written, the year last.
type Written = (u32, u32, i32);

/// The moment in a cell; none for what is no such time.
pub(super) fn read(cell: &str) -> Option<Stamp> {
    // Every form has the colon. What comes behind the last one may have a decimal comma.
    let (before, seconds) = cell.trim().rsplit_once(':')?;
    let text = format!("{before}:{}", seconds.replacen(',', ".", 1));
    let text = text.strip_suffix(['Z', 'z']).unwrap_or(&text).trim_end();
    let sure = |nanoseconds: i64| Stamp { nanoseconds, unsure: None };
    let dated = DATES.iter().find_map(|form| NaiveDateTime::parse_from_str(text, form).ok());
    if let Some(found) = dated {
        return found.and_utc().timestamp_nanos_opt().map(sure);
    }
    // The colon of an offset is not that of the seconds.
    let offset = cell.trim().replacen(',', ".", 1);
    let dated = WITH_OFFSET.iter().find_map(|form| DateTime::parse_from_str(&offset, form).ok());
    if let Some(found) = dated {
        return found.timestamp_nanos_opt().map(sure);
    }
    if let Some(time) = time_of_day(text) {
        return (time - NaiveTime::MIN).num_nanoseconds().map(sure);
    }
    let (date, time) = text.split_once(' ')?;
    let (date, unsure) = day_and_month(date)?;
    let time = time_of_day(time.trim())?;
    let nanoseconds = date.and_time(time).and_utc().timestamp_nanos_opt()?;
    Some(Stamp { nanoseconds, unsure })
}

/// The moment of a date and a time of day that stand in two cells.
pub(super) fn read_dated(date: &str, time: &str) -> Option<Stamp> {
    let has_date = date.contains(|c: char| c.is_ascii_digit());
    if has_date { read(&format!("{} {}", date.trim(), time.trim())) } else { None }
}

fn time_of_day(text: &str) -> Option<NaiveTime> {
    TIMES.iter().find_map(|form| NaiveTime::parse_from_str(text, form).ok())
}

/// A date that ends with the year, and itself where its order is not known.
fn day_and_month(text: &str) -> Option<(NaiveDate, Option<Written>)> {
    let mark = text.chars().find(|c| !c.is_ascii_digit())?;
    let mut parts = text.split(mark);
    let [Some(first), Some(second), Some(year), None] = [(); 4].map(|()| parts.next()) else {
        return None;
    };
    if year.len() != 4 || !matches!(mark, '.' | '/' | '-') {
        return None;
    }
    let (first, second): (u32, u32) = (first.parse().ok()?, second.parse().ok()?);
    let year: i32 = year.parse().ok()?;
    let months = (first <= 12, second <= 12);
    let (day, month) = if mark == '.' || months.1 { (first, second) } else { (second, first) };
    let unsure = mark != '.' && months == (true, true) && first != second;
    Some((NaiveDate::from_ymd_opt(year, month, day)?, unsure.then_some((first, second, year))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_and_times_of_day_are_read_to_the_nanosecond() {
        let at = |text: &str| read(text).map(|stamp| stamp.nanoseconds);
        let noon = 1_709_294_400_000_000_000;
        for text in [
            "2024-03-01T12:00:00",
            "2024-03-01 12:00:00.000",
            "2024-03-01T12:00:00Z",
            "2024-03-01 12:00:00+00:00",
            "2024-03-01T13:00:00+0100",
            "2024-03-01T13:00:00+01:00",
            "2024/03/01 12:00:00",
            "01.03.2024 12:00:00",
            "1.3.2024 12:00:00,000",
            "01.03.2024 12:00:00 PM",
        ] {
            assert_eq!(at(text), Some(noon), "{text}");
        }
        assert_eq!(at("2024-03-01 12:00:00.000000007"), Some(noon + 7));
        assert_eq!(at("2024-03-01 12:00:00,5"), Some(noon + 500_000_000));
        assert_eq!(at("00:01:00.25"), Some(60_250_000_000));
        for text in
            ["", "12", "1.5", "32.03.2024 12:00:00", "01.03.24 12:00:00", "noon", "25:00:00", "a:b"]
        {
            assert_eq!(at(text), None, "{text}");
        }
    }

    #[test]
    fn day_and_month_are_told_apart_where_they_can_be() {
        let day = |text: &str| read(text).unwrap();
        assert_eq!(day("13/02/2026 10:11:12"), day("2026-02-13 10:11:12"));
        assert_eq!(day("02/13/2026 10:11:12 AM"), day("2026-02-13 10:11:12"));
        assert_eq!(day("13-02-2026 10:11:12.5"), day("2026-02-13 10:11:12.5"));
        assert_eq!(day("02/02/2026 10:11:12").unsure, None);
        assert_eq!(day("03/02/2026 10:11:12").unsure, Some((3, 2, 2026)));
        assert_eq!(read("13/13/2026 10:11:12"), None);
    }
}
