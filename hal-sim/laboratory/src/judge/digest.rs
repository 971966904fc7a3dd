//! Fingerprints as text.

use floorguard_runtime::digest::Fnv64;

/// A fingerprint of whole runs, for campaigns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Digest(Fnv64);

impl Digest {
    /// Of nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self(Fnv64::new())
    }

    /// Adds bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        self.0.add(bytes);
    }

    /// The fingerprint, 16 hexadecimal digits: a JSON number would lose its last bits in many readers.
    #[must_use]
    pub fn hex(self) -> String {
        format!("{:016x}", self.0.value())
    }
}
