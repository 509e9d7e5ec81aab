use strum::{Display, EnumString};

/// How much a log line matters. The numbers are those of `rcl_interfaces/msg/Log`; the names are
/// read in capitals or not, as rcl does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Display, EnumString)]
#[strum(serialize_all = "UPPERCASE", ascii_case_insensitive)]
#[repr(u8)]
pub enum LogLevel {
    /// For those who look for a mistake.
    Debug = 10,
    /// What happens.
    Info = 20,
    /// What somebody should look at.
    Warn = 30,
    /// What does not work.
    Error = 40,
    /// What ends the program.
    Fatal = 50,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_rcl_reads_them() {
        for text in ["warn", "WARN", "Warn"] {
            assert_eq!(text.parse(), Ok(LogLevel::Warn));
        }
        assert_eq!(LogLevel::Fatal.to_string(), "FATAL");
        assert!("loud".parse::<LogLevel>().is_err());
    }
}
