use super::*;
use crate::lidar3d::closing::SmallPoints;

/// A round of 72 m through a corridor about a block of rooms, walked once and a third: walls 2.4 m apart, with doors and pillars
/// that differ.
struct Building {
    /// Ends of walls on the plane.
    walls: Vec<[[f64; 2]; 2]>,
}

impl Building {
    fn new() -> Self {
        let mut walls = Vec::new();
        let mut ring = |half_x: f64, half_y: f64| {
            let corners = [[half_x, half_y], [-half_x, half_y], [-half_x, -half_y], [half_x, -half_y]];
            for side in 0..4 {
                walls.push([corners[side], corners[(side + 1) % 4]]);
            }
        };
        ring(11.2, 9.2);
        ring(8.8, 6.8);
        // Pillars of different sizes along the outer wall, at uneven distances.
        let pillars = [-9.0, -7.7, -4.1, -3.2, 0.4, 2.9, 3.7, 6.6, 9.1];
        for (index, x) in pillars.into_iter().enumerate() {
            let deep = 0.2 + 0.07 * index as f64;
            walls.push([[x, 9.2], [x, 9.2 - deep]]);
            walls.push([[x, 9.2 - deep], [x + 0.5, 9.2 - deep]]);
            walls.push([[-11.2, 0.8 * x], [-11.2 + deep, 0.8 * x]]);
            walls.push([[-11.2 + deep, 0.8 * x], [-11.2 + deep, 0.8 * x + 0.4]]);
            walls.push([[0.9 * x, -9.2], [0.9 * x, -9.2 + 0.6 * deep]]);
            walls.push([[11.2, 0.7 * x + 0.3], [11.2 - 0.8 * deep, 0.7 * x + 0.3]]);
        }
        Self { walls }
    }

    fn range_m(&self, from: &Vector3<f64>, (sin, cos): (f64, f64)) -> f64 {
        let hit = |[a, b]: &[[f64; 2]; 2]| {
            let (ex, ey) = (b[0] - a[0], b[1] - a[1]);
            let (ax, ay) = (a[0] - from.x, a[1] - from.y);
            let across = cos * ey - sin * ex;
            let range = (ax * ey - ay * ex) / across;
            let along = (ax * sin - ay * cos) / across;
            (range > 0.0 && (0.0..=1.0).contains(&along)).then_some(range)
        };
        self.walls.iter().filter_map(hit).fold(60.0, f64::min)
    }

    /// Points in the frame of the sensor: walls between 1 m below and 1.5 m above it, floor and ceiling.
    fn sweep(&self, pose: &Pose3) -> Vec<Vector3<f32>> {
        let back = pose.inverse();
        let mut points = Vec::new();
        for azimuth in 0..720 {
            let direction = (f64::from(azimuth) * 0.5).to_radians().sin_cos();
            let range = self.range_m(&pose.place_m, direction);
            for ring in -7..=8 {
                let slope = (2.0 * f64::from(ring) - 1.0).to_radians().tan();
                let floor = pose.place_m.z + 1.0;
                let reach = if slope < 0.0 { -floor / slope } else { (2.5 - floor) / slope };
                let range = range.min(reach);
                let (sin, cos) = direction;
                let place = pose.place_m + Vector3::new(range * cos, range * sin, range * slope);
                points.push(back.transform(&place).map(|value| value as f32));
            }
        }
        points
    }
}

/// Along the middle of the corridor.
fn on_the_round(at_m: f64) -> Pose3 {
    let corners: [[f64; 2]; 5] = [[10.0, -8.0], [10.0, 8.0], [-10.0, 8.0], [-10.0, -8.0], [10.0, -8.0]];
    let mut left = at_m.rem_euclid(72.0);
    for (side, pair) in corners.windows(2).enumerate() {
        let length = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
        if left <= length {
            let share = left / length;
            let part = |axis: usize| pair[0][axis] + share * (pair[1][axis] - pair[0][axis]);
            let heading = std::f64::consts::FRAC_PI_2 * (side + 1) as f64;
            let turned = Pose3::identity().moved(Vector3::new(0.0, 0.0, heading), Vector3::zeros());
            return Pose3 { rotation: turned.rotation, place_m: Vector3::new(part(0), part(1), 0.0) };
        }
        left -= length;
    }
    on_the_round(0.0)
}

