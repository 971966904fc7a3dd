//! Our measurements and results as ROS 2 messages.

use floorguard_types::geometry::{Point2, Pose2, Transform3, Twist2};
use floorguard_types::sensing::{BeamReturn, ImuSample, Scan};
use floorguard_types::time::Stamp;

use super::cdr::Encoder;

/// One point of a cloud, in the frame that the message names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointRow {
    /// x, y, z in metres.
    pub position_m: [f32; 3],
    /// Calibrated reflectivity, 0…255.
    pub reflectivity: u8,
    /// Laser ring, 0 lowest.
    pub ring: u16,
    /// Seconds after the stamp of the cloud.
    pub time_s: f32,
}

/// How bad a diagnostic is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Severity {
    /// Healthy.
    Good = 0,
    /// Limits the robot.
    Warning = 1,
    /// Stops the robot.
    Error = 2,
    /// Says nothing any more.
    Stale = 3,
}

/// One source's health or one cause of a stop.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// How bad.
    pub severity: Severity,
    /// Source or cause.
    pub name: String,
    /// In plain words.
    pub message: String,
    /// Value, limit, age and the like.
    pub values: Vec<(String, String)>,
}

/// What a marker looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum MarkerShape {
    /// From the position along the heading.
    Arrow = 0,
    /// Upright.
    Cylinder = 3,
    /// Along the points; the size along x is its width.
    LineStrip = 4,
    /// Words that face the viewer.
    Text = 9,
}

/// Something drawn in the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// Group that the viewer can switch off.
    pub group: &'static str,
    /// Number within the group.
    pub id: i32,
    /// Form.
    pub shape: MarkerShape,
    /// Where, and in which direction.
    pub pose: Pose2,
    /// Size along x, y, z, metres.
    pub size_m: [f64; 3],
    /// Red, green, blue, opacity, 0…1.
    pub color: [f32; 4],
    /// Words of a text marker.
    pub text: String,
    /// Corners of a line, in the frame of the pose.
    pub points: Vec<Point2>,
}

/// A map to be written: row by row from the origin; −1 unknown, 0 free … 100 occupied.
pub struct GridImage<'a> {
    /// Edge of a cell, metres.
    pub resolution_m: f32,
    /// Cells per row.
    pub width: u32,
    /// Pose of the lower left corner.
    pub origin: Pose2,
    /// The cells.
    pub cells: &'a [i8],
}

/// Offsets of the fields of one point: name, offset, type (7 = float32, 4 = uint16), in 20 bytes.
const POINT_FIELDS: [(&str, u32, u8); 6] =
    [("x", 0, 7), ("y", 4, 7), ("z", 8, 7), ("intensity", 12, 7), ("time", 16, 7), ("ring", 20, 4)];
const POINT_BYTES: u32 = 22;

/// How messages are written, by MCAP's name for it.
pub const ENCODING: &str = "cdr";

/// `std_msgs/msg/UInt8MultiArray`: bytes, without dimensions.
pub fn octets(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = Encoder::new();
    encoder.length(0).u32(0).octets(bytes);
    encoder.finish()
}

