//! The controller drives a model robot through small worlds.

use std::vec;
use std::vec::Vec;

use floorguard_mapping::GridGeometry;
use floorguard_types::geometry::Pose2;
use floorguard_types::motion::{
    AlwaysPermitted, DriveGeometry, DriveKinematics, Gear, MovingPerson, Permission, PlannedMotion, Waypoint,
};

use super::*;
use crate::costmap::floor_tests::costs_of;
use crate::costmap::{CostmapView, InflationConfig, footprint_cost};
use crate::local::{Arrival, MppiWeights};

const CONFIG: MppiConfig = MppiConfig {
    drive: DriveKinematics {
        geometry: DriveGeometry::Differential,
        speed_max_mps: 0.8,
        reverse_max_mps: 0.2,
        turn_max_radps: 1.0,
        acceleration_mps2: 0.6,
        braking_mps2: 1.0,
        turn_acceleration_radps2: 2.0,
    },
    step_s: 0.1,
    period_s: 0.1,
    speed_noise_mps: 0.25,
    turn_noise_radps: 0.5,
    temperature_s: 0.15,
    clear_cost: 1,
    people_acceleration_mps2: 0.4,
    person_radius_m: 0.25,
    arrival: Arrival { within_m: 0.2, within_rad: 4.0, turn_min_radps: 0.1, turn_max_radps: 0.8 },
    weights: MppiWeights::DEFAULT,
};

fn outline() -> Footprint {
    let corners = [(0.35, 0.3), (-0.35, 0.3), (-0.35, -0.3), (0.35, -0.3)];
    Footprint::new(&corners.map(|(x, y)| Point2::new(x, y))).unwrap()
}

fn geometry() -> GridGeometry {
    GridGeometry::new(200, 120, 0.05, Point2::new(-1.0, -3.0)).unwrap()
}

/// Costs of a floor on which some places are occupied.
fn costs(is_occupied: impl Fn(Point2) -> bool) -> Vec<u8> {
    let shape = InflationConfig { inscribed_radius_m: 0.3, inflation_radius_m: 0.7, decay_per_m: 5.0 };
    costs_of(&geometry(), &shape, is_occupied)
}

fn straight_path(to_m: f32) -> Vec<Waypoint> {
    (0..=60)
        .map(|step| {
            let x_m = to_m * step as f32 / 60.0;
            Waypoint { pose_in_map: Pose2::new(x_m, 0.0, 0.0), gear: Gear::Ahead }
        })
        .collect()
}

/// Drives until arrival; gives the poses and the digest of all commands.
fn drive<P: PermittedMotion>(
    costs: &[u8],
    guard: &P,
    person_at: impl Fn(f32) -> Option<MovingPerson>,
    seconds: f32,
) -> (Vec<Pose2>, u64) {
    let mut planner = Mppi::new(CONFIG, outline(), vec![MppiSample::default(); 400], 7);
    let path = straight_path(6.0);
    let (mut pose, mut twist, mut digest) = (Pose2::default(), Twist2::ZERO, 0_u64);
    let mut poses = vec![pose];
    for step in 0..(seconds / 0.1) as usize {
        let people: Vec<MovingPerson> = person_at(step as f32 * 0.1).into_iter().collect();
        let command = planner.command(&LocalSituation {
            pose_in_map: pose,
            twist,
            costmap: CostmapView::new(geometry(), costs, 0).unwrap(),
            path: &path,
            people: &people,
            guard,
            speed_limit_mps: f32::INFINITY,
        });
        if command.verdict == LocalVerdict::Arrived {
            break;
        }
        digest = digest.wrapping_mul(0x100_0000_01b3)
            ^ u64::from(command.twist.linear_mps.to_bits())
            ^ (u64::from(command.twist.angular_radps.to_bits()) << 32);
        twist = CONFIG.drive.reachable(twist, command.twist, 0.1);
        pose = pose.after(twist, 0.1);
        poses.push(pose);
    }
    (poses, digest)
}

fn is_at_goal(pose: &Pose2) -> bool {
    Point2::new(pose.x_m, pose.y_m).distance(Point2::new(6.0, 0.0)) <= 0.2
}

#[test]
fn drives_round_obstacle_with_true_outline() {
    let costs = costs(|place| place.distance(Point2::new(3.0, 0.1)) < 0.3);
    let (poses, digest) = drive(&costs, &AlwaysPermitted, |_| None, 20.0);
    assert!(is_at_goal(poses.last().unwrap()), "{:?}", poses.last());
    assert!(poses.len() < 130, "{} steps", poses.len());
    for pose in &poses {
        let view = CostmapView::new(geometry(), &costs, 0).unwrap();
        assert!(footprint_cost(view, &outline(), *pose).is_ok(), "{pose:?}");
    }
    let (_, again) = drive(&costs, &AlwaysPermitted, |_| None, 20.0);
    assert_eq!(digest, again, "the same seed gives the same commands");
}

