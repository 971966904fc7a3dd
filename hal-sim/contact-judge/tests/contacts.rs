//! Contacts whose place, time and blame follow from geometry by hand.

mod common;

use common::{block, drive, no_people, person, setup, straight};
use floorguard_contact_judge::{
    BodyPart, ContactKind, ForceClass, Job, JobOutcome, Limb, LimbName, Other, Person, RobotMotion, Solid,
    Surface, Thing, ThingKind,
};

#[test]
fn wall_contact_was_visible_to_every_sensor() {
    let wall = block("wall", [5.0, 0.0], [0.1, 4.0], [0.0, 2.0]);
    let report = drive(setup(vec![wall]), 6.0, straight(0.8), no_people);
    let [contact] = report.contacts.as_slice() else { panic!("{report:?}") };
    // The front at 0.95 m comes to 4.95 m after 4.0 m.
    assert!((contact.at_s - 5.0).abs() < 0.011, "{contact:?}");
    assert_eq!((contact.kind, contact.place.side), (ContactKind::DroveInto, "front"));
    assert!((contact.robot_mps - 0.8).abs() < 1e-3 && contact.force.class == ForceClass::Harm);
    assert!(contact.avoidable && contact.seen_by.is_some());
    assert_eq!((report.counts.drove_into_things, report.missed_stops, report.passed), (1, 1, false));
    assert!(report.depth_m > 0.5);
}

/// The lidar sees the board from afar and loses it when it comes near; that it was seen is enough.
#[test]
fn a_table_board_is_met_at_its_height() {
    for z_m in [0.30, 0.45, 0.55] {
        let board = block("board", [6.0, 0.0], [0.6, 1.6], [z_m, z_m + 0.03]);
        let report = drive(setup(vec![board]), 6.8, straight(0.8), no_people);
        let [contact] = report.contacts.as_slice() else { panic!("{z_m}: {report:?}") };
        assert!((contact.place.point_m[2] - z_m - 0.015).abs() < 0.03, "{contact:?}");
        assert!(contact.avoidable, "{z_m}");
        assert_eq!(contact.seen_by.as_deref(), Some("lidar"), "{z_m}");
    }
    // Over the mast it is free.
    let board = block("board", [6.0, 0.0], [0.6, 1.6], [0.90, 0.93]);
    assert!(drive(setup(vec![board]), 6.8, straight(0.8), no_people).contacts.is_empty());
}

#[test]
fn low_box_contact_was_invisible() {
    let low = block("box", [5.0, 0.0], [0.4, 0.4], [0.0, 0.08]);
    let report = drive(setup(vec![low]), 6.0, straight(0.8), no_people);
    let [contact] = report.contacts.as_slice() else { panic!("{report:?}") };
    assert!(contact.avoidable && contact.seen_by.is_none(), "{contact:?}");
    assert_eq!((report.missed_stops, report.missed_unseen), (0, 1));
    assert!(report.passed, "what was invisible is separated: {:?}", report.failures);
    let flat = block("sill", [5.0, 0.0], [0.4, 0.4], [0.0, 0.015]);
    assert!(drive(setup(vec![flat]), 6.0, straight(0.8), no_people).contacts.is_empty());
}

/// The scanner's plane passes over the legs and meets the torso, 0.8 m beside what is touched: that is no sight of the legs. Thicker
/// legs, which reach into the plane, are seen.
#[test]
fn torso_of_who_lies_hides_no_leg() {
    let lies = |radius_m: f32| {
        let rod = |from: [f32; 2], to: [f32; 2], radius_m: f32| Solid::Capsule {
            from_m: [from[0], from[1], radius_m],
            to_m: [to[0], to[1], radius_m],
            radius_m,
        };
        let limbs = vec![
            Limb { name: LimbName::LowerLeg, solid: rod([2.0, -0.35], [2.55, -0.9], radius_m) },
            Limb { name: LimbName::Torso, solid: rod([2.6, -0.95], [2.75, -1.35], 0.13) },
        ];
        Person { id: 1, kind: "lying", velocity_mps: [0.0; 2], limbs }
    };
    let seen_by = |radius_m: f32| {
        let report = drive(setup(vec![]), 3.0, straight(0.5), |_| vec![lies(radius_m)]);
        let [contact] = report.contacts.as_slice() else { panic!("{report:?}") };
        assert!(contact.avoidable, "{contact:?}");
        assert!(matches!(contact.other, Other::Person { limb: LimbName::LowerLeg, .. }), "{contact:?}");
        contact.seen_by.clone()
    };
    assert_eq!(seen_by(0.065), None);
    assert_eq!(seen_by(0.10).as_deref(), Some("scanner"));
}

