//! A 64-bit fingerprint of everything the robot put out, to tell whether two runs were the same.

/// FNV-1a, 64 bits (Fowler, Noll, Vo): offset basis and prime of the published algorithm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest(u64);

impl Digest {
    /// Of nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Adds bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// The fingerprint, 16 hexadecimal digits: a JSON number would lose its last bits in many readers.
    #[must_use]
    pub fn hex(self) -> String {
        format!("{:016x}", self.0)
    }
}

impl Default for Digest {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vectors of the authors' test suite.
    #[test]
    fn published_vectors() {
        let digest = |text: &str| {
            let mut digest = Digest::new();
            digest.add(text.as_bytes());
            digest.hex()
        };
        assert_eq!(digest(""), "cbf29ce484222325");
        assert_eq!(digest("a"), "af63dc4c8601ec8c");
        assert_eq!(digest("foobar"), "85944171f73967e8");
    }
}
