//! The command line.

use std::path::PathBuf;

use clap::Args;

/// What to clean.
#[derive(Clone, Debug, Args)]
#[command(
    after_help = "Examples: floorguard clean-map puck.pcap --poses trajectory.tum --out clean\n          \
                        floorguard clean-map standing-lidar.pcap.gz --out clean"
)]
pub struct CleanArguments {
    /// Captures of a Velodyne lidar (.pcap, .pcapng; packed or not). Several surveys of one building are cleaned together: what
    /// stood through one of them and is gone in another leaves the map.
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// Poses of the lidar in the map (TUM format: time x y z qx qy qz qw), for each file one; times are those of the capture,
    /// or seconds since its first packet. Without any, the lidar stands still.
    #[arg(long, value_name = "FILE.tum")]
    pub poses: Vec<PathBuf>,
    /// The folder of the clouds; made if it is not there, files of a former run in it are replaced.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Also remove boxes around people whose places are known, one `x y` or `x,y` in metres a line, in the map.
    #[arg(long, value_name = "FILE")]
    pub people: Option<PathBuf>,
    /// One point in cubes of this edge is written, metres.
    #[arg(long, value_name = "M", default_value_t = 0.03, value_parser = edge)]
    pub cube_m: f32,
    /// Edge of a voxel of the evidence, metres.
    #[arg(long, value_name = "M", default_value_t = 0.1, value_parser = voxel)]
    pub voxel_m: f32,
    /// The summary as one JSON object on standard output.
    #[arg(long)]
    pub json: bool,
}

fn number(text: &str, least: f32, most: f32) -> Result<f32, String> {
    let inside = text.parse::<f32>().ok().filter(|number| (least..=most).contains(number));
    inside.ok_or_else(|| format!("give metres, {least} to {most}"))
}

fn edge(text: &str) -> Result<f32, String> {
    number(text, 0.005, 1.0)
}

fn voxel(text: &str) -> Result<f32, String> {
    number(text, 0.05, 0.5)
}
