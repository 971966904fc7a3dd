//! Perception on the MCU: odometry, people, what moves, the floor; and the route, which runs beside it.

use core::hint::black_box;

use floorguard_localisation::odometry::{Odometry, PoseHistory, Tricycle, WheelOdometry};
use floorguard_navigation::route::RouteFollower;
use floorguard_perception::floor::{FloorEstimate, FloorModel, ObjectFinder, ObjectMemory, PixelClass};
use floorguard_perception::legs::{LegDetector, LegTracker};
use floorguard_perception::motion::{MotionDetector, find_moving_people};
use floorguard_perception::people::{PeoplePipeline, SweepContext};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{DepthImage, ImageSize, ImuSample, Scan, Sweep, WheelSample};
use floorguard_types::time::Stamp;

/// State of perception.
pub struct Perception {
    people: PeoplePipeline,
    context: SweepContext,
    sweep: Sweep,
    motion: MotionDetector,
    scan: Scan,
    legs: LegDetector,
    leg_tracker: LegTracker,
    floor: FloorModel,
    finder: ObjectFinder,
    memory: ObjectMemory,
    depth: &'static [u16],
    classes: &'static mut [PixelClass],
    pose: Pose2,
    odometry: Odometry,
    wheels: WheelOdometry,
    tricycle: Tricycle,
    history: PoseHistory,
    wheel_sample: WheelSample,
    imu_sample: ImuSample,
    route: RouteFollower,
}

/// Reaches every root.
#[inline(always)]
pub fn all(state: &mut Perception, now: Stamp) {
    root_people(&mut state.people, &state.sweep, &state.context);
    root_motion(&mut state.motion, &mut state.people, &state.sweep, &state.context);
    root_legs(&mut state.legs, &mut state.leg_tracker, &state.scan);
    if let Ok(image) = DepthImage::new(now, black_box(ImageSize { width: 640, height: 480 }), state.depth) {
        let estimate = root_floor_plane(state, &image, now);
        root_floor_objects(state, &image, &estimate);
    }
    root_odometry(state, now);
    root_route(&mut state.route, state.pose);
}

#[inline(never)]
fn root_route(follower: &mut RouteFollower, pose_in_odometry: Pose2) {
    black_box((follower.wanted(pose_in_odometry), follower.finished()));
}

#[inline(never)]
fn root_motion(
    motion: &mut MotionDetector,
    people: &mut PeoplePipeline,
    sweep: &Sweep,
    context: &SweepContext,
) {
    black_box(find_moving_people(people, motion, sweep, context).tracks.len());
}

#[inline(never)]
fn root_legs(detector: &mut LegDetector, tracker: &mut LegTracker, scan: &Scan) {
    let wall_m = black_box(3.0);
    let found = detector.process(scan, Some(|at: Point2| at.x_m > wall_m));
    tracker.update(scan.stamp, found.legs);
    tracker.people(|person| {
        black_box(person.sigma_m());
    });
}

#[inline(never)]
fn root_floor_plane(state: &mut Perception, image: &DepthImage, now: Stamp) -> FloorEstimate {
    state.floor.update(image, now)
}

#[inline(never)]
fn root_floor_objects(state: &mut Perception, image: &DepthImage, estimate: &FloorEstimate) {
    let parameters = *state.floor.parameters();
    if let Ok(found) = state.finder.find(image, (&parameters, estimate), state.classes) {
        black_box(state.memory.update(&found, state.pose));
    }
}

#[inline(never)]
fn root_people(people: &mut PeoplePipeline, sweep: &Sweep, context: &SweepContext) {
    black_box(people.process(sweep, context).tracks.len());
}

#[inline(never)]
fn root_odometry(state: &mut Perception, now: Stamp) {
    if let Some(motion) = state.wheels.update(&state.wheel_sample) {
        state.odometry.on_wheels(&motion);
    }
    state.odometry.on_imu(&state.imu_sample);
    state.history.record(now, state.odometry.pose());
    let _ = black_box(state.history.at(now).is_ok());
    let twist = state.odometry.twist();
    black_box(state.tricycle.steering_rad(twist, 0.0));
}
