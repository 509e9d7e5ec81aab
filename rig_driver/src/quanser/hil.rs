//! The HIL library's functions as safe methods. All `unsafe` that calls foreign code is in
//! this file.
//!
//! Types and order of the arguments are those of the vendor's `hil.h`: `t_error` and `t_int` are
//! `i32`, `t_uint32` is `u32`, `t_double` is `f64`, `t_boolean` one byte, cards are pointers nobody
//! looks behind, enums have 32 bits; a result below zero is an error.

// The one file that talks to a foreign library. Each block says what it relies on.
#![allow(unsafe_code)]

use std::ffi::{CStr, c_char, c_void};
use std::path::{Path, PathBuf};
use std::ptr;

use libloading::Library;

use super::QuanserError;

type RawCard = *mut c_void;
type Channels = *const u32;
type Volts = *const f64;

/// Four counts a period of the encoder's lines.
const QUADRATURE_4X: u32 = 4;

/// Declares the table of functions and how it is read from a library.
macro_rules! functions {
    ($($name:ident: fn($($argument:ty),*) -> $result:ty;)*) => {
        // The vendor's names as they are.
        #[allow(non_snake_case)]
        #[derive(Debug, Clone, Copy)]
        struct Functions {
            $($name: unsafe extern "C" fn($($argument),*) -> $result,)*
        }

        impl Functions {
            fn read(library: &Library, file: &Path) -> Result<Self, QuanserError> {
                Ok(Self {
                    $($name: {
                        // SAFETY: the signature is that of the function of this name in the
                        // vendor's header. The pointer is kept beside the library in `Hil` and
                        // never leaves it, so it does not outlive the code it points to.
                        let found = unsafe { library.get(concat!(stringify!($name), "\0").as_bytes()) };
                        *found.map_err(|_| QuanserError::NoFunction {
                            library: file.display().to_string(),
                            function: stringify!($name),
                        })?
                    },)*
                })
            }
        }
    };
}

functions! {
    hil_open: fn(*const c_char, *const c_char, *mut RawCard) -> i32;
    hil_close: fn(RawCard) -> i32;
    hil_set_analog_input_ranges: fn(RawCard, Channels, u32, Volts, Volts) -> i32;
    hil_set_analog_output_ranges: fn(RawCard, Channels, u32, Volts, Volts) -> i32;
    hil_set_encoder_quadrature_mode: fn(RawCard, Channels, u32, *const u32) -> i32;
    hil_set_encoder_counts: fn(RawCard, Channels, u32, *const i32) -> i32;
    hil_write_analog: fn(RawCard, Channels, u32, Volts) -> i32;
    hil_read_write: fn(
        RawCard,
        Channels, u32, Channels, u32, Channels, u32, Channels, u32,
        Channels, u32, Channels, u32, Channels, u32, Channels, u32,
        *mut f64, *mut i32, *mut c_char, *mut f64,
        *const f64, *const f64, *const c_char, *const f64
    ) -> i32;
    hil_watchdog_set_analog_expiration_state: fn(RawCard, Channels, u32, Volts) -> i32;
    hil_watchdog_start: fn(RawCard, f64) -> i32;
    hil_watchdog_reload: fn(RawCard) -> i32;
    hil_watchdog_clear: fn(RawCard) -> i32;
    hil_watchdog_stop: fn(RawCard) -> i32;
    hil_set_analog_termination_state: fn(RawCard, Channels, u32, Volts) -> i32;
    hil_write_termination_states: fn(RawCard) -> i32;
    msg_get_error_messageA: fn(*const c_char, i32, *mut c_char, usize) -> i32;
}

/// A loaded library.
#[derive(Debug)]
pub(super) struct Hil {
    functions: Functions,
    file: PathBuf,
    // Last, so that it is unloaded last.
    _library: Library,
}

impl Hil {
    /// Loads the library of this name.
    pub(super) fn load(file: &Path) -> Result<Self, QuanserError> {
        // SAFETY: loading runs the library's own initialisation. The name is one of the vendor's
        // library or was given by whoever owns the machine; as with any program's libraries, that
        // code is trusted.
        let library = unsafe { Library::new(file) }.map_err(|error| {
            let said = Source(&error).to_string();
            let absent = said.contains("No such file");
            QuanserError::NoLibrary {
                tried: if absent { file.display().to_string() } else { said },
            }
        })?;
        let functions = Functions::read(&library, file)?;
        Ok(Self { functions, file: file.to_owned(), _library: library })
    }

    /// The file it was loaded from, as it was asked for.
    pub(super) fn name(&self) -> &Path {
        &self.file
    }

    /// Opens a card.
    pub(super) fn open(self, card_type: &CStr, identifier: &CStr) -> Result<Card, QuanserError> {
        let mut raw: RawCard = ptr::null_mut();
        // SAFETY: both texts end with a zero byte and live through the call, `raw` is a valid place
        // for one pointer.
        let code = unsafe {
            (self.functions.hil_open)(card_type.as_ptr(), identifier.as_ptr(), &raw mut raw)
        };
        self.checked("hil_open", code)?;
        Ok(Card { raw, hil: self })
    }

