//! `[fleet]` and `--fleet`: the robot drives to the places that a fleet's master orders, and cleans there.

use std::path::Path;
#[cfg(feature = "fleet")]
use std::path::PathBuf;

use floorguard_configuration::FleetConfiguration;
#[cfg(not(feature = "fleet"))]
use floorguard_host::outcome::WrongUsage;
#[cfg(not(feature = "fleet"))]
use floorguard_operator::telemetry::RunLink;
use floorguard_robot::cleaner::{CleaningOrders, MissionPlan};
use floorguard_robot::navigator::{DriveOrders, NavigationSettings};
use floorguard_runtime::configuration::RobotConfiguration;

/// What a robot in a fleet is, and where its orders go.
pub struct FleetOpening<'a> {
    /// The fleet.
    pub fleet: &'a FleetConfiguration,
    /// The folder of the robot's file: what must outlive the program, and the broker's certificates, lie there.
    pub folder: Option<&'a Path>,
    /// The robot.
    pub robot: &'a RobotConfiguration,
    /// How it drives.
    pub settings: NavigationSettings,
    /// Where its orders go.
    pub orders: DriveOrders,
    /// What it cleans on order; or why nothing.
    pub cleaning: Result<CleaningOffer, String>,
}

/// A robot that cleans on order.
pub struct CleaningOffer {
    /// Where those orders go.
    pub orders: CleaningOrders,
    /// Units that may stay in a clean cell, where an order says nothing else.
    pub tolerated_units: u8,
    /// Probability with which a cell called clean may hold more, likewise.
    pub delta: f64,
}

impl CleaningOffer {
    /// Of a mission; none of one that is not ordered from outside.
    pub fn of(plan: &MissionPlan, orders: Option<CleaningOrders>) -> Option<Self> {
        Some(Self { orders: orders?, tolerated_units: plan.tolerated_units, delta: plan.delta })
    }
}

/// A broker on the command line: `HOST:PORT`, or `HOST:PORT/SERIAL`.
///
/// # Errors
/// Anything else, in words.
#[cfg(any(test, feature = "laboratory"))]
pub fn fleet_broker(text: &str) -> Result<FleetConfiguration, String> {
    let (address, serial) = text.split_once('/').unwrap_or((text, "simulated-1"));
    let parts = address.rsplit_once(':').and_then(|(host, port)| Some((host, port.parse::<u16>().ok()?)));
    match parts {
        Some((host, port))
            if !host.is_empty() && port > 0 && !serial.is_empty() && !serial.contains(['/', '+', '#']) =>
        {
            Ok(FleetConfiguration::at(host.to_owned(), port, serial.to_owned()))
        }
        _ => Err("write HOST:PORT or HOST:PORT/SERIAL, for example 127.0.0.1:1883/robot-7".to_owned()),
    }
}

/// Joins the fleet.
///
/// # Errors
/// The folder, certificates, or a program that was built without fleets.
#[cfg(not(feature = "fleet"))]
pub fn join(_opening: FleetOpening<'_>) -> anyhow::Result<Box<dyn RunLink>> {
    let what = "fleets: this program was built without them; build it with `--features fleet`";
    Err(WrongUsage(what.to_owned()).into())
}

/// Where a robot keeps what must outlive the program.
#[cfg(feature = "fleet")]
pub(super) fn kept_in(folder: &Path, serial: &str) -> PathBuf {
    folder.join(format!("fleet-{serial}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn broker_has_port_and_serial() {
        let fleet = fleet_broker("127.0.0.1:1883/robot-7").unwrap();
        assert_eq!((fleet.port, fleet.serial.as_str()), (1_883, "robot-7"));
        assert_eq!(fleet_broker("broker:8883").unwrap().serial, "simulated-1");
        for wrong in ["", "broker", ":1883", "broker:0", "broker:1883/", "broker:1883/a/b"] {
            assert!(fleet_broker(wrong).is_err(), "{wrong}");
        }
    }
}
