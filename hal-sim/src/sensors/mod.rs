//! The sensors: what they measure in the world and the bytes they send.

mod bridged;
mod bridged_imu;
mod bridged_scanner;
mod depth_camera;
mod floor_camera_sensor;
mod imu;
mod imu_sensor;
mod lidar;
mod lidar_sensor;
mod livox;
mod ouster;
mod pandar;
mod rplidar;
mod scanner;
mod sick;
mod vectornav;
mod view;

pub use bridged::BridgedLidar;
pub use bridged_imu::BridgedImu;
pub use depth_camera::{DepthCamera, DepthPicture};
pub use floor_camera_sensor::{FloorCameraMounting, FloorCameraSensor, FloorFrame};
pub use imu::{Imu, Motion};
pub use imu_sensor::ImuSensor;
pub use lidar::{LIDAR_PACKET_NS, Lidar};
pub use lidar_sensor::LidarSensor;
pub use livox::LivoxMid360;
pub use ouster::Ouster;
pub use pandar::Pandar;
pub use rplidar::RplidarScanner;
pub use scanner::{Scanner, ScannerState};
pub use sick::SickScanner;
pub use vectornav::VectorNav;
pub use view::View;
