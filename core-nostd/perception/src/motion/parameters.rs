//! The parameters of the detector of moving objects, with the published values and ours.
//!
//! Symbols of the source in brackets (book, Motion: Published steps).

/// Frames of history that a chain may need at most (ζ ≤ 8).
pub const CHAIN_MAX: u8 = 8;

/// Steps 4 to 7.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionParameters {
    /// Sweeps in a row in which an object must have changed before it is reported (ζ).
    pub chain: u8,
    /// Sweeps at rest after which a reported object is forgotten: one more than this (β_max).
    pub rest_max: u8,
    /// An object has changed if `changed · sensitivity > points before + points now` (η).
    pub sensitivity: u16,
    /// A centroid closer than this to a reported one is the same object, metres (Δ_catch-up).
    pub catch_up_m: f32,
    /// A reported object whose nearest object is farther than this has left, metres (Δ_leave-off, true
    /// distance).
    pub leave_off_m: f32,
    /// |v₁−v₂| / (v₁+v₂) of two boxes that may be the same object (δ).
    pub volume_change_max: f32,
    /// Fastest object, m/s: gate of the correspondence (book, Motion: Correspondence).
    pub speed_max_mps: f32,
    /// Parts with fewer new returns are noise (own; not used by the published steps).
    pub points_min: u16,
    /// Added to the gate for noise and the shift of a centroid, metres.
    pub gate_m: f32,
}

impl MotionParameters {
    /// The optimum of Rath et al. 2020.
    pub const PAPER: Self = Self {
        chain: 4,
        rest_max: 3,
        sensitivity: 20,
        catch_up_m: 0.2,
        leave_off_m: 0.5,
        volume_change_max: 0.3,
        speed_max_mps: 6.0,
        gate_m: 0.1,
        points_min: 1,
    };

    /// For the parts of [`super::MotionDetector`]: nothing on a floor among people runs faster than 3 m/s, and what
    /// changes of a walker has another volume in every sweep, so volumes are not compared.
    pub const FIXED: Self = Self { volume_change_max: 1.0, points_min: 8, speed_max_mps: 3.0, ..Self::PAPER };

    /// Every value is within its range: chain 1 to 8, sensitivity at least 1, distances positive and finite.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let positive = |value: f32| value.is_finite() && value > 0.0;
        (1..=CHAIN_MAX).contains(&self.chain)
            && self.sensitivity > 0
            && positive(self.catch_up_m)
            && positive(self.leave_off_m)
            && positive(self.volume_change_max)
            && positive(self.speed_max_mps)
            && self.gate_m.is_finite()
            && self.gate_m >= 0.0
    }
}

impl Default for MotionParameters {
    fn default() -> Self {
        Self::FIXED
    }
}
