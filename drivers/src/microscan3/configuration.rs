//! What the messages do not say about themselves.

/// How the scanner is mounted and how far its silence is to be trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Configuration {
    /// Angle of "straight ahead" in the device's own polar frame, degrees: 90, where its 275° begin at −47.5°.
    pub forward_deg: f32,
    /// Mounted upside down: beams run clockwise.
    pub inverted: bool,
    /// What "infinite" is worth: nothing stands within this range, mm. No published figure holds for dark surfaces at
    /// the end of the measuring range, so that the default is a common range of a protective field.
    pub free_range_mm: u16,
    /// From the last beam to the arrival of the first datagram, µs. Not published; confirm it on the device.
    pub latency_us: u64,
}

impl Default for Configuration {
    fn default() -> Self {
        Self { forward_deg: 90.0, inverted: false, free_range_mm: 5_500, latency_us: 10_000 }
    }
}
