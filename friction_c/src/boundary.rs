//! Where C and Rust meet: pointers that are checked for null, texts in and out, and panics, which
//! stop here.

// Pointers of C. Each block says what it relies on.
#![allow(unsafe_code)]

use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::code::{Failure, FrictionCode};

/// A text of C.
///
/// # Errors
/// [`FrictionCode::NullPointer`], [`FrictionCode::NotText`].
///
/// # Safety
/// `text` is null or leads to a text that ends with a zero byte and stays as it is for `'a`.
pub unsafe fn text<'a>(text: *const c_char) -> Result<&'a str, FrictionCode> {
    if text.is_null() {
        return Err(FrictionCode::NullPointer);
    }
    // SAFETY: it is not null, and the caller promises the rest.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|_| FrictionCode::NotText)
}

/// What a pointer leads to.
///
/// # Errors
/// [`FrictionCode::NullPointer`].
///
/// # Safety
/// `pointer` is null or leads to a `T` that nobody changes for `'a`.
pub unsafe fn seen<'a, T>(pointer: *const T) -> Result<&'a T, FrictionCode> {
    // SAFETY: the caller promises it.
    unsafe { pointer.as_ref() }.ok_or(FrictionCode::NullPointer)
}

/// What a pointer leads to, to be changed.
///
/// # Errors
/// [`FrictionCode::NullPointer`].
///
/// # Safety
/// `pointer` is null or leads to a `T` that nobody else looks at for `'a`.
pub unsafe fn changed<'a, T>(pointer: *mut T) -> Result<&'a mut T, FrictionCode> {
    // SAFETY: the caller promises it.
    unsafe { pointer.as_mut() }.ok_or(FrictionCode::NullPointer)
}

/// A place for a result, which may hold anything before.
///
/// # Errors
/// [`FrictionCode::NullPointer`].
///
/// # Safety
/// `pointer` is null or leads to room for a `T` that nobody else looks at for `'a`.
pub unsafe fn place<'a, T>(pointer: *mut T) -> Result<&'a mut MaybeUninit<T>, FrictionCode> {
    // SAFETY: the caller promises it; what may hold anything has the form of a `T`.
    unsafe { pointer.cast::<MaybeUninit<T>>().as_mut() }.ok_or(FrictionCode::NullPointer)
}

/// The elements of an array of C. Nothing is looked at where there are none.
///
/// # Errors
/// [`FrictionCode::NullPointer`]; [`FrictionCode::OutOfRange`] for more than any machine holds.
///
/// # Safety
/// `first` is null or leads to `count` elements that nobody changes for `'a`.
pub unsafe fn array<'a, T>(first: *const T, count: usize) -> Result<&'a [T], FrictionCode> {
    if count == 0 {
        return Ok(&[]);
    }
    if first.is_null() {
        return Err(FrictionCode::NullPointer);
    }
    if count > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(FrictionCode::OutOfRange);
    }
    // SAFETY: it is not null, the size fits, and the caller promises the elements.
    Ok(unsafe { std::slice::from_raw_parts(first, count) })
}

/// Does something that may panic, and answers with its code.
pub fn guarded(body: impl FnOnce() -> Result<(), FrictionCode>) -> FrictionCode {
    match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => FrictionCode::Ok,
        Ok(Err(code)) => code,
        Err(_) => FrictionCode::Panic,
    }
}

/// Asks something that may panic; `otherwise` is the answer then.
pub fn asked<T>(otherwise: T, body: impl FnOnce() -> T) -> T {
    catch_unwind(AssertUnwindSafe(body)).unwrap_or(otherwise)
}

/// Where C wants the message of a failure: a buffer of its own, or null for nowhere.
#[derive(Debug, Clone, Copy)]
pub struct Message {
    /// First byte, or null.
    pub into: *mut c_char,
    /// Room, with that for the zero byte at the end.
    pub room: usize,
}

