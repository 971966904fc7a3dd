//! `floorguard map3d`: drives of a spinning lidar become a trajectory and a cloud of surfaces in space.

use std::time::Instant;

use floorguard_host::outcome::{BadInput, VerdictFailed, WrongUsage};
use floorguard_host::words::counted;
use floorguard_mapping::lidar_odometry::{FloorPrior, MotionAid, OdometryConfig};
use floorguard_mapping_host::lego_loam::{LegoLoamConfig, LegoMapper};
use floorguard_mapping_host::lidar3d::{
    CloudPoint, Colour, Mapper3, Mapper3Config, SpaceMap, SpaceMapper, colours_of, las, pcd, ply,
};
use floorguard_mapping_host::metrics::write_tum_in_space;
use floorguard_mapping_host::output::{MARKER_3D, OutputFile, check_place, replace_folder};
use floorguard_mapping_host::turn_angle_rad;
use serde::Serialize;

use super::arguments::{ColourArgument, Map3dArguments, MethodArgument};
use super::camera_colours::{PictureCounts, camera_colours};
use super::input::{SpaceDrive, SweepsRead};
use super::progress::Progress;

/// More sweeps than this share without a match, and the map is in doubt.
const BLIND_SHARE_MAX: f64 = 0.02;
/// More sweeps than this share with a direction that the prediction alone held, and the map is in doubt.
const HELD_SHARE_MAX: f64 = 0.10;
/// Farther off by one standard deviation, metres, and the map is in doubt, unless a place was recognised.
const DEVIATION_MAX_M: f64 = 0.5;
/// Cubes of the cloud with fewer returns are noise.
const RETURNS_LEAST: u32 = 2;

/// What came of it; field names say the units.
#[derive(Clone, Debug, Serialize)]
struct Map3dSummary {
    /// `good` or `doubtful`.
    verdict: &'static str,
    doubts: Vec<String>,
    notes: Vec<String>,
    packets: u64,
    packets_refused: u64,
    sweeps: u64,
    sweeps_not_later: u64,
    /// Too few returns lay on the map: the pose is a prediction.
    sweeps_blind: u64,
    /// Returns without information about one direction.
    sweeps_held: u64,
    /// Entered into the map.
    sweeps_mapped: u64,
    duration_s: f64,
    path_m: f64,
    /// How far the place may be off by those that are held, before loops: one standard deviation.
    held_deviation_m: Option<f64>,
    /// Wheels and gyroscope of the recording were used.
    with_wheels: bool,
    with_gyroscope: bool,
    /// Places that were recognised and measured, those of them that count, and those that were refused in space.
    loops_closed: usize,
    loops_believed: usize,
    loops_refused: usize,
    /// From the first pose to the last.
    displacement_m: f64,
    turned_deg: f64,
    cloud_points: usize,
    /// Of `--colour camera`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pictures: Option<PictureCounts>,
    /// Cubes of the map of planes, and those given up because their place was taken.
    cubes: u32,
    cubes_replaced: u32,
    took_s: f64,
    ms_per_sweep: f64,
}

/// Runs the command.
///
/// # Errors
/// Bad input, a folder that cannot take a map, or a map that is in doubt (it is written all the same).
pub fn run(arguments: &Map3dArguments) -> anyhow::Result<()> {
    check_place(&arguments.out).map_err(|error| WrongUsage(error.to_string()))?;
    let began = Instant::now();
    let drive = SpaceDrive::open(&arguments.files, arguments.model.choice())?;
    let (map, read, worked_s) = mapped(&drive, arguments)?;
    if map.counters.sweeps == 0 {
        return Err(BadInput("no whole revolution in it: nothing to map".to_owned()).into());
    }
    let least = if map.counters.mapped > 1 { RETURNS_LEAST } else { 1 };
    let points = map.cloud.points(least);
    let mut summary = summarise(&map, &read, points.len());
    summary.notes.extend(drive.notes.iter().cloned());
    [summary.with_wheels, summary.with_gyroscope] =
        drive.aids.are_there().map(|is| is && arguments.uses_aids());
    (summary.took_s, summary.ms_per_sweep) =
        (began.elapsed().as_secs_f64(), 1.0e3 * worked_s / map.counters.sweeps.max(1) as f64);
    let (colours, pictures) = colours(&map, &points, arguments)?;
    summary.pictures = pictures;
    let files = [
        OutputFile::new("trajectory.tum", write_tum_in_space(&map.trajectory)),
        OutputFile::new("cloud.ply", ply(&points, &colours)),
        OutputFile::new("cloud.pcd", pcd(&points)),
        OutputFile::new("cloud.las", las(&points, &colours)?),
        OutputFile::new(MARKER_3D, serde_json::to_string_pretty(&summary)? + "\n"),
    ];
    replace_folder(&arguments.out, &files).map_err(|error| BadInput(error.to_string()))?;
    conclude(arguments, &summary, read.ended)
}