/// A bumper from 4 to 40 cm: at 0.4 m/s the robot has 0.06 + 0.1 m of braking, 0.04 m of delay and 0.05 m of grace.
#[test]
fn motion_with_touched_bumper_is_reported() {
    let bumper = BodyPart {
        name: "bumper".into(),
        outline_m: vec![[0.90, -0.4], [0.955, -0.4], [0.955, 0.4], [0.90, 0.4]],
        height_m: [0.04, 0.40],
    };
    let went_on = |z_m: [f32; 2], stops_s: f32| {
        let things = vec![block("box", [3.0, 0.0], [0.4, 0.4], z_m)];
        let plan = floorguard_contact_judge::Setup { bumpers: vec![bumper.clone()], ..setup(things) };
        let motion =
            |at_s: f32| RobotMotion { forward_mps: if at_s < stops_s { 0.4 } else { 0.0 }, turn_radps: 0.0 };
        drive(plan, 8.0, motion, no_people).counts.went_on
    };
    // The box is met after 1.85 m: at 4.625 s. 0.25 m later it is 5.25 s.
    assert_eq!(went_on([0.0, 0.08], 5.15), 0);
    assert_eq!(went_on([0.0, 0.08], 5.4), 1);
    assert_eq!(went_on([0.5, 0.6], 5.4), 0, "nothing feels that high");
    assert_eq!(went_on([0.0, 0.03], 5.4), 0, "it lies below the bumper");
}

/// A surface that rises by 0.1 a metre meets the body at 2 cm and the bumper at 4 cm, 0.2 m later.
#[test]
fn bumper_feels_what_rises_later() {
    let bumper = BodyPart {
        name: "bumper".into(),
        outline_m: vec![[0.90, -0.4], [0.955, -0.4], [0.955, 0.4], [0.90, 0.4]],
        height_m: [0.04, 0.40],
    };
    let went_on = |half_length_m: f32, stops_s: f32| {
        // Its upper face goes through the floor at x = 2.80 m, and its upper end is 0.2 half_length_m high.
        let slope_rad = 0.1_f32.atan();
        let (sin, cos) = slope_rad.sin_cos();
        let half_m = [half_length_m, 0.5, 0.05];
        let x_m = 2.80 + half_length_m * cos + 0.05 * sin;
        let centre_m = [x_m, 0.0, half_length_m * sin - 0.05 * cos];
        let ramp = floorguard_contact_judge::Thing {
            solid: Solid::Box { centre_m, half_m, yaw_rad: 0.0, slope_rad },
            ..block("ramp", [0.0; 2], [1.0; 2], [0.0, 1.0])
        };
        let plan = floorguard_contact_judge::Setup { bumpers: vec![bumper.clone()], ..setup(vec![ramp]) };
        let motion =
            |at_s: f32| RobotMotion { forward_mps: if at_s < stops_s { 0.4 } else { 0.0 }, turn_radps: 0.0 };
        drive(plan, 9.0, motion, no_people).counts
    };
    // The body touches at x = 3.00 m after 2.05 m, the bumper 0.2 m later: at 5.6 s, and 0.25 m are 0.63 s.
    assert_eq!(went_on(1.0, 6.0).went_on, 0);
    assert_eq!(went_on(1.0, 6.4).went_on, 1);
    let low = went_on(0.17, 8.0);
    assert_eq!((low.went_on, low.drove_into_things), (0, 1), "its end is 3.4 cm high");
}

/// The rear right corner at (-0.45, -0.40) is 0.602 m from the axle; beside it, 5 cm away, stands a box.
#[test]
fn rear_corner_swings_into_a_box() {
    let beside = block("box", [-0.35, -0.65], [0.3, 0.4], [0.0, 0.45]);
    let spin = |at_s: f32| RobotMotion { forward_mps: 0.0, turn_radps: if at_s < 1.0 { 0.0 } else { 0.5 } };
    let report = drive(setup(vec![beside]), 3.0, spin, no_people);
    let [contact] = report.contacts.as_slice() else { panic!("{report:?}") };
    // The corner moves on a circle of 0.602 m from y = -0.40 to y = -0.45 at x = -0.40: atan2(0.40, 0.45) = 41.6° to
    // asin(0.45/0.602) = 48.4°: 0.118 rad, 0.24 s.
    assert!((contact.at_s - 1.24).abs() < 0.03, "{contact:?}");
    assert_eq!(contact.place.side, "rear-right");
    assert!(contact.avoidable && contact.seen_by.is_none());
    assert!((contact.robot_mps - 0.301).abs() < 0.005);
}

