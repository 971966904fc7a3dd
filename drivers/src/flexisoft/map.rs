//! What each bit of the controller's process image means; the Flexi Soft project decides it, so it is configured.

/// Process data objects of the gateway.
pub const IMAGE_OBJECTS: usize = 4;

/// The two channels of one input.
///
/// A bit has the number 64·(object − 1) + 8·byte + place: 0 is the lowest bit of byte 0 of the first process data object
/// (180h + node), 255 the highest of byte 7 of the fourth (480h + node). Both numbers are the same for an input with a
/// single channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputBits {
    /// Numbers of the bits.
    pub bits: [u8; 2],
    /// A channel whose operating state is 0: the closed-at-rest partner of a complementary pair.
    pub inverted: [bool; 2],
}

impl InputBits {
    /// Equivalent channels: 1 is the operating state of both.
    #[must_use]
    pub const fn new(bits: [u8; 2]) -> Self {
        Self { bits, inverted: [false; 2] }
    }

    /// Complementary channels: 1 is the operating state of the first, 0 that of the second.
    #[must_use]
    pub const fn complementary(bits: [u8; 2]) -> Self {
        Self { bits, inverted: [false, true] }
    }
}

/// What the image means. `None`: the robot has no such input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputMap {
    /// Emergency stop.
    pub emergency_stop: InputBits,
    /// Contact edge at the front.
    pub bumper_front: InputBits,
    /// Contact edge at the rear.
    pub bumper_rear: Option<InputBits>,
    /// Floor sensors at the front.
    pub cliff_front: Option<InputBits>,
    /// Floor sensors at the rear.
    pub cliff_rear: Option<InputBits>,
    /// The channels of an input may differ for this long, microseconds.
    pub discrepancy_us: u64,
}

impl InputMap {
    /// Whether any input stands in this object, 0…3.
    #[must_use]
    pub fn uses(&self, object: usize) -> bool {
        [
            Some(self.emergency_stop),
            Some(self.bumper_front),
            self.bumper_rear,
            self.cliff_front,
            self.cliff_rear,
        ]
        .iter()
        .flatten()
        .any(|input| input.bits.iter().any(|bit| usize::from(bit / 64) == object))
    }
}
