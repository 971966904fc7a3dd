//! Why a device is of no use, in the words of its driver: for commissioning. Nothing is decided by it.

use floorguard_drivers::inertial::InertialFault;
use floorguard_drivers::lidar::LidarError;
use floorguard_drivers::microscan3::ScanError;
use floorguard_drivers::s300::TelegramError;
use floorguard_drivers::scan_link::DecodeError;
use floorguard_drivers::velodyne::ClosedSector;

/// The newest complaint about each device; it stays when the device has become good.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Complaints {
    /// A lidar datagram that gave no columns, or not those of all its blocks.
    pub lidar: Option<LidarError>,
    /// What the lidar leaves out because it is set to a field of view.
    pub lidar_closed: Option<ClosedSector>,
    /// A scanner's telegram that is right and of no use.
    pub scanner: Option<TelegramError>,
    /// The same of the second scanner's telegram.
    pub rear_scanner: Option<TelegramError>,
    /// The same of a microScan3's datagram or message.
    pub scanner_message: Option<ScanError>,
    /// The same of a datagram of a scanner behind a bridge.
    pub scan_link: Option<DecodeError>,
    /// What keeps the inertial sensor from measuring.
    pub imu: Option<InertialFault>,
}

impl Complaints {
    /// Whether they are reported at all.
    pub const ARE_REPORTED: bool = cfg!(not(target_os = "none"));
}
