use super::*;

/// A square of 40 m walked twice, as it is and as an odometry that turns too far tells it.
fn drive() -> (Vec<Pose3>, SpaceGraph) {
    let mut truth = vec![Pose3::identity()];
    let mut poses = vec![Pose3::identity()];
    let mut edges = Vec::new();
    let information = Matrix6::from_diagonal(&Vector6::new(1e5, 1e5, 1e5, 1e4, 1e4, 1e4));
    for step in 1..80_usize {
        let turn = if step % 10 == 0 { std::f64::consts::FRAC_PI_2 } else { 0.0 };
        let motion = |tilt: f64, more: f64| {
            Pose3::identity().moved(Vector3::new(tilt, 0.0, turn + more), Vector3::new(1.0, 0.0, 0.0))
        };
        truth.push(truth[step - 1].compose(&motion(0.0, 0.0)));
        let measured = motion(1.0e-3, 4.0e-3);
        poses.push(poses[step - 1].compose(&measured));
        edges.push(SpaceEdge { from: step - 1, to: step, measured, information, kind: EdgeKind::Sequence });
    }
    (truth, SpaceGraph { poses, edges })
}

fn worst_m(truth: &[Pose3], graph: &SpaceGraph) -> f64 {
    truth.iter().zip(&graph.poses).map(|(a, b)| (a.place_m - b.place_m).norm()).fold(0.0, f64::max)
}

fn seen_again(truth: &[Pose3], [from, to]: [usize; 2]) -> SpaceEdge {
    let measured = truth[from].inverse().compose(&truth[to]);
    SpaceEdge { from, to, measured, information: Matrix6::from_diagonal_element(1.0e6), kind: EdgeKind::Loop }
}

#[test]
fn right_loops_bring_poses_back() {
    let (truth, mut graph) = drive();
    let drifted = worst_m(&truth, &graph);
    assert!(drifted > 1.0, "{drifted}");
    let right = [[0, 40], [5, 45], [12, 52], [20, 60], [33, 73], [38, 78]];
    graph.edges.extend(right.map(|pair| seen_again(&truth, pair)));
    let mut wrong = seen_again(&truth, [3, 40]);
    wrong.measured.place_m.x += 4.0;
    graph.edges.push(wrong);
    let weights = graph.optimise_robustly(&RobustConfig::default()).unwrap();
    assert_eq!(weights[79..], [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0]);
    let closed = worst_m(&truth, &graph);
    assert!(closed < 0.15 * drifted, "{closed} of {drifted}");
}

#[test]
fn gradient_vanishes_where_the_optimum_is() {
    let (truth, mut graph) = drive();
    graph.edges.extend([[0, 40], [20, 60]].map(|pair| seen_again(&truth, pair)));
    let found = graph.optimise(&OptimiseConfig::default()).unwrap();
    assert!(found.has_converged);
    // Any other poses nearby are worse.
    for (pose, axis) in [(7, 0), (40, 1), (60, 2), (79, 2)] {
        for by in [-1.0e-4, 1.0e-4] {
            let mut other = graph.clone();
            let mut step = Vector3::zeros();
            step[axis] = by;
            other.poses[pose] = other.poses[pose].moved(step, step);
            assert!(other.chi2(&[1.0; 81]) > found.chi2, "{pose} {axis}");
        }
    }
}
