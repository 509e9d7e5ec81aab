//! Who may do what.

use std::{fmt, io};

use subtle::ConstantTimeEq;

/// Bytes that are drawn for a token.
const DRAWN: usize = 20;

/// What a viewer may do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Access {
    /// Look, and ask for what changes nothing.
    ReadOnly,
    /// Everything that anybody may do on the network of nodes.
    Full,
}

/// A secret word of 40 hexadecimal digits, 160 bits from the system.
#[derive(Clone)]
pub struct Token(String);

impl Token {
    /// Draws one.
    ///
    /// # Errors
    /// If the system gives no random numbers.
    pub fn draw() -> io::Result<Self> {
        let mut bytes = [0; DRAWN];
        getrandom::fill(&mut bytes).map_err(io::Error::other)?;
        Ok(Self(bytes.iter().map(|byte| format!("{byte:02x}")).collect()))
    }

    /// The word, to be shown once.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }

    /// Whether `word` is it. The time this takes depends on the length of `word` alone.
    #[must_use]
    pub fn is(&self, word: &str) -> bool {
        self.0.as_bytes().ct_eq(word.as_bytes()).into()
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token")
    }
}

/// One token for those who steer, one for those who look.
#[derive(Debug, Clone)]
pub struct Tokens {
    /// Gives [`Access::Full`].
    pub full: Token,
    /// Gives [`Access::ReadOnly`].
    pub read_only: Token,
}

impl Tokens {
    /// Draws both.
    ///
    /// # Errors
    /// If the system gives no random numbers.
    pub fn draw() -> io::Result<Self> {
        Ok(Self { full: Token::draw()?, read_only: Token::draw()? })
    }

    /// What a word opens, if anything. Both tokens are always compared.
    #[must_use]
    pub fn access(&self, word: &str) -> Option<Access> {
        match (self.full.is(word), self.read_only.is(word)) {
            (true, _) => Some(Access::Full),
            (false, true) => Some(Access::ReadOnly),
            (false, false) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_token_opens_its_own() {
        let tokens = Tokens::draw().unwrap();
        assert_eq!(tokens.access(tokens.full.as_str()), Some(Access::Full));
        assert_eq!(tokens.access(tokens.read_only.as_str()), Some(Access::ReadOnly));
        let mut cut = tokens.full.as_str().to_owned();
        cut.pop();
        for wrong in ["", "0", &cut, &format!("{}0", tokens.full.as_str())] {
            assert_eq!(tokens.access(wrong), None);
        }
        assert_ne!(tokens.full.as_str(), tokens.read_only.as_str());
    }

    #[test]
    fn no_debug_print_shows_a_token() {
        let tokens = Tokens::draw().unwrap();
        assert!(!format!("{tokens:?}").contains(tokens.full.as_str()));
    }
}
