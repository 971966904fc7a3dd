//! Which keys a reading asks for, noted while a reference is made.

use std::cell::RefCell;

/// A key that was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Asked {
    pub section: String,
    pub key: &'static str,
    pub kind: &'static str,
    pub allowed: String,
    pub default: Option<String>,
}

impl Asked {
    /// Whether it is this key of this section.
    pub(crate) fn is_of(&self, section: &str, key: &str) -> bool {
        self.section == section && self.key == key
    }
}

thread_local! {
    static LIST: RefCell<Option<Vec<Asked>>> = const { RefCell::new(None) };
}

/// Takes note while a reference is made; else nothing.
pub(crate) fn note(asked: impl FnOnce() -> Asked) {
    LIST.with_borrow_mut(|list| {
        if let Some(list) = list {
            list.push(asked());
        }
    });
}

/// What some reading gives, and the keys that it asked for.
pub(crate) fn asked_during<T>(reading: impl FnOnce() -> T) -> (T, Vec<Asked>) {
    LIST.set(Some(Vec::new()));
    let read = reading();
    (read, LIST.take().unwrap_or_default())
}
