//! The command line of what reads recordings.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// What to decode.
#[derive(Clone, Debug, Args)]
pub struct DecodeArguments {
    /// The capture: .pcap, .pcapng, either of them .gz; or the bytes of an MTi's line.
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
    /// A recording of `--record` or a ROS 2 bag (.mcap), a lidar capture (.pcap, .pcapng, .gz), a CARMEN log (.clf,
    /// .log, .gz, .bz2), or the bytes of an S300's line.
    pub file: PathBuf,
    /// Which lidar made a capture.
    #[arg(long, default_value = "auto")]
    pub model: ModelArgument,
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
