//! The precomputed tables against plane geometry in 64 bits.

use super::fixtures::{config, config_with_rear, rectangle, tables};
use crate::*;
use floorguard_types::geometry::{Point2, Point3, Pose2, Transform3};
use floorguard_types::units::radians;

/// Where a ray leaves a polygon for the last time, 0 when it never meets it.
fn exit_m(polygon: &Polygon, from: (f64, f64), angle_rad: f64) -> f64 {
    let (sin, cos) = angle_rad.sin_cos();
    // Turn the world so that the ray is the positive x axis.
    let turned: std::vec::Vec<(f64, f64)> = polygon
        .iter()
        .map(|corner| (f64::from(corner.x_m) - from.0, f64::from(corner.y_m) - from.1))
        .map(|(x, y)| (cos * x + sin * y, cos * y - sin * x))
        .collect();
    let mut last_m = 0.0_f64;
    for (index, a) in turned.iter().enumerate() {
        let b = turned[(index + 1) % turned.len()];
        if (a.1 > 0.0) != (b.1 > 0.0) {
            last_m = last_m.max(a.0 + (b.0 - a.0) * a.1 / (a.1 - b.1));
        }
    }
    last_m
}

fn shapes() -> [Polygon; 3] {
    let corners = |list: &[(f32, f32)]| list.iter().map(|(x_m, y_m)| Point2::new(*x_m, *y_m)).collect();
    [
        rectangle([-0.45, 1.5], 0.5),
        corners(&[(-0.5, -0.6), (1.0, -0.9), (2.2, 0.1), (1.1, 0.8), (-0.6, 0.5)]),
        // Not star-shaped: an L.
        corners(&[(-0.5, -0.5), (2.0, -0.5), (2.0, 0.1), (0.6, 0.1), (0.6, 1.5), (-0.5, 1.5)]),
    ]
}

#[test]
fn fg_req_020_ray_exit_equals_plane_geometry() {
    for (index, shape) in shapes().iter().enumerate() {
        for origin in [(0.0_f32, 0.0_f32), (0.4, 0.05), (-3.0, 0.3)] {
            for step in 0..720_u32 {
                let angle = f64::from(step).to_radians() / 2.0 + 1.0e-4;
                let direction = Point2::new(angle.cos() as f32, angle.sin() as f32);
                let found = f64::from(ray_exit_m(shape, Point2::new(origin.0, origin.1), direction));
                let expected = exit_m(shape, (f64::from(origin.0), f64::from(origin.1)), angle);
                // A hair beyond the corners is inside.
                assert!((found - expected).abs() < 2.0e-3 || found > expected, "{index} {origin:?} {step}");
                assert!(found < expected + 2.0e-3 || (found - expected).abs() < 0.02 || expected == 0.0);
            }
        }
    }
    let square = rectangle([0.0, 1.0], 0.5);
    assert_eq!(ray_exit_m(&square, Point2::new(-1.0, 0.0), Point2::new(1.0, 0.0)), 2.0);
    assert_eq!(ray_exit_m(&square, Point2::new(-1.0, 0.0), Point2::new(-1.0, 0.0)), 0.0, "behind");
    assert_eq!(ray_exit_m(&square, Point2::new(-1.0, 3.0), Point2::new(1.0, 0.0)), 0.0, "beside");
    assert_eq!(ray_exit_m(&square, Point2::new(0.5, 0.0), Point2::new(0.0, 1.0)), 0.5);
    // A ray that meets the far edge a hair beside its corner, where the neighbouring edge is parallel to it.
    for y_m in [-0.499_96, -0.5, -0.500_04, 0.499_96, 0.500_04] {
        assert_eq!(ray_exit_m(&square, Point2::new(-1.0, y_m), Point2::new(1.0, 0.0)), 2.0, "{y_m}");
    }
    assert_eq!(ray_exit_m(&[], Point2::default(), Point2::new(1.0, 0.0)), 0.0);
}

/// Crossing numbers with the ray upwards instead of sidewards.
fn is_inside(shape: &Polygon, x: f64, y: f64) -> bool {
    exit_count(shape, x, y) % 2 == 1
}

