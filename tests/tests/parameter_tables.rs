//! The documentation shows the parameters that the nodes declare; `UPDATE_DOCS=1` writes the tables
//! anew.

use std::path::{Path, PathBuf};

use experiment_runner::server::parameters::RunnerParameters;
use friction_model::ModelName;
use ros_node::parameters::{Declaration, Declared, markdown_table};

/// Declarations of each node by the name that its table has in the pages. Of the observer, those of
/// the models have pages of their own.
fn declared() -> [(&'static str, Vec<Declaration>); 4] {
    let of_a_model = |parameter: &Declaration| {
        let group = parameter.name().split_once('.').map(|(group, _)| group);
        group.is_some_and(|group| group.parse::<ModelName>().is_ok())
    };
    let mut observer = friction_observer::parameters::declarations(&[]);
    observer.retain(|parameter| !of_a_model(parameter));
    [
        ("rig_driver", rig_driver::node::declarations("simulated")),
        ("friction_observer", observer),
        ("controller", controller::node::declarations(&[])),
        ("experiment_runner", RunnerParameters::default().declarations()),
    ]
}

/// Every page of the documentation.
fn pages() -> Vec<PathBuf> {
    fn into(found: &mut Vec<PathBuf>, folder: &Path) {
        for entry in std::fs::read_dir(folder).expect("a folder of pages").flatten() {
            let path = entry.path();
            if path.is_dir() {
                into(found, &path);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                found.push(path);
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut found = vec![root.join("README.md")];
    into(&mut found, &root.join("docs"));
    found
}

#[test]
fn the_documentation_shows_the_parameters_of_the_nodes() {
    for (node, declared) in declared() {
        let made = markdown_table(&declared);
        let (begin, end) = (format!("<!-- {node} -->\n"), format!("<!-- end of {node} -->"));
        let mut shown = 0;
        for page in pages() {
            let mut text = std::fs::read_to_string(&page).expect("a page");
            let Some((before, _)) = text.split_once(&begin) else { continue };
            let from = before.len() + begin.len();
            let to = text.find(&end).expect("the page marks where the table ends");
            shown += 1;
            if std::env::var_os("UPDATE_DOCS").is_some() {
                text.replace_range(from..to, &made);
                std::fs::write(&page, text).expect("the page can be written");
            } else {
                let page = page.display();
                assert_eq!(&text[from..to], made, "{page}: run this test with UPDATE_DOCS=1");
            }
        }
        assert!(shown > 0, "no page shows the parameters of {node}");
    }
}
