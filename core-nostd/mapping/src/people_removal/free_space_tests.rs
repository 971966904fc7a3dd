//! Rays through voxels, beside sampling of the same rays, and memory that ends.

use std::collections::BTreeSet;
use std::vec;
use std::vec::Vec;

use floorguard_types::geometry::Point3;

use super::{Block, ClearRay, FanReturn, FanRule, FixedVoxels, FreeSpace, SweepFan};

fn space(blocks: usize) -> FreeSpace<FixedVoxels<Vec<Block>>> {
    FreeSpace::new(0.1, FixedVoxels::new(vec![Block::FREE; blocks])).unwrap()
}

#[test]
fn a_ray_passes_the_voxels_that_it_crosses() {
    let rays = [
        ([-0.73, 0.21, 0.8], [3.11, -2.46, 1.93]),
        ([0.05, 0.05, 0.05], [0.05, 0.05, 2.05]),
        ([2.0, -1.3, 0.7], [-2.0, -1.3, 0.7]),
        ([1.23, 1.31, 0.42], [1.24, 1.32, 0.43]),
    ];
    for (from, to) in rays {
        let point = |[x, y, z]: [f32; 3]| Point3::new(x, y, z);
        let mut space = space(512);
        space.begin_sweep();
        space.pass(point(from), point(to));
        // Twenty thousand samples of the ray, each in its voxel.
        let mut crossed = BTreeSet::new();
        for step in 0..=20_000_u16 {
            let share = f32::from(step) / 20_000.0;
            let at = [0, 1, 2].map(|axis| from[axis] + share * (to[axis] - from[axis]));
            crossed.insert(at.map(|value| (value / 0.1).floor() as i32));
        }
        let middle = |key: &[i32; 3]| point(key.map(|index| (index as f32 + 0.5) * 0.1));
        let missed = crossed.iter().filter(|key| space.at(middle(key)).passes != 1).count();
        // A sample may be rounded into a voxel that the ray only touches.
        assert!(missed <= 2, "{missed} of {}", crossed.len());
        let beside = Point3::new(from[0], from[1], from[2] + 0.5);
        assert_eq!(space.at(beside).passes, u8::from(to[0] == from[0]));
    }
}

#[test]
fn a_voxel_counts_once_a_sweep() {
    let mut space = space(64);
    let place = Point3::new(1.05, 0.05, 0.55);
    for _ in 0..3 {
        space.begin_sweep();
        space.hit(place);
        space.hit(place);
        space.pass(Point3::new(0.0, 0.05, 0.55), Point3::new(2.0, 0.05, 0.55));
    }
    assert_eq!((space.at(place).hits, space.at(place).passes), (3, 0));
    for _ in 0..2 {
        space.begin_sweep();
        (0..2).for_each(|_| space.pass(Point3::new(0.0, 0.05, 0.55), Point3::new(2.0, 0.05, 0.55)));
    }
    assert_eq!((space.at(place).hits, space.at(place).passes), (3, 2));
}

#[test]
fn what_does_not_fit_is_counted_and_unknown() {
    let mut space = space(2);
    space.begin_sweep();
    for step in 0..10_u8 {
        space.hit(Point3::new(2.0 * f32::from(step), 0.0, 0.0));
    }
    assert_eq!(space.counts().left_out, 8);
    assert_eq!(space.at(Point3::new(18.0, 0.0, 0.0)).hits, 0);
    space.hit(Point3::new(f32::NAN, 0.0, 0.0));
    space.pass(Point3::default(), Point3::new(1.0e9, 0.0, 0.0));
    assert_eq!(space.counts().refused, 2);
}

fn clear(fan: &SweepFan<3, 360>, rule: FanRule) -> Vec<ClearRay> {
    let mut rays = Vec::new();
    fan.for_each_clear(rule, &mut [[0.0; 360]; 3], |ray| rays.push(ray));
    rays
}

fn enter(fan: &mut SweepFan<3, 360>, ring: usize, degrees: f32, range_m: f32) {
    let (azimuth, elevation) = (degrees.to_radians(), (2.0 * ring as f32 - 2.0).to_radians());
    let flat_m = range_m * elevation.cos();
    let point = Point3::new(flat_m * azimuth.cos(), flat_m * azimuth.sin(), range_m * elevation.sin());
    fan.enter(FanReturn {
        ring,
        point_in_sensor: point,
        point_in_map: point,
        sensor_in_map: Point3::default(),
    });
}

#[test]
fn rays_end_beside_near_returns() {
    let rule = FanRule { every: 1, ..FanRule::default() };
    let mut fan = SweepFan::<3, 360>::new([-2.0_f32, 0.0, 2.0].map(f32::to_radians));
    // A wall at 5 m; no return beyond 40°: nothing is known there.
    for degrees in 0..40_u8 {
        (0..3).for_each(|ring| enter(&mut fan, ring, f32::from(degrees) + 0.5, 5.0));
    }
    let rays = clear(&fan, rule);
    assert_eq!(rays.len(), 120);
    let ends = |rays: &[ClearRay]| rays.iter().map(|ray| ray.to.x_m.hypot(ray.to.y_m)).collect::<Vec<f32>>();
    assert!(ends(&rays).iter().all(|end| (end - 4.85).abs() < 0.01));
    // A post at 2 m: rays within 0.08 m of it, two cells on each side and the rings above and below, end before it. In its own
    // cell the step to the rings above and below may be a flat surface, and nothing is claimed.
    enter(&mut fan, 1, 20.5, 2.0);
    let short = ends(&clear(&fan, rule)).iter().filter(|end| (**end - 1.85).abs() < 0.01).count();
    assert_eq!((short, clear(&fan, rule).len()), (12, 119));
    // The next sweep begins without knowledge.
    fan.clear();
    assert_eq!(clear(&fan, rule).len(), 0);
}

#[test]
fn a_flat_surface_ends_rays_before_its_height() {
    let rule = FanRule { every: 1, farthest_m: 50.0, ..FanRule::default() };
    let mut fan = SweepFan::<3, 360>::new([-6.0_f32, -4.0, -2.0].map(f32::to_radians));
    // A floor 0.8 m below the sensor.
    for ring in 0..3_usize {
        let elevation = (2.0 * ring as f32 - 6.0).to_radians();
        let far_m = 0.8 / elevation.tan().abs();
        let point = Point3::new(far_m, 0.001, -0.8);
        fan.enter(FanReturn {
            ring,
            point_in_sensor: point,
            point_in_map: point,
            sensor_in_map: Point3::default(),
        });
    }
    let rays = clear(&fan, rule);
    assert_eq!(rays.len(), 3);
    assert!(rays.iter().all(|ray| (ray.to.z_m + 0.65).abs() < 0.01), "{rays:?}");
}
