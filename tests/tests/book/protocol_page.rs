//! `rig_driver/PROTOCOL.md` says what the code does: its examples decode to what stands under them,
//! and its tables are the code's.

use std::{collections::BTreeSet, fmt::Debug, fs, path::Path};

use rig_protocol::{Cause, Decoder, DeviceMessage, Event, HostMessage, Message, State};

fn page() -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../rig_driver/PROTOCOL.md");
    fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

/// Hexadecimal bytes and the text under them, of every example of a direction.
fn examples(page: &str, direction: &str) -> Vec<(Vec<u8>, String)> {
    page.split("```")
        .filter_map(|block| block.strip_prefix(&format!("frame {direction}\n")))
        .map(|block| {
            let (text, hexadecimal): (Vec<&str>, Vec<&str>) = block
                .lines()
                .partition(|line| line.starts_with(|first: char| first.is_ascii_uppercase()));
            let bytes = hexadecimal.join(" ");
            let bytes =
                bytes.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).expect("a byte"));
            (bytes.collect(), text.join(" "))
        })
        .collect()
}

/// Decodes the examples and says them again. Returns the kinds that were shown.
fn hold<M: Message + Debug>(examples: &[(Vec<u8>, String)]) -> BTreeSet<u8> {
    let mut kinds = BTreeSet::new();
    for (bytes, text) in examples {
        let mut decoder = Decoder::<M>::new();
        let said: Vec<M> =
            bytes.iter().filter_map(|byte| decoder.push(*byte).expect("a frame")).collect();
        let [message] = &said[..] else { panic!("{} messages in {bytes:x?}", said.len()) };
        assert_eq!(&format!("{message:?}"), text);
        assert_eq!(message.frame().as_bytes(), bytes);
        // Version and kind are never zero: they stand unstuffed behind the first byte.
        kinds.insert(bytes[2]);
    }
    kinds
}

#[test]
fn every_message_has_an_example_and_every_example_decodes_to_what_stands_under_it() {
    let page = page();
    assert_eq!(hold::<HostMessage>(&examples(&page, "from host")), (0x01..=0x08).collect());
    assert_eq!(hold::<DeviceMessage>(&examples(&page, "from device")), (0x81..=0x83).collect());
}

#[test]
fn the_table_of_states_is_the_one_in_the_code() {
    let page = page();
    let name = |state: State| match state {
        State::Inactive => "inactive",
        State::Active => "active",
        State::Fault => "fault",
        State::EmergencyStopped => "stopped",
    };
    for state in State::ALL {
        let begin = format!("| {} {} |", state as u8, name(state));
        let row = page.lines().find(|line| line.starts_with(&begin)).expect("a row of the table");
        let cells: Vec<String> =
            row.split('|').map(|cell| cell.replace('*', "").trim().to_owned()).collect();
        for event in Event::ALL {
            assert_eq!(
                cells[3 + event as usize],
                name(state.after(event)),
                "{state:?} on {event:?}"
            );
        }
    }
    for cause in Cause::ALL {
        assert!(page.contains(&format!("\n| {} | ", cause as u8)), "{cause:?} is not explained");
    }
}