/// The colour of each point; and what became of the pictures, where they are the colour.
fn colours(
    map: &SpaceMap,
    points: &[CloudPoint],
    arguments: &Map3dArguments,
) -> anyhow::Result<(Vec<[u8; 3]>, Option<PictureCounts>)> {
    let shown = match arguments.colour {
        ColourArgument::Height => Colour::Height,
        ColourArgument::Time => Colour::Time,
        ColourArgument::Reflectivity => Colour::Reflectivity,
        ColourArgument::Camera => {
            let (colours, counts) = camera_colours((map, points), arguments)?;
            return Ok((colours, Some(counts)));
        }
    };
    Ok((colours_of(points, shown), None))
}

/// Runs the drive through the mapper; and the seconds that the mapper took.
fn mapped(drive: &SpaceDrive, arguments: &Map3dArguments) -> anyhow::Result<(SpaceMap, SweepsRead, f64)> {
    let mut mapper: Box<dyn SpaceMapper> = match arguments.method {
        MethodArgument::Ours => Box::new(Mapper3::new(config(arguments))),
        MethodArgument::LegoLoam => {
            Box::new(LegoMapper::new(LegoLoamConfig::default(), arguments.cell_m as f32))
        }
    };
    let progress = Progress::new(drive.sweeps);
    let mut worked_s = 0.0;
    let unsolvable = |error: &dyn std::fmt::Display| BadInput(format!("the graph cannot be solved: {error}"));
    let read = drive.read(&mut |sweep, aid| {
        progress.count();
        let start = Instant::now();
        let aid = if arguments.uses_aids() { aid } else { MotionAid::default() };
        mapper.take(sweep, &aid).map_err(|error| unsolvable(&error))?;
        worked_s += start.elapsed().as_secs_f64();
        Ok(())
    });
    progress.phase("closing the last loops");
    let map = mapper.conclude().map_err(|error| unsolvable(&error));
    progress.finish();
    Ok((map?, read?, worked_s))
}

impl Map3dArguments {
    /// Wheels and gyroscope help, where the recording has them.
    fn uses_aids(&self) -> bool {
        !self.lidar_alone && self.method == MethodArgument::Ours
    }
}

fn config(arguments: &Map3dArguments) -> Mapper3Config {
    let mut odometry = OdometryConfig::default();
    odometry.averaging.range_most_m = arguments.range_m as f32;
    odometry.floor = arguments.level_floor.then(FloorPrior::default);
    let usual = Mapper3Config::default();
    let closing = usual.closing.filter(|_| !arguments.without_loops);
    Mapper3Config { odometry, cloud_m: arguments.cell_m as f32, closing, ..usual }
}

fn summarise(map: &SpaceMap, read: &SweepsRead, cloud_points: usize) -> Map3dSummary {
    let trajectory = &map.trajectory;
    let path = trajectory.windows(2).map(|pair| (pair[1].place_m - pair[0].place_m).norm());
    let ends = trajectory.first().zip(trajectory.last());
    let counters = map.counters;
    let [cubes, cubes_replaced] = map.cubes;
    let mut summary = Map3dSummary {
        verdict: "good",
        doubts: Vec::new(),
        notes: Vec::new(),
        packets: read.packets,
        packets_refused: read.refused,
        sweeps: counters.sweeps,
        sweeps_not_later: counters.not_later,
        sweeps_blind: counters.blind,
        sweeps_held: counters.held,
        sweeps_mapped: counters.mapped,
        duration_s: ends.map_or(0.0, |(first, last)| last.time_s - first.time_s),
        path_m: path.sum(),
        held_deviation_m: map.held_deviation_m,
        with_wheels: false,
        with_gyroscope: false,
        loops_closed: map.loops.closed,
        loops_believed: map.loops_believed,
        loops_refused: map.loops.refused,
        displacement_m: ends.map_or(0.0, |(first, last)| (last.place_m - first.place_m).norm()),
        turned_deg: ends.map_or(0.0, |(first, last)| {
            turn_angle_rad(&first.rotation.rotation_to(&last.rotation)).to_degrees()
        }),
        cloud_points,
        pictures: None,
        cubes,
        cubes_replaced,
        took_s: 0.0,
        ms_per_sweep: 0.0,
    };
    summary.judge(read);
    summary
}

