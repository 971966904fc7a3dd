//! ROS 2 messages of anybody's recording, read into what we need of them. `None`: the message is damaged or no plain CDR.

use floorguard_types::geometry::{Point2, Point3, Pose2, Transform3, Twist2};
use floorguard_types::time::Stamp;

use super::cdr::Decoder;

/// When and in which frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    /// Stamp of the measurement.
    pub stamp: Stamp,
    /// Frame of the coordinates.
    pub frame: String,
}

/// One field of a point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Name.
    pub name: String,
    /// Bytes from the beginning of the point.
    pub offset: usize,
    /// Number of the type (1 = int8 … 8 = float64).
    pub datatype: u8,
}

/// `sensor_msgs/msg/PointCloud2`.
#[derive(Clone, Debug)]
pub struct Cloud<'a> {
    /// When and where.
    pub header: Header,
    /// Points.
    pub height: usize,
    /// Points in a row.
    pub width: usize,
    /// What a point holds.
    pub fields: Vec<Field>,
    /// Bytes from point to point.
    pub point_step: usize,
    /// Bytes from row to row.
    pub row_step: usize,
    /// Numbers are big-endian.
    pub big_endian: bool,
    /// The points.
    pub data: &'a [u8],
}

/// No scanner takes longer for a scan, seconds.
const SCAN_MAX_S: f32 = 0.5;

/// `sensor_msgs/msg/LaserScan`.
#[derive(Clone, Debug, PartialEq)]
pub struct LaserScan {
    /// When and where.
    pub header: Header,
    /// Angle of the first beam, radians.
    pub first_angle_rad: f32,
    /// From beam to beam, radians; negative for a scanner on its head.
    pub step_rad: f32,
    /// From beam to beam, seconds, as the driver says; see [`Self::beam_interval_s`].
    pub between_s: f32,
    /// Shorter ranges are none, metres.
    pub range_min_m: f32,
    /// Longer ranges are none, metres.
    pub range_max_m: f32,
    /// The ranges, metres.
    pub ranges_m: Vec<f32>,
}

/// `nav_msgs/msg/Odometry`.
#[derive(Clone, Debug, PartialEq)]
pub struct Odometry {
    /// When and where.
    pub header: Header,
    /// Pose on the plane.
    pub pose: Pose2,
    /// Speed in the robot's frame.
    pub twist: Twist2,
}

/// `sensor_msgs/msg/Imu`, the part that is used.
#[derive(Clone, Debug, PartialEq)]
pub struct Imu {
    /// When and where.
    pub header: Header,
    /// Rates of turn, rad/s.
    pub angular_radps: [f32; 3],
}

/// One frame of `tf2_msgs/msg/TFMessage`.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// When, and the parent.
    pub header: Header,
    /// The child.
    pub child: String,
    /// Child to parent.
    pub transform: Transform3,
}

/// One entry of `diagnostic_msgs/msg/DiagnosticArray`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Status {
    /// 0 good, 1 warning, 2 error, 3 stale.
    pub level: u8,
    /// Name.
    pub name: String,
    /// Words.
    pub message: String,
    /// Named values.
    pub values: Vec<(String, String)>,
}

impl LaserScan {
    /// From beam to beam, seconds; 0 where it is not known: some drivers write the time of the whole scan, or a rate.
    #[must_use]
    pub fn beam_interval_s(&self) -> f32 {
        let is_known = (0.0..SCAN_MAX_S).contains(&(self.between_s * self.ranges_m.len() as f32));
        if is_known { self.between_s } else { 0.0 }
    }

    /// When the middle beam was measured: stamps are of the first one.
    #[must_use]
    pub fn middle(&self) -> Stamp {
        let half_s = 0.5 * self.beam_interval_s() * self.ranges_m.len().saturating_sub(1) as f32;
        self.header.stamp.plus_micros((1.0e6 * half_s) as u64)
    }
}

impl Status {
    /// A value by its name.
    pub fn value(&self, name: &str) -> Option<&str> {
        self.values.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// A value that is a number.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.value(name)?.parse().ok()
    }
}

