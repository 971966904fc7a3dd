//! The robot in ROS 2: its domain, and who may reach it.

use std::net::Ipv4Addr;

use super::reader::Reader;

/// The largest domain that has ports.
const DOMAIN_MAX: i64 = 232;

/// How long a velocity holds that does not say it itself, milliseconds; the guard believes none for longer.
pub(super) const DEADLINE_MS: u16 = 200;

/// What a section may say.
#[cfg(test)]
const EXAMPLE_SECTION: &str = "[ros2]\naddress = \"192.168.1.5\"\n";

/// A robot in ROS 2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RosConfiguration {
    /// Its domain; without it that of `ROS_DOMAIN_ID`, or 0.
    pub domain: Option<u16>,
    /// This computer's address in the network where the others are; without it nobody but this computer hears or reaches it.
    pub address: Option<Ipv4Addr>,
    /// `run` waits for goals and drives there on the map of `[navigation]`.
    pub goals: bool,
}

/// A topic that a velocity comes on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RosTopic {
    /// Its name, such as `/cmd_vel`.
    pub name: String,
    /// How long a velocity holds, milliseconds.
    pub deadline_ms: u16,
}

impl RosTopic {
    /// Parses `ros2:/cmd_vel`: parts of letters, digits and underscores, none of which begins with a digit.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let name = text.strip_prefix("ros2:")?;
        let is_part = |part: &str| {
            part.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
                && part.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')
        };
        let is_topic = name.strip_prefix('/')?.split('/').all(is_part);
        is_topic.then(|| Self { name: name.to_owned(), deadline_ms: DEADLINE_MS })
    }
}

pub(super) fn read_ros2(top: &Reader<'_>, section: Reader<'_>) -> Option<RosConfiguration> {
    let domain = section.integer_or("domain", 0..=DOMAIN_MAX, 0);
    let domain = section.find("domain").and_then(|_| u16::try_from(domain).ok());
    let address = read_address(&section);
    let goals = section.flag_or("goals", false);
    if goals && top.find("navigation").is_none() {
        section.refuse(
            section.span(),
            "[ros2]: `goals` needs a map".to_owned(),
            "write [navigation] with map = \"hall.yaml\", or leave goals out",
        );
    }
    section.finish();
    Some(RosConfiguration { domain, address, goals })
}

fn read_address(section: &Reader<'_>) -> Option<Ipv4Addr> {
    let (text, span) = section.text_or_absent("address", "192.168.1.5", "this computer alone")?;
    let address = text.parse().ok().filter(|address: &Ipv4Addr| !address.is_loopback());
    if address.is_none() {
        section.refuse(
            &span,
            format!("[ros2]: `address` is \"{text}\", no address of this computer in a network"),
            "write for example \"192.168.1.5\", or leave it out to stay on this computer",
        );
    }
    address
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EXAMPLE, parse};

    fn read(section: &str) -> Result<Option<RosConfiguration>, String> {
        let parsed = parse("robot.toml", &format!("{EXAMPLE}\n{section}"));
        parsed.map(|configuration| configuration.ros2).map_err(|refused| refused.to_string())
    }

    #[test]
    fn ros2_stays_here_without_an_address() {
        assert_eq!(read(""), Ok(None));
        assert_eq!(read("[ros2]"), Ok(Some(RosConfiguration::default())));
        let known = read(&format!("{EXAMPLE_SECTION}domain = 7")).unwrap().unwrap();
        assert_eq!((known.domain, known.address), (Some(7), Some(Ipv4Addr::new(192, 168, 1, 5))));
        let goals = read("[ros2]\ngoals = true\n[navigation]").unwrap().unwrap();
        assert!(goals.goals && goals.domain.is_none());
    }

    #[test]
    fn topics_are_words_and_slashes() {
        assert_eq!(RosTopic::parse("ros2:/nav/cmd_vel2").unwrap().name, "/nav/cmd_vel2");
        for wrong in [
            "ros2:",
            "ros2:/",
            "ros2:cmd_vel",
            "ros2:/cmd vel",
            "ros2:/2fast",
            "ros2:/a//b",
            "ros2:/ä",
            "udp:/a",
        ] {
            assert_eq!(RosTopic::parse(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn wrong_sections_of_ros2_are_refused() {
        for (wrong, words) in [
            ("domain = 233", "domain"),
            ("address = \"robot\"", "no address of this computer"),
            ("address = \"127.0.0.1\"", "no address of this computer"),
            ("goals = true", "needs a map"),
            ("interface = \"lo\"", "interface"),
        ] {
            let refused = read(&format!("[ros2]\n{wrong}")).unwrap_err();
            assert!(refused.contains(words), "{wrong}: {refused}");
        }
    }
}
