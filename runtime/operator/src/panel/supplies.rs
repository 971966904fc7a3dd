//! What the robot uses up: charge, water, parts that wear out. Shown to people; the guard does not know it.

use std::collections::BTreeMap;

use floorguard_configuration::PanelConfiguration;
use floorguard_types::time::{Age, Stamp};
use serde::Serialize;

use super::records::PartUse;

/// What was not heard for longer is unknown, microseconds.
const SILENT_MAX_US: u64 = 3_000_000;
/// First identifier of the objects of an image; each further object lies this much higher (CiA 301, 7.3.5).
const OBJECT_IDS: u16 = 0x180;
const OBJECT_STEP: u16 = 0x100;
/// Bits of an object.
const OBJECT_BITS: u8 = 64;
/// More is no charge, percent.
const CHARGE_MAX: u8 = 100;

/// A level that the safety controller reports as a bit.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LevelFrame {
    /// What is reported, in words.
    pub name: &'static str,
    /// Whether it is; `None`: nothing was heard lately.
    pub reported: Option<bool>,
}

/// A part that wears out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartFrame {
    /// Name.
    pub name: String,
    /// Driven with it, hours.
    pub used_h: f64,
    /// Hours after which it is changed.
    pub life_h: f32,
    /// When it was changed, RFC 3339; empty if never.
    pub changed: String,
}

/// What a page shows of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SuppliesFrame {
    /// There is a battery computer.
    pub has_battery: bool,
    /// Charge, percent; `None`: nothing was heard lately.
    pub charge_percent: Option<u8>,
    /// Levels.
    pub levels: Vec<LevelFrame>,
    /// Parts.
    pub parts: Vec<PartFrame>,
}

struct Level {
    name: &'static str,
    bit: u8,
    heard: Option<(Stamp, bool)>,
}

/// Listens to the bus.
pub struct Supplies {
    configured: PanelConfiguration,
    inputs_node: u8,
    charge: Option<(Stamp, u8)>,
    levels: Vec<Level>,
    newest: Stamp,
}

impl Supplies {
    /// For a robot whose safety controller is this node.
    pub fn new(configured: &PanelConfiguration, inputs_node: u8) -> Self {
        let bits = &configured.levels;
        let levels = [
            ("battery low", bits.battery_low),
            ("clean water low", bits.clean_water_low),
            ("dirty water full", bits.dirty_water_full),
        ];
        let level = |(name, bit): (&'static str, Option<u8>)| Some(Level { name, bit: bit?, heard: None });
        Self {
            configured: configured.clone(),
            inputs_node,
            charge: None,
            levels: levels.into_iter().filter_map(level).collect(),
            newest: Stamp::ZERO,
        }
    }

    /// A frame of the bus as recordings hold it: identifier in two bytes, the lower first, then the data.
    pub fn can_frame(&mut self, bytes: &[u8], at: Stamp) {
        let Some((id, payload)) = bytes.split_first_chunk::<2>() else { return };
        let id = u16::from_le_bytes(*id);
        self.newest = at;
        let (node, above) = (id & 0x7F, (id & !0x7F).checked_sub(OBJECT_IDS));
        if self.configured.battery_node.is_some_and(|battery| u16::from(battery) == node) && above == Some(0)
        {
            let charge = payload.first().copied().filter(|percent| *percent <= CHARGE_MAX);
            self.charge = charge.map(|percent| (at, percent)).or(self.charge);
        }
        let Some(above) =
            above.filter(|above| node == u16::from(self.inputs_node) && above % OBJECT_STEP == 0)
        else {
            return;
        };
        for level in &mut self.levels {
            let byte = payload.get(usize::from(level.bit % OBJECT_BITS / 8));
            if let Some(byte) = byte.filter(|_| above / OBJECT_STEP == u16::from(level.bit / OBJECT_BITS)) {
                level.heard = Some((at, byte & (1 << (level.bit % 8)) != 0));
            }
        }
    }

    /// Now, with the parts as they are kept. `None` for a robot that reports nothing of the kind.
    pub fn frame(&self, now: Stamp, kept: &BTreeMap<String, PartUse>) -> Option<SuppliesFrame> {
        let has_battery = self.configured.battery_node.is_some();
        if !has_battery && self.levels.is_empty() && self.configured.consumables.is_empty() {
            return None;
        }
        let is_new =
            |at: &Stamp| matches!(at.age(now.max(self.newest)), Age::Past(us) if us <= SILENT_MAX_US);
        let charge = self.charge.filter(|(at, _)| is_new(at)).map(|(_, percent)| percent);
        let level = |level: &Level| LevelFrame {
            name: level.name,
            reported: level.heard.filter(|(at, _)| is_new(at)).map(|(_, reported)| reported),
        };
        let parts = self.configured.consumables.iter().map(|part| {
            let kept = kept.get(&part.name).cloned().unwrap_or_default();
            let used_h = (kept.used_s / 36.0).round() / 100.0;
            PartFrame { name: part.name.clone(), used_h, life_h: part.life_h, changed: kept.changed }
        });
        Some(SuppliesFrame {
            has_battery,
            charge_percent: charge,
            levels: self.levels.iter().map(level).collect(),
            parts: parts.collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_configuration::LevelBits;

    const INPUTS: u8 = 5;

    fn frame(id: u16, data: &[u8]) -> Vec<u8> {
        id.to_le_bytes().iter().chain(data).copied().collect()
    }

    #[test]
    fn levels_come_from_the_bus_and_age() {
        let levels = LevelBits { clean_water_low: Some(66), ..LevelBits::default() };
        let configured =
            PanelConfiguration { levels, battery_node: Some(9), ..PanelConfiguration::default() };
        let mut supplies = Supplies::new(&configured, INPUTS);
        let seen = |supplies: &Supplies, at_us| {
            let frame = supplies.frame(Stamp::from_micros(at_us), &BTreeMap::new()).expect("levels");
            (frame.charge_percent, frame.levels.first().and_then(|level| level.reported))
        };
        assert_eq!(seen(&supplies, 0), (None, None));
        let at = Stamp::from_micros(1_000_000);
        supplies.can_frame(&frame(0x189, &[73, 0]), at);
        supplies.can_frame(&frame(0x285, &[0b100]), at);
        assert_eq!(seen(&supplies, 1_000_000), (Some(73), Some(true)));
        // The first object has other bits, another node is another device, 200 % is no charge.
        for other in
            [frame(0x185, &[0]), frame(0x286, &[0]), frame(0x289, &[5]), frame(0x189, &[200]), vec![1]]
        {
            supplies.can_frame(&other, at);
        }
        assert_eq!(seen(&supplies, 1_000_000), (Some(73), Some(true)));
        supplies.can_frame(&frame(0x285, &[0]), at);
        assert_eq!(seen(&supplies, 4_000_000), (Some(73), Some(false)));
        assert_eq!(seen(&supplies, 4_000_001), (None, None), "silence is unknown, not good");
    }
}