/// One entry of `visualization_msgs/msg/MarkerArray`.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn {
    /// Group.
    pub group: String,
    /// Number within the group.
    pub id: i32,
    /// 0 = add, 3 = clear all.
    pub action: i32,
    /// Where.
    pub pose: Pose2,
    /// Words.
    pub text: String,
    /// Corners of a line.
    pub points: Vec<Point2>,
}

fn header(decoder: &mut Decoder<'_>) -> Option<Header> {
    let (seconds, nanoseconds) = (decoder.i32()?, decoder.u32()?);
    let micros = u64::try_from(seconds).ok()? * 1_000_000 + u64::from(nanoseconds / 1_000);
    Some(Header { stamp: Stamp::from_micros(micros), frame: decoder.text()? })
}

fn rotation([x, y, z, w]: [f64; 4]) -> [[f32; 3]; 3] {
    let square = x * x + y * y + z * z + w * w;
    // A quaternion of zeros stands for no rotation in files of careless recorders.
    if !square.is_finite() || square < 1.0e-9 {
        return Transform3::IDENTITY.rotation;
    }
    let s = 2.0 / square;
    [
        [1.0 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
        [s * (x * y + z * w), 1.0 - s * (x * x + z * z), s * (y * z - x * w)],
        [s * (x * z - y * w), s * (y * z + x * w), 1.0 - s * (x * x + y * y)],
    ]
    .map(|row| row.map(|value| value as f32))
}

fn transform(decoder: &mut Decoder<'_>) -> Option<Transform3> {
    let [x, y, z] = decoder.f64s()?.map(|value| value as f32);
    Some(Transform3 { translation: Point3::new(x, y, z), rotation: rotation(decoder.f64s()?) })
}

fn flat(transform: &Transform3) -> Pose2 {
    let [[cos, ..], [sin, ..], _] = transform.rotation;
    Pose2::new(transform.translation.x_m, transform.translation.y_m, libm::atan2f(sin, cos))
}

/// Points.
pub fn cloud(message: &[u8]) -> Option<Cloud<'_>> {
    let mut decoder = Decoder::new(message)?;
    let header = header(&mut decoder)?;
    let (height, width, fields) = (decoder.length()?, decoder.length()?, decoder.length()?);
    let fields = (0..fields).map(|_| {
        let (name, offset, datatype) = (decoder.text()?, decoder.length()?, decoder.u8()?);
        decoder.u32()?;
        Some(Field { name, offset, datatype })
    });
    let fields = fields.collect::<Option<Vec<_>>>()?;
    let big_endian = decoder.u8()? != 0;
    let (point_step, row_step) = (decoder.length()?, decoder.length()?);
    let data = decoder.octets()?;
    Some(Cloud { header, height, width, fields, point_step, row_step, big_endian, data })
}

/// A scan.
pub fn laser_scan(message: &[u8]) -> Option<LaserScan> {
    let mut decoder = Decoder::new(message)?;
    let header = header(&mut decoder)?;
    let (first_angle_rad, _last, step_rad) = (decoder.f32()?, decoder.f32()?, decoder.f32()?);
    let (between_s, _turn_s) = (decoder.f32()?, decoder.f32()?);
    let (range_min_m, range_max_m) = (decoder.f32()?, decoder.f32()?);
    let ranges_m = decoder.singles()?;
    Some(LaserScan { header, first_angle_rad, step_rad, between_s, range_min_m, range_max_m, ranges_m })
}

/// Pose and speed.
pub fn odometry(message: &[u8]) -> Option<Odometry> {
    let mut decoder = Decoder::new(message)?;
    let header = header(&mut decoder)?;
    let _child = decoder.text()?;
    let pose = flat(&transform(&mut decoder)?);
    let _covariance: [f64; 36] = decoder.f64s()?;
    let [linear, _, _, _, _, angular] = decoder.f64s()?;
    let twist = Twist2 { linear_mps: linear as f32, angular_radps: angular as f32 };
    Some(Odometry { header, pose, twist })
}

/// An inertial sample.
pub fn imu(message: &[u8]) -> Option<Imu> {
    let mut decoder = Decoder::new(message)?;
    let header = header(&mut decoder)?;
    let (_orientation, _covariance): ([f64; 4], [f64; 9]) = (decoder.f64s()?, decoder.f64s()?);
    Some(Imu { header, angular_radps: decoder.f64s::<3>()?.map(|value| value as f32) })
}

