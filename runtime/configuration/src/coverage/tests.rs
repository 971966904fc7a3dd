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

/// The nearest to no hole that today's configuration can describe: nothing ahead from the floor on, nothing behind, and gentler sides.
#[test]
fn fg_req_062_fewest_holes_names_what_remains() {
    let configuration = read(include_str!("../../../../examples/fewest-holes.toml"));
    let (coverage, refused) = configuration.coverage();
    assert_eq!(refused, []);
    let is =
        |gap: &Gap| matches!((gap.region, gap.unseen), (Region::Front, Unseen::Below(_)) | (Region::Rear, _));
    assert!(!coverage.gaps.iter().any(|found| is(&found.gap)), "{:?}", coverage.gaps);
    let (shipped, _) = read(EXAMPLE).coverage();
    let fastest_mps =
        |gaps: &[super::SensorGap]| gaps.iter().map(super::SensorGap::reached_mps).fold(0.0, f32::max);
    assert!(
        coverage.gaps.len() < shipped.gaps.len() && fastest_mps(&coverage.gaps) < fastest_mps(&shipped.gaps)
    );
    // Without the camera the low boxes ahead are a gap again.
    let without = super::Coverage::of(&configuration.robot, None).refusals(&configuration.accepted_gaps);
    assert!(without.iter().any(|refusal| refusal.to_string().contains("\"front below")), "{without:?}");
}

#[test]
fn zz_print() {
    for text in [EXAMPLE, include_str!("../../../../examples/fewest-holes.toml")] {
        let configuration = read(text);
        let (coverage, refused) = configuration.coverage();
        eprintln!("{:?}", configuration.robot.unseen);
        for gap in &coverage.gaps {
            eprintln!("{} {:.2} {:?}", gap.gap, gap.reached_mps(), gap.around_m);
            for m in &gap.motions { eprintln!("   {:?} reached {:.2} share {:.2} free {:.2} fastest {:.2} first {:?}", m.motion, m.reached_mps, m.body_share, m.free_mps, m.fastest_mps, m.steps.first()); }
        }
        for r in refused { eprintln!("{r}"); }
    }
}
