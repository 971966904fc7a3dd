//! Whether a sensor sees something: beams cast at the true scene.
//!
//! Written independently of the simulator's sensors: it gives no ranges and no noise, only whether enough beams end on
//! the object asked for.

use parry3d::math::Vector;
use parry3d::query::Ray;

use crate::scene::{Key, Surface};
use crate::sensor::{Sensor, Window};
use crate::solid::Placed;
use crate::{RobotPose, SensorView};

/// Glass throws a beam back within 6° of the right angle.
const GLASS_COSINE: f32 = 0.9945;
/// A beam that ends this little below the floor has met a hole in it, metres.
const FLOOR_M: f32 = 0.01;

/// A solid that beams meet.
#[derive(Clone)]
pub(crate) struct Visible {
    pub(crate) key: Key,
    pub(crate) placed: Placed,
    pub(crate) surface: Surface,
}

/// What is looked for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    pub(crate) key: Key,
    /// Around this point, world frame, metres.
    pub(crate) centre_m: [f32; 3],
    /// Within this of it, metres.
    pub(crate) radius_m: f32,
    /// Within this of it as seen from above, metres.
    pub(crate) aside_m: f32,
}

/// Enough beams of the sensor end on the target.
pub(crate) fn sees(sensor: &Sensor, robot: RobotPose, target: &Target, scene: &[Visible]) -> bool {
    let [x, y] = robot.point([sensor.at_m[0], sensor.at_m[1]]);
    let origin = Vector::new(x, y, sensor.at_m[2]);
    let heading_rad = robot.heading_rad + sensor.yaw_rad;
    let centre = Vector::from_array(target.centre_m);
    let path = centre - origin;
    let distance_m = path.length();
    let [nearest_m, farthest_m] = sensor.range_m;
    if distance_m - target.radius_m > farthest_m || distance_m + target.radius_m < nearest_m {
        return false;
    }
    let half_rad = if distance_m > target.radius_m * 1.01 {
        libm::asinf(target.radius_m / distance_m) + 0.01
    } else {
        core::f32::consts::PI
    };
    let window = Window {
        azimuth_rad: libm::atan2f(path.y, path.x) - heading_rad,
        elevation_rad: libm::atan2f(path.z, libm::hypotf(path.x, path.y)),
        half_rad: if sensor.view == SensorView::Down { core::f32::consts::PI } else { half_rad },
    };
    let (sin, cos) = libm::sincosf(heading_rad);
    let near: Vec<&Visible> = scene.iter().filter(|seen| reaches(seen, origin, centre)).collect();
    let mut count = 0;
    for beam in sensor.view.beams(&window) {
        let direction = Vector::new(cos * beam[0] - sin * beam[1], sin * beam[0] + cos * beam[1], beam[2]);
        let Some((key, range_m)) = end(&near, origin, direction, farthest_m) else { continue };
        let at = origin + direction * range_m;
        let is_distinguished = if at.z <= 0.0 { sensor.sees_holes } else { at.z >= sensor.above_floor_m };
        let is_near = (at - centre).length() <= target.radius_m
            && libm::hypotf(at.x - centre.x, at.y - centre.y) <= target.aside_m;
        let is_target = key == target.key && is_distinguished && is_near;
        count += usize::from(is_target && range_m >= nearest_m);
        if count >= sensor.beams_min {
            return true;
        }
    }
    false
}

/// The solid can stand between the two points, or at the far one.
fn reaches(seen: &Visible, from: Vector, to: Vector) -> bool {
    let [low, high] = seen.placed.bounds();
    let (middle, radius_m) = ((low + high) / 2.0, (high - low).length() / 2.0);
    let path = to - from;
    let along = ((middle - from).dot(path) / path.length_squared().max(1.0e-6)).clamp(0.0, 1.0);
    // Beams of the window end within a metre of the target.
    (from + path * along - middle).length() <= radius_m + 1.0
}

