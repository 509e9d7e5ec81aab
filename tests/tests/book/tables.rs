//! The book shows the tables of the code: parameters, topics, services, actions, what becomes of
//! hostile input, states and faults of the safety layer. `UPDATE_DOCS=1` writes them anew.

use std::fs;

use experiment_runner::server::parameters::RunnerParameters;
use friction_model::ModelName;
use msgs::interfaces::{action_table, service_table, topic_table};
use rig_driver::safety::{fault_table, transition_list, transition_table};
use ros_node::hostile;
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

/// Holds a page to a table: it stands between `<!-- NAME -->` and `<!-- end of NAME -->`.
fn hold(page: &str, name: &str, made: &str) {
    let path = tests::checkout().join(page);
    let text = fs::read_to_string(&path).expect("the page is part of the project");
    let (begin, end) = (format!("<!-- {name} -->\n"), format!("<!-- end of {name} -->"));
    let from = text.find(&begin).expect("the page marks where the table begins") + begin.len();
    let to = text.find(&end).expect("the page marks where the table ends");
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&path, [&text[..from], made, &text[to..]].concat()).expect("it can be written");
    } else {
        assert_eq!(&text[from..to], made, "{page}, {name}: run this test with UPDATE_DOCS=1");
    }
}

#[test]
fn the_book_shows_the_parameters_of_the_nodes() {
    for (node, declared) in declared() {
        hold("docs/reference/parameters.md", node, &markdown_table(&declared));
    }
}

#[test]
fn the_book_shows_topics_services_and_actions() {
    let page = "docs/reference/topics.md";
    hold(page, "topics", &topic_table());
    hold(page, "services", &service_table());
    hold(page, "actions", &action_table());
}

#[test]
fn the_book_shows_what_becomes_of_hostile_input() {
    hold("docs/reference/nodes.md", "hostile", &hostile::markdown_table());
}

#[test]
fn the_book_shows_states_and_faults_of_the_safety_layer() {
    // The picture says in words what it draws.
    hold("docs/pictures/safety_states.svg", "states", &transition_list());
    let page = "docs/reference/faults.md";
    hold(page, "transitions", &transition_table());
    hold(page, "faults", &fault_table());
}
