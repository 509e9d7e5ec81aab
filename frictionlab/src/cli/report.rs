//! `frictionlab report`: the page of a run made anew.

use std::path::{Path, PathBuf};

use files::{OutputFile, write_all};
use identification::look::page;
use recording::column_options::ColumnArgs;
use recording::joints::JointChoice;
use recording::overview;
use recording::table::Measured;
use report::figure::Block;
use report::render_page;
use run_folder::{Remade, Run};
use serde_json::json;
use work::BadInput;
use work::saying::{Saying, document};

/// Make the page of a run anew, from what its folder holds
///
/// FOLDER is that of any command that leaves a report. Its page gets the looks of this program. What a
/// report draws stands in it; where report.html is lost or cut off, the page is made of the document
/// (run.json and the like) and the bag, and says what is missing. A damaged report.html is replaced by
/// such a page only with --force. The page appears whole or not at all.
///
///   frictionlab report runs/all-1
///   frictionlab report runs/all-1 --out somewhere/else.html
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct ReportArgs {
    /// Folder of the run.
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,

    /// File for the page [default: report.html in FOLDER]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,

    /// Replace a file that has more than this page, or that is in the way.
    #[arg(long)]
    force: bool,

    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
    #[command(flatten)]
    saying: Saying,
}

/// Name of the page.
const REPORT: &str = "report.html";

/// Makes the page and writes it.
///
/// # Errors
/// [`BadInput`] for a folder that is none of a run, and a page that would replace a better one;
/// [`OutputError`](files::OutputError) where it cannot be written.
pub fn execute(args: &ReportArgs) -> anyhow::Result<()> {
    args.saying.begin();
    let folder = &args.folder;
    let Remade { page, missing, poorer, run } =
        Run::page(folder, of_bag).map_err(|error| BadInput(error.to_string()))?;
    let html = render_page(&page);
    let written = match &args.out {
        Some(file) => {
            OutputFile::new(file, args.force)?.write(html.as_bytes())?;
            file.clone()
        }
        None if poorer && !args.force => {
            return Err(BadInput(format!(
                "{} cannot be read again, and a page made of the other files has fewer pictures: --out names another file, --force replaces it",
                folder.join(REPORT).display()
            ))
            .into());
        }
        None => {
            write_all(folder, &[(REPORT, html)])?;
            folder.join(REPORT)
        }
    };
    let told = json!({
        "format": "frictionlab-report-made",
        "format_version": 1,
        "report": written,
        "kind": run.kind,
        "missing": missing,
    });
    let lines: String = missing.iter().map(|what| format!("Missing: {what}.\n")).collect();
    let text = format!("{lines}Report  {}\n", written.display());
    args.saying.result(args.quiet, &document(&told)?, &text)
}

/// What a recording shows by itself.
fn of_bag(bag: &Path) -> Result<Vec<Block>, String> {
    let choice = JointChoice { name: None, effort: None };
    let columns = ColumnArgs::default().columns(Measured::Force, None);
    let seen = overview::look(bag, &columns, &choice).map_err(|error| error.to_string())?;
    let heading = Block::Heading("The recording".to_owned());
    let shown = page(&seen).blocks.into_iter().filter(|block| !matches!(block, Block::Heading(_)));
    Ok([heading].into_iter().chain(shown).collect())
}
