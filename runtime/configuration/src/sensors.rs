//! The sensors that the guard listens to: read together, because two of them share no line, and two scanners share a plane.

use floorguard_runtime::configuration::{
    ImuConfiguration, LidarConfiguration, Limits, ScannerConfiguration, ScannerModel,
};

use super::actuated_lidar::{ActuatedLidarConfiguration, check_motor_bus, read_actuated_lidar};
use super::address::{BaseAddress, CanAddress, DatagramAddress, ImuAddress, SerialAddress};
use super::camera::{CameraConfiguration, read_camera};
use super::command::CommandAddress;
use super::devices::read_imu;
use super::distinct::{Addresses, check_addresses};
use super::lidar::read_lidar;
use super::reader::Reader;
use super::scanner::{ReadScanner, read_rear_scanner, read_scanner};

/// Scan planes whose heights differ by more are not one, metres.
const SAME_PLANE_M: f32 = 0.01;

/// Why no robot does without.
const NO_SCANNER: &str = "the safety scanner is the protection that sees feet and children in time, and stops the robot when all \
    else fails: no robot drives without; add the section";

/// A device of a section, with its address; `None`: it is wrong.
pub(super) type Read<C, A> = Option<(C, A)>;

/// The sensors that the guard listens to, as far as they were read.
pub(super) struct Sensors {
    pub(super) lidar: Option<Read<LidarConfiguration, DatagramAddress>>,
    pub(super) scanner: Option<ReadScanner>,
    pub(super) rear_scanner: Option<Read<ScannerConfiguration, SerialAddress>>,
    pub(super) imu: Option<Read<ImuConfiguration, ImuAddress>>,
    pub(super) camera: Option<CameraConfiguration>,
    /// None of the guard's, but it shares no line with them either.
    pub(super) actuated_lidar: Option<Option<ActuatedLidarConfiguration>>,
}

impl Sensors {
    pub(super) fn read(top: &Reader<'_>) -> Self {
        Self {
            lidar: top.optional_section("lidar").map(read_lidar),
            scanner: read_scanner(top.section_because("scanner", NO_SCANNER)),
            rear_scanner: top.optional_section("rear_scanner").map(read_rear_scanner),
            imu: top.optional_section("imu").map(read_imu),
            camera: top.optional_section("camera").and_then(read_camera),
            actuated_lidar: top.optional_section("actuated_lidar").map(read_actuated_lidar),
        }
    }

    /// The limits of a robot whose scanner may be slower than a safety scanner, or whose lidar shows later what it met: it reacts so much
    /// later.
    pub(super) fn slowed(&self, limits: Limits) -> Limits {
        let scanner_s = match self.scanner.as_ref().map(|read| read.scanner.model) {
            Some(ScannerModel::Ranging(ranging)) => ranging.later_s(),
            _ => 0.0,
        };
        let lidar = self.lidar.as_ref().and_then(Option::as_ref);
        let lidar_s = lidar.map_or(0.0, |(lidar, _)| lidar.model.later_s());
        Limits { response_s: limits.response_s + scanner_s.max(lidar_s), ..limits }
    }

    /// What two devices cannot share, and what two scanners must.
    pub(super) fn check(
        &self,
        top: &Reader<'_>,
        (can, base, command): (Option<&CanAddress>, Option<&BaseAddress>, Option<&CommandAddress>),
    ) {
        let Some(ReadScanner { scanner: first, address: scanner, .. }) = &self.scanner else { return };
        let (lidar, imu) = (address_of(&self.lidar), address_of(&self.imu));
        let rear_scanner = address_of(&self.rear_scanner);
        let actuated_lidar = self.actuated_lidar.as_ref().and_then(Option::as_ref);
        check_addresses(
            top,
            &Addresses { lidar, scanner, rear_scanner, imu, can, base, command, actuated_lidar },
        );
        check_motor_bus(top, actuated_lidar, can);
        let rear = self.rear_scanner.as_ref().and_then(Option::as_ref);
        check_planes(top, first, rear.map(|(scanner, _)| scanner));
    }
}

/// Where such a device is, if it was read.
fn address_of<C, A>(read: &Option<Read<C, A>>) -> Option<&A> {
    read.as_ref().and_then(Option::as_ref).map(|(_, address)| address)
}

/// Both scanners look along one plane: what either meets, the other clears when it looks through its place.
fn check_planes(top: &Reader<'_>, first: &ScannerConfiguration, rear: Option<&ScannerConfiguration>) {
    let height_m = |scanner: &ScannerConfiguration| scanner.mounting.position.z_m;
    let is_other = |rear: &&ScannerConfiguration| (height_m(rear) - height_m(first)).abs() > SAME_PLANE_M;
    let Some(rear) = rear.filter(is_other) else { return };
    top.refuse(
        &top.find("rear_scanner").map_or(0..0, |value| value.span()),
        format!(
            "[rear_scanner]: its scan plane is {} m high, that of [scanner] {} m: the one would look over what the other has met",
            height_m(rear),
            height_m(first)
        ),
        "mount both at the same height",
    );
}

/// A device that a robot can do without: none if its section is missing, refused if it is wrong.
pub(super) fn fitted<C, A>(read: Option<Read<C, A>>) -> Option<(Option<C>, Option<A>)> {
    read.map_or(Some((None, None)), |read| read.map(|(device, address)| (Some(device), Some(address))))
}
