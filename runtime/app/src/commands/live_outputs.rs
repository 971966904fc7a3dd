//! `--foxglove`, `--ros2` and how recordings are packed: the same for every command that runs a robot.

use std::net::SocketAddr;

use clap::{Args, ValueEnum};
use floorguard_recording::{Compression, MessageListener};

use super::ros2::{RosDomain, ros_domain};
use super::values::panel_address;

/// What is shown live, and how a recording is packed.
#[derive(Clone, Debug, Default, Args)]
pub struct LiveOutputs {
    /// Show the run live in Foxglove, with everything that a recording holds: `--foxglove 127.0.0.1:8765`, then open
    /// `ws://127.0.0.1:8765` there. Every program that reaches the address may watch. Needs the feature `foxglove`.
    #[arg(long, value_name = "ADDRESS:PORT", value_parser = panel_address)]
    pub foxglove: Option<SocketAddr>,
    /// Show the robot live in ROS 2, as a node that publishes /tf, /scan, /people and everything else of a recording, and takes
    /// pause, resume and reset: `--ros2`, or in another domain `--ros2=7`. On this computer alone, unless `[ros2]` gives an address.
    /// There is no DDS security. Needs the feature `ros2`.
    #[arg(long, value_name = "DOMAIN", num_args = 0..=1, require_equals = true, default_missing_value = "", value_parser = ros_domain)]
    pub ros2: Option<RosDomain>,
    /// Pack the recording. A cut then costs a quarter of a second. Needs the feature `compression`.
    #[arg(long, value_enum, default_value_t, requires = "record")]
    pub record_compression: RecordCompression,
}

/// How a recording is packed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum RecordCompression {
    /// Not at all.
    #[default]
    None,
    /// LZ4: fast.
    Lz4,
    /// Zstandard: small.
    Zstd,
}

impl From<RecordCompression> for Compression {
    fn from(chosen: RecordCompression) -> Self {
        match chosen {
            RecordCompression::None => Self::None,
            RecordCompression::Lz4 => Self::Lz4,
            RecordCompression::Zstd => Self::Zstd,
        }
    }
}

impl LiveOutputs {
    /// Opens what is shown live; what it gives is to hear every message of the run.
    ///
    /// # Errors
    /// The address is taken, or the program was built without it.
    pub fn open(&self, title: &str) -> anyhow::Result<Option<Box<dyn MessageListener>>> {
        self.foxglove.map(|address| foxglove(address, title)).transpose()
    }
}

#[cfg(feature = "foxglove")]
fn foxglove(address: SocketAddr, title: &str) -> anyhow::Result<Box<dyn MessageListener>> {
    let server = floorguard_foxglove::FoxgloveServer::open(address, title)
        .map_err(|error| super::exit::BadInput(error.to_string()))?;
    let address = server.address();
    say!("  Foxglove: open ws://{address} there");
    if !address.ip().is_loopback() {
        say!(
            "  Foxglove: every program that reaches {address} sees the run; nothing is encrypted, there is no password"
        );
    }
    Ok(Box::new(server))
}

#[cfg(not(feature = "foxglove"))]
fn foxglove(_address: SocketAddr, _title: &str) -> anyhow::Result<Box<dyn MessageListener>> {
    let what = "--foxglove: this program was built without it; build it with `--features foxglove`";
    Err(super::exit::WrongUsage(what.to_owned()).into())
}
