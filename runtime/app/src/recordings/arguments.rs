//! The command line of what reads recordings.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// What to decode.
#[derive(Clone, Debug, Args)]
pub struct DecodeArguments {
    /// The capture: .pcap, .pcapng, either of them .gz; or the bytes of an inertial sensor's line.
    pub file: PathBuf,
    /// Which lidar made it.
    #[arg(long, default_value = "auto")]
    pub model: ModelArgument,
    /// Comma-separated values on standard output.
    #[arg(long)]
    pub csv: bool,
}

/// What to replay.
#[derive(Clone, Debug, Args)]
pub struct ReplayArguments {
    /// A recording of `--record` or a ROS 2 bag (.mcap), a capture of a lidar or a microScan3 (.pcap, .pcapng, .gz), a
    /// CARMEN log (.clf, .log, .gz, .bz2), or the bytes of an S300's line.
    pub file: PathBuf,
    /// Which lidar made a capture.
    #[arg(long, default_value = "auto")]
    pub model: ModelArgument,
    /// How the lidar of a capture is tilted, roll and pitch in degrees, for example `180,0` upside down.
    #[arg(long, value_name = "ROLL,PITCH", allow_hyphen_values = true, value_parser = tilt, default_value = "0,0")]
    pub tilt: Tilt,
    /// One object per sweep or scan and line on standard output.
    #[arg(long)]
    pub json: bool,
    /// Of a bag, only this topic of point clouds or scans.
    #[arg(long)]
    pub topic: Option<String>,
    /// Of a capture, a bag or a log: write what it holds and what was found as a recording, for viewers and `report`.
    #[arg(long, value_name = "FILE.mcap")]
    pub record: Option<PathBuf>,
    /// As fast as it was recorded instead of as fast as possible.
    #[arg(long)]
    pub realtime: bool,
    /// Of a recording of floorguard: also end with code 1 when there was nothing to compare today's code with, or only a
    /// part of the run.
    #[arg(long)]
    pub check: bool,
}

/// How a lidar is mounted besides its height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tilt {
    /// About the axis that points ahead, degrees.
    pub roll_deg: f32,
    /// About the axis that points to the left, degrees; positive looks down.
    pub pitch_deg: f32,
}

impl Tilt {
    /// Not at all.
    pub const UPRIGHT: Self = Self { roll_deg: 0.0, pitch_deg: 0.0 };
}

/// `ROLL,PITCH` in degrees.
///
/// # Errors
/// What is wrong with it.
pub fn tilt(text: &str) -> Result<Tilt, String> {
    let number = |part: &str| part.trim().parse::<f32>().ok().filter(|degrees| degrees.abs() <= 180.0);
    let parts = text.split_once(',').and_then(|(roll, pitch)| Some((number(roll)?, number(pitch)?)));
    let (roll_deg, pitch_deg) = parts.ok_or("write roll and pitch in degrees, for example 180,0")?;
    Ok(Tilt { roll_deg, pitch_deg })
}

/// Lidar models by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ModelArgument {
    /// Tell from the packets.
    #[default]
    Auto,
    /// VLP-16 or Puck LITE.
    Vlp16,
    /// Puck Hi-Res.
    PuckHiRes,
    /// VLP-32C.
    Vlp32c,
    /// HDL-32E.
    Hdl32e,
}
