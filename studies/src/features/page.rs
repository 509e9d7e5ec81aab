//! The report's page as data.

use super::{FeaturesResults, pictures, tables};
use report::figure::{Block, Page};

/// The page.
#[must_use]
pub fn page(results: &FeaturesResults) -> Page {
    let FeaturesResults { models, limit_cycle } = results;
    let heading = |text: &str| Block::Heading(text.to_owned());
    let text = |text: &str| Block::Text(text.to_owned());
    let blocks = vec![
        heading("Which model shows what"),
        text(
            "Every model with the parameters of the thesis's chapter 3 (N, m, s), and for frictional lag with those of the test bed (N m, rad, s). Click a name in a \
             legend to hide a curve, double-click to see it alone. Steps were halved until the figures held to 1e-4; random or switching models settle less far, and the last change stands beside their figures.",
        ),
        Block::Note(
            "The stiffnesses of the thesis's chapter 3 sets differ by a factor of 200 between models (GMS 460 N/m, proposed 2356, Xiong 46 000, LuGre 100 000): \
             displacements cannot be compared across models, only whether a feature is there."
                .to_owned(),
        ),
        Block::Table(tables::overview(models)),
        heading("Stick-slip"),
        Block::Figure(pictures::stick_slip(models)),
        Block::Table(tables::stick_slip(models)),
        heading("Drift and memory"),
        Block::Figure(pictures::drift(models)),
        Block::Figure(pictures::memory(models)),
        Block::Table(tables::memory(models)),
        heading("Breakaway"),
        Block::Figure(pictures::breakaway(models)),
        Block::Figure(pictures::breakaway_rates(models)),
        Block::Table(tables::breakaway(models)),
        heading("Sliding: lag and steady state"),
        Block::Figure(pictures::lag(models)),
        Block::Figure(pictures::lag_areas(models)),
        Block::Table(tables::lag(models)),
        Block::Figure(pictures::steady_state(models)),
        heading("Through zero velocity"),
        Block::Figure(pictures::zero_crossing(models)),
        Block::Table(tables::reversal(models)),
        heading("Sensitivity"),
        Block::Table(tables::sensitivity(models)),
        heading("Describing function and limit cycle"),
        Block::Figure(pictures::describing(models)),
        Block::Figure(pictures::nyquist(limit_cycle)),
        Block::Figure(pictures::hunting(limit_cycle)),
        Block::Table(tables::limit_cycle(limit_cycle)),
    ];
    Page {
        title: "Features of friction models".to_owned(),
        subtitle: format!("{} models; frictionlab {}", models.len(), env!("CARGO_PKG_VERSION")),
        blocks,
    }
}