/// Somebody crosses the path; the robot keeps its distance and still arrives.
#[test]
fn lets_a_crossing_person_pass() {
    let costs = costs(|_| false);
    let person = |time_s: f32| {
        Some(MovingPerson {
            position_in_map: Point2::new(3.0, -2.8 + 0.8 * time_s),
            velocity_in_map_mps: Point2::new(0.0, 0.8),
            position_deviation_m: 0.1,
            velocity_deviation_mps: 0.1,
        })
    };
    let (poses, _) = drive(&costs, &AlwaysPermitted, person, 25.0);
    assert!(is_at_goal(poses.last().unwrap()));
    for (step, pose) in poses.iter().enumerate() {
        let middle = person(step as f32 * 0.1).unwrap().position_in_map;
        let gap_m = outline().clearance_m(*pose, middle) - 0.25;
        assert!(gap_m > 0.15, "{gap_m} m after {step} steps");
    }
}

/// A corner of a long robot that turns on the spot sweeps over somebody who stands beside its front.
#[test]
fn turning_on_the_spot_touches_people() {
    let costs = costs(|_| false);
    let corners = [(0.95, 0.4), (-0.45, 0.4), (-0.45, -0.4), (0.95, -0.4)];
    let footprint = Footprint::new(&corners.map(|(x, y)| Point2::new(x, y))).unwrap();
    let position_in_map = Point2::new(0.75, 0.85);
    let person = MovingPerson { position_in_map, position_deviation_m: 0.05, ..MovingPerson::default() };
    let stage = Stage {
        config: &CONFIG,
        footprint: &footprint,
        costmap: CostmapView::new(geometry(), &costs, 0).unwrap(),
        guard: &AlwaysPermitted,
        path: PathLeft::new(&straight_path(6.0), Point2::default()).unwrap(),
        people: Forecast::new(&[person], Point2::default(), (0.1, 0.0)),
        pose: Pose2::default(),
        twist: Twist2::ZERO,
        speed_limit_mps: f32::INFINITY,
    };
    let is_free = |angular_radps: f32| {
        let turn = Twist2 { linear_mps: 0.0, angular_radps };
        stage.play(&[turn; MPPI_STEPS]).is_free
    };
    assert!(is_free(0.0) && is_free(-0.6), "standing and turning away touch nobody");
    assert!(!is_free(0.6));
}

/// A guard that permits nothing on the left, and only this speed elsewhere, m/s.
struct Strict(f32);

impl PermittedMotion for Strict {
    fn permission(&self, motion: PlannedMotion) -> Permission {
        if motion.pose_in_map.y_m > 0.3 {
            return Permission::stop(2.0);
        }
        Permission { share: (self.0 / motion.twist.linear_mps.abs().max(1.0e-3)).min(1.0), held_s: 0.0 }
    }
}

#[test]
fn goes_where_the_guard_lets_it() {
    let costs = costs(|place| place.distance(Point2::new(3.0, -0.1)) < 0.2);
    let (free, _) = drive(&costs, &AlwaysPermitted, |_| None, 30.0);
    assert!(free.iter().any(|pose| pose.y_m > 0.35), "left is shorter");
    let (guarded, _) = drive(&costs, &Strict(f32::INFINITY), |_| None, 40.0);
    assert!(is_at_goal(guarded.last().unwrap()), "{:?}", guarded.last());
    assert!(guarded.iter().all(|pose| pose.y_m < 0.35), "it goes round on the right");
}

#[test]
fn stands_when_blocked_or_without_path() {
    let walled = costs(|place| place.distance(Point2::new(0.0, 0.0)) < 0.5);
    let mut planner = Mppi::new(CONFIG, outline(), vec![MppiSample::default(); 100], 7);
    let path = straight_path(6.0);
    let mut situation = LocalSituation {
        pose_in_map: Pose2::default(),
        twist: Twist2::ZERO,
        costmap: CostmapView::new(geometry(), &walled, 0).unwrap(),
        path: &path,
        people: &[],
        guard: &AlwaysPermitted,
        speed_limit_mps: f32::INFINITY,
    };
    assert_eq!(planner.command(&situation), LocalCommand::stand(LocalVerdict::Blocked));
    situation.path = &[];
    assert_eq!(planner.command(&situation), LocalCommand::stand(LocalVerdict::NoPath));
    situation.path = &path;
    situation.pose_in_map = Pose2::new(f32::NAN, 0.0, 0.0);
    assert_eq!(planner.command(&situation).twist, Twist2::ZERO);
}
