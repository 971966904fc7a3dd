//! The command lines.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use floorguard_mapping_host::grid_map::Zone;

use super::input::InputOptions;
use crate::recordings::ModelArgument;

/// Usual edge of a cell, and usual range, metres.
const CELL_M: f64 = 0.05;
const RANGE_M: f64 = 30.0;

/// Files of a drive, and which part of them.
#[derive(Clone, Debug, Args)]
pub struct DriveArguments {
    /// Of bags, only this topic of scans; without it, the one with most scans.
    #[arg(long)]
    pub topic: Option<String>,
    /// Do not use the odometry of the files: the scans alone.
    #[arg(long)]
    pub without_odometry: bool,
    /// From this time on, seconds since the first scan.
    #[arg(long, value_name = "S", default_value_t = 0.0, value_parser = seconds)]
    pub from: f64,
    /// Up to this time, seconds since the first scan.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub to: Option<f64>,
}

/// What to map.
#[derive(Clone, Debug, Args)]
#[command(
    after_help = "Examples: floorguard map drive.mcap --out maps/hall\n          \
                  floorguard map --clean puck.pcap --out hall-without-people\n          \
                  floorguard map edit maps/hall --to-walls --no-go 3,1;5,1;5,4 --out maps/hall-edited",
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true
)]
pub struct MapArguments {
    /// Change a finished map.
    #[command(subcommand)]
    pub task: Option<MapTask>,
    /// Recordings of `--record` and ROS 2 bags with LaserScan (.mcap), or CARMEN logs (.clf, .log); packed or not. Several
    /// are the parts of one drive, in their order.
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// The folder of the map; a former map in it is replaced once the new one is whole. A mapping that was interrupted goes on
    /// when the same command is given again: its state lies beside the folder as `.NAME.resume`.
    #[arg(long, value_name = "DIR", required = true)]
    pub out: Option<PathBuf>,
    /// Map the recording of a lidar in space (.pcap, or .mcap with PointCloud2) and take people and what else moved out of it:
    /// the same as `clean-map --map-first`, which has more options.
    #[arg(long)]
    pub clean: bool,
    /// Which scans.
    #[command(flatten)]
    pub drive: DriveArguments,
    /// Edge of a cell of the map, metres.
    #[arg(long, value_name = "M", default_value_t = CELL_M, value_parser = cell)]
    pub cell_m: f64,
    /// Farther returns are not used, metres.
    #[arg(long, value_name = "M", default_value_t = RANGE_M, value_parser = range)]
    pub range_m: f64,
    /// The summary as one JSON object on standard output.
    #[arg(long)]
    pub json: bool,
}

/// What else is done with maps.
#[derive(Clone, Debug, Subcommand)]
pub enum MapTask {
    /// Crop a map, turn it to its walls, erase what was there by chance, mark zones that are not driven.
    #[command(after_help = "Example:\n  floorguard map edit maps/hall --to-walls --out maps/hall-edited")]
    Edit(MapEditArguments),
}

/// Which changes, made in this order: turned, cropped, erased, forgotten, closed. Places are in metres of the map as it is
/// after the turn.
#[derive(Clone, Debug, Args)]
pub struct MapEditArguments {
    /// A folder of `floorguard map`, a ROS map_server map (.yaml), or a bare picture of 0.05 m a pixel.
    pub map: PathBuf,
    /// The folder of the changed map; a former map in it is replaced once the new one is whole.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Turn the map about its origin so that most walls run along its axes.
    #[arg(long, conflicts_with = "turn_deg")]
    pub to_walls: bool,
    /// Turn the map counter-clockwise about its origin, degrees.
    #[arg(long, value_name = "DEG", allow_hyphen_values = true, value_parser = turn)]
    pub turn_deg: Option<f64>,
    /// Keep only what lies between two corners: `X1,Y1,X2,Y2`.
    #[arg(long, value_name = "CORNERS", allow_hyphen_values = true, value_parser = corners)]
    pub crop: Option<Corners>,
    /// Make the floor between two corners free, as where a trolley stood: `X1,Y1,X2,Y2`. May be repeated.
    #[arg(long, value_name = "CORNERS", allow_hyphen_values = true, value_parser = corners)]
    pub erase: Vec<Corners>,
    /// Make what lies between two corners unknown. May be repeated.
    #[arg(long, value_name = "CORNERS", allow_hyphen_values = true, value_parser = corners)]
    pub forget: Vec<Corners>,
    /// A zone that is not driven: `X,Y;X,Y;X,Y…`. It becomes unknown floor, which no plan of ours enters, and is drawn in
    /// `no_go.yaml`, a keepout mask as nav2 takes it. May be repeated.
    #[arg(long, value_name = "POLYGON", allow_hyphen_values = true, value_parser = polygon)]
    pub no_go: Vec<Zone>,
}

