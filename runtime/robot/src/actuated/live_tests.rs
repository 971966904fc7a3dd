//! A person whom the sweep has left is in the list of people, beside those of the lidar.

use floorguard_configuration::{EXAMPLE, parse};
use floorguard_mapping::sliding_window::PassedPerson;
use floorguard_perception::people::{PeopleSensor, SweepContext, TrackStatus};
use floorguard_runtime::tasks::JudgeMotion as _;
use floorguard_types::geometry::{Point2, Pose2, Twist2};
use floorguard_types::sensing::Sweep;
use floorguard_types::time::Stamp;

use super::live::view;
use crate::assembly::{PeopleInbox, Stages, new_perception};

#[test]
fn passed_person_is_in_the_list() {
    let robot = parse("robot.toml", EXAMPLE).unwrap().robot;
    let mut perception = new_perception(&robot, Stages::All);
    let inbox = PeopleInbox::default();
    perception.motion.listen_to(inbox.clone());
    // Sweeps of a second back and forth: a person at 2 m walks 0.4 m to the left in each.
    let mut seen = Vec::new();
    for sweep in 1..=60_u64 {
        let stamp = Stamp::from_micros(sweep * 100_000);
        if sweep % 10 == 0 {
            let walked_m = 0.04 * sweep as f32;
            let passed = PassedPerson {
                stamp: Stamp::from_micros(sweep * 100_000 - 50_000),
                position_in_odometry: Point2::new(2.0, walked_m - 1.0),
                sigma_m: 0.15,
                returns: 40,
            };
            inbox.put(view(&passed, Pose2::default()));
        }
        let empty = Sweep { end_stamp: stamp, ..Sweep::EMPTY };
        let context = SweepContext {
            sensor_in_base: perception.sensor_in_base,
            twist: Twist2::ZERO,
            base_in_odom: Pose2::default(),
        };
        let people = perception.motion.people(&mut perception.people, &empty, &context);
        seen = people.tracks.to_vec();
    }
    let [person] = &seen[..] else { panic!("{} people", seen.len()) };
    assert!(person.sensors(Stamp::from_micros(6_000_000)).contains(PeopleSensor::DepthCamera), "{person:?}");
    assert!(person.state.position.distance(Point2::new(2.0, 1.4)) < 0.25, "{person:?}");
    // A track that has been seen once does not outlive a second without a look: each sweep names the person anew, without a velocity.
    assert_eq!((person.status, person.sightings), (TrackStatus::Tentative, 1), "{person:?}");
}
