//! What a call answers.

use std::ffi::CStr;

/// What came of a call. `FRICTION_CODE_OK` is zero; all others mean that nothing was changed and
/// that results are zero.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrictionCode {
    /// It is done.
    Ok = 0,
    /// A pointer that must lead somewhere is null.
    NullPointer = 1,
    /// A text is not UTF-8.
    NotText = 2,
    /// There is no friction model of that name.
    UnknownModel = 3,
    /// A parameter is unknown, missing, given twice or outside its range.
    BadParameter = 4,
    /// A period lies outside (0, 0.01] s, or two periods differ that must be the same.
    BadPeriod = 5,
    /// A parameter file cannot be read, or says nothing of the node.
    BadFile = 6,
    /// A number is not finite.
    NotFinite = 7,
    /// An index or a choice is beyond the last.
    OutOfRange = 8,
    /// A fault of this library; please report it. Reset or free what was called.
    Panic = 9,
}

impl FrictionCode {
    /// Every code.
    pub(crate) const ALL: [Self; 10] = [
        Self::Ok,
        Self::NullPointer,
        Self::NotText,
        Self::UnknownModel,
        Self::BadParameter,
        Self::BadPeriod,
        Self::BadFile,
        Self::NotFinite,
        Self::OutOfRange,
        Self::Panic,
    ];

    /// What it means, in a sentence.
    #[must_use]
    pub const fn meaning(self) -> &'static CStr {
        match self {
            Self::Ok => c"done",
            Self::NullPointer => c"a pointer that must lead somewhere is null",
            Self::NotText => c"a text is not UTF-8",
            Self::UnknownModel => c"there is no friction model of that name",
            Self::BadParameter => {
                c"a parameter is unknown, missing, given twice or outside its range"
            }
            Self::BadPeriod => {
                c"a period must lie in (0, 0.01] s, and be the same where two are compared"
            }
            Self::BadFile => c"the parameter file cannot be read, or says nothing of the node",
            Self::NotFinite => c"a number is not finite",
            Self::OutOfRange => c"an index or a choice is beyond the last",
            Self::Panic => c"a fault of the library; please report it",
        }
    }
}

/// Why something could not be made.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct Failure {
    /// What C gets.
    pub code: FrictionCode,
    /// What people read.
    pub message: String,
}

impl Failure {
    /// A failure in words.
    pub fn new(code: FrictionCode, message: impl ToString) -> Self {
        Self { code, message: message.to_string() }
    }
}

impl From<FrictionCode> for Failure {
    fn from(code: FrictionCode) -> Self {
        Self::new(code, code.meaning().to_string_lossy())
    }
}
