//! `--ros2`, `[ros2]`, and velocities of ROS 2: a robot live in ROS 2 without a ROS installation.

#[cfg(feature = "ros2")]
mod bridged;

use std::net::Ipv4Addr;

use floorguard_configuration::{CommandAddress, CommandConfiguration, RosConfiguration};
use floorguard_operator::telemetry::RunLink;
use floorguard_recording::MessageListener;
use floorguard_robot::navigator::{DriveOrders, NavigationSettings};

#[cfg(feature = "ros2")]
pub(super) use bridged::{RosFeed, open, take_velocities};

/// Where ROS 2 says which domain a program belongs to.
const DOMAIN_VARIABLE: &str = "ROS_DOMAIN_ID";
/// The largest domain that has ports.
const DOMAIN_MAX: u16 = 232;

/// A domain that was asked for on the command line; without a number that of the environment, or 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RosDomain(Option<u16>);

/// Where a robot is in ROS 2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RosPlace {
    /// The domain.
    pub domain: u16,
    /// This computer's address in the network where the others are; without it the bridge stays on this computer.
    pub address: Option<Ipv4Addr>,
}

/// What a bridge is, and where goals go.
#[cfg_attr(not(feature = "ros2"), expect(dead_code, reason = "a program without ROS 2 refuses it"))]
pub struct RosOpening {
    /// Where.
    pub place: RosPlace,
    /// The way of velocities to the guard, if they come from there.
    pub feed: RosFeed,
    /// Where goals go, and when they are reached; a robot without them drives to none.
    pub orders: Option<(DriveOrders, NavigationSettings)>,
}

/// A bridge that is not open yet, if anything asks for one: the guard's end of its velocities is known before.
#[derive(Default)]
pub struct RosWay {
    place: Option<RosPlace>,
    feed: RosFeed,
}

impl RosWay {
    /// From the command line and the robot's file; velocities of ROS 2 come on a port of the loopback from here on.
    ///
    /// # Errors
    /// The program was built without ROS 2, or the computer has no free port.
    pub(super) fn of(
        asked: Option<RosDomain>,
        section: Option<&RosConfiguration>,
        command: &mut Option<CommandConfiguration>,
    ) -> anyhow::Result<Self> {
        let place = place_of(asked, section, is_ros(command.as_ref()));
        Ok(Self { place, feed: take_velocities(command)? })
    }

    /// Opens it.
    ///
    /// # Errors
    /// The program was built without ROS 2, or DDS refuses.
    pub(super) fn open(
        self,
        orders: Option<(DriveOrders, NavigationSettings)>,
    ) -> anyhow::Result<Option<RosEnds>> {
        let Self { place, feed } = self;
        place.map(|place| open(RosOpening { place, feed, orders })).transpose()
    }
}

/// What a bridge hears and what it asks for.
pub type RosEnds = (Box<dyn MessageListener>, Box<dyn RunLink>);

/// A domain on the command line: `--ros2` or `--ros2=7`.
///
/// # Errors
/// Anything else, in words.
pub(super) fn ros_domain(text: &str) -> Result<RosDomain, String> {
    if text.is_empty() {
        return Ok(RosDomain(None));
    }
    let domain = text.parse().ok().filter(|domain| *domain <= DOMAIN_MAX);
    domain.map(|domain| RosDomain(Some(domain))).ok_or_else(|| {
        format!("write a domain from 0 to {DOMAIN_MAX}, for example --ros2=7, or --ros2 alone")
    })
}

/// Where the robot is in ROS 2, if anything asks for it: the command line, `[ros2]`, or a source of velocities.
pub(super) fn place_of(
    asked: Option<RosDomain>,
    section: Option<&RosConfiguration>,
    takes_velocities: bool,
) -> Option<RosPlace> {
    let wanted = asked.is_some() || section.is_some() || takes_velocities;
    let environment = || std::env::var(DOMAIN_VARIABLE).ok()?.trim().parse().ok();
    let domain = asked
        .and_then(|asked| asked.0)
        .or_else(|| section.and_then(|section| section.domain))
        .or_else(environment)
        .unwrap_or(0);
    let address = section.and_then(|section| section.address);
    wanted.then_some(RosPlace { domain, address })
}

/// Whether velocities come from ROS 2.
pub(super) fn is_ros(command: Option<&CommandConfiguration>) -> bool {
    command.is_some_and(|command| matches!(command.address, CommandAddress::Ros(_)))
}

#[cfg(not(feature = "ros2"))]
const MISSING: &str = "ROS 2: this program was built without it; build it with `--features ros2`";

/// There is none.
#[cfg(not(feature = "ros2"))]
pub type RosFeed = ();

/// Velocities of ROS 2 need the feature.
///
/// # Errors
/// They are asked for.
#[cfg(not(feature = "ros2"))]
pub(super) fn take_velocities(command: &mut Option<CommandConfiguration>) -> anyhow::Result<RosFeed> {
    if is_ros(command.as_ref()) {
        return Err(super::exit::WrongUsage(MISSING.to_owned()).into());
    }
    Ok(())
}

/// A bridge needs the feature.
///
/// # Errors
/// Always.
#[cfg(not(feature = "ros2"))]
pub(super) fn open(_opening: RosOpening) -> anyhow::Result<RosEnds> {
    Err(super::exit::WrongUsage(MISSING.to_owned()).into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn domain_is_a_number_or_absent() {
        assert_eq!(ros_domain(""), Ok(RosDomain(None)));
        assert_eq!(ros_domain("7"), Ok(RosDomain(Some(7))));
        for wrong in ["-1", "233", "lo", "7 "] {
            assert!(ros_domain(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn nothing_opens_ros2_unasked() {
        let address = Some(Ipv4Addr::new(10, 0, 0, 2));
        let section = RosConfiguration { domain: Some(5), address, goals: false };
        assert_eq!(place_of(None, None, false), None);
        let here = RosPlace { domain: 5, address };
        assert_eq!(place_of(None, Some(&section), false), Some(here));
        let asked = Some(RosDomain(Some(9)));
        assert_eq!(place_of(asked, Some(&section), false), Some(RosPlace { domain: 9, address }));
        assert_eq!(place_of(asked, None, true), Some(RosPlace { domain: 9, address: None }));
    }
}
