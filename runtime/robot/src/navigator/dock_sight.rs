//! What the scanner saw at the dock, and where the robot stands from there by what it sees now.
//!
//! The mean of many scans is kept. A new scan is brought near by a field whose value falls with the distance from what they met, and then
//! laid onto their lines, to millimetres (book, Navigation to a goal: Docking). Between the scans the wheels tell the way.

use floorguard_localisation::scan_matching::{DescentConfig, Guess, Panorama, refine};
use floorguard_mapping::GridGeometry;
use floorguard_mapping::match_field::MatchField;
use floorguard_types::geometry::{Point2, Pose2, wrap_angle};
use floorguard_types::sensing::{BeamReturn, Scan};

/// The robot looks at its dock for so many scans before it leaves it, …
const SCANS_MIN: u32 = 10;
/// … and for no more than these.
const SCANS_MAX: u32 = 100;
/// Beams that must meet something there.
const BEAMS_MIN: usize = 60;
/// From the middle of a field to its edges, and how far what is met may be, metres.
const HALF_M: f32 = 12.0;
const NEAR_M: f32 = 11.0;
/// Edge of a cell, and where values have fallen to zero, metres.
const CELL_M: f32 = 0.05;
const REACH_M: f32 = 0.6;
/// Share of what a scan says against the wheels.
const SHARE: f32 = 0.25;
/// A scan of which fewer returns lie on lines of the dock says nothing.
const SHARE_LEAST: f32 = 0.4;
/// Nor does one that leaps, metres.
const LEAP_M: f32 = 0.2;

/// Sums of what each beam met.
#[derive(Clone, Debug, Default)]
struct Beams {
    angles_rad: [f32; 2],
    sums: Vec<(f32, u32)>,
    scans: u32,
}

impl Beams {
    fn add(&mut self, scan: &Scan) {
        if self.sums.len() != scan.beams.len() {
            *self = Self::default();
            self.sums = vec![(0.0, 0); scan.beams.len()];
        }
        self.angles_rad = [scan.first_angle_rad, scan.step_rad];
        self.scans += 1;
        for ((sum_m, count), beam) in self.sums.iter_mut().zip(&scan.beams) {
            if let BeamReturn::Hit(range_mm) = beam {
                *sum_m += f32::from(*range_mm) * 1.0e-3;
                *count += 1;
            }
        }
    }

    /// Mean ranges of the beams that mostly met something, 0 for all others.
    fn ranges_m(&self) -> Vec<f32> {
        let mean = |(sum_m, count): &(f32, u32)| {
            let mean_m = sum_m / (*count).max(1) as f32;
            if 2 * count > self.scans && mean_m < NEAR_M { mean_m } else { 0.0 }
        };
        self.sums.iter().map(mean).collect()
    }

    /// Where those ended, in the scanner's frame.
    fn ends(&self) -> Vec<Point2> {
        let [first_rad, step_rad] = self.angles_rad;
        let ranges_m = self.ranges_m();
        let met = ranges_m.iter().enumerate().filter(|(_, range_m)| **range_m > 0.0);
        let end = |(beam, range_m): (usize, &f32)| {
            let (sin, cos) = libm::sincosf(first_rad + beam as f32 * step_rad);
            Point2::new(range_m * cos, range_m * sin)
        };
        met.map(end).collect()
    }
}

/// The dock, once the robot has left it.
struct Known {
    field: MatchField<Vec<u8>>,
    ranges_m: Vec<f32>,
}

/// The dock as the scanner knows it.
pub(super) struct DockSight {
    scanner_in_base: Pose2,
    beams: Beams,
    known: Option<Known>,
    /// The odometry frame in that of the dock, once the robot has found it again.
    odometry_in_dock: Option<Pose2>,
    /// Commands since a scan showed where the robot stands.
    unseen: u32,
}

impl DockSight {
    pub(super) fn new(scanner_in_base: Pose2) -> Self {
        Self { scanner_in_base, beams: Beams::default(), known: None, odometry_in_dock: None, unseen: 0 }
    }

