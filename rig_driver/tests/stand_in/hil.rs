//! A stand-in for the vendor's HIL library, built by the tests with `rustc`. It writes every call
//! into a file, can refuse any of them, and can hand its card to a process of its own (`card.rs`),
//! which outlives a driver that is killed.
//!
//! What it does stands in the card's identifier: `log=FILE`, `fail=FUNCTION@N` (the Nth call of
//! it), `expired=N` (the watchdog has expired at the Nth reload), `card=PROGRAM`; parted by
//! semicolons.

#![allow(non_snake_case, unsafe_code, unused_unsafe)]

use std::ffi::{CStr, c_char, c_void};
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// Refused calls have the code -(1000 + place in this list).
const CALLS: [&str; 15] = [
    "hil_open",
    "hil_close",
    "hil_set_analog_input_ranges",
    "hil_set_analog_output_ranges",
    "hil_set_encoder_quadrature_mode",
    "hil_set_encoder_counts",
    "hil_write_analog",
    "hil_read_write",
    "hil_watchdog_set_analog_expiration_state",
    "hil_watchdog_start",
    "hil_watchdog_reload",
    "hil_watchdog_clear",
    "hil_watchdog_stop",
    "hil_set_analog_termination_state",
    "hil_write_termination_states",
];

struct Process {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
}

impl Process {
    fn start(program: &str, log: &str) -> Self {
        let mut child = Command::new(program)
            .arg(log)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the card starts");
        let to = child.stdin.take().expect("piped");
        let from = BufReader::new(child.stdout.take().expect("piped"));
        Self { child, to, from }
    }

    /// Sends a line and waits for the answer, a number.
    fn ask(&mut self, line: &str) -> i32 {
        let mut answer = String::new();
        writeln!(self.to, "{line}").expect("the card listens");
        self.from.read_line(&mut answer).expect("the card answers");
        answer.trim().parse().expect("a number")
    }
}

struct StandIn {
    log: File,
    fail: Option<(String, u32)>,
    expired: Option<u32>,
    process: Option<Process>,
    counts: [u32; CALLS.len()],
    turned: i32,
}

impl StandIn {
    /// Notes the call. The code it returns, and whether it is to be done.
    fn call(&mut self, name: &str, detail: &str) -> i32 {
        let place = CALLS.iter().position(|call| *call == name).expect("listed");
        self.counts[place] += 1;
        let refused = self.fail.as_ref().is_some_and(|(call, n)| call == name && *n == self.counts[place]);
        let line = format!("{name}{detail}{}\n", if refused { " REFUSED" } else { "" });
        self.log.write_all(line.as_bytes()).expect("the log takes it");
        if refused { -(1000 + place as i32) } else { 0 }
    }

    fn tell(&mut self, line: &str) -> i32 {
        self.process.as_mut().map_or(1, |process| process.ask(line))
    }
}

/// # Safety
/// `card` came from `hil_open` and was not closed.
unsafe fn stand_in<'a>(card: *mut c_void) -> &'a mut StandIn {
    unsafe { &mut *card.cast() }
}

