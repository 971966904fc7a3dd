//! The tour that the robot itself drives: its navigator plans, its guard watches, and what its lidar sees along the path that it
//! really took is rendered as in the other experiments.

use floorguard_laboratory::world::{Observer, Plan, run_virtual};
use floorguard_sim::scenario::Scenario;
use floorguard_types::geometry::{Point2, Pose2};

use super::building::Building;
use super::render::Drive;
use super::revisit::{Revisited, Round};
use super::walkers::Walker;

/// The lidar is this far ahead of the robot's origin, metres.
const LIDAR_M: f32 = 0.5;
/// From place to place of an observed path, seconds.
const STEP_S: f32 = 0.25;
/// A leg takes no longer, microseconds.
const LEG_US: u64 = 90_000_000;
/// The robot turns where this much is free around it, metres.
const CLEAR_M: f32 = 1.25;
/// Where the robot starts, and the end of its survey, on the middle line of the hall, metres.
const SURVEY_X_M: [f32; 2] = [2.0, 9.5];
/// Who stands through the survey.
const PERSON: [f32; 2] = [5.5, 2.6];

/// What came of it.
#[derive(Clone, Debug, Default)]
pub struct Driven {
    /// After the survey, and after each tour.
    pub rounds: Vec<Round>,
    /// Legs of all tours, and of them those whose end the robot reached.
    pub legs: usize,
    /// See `legs`.
    pub reached: usize,
    /// Contacts of the moving robot that its sensors could have avoided.
    pub contacts: usize,
    /// Driven on all legs, metres.
    pub driven_m: f32,
}

/// Survey, removal, and tours that the robot drives, until nobody is seen any more.
///
/// # Errors
/// The hall cannot be simulated.
pub fn driven_revisit(seed: u64) -> anyhow::Result<Driven> {
    let hall = Building::hall();
    let mut driven = Driven::default();
    let [start, end] = SURVEY_X_M.map(|x_m| Pose2::new(x_m, 0.0, 0.0));
    let mut survey = Drive::begin(lidar_of(start), 0.0);
    let mut base = leg(&hall, true, (start, end), &mut survey, &mut driven)?;
    // The survey is no tour.
    (driven.legs, driven.reached) = (0, 0);
    let leaves_s = survey.end_s() + 1.0;
    let [x, y] = PERSON;
    let person = Walker { course: vec![[-1.0, x, y], [leaves_s, x, y]], height_m: 1.75 };
    let mut revisited = Revisited::of(hall.clone(), vec![person], survey, seed);
    let mut failed = None;
    let is_reachable = |stop: Pose2| clearance_m(&hall, base_of(stop)) >= CLEAR_M;
    let (rounds, _) = revisited.run_by(is_reachable, &mut |tour, start_s| {
        let mut drive = Drive::begin(lidar_of(base), start_s);
        for stop in tour {
            match leg(&hall, false, (base, base_of(*stop)), &mut drive, &mut driven) {
                Ok(end) => base = end,
                Err(error) => failed = Some(error),
            }
        }
        drive
    });
    driven.rounds = rounds;
    failed.map_or(Ok(driven), Err)
}

/// One drive of the robot; the path goes into the drive of its lidar. Gives where it ended.
fn leg(
    hall: &Building,
    has_person: bool,
    (from, to): (Pose2, Pose2),
    drive: &mut Drive,
    driven: &mut Driven,
) -> anyhow::Result<Pose2> {
    let scenario = Scenario::from_toml(&scenario(hall, has_person, from))?;
    let plan = Plan::of("hall", scenario, 1, LEG_US)?.navigating(to)?;
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    run_virtual(&plan, &mut observer)?;
    let seen = observer.into_observation();
    driven.legs += 1;
    driven.reached += usize::from(seen.verdict.navigation.as_ref().is_some_and(|drive| drive.reached));
    driven.contacts += seen.verdict.avoidable_contacts as usize;
    driven.driven_m += seen.verdict.distance_m as f32;
    for pose in &seen.robot_path {
        drive.pass(lidar_of(*pose), STEP_S);
    }
    drive.wait(0.6);
    Ok(seen.robot_path.last().copied().unwrap_or(from))
}

fn lidar_of(base: Pose2) -> [f32; 3] {
    let lidar = base.compose(Pose2::new(LIDAR_M, 0.0, 0.0));
    [lidar.x_m, lidar.y_m, lidar.heading_rad]
}

fn base_of(lidar: Pose2) -> Pose2 {
    lidar.compose(Pose2::new(-LIDAR_M, 0.0, 0.0))
}

/// Distance from the nearest wall or piece of furniture, metres.
fn clearance_m(hall: &Building, base: Pose2) -> f32 {
    let place = Point2::new(base.x_m, base.y_m);
    let gap = |low: f32, high: f32, at: f32| (low - at).max(at - high).max(0.0);
    let of = |cuboid: &super::building::Cuboid| {
        let [x, y] =
            [0, 1].map(|axis| gap(cuboid.low[axis], cuboid.high[axis], [place.x_m, place.y_m][axis]));
        x.hypot(y)
    };
    hall.cuboids.iter().map(of).fold(f32::INFINITY, f32::min)
}

/// The hall as the simulator reads it.
fn scenario(hall: &Building, has_person: bool, start: Pose2) -> String {
    let piece = |cuboid: &super::building::Cuboid| {
        let middle = [0, 1].map(|axis| 0.5 * (cuboid.low[axis] + cuboid.high[axis]));
        let size = [0, 1].map(|axis| cuboid.high[axis] - cuboid.low[axis]);
        let height_m = cuboid.high[2];
        format!(
            "{{ kind = \"box\", at_m = {middle:?}, yaw_deg = 0.0, size_m = {size:?}, height_m = {height_m} }}"
        )
    };
    let furniture: Vec<String> = hall.cuboids.iter().map(piece).collect();
    let person = format!(
        "[[person]]\nkind = \"adult\"\nat_m = {PERSON:?}\nspeed_mps = 0.0\ngoals_m = [{PERSON:?}, {PERSON:?}]\n"
    );
    format!(
        "title = \"a hall\"\nstart = {{ at_m = [{:?}, {:?}], yaw_deg = {:?} }}\n[route]\nspeed_mps = 0.8\nwaypoints_m = [[{:?}, {:?}]]\n\
         [scene]\nfurniture = [{}]\n{}",
        start.x_m,
        start.y_m,
        start.heading_rad.to_degrees(),
        start.x_m,
        start.y_m,
        furniture.join(",\n"),
        if has_person { person.as_str() } else { "" }
    )
}
