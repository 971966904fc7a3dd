//! Whichever lidar the robot carries.

use super::{BridgedLidar, Lidar, LivoxMid360, Ouster, Pandar, View};
use crate::robot::LidarDevice;
use crate::wire::ReturnMode;

/// A lidar that sends datagrams. The VLP-16 sends position packets, too.
#[derive(Clone, Debug)]
pub enum LidarSensor {
    /// VLP-16.
    Vlp16(Lidar),
    /// PandarXT-16 and XT-32.
    Pandar(Pandar),
    /// Ouster.
    Ouster(Ouster),
    /// Any lidar behind a bridge.
    Bridged(BridgedLidar),
    /// Livox Mid-360.
    Livox(LivoxMid360),
}

impl LidarSensor {
    /// Switched on at time 0 at 600 rpm.
    #[must_use]
    pub fn of(device: LidarDevice, seed: u64) -> Self {
        match device {
            LidarDevice::Vlp16 => Self::Vlp16(Lidar::new(seed, ReturnMode::Strongest)),
            LidarDevice::PandarXt16 => Self::Pandar(Pandar::new(16, seed)),
            LidarDevice::PandarXt32 => Self::Pandar(Pandar::new(32, seed)),
            LidarDevice::Ouster(device) => Self::Ouster(Ouster::new(device, seed)),
            LidarDevice::Bridged(elevations) => Self::Bridged(BridgedLidar::new(elevations, seed)),
            LidarDevice::LivoxMid360 { hangs } => Self::Livox(LivoxMid360::new(hangs, seed)),
        }
    }

    /// See [`Lidar::coarse`].
    pub const fn coarse(&mut self, grain: usize) {
        match self {
            Self::Vlp16(lidar) => lidar.coarse(grain),
            Self::Pandar(lidar) => lidar.coarse(grain),
            Self::Ouster(lidar) => lidar.coarse(grain),
            Self::Bridged(lidar) => lidar.coarse(grain),
            // Its points are too few to leave any out.
            Self::Livox(_) => {}
        }
    }

    /// When the packet now being measured is complete, microseconds of the world.
    #[must_use]
    pub fn due_us(&self) -> u64 {
        match self {
            Self::Vlp16(lidar) => lidar.due_us(),
            Self::Pandar(lidar) => lidar.due_us(),
            Self::Ouster(lidar) => lidar.due_us(),
            Self::Bridged(lidar) => lidar.due_us(),
            Self::Livox(lidar) => lidar.due_us(),
        }
    }

    /// Measures the packet that ends now; the robot's last step was at `step_us`.
    pub fn measure(&mut self, view: &View<'_>, step_us: u64) -> Vec<u8> {
        match self {
            Self::Vlp16(lidar) => lidar.measure(view, step_us),
            Self::Pandar(lidar) => lidar.measure(view, step_us),
            Self::Ouster(lidar) => lidar.measure(view, step_us),
            Self::Bridged(lidar) => lidar.measure(view, step_us),
            Self::Livox(lidar) => lidar.measure(view, step_us),
        }
    }

    /// A position packet, of a lidar that sends them.
    #[must_use]
    pub fn position_packet(&self, now_us: u64) -> Option<Vec<u8>> {
        match self {
            Self::Vlp16(lidar) => Some(lidar.position_packet(now_us)),
            Self::Pandar(_) | Self::Ouster(_) | Self::Bridged(_) | Self::Livox(_) => None,
        }
    }
}
