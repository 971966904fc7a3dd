//! What the telegram does not say about itself.

use heapless::Vec;

/// What bit 13 of a measured word means; set in the scanner's own configuration (book, SICK S300: Measured words).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Bit13 {
    /// The beam hit a reflector: the distance is good.
    Reflector,
    /// The scanner was dazzled: the beam says nothing.
    #[default]
    Dazzled,
}

/// How the scanner is configured.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// Values of each configured field; there is no count in the telegram.
    pub values_per_field: Vec<u16, 5>,
    /// Meaning of bit 13.
    pub bit13: Bit13,
    /// Angle of the first value, radians in the scanner's frame.
    pub first_angle_rad: f32,
    /// Angle between values, radians.
    pub step_rad: f32,
    /// Mounted upside down: values run clockwise.
    pub inverted: bool,
    /// What "no echo" is worth: nothing stands within this range, mm.
    pub free_range_mm: u16,
    /// From the middle of the scan to the last byte of its telegram, µs: 22 ms on the line at 500 kBd and 20 to 45 ms
    /// within the scanner (book, SICK S300: Line).
    pub delay_us: u64,
    /// Silence within a telegram after which it is given up, µs. Less than the 18 ms between two telegrams at 500 kBd, and
    /// more than a busy Linux computer is late by: a telegram that was cut is recognised by its checksum anyway.
    pub gap_max_us: u64,
}

impl Default for Configuration {
    /// One field of 541 values over 270°.
    fn default() -> Self {
        let mut values_per_field = Vec::new();
        // One of five.
        let _ = values_per_field.push(541);
        Self {
            values_per_field,
            bit13: Bit13::default(),
            first_angle_rad: -135.0 * floorguard_types::units::RADIANS_PER_DEGREE,
            step_rad: 0.5 * floorguard_types::units::RADIANS_PER_DEGREE,
            inverted: false,
            free_range_mm: 30_000,
            delay_us: 54_660,
            gap_max_us: 15_000,
        }
    }
}

impl Configuration {
    /// Measured values of a telegram.
    pub(super) fn values(&self) -> usize {
        self.values_per_field.iter().map(|count| usize::from(*count)).sum()
    }

    /// Measured words of a telegram, with the markers between fields.
    pub(super) fn words(&self) -> usize {
        self.values().saturating_add(self.values_per_field.len().saturating_sub(1))
    }
}
