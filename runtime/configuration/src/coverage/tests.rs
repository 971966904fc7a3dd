//! The example robots, and robots whose file has a mistake that only the sensors' view shows.

use super::{Gap, Refusal, Region, Unseen};
use crate::{EXAMPLE, HostedConfiguration, parse};

const SCANNER: &str = "z_m = 0.15, roll_deg = 0.0, pitch_deg = 0.0, yaw_deg = 0.0 }";
const LIDAR: &str = "z_m = 0.80, roll_deg = 0.0, pitch_deg = 0.0, yaw_deg = 0.0 }";

fn read(text: &str) -> HostedConfiguration {
    parse("robot.toml", text).unwrap_or_else(|refused| panic!("{refused}"))
}

/// Why the example with changes is refused.
fn refusals(changes: &[(&str, &str)]) -> Vec<Refusal> {
    let text = changes.iter().fold(EXAMPLE.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    });
    read(&text).coverage().1
}

/// Regions of gaps that are not accepted.
fn open_regions(changes: &[(&str, &str)]) -> Vec<Region> {
    let regions = refusals(changes).into_iter().filter_map(|refusal| match refusal {
        Refusal::NotAccepted { gap, .. } => Some(gap.region),
        Refusal::Superfluous(_) => None,
    });
    regions.collect()
}

#[test]
fn fg_req_062_example_names_exactly_its_gaps() {
    let configuration = read(EXAMPLE);
    let (coverage, refused) = configuration.coverage();
    assert_eq!(refused, []);
    assert!(coverage.gaps.len() > 8 && coverage.places.len() > 500, "{}", coverage.gaps.len());
    for gap in &coverage.gaps {
        let name = gap.gap.to_string();
        let others = configuration.accepted_gaps.iter().filter(|accepted| !accepted.is_same(&gap.gap));
        let found = coverage.refusals(&others.copied().collect::<Vec<_>>());
        assert!(
            matches!(&found[..], [Refusal::NotAccepted { gap: open, .. }] if *open == gap.gap),
            "{name}: {found:?}"
        );
        assert!(found[0].to_string().contains(&format!("no sensor sees \"{name}\"")), "{found:?}");
        assert!(gap.reached_mps() > 0.0 && !gap.motions.is_empty(), "{gap:?}");
    }
}

/// What the example touches is what the simulated robot was seen to touch: low boxes ahead at speed, boxes beside the rear in turns.
#[test]
fn low_boxes_and_swinging_rear_are_named() {
    let (coverage, _) = read(EXAMPLE).coverage();
    let below_m = |region| {
        coverage.gaps.iter().find_map(|found| match found.gap {
            Gap { region: of, unseen: Unseen::Below(height_m) } if of == region => Some(height_m),
            _ => None,
        })
    };
    assert!(below_m(Region::Front).is_some_and(|height_m| height_m > 0.12 && height_m < 0.30));
    assert!(below_m(Region::RearLeft).is_some_and(|height_m| height_m > 0.45));
    assert_eq!(below_m(Region::RearLeft), below_m(Region::RearRight));
}

#[test]
fn fg_req_062_superfluous_and_outdated_names_are_refused() {
    let extra = ("  \"rear below 0.45 m\"", "  \"rear below 0.12 m\", \"front stepping in below 0.30 m\"");
    let found: Vec<String> = refusals(&[extra]).iter().map(ToString::to_string).collect();
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(
        found[0].contains("\"rear below 0.45 m\", and `accept_unseen` of [guard] has \"rear below 0.12 m\""),
        "{found:?}"
    );
    assert!(
        found[1].contains("has \"front stepping in below 0.30 m\", and the sensors see that"),
        "{found:?}"
    );
    // Without reversing nothing behind is a gap, and its names are superfluous.
    let without = refusals(&[("reverse_mps = 0.25", "reverse_mps = 0.0")]);
    let is_rear =
        |refusal: &Refusal| matches!(refusal, Refusal::Superfluous(gap) if gap.region == Region::Rear);
    assert!(without.len() == 4 && without.iter().all(is_rear), "{without:?}");
}

