//! Clouds of a drive as LAS files: place, reflectivity, colour, time.

use super::cloud::CloudPoint;
use crate::output::LasPoint;

/// A cloud that cannot be a LAS file: a point farther than 2,000 km away.
#[derive(Debug, thiserror::Error)]
#[error("the cloud cannot be written as LAS: {0}")]
pub struct LasError(#[from] las::Error);

/// LAS: place, intensity (the reflectivity in 16 bits), colour, and the time since the first sweep as GPS time. Without a date:
/// the same points give the same bytes. `colours` are those of the points; a point without one is black.
///
/// # Errors
/// See [`LasError`].
pub fn las(points: &[CloudPoint], colours: &[[u8; 3]]) -> Result<Vec<u8>, LasError> {
    Ok(crate::output::las(points.iter().enumerate().map(|(index, point)| LasPoint {
        place_m: point.place_m.map(f64::from).into(),
        intensity: (point.reflectivity * 257.0) as u16,
        time_s: f64::from(point.time_s),
        colour: Some(colours.get(index).copied().unwrap_or_default()),
    }))?)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn header_and_points_are_where_the_standard_says() {
        let point = |x: f32, z: f32| CloudPoint {
            place_m: Vector3::new(x, -2.0, z),
            reflectivity: 7.0,
            time_s: 0.5,
            count: 3,
        };
        let cloud = [point(1.25, 0.0), point(3.0, 1.0), point(-4.5, 2.0)];
        let colours = [[1, 2, 3]; 3];
        let bytes = las(&cloud, &colours).unwrap();
        // ASPRS LAS 1.2, table 1: signature, version, offset to the points, format, length, count, scale.
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        let double = |at: usize| f64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
        assert_eq!((&bytes[..4], &bytes[24..26]), (&b"LASF"[..], &[1, 2][..]));
        let (first, length) = (word(96) as usize, usize::from(bytes[105]) + 256 * usize::from(bytes[106]));
        assert_eq!((bytes[104], length, word(107)), (3, 34, 3));
        assert_eq!((double(131), double(155)), (0.001, 0.0));
        assert_eq!((double(179), double(187)), (3.0, -4.5), "largest and smallest x");
        // Table 8: x, y, z in millimetres, intensity, GPS time at 20, colour at 28.
        let at = first + length;
        assert_eq!([word(at), word(at + 4), word(at + 8)], [3_000, (-2_000_i32) as u32, 1_000]);
        assert_eq!((u16::from_le_bytes([bytes[at + 12], bytes[at + 13]]), double(at + 20)), (7 * 257, 0.5));
        assert_eq!(
            [28, 30, 32].map(|red| bytes[at + red]),
            [1, 2, 3],
            "a colour is an octet of 16 bits twice"
        );
        assert_eq!(bytes.len(), first + 3 * length);
        assert_eq!(bytes, las(&cloud, &colours).unwrap());
    }
}
