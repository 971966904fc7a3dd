//! The fleet that a robot belongs to: its broker, and the robot's name there.

use std::path::PathBuf;

use super::reader::Reader;

/// Port of a broker, without and with encryption.
const PORT: i64 = 1_883;

/// A robot in a fleet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FleetConfiguration {
    /// Name or address of the broker.
    pub broker: String,
    /// Its port.
    pub port: u16,
    /// Certificates of the authority that signed the broker's, PEM, relative to the folder of the file; with it the connection is
    /// encrypted.
    pub authority: Option<PathBuf>,
    /// The robot's name at the broker; its password is in the environment variable `FLOORGUARD_FLEET_PASSWORD`.
    pub user: Option<String>,
    /// First level of the topics.
    pub interface: String,
    /// The robot's maker, as the fleet calls it.
    pub manufacturer: String,
    /// The robot's number, as the fleet calls it.
    pub serial: String,
    /// Name of the map of `[navigation]`, as the fleet calls it.
    pub map_id: String,
    /// The broker is spoken to by MQTT 5; otherwise by 3.1.1.
    pub is_mqtt_5: bool,
}

impl FleetConfiguration {
    /// A robot without a file: at a broker that encrypts nothing.
    #[must_use]
    pub fn at(broker: String, port: u16, serial: String) -> Self {
        Self {
            broker,
            port,
            authority: None,
            user: None,
            interface: "uagv".to_owned(),
            manufacturer: "floorguard".to_owned(),
            serial,
            map_id: "map".to_owned(),
            is_mqtt_5: false,
        }
    }
}

pub(super) fn read_fleet(section: Reader<'_>) -> Option<FleetConfiguration> {
    let broker = level(&section, "broker", "fleet.example.com", None);
    let port = section.integer_or("port", 1..=65_535, PORT) as u16;
    let absent = |key: &'static str, example: &str, what: &str| {
        section.text_or_absent(key, example, what).map(|(text, _)| text.to_owned())
    };
    let authority = absent("authority", "broker.pem", "no encryption").map(PathBuf::from);
    let user = absent("user", "robot-7", "no name and no password");
    let interface = level(&section, "interface", "uagv", Some("uagv"));
    let manufacturer = level(&section, "manufacturer", "floorguard", Some("floorguard"));
    let serial = level(&section, "serial", "robot-7", None);
    let map_id = level(&section, "map_id", "map", Some("map"));
    let is_mqtt_5 = section.choice_or("mqtt", &[("3.1.1", false), ("5", true)], false);
    section.finish();
    Some(FleetConfiguration {
        broker: broker?,
        port,
        authority,
        user,
        interface: interface?,
        manufacturer: manufacturer?,
        serial: serial?,
        map_id: map_id?,
        is_mqtt_5,
    })
}

/// A text that can be a level of a topic.
fn level(section: &Reader<'_>, key: &'static str, example: &str, default: Option<&str>) -> Option<String> {
    let found = match default {
        Some(default) => section.text_or_absent(key, example, &format!("\"{default}\"")),
        None => section.text(key, example),
    };
    let Some((text, span)) = found else { return default.map(str::to_owned) };
    if text.is_empty() || text.contains(['/', '+', '#', '$']) || text.contains(char::is_whitespace) {
        section.refuse(
            &span,
            format!("[fleet]: `{key}` is \"{text}\", no level of a topic"),
            format!("write a word without /, +, #, $ and blanks, for example \"{example}\""),
        );
    }
    Some(text.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EXAMPLE, parse};

    #[test]
    fn fleet_is_read_and_bad_levels_are_refused() {
        let read = |section: &str| {
            let parsed = parse("robot.toml", &format!("{EXAMPLE}\n{section}"));
            parsed.map(|configuration| configuration.fleet).map_err(|refused| refused.to_string())
        };
        assert_eq!(read(""), Ok(None));
        let own = read("[fleet]\nbroker = \"127.0.0.1\"\nserial = \"robot-7\"").unwrap().unwrap();
        assert_eq!(own, FleetConfiguration::at("127.0.0.1".to_owned(), 1_883, "robot-7".to_owned()));
        let newer = read("[fleet]\nbroker = \"b\"\nserial = \"a\"\nmqtt = \"5\"").unwrap().unwrap();
        assert!(newer.is_mqtt_5);
        for (wrong, reported) in [
            ("serial = \"a\"", "broker"),
            ("broker = \"b\"\nserial = \"a/b\"", "no level of a topic"),
            ("broker = \"b\"\nserial = \"a\"\nport = 0", "port"),
            ("broker = \"b\"\nserial = \"a\"\nbrokers = 1", "brokers"),
            ("broker = \"b\"\nserial = \"a\"\nmqtt = \"4\"", "mqtt"),
        ] {
            let refused = read(&format!("[fleet]\n{wrong}")).unwrap_err();
            assert!(refused.contains(reported), "{wrong}: {refused}");
        }
    }
}
