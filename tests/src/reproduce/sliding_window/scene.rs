//! A world of boxes and upright cylinders, and rays through it. Its own mathematics, in double precision.

/// A place or a direction, metres: forward, left, up.
pub type Vector = [f64; 3];

/// A body with a surface.
#[derive(Clone, Copy, Debug)]
pub enum Solid {
    /// Between two corners.
    Box {
        /// Smallest coordinates.
        low: Vector,
        /// Largest coordinates.
        high: Vector,
    },
    /// Upright, on the floor or above it.
    Cylinder {
        /// Middle, metres.
        middle: [f64; 2],
        /// Metres.
        radius: f64,
        /// Lower and upper end, metres.
        heights: [f64; 2],
    },
}

/// Somebody who walks in a straight line.
#[derive(Clone, Copy, Debug)]
pub struct Walker {
    /// Where at time 0.
    pub start: [f64; 2],
    /// Metres per second.
    pub velocity: [f64; 2],
}

impl Walker {
    /// Radius and height of the body, metres.
    pub const RADIUS: f64 = 0.2;
    /// See [`Self::RADIUS`].
    pub const HEIGHT: f64 = 1.7;

    /// Where at a time in seconds.
    #[must_use]
    pub fn at(&self, seconds: f64) -> [f64; 2] {
        [self.start[0] + self.velocity[0] * seconds, self.start[1] + self.velocity[1] * seconds]
    }
}

/// Floor at height 0, bodies, walkers.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// What stands.
    pub solids: Vec<Solid>,
    /// Who walks.
    pub walkers: Vec<Walker>,
}

/// A ray.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// From here.
    pub origin: Vector,
    /// Unit vector.
    pub direction: Vector,
}

impl Solid {
    /// A wall of 0.1 m from the floor to 2.4 m along two axes.
    #[must_use]
    pub fn wall(low: [f64; 2], high: [f64; 2]) -> Self {
        Self::Box { low: [low[0], low[1], 0.0], high: [high[0], high[1], 2.4] }
    }

    /// Distance along a ray to the surface, from outside.
    fn hit(&self, ray: &Ray) -> Option<f64> {
        match *self {
            Self::Box { low, high } => {
                let (mut enters, mut leaves) = (0.0_f64, f64::INFINITY);
                for axis in 0..3 {
                    let (from, along) = (ray.origin[axis], ray.direction[axis]);
                    if along.abs() < 1e-12 {
                        if from < low[axis] || from > high[axis] {
                            return None;
                        }
                        continue;
                    }
                    let (a, b) = ((low[axis] - from) / along, (high[axis] - from) / along);
                    enters = enters.max(a.min(b));
                    leaves = leaves.min(a.max(b));
                }
                (enters <= leaves && enters > 0.0).then_some(enters)
            }
            Self::Cylinder { middle, radius, heights } => hit_cylinder(ray, (middle, radius), heights),
        }
    }

    /// Distance from a point to the surface, metres.
    #[must_use]
    pub fn distance(&self, point: Vector) -> f64 {
        match *self {
            Self::Box { low, high } => {
                let outside: f64 = (0..3)
                    .map(|axis| (low[axis] - point[axis]).max(point[axis] - high[axis]).max(0.0).powi(2))
                    .sum();
                let inside = (0..3)
                    .map(|axis| (point[axis] - low[axis]).min(high[axis] - point[axis]))
                    .fold(f64::INFINITY, f64::min);
                if outside > 0.0 { outside.sqrt() } else { inside }
            }
            Self::Cylinder { middle, radius, heights } => {
                let aside = (point[0] - middle[0]).hypot(point[1] - middle[1]) - radius;
                let above = (heights[0] - point[2]).max(point[2] - heights[1]);
                if aside <= 0.0 && above <= 0.0 {
                    (-aside).min(-above)
                } else {
                    aside.max(0.0).hypot(above.max(0.0))
                }
            }
        }
    }
}

