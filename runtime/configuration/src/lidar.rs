//! `[lidar]`: model, address, mounting; of an Ouster what its metadata say.

use std::fmt::Write;

use floorguard_drivers::livox::{DEFAULT_ELEVATIONS_MDEG, HIGHEST_MDEG, LOWEST_MDEG};
use floorguard_drivers::ouster::{Beams, CHANNELS_MAX, DataFormat};
use floorguard_runtime::configuration::{LidarConfiguration, LidarModel};
use floorguard_types::capacities::SWEEP_RINGS;

use super::address::DatagramAddress;
use super::devices::{read_datagrams, read_mounting};
use super::reader::Reader;

/// Data formats by the names of the maker.
const FORMATS: [(&str, DataFormat); 4] = [
    ("RNG19_RFL8_SIG16_NIR16", DataFormat::Single),
    ("RNG19_RFL8_SIG16_NIR16_DUAL", DataFormat::Dual),
    ("RNG15_RFL8_NIR8", DataFormat::LowRate),
    ("LEGACY", DataFormat::Legacy),
];

/// A choice whose details follow in keys of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Chosen {
    Plain(LidarModel),
    Ouster,
    Bridged,
    Livox,
}

pub(super) fn read_lidar(section: Reader<'_>) -> Option<(LidarConfiguration, DatagramAddress)> {
    let models = [
        ("vlp16", Chosen::Plain(LidarModel::Vlp16)),
        ("auto", Chosen::Plain(LidarModel::Auto)),
        ("puck-hi-res", Chosen::Plain(LidarModel::PuckHiRes)),
        ("vlp32c", Chosen::Plain(LidarModel::Vlp32c)),
        ("hdl32e", Chosen::Plain(LidarModel::Hdl32e)),
        ("pandar-xt16", Chosen::Plain(LidarModel::PandarXt16)),
        ("pandar-xt32", Chosen::Plain(LidarModel::PandarXt32)),
        ("ouster", Chosen::Ouster),
        ("columns", Chosen::Bridged),
        ("livox-mid360", Chosen::Livox),
    ];
    let model = match section.choice("model", &models) {
        Some(Chosen::Plain(model)) => Some(model),
        Some(Chosen::Ouster) => read_ouster(&section).map(LidarModel::Ouster),
        Some(Chosen::Bridged) => read_elevations(&section, BRIDGED).map(LidarModel::Bridged),
        Some(Chosen::Livox) if section.find("elevations_deg").is_some() => {
            read_elevations(&section, LIVOX).map(LidarModel::LivoxMid360)
        }
        Some(Chosen::Livox) => Some(LidarModel::LivoxMid360(&DEFAULT_ELEVATIONS_MDEG)),
        None => None,
    };
    let source = match model {
        Some(LidarModel::Ouster(_)) => read_datagrams(&section, "udp:0.0.0.0:7502"),
        Some(LidarModel::LivoxMid360(_)) => read_datagrams(&section, "udp:0.0.0.0:56301"),
        _ => read_datagrams(&section, "udp:0.0.0.0:2368"),
    };
    let mounting = read_mounting(section.section("mounting"));
    section.finish();
    Some((LidarConfiguration { model: model?, mounting }, source?))
}