#[test]
fn fg_req_062_narrow_sector_and_turned_sensors_are_refused() {
    let narrow = format!("{SCANNER}\nsector_first_deg = -10.0\nsector_last_deg = 10.0");
    assert!(open_regions(&[(SCANNER, &narrow)]).contains(&Region::Front));
    let turned = SCANNER.replace("yaw_deg = 0.0", "yaw_deg = 180.0");
    assert!(open_regions(&[(SCANNER, &turned)]).contains(&Region::Front));
    let skewed = SCANNER.replace("yaw_deg = 0.0", "yaw_deg = 90.0");
    assert!(open_regions(&[(SCANNER, &skewed)]).contains(&Region::Front));
    let raised = LIDAR.replace("pitch_deg = 0.0", "pitch_deg = -20.0");
    assert!(open_regions(&[(LIDAR, &raised)]).contains(&Region::Front));
    let high = LIDAR.replace("z_m = 0.80", "z_m = 1.60");
    assert!(open_regions(&[(LIDAR, &high)]).contains(&Region::Front));
}

#[test]
fn fg_req_062_faster_robot_needs_more_sight() {
    let slow =
        refusals(&[("\nspeed_mps = 1.0", "\nspeed_mps = 0.3"), ("speed_mps = 0.8", "speed_mps = 0.3")]);
    let is_front_bar = |refusal: &Refusal| matches!(refusal, Refusal::Superfluous(gap) if gap.to_string() == "front hanging 0.10 to 0.30 m");
    assert!(slow.iter().any(is_front_bar), "{slow:?}");
}

const FEWEST: &str = include_str!("../../../../examples/fewest-holes.toml");

fn below_m(coverage: &super::Coverage, region: Region) -> Option<f32> {
    coverage.gaps.iter().find_map(|found| match found.gap {
        Gap { region: of, unseen: Unseen::Below(height_m) } if of == region => Some(height_m),
        _ => None,
    })
}

/// The nearest to no hole that the configuration can describe: nothing ahead from the floor on, nothing behind, and beside the body
/// only what is lower than the scanners' planes, or hangs.
#[test]
fn fg_req_062_fewest_holes_names_what_remains() {
    let configuration = read(FEWEST);
    let (coverage, refused) = configuration.coverage();
    assert_eq!(refused, []);
    let is =
        |gap: &Gap| matches!((gap.region, gap.unseen), (Region::Front, Unseen::Below(_)) | (Region::Rear, _));
    assert!(!coverage.gaps.iter().any(|found| is(&found.gap)), "{:?}", coverage.gaps);
    let (shipped, _) = read(EXAMPLE).coverage();
    assert!(coverage.gaps.len() < shipped.gaps.len());
    for region in [Region::FrontLeft, Region::FrontRight, Region::RearLeft, Region::RearRight] {
        assert_eq!((below_m(&coverage, region), below_m(&shipped, region)), (Some(0.12), Some(0.80)));
    }
    // Without the camera the low boxes ahead are a gap again.
    let without = super::Coverage::of(&configuration.robot, None).refusals(&configuration.accepted_gaps);
    assert!(without.iter().any(|refusal| refusal.to_string().contains("\"front below")), "{without:?}");
    // Without the second scanner, or with one that looks along a narrow sector, what stands beside the rear is a gap again.
    let mut blind = configuration.robot.clone();
    blind.rear_scanner = None;
    let mut narrow = configuration.robot.clone();
    narrow.rear_scanner.as_mut().expect("a second scanner").sector_rad = [0.0, 0.1];
    for changed in [blind, narrow] {
        let coverage = super::Coverage::of(&changed, configuration.carriers.camera.as_ref());
        let found_m = below_m(&coverage, Region::RearRight);
        assert!(found_m.is_some_and(|height_m| height_m > 0.12), "{found_m:?}: {:?}", changed.rear_scanner);
    }
}

/// Scan planes at two heights would clear what the other has met; two devices share no line; a board lacks the memory for the second.
#[test]
fn fg_req_029_second_scanner_is_checked() {
    let refused = |from: &str, to: &str| {
        assert!(FEWEST.contains(from), "{from}");
        parse("robot.toml", &FEWEST.replacen(from, to, 1)).expect_err("refused").to_string()
    };
    let rear = "x_m = -0.43, y_m = -0.38, z_m = 0.10";
    assert!(refused(rear, &rear.replace("0.10", "0.15")).contains("mount both at the same height"));
    assert!(refused("serial:/dev/ttyUSB3", "serial:/dev/ttyUSB0").contains("give each device its own line"));
    let robot = read(FEWEST).robot;
    let guard = robot.guard();
    guard.validate().expect("a computer has the memory for it");
    assert_eq!(guard.rear_scanner.map(|rear| rear.beams), Some(541));
    assert!(
        crate::bake(&robot).contains("compile_error!(\"[rear_scanner]: a microcontroller lacks the memory")
    );
    assert!(crate::bake(&read(EXAMPLE).robot).contains("rear_scanner: None"));
}

