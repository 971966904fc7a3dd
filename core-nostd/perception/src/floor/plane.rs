//! A plane under the camera, and heights above it.

/// Points `p` with `normal · p + distance = 0`, in the camera frame (x right, y down, z forward).
/// Invariants: the normal has unit length and points up, to the camera's side; `distance_m` > 0 is the height of
/// the camera above the plane.
///
/// ```
/// use floorguard_perception::floor::Plane;
///
/// // A camera 0.9 m above the floor that looks 40° down.
/// let floor = Plane::of_mounting(0.9, 40.0_f32.to_radians()).unwrap();
/// assert_eq!(floor.height_m([0.0, 0.0, 0.0]), 0.9);
/// // Where the optical axis meets the floor.
/// let depth_m = 0.9 / 40.0_f32.to_radians().sin();
/// assert!(floor.height_m([0.0, 0.0, depth_m]).abs() < 1.0e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Unit vector that points up.
    pub normal: [f32; 3],
    /// Height of the camera, metres.
    pub distance_m: f32,
}

/// Scalar product.
#[inline]
#[must_use]
pub fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    let ([ax, ay, az], [bx, by, bz]) = (a, b);
    ax * bx + ay * by + az * bz
}

/// Vector product.
#[must_use]
pub fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    let ([ax, ay, az], [bx, by, bz]) = (a, b);
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

/// The vector with length one; `None` for one that is shorter than 10⁻⁶ or not finite.
#[must_use]
pub fn unit(vector: [f32; 3]) -> Option<[f32; 3]> {
    let length = libm::sqrtf(dot(vector, vector));
    let usable = length.is_finite() && length > 1.0e-6;
    usable.then(|| vector.map(|value| value / length))
}

impl Plane {
    /// From a normal of any length that points up and the height of the camera; `None` where either is degenerate.
    #[must_use]
    pub fn new(up: [f32; 3], distance_m: f32) -> Option<Self> {
        let normal = unit(up)?;
        let above = distance_m.is_finite() && distance_m > 0.0;
        above.then_some(Self { normal, distance_m })
    }

    /// The plane through three points, seen from the camera; `None` where they lie on a line or the camera in the plane.
    #[must_use]
    pub fn through(points: [[f32; 3]; 3]) -> Option<Self> {
        let [a, b, c] = points;
        let minus = |p: [f32; 3], q: [f32; 3]| {
            let ([px, py, pz], [qx, qy, qz]) = (p, q);
            [px - qx, py - qy, pz - qz]
        };
        let normal = unit(cross(minus(b, a), minus(c, a)))?;
        let distance_m = -dot(normal, a);
        if distance_m >= 0.0 {
            Self::new(normal, distance_m)
        } else {
            Self::new(normal.map(|value| -value), -distance_m)
        }
    }

    /// A camera that looks down by `pitch_rad` from `height_m` above a level floor, without roll.
    #[must_use]
    pub fn of_mounting(height_m: f32, pitch_rad: f32) -> Option<Self> {
        let (sin, cos) = libm::sincosf(pitch_rad);
        Self::new([0.0, -cos, -sin], height_m)
    }

    /// Height of a point above the plane, metres, negative below.
    #[inline]
    #[must_use]
    pub fn height_m(&self, point: [f32; 3]) -> f32 {
        dot(self.normal, point) + self.distance_m
    }

    /// Angle between the normals, radians.
    #[must_use]
    pub fn tilt_from_rad(&self, other: &Self) -> f32 {
        // The arc cosine of a product near one loses half of its digits; the arc sine does not.
        let [x, y, z] = cross(self.normal, other.normal);
        libm::atan2f(libm::sqrtf(x * x + y * y + z * z), dot(self.normal, other.normal))
    }

    /// Two unit vectors within the plane: across the view and along it. They are the axes of footprints.
    #[must_use]
    pub fn axes(&self) -> [[f32; 3]; 2] {
        // Forward is the optical axis without what leaves the plane; a camera that looks straight down has none, and
        // there the image's upward direction serves.
        let [_, _, z] = self.normal;
        let forward = self.normal.map(|value| -value * z);
        let [fx, fy, fz] = forward;
        let along = unit([fx, fy, fz + 1.0]).filter(|_| z.abs() < 0.999).or_else(|| {
            let [_, y, _] = self.normal;
            let [ux, uy, uz] = self.normal.map(|value| value * y);
            unit([ux, uy - 1.0, uz])
        });
        let along = along.unwrap_or([0.0, 0.0, 1.0]);
        [cross(along, self.normal), along]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_those_of_the_mounting() {
        let plane = Plane::of_mounting(0.8, 0.6).unwrap();
        // Straight ahead along the optical axis the floor lies 0.8 m / sin 0.6 away.
        let on_floor = [0.0, 0.0, 0.8 / libm::sinf(0.6)];
        assert!(plane.height_m(on_floor).abs() < 1e-6);
        assert!((plane.height_m([0.0, 0.0, 0.0]) - 0.8).abs() < 1e-6);
    }

    #[test]
    fn axes_span_the_plane_with_right_and_forward() {
        for pitch in [0.05_f32, 0.6, 1.2, core::f32::consts::FRAC_PI_2] {
            let plane = Plane::of_mounting(0.8, pitch).unwrap();
            let [right, along] = plane.axes();
            assert!(dot(right, plane.normal).abs() < 1e-5 && dot(along, plane.normal).abs() < 1e-5);
            assert!(right[0] > 0.999, "{right:?}");
            assert!((dot(along, along) - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn degenerate_points_make_no_plane() {
        assert_eq!(Plane::through([[0.0, 1.0, 1.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]]), None);
        assert_eq!(Plane::new([0.0, f32::NAN, 0.0], 1.0), None);
        let plane = Plane::through([[0.0, 1.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 2.0]]).unwrap();
        assert_eq!(plane.normal, [0.0, -1.0, 0.0]);
        assert_eq!(plane.distance_m, 1.0);
    }
}