impl Map3dSummary {
    fn judge(&mut self, read: &SweepsRead) {
        let share = |part: u64| part as f64 / self.sweeps.max(1) as f64;
        let mut doubts = Vec::new();
        if share(self.sweeps_blind) > BLIND_SHARE_MAX {
            let what = "sweeps hardly fit what was seen before: their poses are predictions";
            doubts.push(format!("{} of {} {what}", self.sweeps_blind, self.sweeps));
        }
        if share(self.sweeps_held) > HELD_SHARE_MAX {
            let what = "sweeps say nothing about one direction (a corridor, a hall, a glass front)";
            doubts.push(format!("{} of {} {what}", self.sweeps_held, self.sweeps));
        }
        let deviation_m = self.held_deviation_m.filter(|deviation_m| *deviation_m > DEVIATION_MAX_M);
        if let Some(deviation_m) = deviation_m.filter(|_| self.loops_believed == 0) {
            doubts.push(format!(
                "the place may be off by {deviation_m:.1} m: sweeps without information about one direction followed each other"
            ));
        }
        if !doubts.is_empty() {
            self.verdict = "doubtful";
        }
        self.doubts = doubts;
        if self.packets_refused > 0 {
            self.notes.push(format!("{} packets were refused", self.packets_refused));
        }
        if self.cubes_replaced > 0 {
            let what = "cubes of the map of planes were given up for others";
            self.notes.push(format!("{} {what}", self.cubes_replaced));
        }
        self.notes.extend(read.ended.iter().map(|why| format!("{why}; everything before is in the map")));
    }
}

fn conclude(arguments: &Map3dArguments, summary: &Map3dSummary, ended: Option<String>) -> anyhow::Result<()> {
    if arguments.json {
        tell!("{}", serde_json::to_string(summary)?)?;
    } else {
        say!("map: {} ({} points)", arguments.out.display(), summary.cloud_points);
        say!(
            "  {} over {:.2} m in {:.1} s; {} entered the map",
            counted(summary.sweeps, "sweep"),
            summary.path_m,
            summary.duration_s,
            summary.sweeps_mapped
        );
        say!(
            "  the last pose is {:.4} m and {:.3}° from the first",
            summary.displacement_m,
            summary.turned_deg
        );
        if summary.with_wheels || summary.with_gyroscope {
            let names = [(summary.with_wheels, "wheels"), (summary.with_gyroscope, "gyroscope")];
            let used: Vec<&str> = names.iter().filter(|(is, _)| *is).map(|(_, name)| *name).collect();
            say!("  with {}", used.join(" and "));
        }
        if let Some(pictures) = &summary.pictures {
            let share = 100 * pictures.points_coloured / summary.cloud_points.max(1);
            let of = counted(pictures.pictures, "picture");
            say!("  {} of {of} give {share} % of the points their colour", pictures.used);
        }
        say!("  {} recognised", counted(summary.loops_believed as u64, "place"));
        say!("  took {:.1} s, {:.2} ms a sweep", summary.took_s, summary.ms_per_sweep);
        summary.notes.iter().for_each(|note| say!("  note: {note}"));
        summary.doubts.iter().for_each(|doubt| say!("  doubt: {doubt}"));
        say!("  look at {}", arguments.out.join("cloud.ply").display());
    }
    match ended {
        Some(why) => Err(BadInput(format!("{why}; everything before is in the map")).into()),
        None if !summary.doubts.is_empty() => {
            Err(VerdictFailed(format!("the map is doubtful: {}", summary.doubts.join("; "))).into())
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floorguard_mapping_host::lidar3d::{Mapper3Counters, SpaceCloserCounters, SurfaceCloud};

    /// A corridor of a few sweeps that show nothing along it bends a long map, whose other sweeps show everything.
    #[test]
    fn few_sweeps_without_information_make_a_map_doubtful() {
        let verdict = |held_deviation_m: Option<f64>, loops_believed: usize| {
            let map = SpaceMap {
                trajectory: Vec::new(),
                cloud: SurfaceCloud::new(1.0),
                counters: Mapper3Counters { sweeps: 1_800, held: 139, ..Mapper3Counters::default() },
                cubes: [0; 2],
                held_deviation_m,
                loops: SpaceCloserCounters::default(),
                loops_believed,
            };
            summarise(&map, &SweepsRead::default(), 0).verdict
        };
        assert_eq!(verdict(Some(14.0), 0), "doubtful");
        assert_eq!([verdict(Some(0.1), 0), verdict(Some(14.0), 1), verdict(None, 0)], ["good"; 3]);
    }
}
