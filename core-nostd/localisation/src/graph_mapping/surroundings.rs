//! Kept scans against which a new one is matched.

use floorguard_types::geometry::Pose2;

use super::kept::KeptScan;

/// Scans around a place lie within, metres; and about so many of them are used.
const AROUND_M: f32 = 3.0;
const AROUND_MAX: usize = 24;

/// Kept scans that belong together where the robot is: of the last metres of its path, or where it was before those around.
#[derive(Clone, Copy)]
pub(super) struct Surroundings {
    pub(super) place: Pose2,
    pub(super) path_m: f32,
    pub(super) is_known: bool,
    pub(super) recent_m: f32,
}

impl Surroundings {
    fn has<const POINTS: usize>(&self, scan: &KeptScan<POINTS>) -> bool {
        if self.is_known {
            libm::hypotf(scan.pose.x_m - self.place.x_m, scan.pose.y_m - self.place.y_m) < AROUND_M
        } else {
            libm::fabsf(scan.path_m - self.path_m) < self.recent_m
        }
    }

    /// At most twice as many as are wanted, evenly among all.
    pub(super) fn of<const POINTS: usize>(
        self,
        scans: &[KeptScan<POINTS>],
    ) -> impl Iterator<Item = &KeptScan<POINTS>> + Clone {
        let count = scans.iter().filter(|scan| self.has(scan)).count();
        let step = count.div_ceil(AROUND_MAX).max(1);
        scans.iter().filter(move |scan| self.has(scan)).step_by(step)
    }
}