/// Two corners of a rectangle, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corners(pub [[f64; 2]; 2]);

/// What to map in space.
#[derive(Clone, Debug, Args)]
#[command(after_help = "Example: floorguard map3d drive.pcap.gz --out maps/hall3d")]
pub struct Map3dArguments {
    /// Captures of a spinning lidar (.pcap, .pcapng), or recordings of `--record` and ROS 2 bags with PointCloud2 (.mcap);
    /// packed or not. Several are the parts of one drive, in their order.
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// The folder of the map; a former map in it is replaced once the new one is whole.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Which lidar made the captures.
    #[arg(long, default_value = "auto")]
    pub model: ModelArgument,
    /// How it is mapped.
    #[arg(long, default_value = "ours")]
    pub method: MethodArgument,
    /// The lidar stands upright on a level floor: height, roll and pitch stay those of the first sweep.
    #[arg(long)]
    pub level_floor: bool,
    /// Do not use wheels and gyroscope of the recording: the returns alone.
    #[arg(long)]
    pub lidar_alone: bool,
    /// Do not close loops: the odometry alone.
    #[arg(long)]
    pub without_loops: bool,
    /// Edge of a cube of the cloud, metres; each cube becomes one point.
    #[arg(long, value_name = "M", default_value_t = 0.05, value_parser = cell)]
    pub cell_m: f64,
    /// Farther returns are not used, metres.
    #[arg(long, value_name = "M", default_value_t = 60.0, value_parser = range)]
    pub range_m: f64,
    /// What the colour of the cloud shows.
    #[arg(long, default_value = "height")]
    pub colour: ColourArgument,
    /// The camera beside the lidar and where it is mounted, for `--colour camera` (JSON, as `calibrate camera-lidar` writes it).
    #[arg(long, value_name = "CAMERA.json", required_if_eq("colour", "camera"))]
    pub camera: Option<PathBuf>,
    /// Its pictures: a folder of PNG or JPEG files whose names end in their times, or a ROS 2 bag; without it, those in the first FILE.
    #[arg(long, value_name = "DIR|BAG", requires = "camera")]
    pub pictures: Option<PathBuf>,
    /// The summary as one JSON object on standard output.
    #[arg(long)]
    pub json: bool,
}

/// How a drive is mapped in space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum MethodArgument {
    /// Sweeps onto planes, straightened as the sensor moved; wheels, gyroscope, loops.
    #[default]
    Ours,
    /// LeGO-LOAM (Shan and Englot 2018) as published, for lidars of 16 lasers; the returns alone.
    LegoLoam,
}

/// What the colour of a cloud shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ColourArgument {
    /// Low blue, high red.
    #[default]
    Height,
    /// Seen early blue, late red.
    Time,
    /// Dark to bright.
    Reflectivity,
    /// The colour in pictures of a camera; grey where none shows the point.
    Camera,
}

/// What to find in which map.
#[derive(Clone, Debug, Args)]
#[command(after_help = "Example: floorguard localise maps/hall drive.mcap --out found.tum")]
pub struct LocaliseArguments {
    /// A folder of `floorguard map`, a ROS map_server map (.yaml), or a bare picture of 0.05 m a pixel.
    pub map: PathBuf,
    /// A recording, bag or CARMEN log of a drive; several are its parts.
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// Another map in which the robot may be, as that of another floor. May be repeated; the answer names the map.
    #[arg(long = "or", value_name = "MAP", conflicts_with = "update")]
    pub others: Vec<PathBuf>,
    /// Write the map with what has changed for good into this folder: what stood, or was gone, on three visits in a row at least
    /// half an hour apart. Evidence that is not enough yet is kept there for the next drive. The folder may be that of the map, of
    /// which then only the map and the evidence stay.
    #[arg(long, value_name = "DIR")]
    pub update: Option<PathBuf>,
    /// Which scans.
    #[command(flatten)]
    pub drive: DriveArguments,
    /// Write the poses in the map, where they are known (TUM format).
    #[arg(long, value_name = "FILE.tum")]
    pub out: Option<PathBuf>,
    /// One JSON object for every change and one for the whole on standard output.
    #[arg(long)]
    pub json: bool,
}

