//! Machines that this process simulates. A machine that is closed stays where it is, as warm as it
//! is, until it is opened again.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use crate::Peaks;
use crate::simulated::{Simulated, locked};

type Shared = Arc<Mutex<Simulated>>;

static SHELF: Mutex<BTreeMap<String, Shared>> = Mutex::new(BTreeMap::new());

/// The machine of that place; `build` makes it where it was never opened.
pub(crate) fn at<E>(
    place: &str,
    build: impl FnOnce() -> Result<Simulated, E>,
) -> Result<(Shared, bool), E> {
    if let Some(there) = locked(&SHELF).get(place) {
        return Ok((Arc::clone(there), true));
    }
    let machine = Arc::new(Mutex::new(build()?));
    locked(&SHELF).insert(place.to_owned(), Arc::clone(&machine));
    Ok((machine, false))
}

/// How far the machine of that file was driven; none where it was never opened.
#[must_use]
pub fn peaks(place: &str) -> Option<Peaks> {
    let machine = locked(&SHELF).get(place).map(Arc::clone);
    machine.map(|machine| locked(&machine).peaks)
}

/// Forgets the machine of that file: opened again it is cold and at zero.
pub fn forget(place: &str) {
    locked(&SHELF).remove(place);
}
