//! What a file holds as text.

use std::fmt::Write;

use recording::grid::Form;
use recording::overview::{Overview, Times};

use super::prospects::prospects;

/// The text. Writing to a string cannot fail.
#[must_use]
pub fn terminal(seen: &Overview) -> String {
    let mut text = format!("{}\n", seen.path.display());
    for line in written(seen) {
        let _ = writeln!(text, "  {line}");
    }
    if let Some(times) = &seen.times {
        for line in of_times(times) {
            let _ = writeln!(text, "  {line}");
        }
    }
    if let Some(motion) = &seen.motion {
        let _ = writeln!(
            text,
            "  at rest {:.0} %, forwards {:.0} %, backwards {:.0} % of the samples; {} reversals",
            100.0 * motion.rest,
            100.0 * motion.forwards,
            100.0 * motion.backwards,
            motion.reversals
        );
    }
    if !seen.channels.is_empty() {
        let _ = writeln!(text, "\nunderstood");
    }
    for row in channels(seen) {
        let [channel, name, unit, range, step] = row;
        let _ = writeln!(text, "  {channel:<17}{name:<21} {unit:<21} {range}{step}");
    }
    let found = prospects(seen);
    for (title, lines) in [
        ("not understood", &seen.problems),
        ("can be identified", &found.can),
        ("is missing", &found.missing),
    ] {
        if !lines.is_empty() {
            let _ = writeln!(text, "\n{title}");
        }
        for line in lines {
            let _ = writeln!(text, "  {line}");
        }
    }
    text
}

/// How the file is written.
pub(super) fn written(seen: &Overview) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(dialect) = seen.dialect {
        let mut line = match dialect.form {
            Form::Text => format!("columns separated by {}", dialect.separator.describe()),
            other => other.describe().to_owned(),
        };
        if let Some(encoding) = dialect.encoding.describe() {
            let _ = write!(line, "; {encoding}");
        }
        if dialect.decimal_comma {
            line += "; decimals with a comma";
        }
        if dialect.remarks > 0 {
            let _ = write!(line, "; {} remarks", dialect.remarks);
        }
        if dialect.above > 0 {
            let _ = write!(line, "; {} lines above the names left out", dialect.above);
        }
        if dialect.names_in_remark {
            line += "; names taken from the last remark";
        }
        if dialect.headerless {
            line += "; no names, columns are counted from 1";
        }
        if dialect.units_below {
            line += "; units taken from the row below the names";
        }
        lines.push(line);
        lines.push(format!("columns: {}", seen.names.join(", ")));
        if !seen.joints.is_empty() {
            lines.push(format!("joints: {}", seen.joints.join(", ")));
        }
    } else {
        lines.push(format!("topics: {}", seen.names.join(", ")));
        lines.push(format!("joints: {}", seen.joints.join(", ")));
    }
    let mut line = format!("{} samples", seen.samples);
    if seen.blank > 0 {
        let _ = write!(line, "; {} rows without a value (empty or NaN) left out", seen.blank);
    }
    lines.push(line);
    lines
}

/// The times in words.
pub(super) fn of_times(times: &Times) -> Vec<String> {
    if !times.rate.is_finite() {
        return vec!["no two samples have different times, so there is no rate".to_owned()];
    }
    let mut lines = vec![format!(
        "{:.4} s at {} Hz (median); steps from {} to {} s; {} gaps",
        times.duration,
        rounded(times.rate),
        rounded(times.shortest),
        rounded(times.longest),
        times.gaps
    )];
    if times.not_forwards > 0 {
        lines.push(format!("{} steps do not go forwards in time", times.not_forwards));
    }
    if let Some(rate) = times.resample_to {
        lines.push(format!(
            "the samples come at irregular times: --resample {rate} brings them to an even rate"
        ));
    }
    lines
}

/// Channel, column, unit, range and step of each channel.
pub(super) fn channels(seen: &Overview) -> Vec<[String; 5]> {
    let one = |channel: &recording::overview::Seen| {
        let si = channel.channel.unit();
        let unit = match &channel.unit {
            _ if channel.dated => "a date or time of day".to_owned(),
            Some(unit) => format!("{unit} (times {})", rounded(channel.scale)),
            None => format!("taken as {si}"),
        };
        [
            channel.channel.describe().to_owned(),
            channel.name.clone(),
            unit,
            format!("{} to {} {si}", rounded(channel.least), rounded(channel.greatest)),
            channel
                .step
                .map_or_else(String::new, |step| format!(", in steps of {}", rounded(step))),
        ]
    };
    seen.channels.iter().map(one).collect()
}

/// Four significant digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
