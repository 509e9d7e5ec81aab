//! Keeps a damaged file from ending the program.
//!
//! mcap 0.26 slices an attachment's record by lengths that the record itself states, and panics
//! where they do not fit (its `read.rs`, arm `op::ATTACHMENT`); flipped bits can turn any record
//! into one. Until it returns an error there, reading goes through here.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::sync::Once;

use super::BagError;

thread_local! {
    static READING: Cell<bool> = const { Cell::new(false) };
}

/// Runs `read` and turns a panic of it into [`BagError::Damaged`]; nothing is printed.
pub(super) fn guarded<T>(
    path: &Path,
    read: impl FnOnce() -> Result<T, BagError>,
) -> Result<T, BagError> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !READING.get() {
                before(info);
            }
        }));
    });
    let outer = READING.replace(true);
    // What `read` built is dropped with it: nobody sees it half done.
    let result = panic::catch_unwind(AssertUnwindSafe(read));
    READING.set(outer);
    result.unwrap_or_else(|_| {
        Err(BagError::Damaged {
            path: path.into(),
            detail: "a record is shorter than it says".into(),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_a_damaged_bag() {
        let result: Result<(), _> = guarded(Path::new("x.mcap"), || panic!("beyond the end"));
        let Err(error) = result else { panic!("no error") };
        assert!(
            matches!(error, BagError::Damaged { .. }) && error.to_string().contains("x.mcap"),
            "{error}"
        );
        assert!(guarded(Path::new("x.mcap"), || Ok(1)).is_ok_and(|one| one == 1));
    }
}