/// On what a beam ends, and how far away, metres; the floor ends it, too.
fn end(scene: &[&Visible], origin: Vector, direction: Vector, range_max_m: f32) -> Option<(Key, f32)> {
    let floor_m = if direction.z < -1.0e-4 { (origin.z + FLOOR_M) / -direction.z } else { range_max_m };
    let limit_m = range_max_m.min(floor_m);
    let ray = Ray::new(origin, direction);
    let mut hits: Vec<(f32, Key, Surface, f32)> = Vec::new();
    for seen in scene {
        let hit = seen.placed.shape.cast_ray_and_get_normal(&seen.placed.pose, &ray, limit_m, true);
        if let Some(hit) = hit {
            hits.push((hit.time_of_impact, seen.key, seen.surface, hit.normal.dot(direction).abs()));
        }
    }
    hits.sort_by(|a, b| a.0.total_cmp(&b.0));
    let passes = |surface: Surface, cosine: f32| surface == Surface::Glass && cosine < GLASS_COSINE;
    let (range_m, key, surface, _) = hits.into_iter().find(|hit| !passes(hit.2, hit.3))?;
    (surface != Surface::Mirror).then_some((key, range_m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Solid;

    fn board(key: usize, x_m: f32, z_m: [f32; 2], surface: Surface) -> Visible {
        let solid = Solid::Box {
            centre_m: [x_m, 0.0, (z_m[0] + z_m[1]) / 2.0],
            half_m: [0.05, 0.5, (z_m[1] - z_m[0]) / 2.0],
            yaw_rad: 0.0,
            slope_rad: 0.0,
        };
        Visible { key: Key::Thing(key), placed: solid.placed(), surface }
    }

    fn scanner() -> Sensor {
        Sensor {
            name: "scanner".into(),
            at_m: [0.9, 0.0, 0.15],
            yaw_rad: 0.0,
            view: SensorView::Plane { half_angle_rad: 2.356, step_rad: 0.0087 },
            range_m: [0.0, 30.0],
            delay_s: 0.22,
            above_floor_m: 0.0,
            sees_holes: false,
            beams_min: 2,
        }
    }

    fn lidar() -> Sensor {
        let elevations_rad = (0..16).map(|ring| ((ring * 2 - 15) as f32).to_radians()).collect();
        let view = SensorView::Rings { elevations_rad, step_rad: 0.007 };
        Sensor {
            name: "lidar".into(),
            at_m: [0.5, 0.0, 0.8],
            view,
            range_m: [0.45, 100.0],
            above_floor_m: 0.1,
            ..scanner()
        }
    }

    fn target(x_m: f32, z_m: f32) -> Target {
        Target { key: Key::Thing(0), centre_m: [x_m, 0.0, z_m], radius_m: 0.5, aside_m: 0.5 }
    }

    fn ahead(sensor: &Sensor, z_m: [f32; 2], x_m: f32) -> bool {
        let scene = [board(0, x_m, z_m, Surface::Opaque)];
        sees(sensor, RobotPose::default(), &target(x_m, z_m[1]), &scene)
    }

    /// The scanner looks at 0.15 m; the lidar's lowest beam falls by 0.268 m a metre from 0.8 m.
    #[test]
    fn heights_decide_who_sees_a_board() {
        assert!(ahead(&scanner(), [0.0, 0.2], 3.0));
        assert!(!ahead(&scanner(), [0.0, 0.12], 3.0));
        assert!(!ahead(&scanner(), [0.4, 0.45], 3.0));
        // At 2.5 m from the lidar the lowest beam is 0.13 m high: a table is seen, and no more from 0.6 m.
        assert!(ahead(&lidar(), [0.3, 0.45], 3.0));
        assert!(!ahead(&lidar(), [0.3, 0.45], 1.1));
        assert!(!ahead(&lidar(), [0.0, 0.08], 2.0));
        // It meets the lower part of a low box, which might as well be the floor.
        assert!(!ahead(&lidar(), [0.0, 0.08], 3.3) && ahead(&lidar(), [0.0, 0.25], 3.0));
    }

    #[test]
    fn solid_hides_and_glass_does_not() {
        let hidden = |surface| {
            let scene = [board(0, 4.0, [0.0, 1.0], Surface::Opaque), board(1, 2.0, [0.0, 1.0], surface)];
            let aside = RobotPose { y_m: 0.5, heading_rad: -0.15, ..RobotPose::default() };
            sees(&scanner(), aside, &target(4.0, 0.15), &scene)
        };
        assert!(!hidden(Surface::Opaque));
        assert!(hidden(Surface::Glass));
        assert!(!hidden(Surface::Mirror));
    }

    #[test]
    fn glass_is_seen_perpendicularly_mirror_never() {
        let one = |surface, heading_rad: f32| {
            let scene = [board(0, 3.0, [0.0, 1.0], surface)];
            let pose = RobotPose { y_m: -2.4 * heading_rad, heading_rad, ..RobotPose::default() };
            sees(&scanner(), pose, &target(3.0, 0.15), &scene)
        };
        assert!(one(Surface::Glass, 0.0));
        assert!(!one(Surface::Glass, 0.6));
        assert!(!one(Surface::Mirror, 0.0));
    }

    #[test]
    fn scanner_is_blind_behind_switch_feels_hole() {
        let rear = [board(0, -1.0, [0.0, 1.0], Surface::Opaque)];
        let behind = Target { key: Key::Thing(0), centre_m: [-0.95, 0.0, 0.5], radius_m: 0.5, aside_m: 0.5 };
        assert!(!sees(&scanner(), RobotPose::default(), &behind, &rear));
        assert!(sees(&lidar(), RobotPose::default(), &behind, &rear));
        let hole = board(0, 1.0, [-1.0, -0.001], Surface::Opaque);
        let below = Target { key: Key::Thing(0), centre_m: [1.0, 0.0, 0.0], radius_m: 0.5, aside_m: 0.5 };
        let switch = Sensor {
            at_m: [1.0, 0.0, 0.1],
            view: SensorView::Down,
            beams_min: 1,
            sees_holes: true,
            ..scanner()
        };
        assert!(sees(&switch, RobotPose::default(), &below, core::slice::from_ref(&hole)));
        let away = RobotPose { x_m: -0.5, ..RobotPose::default() };
        assert!(!sees(&switch, away, &below, &[hole]));
    }
}
