//! `floorguard lidar-metadata FILE.json`: the keys of `[lidar]` from the metadata that an Ouster serves.

use std::path::PathBuf;

use clap::Args;
use floorguard_configuration::{ouster_format, ouster_keys};
use floorguard_drivers::ouster::{Beams, CHANNELS_MAX};
use serde_json::Value;

use floorguard_host::outcome::BadInput;

/// What to read.
#[derive(Clone, Debug, Args)]
pub struct LidarMetadataArguments {
    /// The sensor's metadata, as `http://SENSOR/api/v1/sensor/metadata` gives them.
    pub file: PathBuf,
}

/// Prints the keys.
///
/// # Errors
/// The file is no metadata, or of a sensor that cannot be used.
pub fn run(arguments: &LidarMetadataArguments) -> anyhow::Result<()> {
    let name = arguments.file.display();
    let text = std::fs::read_to_string(&arguments.file)
        .map_err(|error| BadInput(format!("{name}: cannot be read ({error})")))?;
    let beams = beams_of(&text).map_err(|why| BadInput(format!("{name}: {why}")))?;
    tell!("[lidar]\n{}", ouster_keys(&beams).trim_end())?;
    Ok(())
}

/// The sensor that metadata describe: those with sections, and the older ones without.
fn beams_of(text: &str) -> Result<Beams, String> {
    let metadata: Value = serde_json::from_str(text).map_err(|error| format!("no JSON ({error})"))?;
    let format = found(&metadata, &["lidar_data_format", "data_format"]);
    let number = |key: &str, otherwise: u64| {
        let value =
            found(&metadata, &["lidar_data_format", "data_format"]).and_then(|format| format.get(key));
        value.and_then(Value::as_u64).unwrap_or(otherwise)
    };
    // Sensors before the profiles existed send the old format.
    let profile = format.and_then(|format| format.get("udp_profile_lidar")).and_then(Value::as_str);
    let profile = profile.unwrap_or("LEGACY");
    let mut beams = Beams {
        format: ouster_format(profile).ok_or_else(|| {
            format!("its profile is {profile}; set the sensor to RNG19_RFL8_SIG16_NIR16, its DUAL, RNG15_RFL8_NIR8 or LEGACY")
        })?,
        columns_per_turn: u16::try_from(number("columns_per_frame", mode_columns(&metadata))).unwrap_or(0),
        columns_per_packet: u8::try_from(number("columns_per_packet", 16)).unwrap_or(0),
        ..Beams::NONE
    };
    let altitudes = angles(&metadata, "beam_altitude_angles")?;
    let azimuths = angles(&metadata, "beam_azimuth_angles")?;
    if altitudes.len() != azimuths.len() || altitudes.len() > CHANNELS_MAX {
        return Err(format!("{} altitude and {} azimuth angles", altitudes.len(), azimuths.len()));
    }
    beams.channels = altitudes.len() as u8;
    beams.altitude_mdeg[..altitudes.len()].copy_from_slice(&altitudes);
    beams.azimuth_mdeg[..azimuths.len()].copy_from_slice(&azimuths);
    let origin_mm = found(&metadata, &["lidar_origin_to_beam_origin_mm"]).and_then(Value::as_f64);
    beams.beam_origin_um = (origin_mm.unwrap_or(0.0) * 1_000.0).round().max(0.0) as u32;
    beams.fault().map_or(Ok(beams), |fault| Err(fault.to_owned()))
}

/// The first of the keys, at the top or within a section.
fn found<'a>(metadata: &'a Value, keys: &[&str]) -> Option<&'a Value> {
    let sections = || metadata.as_object().into_iter().flat_map(|sections| sections.values());
    keys.iter().find_map(|key| metadata.get(key).or_else(|| sections().find_map(|section| section.get(key))))
}

/// Columns of a mode such as `1024x10`.
fn mode_columns(metadata: &Value) -> u64 {
    let mode = found(metadata, &["lidar_mode"]).and_then(Value::as_str).unwrap_or("");
    mode.split_once('x').and_then(|(columns, _)| columns.parse().ok()).unwrap_or(1_024)
}

/// Thousandths of a degree.
fn angles(metadata: &Value, key: &str) -> Result<Vec<i32>, String> {
    let list =
        found(metadata, &[key]).and_then(Value::as_array).ok_or_else(|| format!("`{key}` is missing"))?;
    let angle = |value: &Value| value.as_f64().map(|degrees| (degrees * 1_000.0).round() as i32);
    list.iter().map(angle).collect::<Option<_>>().ok_or_else(|| format!("`{key}` holds no angles"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_drivers::ouster::DataFormat;

    #[test]
    fn metadata_with_and_without_sections_are_read() {
        let angles = |from: f64, step: f64| {
            (0..16).map(|beam| (from - step * f64::from(beam)).to_string()).collect::<Vec<_>>().join(",")
        };
        let beams = format!(
            "\"beam_altitude_angles\":[{}],\"beam_azimuth_angles\":[{}],\"lidar_origin_to_beam_origin_mm\":15.806",
            angles(15.0, 2.0),
            angles(1.5, 0.2)
        );
        let format = "{\"columns_per_frame\":2048,\"columns_per_packet\":16,\"udp_profile_lidar\":\"RNG15_RFL8_NIR8\"}";
        let new = format!("{{\"beam_intrinsics\":{{{beams}}},\"lidar_data_format\":{format}}}");
        let read = beams_of(&new).unwrap();
        assert_eq!((read.format, read.columns_per_turn, read.channels), (DataFormat::LowRate, 2_048, 16));
        assert_eq!(
            (read.altitude_mdeg[15], read.azimuth_mdeg[0], read.beam_origin_um),
            (-15_000, 1_500, 15_806)
        );
        let old = format!("{{{beams},\"lidar_mode\":\"512x10\"}}");
        let read = beams_of(&old).unwrap();
        assert_eq!(
            (read.format, read.columns_per_turn, read.columns_per_packet),
            (DataFormat::Legacy, 512, 16)
        );
        for (text, words) in [
            ("[", "no JSON"),
            ("{}", "`beam_altitude_angles` is missing"),
            (&new.replace("RNG15_RFL8_NIR8", "FUSA"), "its profile is FUSA"),
            (&new.replace("2048", "100"), "whole packets"),
        ] {
            let refused = beams_of(text).expect_err("refused");
            assert!(refused.contains(words), "{words} is not in: {refused}");
        }
    }
}
