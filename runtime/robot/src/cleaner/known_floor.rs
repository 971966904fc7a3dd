//! What is known of the floor while somebody else drives: the brush cleans on every way, and a cleaning that did not know it would
//! expect dirt where none lies any more. Its dirt sensor would then contradict the pose, and nothing could be claimed.

use floorguard_mapping::{DirtCell, NO_SLOT};
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_runtime::tasks::MissionMoment;
use floorguard_types::geometry::Point2;
use floorguard_types::time::Stamp;

use super::mission::{Cleaner, SharedWatch};
use super::ordered::{Whereabouts, prepared};
use super::plan::MissionPlan;

/// What was cleaned longer ago counts as dirty as expected again, microseconds: an hour.
const FORGOTTEN_US: u64 = 3_600_000_000;
/// When a cell changed is noted this often, microseconds.
const NOTED_US: u64 = 10_000_000;
/// Farther from where the drive is, somebody has put the robot there, metres.
const APART_M: f32 = 0.5;

/// The floor of a mission, and when what is known of it changed.
pub struct KnownFloor {
    beliefs: Cleaner,
    prior: Vec<DirtCell>,
    noted: Vec<(f32, u64)>,
    next_us: u64,
}

impl KnownFloor {
    /// Nothing is known but what the plan expects.
    ///
    /// # Errors
    /// The plan has no floor for this robot.
    pub fn new((plan, robot): (&MissionPlan, &RobotConfiguration), at: &Whereabouts) -> anyhow::Result<Self> {
        let beliefs = prepared((plan, robot), &SharedWatch::default(), at)?;
        let prior = beliefs.plan.prior(&beliefs.ground.expected);
        let noted = prior.iter().map(|cell| (cell.expected_units, 0)).collect();
        Ok(Self { beliefs, prior, noted, next_us: 0 })
    }

    /// A moment in which somebody else drives.
    pub fn observe(&mut self, moment: &MissionMoment<'_>, driven: &Whereabouts) {
        self.beliefs.observe(moment);
        if moment.now.as_micros() >= self.next_us {
            self.next_us = moment.now.as_micros().saturating_add(NOTED_US);
            self.note(moment.now);
            self.follow(driven);
        }
    }

    fn note(&mut self, now: Stamp) {
        for (noted, cell) in self.noted.iter_mut().zip(self.beliefs.localiser.map.values()) {
            if noted.0 != cell.expected_units {
                *noted = (cell.expected_units, now.as_micros());
            }
        }
    }

    /// The robot was put somewhere else: the drive knows.
    fn follow(&mut self, driven: &Whereabouts) {
        let (own, other) = (self.beliefs.pose(), driven.pose_in_map);
        let apart_m = Point2::new(own.x_m, own.y_m).distance(Point2::new(other.x_m, other.y_m));
        if apart_m > APART_M {
            self.go_on_at(driven);
        }
    }

    fn go_on_at(&mut self, at: &Whereabouts) {
        let odometry = at.odometry.pose_in_odometry;
        self.beliefs.odometry = at.odometry;
        self.beliefs.poses = at.poses.clone();
        self.beliefs.localiser.go_on_at((at.pose_in_map, at.doubt_m), odometry, at.is_trusted);
    }

    /// Where the robot is. What is under the brush is decided.
    pub fn settled_at(&mut self, driven: &Whereabouts) -> Whereabouts {
        self.follow(driven);
        self.beliefs.localiser.settle();
        self.beliefs.whereabouts()
    }

    /// A cleaning begins with what is known, as far as it is not too old. One with another promise counts what is left otherwise, and
    /// begins with what the plan expects.
    pub fn tell(&mut self, cleaner: &mut Cleaner, now: Stamp) {
        self.note(now);
        let known = self.beliefs.localiser.map.values_mut();
        for ((known, prior), (_, since_us)) in known.iter_mut().zip(&self.prior).zip(&self.noted) {
            if now.as_micros().saturating_sub(*since_us) > FORGOTTEN_US {
                *known = *prior;
            }
        }
        if cleaner.plan.tolerated_units == self.beliefs.plan.tolerated_units {
            copy(&self.beliefs, cleaner);
        }
    }

    /// A cleaning has ended: what it knows is known from now on.
    pub fn learn(&mut self, cleaner: &mut Cleaner, now: Stamp) {
        cleaner.localiser.settle();
        if cleaner.plan.tolerated_units == self.beliefs.plan.tolerated_units {
            copy(cleaner, &mut self.beliefs);
        }
        self.beliefs.dirt = cleaner.dirt;
        self.go_on_at(&cleaner.whereabouts());
        self.note(now);
    }
}

/// What one knows of the floor the other knows, too.
fn copy(from: &Cleaner, to: &mut Cleaner) {
    for (cell, known) in to.localiser.map.values_mut().iter_mut().zip(from.localiser.map.values()) {
        *cell = DirtCell { slot: NO_SLOT, ..*known };
    }
}