#[test]
fn reverse_and_creeping_count_as_motion() {
    let behind = block("box", [-1.0, 0.0], [0.2, 0.2], [0.0, 0.3]);
    let report = drive(setup(vec![behind.clone()]), 4.0, straight(-0.25), no_people);
    assert_eq!(report.contacts.len(), 1, "{report:?}");
    assert_eq!(report.contacts[0].place.side, "rear");
    assert!((report.contacts[0].at_s - 1.8).abs() < 0.02 && (report.reversing_share - 1.0).abs() < 1e-6);
    let creeps = drive(setup(vec![behind]), 60.0, straight(-0.01), no_people);
    assert_eq!(creeps.counts.drove_into_things, 1, "{creeps:?}");
    assert!((creeps.contacts[0].at_s - 45.0).abs() < 0.2);
    assert_eq!(creeps.contacts[0].force.class, ForceClass::Touch);
}

/// Who walks into a robot that stands is counted apart; who is driven into is not excused by standing still.
#[test]
fn initiator_of_contact_is_distinguished() {
    let walks = |at_s: f32| vec![person([3.0 - at_s, 0.0], [-1.0, 0.0])];
    let stood = drive(setup(Vec::new()), 2.3, straight(0.0), walks);
    assert_eq!(stood.counts.walked_into_standing, 1, "{stood:?}");
    assert_eq!((stood.counts.while_moving(), stood.passed), (0, true));
    let stands = |_: f32| vec![person([3.0, 0.0], [0.0, 0.0])];
    let hit = drive(setup(Vec::new()), 4.0, straight(0.5), stands);
    let [contact] = hit.contacts.as_slice() else { panic!("{hit:?}") };
    // The body is 0.75 m high: the lower end of the torso at 0.7 m reaches furthest, 0.16 m before the middle at its widest.
    assert!(matches!(
        &contact.other,
        Other::Person { id: 1, kind: "adult", limb: LimbName::Torso | LimbName::LowerLeg }
    ));
    assert!((contact.at_s - 3.85).abs() < 0.15, "{contact:?}");
    assert_eq!((contact.kind, contact.avoidable), (ContactKind::DroveInto, true));
    assert!(contact.seen_by.is_some());
    let beside = |at_s: f32| vec![person([1.0 + 0.5 * at_s, 2.0 - at_s], [0.5, -1.0])];
    let flank = drive(setup(Vec::new()), 1.9, straight(0.8), beside);
    assert_eq!(flank.contacts.len(), 1, "{flank:?}");
    assert_eq!(flank.contacts[0].kind, ContactKind::WalkedIntoMoving);
}

/// Somebody leans against the standing robot, and it drives off into them.
#[test]
fn pushing_a_leaning_person_counts_as_contact() {
    let leans = |_: f32| vec![person([1.01, 0.0], [0.0, 0.0])];
    let starts = |at_s: f32| RobotMotion { forward_mps: if at_s < 2.0 { 0.0 } else { 0.2 }, turn_radps: 0.0 };
    let report = drive(setup(Vec::new()), 3.0, starts, leans);
    assert_eq!(report.contacts.len(), 1, "{report:?}");
    assert_eq!(report.contacts[0].kind, ContactKind::DroveInto);
    assert!((report.contacts[0].at_s - 2.0).abs() < 0.05);
    assert!(report.contacts[0].avoidable, "it need not have started");
    let away = |at_s: f32| RobotMotion { forward_mps: if at_s < 2.0 { 0.0 } else { -0.2 }, turn_radps: 0.0 };
    let report = drive(setup(Vec::new()), 3.0, away, leans);
    assert_eq!(report.counts.walked_into_standing, 1, "{report:?}");
    assert_eq!(report.counts.while_moving(), 0);
}

/// A box that falls from a shelf 0.3 m before a robot at 0.8 m/s: no brake of 0.8 m/s² helps; 1.2 m before it one does.
#[test]
fn what_appears_too_late_is_nobodys_fault() {
    let falls = |ahead_m: f32| {
        let at_m = [0.95 + 0.8 * 3.0 + ahead_m + 0.2, 0.0];
        let fallen = Thing { from_s: 3.0, ..block("box", at_m, [0.4, 0.4], [0.0, 0.4]) };
        drive(setup(vec![fallen]), 6.0, straight(0.8), no_people).contacts.remove(0)
    };
    // v·t + v²/2b = 0.12 + 0.4 m; sensing takes another 0.176 m.
    assert!(!falls(0.3).avoidable);
    let late = falls(0.6);
    assert!(late.avoidable && late.seen_by.is_none(), "{late:?}");
    assert!(falls(1.2).seen_by.is_some());
}

