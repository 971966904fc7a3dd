//! What the operator's panel shows besides the robot itself: parts that wear out, levels, other robots.

use std::ops::Range;

use floorguard_drivers::flexisoft::InputBits;
use floorguard_runtime::configuration::CanConfiguration;

use super::reader::Reader;

/// Other robots, and parts that wear out, that a page can show.
const LIST_MAX: usize = 16;
/// Letters of a name.
const NAME_MAX: usize = 40;
/// Shortest and longest life of a part, hours.
const LIFE_H: (f32, f32) = (1.0, 20_000.0);

/// A part that wears out.
#[derive(Clone, Debug, PartialEq)]
pub struct Consumable {
    /// Name, as the operator calls it.
    pub name: String,
    /// Hours of driving after which it is changed.
    pub life_h: f32,
}

/// Another robot whose panel is read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OtherRobot {
    /// Name, as the operator calls it.
    pub name: String,
    /// Host and port of its panel.
    pub host: String,
}

/// Levels that the safety controller reports as single bits of its image, 1 = reported.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LevelBits {
    /// The battery must be charged.
    pub battery_low: Option<u8>,
    /// Clean water must be filled in.
    pub clean_water_low: Option<u8>,
    /// Dirty water must be let out.
    pub dirty_water_full: Option<u8>,
}

/// What the panel shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PanelConfiguration {
    /// Other robots of the site.
    pub robots: Vec<OtherRobot>,
    /// Parts that wear out.
    pub consumables: Vec<Consumable>,
    /// Levels as bits.
    pub levels: LevelBits,
    /// CAN node of a battery computer: the first byte of its message 0x180 + node is the charge, percent.
    pub battery_node: Option<u8>,
}

pub(super) fn read_panel(section: Reader<'_>, can: Option<&CanConfiguration>) -> PanelConfiguration {
    let robots = section.texts("robots", "[\"Hall B http://192.168.1.12:8080\"]");
    let robots = named(&section, "robots", robots, |text| {
        let (name, address) = text.rsplit_once(' ')?;
        let host = address.strip_prefix("http://")?.trim_end_matches('/');
        let (computer, port) = host.rsplit_once(':')?;
        let is_host = !computer.is_empty() && !computer.contains(['/', '#', '@', ' ']);
        port.parse::<u16>().ok().filter(|_| is_host)?;
        Some(OtherRobot { name: name_of(name)?, host: host.to_owned() })
    });
    let consumables = section.texts("consumables", "[\"brushes 200 h\"]");
    let consumables = named(&section, "consumables", consumables, |text| {
        let (name, life) = text.strip_suffix('h')?.trim_end().rsplit_once(' ')?;
        let life_h = life.parse::<f32>().ok().filter(|life_h| (LIFE_H.0..=LIFE_H.1).contains(life_h))?;
        Some(Consumable { name: name_of(name)?, life_h })
    });
    let bit = |key| section.integer_or_absent(key, 0..=255).map(|bit| bit as u8);
    let levels = LevelBits {
        battery_low: bit("battery_low_bit"),
        clean_water_low: bit("clean_water_low_bit"),
        dirty_water_full: bit("dirty_water_full_bit"),
    };
    check_levels(&section, &levels, can);
    let battery_node = section.integer_or_absent("battery_node", 1..=127).map(|node| node as u8);
    if let Some(node) = battery_node.filter(|node| can.is_some_and(|can| nodes(can).contains(node))) {
        section.refuse(
            section.span(),
            format!("[panel]: node {node} of `battery_node` is another device of [can]"),
            "give each device a node of its own",
        );
    }
    section.finish();
    PanelConfiguration { robots, consumables, levels, battery_node }
}

fn name_of(text: &str) -> Option<String> {
    let name = text.trim();
    (!name.is_empty() && name.chars().count() <= NAME_MAX).then(|| name.to_owned())
}

/// What has a name: each name once, and not too many.
fn named<T: Named>(
    section: &Reader<'_>,
    key: &'static str,
    texts: Vec<(&str, Range<usize>)>,
    read: impl Fn(&str) -> Option<T>,
) -> Vec<T> {
    let mut found = Vec::<T>::new();
    for (text, span) in texts {
        let item = read(text);
        let is_known =
            item.as_ref().is_some_and(|item| found.iter().any(|known| known.name() == item.name()));
        match item {
            Some(item) if !is_known && found.len() < LIST_MAX => found.push(item),
            _ => section.refuse(
                &span,
                format!("[panel]: `{key}` cannot hold \"{text}\""),
                format!("write up to {LIST_MAX} different ones as {}", T::EXAMPLE),
            ),
        }
    }
    found
}

