//! Where the robot is: by a known map, or by the map that it makes.

use floorguard_mapping::{DirtCell, Grid};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::random::Pcg32;

use super::plan::NavigationPlan;
use super::survey::{SharedSurvey, locked};
use crate::site::{Floor, Localiser, scrubber};

/// What keeps the place.
pub(super) enum Place {
    /// The particle filter on a known map.
    Known(Box<(Floor, Localiser)>),
    /// The map under construction.
    Surveyed(SharedSurvey),
}

impl Place {
    /// At the start of a plan, on its map.
    ///
    /// # Errors
    /// The map has no floor for a robot of this radius.
    pub(super) fn on_map(plan: &NavigationPlan, radius_m: f32) -> anyhow::Result<Self> {
        let mut floor = Floor::new("navigation", plan.occupancy()?, radius_m)?;
        floor.start = plan.start_pose();
        // The belief of the cleaning mission, on a floor where nothing is dirty: it keeps the pose alone.
        let cells = Grid::new(floor.cells, vec![DirtCell::CLEAN; floor.cells.cell_count()])?;
        let mut localiser = Localiser::new(&floor, scrubber::belief(5), cells, Pcg32::new(plan.seed, 73));
        localiser.brush_turns = false;
        Ok(Self::Known(Box::new((floor, localiser))))
    }

    /// The robot in the map frame.
    pub(super) fn pose(&self, in_odometry: Pose2) -> Pose2 {
        match self {
            Self::Known(known) => known.1.pose(in_odometry),
            Self::Surveyed(survey) => locked(survey).odometry_in_map().compose(in_odometry),
        }
    }

    /// The robot is at `pose_in_map` now. A map that is made here keeps its own place.
    pub(super) fn relocate(&mut self, pose_in_map: Pose2, in_odometry: Pose2) {
        if let Self::Known(known) = self {
            known.1.relocate(pose_in_map, in_odometry);
        }
    }

    /// The pose explains what the scanner sees. A map that is made here agrees with its scans by the way it is made.
    pub(super) fn is_trusted(&self) -> bool {
        match self {
            Self::Known(known) => known.1.is_trusted(),
            Self::Surveyed(_) => true,
        }
    }

    /// Doubt of the pose, metres. A map that is made here has its own place.
    pub(super) fn doubt_m(&self) -> f32 {
        match self {
            Self::Known(known) => known.1.doubt_m(),
            Self::Surveyed(_) => 0.0,
        }
    }

    /// The middle of a free floor: what stands there is not on the map.
    pub(super) fn is_middle_of_floor(&self, place_in_map: Point2, clearance_m: f32) -> bool {
        match self {
            Self::Known(known) => known.0.clearance.clearance_m(place_in_map) > clearance_m,
            Self::Surveyed(_) => false,
        }
    }
}