fn exit_count(shape: &Polygon, x: f64, y: f64) -> usize {
    let corner = |index: usize| {
        let corner = shape[index % shape.len()];
        (f64::from(corner.x_m), f64::from(corner.y_m))
    };
    (0..shape.len())
        .filter(|index| {
            let (a, b) = (corner(*index), corner(*index + 1));
            (a.0 > x) != (b.0 > x) && a.1 + (b.1 - a.1) * (x - a.0) / (b.0 - a.0) > y
        })
        .count()
}

#[test]
fn fg_req_020_inside_equals_another_crossing_number() {
    for (index, shape) in shapes().iter().enumerate() {
        let mut inside = 0;
        for (x, y) in (-20..60).flat_map(|x| (-25..40).map(move |y| (x, y))) {
            let (x, y) = (f64::from(x) * 0.05 + 0.013, f64::from(y) * 0.05 + 0.017);
            let found = point_in_polygon(Point2::new(x as f32, y as f32), shape);
            inside += u32::from(found);
            // On an edge either is right.
            let near_an_edge = is_inside(shape, x, y - 1.0e-3) != is_inside(shape, x, y + 1.0e-3);
            assert!(near_an_edge || found == is_inside(shape, x, y), "{index} {x} {y}");
        }
        assert!(inside > 300, "{inside}");
    }
}

#[test]
fn fg_req_023_each_bin_holds_the_extremes_of_its_rays() {
    let mut config = config();
    // Not level with the edge of the body, and not on the middle line.
    config.lidar.mounting = Transform3::from_mounting(Point3::new(0.4, 0.1, 0.8), 0.0, 0.0, 0.0);
    let (_, table) = tables(&config);
    assert_eq!((table.origin.x_m, table.origin.y_m), (0.4, 0.1));
    let saturated = |value: f64| value.clamp(0.0, 65_535.0);
    for (index, bin) in table.bins.iter().enumerate() {
        // Azimuth runs clockwise.
        let rays = (0..5_u32).map(|sample| -(f64::from(index as u32 * 4 + sample) / 2.0).to_radians());
        let rays: std::vec::Vec<f64> = rays.collect();
        let exits = |polygon: &Polygon| {
            rays.iter().map(|angle| exit_m(polygon, (0.4, 0.1), *angle) * 1.0e3).collect::<std::vec::Vec<_>>()
        };
        for (set, field) in config.fields.iter().enumerate() {
            let most = exits(&field.protective).into_iter().fold(0.0, f64::max);
            let found = f64::from(bin.protective_mm[set]);
            assert!((found - most.ceil()).abs() < 1.5, "bin {index} set {set}: {found} {most}");
        }
        let least = exits(&config.lidar.self_mask).into_iter().fold(f64::INFINITY, f64::min);
        assert!((f64::from(bin.own_mm) - least).abs() < 1.5, "bin {index}: {} {least}", bin.own_mm);
        let last = rays[4];
        assert!((f64::from(bin.direction.x_m) - last.cos()).abs() < 1.0e-5);
        assert!((f64::from(bin.direction.y_m) - last.sin()).abs() < 1.0e-5);
        for ring in 0..16_usize {
            let elevation = (ring as f64 * 2.0 - 15.0).to_radians();
            let share = elevation.cos() * 65_535.0;
            assert!((f64::from(bin.plane_share[ring]) - share).abs() <= 2.0, "bin {index} ring {ring}");
            // 0.7 m down to the clearance, 0.2 m up to the body's height.
            let clear_m = if elevation < 0.0 { 0.7 / -elevation.sin() } else { 0.2 / elevation.sin() };
            let height_mm = saturated(clear_m * 1.0e3);
            assert!((f64::from(bin.height_mm[ring]) - height_mm).abs() <= 2.0, "bin {index} ring {ring}");
        }
        let least_share = bin.plane_share[..16].iter().min().copied();
        assert_eq!(Some(bin.least_share), least_share);
    }
}

