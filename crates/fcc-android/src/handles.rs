//! Numbers for what Java holds: never an address, and never used twice, so that
//! one that is closed is refused for ever.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::failure::Failure;

/// What is open, by its handle.
pub(crate) struct Handles<T> {
    open: Mutex<Open<T>>,
}

struct Open<T> {
    last: i64,
    all: BTreeMap<i64, Arc<T>>,
}

impl<T> Handles<T> {
    pub(crate) const fn new() -> Self {
        Self {
            open: Mutex::new(Open {
                last: 0,
                all: BTreeMap::new(),
            }),
        }
    }

    /// A handle for `opened`: 1 or more.
    pub(crate) fn add(&self, opened: T) -> i64 {
        let mut open = self.lock();
        open.last += 1;
        let handle = open.last;
        open.all.insert(handle, Arc::new(opened));
        handle
    }

    /// What a handle stands for; it lives until the last user drops it.
    ///
    /// # Errors
    /// When it is closed, or never was one.
    pub(crate) fn get(&self, handle: i64) -> Result<Arc<T>, Failure> {
        self.lock().all.get(&handle).cloned().ok_or(Failure::Closed)
    }

    /// Closes a handle; none if it is closed already.
    pub(crate) fn remove(&self, handle: i64) -> Option<Arc<T>> {
        self.lock().all.remove(&handle)
    }

    fn lock(&self) -> MutexGuard<'_, Open<T>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_handle_is_refused_and_never_given_again() {
        let handles = Handles::new();
        let first = handles.add('a');
        let used = handles.get(first).unwrap();
        assert!(handles.remove(first).is_some());
        assert!(handles.remove(first).is_none());
        let second = handles.add('b');
        assert_ne!(first, second);
        assert!(matches!(handles.get(first), Err(Failure::Closed)));
        // Who uses it meanwhile still has it.
        assert_eq!((*used, *handles.get(second).unwrap()), ('a', 'b'));
        assert!(handles.get(0).is_err() && handles.get(-1).is_err());
    }
}
