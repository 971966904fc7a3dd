//! Which recordings, and which robot.

use floorguard_configuration::{EXAMPLE, NavigationConfiguration, parse};
use floorguard_robot::navigator::{GuardModel, LocalPlanning, NavigationSettings};
use floorguard_types::motion::Footprint;

use super::drive::Robot;
use super::policy::CELL_M;

/// Name and file, below `trajectories/eth_ucy`. The last two are kept for acceptance and absent where that is not at hand.
pub const SCENES: [(&str, &str); 6] = [
    ("eth", "eth_biwi_eth"),
    ("univ 1", "univ_students001"),
    ("univ 3", "univ_students003"),
    ("zara2", "zara2_crowds_zara02"),
    ("hotel", "hotel_biwi_hotel"),
    ("zara1", "zara1_crowds_zara01"),
];

/// The example robot, as its navigator drives it.
///
/// # Errors
/// Never: the example is legal.
pub fn example_robot() -> anyhow::Result<Robot> {
    let robot = parse("robot.toml", EXAMPLE)?.robot;
    let settings = NavigationSettings::from(&NavigationConfiguration::of_limits(&robot.limits));
    Ok(Robot {
        body: Footprint::new(&robot.geometry.footprint)?,
        planning: LocalPlanning::of(&robot, &settings, CELL_M)?,
        guard: GuardModel::of(&robot),
    })
}