#[test]
fn fg_req_023_tilted_lidar_places_the_floor_correctly() {
    let mut config = config();
    let pitch = radians(10.0);
    config.lidar.mounting = Transform3::from_mounting(Point3::new(0.5, 0.0, 0.8), 0.0, pitch, radians(90.0));
    config.lidar.elevations_rad = [0.0].into_iter().collect();
    let (_, table) = tables(&config);
    let bin = |azimuth_deg: usize| table.bins[azimuth_deg / 2];
    assert!(table.bins.iter().all(|bin| (bin.direction.norm() - 1.0).abs() < 1.0e-5), "unit vectors");
    // Its front points to the left of the robot, and down by 10°.
    let reach_mm = 0.7e3 / f64::from(pitch).sin();
    assert!((f64::from(bin(0).height_mm[0]) - reach_mm).abs() < 30.0, "{}", bin(0).height_mm[0]);
    assert!(bin(0).direction.y_m > 0.99 && bin(90).direction.x_m > 0.99);
    let up_mm = 0.2e3 / f64::from(pitch).sin();
    assert!((f64::from(bin(180).height_mm[0]) - up_mm).abs() < 10.0, "{}", bin(180).height_mm[0]);
    assert!((f64::from(bin(0).plane_share[0]) - 65_535.0 * f64::from(pitch).cos()).abs() < 30.0);
}

#[test]
fn fg_req_023_a_level_ray_meets_neither_floor_nor_ceiling() {
    let mut config = config();
    config.lidar.elevations_rad = [0.0].into_iter().collect();
    let (_, table) = tables(&config);
    assert!(table.bins.iter().all(|bin| bin.height_mm[0] == u16::MAX));
}

#[test]
fn fg_req_020_each_beam_has_the_reach_of_its_field() {
    let mut config = config();
    config.scanner.mounting = Pose2::new(0.8, 0.1, radians(10.0));
    config.scanner.sector_rad = [radians(-120.0), radians(110.0)];
    let (table, _) = tables(&config);
    for beam in 0..541_usize {
        let in_sensor_deg = beam as f64 * 0.5 - 135.0;
        let angle = (in_sensor_deg + 10.0).to_radians();
        assert!((f64::from(table.directions[beam].x_m) - angle.cos()).abs() < 1.0e-5, "{beam}");
        assert!((f64::from(table.directions[beam].y_m) - angle.sin()).abs() < 1.0e-5, "{beam}");
        let is_watched = (-120.25..=110.25).contains(&in_sensor_deg);
        for (set, field) in config.fields.iter().enumerate() {
            for (found, polygon) in [(&table.protective, &field.protective), (&table.warning, &field.warning)]
            {
                let expected_mm =
                    if is_watched { (exit_m(polygon, (0.8, 0.1), angle) * 1.0e3).ceil() } else { 0.0 };
                let found_mm = f64::from(found[set][beam]);
                assert!(
                    (found_mm - expected_mm).abs() <= 2.0,
                    "beam {beam} set {set}: {found_mm} {expected_mm}"
                );
            }
        }
    }
    for (set, _) in config.fields.iter().enumerate() {
        let watched = table.protective[set].iter().filter(|limit| **limit > 0).count();
        assert_eq!((usize::from(table.watched[set]), watched), (461, 461), "from -120° to 110°");
    }
    assert_eq!(table.watched[config.fields.len()], 0);
}

fn rear_table() -> RearScanner {
    let config = config_with_rear();
    let mut rear = RearScanner::EMPTY;
    rear.fill(config.rear_scanner.as_ref(), &config.fields);
    rear
}

