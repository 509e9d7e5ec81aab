//! The report as text.

use std::fmt::Write as _;

use super::{Finding, Report, Verdict};

/// Wide enough for the longest verdict.
const VERDICT: usize = 12;

/// The report as people read it in a terminal.
#[must_use]
pub fn render(report: &Report) -> String {
    let mut text = String::new();
    for section in &report.sections {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", section.name);
        section.findings.iter().for_each(|finding| write_finding(&mut text, finding));
        text.push('\n');
    }
    let (look, broken) =
        (report.of(Verdict::LookAtThis).count(), report.of(Verdict::Broken).count());
    let all = report.sections.iter().map(|section| section.findings.len()).sum::<usize>();
    let _ = match (look, broken) {
        (0, 0) => writeln!(text, "All {all} are fine."),
        _ => writeln!(
            text,
            "{} of {all} are fine, {look} to look at, {broken} broken.",
            all - look - broken
        ),
    };
    text
}

fn write_finding(text: &mut String, finding: &Finding) {
    let _ = writeln!(
        text,
        "  {:<VERDICT$}  {}: {}",
        finding.verdict.label(),
        finding.subject,
        finding.found
    );
    let indent = " ".repeat(VERDICT + 4);
    for figure in &finding.figures {
        let unit = if figure.unit.is_empty() { String::new() } else { format!(" {}", figure.unit) };
        let _ = writeln!(text, "{indent}  {:<38} {}{unit}", figure.name, number(figure.value));
    }
    if let Some(mend) = &finding.mend {
        let _ = writeln!(text, "{indent}  to mend it: {mend}");
    }
}

/// Four digits, or all of them before the point.
fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == value.round() || magnitude >= 1000.0 {
        format!("{value:.0}")
    } else if magnitude >= 0.1 {
        let decimals = 3 - magnitude.log10().floor().max(0.0) as usize;
        format!("{value:.decimals$}")
    } else {
        format!("{value:.2e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::doctor::Section;

    #[test]
    fn every_finding_has_its_verdict_its_figures_with_units_and_how_to_mend_it() {
        let findings = vec![
            Finding::fine("clock", "is good").with("resolution", 1.0, "ns"),
            Finding::broken("domain", "is none", "choose another").with(
                "lateness p99",
                12.345,
                "us",
            ),
        ];
        let report = Report::new(vec![Section { name: "All", findings }]);
        let text = render(&report);
        for line in [
            "  fine          clock: is good",
            "resolution                             1 ns",
            "  BROKEN        domain: is none",
            "lateness p99                           12.35 us",
            "to mend it: choose another",
            "1 of 2 are fine, 0 to look at, 1 broken.",
        ] {
            assert!(text.contains(line), "`{line}` is not in\n{text}");
        }
        assert_eq!(report.verdict, Verdict::Broken);
        assert_eq!(
            (number(0.25), number(1234.5), number(0.0), number(3e-5)),
            ("0.250".into(), "1234".into(), "0".into(), "3.00e-5".into())
        );
    }
}
