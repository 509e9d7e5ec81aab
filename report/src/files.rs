//! What lies beside a page, for its reader to open.

use super::figure::{Block, FileLink, Page};

/// A bag's folder.
const BAG: &str = "bag";

/// The page with links to those of `names` that are results: files that stand beside it, or `bag`,
/// once all is written.
#[must_use]
pub fn linked<'a>(mut page: Page, names: impl IntoIterator<Item = &'a str>) -> Page {
    let links: Vec<FileLink> = names
        .into_iter()
        .filter_map(|name| {
            let path = if name == BAG { format!("{BAG}/") } else { name.to_owned() };
            Some(FileLink { path, what: what(name)?.to_owned() })
        })
        .collect();
    if !links.is_empty() {
        page.blocks.push(Block::Heading("Files beside this page".to_owned()));
        page.blocks.push(Block::Files(links));
    }
    page
}

/// What a file of this name holds; nothing for those that are no results.
fn what(name: &str) -> Option<&'static str> {
    Some(match name {
        BAG => "the recording: `ros2 bag`, Foxglove and PlotJuggler open it",
        "parameters.yaml" => "parameters, as `--parameters` and the nodes take them",
        "controller.yaml" => "the controller's gains, as `--parameters` and the nodes take them",
        "drive.yaml" => "the drive's constants",
        "run.json" => "every figure and option of the run, for programs",
        _ if name.ends_with(".csv") => "a table of what was measured",
        _ if name.ends_with(".json") => "every figure of this page and more, for programs",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_linked_and_nothing_else() {
        let names = ["bag", "run.json", "steady_points.csv", "report.html", "odd.tmp"];
        let page = linked(Page::default(), names);
        let Some(Block::Files(links)) = page.blocks.last() else { panic!("{:?}", page.blocks) };
        let paths: Vec<&str> = links.iter().map(|link| link.path.as_str()).collect();
        assert_eq!(paths, ["bag/", "run.json", "steady_points.csv"]);
        assert!(linked(Page::default(), ["report.html"]).blocks.is_empty());
    }
}
