//! Casts rays at the standing world, through parry's bounding-volume hierarchy.

use floorguard_types::geometry::Point2;
use parry3d::math::Pose;
use parry3d::math::Vector;
use parry3d::query::{PointQuery, Ray, intersection_test};
use parry3d::shape::{CompositeShapeRef, Compound, Shape};

use super::{DropTruth, Material, PartTruth};

/// A beam meets at most this many panes and mirrors.
const BOUNCES_MAX: usize = 3;
/// Cosine of the tilt below which a part is as wide at every height that it reaches.
const UPRIGHT_COSINE: f32 = 0.999_999;
/// So few parts are examined one by one, which is faster than to ask the hierarchy.
const FEW: usize = 6;
/// Cosine above which glass throws a beam back: within 6° of the right angle.
const GLASS_COSINE: f32 = 0.9945;

/// Where a beam ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Along the beam from its origin, metres.
    pub range_m: f32,
    /// Of the VLP-16's scale.
    pub reflectivity: u8,
}

/// The standing world: a floor at z = 0 and parts on it.
pub struct Scene {
    parts: Option<Compound>,
    truth: Vec<PartTruth>,
    drops: Vec<DropTruth>,
    plan: Option<Compound>,
}

impl Scene {
    pub(super) fn new(
        parts: Option<Compound>,
        (truth, drops): (Vec<PartTruth>, Vec<DropTruth>),
        plan: Option<Compound>,
    ) -> Self {
        Self { parts, truth, drops, plan }
    }

    /// Every part as it is, for judges.
    #[must_use]
    pub fn truth(&self) -> &[PartTruth] {
        &self.truth
    }

    /// Every hole in the floor.
    #[must_use]
    pub fn drops(&self) -> &[DropTruth] {
        &self.drops
    }

    /// The floor is there.
    #[must_use]
    pub fn has_floor_at(&self, place: Point2) -> bool {
        !self.drops.iter().any(|drop| drop.contains([place.x_m, place.y_m]))
    }

    /// A shape touches a part.
    #[must_use]
    pub fn touches(&self, pose: &Pose, shape: &dyn Shape) -> bool {
        let parts = self.parts.iter().flat_map(|parts| parts.shapes());
        let around = shape.compute_aabb(pose);
        parts.into_iter().any(|(at, part)| {
            use parry3d::bounding_volume::BoundingVolume as _;
            part.compute_aabb(at).intersects(&around)
                && intersection_test(at, part.as_ref(), pose, shape).is_ok_and(|met| met.intersecting)
        })
    }

    /// Along a beam to the floor, or to the floor of a hole, metres.
    fn floor_range(&self, origin: Vector, direction: Vector) -> Option<f32> {
        let range_m = floor_range(origin, direction)?;
        let at = origin + direction * range_m;
        let drop = self.drops.iter().find(|drop| drop.contains([at.x, at.y]));
        Some(drop.map_or(range_m, |drop| (origin.z + drop.depth_m) / -direction.z))
    }

    /// Follows a beam (unit direction) through panes and mirrors to a surface within `range_max_m`.
    #[must_use]
    pub fn cast(&self, origin: Vector, direction: Vector, range_max_m: f32) -> Option<Hit> {
        let (mut origin, mut direction, mut gone_m) = (origin, direction, 0.0);
        for _ in 0..BOUNCES_MAX {
            let left_m = range_max_m - gone_m;
            let floor = self.floor_range(origin, direction).filter(|range| *range < left_m);
            let part = self.nearest_part(origin, direction, floor.unwrap_or(left_m));
            let Some((index, range_m)) = part else {
                return floor.map(|range_m| Hit { range_m: gone_m + range_m, reflectivity: 30 });
            };
            let material = self.truth.get(index as usize).map(|part| part.material).unwrap_or_default();
            let end = Hit { range_m: gone_m + range_m, reflectivity: material.reflectivity() };
            if !matches!(material, Material::Glass | Material::Mirror) {
                return Some(end);
            }
            let normal = self.normal(index, origin, direction);
            if material == Material::Glass && normal.dot(direction).abs() > GLASS_COSINE {
                return Some(end);
            }
            // Glass: go on behind the pane. Mirror: go on along the mirrored direction.
            let step_m = if material == Material::Glass { range_m + 0.15 } else { range_m - 0.002 };
            origin += direction * step_m;
            gone_m += step_m;
            if material == Material::Mirror {
                direction -= normal * (2.0 * normal.dot(direction));
            }
        }
        None
    }

