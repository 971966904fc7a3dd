//! The two times of a message.

use floorguard_types::time::Stamp;

/// When something was recorded, and when it was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Times {
    /// Recorded: the order of the file.
    pub logged: Stamp,
    /// Made, or for raw bytes: arrived.
    pub published: Stamp,
}

impl From<Stamp> for Times {
    fn from(stamp: Stamp) -> Self {
        Self { logged: stamp, published: stamp }
    }
}
