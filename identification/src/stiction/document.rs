//! `stiction.json`.
//!
//! ```text
//! format, format_version, program_version
//! settings       resolution_rad, from_s, until_s, cutoff_hz, slowest_rad_s
//! breakaway      median over all recordings: name, unit, value, interval (ranks), verdict
//! episodes       file, cycles, rest_share, breakaways, quartiles (forward, backward) [V]
//!   slip         estimates in volts, samples, delay (an estimate in seconds), unexplained share; or error
//! unknown        what such recordings cannot say
//! ```

use serde_json::json;

use super::{StictionIdentification, UNKNOWN};
use recording::stiction_table::StictionTable;

/// The document as text.
pub fn render(found: &StictionIdentification, tables: &[StictionTable]) -> String {
    let episodes: Vec<_> = tables
        .iter()
        .zip(&found.episodes)
        .map(|(table, episode)| {
            json!({
                "file": table.path.display().to_string(),
                "rest_share": episode.rest_share,
                "breakaways": episode.breakaways,
                "quartiles": { "forward": episode.quartiles[0], "backward": episode.quartiles[1] },
                "slip": match &episode.slip {
                    Ok(slip) => json!(slip),
                    Err(error) => json!({ "error": error.to_string() }),
                },
            })
        })
        .collect();
    let settings = &found.settings;
    let document = json!({
        "format": "frictionlab-stiction",
        "format_version": 1,
        "program_version": env!("CARGO_PKG_VERSION"),
        "settings": {
            "resolution_rad": settings.resolution,
            "from_s": settings.from,
            "until_s": settings.until,
            "gap_s": settings.gap,
            "cutoff_hz": settings.slip.cutoff,
            "slowest_rad_s": settings.slip.slowest,
        },
        "breakaway": found.breakaway,
        "episodes": episodes,
        "unknown": UNKNOWN,
    });
    format!("{document:#}\n")
}