/// Somebody who stood in safety steps before the robot at the last moment.
#[test]
fn future_motion_of_people_is_unknown() {
    let steps_out = |when_s: f32| {
        move |at_s: f32| {
            let y_m = (1.3 - 2.0 * (at_s - when_s).max(0.0)).max(0.0);
            let speed_mps = if at_s >= when_s && y_m > 0.0 { -2.0 } else { 0.0 };
            vec![person([4.3, y_m], [0.0, speed_mps])]
        }
    };
    // The front comes to 4.2 m after 3.25 m: at 4.06 s. Out at 3.5 s, 0.65 s on the way.
    let late = drive(setup(Vec::new()), 4.5, straight(0.8), steps_out(3.45));
    assert_eq!(late.contacts.len(), 1, "{late:?}");
    assert!(!late.contacts[0].avoidable, "{:?}", late.contacts[0]);
    let early = drive(setup(Vec::new()), 4.5, straight(0.8), steps_out(1.0));
    assert!(early.contacts[0].avoidable && early.contacts[0].seen_by.is_some(), "{:?}", early.contacts[0]);
}

#[test]
fn only_perpendicular_glass_is_seen() {
    let pane = |yaw_rad: f32| {
        let mut pane = block("pane", [5.0, 0.0], [0.02, 3.0], [0.0, 2.0]);
        pane.surface = Surface::Glass;
        if let floorguard_contact_judge::Solid::Box { yaw_rad: yaw, .. } = &mut pane.solid {
            *yaw = yaw_rad;
        }
        drive(setup(vec![pane]), 6.5, straight(0.8), no_people).contacts.remove(0)
    };
    assert!(pane(0.0).seen_by.is_some());
    // Its foot of the perpendicular is far from the place that is hit.
    assert!(pane(1.2).seen_by.is_none());
}

#[test]
fn wheel_over_an_edge_is_reported() {
    let mut hole = block("dock", [6.0, 0.0], [2.0, 4.0], [-1.0, 0.0]);
    hole.kind = ThingKind::Drop;
    let report = drive(setup(vec![hole]), 6.0, straight(0.8), no_people);
    assert_eq!(report.counts.over_edges, 1, "{report:?}");
    // The front wheel at 0.8 m reaches 5.0 m.
    assert!((report.contacts[0].at_s - 5.25).abs() < 0.04, "{:?}", report.contacts[0]);
}

#[test]
fn braking_in_time_is_no_missed_stop() {
    // From 0.8 m/s with 0.8 m/s² from 3 s on: stands after 0.4 m at 3.75 m, 0.25 m before the wall.
    let brakes = |at_s: f32| {
        let forward_mps = (0.8 - 0.8 * (at_s - 3.0).max(0.0)).max(0.0);
        RobotMotion { forward_mps, turn_radps: 0.0 }
    };
    let wall = block("wall", [4.05, 0.0], [0.1, 4.0], [0.0, 2.0]);
    let report = drive(setup(vec![wall]), 6.0, brakes, no_people);
    assert_eq!((report.contacts.len(), report.missed_stops, report.missed_unseen), (0, 0, 0), "{report:?}");
    assert!(report.clearance_m.is_some_and(|gap_m| (0.24..0.30).contains(&gap_m)), "{report:?}");
    assert!(report.passed);
}

#[test]
fn a_robot_that_stands_about_does_not_pass() {
    let mut idle = setup(Vec::new());
    idle.job = Job::Route(vec![[5.0, 0.0]]);
    let report = drive(idle.clone(), 20.0, straight(0.0), no_people);
    assert_eq!(report.job, JobOutcome::Undone);
    assert!(!report.passed && report.failures.iter().any(|why| why.contains("never moved")), "{report:?}");
    let wall = block("wall", [1.2, 0.0], [0.1, 4.0], [0.0, 2.0]);
    let held = drive(
        floorguard_contact_judge::Setup { things: vec![wall], ..idle.clone() },
        20.0,
        straight(0.0),
        no_people,
    );
    assert_eq!(held.job, JobOutcome::Blocked("wall".into()));
    assert!(held.passed, "{held:?}");
    assert_eq!(drive(idle, 12.0, straight(0.5), no_people).job, JobOutcome::Done);
}

/// It stands 0.6 m before a place, which counts, and the next one lies behind it: what stands before the middle of the place is in its way
/// all the same, and what stands beyond the place is not.
#[test]
fn a_place_that_counts_may_be_closed() {
    let stops_at =
        |at_s: f32| RobotMotion { forward_mps: if at_s < 4.8 { 0.5 } else { 0.0 }, turn_radps: 0.0 };
    let job = |wall_m: f32| {
        let mut held = setup(vec![block("wall", [wall_m, 0.0], [0.1, 4.0], [0.0, 2.0])]);
        held.job = Job::Route(vec![[3.0, 0.0], [-5.0, 0.0]]);
        drive(held, 20.0, stops_at, no_people).job
    };
    assert_eq!(job(3.9), JobOutcome::Blocked("wall".into()));
    assert_eq!(job(4.5), JobOutcome::Undone);
}
