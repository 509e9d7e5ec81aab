//! What a `.mat` file is made of: elements of a type and a length.

use std::io::Read;

use flate2::read::ZlibDecoder;

use super::super::MOST_VALUES;

/// Which end of a number comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    Little,
    Big,
}

impl Order {
    fn four(self, bytes: &[u8]) -> Option<u32> {
        let four: [u8; 4] = bytes.get(..4)?.try_into().ok()?;
        Some(match self {
            Self::Little => u32::from_le_bytes(four),
            Self::Big => u32::from_be_bytes(four),
        })
    }
}

/// One element.
pub(super) struct Element<'a> {
    pub kind: u32,
    pub data: &'a [u8],
}

/// Elements one behind the other.
pub(super) struct Elements<'a> {
    pub rest: &'a [u8],
    pub order: Order,
}

impl<'a> Elements<'a> {
    /// The next one; none behind the last.
    pub(super) fn next(&mut self) -> Result<Option<Element<'a>>, String> {
        const CUT: &str = "it is cut off within an element";
        // Padding behind the last element is none.
        if self.rest.len() < 8 {
            self.rest = &[];
            return Ok(None);
        }
        let first = self.order.four(self.rest).ok_or(CUT)?;
        // Short ones have the length beside the type.
        if first >> 16 != 0 {
            let length = (first >> 16) as usize;
            let data = self.rest.get(4..4 + length).filter(|_| length <= 4).ok_or(CUT)?;
            self.rest = self.rest.get(8..).unwrap_or_default();
            return Ok(Some(Element { kind: first & 0xffff, data }));
        }
        let length = self.order.four(&self.rest[4..]).ok_or(CUT)? as usize;
        let data = self.rest.get(8..).and_then(|rest| rest.get(..length)).ok_or(CUT)?;
        let padded = if first == super::COMPRESSED { length } else { length.next_multiple_of(8) };
        self.rest = self.rest.get(8..).and_then(|rest| rest.get(padded..)).unwrap_or_default();
        Ok(Some(Element { kind: first, data }))
    }
}

impl Element<'_> {
    /// Its text.
    pub(super) fn text(&self) -> String {
        word(self.data)
    }

    /// Its whole numbers of four bytes.
    pub(super) fn integers(&self, order: Order) -> Result<Vec<u32>, String> {
        if self.data.len() > 1 << 16 {
            return Err("it has more dimensions than a matrix can have".to_owned());
        }
        Ok(self.data.chunks_exact(4).filter_map(|four| order.four(four)).collect())
    }

    /// Its numbers. MATLAB stores them in the smallest type that holds them.
    pub(super) fn numbers(&self, order: Order, unsigned_eight: bool) -> Result<Vec<f64>, String> {
        let size = match self.kind {
            1 | 2 => 1,
            3 | 4 => 2,
            5..=7 => 4,
            9 | 12 | 13 => 8,
            kind => return Err(format!("its numbers have the unknown type {kind}")),
        };
        let number = |cell: &[u8]| {
            let mut bytes = [0u8; 8];
            for (k, byte) in bytes.iter_mut().take(size).enumerate() {
                *byte = cell[if order == Order::Big { size - 1 - k } else { k }];
            }
            let whole = u64::from_le_bytes(bytes);
            match self.kind {
                1 => f64::from(whole as u8 as i8),
                3 => f64::from(whole as u16 as i16),
                5 => f64::from(whole as u32 as i32),
                7 => f64::from(f32::from_bits(whole as u32)),
                9 => f64::from_bits(whole),
                12 if !unsigned_eight => whole as i64 as f64,
                _ => whole as f64,
            }
        };
        Ok(self.data.chunks_exact(size).map(number).collect())
    }
}

/// A name up to its end.
pub(super) fn word(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(&bytes[..end]).into_owned()
}

/// What was compressed, up to as many numbers as are read.
pub(super) fn inflated(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let most = MOST_VALUES as u64 * 8;
    let mut data = Vec::new();
    ZlibDecoder::new(bytes)
        .take(most + 1)
        .read_to_end(&mut data)
        .map_err(|error| format!("a variable of it cannot be unpacked: {error}"))?;
    if data.len() as u64 > most {
        return Err(format!("it unpacks to more than {MOST_VALUES} numbers"));
    }
    Ok(data)
}