impl Message {
    /// Writes as much of `words` as there is room for, never half a character, and a zero byte.
    ///
    /// # Safety
    /// `into` is null or leads to `room` bytes that nobody else looks at.
    unsafe fn write(self, words: &str) {
        if self.into.is_null() || self.room == 0 {
            return;
        }
        let mut length = words.len().min(self.room - 1);
        while !words.is_char_boundary(length) {
            length -= 1;
        }
        // SAFETY: `length + 1` bytes are at most `room`; `words` lies elsewhere, it was made here.
        unsafe {
            std::ptr::copy_nonoverlapping(words.as_ptr(), self.into.cast(), length);
            *self.into.add(length) = 0;
        }
    }
}

/// Makes something that may fail or panic, and hands it over to C: `into` then owns it, and is null
/// where nothing was made. The message is empty where all went well.
///
/// # Safety
/// `into` is null or leads to a pointer that may be overwritten, `message` is as
/// [`Message::write`] wants it.
pub unsafe fn handed_over<T>(
    into: *mut *mut T,
    message: Message,
    make: impl FnOnce() -> Result<T, Failure>,
) -> FrictionCode {
    // SAFETY: the caller promises it.
    let into = unsafe { into.as_mut() };
    let made = catch_unwind(AssertUnwindSafe(|| {
        if into.is_none() {
            return Err(FrictionCode::NullPointer.into());
        }
        make()
    }))
    .unwrap_or_else(|_| Err(FrictionCode::Panic.into()));
    let (code, words, pointer) = match made {
        Ok(made) => (FrictionCode::Ok, String::new(), Box::into_raw(Box::new(made))),
        Err(failure) => (failure.code, failure.message, std::ptr::null_mut()),
    };
    if let Some(into) = into {
        *into = pointer;
    }
    // SAFETY: the caller promises it.
    unsafe { message.write(&words) };
    code
}

/// Takes back what [`handed_over`] gave, and ends it. Null is nothing.
///
/// # Safety
/// `pointer` is null or came from [`handed_over`], and nobody uses it again.
pub unsafe fn taken_back<T>(pointer: *mut T) {
    if !pointer.is_null() {
        // SAFETY: it was made by `Box::into_raw`, and the caller gives it up.
        let taken = unsafe { Box::from_raw(pointer) };
        asked((), || drop(taken));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_a_code() {
        assert_eq!(guarded(|| panic!("on purpose")), FrictionCode::Panic);
        assert_eq!(asked(7, || panic!("on purpose")), 7);
        let (mut pointer, mut text) = (std::ptr::NonNull::<u8>::dangling().as_ptr(), [1; 20]);
        let message = Message { into: text.as_mut_ptr(), room: text.len() };
        // SAFETY: both lead to what stands above.
        let code = unsafe { handed_over(&raw mut pointer, message, || panic!("on purpose")) };
        assert_eq!((code, pointer.is_null()), (FrictionCode::Panic, true));
        let said: Vec<u8> = text.iter().map(|byte| byte.cast_unsigned()).collect();
        assert_eq!(CStr::from_bytes_until_nul(&said).unwrap(), c"a fault of the libr");
    }

    #[test]
    fn a_message_is_cut_between_characters_and_always_ends() {
        for (room, expected) in [(1, ""), (2, "a"), (3, "a"), (4, "a\u{e9}"), (9, "a\u{e9}b")] {
            let mut bytes = [b'x'; 9];
            let message = Message { into: bytes.as_mut_ptr().cast(), room };
            // SAFETY: there is room for nine bytes.
            unsafe { message.write("a\u{e9}b") };
            let said = CStr::from_bytes_until_nul(&bytes).unwrap().to_str().unwrap();
            assert_eq!(said, expected, "{room}");
            assert!(bytes[room..].iter().all(|byte| *byte == b'x'), "{room}");
        }
    }

    #[test]
    fn arrays_that_cannot_be_are_refused() {
        // SAFETY: nothing is looked at.
        unsafe {
            assert_eq!(array::<f64>(std::ptr::null(), 0), Ok(&[][..]));
            assert_eq!(array::<f64>(std::ptr::null(), 1), Err(FrictionCode::NullPointer));
            let somewhere = std::ptr::NonNull::<f64>::dangling().as_ptr();
            assert_eq!(array(somewhere, usize::MAX), Err(FrictionCode::OutOfRange));
        }
    }
}
