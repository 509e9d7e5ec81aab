//! The examples for readers run, and find what they say they find. `examples/firmware.rs` has tests
//! of its own.

#[path = "../examples/board_loop.rs"]
mod board_loop;
#[path = "../examples/frames.rs"]
mod frames;

#[test]
fn a_message_becomes_bytes_and_comes_back() {
    frames::main();
}

#[test]
fn a_board_drives_one_command_and_stops() -> Result<(), rig_protocol::HelloError> {
    board_loop::main()
}