unsafe fn first(values: *const f64) -> f64 {
    unsafe { *values }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn hil_open(card_type: *const c_char, id: *const c_char, card: *mut *mut c_void) -> i32 {
    let (card_type, id) = unsafe { (CStr::from_ptr(card_type), CStr::from_ptr(id)) };
    let (mut log, mut fail, mut expired, mut program) = (String::new(), None, None, None);
    for part in id.to_str().expect("text").split(';') {
        match part.split_once('=').expect("KEY=VALUE") {
            ("log", file) => log = file.to_owned(),
            ("fail", what) => {
                let (call, n) = what.split_once('@').expect("FUNCTION@N");
                assert!(CALLS.contains(&call), "{call} is none of the calls");
                fail = Some((call.to_owned(), n.parse().expect("a number")));
            }
            ("expired", n) => expired = Some(n.parse().expect("a number")),
            ("card", file) => program = Some(file.to_owned()),
            (other, _) => panic!("{other}?"),
        }
    }
    let file = OpenOptions::new().create(true).append(true).open(&log).expect("the log opens");
    let mut made = StandIn { log: file, fail, expired, process: None, counts: [0; CALLS.len()], turned: 0 };
    let code = made.call("hil_open", &format!(" {}", card_type.to_str().expect("text")));
    if code == 0 {
        made.process = program.map(|program| Process::start(&program, &log));
        unsafe { *card = Box::into_raw(Box::new(made)).cast() };
    }
    code
}

#[unsafe(no_mangle)]
unsafe extern "C" fn hil_close(card: *mut c_void) -> i32 {
    let mut card = unsafe { Box::from_raw(card.cast::<StandIn>()) };
    let code = card.call("hil_close", "");
    card.tell("terminate");
    if let Some(Process { mut child, to, .. }) = card.process.take() {
        drop(to);
        child.wait().expect("the card ends");
    }
    code
}

macro_rules! notes {
    ($($name:ident($($argument:ident: $type:ty),*), $detail:expr, $tell:expr;)*) => {$(
        #[unsafe(no_mangle)]
        unsafe extern "C" fn $name(card: *mut c_void, $($argument: $type),*) -> i32 {
            let stand_in = unsafe { stand_in(card) };
            let detail: String = unsafe { $detail };
            let code = stand_in.call(stringify!($name), &detail);
            let line: Option<String> = unsafe { $tell };
            if let (0, Some(line)) = (code, line) {
                stand_in.tell(&line);
            }
            code
        }
    )*};
}

notes! {
    hil_set_analog_input_ranges(ch: *const u32, n: u32, min: *const f64, max: *const f64),
        format!(" {:?} {} {}", std::slice::from_raw_parts(ch, n as usize), first(min), first(max)), None;
    hil_set_analog_output_ranges(ch: *const u32, n: u32, min: *const f64, max: *const f64),
        format!(" {:?} {} {}", std::slice::from_raw_parts(ch, n as usize), first(min), first(max)), None;
    hil_set_encoder_quadrature_mode(ch: *const u32, n: u32, mode: *const u32),
        format!(" {:?} {}", std::slice::from_raw_parts(ch, n as usize), *mode), None;
    hil_set_encoder_counts(ch: *const u32, n: u32, counts: *const i32),
        format!(" {:?} {}", std::slice::from_raw_parts(ch, n as usize), *counts), None;
    hil_write_analog(ch: *const u32, n: u32, volts: *const f64),
        format!(" {:?} {:?}", std::slice::from_raw_parts(ch, n as usize), first(volts)),
        Some(format!("write {}", first(volts)));
    hil_watchdog_set_analog_expiration_state(ch: *const u32, n: u32, volts: *const f64),
        format!(" {:?} {:?}", std::slice::from_raw_parts(ch, n as usize), first(volts)),
        Some(format!("expiration {}", first(volts)));
    hil_set_analog_termination_state(ch: *const u32, n: u32, volts: *const f64),
        format!(" {:?} {:?}", std::slice::from_raw_parts(ch, n as usize), first(volts)),
        Some(format!("termination {}", first(volts)));
    hil_watchdog_start(timeout: f64), format!(" {timeout}"), Some(format!("start {timeout}"));
    hil_watchdog_clear(), String::new(), Some("clear".to_owned());
    hil_watchdog_stop(), String::new(), Some("stop".to_owned());
    hil_write_termination_states(), String::new(), Some("terminate".to_owned());
}

#[unsafe(no_mangle)]
unsafe extern "C" fn hil_watchdog_reload(card: *mut c_void) -> i32 {
    let stand_in = unsafe { stand_in(card) };
    let code = stand_in.call("hil_watchdog_reload", "");
    if code != 0 {
        return code;
    }
    let reloads =
        stand_in.counts[CALLS.iter().position(|call| *call == "hil_watchdog_reload").expect("listed")];
    if stand_in.expired == Some(reloads) { 0 } else { stand_in.tell("reload") }
}

/// The shaft turns 1000 counts a cycle; input k shows k + 1 volts.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)]
unsafe extern "C" fn hil_read_write(
    card: *mut c_void,
    inputs: *const u32,
    n_inputs: u32,
    encoders: *const u32,
    n_encoders: u32,
    digital: *const u32,
    n_digital: u32,
    other: *const u32,
    n_other: u32,
    outputs: *const u32,
    n_outputs: u32,
    pwm: *const u32,
    n_pwm: u32,
    digital_out: *const u32,
    n_digital_out: u32,
    other_out: *const u32,
    n_other_out: u32,
    input_volts: *mut f64,
    counts: *mut i32,
    digital_in: *mut c_char,
    other_in: *mut f64,
    volts: *const f64,
    duty: *const f64,
    digital_values: *const c_char,
    other_values: *const f64,
) -> i32 {
    let stand_in = unsafe { stand_in(card) };
    assert_eq!([n_digital, n_other, n_pwm, n_digital_out, n_other_out], [0; 5]);
    assert!([digital, other, pwm, digital_out, other_out].iter().all(|list| list.is_null()));
    assert!(digital_in.is_null() && other_in.is_null() && duty.is_null());
    assert!(digital_values.is_null() && other_values.is_null());
    assert_eq!((n_encoders, n_outputs, inputs.is_null()), (1, 1, n_inputs == 0));
    let put_out = unsafe { first(volts) };
    let detail = format!(" encoder {} output {} {put_out:?}", unsafe { *encoders }, unsafe { *outputs });
    let code = stand_in.call("hil_read_write", &detail);
    if code == 0 {
        stand_in.tell(&format!("write {put_out}"));
        for place in 0..n_inputs as usize {
            unsafe { *input_volts.add(place) = f64::from(*inputs.add(place)) + 1.0 };
        }
        // A counter of sixteen bits.
        unsafe { *counts = i32::from(stand_in.turned as i16) };
        stand_in.turned += 1000;
    }
    code
}

#[unsafe(no_mangle)]
unsafe extern "C" fn msg_get_error_messageA(
    _: *const c_char,
    code: i32,
    buffer: *mut c_char,
    n: usize,
) -> i32 {
    let text = usize::try_from(-(code + 1000))
        .ok()
        .and_then(|place| CALLS.get(place))
        .map_or_else(|| format!("Error {code}."), |call| format!("The stand-in was told to refuse {call}."));
    let length = text.len().min(n - 1);
    unsafe {
        buffer.cast::<u8>().copy_from_nonoverlapping(text.as_ptr(), length);
        *buffer.add(length) = 0;
    }
    0
}