    fn nearest_part(&self, origin: Vector, direction: Vector, range_max_m: f32) -> Option<(u32, f32)> {
        let parts = self.parts.as_ref()?;
        let ray = Ray::new(origin, direction);
        if parts.shapes().len() > FEW {
            return CompositeShapeRef(parts).cast_local_ray(&ray, range_max_m, true);
        }
        let mut nearest = None;
        let mut limit_m = range_max_m;
        for (index, (pose, shape)) in (0..).zip(parts.shapes()) {
            if let Some(range_m) = shape.cast_ray(pose, &ray, limit_m, true).filter(|range| *range < limit_m)
            {
                limit_m = range_m;
                nearest = Some((index, range_m));
            }
        }
        nearest
    }

    fn normal(&self, part: u32, origin: Vector, direction: Vector) -> Vector {
        let shape = self.parts.as_ref().and_then(|parts| parts.shapes().get(part as usize));
        shape
            .and_then(|(pose, shape)| {
                shape.cast_ray_and_get_normal(pose, &Ray::new(origin, direction), 1.0e3, true)
            })
            .map_or(Vector::Z, |hit| hit.normal)
    }

    /// The nearest point of any obstacle, seen from above; `None` in an empty world.
    #[must_use]
    pub fn nearest_obstacle(&self, point: Point2) -> Option<(Point2, f32)> {
        let plan = self.plan.as_ref()?;
        let at = Vector::new(point.x_m, point.y_m, 1.0);
        let projection = plan.project_local_point(at, true);
        let nearest = Point2::new(projection.point.x, projection.point.y);
        Some((nearest, if projection.is_inside { 0.0 } else { nearest.distance(point) }))
    }

    /// Distance of a place at a height above the floor from the nearest part, metres; 0 inside one. `None` in an empty
    /// world.
    #[must_use]
    pub fn distance_at(&self, place: Point2, height_m: f32) -> Option<f32> {
        let at = Vector::new(place.x_m, place.y_m, height_m);
        Some(self.parts.as_ref()?.distance_to_local_point(at, true))
    }

    /// Lower left and upper right corner of every obstacle, seen from above.
    #[must_use]
    pub fn bounds(&self) -> Option<[Point2; 2]> {
        let around = self.plan.as_ref()?.local_aabb();
        Some([Point2::new(around.mins.x, around.mins.y), Point2::new(around.maxs.x, around.maxs.y)])
    }

    /// Everything that stands looks the same at both heights above the floor, metres: a level beam meets the same
    /// objects.
    #[must_use]
    pub fn is_same_at_heights(&self, one_m: f32, other_m: f32) -> bool {
        let parts = self.parts.iter().flat_map(|parts| parts.shapes());
        parts.into_iter().all(|(pose, shape)| {
            let around = shape.compute_aabb(pose);
            let reaches = |height_m: f32| (around.mins.z..=around.maxs.z).contains(&height_m);
            let upright = (pose.rotation * Vector::Z).z > UPRIGHT_COSINE;
            if upright { reaches(one_m) == reaches(other_m) } else { !reaches(one_m) && !reaches(other_m) }
        })
    }

    /// Number of parts.
    #[must_use]
    pub fn parts(&self) -> usize {
        self.truth.len()
    }
}

