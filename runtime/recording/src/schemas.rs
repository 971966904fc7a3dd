//! Definitions of the ROS 2 messages that a recording holds (`ros2msg`, as MCAP's registry wants them).
//!
//! Field names and types are those of the ROS 2 interface packages; a reader needs each used type after a separator.

/// How the definitions are written, by MCAP's name for it.
pub const ENCODING: &str = "ros2msg";

/// A message type: its name and its definition with everything that it uses.
pub struct Schema {
    /// Full name.
    pub name: &'static str,
    /// Fields of the message itself.
    fields: &'static str,
    /// Types that it uses, directly or not.
    uses: &'static [&'static Part],
}

struct Part {
    name: &'static str,
    fields: &'static str,
}

impl Schema {
    /// The definition as it stands in the file, with those of all types that it uses.
    #[must_use]
    pub fn definition(&self) -> String {
        let separator = "=".repeat(80);
        self.uses.iter().fold(self.fields.to_owned(), |text, part| {
            format!("{text}{separator}\nMSG: {}\n{}", part.name, part.fields)
        })
    }
}

macro_rules! part {
    ($identifier:ident, $name:literal, $fields:literal) => {
        static $identifier: Part = Part { name: $name, fields: $fields };
    };
}

part!(TIME, "builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
part!(DURATION, "builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n");
part!(HEADER, "std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n");
part!(COLOR, "std_msgs/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n");
part!(
    POINT_FIELD,
    "sensor_msgs/PointField",
    "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\nuint8 FLOAT32=7\n\
     uint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n"
);
part!(MULTI_ARRAY_DIMENSION, "std_msgs/MultiArrayDimension", "string label\nuint32 size\nuint32 stride\n");
part!(
    MULTI_ARRAY_LAYOUT,
    "std_msgs/MultiArrayLayout",
    "std_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n"
);
part!(VECTOR3, "geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n");
part!(POINT, "geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n");
part!(QUATERNION, "geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n");
part!(POSE, "geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n");
part!(POSE_STAMPED, "geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n");
part!(
    POSE_WITH_COVARIANCE,
    "geometry_msgs/PoseWithCovariance",
    "geometry_msgs/Pose pose\nfloat64[36] covariance\n"
);
part!(TWIST, "geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n");
part!(
    TWIST_WITH_COVARIANCE,
    "geometry_msgs/TwistWithCovariance",
    "geometry_msgs/Twist twist\nfloat64[36] covariance\n"
);
part!(
    TRANSFORM,
    "geometry_msgs/Transform",
    "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"
);
part!(
    TRANSFORM_STAMPED,
    "geometry_msgs/TransformStamped",
    "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"
);
part!(
    MAP_META_DATA,
    "nav_msgs/MapMetaData",
    "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\n\
     geometry_msgs/Pose origin\n"
);
part!(KEY_VALUE, "diagnostic_msgs/KeyValue", "string key\nstring value\n");
part!(
    DIAGNOSTIC_STATUS,
    "diagnostic_msgs/DiagnosticStatus",
    "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\nstring name\nstring message\nstring hardware_id\n\
     diagnostic_msgs/KeyValue[] values\n"
);
part!(
    COMPRESSED_IMAGE,
    "sensor_msgs/CompressedImage",
    "std_msgs/Header header\nstring format\nuint8[] data\n"
);
part!(UV_COORDINATE, "visualization_msgs/UVCoordinate", "float32 u\nfloat32 v\n");
part!(MESH_FILE, "visualization_msgs/MeshFile", "string filename\nuint8[] data\n");
part!(
    MARKER,
    "visualization_msgs/Marker",
    "int32 ARROW=0\nint32 CUBE=1\nint32 SPHERE=2\nint32 CYLINDER=3\nint32 LINE_STRIP=4\nint32 TEXT_VIEW_FACING=9\n\
     int32 ADD=0\nint32 DELETE=2\nint32 DELETEALL=3\nstd_msgs/Header header\nstring ns\nint32 id\nint32 type\n\
     int32 action\ngeometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\n\
     builtin_interfaces/Duration lifetime\nbool frame_locked\ngeometry_msgs/Point[] points\n\
     std_msgs/ColorRGBA[] colors\nstring texture_resource\nsensor_msgs/CompressedImage texture\n\
     visualization_msgs/UVCoordinate[] uv_coordinates\nstring text\nstring mesh_resource\n\
     visualization_msgs/MeshFile mesh_file\nbool mesh_use_embedded_materials\n"
);
part!(HYPOTHESIS, "vision_msgs/ObjectHypothesis", "string class_id\nfloat64 score\n");
part!(
    HYPOTHESIS_WITH_POSE,
    "vision_msgs/ObjectHypothesisWithPose",
    "vision_msgs/ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose\n"
);
part!(BOUNDING_BOX, "vision_msgs/BoundingBox3D", "geometry_msgs/Pose center\ngeometry_msgs/Vector3 size\n");
part!(
    DETECTION,
    "vision_msgs/Detection3D",
    "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\nvision_msgs/BoundingBox3D bbox\n\
     string id\n"
);

/// Raw bytes.
pub static OCTETS: Schema = Schema {
    name: "std_msgs/msg/UInt8MultiArray",
    fields: "std_msgs/MultiArrayLayout layout\nuint8[] data\n",
    uses: &[&MULTI_ARRAY_LAYOUT, &MULTI_ARRAY_DIMENSION],
};
/// One number.
pub static NUMBER: Schema = Schema { name: "std_msgs/msg/Float32", fields: "float32 data\n", uses: &[] };
/// Words.
pub static TEXT: Schema = Schema { name: "std_msgs/msg/String", fields: "string data\n", uses: &[] };
/// A command.
pub static TWIST_STAMPED: Schema = Schema {
    name: "geometry_msgs/msg/TwistStamped",
    fields: "std_msgs/Header header\ngeometry_msgs/Twist twist\n",
    uses: &[&HEADER, &TIME, &TWIST, &VECTOR3],
};
/// Lidar sweeps.
pub static POINT_CLOUD: Schema = Schema {
    name: "sensor_msgs/msg/PointCloud2",
    fields: "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n\
             bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
    uses: &[&HEADER, &TIME, &POINT_FIELD],
};
/// Scans of the safety scanner.
pub static LASER_SCAN: Schema = Schema {
    name: "sensor_msgs/msg/LaserScan",
    fields: "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n\
             float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\n\
             float32[] intensities\n",
    uses: &[&HEADER, &TIME],
};
/// Inertial samples.
pub static IMU: Schema = Schema {
    name: "sensor_msgs/msg/Imu",
    fields: "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n\
             geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n\
             geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n",
    uses: &[&HEADER, &TIME, &QUATERNION, &VECTOR3],
};
/// Pose and speed of the robot.
pub static ODOMETRY: Schema = Schema {
    name: "nav_msgs/msg/Odometry",
    fields: "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
             geometry_msgs/TwistWithCovariance twist\n",
    uses: &[
        &HEADER,
        &TIME,
        &POSE_WITH_COVARIANCE,
        &POSE,
        &POINT,
        &QUATERNION,
        &TWIST_WITH_COVARIANCE,
        &TWIST,
        &VECTOR3,
    ],
};
/// Maps.
pub static OCCUPANCY_GRID: Schema = Schema {
    name: "nav_msgs/msg/OccupancyGrid",
    fields: "std_msgs/Header header\nnav_msgs/MapMetaData info\nint8[] data\n",
    uses: &[&HEADER, &TIME, &MAP_META_DATA, &POSE, &POINT, &QUATERNION],
};
/// Planned paths.
pub static PATH: Schema = Schema {
    name: "nav_msgs/msg/Path",
    fields: "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n",
    uses: &[&HEADER, &TIME, &POSE_STAMPED, &POSE, &POINT, &QUATERNION],
};
/// Frames.
pub static TF_MESSAGE: Schema = Schema {
    name: "tf2_msgs/msg/TFMessage",
    fields: "geometry_msgs/TransformStamped[] transforms\n",
    uses: &[&TRANSFORM_STAMPED, &HEADER, &TIME, &TRANSFORM, &VECTOR3, &QUATERNION],
};
/// People, fields, paths.
pub static MARKER_ARRAY: Schema = Schema {
    name: "visualization_msgs/msg/MarkerArray",
    fields: "visualization_msgs/Marker[] markers\n",
    uses: &[
        &MARKER,
        &HEADER,
        &TIME,
        &POSE,
        &POINT,
        &QUATERNION,
        &VECTOR3,
        &COLOR,
        &DURATION,
        &COMPRESSED_IMAGE,
        &UV_COORDINATE,
        &MESH_FILE,
    ],
};
/// Health of the sources, causes of stops.
pub static DIAGNOSTIC_ARRAY: Schema = Schema {
    name: "diagnostic_msgs/msg/DiagnosticArray",
    fields: "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n",
    uses: &[&HEADER, &TIME, &DIAGNOSTIC_STATUS, &KEY_VALUE],
};
/// People as boxes with a class.
pub static DETECTIONS: Schema = Schema {
    name: "vision_msgs/msg/Detection3DArray",
    fields: "std_msgs/Header header\nvision_msgs/Detection3D[] detections\n",
    uses: &[
        &DETECTION,
        &HYPOTHESIS_WITH_POSE,
        &HYPOTHESIS,
        &BOUNDING_BOX,
        &HEADER,
        &TIME,
        &POSE_WITH_COVARIANCE,
        &POSE,
        &POINT,
        &QUATERNION,
        &VECTOR3,
    ],
};
/// The clock on the wall beside the robot's.
pub static TIME_REFERENCE: Schema = Schema {
    name: "sensor_msgs/msg/TimeReference",
    fields: "std_msgs/Header header\nbuiltin_interfaces/Time time_ref\nstring source\n",
    uses: &[&HEADER, &TIME],
};
