//! The sensors: what they measure in the world and the bytes they send.

mod depth_camera;
mod floor_camera_sensor;
mod imu;
mod lidar;
mod lidar_sensor;
mod pandar;
mod scanner;
mod view;

pub use depth_camera::{DepthCamera, DepthPicture};
pub use floor_camera_sensor::{FloorCameraMounting, FloorCameraSensor, FloorFrame};
pub use imu::{Imu, Motion};
pub use lidar::{LIDAR_PACKET_NS, Lidar};
pub use lidar_sensor::LidarSensor;
pub use pandar::PandarXt16;
pub use scanner::{Scanner, ScannerState};
pub use view::View;
