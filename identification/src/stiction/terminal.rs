//! What the terminal shows.

use std::fmt::Write;

use friction_ident::Estimate;

use super::{StictionIdentification, UNKNOWN};
use crate::servo::terminal::{number, range, verdict};
use recording::stiction_table::StictionTable;

/// A summary for people.
pub fn render(found: &StictionIdentification, tables: &[StictionTable]) -> String {
    let mut text = String::from("breakaway voltage, median over all recordings\n");
    for estimate in &found.breakaway {
        line(&mut text, estimate);
    }
    for (table, episode) in tables.iter().zip(&found.episodes) {
        // Writing to a string cannot fail, hence the ignored results.
        let _ = writeln!(
            text,
            "\n{}: {} breakaways, at rest {:.0} % of the limit cycle",
            table.path.display(),
            episode.breakaways.len(),
            100.0 * episode.rest_share
        );
        for (name, quartiles) in ["forward", "backward"].iter().zip(&episode.quartiles) {
            if let Some(q) = quartiles {
                let _ = writeln!(
                    text,
                    "  breakaway {name:<9} {:.3} V (quartiles {:.3} to {:.3})",
                    q.median, q.lower, q.upper
                );
            }
        }
        match &episode.slip {
            Ok(slip) => {
                let _ = writeln!(
                    text,
                    "  sliding, {} samples, {:.1} % of the voltage unexplained",
                    slip.samples,
                    100.0 * slip.unexplained
                );
                for estimate in slip.estimates.parameters.iter().chain([&slip.delay]) {
                    line(&mut text, estimate);
                }
            }
            Err(error) => {
                let _ = writeln!(text, "  sliding: {error}");
            }
        }
    }
    text.push_str("\nwhat these recordings cannot say\n");
    for unknown in UNKNOWN {
        let _ = writeln!(text, "  - {unknown}");
    }
    text
}

fn line(text: &mut String, estimate: &Estimate) {
    let _ = writeln!(
        text,
        "  {:<19} {:>10} {:<10} {:<22} {}",
        estimate.id,
        number(estimate.value),
        estimate.unit,
        range(estimate),
        verdict(estimate)
    );
}
