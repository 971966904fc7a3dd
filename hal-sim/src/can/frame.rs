//! A CAN data frame.

/// Invariant: `len` ≤ 8; the bytes behind it are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CanFrame {
    /// 11 bits, or 29 with `extended`.
    pub id: u32,
    /// 29-bit identifier.
    pub extended: bool,
    /// Number of data bytes.
    pub len: u8,
    /// The data.
    pub data: [u8; 8],
}

impl CanFrame {
    /// A standard frame; more than eight bytes are cut.
    #[must_use]
    pub fn new(id: u32, payload: &[u8]) -> Self {
        let mut data = [0; 8];
        for (cell, byte) in data.iter_mut().zip(payload) {
            *cell = *byte;
        }
        Self { id, extended: false, len: payload.len().min(8) as u8, data }
    }

    /// A frame with 29 bits of identifier; more than eight bytes are cut.
    #[must_use]
    pub fn extended(id: u32, payload: &[u8]) -> Self {
        Self { extended: true, ..Self::new(id, payload) }
    }

    /// The data bytes in use.
    #[must_use]
    pub fn payload(&self) -> &[u8] {
        &self.data[..usize::from(self.len).min(8)]
    }

    /// How long the frame occupies a 500 kbit/s bus at most, microseconds: 55 + 10 bits a byte (book, CANopen: Process
    /// data).
    #[must_use]
    pub fn duration_us(&self) -> u64 {
        (55 + 10 * u64::from(self.len)) * 2
    }
}