    /// The robot stands at the dock and sees this.
    pub(super) fn learn(&mut self, scan: &Scan) {
        if self.beams.scans < SCANS_MAX {
            self.beams.add(scan);
        }
    }

    /// It has looked for long enough.
    pub(super) const fn is_known(&self) -> bool {
        self.beams.scans >= SCANS_MIN
    }

    /// Begins to look for the dock, from where the map says that the robot is. False: it saw too little there.
    pub(super) fn begin(&mut self, robot_in_dock: Pose2, odometry: Pose2) -> bool {
        self.odometry_in_dock = Some(robot_in_dock.compose(odometry.inverse()));
        if self.known.is_none() {
            let ends = self.beams.ends();
            let field = field(&ends).filter(|_| ends.len() >= BEAMS_MIN);
            self.known = field.map(|field| Known { field, ranges_m: self.beams.ranges_m() });
        }
        self.known.is_some()
    }

    /// Where the robot stands, dock frame, for its place in the odometry frame.
    pub(super) fn robot_in_dock(&self, odometry: Pose2) -> Option<Pose2> {
        self.odometry_in_dock.map(|frame| frame.compose(odometry))
    }

    /// Counts a command, and gives how many have passed since a scan showed where the robot stands. There is none while what is around
    /// the dock has changed, while somebody stands before the scanner, and while no scan comes.
    pub(super) const fn pass_command(&mut self) -> u32 {
        self.unseen = self.unseen.saturating_add(1);
        self.unseen
    }

    /// Commands since a scan showed where the robot stands.
    pub(super) const fn unseen(&self) -> u32 {
        self.unseen
    }

    /// A scan, taken at this place of the odometry frame.
    pub(super) fn see(&mut self, scan: &Scan, odometry: Pose2) {
        let Some(frame) = self.odometry_in_dock else { return };
        let expected = frame.compose(odometry);
        let Some(found) = self.found(scan, expected) else { return };
        self.unseen = 0;
        let turn_rad = wrap_angle(found.heading_rad - expected.heading_rad);
        let corrected = Pose2::new(
            expected.x_m + SHARE * (found.x_m - expected.x_m),
            expected.y_m + SHARE * (found.y_m - expected.y_m),
            expected.heading_rad + SHARE * turn_rad,
        );
        self.odometry_in_dock = Some(corrected.compose(odometry.inverse()));
    }

    /// Where the robot stands by a scan alone, dock frame; `None`: it fits nowhere near.
    fn found(&self, scan: &Scan, expected: Pose2) -> Option<Pose2> {
        let known = self.known.as_ref()?;
        let mut seen = Beams::default();
        seen.add(scan);
        let returns = seen.ends();
        // The scanner at the dock and now; the robot is the same body around it.
        let scanner = expected.compose(self.scanner_in_base);
        let scanner = self.scanner_in_base.inverse().compose(scanner);
        let descent = DescentConfig {
            reach_m: REACH_M,
            return_deviation_m: 0.03,
            outlier_distance_m: 0.2,
            steps_max: 20,
            step_least: 1.0e-4,
        };
        let near = refine(&known.field.levels()[0], &returns, &Guess::without_odometry(scanner), &descent);
        let [first_angle_rad, step_rad] = self.beams.angles_rad;
        let panorama = Panorama { ranges_m: &known.ranges_m, first_angle_rad, step_rad };
        let found = panorama.locate(&returns, near.pose)?;
        let leap_m = libm::hypotf(found.pose.x_m - scanner.x_m, found.pose.y_m - scanner.y_m);
        let fits = found.share >= SHARE_LEAST && leap_m <= LEAP_M;
        let base = self.scanner_in_base.compose(found.pose).compose(self.scanner_in_base.inverse());
        fits.then_some(base)
    }
}