/// Frames.
pub fn frames(message: &[u8]) -> Option<Vec<Frame>> {
    let mut decoder = Decoder::new(message)?;
    let count = decoder.length()?;
    let frame = |_| {
        let (header, child) = (header(&mut decoder)?, decoder.text()?);
        Some(Frame { header, child, transform: transform(&mut decoder)? })
    };
    (0..count).map(frame).collect()
}

/// Diagnostics.
pub fn diagnostics(message: &[u8]) -> Option<(Header, Vec<Status>)> {
    let mut decoder = Decoder::new(message)?;
    let header = header(&mut decoder)?;
    let count = decoder.length()?;
    let status = |_| {
        let (level, name, message) = (decoder.u8()?, decoder.text()?, decoder.text()?);
        let _hardware = decoder.text()?;
        let values = decoder.length()?;
        let values = (0..values).map(|_| decoder.text().zip(decoder.text())).collect::<Option<Vec<_>>>()?;
        Some(Status { level, name, message, values })
    };
    Some((header, (0..count).map(status).collect::<Option<Vec<_>>>()?))
}

/// What is drawn.
pub fn markers(message: &[u8]) -> Option<Vec<Drawn>> {
    let mut decoder = Decoder::new(message)?;
    let count = decoder.length()?;
    (0..count).map(|_| marker(&mut decoder)).collect()
}

fn marker(decoder: &mut Decoder<'_>) -> Option<Drawn> {
    let _header = header(decoder)?;
    let (group, id, _shape, action) = (decoder.text()?, decoder.i32()?, decoder.i32()?, decoder.i32()?);
    let pose = flat(&transform(decoder)?);
    let _size: [f64; 3] = decoder.f64s()?;
    for _ in 0..4 {
        decoder.f32()?;
    }
    let _lifetime = (decoder.i32()?, decoder.u32()?, decoder.u8()?);
    let count = decoder.length()?;
    let points = (0..count).map(|_| {
        let [x, y, _] = decoder.f64s()?;
        Some(Point2::new(x as f32, y as f32))
    });
    let points = points.collect::<Option<Vec<_>>>()?;
    let colours = decoder.length()?;
    for _ in 0..colours.checked_mul(4)? {
        decoder.f32()?;
    }
    let _texture = (decoder.text()?, header(decoder)?, decoder.text()?, decoder.octets()?);
    let coordinates = decoder.length()?;
    for _ in 0..coordinates.checked_mul(2)? {
        decoder.f32()?;
    }
    let text = decoder.text()?;
    let _mesh = (decoder.text()?, decoder.text()?, decoder.octets()?, decoder.u8()?);
    Some(Drawn { group, id, action, pose, text, points })
}

/// `std_msgs/msg/Float32`.
pub fn number(message: &[u8]) -> Option<f32> {
    Decoder::new(message)?.f32()
}

/// `geometry_msgs/msg/TwistStamped`: forward speed and turning rate.
pub fn twist(message: &[u8]) -> Option<Twist2> {
    let mut decoder = Decoder::new(message)?;
    header(&mut decoder)?;
    let [linear, _, _, _, _, angular] = decoder.f64s()?;
    Some(Twist2 { linear_mps: linear as f32, angular_radps: angular as f32 })
}

/// `nav_msgs/msg/OccupancyGrid`.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// When and where.
    pub header: Header,
    /// Edge of a cell, metres.
    pub resolution_m: f32,
    /// Cells per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Pose of the lower left corner.
    pub origin: Pose2,
    /// −1 unknown, 0 free … 100 occupied.
    pub cells: Vec<i8>,
}

/// A map.
pub fn grid(message: &[u8]) -> Option<Grid> {
    let mut decoder = Decoder::new(message)?;
    let header = header(&mut decoder)?;
    let _loaded = (decoder.i32()?, decoder.u32()?);
    let (resolution_m, width, height) = (decoder.f32()?, decoder.length()?, decoder.length()?);
    let origin = flat(&transform(&mut decoder)?);
    let cells: Vec<i8> = decoder.octets()?.iter().map(|cell| cell.cast_signed()).collect();
    let whole = width.checked_mul(height)? == cells.len();
    whole.then_some(Grid { header, resolution_m, width, height, origin, cells })
}
