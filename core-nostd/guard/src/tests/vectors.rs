//! Numbers of the book, Guard and Conventions, and the tables against an independent point-in-polygon test.

use super::fixtures::{config, rectangle};
use crate::*;
use floorguard_types::geometry::Point2;
use floorguard_types::sensing::BeamReturn;
use floorguard_types::time::Stamp;

#[test]
fn fg_req_020_field_lengths_of_the_specification() {
    for (speed, expected) in [(0.3, 0.575), (0.6, 0.813), (1.0, 1.305), (1.3, 1.805)] {
        let length = field_length_m(speed, 0.23, 0.8, 0.45);
        assert!((length - expected).abs() < 6.0e-4, "{speed}: {length}");
    }
    // The worked example of the book, Guard: Field length.
    assert!((field_length_m(1.0, 0.13, 1.5, 0.45) - 0.913).abs() < 1.0e-3);
    assert!(stop_distance_m(1.0, 0.5, 0.0, 0.0).is_infinite());
    assert!(
        (stop_distance_m(1.0, 0.5, 1.0, 1.5) - (0.5 + 0.125 + 0.75)).abs() < 1.0e-6,
        "RSS: 1.3750 to a standing one"
    );
}

#[test]
fn fg_req_020_lower_and_left_edges_are_inside() {
    let square = rectangle([0.0, 1.0], 0.5);
    for (x, y, inside) in
        [(0.5, 0.0, true), (0.0, 0.0, true), (1.0, 0.0, false), (0.5, -0.5, true), (0.5, 0.5, false)]
    {
        assert_eq!(point_in_polygon(Point2::new(x, y), &square), inside, "{x} {y}");
    }
}

#[test]
fn fg_req_030_time_to_collision_of_the_closed_form() {
    let t = |p: (f32, f32), u: (f32, f32), r| {
        time_to_collision_s(Point2::new(p.0, p.1), Point2::new(u.0, u.1), r)
    };
    assert_eq!(t((0.5, 0.0), (0.0, 0.0), 1.0), 0.0);
    assert!((t((3.0, 0.0), (-1.0, 0.0), 1.0) - 2.0).abs() < 1.0e-5);
    assert!(t((3.0, 0.0), (1.0, 0.0), 1.0).is_infinite());
    assert!(t((3.0, 0.0), (0.0, 0.0), 1.0).is_infinite());
    assert!(t((3.0, 1.5), (-1.0, 0.0), 1.0).is_infinite(), "a miss");
    // A robot that turns towards somebody aside meets him, one that drives straight does not.
    let body = Body::around(&config().footprint);
    let aside = AdvisedPerson { position: Point2::new(1.5, 1.6), ..AdvisedPerson::default() };
    let twist = |angular_radps| floorguard_types::geometry::Twist2 { linear_mps: 0.6, angular_radps };
    assert!(body.times_to_person_s(&aside, twist(0.0))[0].is_infinite());
    assert!(body.times_to_person_s(&aside, twist(0.6))[0] < 3.0);
}

#[test]
fn fg_req_026_inner_points_are_seen_zone_contains_footprint() {
    let config = config();
    let mut table = crate::ScanTable::EMPTY;
    table.fill(&config.scanner, &config.fields);
    let body = Body::around(&config.footprint);
    for (x, y) in (-40..130).flat_map(|x| (-30..31).map(move |y| (x as f32 * 0.02, y as f32 * 0.02))) {
        let (dx, dy): (f32, f32) = (x - 0.9, y);
        // The scanner sees 270 degrees.
        if dy.atan2(dx).abs() > 134.0_f32.to_radians() || dx.hypot(dy) < 0.05 {
            continue;
        }
        let scan = super::fixtures::scan(Stamp::ZERO, 1, &[Point2::new(x, y)]);
        for (index, set) in config.fields.iter().enumerate() {
            // Beams stand 0.5° apart: points within a beam's width of the border may fall on either side.
            let border = 0.03;
            let inside = [(-border, 0.0), (border, 0.0), (0.0, -border), (0.0, border)]
                .iter()
                .all(|(ox, oy)| point_in_polygon(Point2::new(x + ox, y + oy), &set.protective));
            let found = table.check(&scan, index, (2, &body)).protective;
            assert!(!inside || found, "set {index} misses {x} {y}");
            let in_body = point_in_polygon(Point2::new(x, y), &config.footprint);
            assert!(!in_body || found, "set {index} misses the footprint at {x} {y}");
        }
    }
}

#[test]
fn fg_req_024_free_beams_inside_the_field_are_ignored() {
    let config = config();
    let mut table = crate::ScanTable::EMPTY;
    table.fill(&config.scanner, &config.fields);
    let mut scan = super::fixtures::scan(Stamp::ZERO, 1, &[]);
    for beam in scan.beams.iter_mut().skip(265).take(10) {
        *beam = BeamReturn::Free(200);
    }
    assert!(table.check(&scan, 2, (2, &Body::around(&config.footprint))).is_blind());
}
