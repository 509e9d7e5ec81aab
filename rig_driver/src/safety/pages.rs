//! The tables as Markdown, for the book. A test of the workspace holds its pages to them.

use std::fmt::Write;

use strum::VariantArray;

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
    for &state in State::VARIANTS {
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
