//! `floorguard map`: a drive becomes a map.

use std::path::Path;
use std::time::Instant;

use floorguard_host::outcome::{BadInput, VerdictFailed, WrongUsage};
use floorguard_host::words::counted;
use floorguard_mapping_host::Se2;
use floorguard_mapping_host::front_end::FrontEndConfig;
use floorguard_mapping_host::grid_map::{GridMap, GridMapConfig, build_grid_map};
use floorguard_mapping_host::mapper::{MapConfig, Mapper};
use floorguard_mapping_host::output::{OutputFile, check_place, map_files, replace_folder};
use floorguard_mapping_host::time_offset::{TimeOffset, estimate_time_offset};

use super::arguments::{MapArguments, MapTask};
use super::checkpoint::Checkpoint;
use super::clean::{CleanArguments, run as clean_map};
use super::input::{Drive, ReadSummary};
use super::progress::Progress;
use super::report::document;
use super::summary::{MapSummary, summarise};

/// Runs the command.
///
/// # Errors
/// Bad input, a folder that cannot take a map, or a map that is in doubt (it is written all the same).
pub fn run(arguments: &MapArguments) -> anyhow::Result<()> {
    if let Some(MapTask::Edit(edit)) = &arguments.task {
        return super::map_edit::run(edit);
    }
    // Only `map edit` goes without.
    let out = arguments.out.clone().unwrap_or_default();
    if arguments.clean {
        let (files, json) = (arguments.files.clone(), arguments.json);
        return clean_map(&CleanArguments { files, out, map_first: true, json, ..CleanArguments::default() });
    }
    check_place(&out).map_err(|error| WrongUsage(error.to_string()))?;
    let began = Instant::now();
    let drive = Drive::open(&arguments.files, arguments.drive.options())?;
    let config = MapConfig {
        front_end: FrontEndConfig { range_most_m: arguments.range_m as f32, ..FrontEndConfig::default() },
        ..MapConfig::default()
    };
    let (checkpoint, mapper) = Checkpoint::open(arguments, &out, &config);
    if checkpoint.scans > 0 {
        say!("goes on after {} of an interrupted mapping", counted(checkpoint.scans, "scan"));
    }
    let (mut mapper, read) = mapped(&drive, mapper, &checkpoint)?;
    let grid = GridMapConfig { cell_m: arguments.cell_m, ..GridMapConfig::default() };
    let map = grid_map(&mapper, &grid)?;
    let (scanner, offset) = timed_trajectory(&mut mapper, &drive);
    let trajectory = robot_trajectory(&scanner, drive.scanner_in_robot);
    let mut summary = summarise(&mapper, &map, read.counters, began.elapsed().as_secs_f64());
    summary.enter_offset(offset);
    summary.notes.extend(drive.notes.iter().cloned());
    summary.notes.extend(read.ended.iter().map(|why| format!("{why}; everything before is in the map")));
    let names: Vec<String> = arguments.files.iter().map(|file| file.display().to_string()).collect();
    let about = [
        OutputFile::new("summary.json", serde_json::to_string_pretty(&summary)? + "\n"),
        OutputFile::new("report.html", document(&summary, &names)),
    ];
    replace_folder(&out, map_files(&mapper, &map, &trajectory).chain(about))
        .map_err(|error| BadInput(error.to_string()))?;
    checkpoint.remove();
    conclude((arguments.json, &out), &summary, read.ended)
}

fn mapped(
    drive: &Drive,
    mut mapper: Mapper,
    checkpoint: &Checkpoint,
) -> anyhow::Result<(Mapper, ReadSummary)> {
    let progress = Progress::new(drive.scans);
    let unsolvable = |error: &dyn std::fmt::Display| BadInput(format!("the graph cannot be solved: {error}"));
    let mut scans = 0_u64;
    let read = drive.read(&|| progress.count(), &mut |record| {
        scans += 1;
        if scans <= checkpoint.scans {
            return Ok(());
        }
        mapper.push(&record).map_err(|error| unsolvable(&error))?;
        Ok(checkpoint.keep(&mapper, scans)?)
    });
    progress.phase("aligning all scans");
    let finished = read.and_then(|read| {
        let needed = 2;
        if mapper.tracker.nodes.len() < needed {
            let what = "the robot hardly moves in it, or its scans have no returns: nothing to map";
            return Err(BadInput(what.to_owned()).into());
        }
        mapper.finish().map_err(|error| unsolvable(&error))?;
        Ok(read)
    });
    progress.finish();
    Ok((mapper, finished?))
}

fn grid_map(mapper: &Mapper, grid: &GridMapConfig) -> Result<GridMap, BadInput> {
    build_grid_map(mapper.scans(), grid)
        .ok_or_else(|| BadInput("no return in any scan: nothing to map".to_owned()))
}

/// The poses of all scans; where the drive shows that their stamps are early or late, all times are corrected.
fn timed_trajectory(mapper: &mut Mapper, drive: &Drive) -> (Vec<(f64, Se2)>, Option<TimeOffset>) {
    let mut scanner = mapper.matched_trajectory();
    let offset = drive.headings().and_then(|headings| estimate_time_offset(&scanner, headings));
    if let Some(offset) = offset.filter(TimeOffset::is_believed) {
        mapper.shift_times(offset.younger_s);
        scanner.iter_mut().for_each(|(time_s, _)| *time_s += offset.younger_s);
    }
    (scanner, offset)
}

/// Poses of the robot, not of its scanner.
fn robot_trajectory(scanner: &[(f64, Se2)], scanner_in_robot: Se2) -> Vec<(f64, Se2)> {
    let robot_in_scanner = scanner_in_robot.inverse();
    scanner.iter().map(|(time_s, pose)| (*time_s, pose.compose(robot_in_scanner))).collect()
}

fn conclude((json, out): (bool, &Path), summary: &MapSummary, ended: Option<String>) -> anyhow::Result<()> {
    if json {
        tell!("{}", serde_json::to_string(summary)?)?;
    } else {
        let [width_m, height_m] = summary.size_m;
        say!(
            "map: {} ({width_m:.1} × {height_m:.1} m, {:.0} m² free floor, {:.2} m a cell)",
            out.display(),
            summary.free_m2,
            summary.cell_m
        );
        say!(
            "  {} over {:.0} m in {:.0} s; {} kept, {} recognised",
            counted(summary.input.scans, "scan"),
            summary.path_m,
            summary.duration_s,
            summary.kept_scans,
            counted(summary.loops as u64, "place")
        );
        say!("  took {:.1} s, {:.2} ms a scan", summary.took_s, summary.ms_per_scan);
        summary.notes.iter().for_each(|note| say!("  note: {note}"));
        summary.doubts.iter().for_each(|doubt| say!("  doubt: {doubt}"));
        say!("  look at {}", out.join("report.html").display());
    }
    match ended {
        Some(why) => Err(BadInput(format!("{why}; everything before is in the map")).into()),
        None if !summary.doubts.is_empty() => {
            Err(VerdictFailed(format!("the map is doubtful: {}", summary.doubts.join("; "))).into())
        }
        None => Ok(()),
    }
}
