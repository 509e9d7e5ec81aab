//! Writes a page with every kind of block, for work on the look of the report:
//! `cargo run -p report --example report_demo -- page.html`.

mod page;

use std::io::Write;

fn main() -> std::io::Result<()> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "report_demo.html".to_owned());
    std::fs::write(&path, report::render_page(&page::demonstration()))?;
    writeln!(std::io::stdout(), "wrote {path}")
}