fn hit_cylinder(ray: &Ray, (middle, radius): ([f64; 2], f64), heights: [f64; 2]) -> Option<f64> {
    let (x, y) = (ray.origin[0] - middle[0], ray.origin[1] - middle[1]);
    let (dx, dy) = (ray.direction[0], ray.direction[1]);
    let (a, b, c) = (dx * dx + dy * dy, x * dx + y * dy, x * x + y * y - radius * radius);
    let height = |along: f64| ray.origin[2] + along * ray.direction[2];
    let is_high = |along: f64| (heights[0]..=heights[1]).contains(&height(along));
    let root = b * b - a * c;
    let side = (a > 1e-12 && root >= 0.0).then(|| (-b - root.sqrt()) / a);
    let side = side.filter(|along| *along > 0.0 && is_high(*along));
    let caps = heights.map(|end| (end - ray.origin[2]) / ray.direction[2]);
    let on_cap =
        |along: &f64| *along > 0.0 && along.is_finite() && (x + along * dx).hypot(y + along * dy) <= radius;
    caps.into_iter().filter(on_cap).chain(side).min_by(f64::total_cmp)
}

impl Scene {
    fn solids_at(&self, seconds: f64) -> impl Iterator<Item = Solid> + '_ {
        let body = move |walker: &Walker| Solid::Cylinder {
            middle: walker.at(seconds),
            radius: Walker::RADIUS,
            heights: [0.0, Walker::HEIGHT],
        };
        self.solids.iter().copied().chain(self.walkers.iter().map(body))
    }

    /// Distance to what a ray meets first at a time in seconds.
    #[must_use]
    pub fn cast(&self, ray: &Ray, seconds: f64) -> Option<f64> {
        let floor = (ray.direction[2] < 0.0).then(|| -ray.origin[2] / ray.direction[2]);
        self.solids_at(seconds).filter_map(|solid| solid.hit(ray)).chain(floor).min_by(f64::total_cmp)
    }

    /// Distance from a point to the nearest surface of what stands, or to the floor.
    #[must_use]
    pub fn distance(&self, point: Vector) -> f64 {
        self.solids.iter().map(|solid| solid.distance(point)).fold(point[2].abs(), f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_meet_what_a_drawing_says() {
        let low = [1.0, -0.2, 0.1];
        let scene = Scene {
            solids: vec![Solid::Box { low, high: [1.4, 0.2, 0.5] }],
            walkers: vec![Walker { start: [0.0, 3.0], velocity: [0.5, 0.0] }],
        };
        let cast = |origin: Vector, direction: Vector, seconds: f64| {
            let length = direction.iter().map(|value| value * value).sum::<f64>().sqrt();
            scene.cast(&Ray { origin, direction: direction.map(|value| value / length) }, seconds)
        };
        assert_eq!(cast([0.0, 0.0, 0.3], [1.0, 0.0, 0.0], 0.0), Some(1.0));
        assert_eq!(cast([0.0, 0.0, 0.6], [1.0, 0.0, 0.0], 0.0), None);
        // The top of the box, 0.07 m below and 1.2 m ahead.
        let top = cast([0.0, 0.0, 0.57], [1.2, 0.0, -0.07], 0.0).unwrap();
        assert!((top - 1.2_f64.hypot(0.07)).abs() < 1e-9);
        let floor = cast([0.0, 0.0, 0.57], [-1.0, 0.0, -0.57], 0.0).unwrap();
        assert!((floor - 1.0_f64.hypot(0.57)).abs() < 1e-9);
        assert!((cast([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], 0.0).unwrap() - 2.8).abs() < 1e-9);
        assert_eq!(cast([0.0, 0.0, 1.0], [0.0, 1.0, 0.0], 1.0), None, "he walked on");
        assert!((scene.distance([0.9, 0.0, 0.3]) - 0.1).abs() < 1e-9);
        assert!((scene.distance([1.1, 0.0, 0.3]) - 0.1).abs() < 1e-9);
        assert_eq!(scene.distance([3.0, 0.0, 0.02]), 0.02);
    }
}
