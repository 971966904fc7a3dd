//! A robot with a flat scanner that drives around the core of a building whose wheels slip: the map in fixed memory.

use cortex_m_semihosting::hprintln;
use floorguard_localisation::graph_mapping::{GraphMappingConfig, MappingStep, OfMicrocontroller};
use floorguard_types::geometry::{Point2, Pose2};
use heapless::Vec;
use static_cell::StaticCell;

use crate::stopwatch::Stopwatch;

/// Walls from and to, metres.
const WALLS: [[f32; 4]; 16] = [
    [0.0, 0.0, 24.0, 0.0],
    [24.0, 0.0, 24.0, 16.0],
    [24.0, 16.0, 0.0, 16.0],
    [0.0, 16.0, 0.0, 0.0],
    [4.0, 4.0, 20.0, 4.0],
    [20.0, 4.0, 20.0, 12.0],
    [20.0, 12.0, 4.0, 12.0],
    [4.0, 12.0, 4.0, 4.0],
    [9.0, 0.0, 9.0, 1.2],
    [16.5, 12.0, 16.5, 13.2],
    [20.0, 7.0, 21.2, 7.0],
    [22.8, 7.4, 24.0, 7.4],
    [0.0, 9.0, 1.1, 9.0],
    [2.8, 9.2, 4.0, 9.2],
    [13.0, 0.0, 13.6, 0.9],
    [7.0, 15.1, 7.8, 16.0],
];
const CORNERS: [[f32; 2]; 4] = [[2.0, 2.0], [22.0, 2.0], [22.0, 14.0], [2.0, 14.0]];
/// Beams of a scan over 270 degrees.
const BEAMS: usize = 541;
/// Metres between scans, and times around.
const STEP_M: f32 = 0.1;
const SIDES: usize = 6;

static MAPPER: StaticCell<OfMicrocontroller> = StaticCell::new();

fn scan(pose: Pose2) -> Vec<Point2, BEAMS> {
    let mut returns = Vec::new();
    for beam in 0..BEAMS {
        let angle = (-135.0 + 0.5 * beam as f32).to_radians();
        let (sin, cos) = libm::sincosf(pose.heading_rad + angle);
        let mut range = f32::INFINITY;
        for [x1, y1, x2, y2] in WALLS {
            let (wall_x, wall_y) = (x2 - x1, y2 - y1);
            let cross = cos * wall_y - sin * wall_x;
            let (from_x, from_y) = (x1 - pose.x_m, y1 - pose.y_m);
            let away = (from_x * wall_y - from_y * wall_x) / cross;
            let along = (from_x * sin - from_y * cos) / cross;
            if away > 0.0 && (0.0..=1.0).contains(&along) {
                range = range.min(away);
            }
        }
        let (sin, cos) = libm::sincosf(angle);
        let _ = returns.push(Point2::new(range * cos, range * sin));
    }
    returns
}

/// What the robot meets on its way.
struct Drive {
    mapper: &'static mut OfMicrocontroller,
    begun: Pose2,
    pose: Pose2,
    odometry: Pose2,
    off_m: f32,
    matched: Stopwatch,
    kept: Stopwatch,
}

impl Drive {
    fn step(&mut self, pose: Pose2) {
        let moved = self.pose.inverse().compose(pose);
        self.pose = pose;
        let turn = 0.94 * moved.heading_rad + 0.009 * moved.x_m;
        self.odometry = self.odometry.compose(Pose2::new(0.97 * moved.x_m, moved.y_m, turn));
        let returns = scan(pose);
        let (step, instructions) = Stopwatch::of(|| self.mapper.push(&returns, self.odometry));
        match step {
            MappingStep::Passed => return,
            MappingStep::Kept(_) => self.kept.enter(instructions),
            _ => self.matched.enter(instructions),
        }
        let truth = self.begun.inverse().compose(pose);
        let found = self.mapper.pose();
        self.off_m = self.off_m.max(libm::hypotf(found.x_m - truth.x_m, found.y_m - truth.y_m));
    }
}

/// Drives, and prints.
pub fn run() {
    let Some(mapper) = OfMicrocontroller::new(GraphMappingConfig::default()) else { return };
    let begun = Pose2::new(CORNERS[0][0], CORNERS[0][1], 0.0);
    let mut drive = Drive {
        mapper: MAPPER.init(mapper),
        begun,
        pose: begun,
        odometry: Pose2::default(),
        off_m: 0.0,
        matched: Stopwatch::default(),
        kept: Stopwatch::default(),
    };
    for side in 0..SIDES {
        let ([x, y], [to_x, to_y]) = (CORNERS[side % 4], CORNERS[(side + 1) % 4]);
        let heading = libm::atan2f(to_y - y, to_x - x);
        let steps = (libm::hypotf(to_x - x, to_y - y) / STEP_M) as usize;
        for step in 0..steps {
            let share = step as f32 / steps as f32;
            drive.step(Pose2::new(x + share * (to_x - x), y + share * (to_y - y), heading));
        }
        for turn in 0..9 {
            drive.step(Pose2::new(to_x, to_y, heading + (10.0 * turn as f32).to_radians()));
        }
    }
    drive.matched.print("graph-mapping-matched");
    drive.kept.print("graph-mapping-kept");
    hprintln!("bytes graph-mapping {}", size_of::<OfMicrocontroller>());
    hprintln!("off_mm graph-mapping {}", (1.0e3 * drive.off_m) as u32);
}
