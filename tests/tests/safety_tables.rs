//! The documentation shows states and faults of the safety layer as the code has them;
//! `UPDATE_DOCS=1` writes them anew.

use std::path::Path;

use rig_driver::safety::{fault_table, transition_list, transition_table};

fn hold(page: &str, tables: &[(&str, String)]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(page);
    let mut text = std::fs::read_to_string(&path).expect("the page is part of the project");
    let update = std::env::var_os("UPDATE_DOCS").is_some();
    for (name, made) in tables {
        let (begin, end) = (format!("<!-- {name} -->\n"), format!("<!-- end of {name} -->\n"));
        let from = text.find(&begin).expect("the page marks where the table begins") + begin.len();
        let to = text.find(&end).expect("the page marks where the table ends");
        if update {
            text.replace_range(from..to, made);
        } else {
            assert_eq!(&text[from..to], made, "{page}, {name}: run this test with UPDATE_DOCS=1");
        }
    }
    if update {
        std::fs::write(&path, text).expect("the page can be written");
    }
}

#[test]
fn the_documentation_shows_states_and_faults_of_the_safety_layer() {
    hold("docs/pictures/safety_states.svg", &[("states", transition_list())]);
    let made = [("transitions", transition_table()), ("faults", fault_table())];
    hold("docs/reference/faults.md", &made);
}
