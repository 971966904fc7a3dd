//! Device drivers against recordings, against keys from documents, and against the simulator's own encoders.

mod can_recordings;
mod large_lidars;
mod lidar_bridges;
mod lidar_senders;
mod microscan3_scans;
mod same_verdicts;
mod scan_bridges;
mod sim_bridged_imu;
mod sim_bridged_scanner;
mod sim_can;
mod sim_hesai;
mod sim_hokuyo;
mod sim_imu;
mod sim_livox;
mod sim_microscan3;
mod sim_ouster;
mod sim_s300;
mod sim_support;
mod sim_vectornav;
mod sim_velodyne;
mod sim_velodyne_speeds;
mod velocity_links;
mod velodyne_captures;
mod velodyne_decode_command;
mod velodyne_recordings;
mod xsens_recordings;
