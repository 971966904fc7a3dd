//! Point clouds for other people's viewers: PLY and PCD, both binary and little-endian.

use floorguard_types::geometry::Point3;

/// A cloud as PLY 1.0 (Turk 1994): `x`, `y`, `z` as floats of 32 bits, metres.
///
/// ```
/// use floorguard_mapping_host::output::cloud_ply;
/// use floorguard_types::geometry::Point3;
///
/// let bytes = cloud_ply(&[Point3::new(1.0, 2.0, 3.0)]);
/// let header = bytes.len() - 12;
/// assert!(bytes[..header].starts_with(b"ply\nformat binary_little_endian 1.0\nelement vertex 1\n"));
/// assert_eq!(bytes[header..header + 4], 1.0_f32.to_le_bytes());
/// ```
#[must_use]
pub fn cloud_ply(points: &[Point3]) -> Vec<u8> {
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
        points.len()
    );
    with_points(header, points)
}

/// A cloud as PCD 0.7, the format of the Point Cloud Library (Rusu and Cousins 2011).
///
/// ```
/// use floorguard_mapping_host::output::cloud_pcd;
/// use floorguard_types::geometry::Point3;
///
/// let bytes = cloud_pcd(&[Point3::new(1.0, 2.0, 3.0); 2]);
/// let text = String::from_utf8_lossy(&bytes[..bytes.len() - 24]);
/// assert!(text.contains("POINTS 2\n") && text.ends_with("DATA binary\n"));
/// ```
#[must_use]
pub fn cloud_pcd(points: &[Point3]) -> Vec<u8> {
    let count = points.len();
    let header = format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n\
         WIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA binary\n"
    );
    with_points(header, points)
}

fn with_points(header: String, points: &[Point3]) -> Vec<u8> {
    let mut bytes = header.into_bytes();
    bytes.reserve(points.len() * 12);
    for point in points {
        for value in [point.x_m, point.y_m, point.z_m] {
            bytes.extend_from_slice(&value.to_le_bytes());
        }
    }
    bytes
}