/// A field around the scanner at the dock in which these places lie.
fn field(met: &[Point2]) -> Option<MatchField<Vec<u8>>> {
    let cells = (2.0 * HALF_M / CELL_M) as u16;
    let geometry = GridGeometry::new(cells, cells, CELL_M, Point2::new(-HALF_M, -HALF_M))?;
    let storage = || vec![0; geometry.cell_count()];
    let mut field = MatchField::new(geometry, [storage(), storage()], REACH_M).ok()?;
    met.iter().for_each(|place| field.insert(*place));
    Some(field)
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_types::random::Pcg32;
    use floorguard_types::time::Stamp;

    /// A scan in a room of 6 by 4 m with a cupboard, with 3 cm of noise.
    fn scan_at(scanner: Pose2, random: &mut Pcg32) -> Scan {
        let mut scan = Scan { first_angle_rad: -2.356, step_rad: 0.008_727, ..Scan::EMPTY };
        scan.stamp = Stamp::from_micros(1);
        for beam in 0..541_u16 {
            let angle = scanner.heading_rad + scan.first_angle_rad + f32::from(beam) * scan.step_rad;
            let (sin, cos) = libm::sincosf(angle);
            let to = |at: f32, from: f32, along: f32| {
                if along.abs() < 1.0e-6 { 99.0 } else { (at - from) / along }
            };
            let walls = [
                to(4.0, scanner.x_m, cos),
                to(-2.0, scanner.x_m, cos),
                to(2.0, scanner.y_m, sin),
                to(-2.0, scanner.y_m, sin),
            ];
            let mut range_m = walls.into_iter().filter(|range| *range > 0.0).fold(99.0, f32::min);
            // The front of a cupboard at x = 3, y from 0.5 to 1.5.
            let cupboard_m = to(3.0, scanner.x_m, cos);
            let side_m = scanner.y_m + cupboard_m * sin;
            if cupboard_m > 0.0 && (0.5..1.5).contains(&side_m) {
                range_m = range_m.min(cupboard_m);
            }
            let noisy_m = range_m + 0.03 * random.normal();
            scan.beams.push(BeamReturn::Hit((noisy_m * 1_000.0) as u16)).expect("541 beams");
        }
        scan
    }

    #[test]
    fn place_is_known_to_millimetres() {
        let scanner_in_base = Pose2::new(0.9, 0.0, 0.0);
        let mut random = Pcg32::new(3, 1);
        let mut sight = DockSight::new(scanner_in_base);
        assert!(!sight.is_known());
        (0..40).for_each(|_| sight.learn(&scan_at(scanner_in_base, &mut random)));
        assert!(sight.is_known());
        // The map is wrong by 8 cm and 3 degrees; the wheels say nothing.
        let truth = Pose2::new(-0.3, 0.04, 0.06);
        assert!(sight.begin(Pose2::new(-0.36, 0.09, 0.01), Pose2::default()));
        for _ in 0..25 {
            sight.see(&scan_at(truth.compose(scanner_in_base), &mut random), Pose2::default());
        }
        let found = sight.robot_in_dock(Pose2::default()).expect("a place");
        let off_m = libm::hypotf(found.x_m - truth.x_m, found.y_m - truth.y_m);
        let off_rad = (found.heading_rad - truth.heading_rad).abs();
        assert!(off_m < 0.004 && off_rad < 0.003, "{off_m} m, {off_rad} rad");
    }

    /// Another room than that of the dock moves nothing.
    #[test]
    fn other_surroundings_say_nothing() {
        let mut random = Pcg32::new(3, 1);
        let mut sight = DockSight::new(Pose2::default());
        (0..20).for_each(|_| sight.learn(&scan_at(Pose2::default(), &mut random)));
        assert!(sight.begin(Pose2::default(), Pose2::default()));
        sight.see(&scan_at(Pose2::new(0.5, 0.9, 0.7), &mut random), Pose2::default());
        assert_eq!(sight.robot_in_dock(Pose2::default()), Some(Pose2::default()));
    }
}