    /// The vendor's result as ours.
    fn checked(&self, call: &'static str, code: i32) -> Result<i32, QuanserError> {
        if code >= 0 {
            Ok(code)
        } else {
            Err(QuanserError::Call { call, code, text: self.message(code) })
        }
    }

    /// The vendor's text for a code.
    fn message(&self, code: i32) -> String {
        let mut buffer = [0u8; 1024];
        // SAFETY: no locale is allowed and means the system's; the buffer has the length that is
        // told, and the last byte is kept back so that a text of full length still ends with a
        // zero.
        unsafe {
            (self.functions.msg_get_error_messageA)(
                ptr::null(),
                code,
                buffer.as_mut_ptr().cast(),
                buffer.len() - 1,
            )
        };
        let text =
            CStr::from_bytes_until_nul(&buffer).map_or_else(|_| "".into(), CStr::to_string_lossy);
        if text.trim().is_empty() {
            "the vendor has no text for it".to_owned()
        } else {
            text.trim().trim_end_matches('.').to_owned()
        }
    }
}

/// What the loader says and why.
struct Source<'a>(&'a libloading::Error);

impl std::fmt::Display for Source<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match std::error::Error::source(self.0) {
            Some(source) => std::fmt::Display::fmt(source, f),
            None => std::fmt::Display::fmt(self.0, f),
        }
    }
}

/// The channels of one cycle and their values. The lists have the lengths of the values, always.
#[derive(Debug)]
pub(super) struct Exchange {
    inputs: Vec<u32>,
    encoder: [u32; 1],
    output: [u32; 1],
    volts: Vec<f64>,
    counts: [i32; 1],
}

impl Exchange {
    pub(super) fn new(inputs: Vec<u32>, encoder: u32, output: u32) -> Self {
        let volts = vec![0.0; inputs.len()];
        Self { inputs, encoder: [encoder], output: [output], volts, counts: [0] }
    }

    /// Volts at the inputs, in the order in which they were given.
    pub(super) fn volts(&self) -> &[f64] {
        &self.volts
    }

    /// The encoder's counter.
    pub(super) const fn count(&self) -> i32 {
        self.counts[0]
    }
}

/// An open card; dropped, it is closed.
#[derive(Debug)]
pub(super) struct Card {
    raw: RawCard,
    // After the card: the library stays until it is closed.
    hil: Hil,
}

// SAFETY: the pointer is only a handle. The HIL library lets any thread use a card, one at a time;
// `Card` cannot be shared (it is not `Sync`, and every call takes it by `&mut`), so there is never
// more than one.
unsafe impl Send for Card {}

impl Card {
    fn checked(&self, call: &'static str, code: i32) -> Result<i32, QuanserError> {
        self.hil.checked(call, code)
    }

    /// Sets the ranges of analogue inputs, +- `limits` \[V\].
    pub(super) fn set_input_ranges(&mut self, inputs: &[(u32, f64)]) -> Result<(), QuanserError> {
        if inputs.is_empty() {
            return Ok(());
        }
        let (channels, above): (Vec<u32>, Vec<f64>) = inputs.iter().copied().unzip();
        let below: Vec<f64> = above.iter().map(|limit| -limit).collect();
        // SAFETY: the card is open; all three lists have the length that is told and live through
        // the call.
        let code = unsafe {
            (self.hil.functions.hil_set_analog_input_ranges)(
                self.raw,
                channels.as_ptr(),
                length(&channels),
                below.as_ptr(),
                above.as_ptr(),
            )
        };
        self.checked("hil_set_analog_input_ranges", code).map(drop)
    }

    /// Sets the range of the output, +- `limit` \[V\].
    pub(super) fn set_output_range(
        &mut self,
        channel: u32,
        limit: f64,
    ) -> Result<(), QuanserError> {
        let (set, below) = (self.hil.functions.hil_set_analog_output_ranges, -limit);
        // SAFETY: the card is open; one channel, one lower and one upper limit, each of which lives
        // through the call.
        let code =
            unsafe { set(self.raw, &raw const channel, 1, &raw const below, &raw const limit) };
        self.checked("hil_set_analog_output_ranges", code).map(drop)
    }

    /// Lets the encoder count four a period, from zero.
    pub(super) fn set_encoder(&mut self, channel: u32) -> Result<(), QuanserError> {
        let Functions { hil_set_encoder_quadrature_mode, hil_set_encoder_counts, .. } =
            self.hil.functions;
        let mode = QUADRATURE_4X;
        // SAFETY: the card is open; one channel and one mode, which live through the call.
        let code = unsafe {
            hil_set_encoder_quadrature_mode(self.raw, &raw const channel, 1, &raw const mode)
        };
        self.checked("hil_set_encoder_quadrature_mode", code)?;
        let zero = 0i32;
        // SAFETY: as above, with one count.
        let code =
            unsafe { hil_set_encoder_counts(self.raw, &raw const channel, 1, &raw const zero) };
        self.checked("hil_set_encoder_counts", code).map(drop)
    }