struct Driven {
    closer: SpaceCloser,
    truth: Vec<Pose3>,
}

/// Drives `length_m` with an odometry that turns, climbs and stretches a little with each step.
fn drive(length_m: f64) -> Driven {
    let building = Building::new();
    let mut closer = SpaceCloser::new(SpaceCloserConfig::default());
    let mut truth: Vec<Pose3> = Vec::new();
    let mut odometry = Pose3::identity();
    for index in 0..(length_m / 0.4) as usize {
        let pose = on_the_round(0.4 * index as f64);
        if let Some(last) = truth.last() {
            let step = last.inverse().compose(&pose);
            let wrong = step.moved(Vector3::new(5.0e-5, 0.0, 4.0e-4), Vector3::new(0.002, 0.0, 0.001));
            odometry = odometry.compose(&wrong);
        }
        let sweep = building.sweep(&pose);
        let mut means = SmallPoints::within(60.0);
        sweep.iter().step_by(3).for_each(|point| means.push(point));
        let covariance = Matrix6::from_diagonal(&[1e-6, 1e-6, 1e-6, 1e-4, 1e-4, 1e-4].into()) * 0.4;
        let time_s = 0.4 * index as f64;
        let key = KeySweep { sweep: index, time_s, pose: odometry, covariance, means };
        closer.push(key, sweep.into_iter()).unwrap();
        truth.push(pose);
    }
    closer.finish().unwrap();
    Driven { closer, truth }
}

/// Farthest from the truth, with the first poses laid onto each other, metres.
fn worst_m(truth: &[Pose3], poses: &[Pose3]) -> f64 {
    let to_truth = truth[0].compose(&poses[0].inverse());
    let off = |(truth, pose): (&Pose3, &Pose3)| (truth.place_m - to_truth.compose(pose).place_m).norm();
    truth.iter().zip(poses).map(off).fold(0.0, f64::max)
}

#[test]
fn round_trip_is_closed_in_space() {
    let Driven { closer, truth } = drive(96.0);
    let odometry: Vec<Pose3> = closer.keys.iter().map(|key| key.pose).collect();
    let (drifted_m, closed_m) = (worst_m(&truth, &odometry), worst_m(&truth, &closer.poses));
    println!("{drifted_m:.3} m → {closed_m:.3} m, {:?}", closer.counters());
    assert!(closer.believed() >= 3, "{:?}", closer.counters());
    // The walls are those of the first round again: the places of the second round lie on those of the first.
    let again = closer.poses.iter().zip(&truth).enumerate().skip(180);
    for (index, (pose, there)) in again {
        let (first, first_truth) = (closer.poses[index - 180], truth[index - 180]);
        let (found, right) = (first.inverse().compose(pose), first_truth.inverse().compose(there));
        let off_m = (found.place_m - right.place_m).norm();
        assert!(off_m < 0.05, "{index}: {off_m}");
    }
    assert!(drifted_m > 0.8 && closed_m < 0.35 * drifted_m, "{drifted_m} {closed_m}");
}

#[test]
fn correction_passes_evenly_between_key_sweeps() {
    let mut closer = SpaceCloser::new(SpaceCloserConfig::default());
    let pose = |x: f64| Pose3 { place_m: Vector3::new(x, 0.0, 0.0), ..Pose3::identity() };
    for index in 0..2 {
        let key = KeySweep {
            sweep: 10 * index,
            time_s: 0.0,
            pose: pose(index as f64),
            covariance: Matrix6::identity(),
            means: SmallPoints::within(60.0),
        };
        closer.push(key, std::iter::empty()).unwrap();
    }
    closer.poses[1].place_m.y = 0.1;
    let places =
        [0, 5, 10, 12].map(|sweep| closer.corrected(sweep, &pose(0.1 * f64::from(sweep as u8))).place_m);
    for (place, y) in places.iter().zip([0.0, 0.05, 0.1, 0.1]) {
        assert!((place.y - y).abs() < 1.0e-9, "{places:?}");
    }
}