trait Named {
    /// How one is written.
    const EXAMPLE: &'static str;
    fn name(&self) -> &str;
}

impl Named for OtherRobot {
    const EXAMPLE: &'static str = "\"Hall B http://192.168.1.12:8080\": name, address and port of its panel";

    fn name(&self) -> &str {
        &self.name
    }
}

impl Named for Consumable {
    const EXAMPLE: &'static str = "\"brushes 200 h\": name, and 1 to 20000 hours of driving";

    fn name(&self) -> &str {
        &self.name
    }
}

fn nodes(can: &CanConfiguration) -> Vec<u8> {
    let fitted =
        [can.drive_node, can.steering_node, can.left_encoder_node, can.right_encoder_node, can.inputs_node];
    fitted.into_iter().chain(can.dirt_sensor_node).collect()
}

/// A bit means one level.
fn check_levels(section: &Reader<'_>, levels: &LevelBits, can: Option<&CanConfiguration>) {
    let own = [
        ("battery_low_bit", levels.battery_low),
        ("clean_water_low_bit", levels.clean_water_low),
        ("dirty_water_full_bit", levels.dirty_water_full),
    ];
    let bits = |input: Option<InputBits>| input.map_or([None; 2], |input| input.bits.map(Some));
    let safety: Vec<u8> = can.map_or(Vec::new(), |can| {
        let map = &can.inputs;
        let all = [
            Some(map.emergency_stop),
            Some(map.bumper_front),
            map.bumper_rear,
            map.cliff_front,
            map.cliff_rear,
        ];
        let buttons = [can.buttons.reset_bit, can.buttons.start_bit];
        all.into_iter().flat_map(bits).chain(buttons).flatten().collect()
    });
    for (index, (key, bit)) in own.iter().enumerate() {
        let Some(bit) = bit else { continue };
        let is_twice = own.iter().take(index).any(|(_, other)| other.as_ref() == Some(bit));
        if is_twice || safety.contains(bit) {
            section.refuse(
                section.span(),
                format!("[panel]: bit {bit} of `{key}` has another meaning already"),
                "give each input a bit of its own",
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EXAMPLE, parse};

    fn read(section: &str) -> Result<PanelConfiguration, String> {
        let parsed = parse("robot.toml", &format!("{EXAMPLE}\n{section}"));
        parsed.map(|configuration| configuration.panel).map_err(|refused| refused.to_string())
    }

    #[test]
    fn panel_section_is_read() {
        assert_eq!(read(""), Ok(PanelConfiguration::default()));
        let panel = read(
            "[panel]\nrobots = [\"Hall B http://10.0.0.7:8080/\"]\nconsumables = [\"side brush 150 h\"]\n\
             battery_low_bit = 60\nbattery_node = 9",
        )
        .unwrap();
        assert_eq!(panel.robots, [OtherRobot { name: "Hall B".into(), host: "10.0.0.7:8080".into() }]);
        assert_eq!(panel.consumables, [Consumable { name: "side brush".into(), life_h: 150.0 }]);
        assert_eq!((panel.levels.battery_low, panel.battery_node), (Some(60), Some(9)));
    }

    #[test]
    fn wrong_panel_sections_are_refused() {
        for (wrong, reported) in [
            ("robots = [\"http://10.0.0.7:8080\"]", "`robots` cannot hold"),
            ("robots = [\"B https://10.0.0.7:8080\"]", "`robots` cannot hold"),
            ("robots = [\"B http://10.0.0.7\"]", "`robots` cannot hold"),
            ("robots = [\"B http://a:1\", \"B http://b:1\"]", "`robots` cannot hold"),
            ("consumables = [\"brushes\"]", "`consumables` cannot hold"),
            ("consumables = [\"brushes 0 h\"]", "`consumables` cannot hold"),
            ("consumables = \"brushes 5 h\"", "a list of texts"),
            ("battery_low_bit = 32", "has another meaning already"),
            ("battery_low_bit = 60\nclean_water_low_bit = 60", "has another meaning already"),
            ("battery_node = 0", "battery_node"),
            ("battery_node = 3", "is another device of [can]"),
            ("robot = []", "did you mean `robots`"),
        ] {
            let refused = read(&format!("[panel]\n{wrong}")).unwrap_err();
            assert!(refused.contains(reported), "{wrong}: {refused}");
        }
    }
}
