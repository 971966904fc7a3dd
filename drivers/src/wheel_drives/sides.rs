//! The sides of a base: what their wheels are to do, and what they do.

use floorguard_types::sensing::{DriveFeedback, DriveState};
use floorguard_types::time::Stamp;

use super::configuration::WHEELS_MAX;

/// Code reported where the wheels of one side do not turn alike: the base slips, or moves sideways.
const SIDE_DISAGREEMENT: u16 = 0xFF03;
/// Wheels of one side may differ by this, m/s, …
const DISAGREEMENT_MPS: f32 = 0.15;
/// … in so many reports in a row, 10 ms apart.
const DISAGREEMENT_REPORTS: u8 = 30;

/// Speeds of both sides over ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SideTargets {
    /// Of the wheels on the left, m/s.
    pub left_mps: f32,
    /// Of the wheels on the right, m/s.
    pub right_mps: f32,
}

impl SideTargets {
    /// Speed of the faster side, m/s.
    #[must_use]
    pub fn fastest_mps(&self) -> f32 {
        libm::fabsf(self.left_mps).max(libm::fabsf(self.right_mps))
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.left_mps.is_finite() && self.right_mps.is_finite()
    }

    /// Moves towards other speeds, both by the same share, so that the faster change takes a step of at most `step_mps`.
    pub(crate) fn toward(self, wanted: Self, step_mps: f32) -> Self {
        let change =
            Self { left_mps: wanted.left_mps - self.left_mps, right_mps: wanted.right_mps - self.right_mps };
        let share = (step_mps / change.fastest_mps().max(1.0e-6)).min(1.0);
        if share >= 1.0 {
            return wanted;
        }
        Self {
            left_mps: self.left_mps + share * change.left_mps,
            right_mps: self.right_mps + share * change.right_mps,
        }
    }

    /// Mean of the wheels of each side: left and right, or front left, front right, rear left, rear right.
    pub(crate) fn measured(speeds_mps: [f32; WHEELS_MAX], wheels: usize) -> Self {
        let [front_left, front_right, rear_left, rear_right] = speeds_mps;
        match wheels {
            WHEELS_MAX => {
                Self { left_mps: 0.5 * (front_left + rear_left), right_mps: 0.5 * (front_right + rear_right) }
            }
            _ => Self { left_mps: front_left, right_mps: front_right },
        }
    }

    /// As the guard takes it: the speed of a steered wheel a lever before the base point, and where it points.
    pub(crate) fn feedback(
        self,
        (stamp, state): (Stamp, DriveState),
        (track_m, lever_m): (f32, f32),
    ) -> DriveFeedback {
        let across_mps = (self.right_mps - self.left_mps) / track_m.max(1.0e-3) * lever_m;
        let forward_mps = 0.5 * (self.left_mps + self.right_mps);
        DriveFeedback {
            stamp,
            state,
            wheel_speed_mps: libm::hypotf(forward_mps, across_mps),
            steering_rad: libm::atan2f(across_mps, forward_mps),
        }
    }
}

/// Four wheels that move a base forward and turn it are alike on each side; else it moves sideways, or a wheel slips (FG-REQ-082).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SideMonitor {
    reports_in_disagreement: u8,
    disagrees: bool,
}

impl SideMonitor {
    /// A report of all wheels.
    pub fn watch(&mut self, speeds_mps: [f32; WHEELS_MAX], wheels: usize) {
        if wheels < WHEELS_MAX {
            return;
        }
        let [front_left, front_right, rear_left, rear_right] = speeds_mps;
        let gap_mps = libm::fabsf(front_left - rear_left).max(libm::fabsf(front_right - rear_right));
        let is_apart = gap_mps > DISAGREEMENT_MPS;
        self.reports_in_disagreement =
            if is_apart { self.reports_in_disagreement.saturating_add(1) } else { 0 };
        self.disagrees |= self.reports_in_disagreement >= DISAGREEMENT_REPORTS;
    }

    /// The code of the fault, until a reset.
    pub const fn fault(&self) -> Option<u16> {
        if self.disagrees { Some(SIDE_DISAGREEMENT) } else { None }
    }
}
