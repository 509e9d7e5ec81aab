//! The header of an array: a dictionary in the words of Python.

/// A number's type.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Kind {
    /// `f`, `i`, `u` or `b`; `S`, `U` or `V` for what is no number.
    pub letter: u8,
    /// Bytes.
    pub size: usize,
    /// Big end first.
    pub big: bool,
    /// Seconds of one tick of a time.
    pub time: Option<f64>,
}

impl Kind {
    /// Whether it is a number.
    pub(super) const fn is_number(self) -> bool {
        !matches!(self.letter, b'S' | b'U' | b'V')
    }
}

/// A field of an array.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Field {
    /// Empty where the array has no fields.
    pub name: String,
    pub kind: Kind,
    /// Numbers of it in a row.
    pub count: usize,
}

/// The header.
pub(super) struct Header {
    /// The fields, or why it holds no numbers.
    pub fields: Result<Vec<Field>, String>,
    /// By columns.
    pub fortran: bool,
    pub shape: Vec<usize>,
}

impl Header {
    /// The header, and what follows it.
    pub(super) fn of(bytes: &[u8]) -> Result<(Self, &[u8]), String> {
        let damaged = || "its header is damaged".to_owned();
        if !bytes.starts_with(b"\x93NUMPY") {
            return Err("it is no NumPy array".to_owned());
        }
        let (start, length) = match bytes.get(6) {
            Some(1) => {
                let length = bytes.get(8..10).ok_or_else(damaged)?;
                (10, usize::from(u16::from_le_bytes([length[0], length[1]])))
            }
            Some(2 | 3) => {
                let length = bytes.get(8..12).ok_or_else(damaged)?;
                let length = u32::from_le_bytes([length[0], length[1], length[2], length[3]]);
                (12, length as usize)
            }
            _ => return Err("its version is not known".to_owned()),
        };
        let text = bytes.get(start..start + length).ok_or_else(damaged)?;
        let text = std::str::from_utf8(text).map_err(|_| damaged())?;
        let mut words = Words { rest: text };
        let (mut fields, mut fortran, mut shape) = (None, false, None);
        words.mark("{").ok_or_else(damaged)?;
        while words.mark("}").is_none() {
            let key = words.quoted().ok_or_else(damaged)?;
            words.mark(":").ok_or_else(damaged)?;
            match key.as_str() {
                "descr" => fields = Some(words.types().ok_or_else(damaged)?),
                "fortran_order" => {
                    fortran = words.mark("True").is_some();
                    if !fortran {
                        words.mark("False").ok_or_else(damaged)?;
                    }
                }
                "shape" => shape = Some(words.shape().ok_or_else(damaged)?),
                _ => return Err(damaged()),
            }
            let _ = words.mark(",");
        }
        let header = Self {
            fields: fields.ok_or_else(damaged)?,
            fortran,
            shape: shape.ok_or_else(damaged)?,
        };
        Ok((header, bytes.get(start + length..).unwrap_or_default()))
    }
}

/// What is left of a text.
struct Words<'a> {
    rest: &'a str,
}

impl Words<'_> {
    fn mark(&mut self, mark: &str) -> Option<()> {
        self.rest = self.rest.trim_start().strip_prefix(mark)?;
        Some(())
    }

    fn quoted(&mut self) -> Option<String> {
        let rest = self.rest.trim_start();
        let quote = rest.chars().next().filter(|c| matches!(c, '\'' | '"'))?;
        let (word, rest) = rest[1..].split_once(quote)?;
        self.rest = rest;
        Some(word.to_owned())
    }

    fn number(&mut self) -> Option<usize> {
        let rest = self.rest.trim_start();
        let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
        let number = rest[..end].parse().ok()?;
        // NumPy of Python 2 writes `10L`.
        self.rest = rest[end..].strip_prefix('L').unwrap_or(&rest[end..]);
        Some(number)
    }

    fn shape(&mut self) -> Option<Vec<usize>> {
        self.mark("(")?;
        let mut shape = Vec::new();
        while self.mark(")").is_none() {
            shape.push(self.number()?);
            let _ = self.mark(",");
        }
        Some(shape)
    }

    /// What stands between a bracket and the one that closes it.
    fn nested(&mut self) -> Option<()> {
        self.mark("[")?;
        let mut depth = 1usize;
        let end = self.rest.find(|c: char| {
            depth = match c {
                '[' => depth + 1,
                ']' => depth - 1,
                _ => depth,
            };
            depth == 0
        })?;
        self.rest = &self.rest[end + 1..];
        Some(())
    }

    /// One type, or a list of named ones; none where it is damaged.
    fn types(&mut self) -> Option<Result<Vec<Field>, String>> {
        if let Some(text) = self.quoted() {
            let field = |kind| vec![Field { name: String::new(), kind, count: 1 }];
            return Some(kind(&text).map(field));
        }
        self.mark("[")?;
        let mut fields = Vec::new();
        let mut refused = None;
        while self.mark("]").is_none() {
            self.mark("(")?;
            let name = self.quoted()?;
            self.mark(",")?;
            let text = match self.quoted() {
                Some(text) => text,
                None => {
                    self.nested()?;
                    refused = Some(format!("field `{name}` has fields of its own"));
                    "<f8".to_owned()
                }
            };
            let mut count = 1usize;
            if self.mark(",").is_some() {
                count = self.shape()?.into_iter().try_fold(1usize, usize::checked_mul)?;
            }
            self.mark(")")?;
            let _ = self.mark(",");
            match kind(&text) {
                Ok(kind) => fields.push(Field { name, kind, count }),
                Err(why) => refused = Some(format!("field `{name}`: {why}")),
            }
        }
        Some(refused.map_or(Ok(fields), Err))
    }
}

/// The type that NumPy writes as `<f8`.
fn kind(text: &str) -> Result<Kind, String> {
    let refuse = || format!("its type `{text}` is no number that is read");
    let (order, rest) = match text.as_bytes().first() {
        Some(b'<' | b'>' | b'|' | b'=') => text.split_at(1),
        _ => ("<", text),
    };
    let big = order == ">";
    let letter = *rest.as_bytes().first().ok_or_else(refuse)?;
    let ticks = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
    for code in ["M8", "m8"] {
        let Some(unit) = rest.strip_prefix(code) else { continue };
        let unit = unit.trim_start_matches('[').trim_end_matches(']');
        let tick = ticks.iter().find(|(name, _)| *name == unit).ok_or_else(refuse)?;
        return Ok(Kind { letter: b'i', size: 8, big, time: Some(tick.1) });
    }
    let size: usize = rest.get(1..).and_then(|size| size.parse().ok()).ok_or_else(refuse)?;
    match (letter, size) {
        // Texts and padding stand between numbers.
        (b'S' | b'V', _) => Ok(Kind { letter, size, big, time: None }),
        (b'U', _) => {
            let size = size.checked_mul(4).ok_or_else(refuse)?;
            Ok(Kind { letter, size, big, time: None })
        }
        (b'f', 2 | 4 | 8) | (b'i' | b'u', 1 | 2 | 4 | 8) | (b'b', 1) => {
            Ok(Kind { letter, size, big, time: None })
        }
        _ => Err(refuse()),
    }
}
