use super::*;

/// Floor, and upright edges at uneven places: features of a sweep that moved by `step` while it lasted.
fn features(step: SweepStep) -> Features {
    let back = step.pose().inverse();
    let mut features = Features::default();
    let mut add = |place: Vector3<f64>, row: u8, is_edge: bool| {
        // Seen at the end of the sweep: there is nothing to straighten.
        let point = back.transform(&place).map(|value| value as f32);
        let feature = Feature { point, row, time_share: 1.0 };
        let (few, all) = if is_edge {
            (&mut features.sharp, &mut features.less_sharp)
        } else {
            (&mut features.flat, &mut features.less_flat)
        };
        few.push(feature);
        all.push(feature);
    };
    for index in 0..24_u8 {
        let angle = 0.27 * f64::from(index);
        let range = 4.0 + f64::from(index % 5);
        let (sin, cos) = angle.sin_cos();
        for row in 8..12 {
            add(Vector3::new(range * cos, range * sin, 0.3 * f64::from(row) - 2.0), row, true);
        }
        for row in 0..6 {
            let range = 3.0 + 1.3 * f64::from(row);
            for part in 0..3 {
                let (sin, cos) = (angle + 0.08 * f64::from(part)).sin_cos();
                add(Vector3::new(range * cos, range * sin, -0.8), row, false);
            }
        }
    }
    features.less_sharp.sort_by_key(|feature| feature.row);
    features.less_flat.sort_by_key(|feature| feature.row);
    features
}

fn found(step: SweepStep, solver: StepSolver, rounds: usize) -> Pose3 {
    let config = LegoLoamConfig { solver, rounds, ..LegoLoamConfig::default() };
    let mut odometry = Odometry::default();
    odometry.push(&features(SweepStep::default()), &config);
    odometry.push(&features(step), &config).pose
}

fn off(pose: &Pose3, truth: &Pose3) -> [f64; 2] {
    let off = truth.inverse().compose(pose);
    [off.place_m.norm(), off.rotation_vector().norm()]
}

#[test]
fn both_solvers_find_the_same_motion() {
    let step =
        SweepStep { angles_rad: Vector3::new(0.004, -0.003, 0.02), step_m: Vector3::new(0.06, -0.02, 0.01) };
    let damped = found(step, StepSolver::Damped, 25);
    let [place_m, turn_rad] = off(&damped, &step.pose());
    assert!(place_m < 0.001 && turn_rad < 3.5e-4, "{place_m} {turn_rad}");
    // A twentieth of a step in each round: 25 of them leave a quarter of the way.
    let [short_m, _] = off(&found(step, StepSolver::Published, 25), &step.pose());
    assert!((0.2..0.5).contains(&(short_m / step.step_m.norm())), "{short_m}");
}

#[test]
fn motion_goes_on_where_nothing_is_seen() {
    let step = SweepStep { step_m: Vector3::new(0.05, 0.0, 0.0), ..SweepStep::default() };
    let config = LegoLoamConfig { solver: StepSolver::Damped, ..LegoLoamConfig::default() };
    let mut odometry = Odometry::default();
    odometry.push(&features(SweepStep::default()), &config);
    let there = odometry.push(&features(step), &config).pose;
    assert!((there.place_m - step.step_m).norm() < 0.002, "{there:?}");
    assert!(!odometry.push(&Features::default(), &config).is_blind);
    let blind = odometry.push(&Features::default(), &config);
    assert!(blind.is_blind && blind.pose.place_m.x > there.place_m.x + 0.05, "{:?}", blind.pose);
}
