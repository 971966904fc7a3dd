//! The whole planner on small costmaps.

use std::vec;
use std::vec::Vec;

use floorguard_mapping::GridGeometry;
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::motion::{AlwaysPermitted, Footprint, Gear, Waypoint};
use proptest::prelude::*;

use super::*;
use crate::costmap::{CostmapView, Costs};

fn square() -> Footprint {
    let corners = [(0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2)];
    Footprint::new(&corners.map(|(x, y)| Point2::new(x, y))).unwrap()
}

fn geometry() -> GridGeometry {
    GridGeometry::new(80, 80, 0.05, Point2::new(-2.0, -2.0)).unwrap()
}

fn command(costs: &[u8], path: &[Waypoint], pose: Pose2, twist: Twist2) -> LocalCommand {
    let (mut a, mut b) = (vec![StepCell::default(); 6_400], vec![StepCell::default(); 6_400]);
    let scratch = DwaScratch { path: &mut a, goal: &mut b };
    let mut planner = Dwa::new(DwaConfig::PUBLISHED, &square(), scratch);
    planner.command(&LocalSituation {
        pose_in_map: pose,
        twist,
        costmap: CostmapView::new(geometry(), costs, 0).unwrap(),
        path,
        people: &[],
        guard: &AlwaysPermitted,
        speed_limit_mps: f32::INFINITY,
    })
}

fn line(to: Point2) -> Vec<Waypoint> {
    (0..=20)
        .map(|step| {
            let t = step as f32 / 20.0;
            let heading_rad = to.y_m.atan2(to.x_m);
            Waypoint { pose_in_map: Pose2::new(t * to.x_m, t * to.y_m, heading_rad), gear: Gear::Ahead }
        })
        .collect()
}

#[test]
fn drives_free_path_and_turns_towards_another() {
    let costs = vec![0; 6_400];
    let moving = Twist2 { linear_mps: 0.5, angular_radps: 0.0 };
    let ahead = command(&costs, &line(Point2::new(1.5, 0.0)), Pose2::default(), moving);
    assert_eq!(ahead.verdict, LocalVerdict::Driving);
    assert!(
        (ahead.twist.linear_mps - 0.55).abs() < 1e-6 && ahead.twist.angular_radps.abs() < 0.02,
        "{ahead:?}"
    );
    let left = command(&costs, &line(Point2::new(0.8, 1.2)), Pose2::default(), moving);
    assert!(left.twist.angular_radps > 0.1, "{left:?}");
}

#[test]
fn stands_where_everything_collides_and_at_the_goal() {
    let mut costs = vec![0; 6_400];
    for row in 0..80 {
        for column in 0..80 {
            if (38..42).contains(&row) && (44..48).contains(&column) {
                costs[row * 80 + column] = Costs::LETHAL;
            }
        }
    }
    let path = line(Point2::new(1.5, 0.0));
    let blocked = command(&costs, &path, Pose2::new(0.05, 0.0, 0.0), Twist2::ZERO);
    assert_eq!(blocked, LocalCommand::stand(LocalVerdict::Blocked));
    let arrived = command(&vec![0; 6_400], &path, Pose2::new(1.45, 0.02, 0.03), Twist2::ZERO);
    assert_eq!(arrived, LocalCommand::stand(LocalVerdict::Arrived));
    assert_eq!(command(&costs, &[], Pose2::default(), Twist2::ZERO).verdict, LocalVerdict::NoPath);
}

/// A trajectory of 0.55 m/s for 1.7 s has 38 poses: the published bound.
#[test]
fn a_trajectory_ends_where_the_published_steps_end() {
    let costs = vec![0; 6_400];
    let situation = LocalSituation {
        pose_in_map: Pose2::default(),
        twist: Twist2::ZERO,
        costmap: CostmapView::new(geometry(), &costs, 0).unwrap(),
        path: &[],
        people: &[],
        guard: &AlwaysPermitted,
        speed_limit_mps: f32::INFINITY,
    };
    let twist = Twist2 { linear_mps: 0.55, angular_radps: 0.5 };
    let (_, end) = simulate(&situation, (&DwaConfig::PUBLISHED, &square()), twist).unwrap();
    let (mut x, mut y, mut heading) = (0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..38 {
        let step_s = 1.7 / 38.0;
        x += 0.55 * step_s * heading.cos();
        y += 0.55 * step_s * heading.sin();
        heading += 0.5 * step_s;
    }
    assert!((f64::from(end.x_m) - x).abs() < 1e-4 && (f64::from(end.y_m) - y).abs() < 1e-4);
    assert!((f64::from(end.sin) - heading.sin()).abs() < 1e-4);
}

proptest! {
    /// Never a command outside of the window, whatever the costs and the speed.
    #[test]
    fn commands_stay_within_the_window(
        seed in any::<u64>(), linear_mps in 0.0_f32..0.55, angular_radps in -1.0_f32..1.0, heading_rad in -3.0_f32..3.0,
    ) {
        let mut random = floorguard_types::random::Pcg32::new(seed, 0);
        let costs: Vec<u8> =
            (0..6_400).map(|_| if random.bernoulli(0.01) { 254 } else { random.below(100) as u8 }).collect();
        let twist = Twist2 { linear_mps, angular_radps };
        let path = line(Point2::new(1.2, 0.7));
        let command = command(&costs, &path, Pose2::new(0.0, 0.0, heading_rad), twist);
        let [speeds, rates] = window(&DwaConfig::PUBLISHED, linear_mps, angular_radps, f32::INFINITY);
        if command.verdict == LocalVerdict::Driving {
            prop_assert!((speeds.min..=speeds.max).contains(&command.twist.linear_mps));
            prop_assert!((rates.min..=rates.max).contains(&command.twist.angular_radps));
        } else {
            prop_assert_eq!(command.twist, Twist2::ZERO);
        }
    }
}