#[test]
fn fg_req_017_every_part_of_the_rear_table_is_checked() {
    let config = config_with_rear();
    let body = Body::around(&config.footprint);
    let ((scan, packet), whole) = (tables(&config), rear_table());
    let noticed = |rear: &RearScanner| {
        let mut integrity = Integrity::NONE;
        let whole = [whole.clone()];
        integrity.remember(&config, body, ((&scan, &whole), &packet, &LidarRays::NONE));
        let tables = ((&scan, core::slice::from_ref(rear)), &packet, &LidarRays::NONE);
        (0..PARTS).filter(|_| !integrity.check_next(&config, body, tables)).count()
    };
    assert_eq!(noticed(&whole), 0);
    for beam in (0..541_usize).step_by(7) {
        let mut other = whole.clone();
        match beam % 3 {
            0 => other.table.directions[beam].x_m += 0.25,
            1 => other.table.protective[beam % 8][beam] ^= 2,
            _ => other.table.warning[beam % 8][beam] ^= 2,
        }
        assert_eq!(noticed(&other), 1, "beam {beam}");
    }
    let mut other = whole.clone();
    other.table.geometry.beams = 540;
    assert_eq!(noticed(&other), 1);
}

#[test]
fn fg_req_017_every_part_of_the_tables_is_checked() {
    let config = config();
    let body = Body::around(&config.footprint);
    let ((scan, packet), rear) = (tables(&config), [rear_table()]);
    let mut rays = LidarRays::NONE;
    rays.fill(&config.lidar);
    let fresh = || {
        let mut integrity = Integrity::NONE;
        integrity.remember(&config, body, ((&scan, &rear), &packet, &rays));
        integrity
    };
    let noticed = |config: &GuardConfig,
                   body: Body,
                   tables: ((&ScanTable, &[RearScanner]), &PacketTable, &LidarRays)| {
        let mut integrity = fresh();
        (0..PARTS).filter(|_| !integrity.check_next(config, body, tables)).count()
    };
    assert_eq!(noticed(&config, body, ((&scan, &rear), &packet, &rays)), 0);
    let mut nothing = Integrity::NONE;
    assert!(!nothing.check_next(&config, body, ((&scan, &rear), &packet, &rays)), "nothing is remembered");
    let mut twice = fresh();
    assert!((0..2 * PARTS).all(|_| twice.check_next(&config, body, ((&scan, &rear), &packet, &rays))));
    let mut other_config = config.clone();
    other_config.drive.speed_mps += 0.1;
    assert_eq!(noticed(&other_config, body, ((&scan, &rear), &packet, &rays)), 1);
    assert_eq!(noticed(&config, Body { x_m: [-0.45, 0.96], ..body }, ((&scan, &rear), &packet, &rays)), 1);
    let mut other_scan = scan.clone();
    other_scan.geometry.beams = 540;
    assert_eq!(noticed(&config, body, ((&other_scan, &rear), &packet, &rays)), 1);
    for bin in 0..180_usize {
        let mut other = packet.clone();
        match bin % 6 {
            0 => other.bins[bin].own_mm ^= 1,
            1 => other.bins[bin].direction.x_m += 0.5,
            2 => other.bins[bin].direction.y_m += 0.5,
            3 => other.bins[bin].plane_share[3] ^= 0x80,
            4 => other.bins[bin].height_mm[15] ^= 4,
            _ => other.bins[bin].least_share ^= 0x4000,
        }
        assert_eq!(noticed(&config, body, ((&scan, &rear), &other, &rays)), 1, "bin {bin}");
    }
    for beam in 0..541_usize {
        let mut other = scan.clone();
        match beam % 4 {
            0 => other.directions[beam].x_m += 0.25,
            1 => other.directions[beam].y_m += 0.25,
            2 => other.protective[beam % 8][beam] ^= 2,
            _ => other.warning[beam % 8][beam] ^= 2,
        }
        assert_eq!(noticed(&config, body, ((&other, &rear), &packet, &rays)), 1, "beam {beam}");
    }
    let mut other = packet.clone();
    other.origin.x_m += 0.125;
    assert!(noticed(&config, body, ((&scan, &rear), &other, &rays)) > 0);
    let mut other = scan.clone();
    other.watched[7] = 1;
    assert!(noticed(&config, body, ((&other, &rear), &packet, &rays)) > 0);
    let mut other = rays.clone();
    other.rings[3][1] += 0.125;
    assert!(noticed(&config, body, ((&scan, &rear), &packet, &other)) > 0);
}