/// What `floorguard lidar-metadata` writes from the sensor's metadata.
fn read_ouster(section: &Reader<'_>) -> Option<&'static Beams> {
    let format = section.choice("profile", &FORMATS);
    let columns_per_turn = section.integer_or("columns_per_turn", 256..=4_096, 1_024) as u16;
    let columns_per_packet = section.integer_or("columns_per_packet", 1..=24, 16) as u8;
    let beam_origin_um = (section.number_or("beam_origin_mm", 0.0..=100.0, 0.0) * 1_000.0).round() as u32;
    let altitudes = read_angles(section, "beam_altitude_deg")?;
    let azimuths = read_angles(section, "beam_azimuth_deg")?;
    if altitudes.len() != azimuths.len() {
        section.refuse(
            section.span(),
            format!(
                "[lidar]: `beam_altitude_deg` has {} angles and `beam_azimuth_deg` {}",
                altitudes.len(),
                azimuths.len()
            ),
            "write both lists as floorguard lidar-metadata gives them",
        );
        return None;
    }
    let mut beams = Beams {
        format: format?,
        columns_per_turn,
        columns_per_packet,
        channels: altitudes.len() as u8,
        beam_origin_um,
        ..Beams::NONE
    };
    beams.altitude_mdeg[..altitudes.len()].copy_from_slice(&altitudes);
    beams.azimuth_mdeg[..azimuths.len()].copy_from_slice(&azimuths);
    if let Some(fault) = beams.fault() {
        section.refuse(section.span(), format!("[lidar]: {fault}"), "write what the sensor's metadata say");
        return None;
    }
    // A robot has one lidar, and it lives as long as the program.
    Some(Box::leak(Box::new(beams)))
}

/// What elevations of rings are allowed, thousandths of a degree, and which to write.
struct Allowed {
    mdeg: core::ops::RangeInclusive<i32>,
    remedy: &'static str,
}

/// Of a lidar behind a bridge.
const BRIDGED: Allowed = Allowed {
    mdeg: -89_000..=89_000,
    remedy: "let the bridge send those 16 rings that are nearest to -15°, -13° … 15°",
};
/// Of the rings that a Livox's points become.
const LIVOX: Allowed = Allowed {
    mdeg: LOWEST_MDEG..=HIGHEST_MDEG,
    remedy: "write 16 elevations between -7° and 52° of its own frame, 2° apart, or leave the key out",
};

/// Elevations of rings that the robot's file names.
fn read_elevations(section: &Reader<'_>, allowed: Allowed) -> Option<&'static [i32; SWEEP_RINGS]> {
    let (degrees, span) = section.angles("elevations_deg")?;
    let mdeg: Vec<i32> = degrees.iter().map(|degrees| (degrees * 1_000.0).round() as i32).collect();
    let Ok(elevations) = <[i32; SWEEP_RINGS]>::try_from(mdeg.as_slice()) else {
        let what = format!("[lidar]: `elevations_deg` has {} angles, allowed are {SWEEP_RINGS}", mdeg.len());
        section.refuse(&span, what, allowed.remedy);
        return None;
    };
    if !mdeg.windows(2).all(|pair| pair[0] < pair[1]) {
        section.refuse(&span, "[lidar]: `elevations_deg` does not rise", "write the lowest ring first");
        return None;
    }
    if let Some(out) = mdeg.iter().find(|mdeg| !allowed.mdeg.contains(mdeg)) {
        let what = format!(
            "[lidar]: `elevations_deg` has {:.1}°, where this lidar has no beam",
            f64::from(*out) * 1.0e-3
        );
        section.refuse(&span, what, allowed.remedy);
        return None;
    }
    // A robot has one lidar, and it lives as long as the program.
    Some(Box::leak(Box::new(elevations)))
}

/// Angles of the beams in thousandths of a degree: as many as the stages have rings, or more.
fn read_angles(section: &Reader<'_>, key: &'static str) -> Option<Vec<i32>> {
    let (degrees, span) = section.angles(key)?;
    if !(SWEEP_RINGS..=CHANNELS_MAX).contains(&degrees.len()) {
        section.refuse(
            &span,
            format!(
                "[lidar]: `{key}` has {} angles, allowed are {SWEEP_RINGS} to {CHANNELS_MAX}",
                degrees.len()
            ),
            "write one for each beam, as the sensor's metadata say",
        );
        return None;
    }
    Some(degrees.iter().map(|degrees| (f64::from(*degrees) * 1_000.0).round() as i32).collect())
}

/// The keys of `[lidar]` for a sensor.
#[must_use]
pub fn ouster_keys(beams: &Beams) -> String {
    let profile = FORMATS.iter().find(|(_, format)| *format == beams.format).map_or("", |(name, _)| name);
    let list = |mdeg: &[i32]| {
        let angles = mdeg.iter().take(usize::from(beams.channels));
        angles.map(|angle| format!("{:.3}", f64::from(*angle) * 1.0e-3)).collect::<Vec<_>>().join(", ")
    };
    let mut text = String::new();
    let _ = writeln!(text, "model = \"ouster\"");
    let _ = writeln!(text, "profile = \"{profile}\"");
    let _ = writeln!(text, "columns_per_turn = {}", beams.columns_per_turn);
    let _ = writeln!(text, "columns_per_packet = {}", beams.columns_per_packet);
    let _ = writeln!(text, "beam_origin_mm = {:.3}", f64::from(beams.beam_origin_um) * 1.0e-3);
    let _ = writeln!(text, "beam_altitude_deg = [{}]", list(&beams.altitude_mdeg));
    let _ = writeln!(text, "beam_azimuth_deg = [{}]", list(&beams.azimuth_mdeg));
    text
}

/// The data format of the maker's name for it.
#[must_use]
pub fn ouster_format(profile: &str) -> Option<DataFormat> {
    FORMATS.iter().find(|(name, _)| *name == profile).map(|(_, format)| *format)
}

/// The keys of `[lidar]` for a lidar of the elevations of a VLP-16 behind a bridge: for examples and simulated robots.
#[must_use]
pub fn bridged_keys() -> String {
    let elevations: Vec<String> =
        (0..16).map(|ring| format!("{:.1}", -15.0 + 2.0 * f64::from(ring))).collect();
    format!("model = \"columns\"\nelevations_deg = [{}]\n", elevations.join(", "))
}

/// The keys of `[lidar]` for a Livox Mid-360 on its head, which sees the floor and people: for examples and simulated robots.
#[must_use]
pub fn livox_keys() -> String {
    let elevations: Vec<String> =
        (0..16).map(|ring| format!("{:.1}", -6.0 + 2.0 * f64::from(ring))).collect();
    format!(
        "model = \"livox-mid360\"\nelevations_deg = [{}]\n\
         mounting = {{ x_m = 0.50, y_m = 0.0, z_m = 0.80, roll_deg = 180.0, pitch_deg = 0.0, yaw_deg = 0.0 }}\n",
        elevations.join(", ")
    )
}

/// A sensor like an OS1 with 32 beams, for examples and simulated robots.
#[must_use]
pub fn ouster_example() -> Beams {
    let mut beams = Beams { format: DataFormat::Single, ..Beams::even(32, (22_500, -22_500)) };
    beams.beam_origin_um = 15_806;
    for (azimuth, angle) in
        beams.azimuth_mdeg.iter_mut().zip([4_230, 1_410, -1_410, -4_230].into_iter().cycle())
    {
        *azimuth = angle;
    }
    beams
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EXAMPLE, parse};

    fn with_ouster(keys: &str) -> String {
        EXAMPLE.replace("model = \"vlp16\"\n", keys)
    }

    #[test]
    fn ouster_keys_give_the_same_beams() {
        for beams in
            [ouster_example(), Beams { format: DataFormat::Legacy, ..Beams::even(128, (45_000, -45_000)) }]
        {
            let text = with_ouster(&ouster_keys(&beams));
            let robot = parse("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}")).robot;
            let LidarModel::Ouster(read) = robot.lidar.model else { panic!("{:?}", robot.lidar.model) };
            let used = usize::from(beams.channels);
            assert_eq!(
                (read.format, read.channels, read.beam_origin_um),
                (beams.format, beams.channels, beams.beam_origin_um)
            );
            assert_eq!(read.altitude_mdeg[..used], beams.altitude_mdeg[..used]);
            assert_eq!(read.azimuth_mdeg[..used], beams.azimuth_mdeg[..used]);
            let guard = robot.guard();
            guard.validate().unwrap();
            assert_eq!(guard.lidar.elevations_rad.len(), 16);
            for (ring, elevation) in robot.ring_angles().rings.iter().zip(&guard.lidar.elevations_rad) {
                assert!(
                    (ring.0 - elevation.sin()).abs() < 1.0e-6,
                    "the people and the guard see the same rings"
                );
            }
        }
    }

    /// The rings of the second look are others than those of the first, and between them about the horizon.
    #[test]
    fn second_rings_of_each_model_interleave() {
        let ouster = |channels| {
            ouster_keys(&Beams { format: DataFormat::Single, ..Beams::even(channels, (22_500, -22_500)) })
        };
        let models = [
            ("model = \"pandar-xt32\"\n".to_owned(), 16),
            ("model = \"vlp32c\"\n".to_owned(), 16),
            ("model = \"hdl32e\"\n".to_owned(), 6),
            (ouster_keys(&ouster_example()), 4),
            (ouster(64), 16),
            (ouster(128), 16),
        ];
        for (keys, new_min) in models {
            let robot =
                parse("robot.toml", &with_ouster(&keys)).unwrap_or_else(|refused| panic!("{refused}")).robot;
            let first = robot.ring_angles().rings.map(|(sine, ..)| sine);
            let second = robot.second_ring_angles().unwrap_or_else(|| panic!("{keys}"));
            let second = second.rings.map(|(sine, ..)| sine);
            assert!(second.windows(2).all(|pair| pair[0] < pair[1]), "{keys}: lowest first");
            let new = |sine: &&f32| first.iter().all(|other| (other - **sine).abs() > 1.0e-4);
            assert!(second.iter().filter(new).count() >= new_min, "{keys}");
            // Of two neighbours of the first look on either side of the horizon, another one lies between.
            let below = first.iter().copied().filter(|sine| *sine <= 0.0).fold(-1.0, f32::max);
            let above = first.iter().copied().filter(|sine| *sine > 0.0).fold(1.0, f32::min);
            assert!(
                second.iter().filter(new).any(|sine| (below..above).contains(sine)) || above - below < 0.026,
                "{keys}"
            );
        }
        for keys in ["model = \"vlp16\"\n", "model = \"pandar-xt16\"\n", "model = \"puck-hi-res\"\n"] {
            let robot =
                parse("robot.toml", &with_ouster(keys)).unwrap_or_else(|refused| panic!("{refused}")).robot;
            assert_eq!(robot.second_ring_angles(), None, "{keys}");
        }
    }

    #[test]
    fn bridged_lidars_name_their_elevations() {
        let keys = bridged_keys();
        let robot =
            parse("robot.toml", &with_ouster(&keys)).unwrap_or_else(|refused| panic!("{refused}")).robot;
        for (ring, elevation) in robot.ring_angles().rings.iter().zip(&robot.guard().lidar.elevations_rad) {
            assert!((ring.0 - elevation.sin()).abs() < 1.0e-6);
        }
        for (from, to, words) in [
            ("-15.0, ", "", "has 15 angles"),
            ("-15.0, -13.0", "-13.0, -15.0", "does not rise"),
            ("elevations_deg", "elevation_deg", "elevations_deg"),
        ] {
            let refused =
                parse("robot.toml", &with_ouster(&keys.replace(from, to))).expect_err("refused").to_string();
            assert!(refused.contains(words), "{words} is not in: {refused}");
        }
    }

    /// What a Livox shows is up to a tenth of a second older: the fields are longer.
    #[test]
    fn fields_of_a_livox_are_longer() {
        let read = |text: &str| parse("robot.toml", text).unwrap_or_else(|refused| panic!("{refused}")).robot;
        let (turning, livox) = (read(EXAMPLE), read(&with_ouster("model = \"livox-mid360\"\n")));
        assert!((livox.limits.response_s - turning.limits.response_s - 0.1).abs() < 1.0e-6);
        let reach_m = |robot: &floorguard_runtime::configuration::RobotConfiguration| {
            let points = robot.fields.iter().flat_map(|field| field.protective.iter());
            points.map(|point| point.x_m).fold(0.0, f32::max)
        };
        assert!(reach_m(&livox) > reach_m(&turning) + 0.05, "{} m, {} m", reach_m(&livox), reach_m(&turning));
        for (keys, words) in [
            ("elevations_deg = [1.0, 2.0]\n", "has 2 angles"),
            (&bridged_keys().replace("model = \"columns\"\n", ""), "no beam"),
        ] {
            let text = with_ouster(&format!("model = \"livox-mid360\"\n{keys}"));
            let refused = parse("robot.toml", &text).expect_err("refused").to_string();
            assert!(refused.contains(words), "{words} is not in: {refused}");
        }
    }

    #[test]
    fn wrong_ouster_keys_are_refused() {
        let keys = ouster_keys(&ouster_example());
        for (from, to, words) in [
            ("\"ouster\"", "\"ouste\"", "did you mean `ouster`"),
            ("NIR16\"", "NIR\"", "did you mean `RNG19_RFL8_SIG16_NIR16`"),
            ("= 1024", "= 1000", "whole packets"),
            ("beam_altitude_deg = [22.500, ", "beam_altitude_deg = [", "31 angles"),
            ("beam_azimuth_deg = [4.230, 1.410", "beam_azimuth_deg = [44.230, 1.410", "64 columns apart"),
            ("beam_altitude_deg", "beam_altitudes", "beam_altitude_deg"),
        ] {
            assert!(keys.contains(from), "{from}");
            let refused =
                parse("robot.toml", &with_ouster(&keys.replace(from, to))).expect_err("refused").to_string();
            assert!(refused.contains(words), "{words} is not in: {refused}");
        }
    }
}
