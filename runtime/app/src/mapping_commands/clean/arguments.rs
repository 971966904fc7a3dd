//! The command line.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// Edge of the cubes of the clouds, metres.
const CUBE_M: f32 = 0.03;
/// Edge of a voxel of the evidence, metres.
const VOXEL_M: f32 = 0.1;

/// How a place in space is found for a box in a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum BoxMethod {
    /// The nearest surface that fills a fifth of the middle third of the box.
    #[default]
    Depth,
    /// As published: the lidar point that appears nearest to the middle of the box.
    Nearest,
}

/// What to clean.
#[derive(Clone, Debug, Args)]
#[command(after_help = "Examples: floorguard clean-map puck.pcap --map-first --out clean\n          \
                        floorguard clean-map puck.pcap --poses trajectory.tum --boxes people.json --camera front.json --out clean\n          \
                        floorguard clean-map standing-lidar.pcap.gz --out clean")]
pub struct CleanArguments {
    /// Captures of a Velodyne lidar (.pcap, .pcapng) or ROS 2 bags with PointCloud2 (.mcap), packed or not. Several surveys of
    /// one building are cleaned together: what stood through one of them and is gone in another leaves the map.
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// Poses of the lidar in the map (TUM format: time x y z qx qy qz qw), for each file one; times are those of the capture,
    /// or seconds since its first packet. Without any, the lidar stands still.
    #[arg(long, value_name = "FILE.tum")]
    pub poses: Vec<PathBuf>,
    /// Find the poses by the sweeps themselves first, as `map3d` does; several files are the parts of one drive, in their order.
    #[arg(long, conflicts_with = "poses")]
    pub map_first: bool,
    /// With --map-first: the lidar stands upright on a level floor.
    #[arg(long, requires = "map_first")]
    pub level_floor: bool,
    /// People that a detector found in pictures: JSON, CSV (time_s,left,top,right,bottom,score,class), or a recording with
    /// vision_msgs/Detection2DArray or Foxglove's ImageAnnotations (.mcap). Boxes around them leave the map.
    #[arg(long, value_name = "FILE", requires = "camera")]
    pub boxes: Option<PathBuf>,
    /// The camera of those pictures and its mounting, a file of `calibrate camera-lidar` (JSON).
    #[arg(long, value_name = "FILE.json", requires = "boxes")]
    pub camera: Option<PathBuf>,
    /// How a place is found for a box.
    #[arg(long, value_name = "METHOD", default_value = "depth")]
    pub box_method: BoxMethod,
    /// The folder of the clouds; made if it is not there, files of a former run in it are replaced.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Also remove boxes around people whose places are known, one `x y` or `x,y` in metres a line, in the map.
    #[arg(long, value_name = "FILE")]
    pub people: Option<PathBuf>,
    /// One point in cubes of this edge is written, metres.
    #[arg(long, value_name = "M", default_value_t = CUBE_M, value_parser = edge)]
    pub cube_m: f32,
    /// Edge of a voxel of the evidence, metres.
    #[arg(long, value_name = "M", default_value_t = VOXEL_M, value_parser = voxel)]
    pub voxel_m: f32,
    /// The summary as one JSON object on standard output.
    #[arg(long)]
    pub json: bool,
}

impl Default for CleanArguments {
    /// Without files; cubes of 3 cm and voxels of 10 cm.
    fn default() -> Self {
        Self {
            files: Vec::new(),
            poses: Vec::new(),
            map_first: false,
            level_floor: false,
            boxes: None,
            camera: None,
            box_method: BoxMethod::Depth,
            out: PathBuf::new(),
            people: None,
            cube_m: CUBE_M,
            voxel_m: VOXEL_M,
            json: false,
        }
    }
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