    /// What the output shall be when the watchdog expires, and when the program ends: zero volts.
    pub(super) fn set_safe_states(&mut self, channel: u32) -> Result<(), QuanserError> {
        let zero = 0.0f64;
        for (call, set) in [
            (
                "hil_watchdog_set_analog_expiration_state",
                self.hil.functions.hil_watchdog_set_analog_expiration_state,
            ),
            (
                "hil_set_analog_termination_state",
                self.hil.functions.hil_set_analog_termination_state,
            ),
        ] {
            // SAFETY: the card is open; one channel and one voltage, which live through the call.
            let code = unsafe { set(self.raw, &raw const channel, 1, &raw const zero) };
            self.checked(call, code)?;
        }
        Ok(())
    }

    /// Puts `volts` out at once \[V\].
    pub(super) fn write(&mut self, channel: u32, volts: f64) -> Result<(), QuanserError> {
        let write = self.hil.functions.hil_write_analog;
        // SAFETY: the card is open; one channel and one voltage, which live through the call.
        let code = unsafe { write(self.raw, &raw const channel, 1, &raw const volts) };
        self.checked("hil_write_analog", code).map(drop)
    }

    /// Reads every channel and puts `volts` out \[V\].
    pub(super) fn read_write(
        &mut self,
        exchange: &mut Exchange,
        volts: f64,
    ) -> Result<(), QuanserError> {
        let Exchange { inputs, encoder, output, volts: read, counts } = exchange;
        let none: Channels = ptr::null();
        let (input_channels, input_volts) = if inputs.is_empty() {
            (none, ptr::null_mut())
        } else {
            (inputs.as_ptr(), read.as_mut_ptr())
        };
        // SAFETY: the card is open. `Exchange` keeps lists of channels and places for their values
        // of equal length; they live through the call. What is not used is null with a length of
        // zero, as the vendor wants it.
        let code = unsafe {
            (self.hil.functions.hil_read_write)(
                self.raw,
                input_channels,
                length(inputs),
                encoder.as_ptr(),
                1,
                none,
                0,
                none,
                0,
                output.as_ptr(),
                1,
                none,
                0,
                none,
                0,
                none,
                0,
                input_volts,
                counts.as_mut_ptr(),
                ptr::null_mut(),
                ptr::null_mut(),
                &raw const volts,
                ptr::null(),
                ptr::null(),
                ptr::null(),
            )
        };
        self.checked("hil_read_write", code).map(drop)
    }

    /// Starts the card's own watchdog \[s\].
    pub(super) fn start_watchdog(&mut self, timeout: f64) -> Result<(), QuanserError> {
        // SAFETY: the card is open.
        let code = unsafe { (self.hil.functions.hil_watchdog_start)(self.raw, timeout) };
        self.checked("hil_watchdog_start", code).map(drop)
    }

    /// Tells the watchdog that the program lives. False if it had expired before.
    pub(super) fn reload_watchdog(&mut self) -> Result<bool, QuanserError> {
        // SAFETY: the card is open.
        let code = unsafe { (self.hil.functions.hil_watchdog_reload)(self.raw) };
        self.checked("hil_watchdog_reload", code).map(|result| result > 0)
    }

    /// Takes an expired watchdog back. One that has not expired is no error.
    pub(super) fn clear_watchdog(&mut self) -> Result<(), QuanserError> {
        const NOT_SET: i32 = -599;
        // SAFETY: the card is open.
        match unsafe { (self.hil.functions.hil_watchdog_clear)(self.raw) } {
            NOT_SET => Ok(()),
            code => self.checked("hil_watchdog_clear", code).map(drop),
        }
    }

    /// Stops the watchdog.
    pub(super) fn stop_watchdog(&mut self) -> Result<(), QuanserError> {
        // SAFETY: the card is open.
        let code = unsafe { (self.hil.functions.hil_watchdog_stop)(self.raw) };
        self.checked("hil_watchdog_stop", code).map(drop)
    }

    /// Puts the outputs into the states for the end of the program.
    pub(super) fn write_termination_states(&mut self) -> Result<(), QuanserError> {
        // SAFETY: the card is open.
        let code = unsafe { (self.hil.functions.hil_write_termination_states)(self.raw) };
        self.checked("hil_write_termination_states", code).map(drop)
    }
}

impl Drop for Card {
    fn drop(&mut self) {
        // SAFETY: the card is open, and nobody uses it after this.
        unsafe { (self.hil.functions.hil_close)(self.raw) };
    }
}

/// Length of a list for the library; lists of channels are short.
fn length<T>(list: &[T]) -> u32 {
    u32::try_from(list.len()).unwrap_or(u32::MAX)
}
