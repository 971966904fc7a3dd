//! Clouds as PLY (Turk 1994) and PCD files (version 0.7 of the Point Cloud Library), both binary, little-endian.

use super::cloud::CloudPoint;

/// What the colour of a point shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colour {
    /// Low blue, high red.
    Height,
    /// Early blue, late red.
    Time,
    /// Dark grey to white.
    Reflectivity,
}

/// The colour of each point, red, green and blue: what the points themselves say.
#[must_use]
pub fn colours_of(points: &[CloudPoint], colour: Colour) -> Vec<[u8; 3]> {
    let range = Range::of(points, colour);
    points.iter().map(|point| range.colour(point)).collect()
}

/// PLY: x, y, z, colour, reflectivity and time. `colours` are those of the points; a point without one is black.
#[must_use]
pub fn ply(points: &[CloudPoint], colours: &[[u8; 3]]) -> Vec<u8> {
    let header = format!(
        "ply\nformat binary_little_endian 1.0\ncomment metres, x forward, y left, z up\nelement vertex {}\n\
         property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n\
         property uchar blue\nproperty float reflectivity\nproperty float time\nend_header\n",
        points.len()
    );
    let mut bytes = header.into_bytes();
    for (index, point) in points.iter().enumerate() {
        bytes.extend(point.place_m.iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend(colours.get(index).copied().unwrap_or_default());
        bytes.extend(point.reflectivity.to_le_bytes());
        bytes.extend(point.time_s.to_le_bytes());
    }
    bytes
}

/// PCD: x, y, z, intensity (the reflectivity) and time.
#[must_use]
pub fn pcd(points: &[CloudPoint]) -> Vec<u8> {
    let count = points.len();
    let header = format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity time\nSIZE 4 4 4 4 4\n\
         TYPE F F F F F\nCOUNT 1 1 1 1 1\nWIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA binary\n"
    );
    let mut bytes = header.into_bytes();
    for point in points {
        let [x, y, z] = point.place_m.into();
        bytes
            .extend([x, y, z, point.reflectivity, point.time_s].iter().flat_map(|value| value.to_le_bytes()));
    }
    bytes
}

/// The values that the two ends of the scale of colours stand for.
struct Range {
    shown: fn(&CloudPoint) -> f32,
    low: f32,
    high: f32,
    grey: bool,
}

impl Range {
    /// Without the highest and lowest hundredth, so that single points do not pale all others.
    fn of(points: &[CloudPoint], colour: Colour) -> Self {
        let shown: fn(&CloudPoint) -> f32 = match colour {
            Colour::Height => |point| point.place_m.z,
            Colour::Time => |point| point.time_s,
            Colour::Reflectivity => |point| point.reflectivity,
        };
        let mut values: Vec<f32> = points.iter().map(shown).collect();
        values.sort_unstable_by(f32::total_cmp);
        let at = |share: usize| values.get(values.len() * share / 100).copied().unwrap_or(0.0);
        Self { shown, low: at(1), high: at(99), grey: colour == Colour::Reflectivity }
    }

    fn colour(&self, point: &CloudPoint) -> [u8; 3] {
        let share = ((self.shown)(point) - self.low) / (self.high - self.low).max(1.0e-6);
        let share = share.clamp(0.0, 1.0);
        let byte = |value: f32| (255.0 * value.clamp(0.0, 1.0)) as u8;
        if self.grey {
            return [byte(0.2 + 0.8 * share); 3];
        }
        // Blue, cyan, green, yellow, red.
        let part = |middle: f32| byte(1.5 - (4.0 * share - middle).abs());
        [part(3.0), part(2.0), part(1.0)]
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    fn points() -> Vec<CloudPoint> {
        let one = |z: f32| CloudPoint {
            place_m: Vector3::new(1.0, -2.0, z),
            reflectivity: 7.0,
            time_s: 0.5,
            count: 3,
        };
        vec![one(0.0), one(1.0), one(2.0)]
    }

    #[test]
    fn ply_has_23_bytes_a_point() {
        let bytes = ply(&points(), &colours_of(&points(), Colour::Height));
        let end = bytes.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
        assert_eq!(bytes.len() - end, 3 * 23);
        assert_eq!(bytes[end..end + 4], 1.0_f32.to_le_bytes());
        // The lowest is blue, the highest red.
        assert!(bytes[end + 14] > bytes[end + 12]);
        let last = end + 2 * 23;
        assert!(bytes[last + 12] > bytes[last + 14]);
    }

    #[test]
    fn pcd_has_20_bytes_a_point() {
        let bytes = pcd(&points());
        let end = bytes.windows(12).position(|window| window == b"DATA binary\n").unwrap() + 12;
        assert_eq!(bytes.len() - end, 3 * 20);
        assert_eq!(bytes[end + 12..end + 16], 7.0_f32.to_le_bytes());
        assert!(String::from_utf8_lossy(&bytes[..end]).contains("POINTS 3\n"));
    }
}