fn floor_range(origin: Vector, direction: Vector) -> Option<f32> {
    (direction.z < -1.0e-4).then(|| -origin.z / direction.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneBuilder;

    fn room(material: Material) -> Scene {
        let mut builder = SceneBuilder::default();
        builder.wall([2.0, -3.0], [2.0, 3.0], 2.0, material);
        builder.wall([5.0, -9.0], [5.0, 9.0], 2.0, Material::Matte);
        builder.build()
    }

    fn range(scene: &Scene, direction: Vector) -> Option<f32> {
        scene.cast(Vector::new(0.0, 0.0, 1.0), direction.normalize(), 50.0).map(|hit| hit.range_m)
    }

    #[test]
    fn beam_ends_at_wall_face_and_floor() {
        let scene = room(Material::Matte);
        assert!((range(&scene, Vector::X).unwrap() - 1.95).abs() < 1e-4);
        let down = range(&scene, Vector::new(1.0, 0.0, -1.0)).unwrap();
        assert!((down - std::f32::consts::SQRT_2).abs() < 1e-4);
        assert_eq!(range(&scene, -Vector::X), None);
    }

    #[test]
    fn glass_is_seen_at_right_angles_only() {
        let scene = room(Material::Glass);
        assert!((range(&scene, Vector::X).unwrap() - 1.95).abs() < 1e-4);
        let oblique = range(&scene, Vector::new(1.0, 0.5, 0.0)).unwrap();
        assert!((oblique - 4.95 * libm::sqrtf(1.25)).abs() < 1e-3, "{oblique}");
    }

    #[test]
    fn equal_heights_unless_objects_end_or_lean() {
        let mut builder = SceneBuilder::default();
        builder.wall([2.0, -3.0], [2.0, 3.0], 2.0, Material::Matte);
        builder.cuboid((5.0, 0.0, 0.3), (1.0, 1.0), (0.6, 0.7), Material::Matte);
        let scene = builder.build();
        assert!(scene.is_same_at_heights(0.15, 0.4) && scene.is_same_at_heights(0.15, 0.75));
        assert!(!scene.is_same_at_heights(0.15, 0.65) && !scene.is_same_at_heights(0.15, 2.5));
        let mut builder = SceneBuilder::default();
        builder.ramp((3.0, 0.0, 0.0), (4.0, 1.0), 0.5);
        let scene = builder.build();
        assert!(!scene.is_same_at_heights(0.15, 0.3) && scene.is_same_at_heights(0.8, 1.2));
    }

    #[test]
    fn linear_search_equals_the_hierarchy() {
        // The same corner of a room, once alone and once with so much far behind it that the hierarchy is asked.
        let corner = |far: usize| {
            let mut builder = SceneBuilder::default();
            builder.wall([2.0, -3.0], [2.0, 3.0], 2.0, Material::Matte);
            builder.wall([-3.0, 2.5], [3.0, 2.0], 1.5, Material::Matte);
            builder.cuboid((1.2, 0.4, 0.5), (0.3, 0.4), (0.2, 1.3), Material::Matte);
            (0..far).for_each(|at| {
                builder.cuboid((60.0 + at as f32, 60.0, 0.0), (0.1, 0.1), (0.0, 1.0), Material::Matte)
            });
            builder.build()
        };
        let (few, many) = (corner(0), corner(FEW));
        let mut met = 0;
        for step in 0..2_000_u16 {
            let (bearing, rise) = (f32::from(step) * 0.0063, f32::from(step % 31) * 0.02 - 0.3);
            let direction = Vector::new(libm::cosf(bearing), libm::sinf(bearing), rise);
            let seen = range(&few, direction);
            met += usize::from(seen.is_some());
            assert_eq!(seen, range(&many, direction), "{step}");
        }
        assert!((200..1_900).contains(&met), "{met}");
    }

    #[test]
    fn a_mirror_shows_what_is_behind_the_sensor() {
        let mut builder = SceneBuilder::default();
        builder.wall([2.0, -3.0], [2.0, 3.0], 2.0, Material::Mirror);
        builder.wall([-4.0, -9.0], [-4.0, 9.0], 2.0, Material::Matte);
        let seen = range(&builder.build(), Vector::X).unwrap();
        assert!((seen - (1.95 + 1.95 + 3.95)).abs() < 1e-2, "{seen}");
    }
}