/// What to judge by what.
#[derive(Clone, Debug, Args)]
#[command(
    after_help = "Examples: floorguard eval slam --relations aces.relations maps/hall/trajectory.tum\n          \
                  floorguard eval slam --trajectory truth.tum maps/hall/trajectory.tum"
)]
pub struct SlamArguments {
    /// The trajectory to judge (TUM format: time x y z qx qy qz qw).
    pub result: PathBuf,
    /// Reference relations: `t1 t2 x y z roll pitch yaw` a line (Kümmerle et al. 2009).
    #[arg(long, value_name = "FILE", required_unless_present = "trajectory", conflicts_with = "trajectory")]
    pub relations: Option<PathBuf>,
    /// A true trajectory (TUM format): absolute and relative errors as the program evo counts them.
    #[arg(long, value_name = "FILE")]
    pub trajectory: Option<PathBuf>,
    /// Poses farther apart in time do not belong together, seconds; 0.01 for trajectories as evo, 0.1 for relations.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub tolerance_s: Option<f64>,
    /// Relative errors over so many metres of path instead of from pose to pose.
    #[arg(long, value_name = "M", value_parser = length, conflicts_with = "relations")]
    pub step_m: Option<f64>,
    /// End with 1 if the mean translation error (of relations) or the root mean square (absolute) is larger, metres.
    #[arg(long, value_name = "M", value_parser = length)]
    pub limit_m: Option<f64>,
}

impl MapArguments {
    /// One recording, with the usual values.
    pub fn of_drive(file: PathBuf, out: PathBuf) -> Self {
        let drive = DriveArguments { topic: None, without_odometry: false, from: 0.0, to: None };
        Self {
            task: None,
            files: vec![file],
            out: Some(out),
            clean: false,
            drive,
            cell_m: CELL_M,
            range_m: RANGE_M,
            json: false,
        }
    }
}

impl DriveArguments {
    /// As the input takes them.
    pub fn options(&self) -> InputOptions {
        InputOptions {
            topic: self.topic.clone(),
            with_odometry: !self.without_odometry,
            from_s: self.from,
            to_s: self.to.unwrap_or(f64::INFINITY),
        }
    }
}

fn number(text: &str, least: f64, most: f64, what: &str) -> Result<f64, String> {
    let inside = text.parse::<f64>().ok().filter(|number| (least..=most).contains(number));
    inside.ok_or_else(|| format!("give {what}, {least} to {most}"))
}

fn seconds(text: &str) -> Result<f64, String> {
    number(text, 0.0, 1.0e9, "seconds")
}

fn cell(text: &str) -> Result<f64, String> {
    number(text, 0.01, 0.5, "metres a cell")
}

fn range(text: &str) -> Result<f64, String> {
    number(text, 1.0, 200.0, "metres")
}

fn length(text: &str) -> Result<f64, String> {
    number(text, 1.0e-6, 1.0e6, "metres")
}

fn turn(text: &str) -> Result<f64, String> {
    number(text, -180.0, 180.0, "degrees")
}

fn places(text: &str) -> Option<Vec<f64>> {
    text.split([',', ';'])
        .map(|word| word.trim().parse::<f64>().ok().filter(|value| value.is_finite()))
        .collect()
}

fn corners(text: &str) -> Result<Corners, String> {
    let numbers = places(text);
    let four = numbers.as_deref().and_then(|numbers| <[f64; 4]>::try_from(numbers).ok());
    let [x1, y1, x2, y2] = four.ok_or("give X1,Y1,X2,Y2, metres")?;
    Ok(Corners([[x1, y1], [x2, y2]]))
}

fn polygon(text: &str) -> Result<Zone, String> {
    let numbers = places(text).filter(|numbers| numbers.len() >= 6 && numbers.len() % 2 == 0);
    let numbers = numbers.ok_or("give three corners or more: X,Y;X,Y;X,Y, metres")?;
    Ok(Zone(numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()))
}
