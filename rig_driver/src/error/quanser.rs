//! What a card and its library can say.

/// A card that cannot be opened or driven.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum QuanserError {
    /// There is no HIL library.
    #[error(
        "Quanser's HIL library could not be loaded (tried {tried}); install the vendor's HIL SDK or QUARC runtime with the driver of your card, or name the file \
         of the library in `library`. Without a card use the simulated rig"
    )]
    NoLibrary {
        /// Each file tried; of one that is there, what the system said.
        tried: String,
    },
    /// The library lacks a function.
    #[error(
        "the library {library} has no function `{function}`: it is no HIL library, or a very old one; install the vendor's present HIL SDK"
    )]
    NoFunction {
        /// The file.
        library: String,
        /// The function.
        function: &'static str,
    },
    /// A call failed.
    #[error("the card refuses `{call}`: {text} (error {code}); the motor is at zero volts{}", hint(*code))]
    Call {
        /// The function of the HIL library.
        call: &'static str,
        /// The vendor's code, below zero.
        code: i32,
        /// The vendor's text for it.
        text: String,
    },
    /// The card's watchdog expired between two cycles.
    #[error(
        "the card's watchdog expired: for longer than {timeout} s no cycle ran, and the card put the motor at zero volts by itself; give the loop real-time \
         priority or a longer `watchdog_timeout`, then clear and activate"
    )]
    WatchdogExpired {
        /// Its time \[s\], in words.
        timeout: String,
    },
    /// A text for the library holds a zero byte.
    #[error("`{name}` must not hold a zero byte; change it in the rig's parameters")]
    ZeroByte {
        /// The parameter.
        name: &'static str,
    },
}

impl QuanserError {
    /// Whether whoever asked for the card can mend it: what is no HIL library, what cannot name a
    /// card. What the card fails at is no such thing.
    #[must_use]
    pub const fn is_bad_input(&self) -> bool {
        match self {
            Self::NoLibrary { .. } | Self::NoFunction { .. } | Self::ZeroByte { .. } => true,
            Self::Call { .. } | Self::WatchdogExpired { .. } => false,
        }
    }
}

/// What helps with the errors everybody meets first.
const fn hint(code: i32) -> &'static str {
    match -code {
        108 => "; is the card plugged in and powered, and its number right?",
        109 => "; another program has the card: end it first",
        986 => {
            "; the library is there, the driver of this card is not: install it, or correct `card_type`"
        }
        _ => "",
    }
}
