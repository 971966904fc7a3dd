//! Places beside the body that the scanner has never looked through: scans are cast at boxes by plain geometry, and the robot stands,
//! turns and drives beside them.

use crate::tests::fixtures::{config, forward};
use crate::{Blind, Supervisor};
use floorguard_types::geometry::{Point2, Twist2};
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;

/// A box as seen from above: least and greatest x and y, metres, in the frame in which the robot starts.
type Plan = [[f32; 2]; 2];

/// Beside the right flank, 5 cm from the body.
const BESIDE: Plan = [[-0.23, 0.22], [-0.87, -0.45]];

/// Where a beam enters a box, metres along it.
fn entered_m(plan: &Plan, from: [f32; 2], direction: [f32; 2]) -> Option<f32> {
    let (mut enters, mut leaves) = (0.0_f32, f32::INFINITY);
    for ((side, from), direction) in plan.iter().zip(from).zip(direction) {
        let [a, b] = side.map(|end| (end - from) / direction);
        (enters, leaves) = (enters.max(a.min(b)), leaves.min(a.max(b)));
    }
    (enters < leaves).then_some(enters)
}

struct Drive {
    guard: Supervisor,
    steps: u64,
}

impl Drive {
    fn begin() -> Self {
        Self { guard: Supervisor::new(config(), Stamp::from_micros(1_000_000)).unwrap(), steps: 0 }
    }

    fn go(&mut self, motion: Twist2, seconds: f32, boxes: &[Plan]) {
        for _ in 0..(seconds * 100.0) as u64 {
            let now = Stamp::from_micros(1_000_000 + self.steps * 10_000);
            self.steps += 1;
            self.guard.on_wheels(motion, now, now);
            if self.steps.is_multiple_of(4) {
                let scan = self.scan(now, boxes);
                self.guard.remember_scan(&scan);
                self.guard.memory.mark_ends();
            }
        }
    }

    fn scan(&self, stamp: Stamp, boxes: &[Plan]) -> Scan {
        let (pose, geometry) = (self.guard.memory.pose(), config().scanner);
        let at = pose.transform(Point2::new(geometry.mounting.x_m, geometry.mounting.y_m));
        let beams = (0..geometry.beams).map(|beam| {
            let angle_rad = pose.heading_rad + geometry.first_angle_rad + beam as f32 * geometry.step_rad;
            let met = |plan: &Plan| entered_m(plan, [at.x_m, at.y_m], [angle_rad.cos(), angle_rad.sin()]);
            let met_m = boxes.iter().filter_map(met).reduce(f32::min);
            met_m.map_or(BeamReturn::Free(30_000), |met_m| BeamReturn::Hit((met_m * 1.0e3) as u16))
        });
        let beams = beams.collect();
        let (first_angle_rad, step_rad) = (geometry.first_angle_rad, geometry.step_rad);
        Scan { stamp, sequence: (self.steps / 4) as u32, first_angle_rad, step_rad, beams }
    }

    /// In the frame in which the robot started.
    fn never_seen(&self) -> std::vec::Vec<Point2> {
        let (memory, mut places) = (&self.guard.memory, std::vec::Vec::new());
        let (pose, blind) = (memory.pose(), Blind::of(&self.guard.scan_table).unwrap());
        memory.for_each_never_seen(&blind, (pose, &self.guard.body), |place| {
            places.push(pose.transform(place))
        });
        places
    }

    fn has_near(&self, place: Point2) -> bool {
        self.never_seen().into_iter().any(|seen| seen.distance(place) < 0.06)
    }
}

/// The scanner meets the far end of a box that stands beside the flank: its near corner, to which the flank turns, was never seen.
#[test]
fn fg_req_069_near_side_never_seen_holds() {
    let mut drive = Drive::begin();
    drive.go(Twist2::ZERO, 0.5, &[BESIDE]);
    assert!(drive.has_near(Point2::new(0.22, -0.45)), "{:?}", drive.never_seen());
    drive.guard.memory.reset_means_way = true;
    drive.guard.memory.on_reset(Stamp::from_micros(9_000_000));
    drive.go(Twist2::ZERO, 0.5, &[BESIDE]);
    assert!(drive.never_seen().is_empty(), "a person has looked there");
}

/// What the robot comes by was looked through around the object, whatever the speed, and when it turns away from it, too.
#[test]
fn fg_req_069_what_is_come_by_is_seen() {
    for (mps, gap_m) in [(0.25, 0.12), (0.5, 0.05), (0.5, 0.3), (1.0, 0.12), (1.0, 0.3)] {
        let beside = [[2.0, 2.6], [-0.9 - gap_m, -0.4 - gap_m]];
        let along = [[-3.0, 9.0], [0.4 + gap_m, 0.9 + gap_m]];
        let mut drive = Drive::begin();
        drive.go(forward(mps), 2.5 / mps, &[beside, along]);
        let near = |place: &Point2| place.x_m > 0.9 && place.y_m.abs() < 0.4 + gap_m - 0.06;
        let seen: std::vec::Vec<_> = drive.never_seen().into_iter().filter(near).collect();
        assert!(seen.is_empty(), "{mps} m/s, {gap_m} m: {seen:?}");
        for angular_radps in [0.8, -0.8] {
            drive.go(Twist2 { linear_mps: 0.0, angular_radps }, 0.3, &[beside, along]);
            let seen: std::vec::Vec<_> = drive.never_seen().into_iter().filter(near).collect();
            assert!(seen.is_empty(), "{mps} m/s, {gap_m} m, {angular_radps} rad/s: {seen:?}");
        }
    }
}