/// The bytes of a message that [`octets`] made.
pub fn octets_of(message: &[u8]) -> Option<&[u8]> {
    const FRONT: [u8; 12] = [0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    let (length, bytes) = message.strip_prefix(&FRONT)?.split_first_chunk::<4>()?;
    bytes.get(..usize::try_from(u32::from_le_bytes(*length)).ok()?)
}

/// `std_msgs/msg/Float32`.
pub fn number(value: f32) -> Vec<u8> {
    let mut encoder = Encoder::new();
    encoder.f32(value);
    encoder.finish()
}

/// `std_msgs/msg/String`.
pub fn text(text: &str) -> Vec<u8> {
    let mut encoder = Encoder::new();
    encoder.text(text);
    encoder.finish()
}

/// `geometry_msgs/msg/TwistStamped` in the robot's frame.
pub fn twist(stamp: Stamp, twist: Twist2) -> Vec<u8> {
    let mut encoder = Encoder::new();
    header(&mut encoder, stamp, "base_link");
    encoder.f64s(&[f64::from(twist.linear_mps), 0.0, 0.0, 0.0, 0.0, f64::from(twist.angular_radps)]);
    encoder.finish()
}

pub(super) fn header(encoder: &mut Encoder, stamp: Stamp, frame: &str) {
    encoder.time(stamp).text(frame);
}

pub(super) fn quaternion_about_z(encoder: &mut Encoder, heading_rad: f32) {
    let half = f64::from(heading_rad) / 2.0;
    encoder.f64s(&[0.0, 0.0, libm::sin(half), libm::cos(half)]);
}

fn pose(encoder: &mut Encoder, pose: Pose2) {
    encoder.f64s(&[f64::from(pose.x_m), f64::from(pose.y_m), 0.0]);
    quaternion_about_z(encoder, pose.heading_rad);
}

/// `sensor_msgs/msg/PointCloud2`, unordered.
pub fn point_cloud(stamp: Stamp, frame: &str, points: &[PointRow]) -> Vec<u8> {
    let mut encoder = Encoder::new();
    header(&mut encoder, stamp, frame);
    let count = u32::try_from(points.len()).unwrap_or(u32::MAX);
    encoder.u32(1).u32(count).length(POINT_FIELDS.len());
    for (name, offset, datatype) in POINT_FIELDS {
        encoder.text(name).u32(offset).u8(datatype).u32(1);
    }
    let mut data = Vec::with_capacity(points.len() * POINT_BYTES as usize);
    for point in points {
        point.position_m.iter().for_each(|value| data.extend(value.to_le_bytes()));
        data.extend(f32::from(point.reflectivity).to_le_bytes());
        data.extend(point.time_s.to_le_bytes());
        data.extend(point.ring.to_le_bytes());
    }
    encoder.u8(0).u32(POINT_BYTES).u32(count.saturating_mul(POINT_BYTES)).octets(&data).u8(1);
    encoder.finish()
}

/// `sensor_msgs/msg/LaserScan`, with the stamp of its first beam. A beam that is free to the device's range is +∞, an unknown one NaN
/// (REP 117).
pub fn laser_scan(scan: &Scan, turn_s: f32, frame: &str) -> Vec<u8> {
    let mut encoder = Encoder::new();
    let last = scan.beams.len().saturating_sub(1) as f32;
    // The mirror turns once a scan, evenly: a beam comes a step of the circle after the one before.
    let beam_s = turn_s * scan.step_rad / (2.0 * std::f32::consts::PI);
    header(&mut encoder, scan.stamp.minus_micros((0.5e6 * last * beam_s) as u64), frame);
    encoder.f32(scan.first_angle_rad).f32(scan.first_angle_rad + last * scan.step_rad).f32(scan.step_rad);
    encoder.f32(beam_s).f32(turn_s).f32(0.0).f32(65.0).length(scan.beams.len());
    for beam in &scan.beams {
        encoder.f32(match beam {
            BeamReturn::Hit(range_mm) => f32::from(*range_mm) / 1_000.0,
            BeamReturn::Free(_) => f32::INFINITY,
            BeamReturn::Unknown => f32::NAN,
        });
    }
    encoder.length(0);
    encoder.finish()
}

/// `sensor_msgs/msg/Imu`. Without an orientation its covariance starts with −1, as the interface says.
pub fn imu(sample: &ImuSample, frame: &str) -> Vec<u8> {
    let mut encoder = Encoder::new();
    header(&mut encoder, sample.stamp, frame);
    let [w, x, y, z] = sample.orientation.unwrap_or([1.0, 0.0, 0.0, 0.0]).map(f64::from);
    let mut covariance = [0.0; 9];
    covariance[0] = if sample.orientation.is_some() { 0.0 } else { -1.0 };
    encoder.f64s(&[x, y, z, w]).f64s(&covariance);
    encoder.f64s(&sample.angular_radps.map(f64::from)).f64s(&[0.0; 9]);
    encoder.f64s(&sample.linear_mps2.map(f64::from)).f64s(&[0.0; 9]);
    encoder.finish()
}

/// `nav_msgs/msg/Odometry`; `covariance` is that of x, y and heading, row by row.
pub fn odometry(stamp: Stamp, at: Pose2, twist: Twist2, covariance: &[[f32; 3]; 3]) -> Vec<u8> {
    odometry_in(("odom", "base_link"), stamp, (at, twist), covariance)
}

/// The same of a child frame in another frame.
pub fn odometry_in(
    (parent, child): (&str, &str),
    stamp: Stamp,
    (at, twist): (Pose2, Twist2),
    covariance: &[[f32; 3]; 3],
) -> Vec<u8> {
    /// Where x, y and the rotation about z stand in the 6 × 6 matrix of ROS.
    const ROWS: [usize; 3] = [0, 1, 5];
    let mut encoder = Encoder::new();
    header(&mut encoder, stamp, parent);
    encoder.text(child);
    pose(&mut encoder, at);
    let mut wide = [0.0; 36];
    for (row, values) in ROWS.into_iter().zip(covariance) {
        for (column, value) in ROWS.into_iter().zip(values) {
            wide[row * 6 + column] = f64::from(*value);
        }
    }
    encoder.f64s(&wide);
    encoder.f64s(&[f64::from(twist.linear_mps), 0.0, 0.0, 0.0, 0.0, f64::from(twist.angular_radps)]);
    // Nothing estimates the speed's: zeros would call it exact.
    let mut of_twist = [0.0; 36];
    of_twist[0] = -1.0;
    encoder.f64s(&of_twist);
    encoder.finish()
}

/// `nav_msgs/msg/OccupancyGrid`.
pub fn occupancy_grid(stamp: Stamp, frame: &str, grid: &GridImage) -> Vec<u8> {
    let mut encoder = Encoder::new();
    header(&mut encoder, stamp, frame);
    encoder.time(stamp);
    let height = grid.cells.len() as u32 / grid.width.max(1);
    encoder.f32(grid.resolution_m).u32(grid.width).u32(height);
    pose(&mut encoder, grid.origin);
    let bytes: Vec<u8> = grid.cells.iter().map(|cell| cell.cast_unsigned()).collect();
    encoder.octets(&bytes);
    encoder.finish()
}

/// `nav_msgs/msg/Path`.
pub fn path(stamp: Stamp, frame: &str, poses: &[Pose2]) -> Vec<u8> {
    let mut encoder = Encoder::new();
    header(&mut encoder, stamp, frame);
    encoder.length(poses.len());
    for at in poses {
        header(&mut encoder, stamp, frame);
        pose(&mut encoder, *at);
    }
    encoder.finish()
}

/// `tf2_msgs/msg/TFMessage` with one mounting (`parent` → `child`).
pub fn mounting(stamp: Stamp, parent: &str, child: &str, transform: &Transform3) -> Vec<u8> {
    let mut encoder = Encoder::new();
    encoder.length(1);
    header(&mut encoder, stamp, parent);
    encoder.text(child);
    let origin = transform.translation;
    encoder.f64s(&[f64::from(origin.x_m), f64::from(origin.y_m), f64::from(origin.z_m)]);
    encoder.f64s(&quaternion(&transform.rotation));
    encoder.finish()
}

/// `tf2_msgs/msg/TFMessage` with the pose of `child` on the plane of `parent`.
pub fn flat_frame(stamp: Stamp, (parent, child): (&str, &str), at: Pose2) -> Vec<u8> {
    let mut encoder = Encoder::new();
    encoder.length(1);
    header(&mut encoder, stamp, parent);
    encoder.text(child);
    encoder.f64s(&[f64::from(at.x_m), f64::from(at.y_m), 0.0]);
    quaternion_about_z(&mut encoder, at.heading_rad);
    encoder.finish()
}

/// x, y, z, w of a rotation matrix; the largest of the four roots keeps the division safe (Shepperd 1978).
fn quaternion(rotation: &[[f32; 3]; 3]) -> [f64; 4] {
    let m = rotation.map(|row| row.map(f64::from));
    let squares = [
        1.0 + m[0][0] - m[1][1] - m[2][2],
        1.0 - m[0][0] + m[1][1] - m[2][2],
        1.0 - m[0][0] - m[1][1] + m[2][2],
        1.0 + m[0][0] + m[1][1] + m[2][2],
    ];
    let largest = (0..4).fold(0, |best, index| if squares[index] > squares[best] { index } else { best });
    let root = libm::sqrt(squares[largest]);
    let scaled = |value: f64| value / (2.0 * root);
    let (yz, zx, xy) = (m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]);
    match largest {
        0 => [root / 2.0, scaled(m[1][0] + m[0][1]), scaled(m[0][2] + m[2][0]), scaled(yz)],
        1 => [scaled(m[1][0] + m[0][1]), root / 2.0, scaled(m[2][1] + m[1][2]), scaled(zx)],
        2 => [scaled(m[0][2] + m[2][0]), scaled(m[2][1] + m[1][2]), root / 2.0, scaled(xy)],
        _ => [scaled(yz), scaled(zx), scaled(xy), root / 2.0],
    }
}