#[test]
fn fg_req_063_gap_accepted_at_a_speed_limits_its_direction() {
    let with = |speed: &str| {
        let name = "\"front hanging 0.10 to 0.30 m";
        read(&EXAMPLE.replacen(&format!("{name}\""), &format!("{name}{speed}\""), 1))
    };
    let free = with("").robot.unseen;
    assert_eq!([free.forward_mps, free.turning_mps, free.spinning_mps, free.reverse_mps], [f32::MAX; 4]);
    // From 0.4 m/s on these bars are not seen in time: at 0.3 m/s there is no gap.
    for (speed, limit_mps) in [(" at 0.10 m/s", 0.3), (" at 0.30 m/s", 0.3), (" at 0.50 m/s", 0.5)] {
        let configuration = with(speed);
        let unseen = configuration.robot.unseen;
        assert!((unseen.forward_mps - limit_mps).abs() < 1.0e-3, "{speed}: {unseen:?}");
        assert_eq!([unseen.turning_mps, unseen.spinning_mps, unseen.reverse_mps], [f32::MAX; 3]);
        let (coverage, refused) = configuration.coverage();
        assert_eq!(refused, [], "it is accepted all the same");
        let limits = configuration.direction_limits(&coverage);
        let text = limits.first().map(ToString::to_string).unwrap_or_default();
        assert!(
            limits.len() == 1
                && text.starts_with(&format!("forward at most {limit_mps:.2} m/s instead of 1.00")),
            "{text}"
        );
    }
    assert_eq!(with(" at 1.00 m/s").robot.unseen, free, "no motion is faster there");
    for wrong in [" at 0.30", " at 9.00 m/s", " at -1 m/s", " at m/s"] {
        let text = EXAMPLE.replacen("0.10 to 0.30 m\"", &format!("0.10 to 0.30 m{wrong}\""), 1);
        assert!(parse("robot.toml", &text).is_err(), "{wrong}");
    }
}

/// The fastest point of the body is slower the nearer to it the gap is.
#[test]
fn fg_req_063_body_comes_no_faster_into_an_accepted_gap() {
    let configuration = read(FEWEST);
    let (coverage, _) = configuration.coverage();
    let limits = configuration.direction_limits(&coverage);
    let limit_mps =
        |name| limits.iter().find(|limit| limit.direction.name() == name).map(|limit| limit.limit_mps);
    for gap in &coverage.gaps {
        for motion in &gap.motions {
            let direction = match motion.motion.is_turning() {
                false => "forward",
                true if motion.motion.name().starts_with("spin") => "spinning",
                true => "turning",
            };
            let limit_mps = limit_mps(direction).expect("a limit");
            let is_slow = motion.body_share * limit_mps <= 0.30 + 1.0e-3;
            assert!(is_slow || limit_mps <= motion.free_mps + 1.0e-3, "{}: {limit_mps} m/s", gap.gap);
        }
    }
}

/// A place beside the rear corner is 0.85 m behind the edge of the scanner's sector; two scanners see it at once.
#[test]
fn fg_req_064_rear_is_known_after_its_places_were_passed() {
    let known_after_m = |text: &str| read(text).robot.unseen.known_after_m;
    let shipped_m = known_after_m(EXAMPLE);
    assert!((0.7..1.1).contains(&shipped_m), "{shipped_m}");
    assert_eq!(known_after_m(FEWEST), 0.0);
    let narrow = format!("{SCANNER}\nsector_first_deg = -60.0\nsector_last_deg = 60.0");
    assert!(known_after_m(&EXAMPLE.replacen(SCANNER, &narrow, 1)) > shipped_m + 0.3);
    let back = EXAMPLE.replacen(SCANNER, &SCANNER.replace("yaw_deg = 0.0", "yaw_deg = 180.0"), 1);
    assert!(known_after_m(&back) > 100.0, "it never looks ahead");
}
