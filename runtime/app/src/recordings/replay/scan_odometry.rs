//! Where a scanner stands in a recording without odometry: each scan is matched against those of the last metres.
//!
//! Walking can only be seen in a frame that stands. The results are given in the frame of the sensor again.

use floorguard_mapping_host::front_end::{FrontEndConfig, Step, Tracker};
use floorguard_mapping_host::input::ScanRecord;
use floorguard_types::geometry::Pose2;
use floorguard_types::sensing::{BeamReturn, Scan};

/// A longer pause than this loses the place: matching begins anew, seconds.
const PAUSE_S: f64 = 2.0;
/// A match of kept scans below this is none.
const SCORE_MIN: f32 = 0.3;

/// What is known of a scanner's place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// In the frame of its first scan.
    Known(Pose2),
    /// The first scan of a frame; what was followed before is in another one.
    Begins,
    /// Lost for good: too little stands around it. Nothing is known of its motion from here on.
    Unknown,
}

/// Follows one scanner.
pub struct ScanOdometry {
    tracker: Tracker,
    last_s: Option<f64>,
    is_lost: bool,
}

impl ScanOdometry {
    /// Nothing seen yet; the frame begins at the first scan.
    pub fn new() -> Self {
        Self { tracker: Tracker::new(FrontEndConfig::default()), last_s: None, is_lost: false }
    }

    /// Where the scanner stood.
    pub fn place(&mut self, scan: &Scan) -> Place {
        if self.is_lost {
            return Place::Unknown;
        }
        let time_s = scan.stamp.as_micros() as f64 * 1.0e-6;
        let is_continued = self.last_s.replace(time_s).is_some_and(|last_s| time_s - last_s <= PAUSE_S);
        if !is_continued {
            self.tracker = Tracker::new(FrontEndConfig::default());
            self.tracker.push(&record(scan, time_s));
            return Place::Begins;
        }
        match self.matched(&record(scan, time_s)) {
            Some(pose) => Place::Known(pose),
            None => {
                self.is_lost = true;
                Place::Begins
            }
        }
    }

    fn matched(&mut self, record: &ScanRecord) -> Option<Pose2> {
        let pose = match self.tracker.push(record) {
            Step::Node(index) => {
                // The points of the last one alone are needed from here on.
                self.tracker.nodes.iter_mut().take(index).for_each(|node| node.points = Box::default());
                self.tracker.nodes.get(index).filter(|node| node.score >= SCORE_MIN)?.pose
            }
            Step::Passed => {
                let passage = self.tracker.passages.pop()?;
                self.tracker.nodes.get(passage.node)?.pose.compose(passage.from_node)
            }
        };
        Some(pose.single())
    }
}

fn record(scan: &Scan, time_s: f64) -> ScanRecord {
    let range_m = |beam: &BeamReturn| match beam {
        BeamReturn::Hit(range_mm) => f32::from(*range_mm) * 1.0e-3,
        _ => f32::NAN,
    };
    ScanRecord {
        time_s,
        odometry: None,
        first_angle_rad: scan.first_angle_rad,
        step_rad: scan.step_rad,
        ranges_m: scan.beams.iter().map(range_m).collect(),
        ..ScanRecord::default()
    }
}