/// `visualization_msgs/msg/MarkerArray`; everything drawn before is cleared first.
pub fn markers(stamp: Stamp, frame: &str, drawn: &[Marker]) -> Vec<u8> {
    let clear = Marker {
        group: "",
        id: 0,
        shape: MarkerShape::Arrow,
        pose: Pose2::default(),
        size_m: [0.0; 3],
        color: [0.0; 4],
        text: String::new(),
        points: Vec::new(),
    };
    let mut encoder = Encoder::new();
    encoder.length(drawn.len() + 1);
    marker(&mut encoder, stamp, frame, &clear, 3);
    drawn.iter().for_each(|each| marker(&mut encoder, stamp, frame, each, 0));
    encoder.finish()
}

fn marker(encoder: &mut Encoder, stamp: Stamp, frame: &str, drawn: &Marker, action: i32) {
    header(encoder, stamp, frame);
    encoder.text(drawn.group).i32(drawn.id).i32(drawn.shape as i32).i32(action);
    encoder.f64s(&[f64::from(drawn.pose.x_m), f64::from(drawn.pose.y_m), drawn.size_m[2] / 2.0]);
    quaternion_about_z(encoder, drawn.pose.heading_rad);
    encoder.f64s(&drawn.size_m);
    drawn.color.iter().for_each(|channel| _ = encoder.f32(*channel));
    // lifetime, not locked
    encoder.i32(0).u32(0).u8(0).length(drawn.points.len());
    for point in &drawn.points {
        encoder.f64s(&[f64::from(point.x_m), f64::from(point.y_m), 0.0]);
    }
    // no colours, no texture
    encoder.length(0).text("");
    header(encoder, Stamp::ZERO, "");
    encoder.text("").octets(&[]).length(0);
    encoder.text(&drawn.text).text("").text("").octets(&[]).u8(0);
}

/// `diagnostic_msgs/msg/DiagnosticArray`.
pub fn diagnostics(stamp: Stamp, list: &[Diagnostic]) -> Vec<u8> {
    let mut encoder = Encoder::new();
    header(&mut encoder, stamp, "");
    encoder.length(list.len());
    for each in list {
        encoder.u8(each.severity as u8).text(&each.name).text(&each.message).text("floorguard");
        encoder.length(each.values.len());
        each.values.iter().for_each(|(key, value)| _ = encoder.text(key).text(value));
    }
    encoder.finish()
}
