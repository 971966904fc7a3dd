//! Emergency stop, bumpers and cliff sensors, after the two channels of each were compared.
//!
//! Comparing channels, filtering test pulses and judging the discrepancy time is the driver's work (book, Safety
//! inputs: Two channels); what arrives here is already one verdict per input. Anything but [`SafetyInput::Clear`] is
//! danger.

use crate::time::Stamp;

/// What one safety input says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SafetyInput {
    /// Never read, out of range, saturated or stuck: treated as danger.
    #[default]
    Unknown,
    /// Operating state on every channel: nothing pressed, floor present.
    Clear,
    /// Pressed, or no floor. At least one channel left its operating state.
    Active,
    /// The channels disagreed for longer than the discrepancy time, or the line is cut or shorted.
    Fault,
}

/// All safety inputs at one moment.
///
/// ```
/// use floorguard_types::sensing::{DiscreteInputs, SafetyInput};
/// use floorguard_types::time::Stamp;
///
/// assert_eq!(DiscreteInputs::default().emergency_stop, SafetyInput::Unknown);
/// let inputs = DiscreteInputs::all_clear(Stamp::ZERO);
/// assert_eq!(inputs.bumper_front, SafetyInput::Clear);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DiscreteInputs {
    /// When the inputs were sampled.
    pub stamp: Stamp,
    /// Emergency-stop circuit, any button of it.
    pub emergency_stop: SafetyInput,
    /// Contact edge at the front.
    pub bumper_front: SafetyInput,
    /// Contact edge at the rear.
    pub bumper_rear: SafetyInput,
    /// Floor sensors at the front.
    pub cliff_front: SafetyInput,
    /// Floor sensors at the rear.
    pub cliff_rear: SafetyInput,
}

impl DiscreteInputs {
    /// Every input in its operating state.
    #[must_use]
    pub const fn all_clear(stamp: Stamp) -> Self {
        Self {
            stamp,
            emergency_stop: SafetyInput::Clear,
            bumper_front: SafetyInput::Clear,
            bumper_rear: SafetyInput::Clear,
            cliff_front: SafetyInput::Clear,
            cliff_rear: SafetyInput::Clear,
        }
    }
}
