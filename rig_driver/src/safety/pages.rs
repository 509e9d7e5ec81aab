//! The tables as Markdown, for `docs/reference/faults.md`.

use std::fmt::Write;

use super::{Event, FAULTS, Reaction, State, TRANSITIONS};

/// The transitions in words, one a line: what the picture of the states describes itself with.
#[must_use]
pub fn transition_list() -> String {
    let line = |rule: &super::Transition| {
        format!("{} to {}: {}\n", rule.from, rule.to, rule.event.as_str())
    };
    TRANSITIONS.iter().map(line).collect()
}

/// State by event: where each leads; a dash is refused.
#[must_use]
pub fn transition_table() -> String {
    let mut events: Vec<Event> = Vec::new();
    for rule in TRANSITIONS {
        if !events.contains(&rule.event) {
            events.push(rule.event);
        }
    }
    let mut text = String::from("| state |");
    events.iter().for_each(|event| text += &format!(" {} |", event.as_str()));
    text += &format!("\n|---|{}\n", "---|".repeat(events.len()));
    for state in State::ALL {
        text += &format!("| {state} |");
        for &event in &events {
            text += &super::next(state, event)
                .map_or_else(|_| " - |".to_owned(), |to| format!(" {to} |"));
        }
        text.push('\n');
    }
    text
}

/// What each fault does.
#[must_use]
pub fn fault_table() -> String {
    let mut text = String::from(
        "| fault | when | what the motor gets | flag in `/rig_measurement` | ends |\n|---|---|---|---|---|\n",
    );
    for rule in FAULTS {
        let lost = rule.name.ends_with("lost");
        let (motor, flag, ends) = match rule.reaction {
            Reaction::Cut => ("the voltage, cut", "`saturated`", "by itself"),
            Reaction::ZeroWhileItLasts => {
                ("zero volts at once", "`watchdog_expired`", "with the next fresh command in time")
            }
            Reaction::ZeroUntilCleared => (
                "zero volts at once",
                if lost { "`fault`, `watchdog_expired`" } else { "`fault`" },
                "when cleared and activated",
            ),
        };
        let _ = writeln!(text, "| {} | {} | {motor} | {flag} | {ends} |", rule.name, rule.when);
    }
    text + "| emergency stop | somebody asks for it, in any state | zero volts at once | `fault` | when cleared, configured and activated |\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    /// They stand in the documentation as they are made here; `UPDATE_DOCS=1` writes them anew.
    #[test]
    fn the_documentation_shows_the_tables_of_the_code() {
        hold("docs/pictures/safety_states.svg", &[("states", transition_list())]);
        let made = [("transitions", transition_table()), ("faults", fault_table())];
        hold("docs/reference/faults.md", &made);
    }

    fn hold(page: &str, tables: &[(&str, String)]) {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(page);
        let mut text = std::fs::read_to_string(&path).expect("the page is part of the project");
        let update = std::env::var_os("UPDATE_DOCS").is_some();
        for (name, made) in tables {
            let (begin, end) = (format!("<!-- {name} -->\n"), format!("<!-- end of {name} -->\n"));
            let from =
                text.find(&begin).expect("the page marks where the table begins") + begin.len();
            let to = text.find(&end).expect("the page marks where the table ends");
            if update {
                text.replace_range(from..to, made);
            } else {
                assert_eq!(
                    &text[from..to],
                    made,
                    "{page}, {name}: run the test with UPDATE_DOCS=1"
                );
            }
        }
        if update {
            std::fs::write(&path, text).expect("the page can be written");
        }
    }
}
