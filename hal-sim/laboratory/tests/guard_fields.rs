//! What the body would sweep, against what the robot saw before: overhangs that sink below the lidar's rays, low things, the
//! tail in a turn, and ways that must stay open. Judged by the true place of the body alone.

use floorguard_laboratory::world::{Observation, Observer, Plan, run_virtual};
use floorguard_sim::scenario::Scenario;
use floorguard_types::geometry::{Point2, Pose2};

/// The true outline of the example robot, metres: rear, front, half of its width.
const BODY: [f32; 3] = [-0.45, 0.95, 0.40];

fn play(scenario: &str, seconds: u64) -> Observation {
    let scenario = Scenario::from_toml(scenario).unwrap();
    let plan = Plan::of("fields", scenario, 1, seconds * 1_000_000).unwrap();
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    run_virtual(&plan, &mut observer).unwrap();
    observer.into_observation()
}

/// Something upright on the floor: middle and size, metres.
#[derive(Clone, Copy)]
struct Thing {
    middle: Point2,
    size: Point2,
}

const fn thing(x_m: f32, y_m: f32, length_m: f32, width_m: f32) -> Thing {
    Thing { middle: Point2::new(x_m, y_m), size: Point2::new(length_m, width_m) }
}

/// How deep any point of the body was in the thing at any moment that was noted, metres; negative: never.
fn depth_m(seen: &Observation, thing: Thing) -> f32 {
    let depth_at = |pose: &Pose2| {
        let mut deepest_m = f32::MIN;
        for ahead in 0..=70_u16 {
            for aside in 0..=40_u16 {
                let in_body =
                    Point2::new(BODY[0] + f32::from(ahead) * 0.02, f32::from(aside) * 0.02 - BODY[2]);
                let place = pose.transform(in_body);
                let gap_x = (place.x_m - thing.middle.x_m).abs() - 0.5 * thing.size.x_m;
                let gap_y = (place.y_m - thing.middle.y_m).abs() - 0.5 * thing.size.y_m;
                deepest_m = deepest_m.max(-gap_x.max(gap_y));
            }
        }
        deepest_m
    };
    seen.robot_way.iter().map(depth_at).fold(f32::MIN, f32::max)
}

fn way_in_all_m(seen: &Observation) -> f32 {
    seen.way_m(0.0, 1.0e3)
}

/// A board on thin legs, which stand beside the way: nothing but the lidar sees it, and not from near.
#[test]
fn fg_req_027_a_board_that_sinks_below_the_rays_is_not_driven_into() {
    for (height_m, speed_mps) in [(0.30, 1.0), (0.40, 0.6), (0.45, 0.3), (0.50, 1.0), (0.55, 0.6)] {
        let scenario = format!(
            "title = \"a board\"\n[route]\nspeed_mps = {speed_mps:.1}\nwaypoints_m = [[9.0, 0.0]]\n\
             [scene]\nfurniture = [{{ kind = \"table\", at_m = [5.0, 0.0], size_m = [0.7, 3.0], height_m = {height_m:.2} }}]\n"
        );
        let seen = play(&scenario, 22);
        let depth_m = depth_m(&seen, thing(5.0, 0.0, 0.7, 3.0));
        assert!(
            depth_m < 0.0,
            "a board at {height_m} m, {speed_mps} m/s: {depth_m} m deep, {:?}",
            seen.stops
        );
        let way_m = way_in_all_m(&seen);
        assert!((2.0..4.0).contains(&way_m), "a board at {height_m} m: the robot went {way_m} m");
    }
}

/// Boxes lower than the scanner's plane: the lidar's lowest rays meet them from afar.
#[test]
fn fg_req_027_low_boxes_that_the_lidar_met_from_afar_are_not_driven_into() {
    for (height_m, speed_mps) in [(0.12, 0.5), (0.12, 1.0), (0.10, 0.8), (0.14, 0.6)] {
        let scenario = format!(
            "title = \"a low box\"\n[route]\nspeed_mps = {speed_mps:.1}\nwaypoints_m = [[10.0, 0.0]]\n\
             [scene]\nfurniture = [{{ kind = \"box\", at_m = [6.0, 0.0], size_m = [0.4, 0.8], height_m = {height_m:.2} }}]\n"
        );
        let seen = play(&scenario, 20);
        let depth_m = depth_m(&seen, thing(6.0, 0.0, 0.4, 0.8));
        assert!(depth_m < 0.0, "a box of {height_m} m, {speed_mps} m/s: {depth_m} m deep, {:?}", seen.stops);
    }
}

/// A box stands 15 cm beside the way. Driving past is free; turning off beside it would swing the tail into it.
#[test]
fn fg_req_027_the_tail_does_not_swing_into_what_was_passed() {
    for (at_x_m, height_m) in [(2.3, 0.45), (2.0, 0.6), (2.6, 0.45)] {
        let scenario = format!(
            "title = \"a box beside the tail\"\n[route]\nspeed_mps = 0.4\nwaypoints_m = [[2.9, 0.0], [2.5, 4.0]]\n\
             [scene]\nfurniture = [{{ kind = \"box\", at_m = [{at_x_m:.1}, -0.75], size_m = [1.0, 0.4], height_m = {height_m:.2} }}]\n"
        );
        let seen = play(&scenario, 25);
        let depth_m = depth_m(&seen, thing(at_x_m, -0.75, 1.0, 0.4));
        assert!(depth_m < 0.0, "a box at {at_x_m}: {depth_m} m deep, {:?}", seen.stops);
        assert!(way_in_all_m(&seen) > 1.5, "{}", way_in_all_m(&seen));
    }
}

/// What must stay open: a doorway of one metre, and an aisle of 1.6 m between shelves.
#[test]
fn fg_req_027_doorways_and_aisles_stay_open() {
    let doorway = "title = \"a doorway\"\n[route]\nspeed_mps = 0.8\nwaypoints_m = [[8.0, 0.0]]\n[scene]\nwall = [\n\
        { from_m = [4.0, 0.55], to_m = [4.0, 6.0] }, { from_m = [4.0, -0.55], to_m = [4.0, -6.0] } ]\n";
    let aisle = "title = \"an aisle\"\n[route]\nspeed_mps = 0.8\nwaypoints_m = [[10.0, 0.0]]\n[scene]\nfurniture = [\n\
        { kind = \"shelf\", at_m = [6.0, 1.1], size_m = [8.0, 0.6], height_m = 1.8 },\n\
        { kind = \"shelf\", at_m = [6.0, -1.1], size_m = [8.0, 0.6], height_m = 1.8 } ]\n";
    for (name, scenario, seconds, way_m) in [("doorway", doorway, 30, 7.4), ("aisle", aisle, 25, 9.4)] {
        let seen = play(scenario, seconds);
        assert!(way_in_all_m(&seen) > way_m, "{name}: {} m, {:?}", way_in_all_m(&seen), seen.stops);
        assert_eq!(seen.verdict.stops, 0, "{name}: {:?}", seen.stops);
    }
}
