//! One person in the scans of a two-dimensional scanner: how much of the time is it seen, followed and confirmed?
//!
//! The scans go through the robot's own list of people, in the frame of the sensor: nothing tells how it moves.

use std::collections::BTreeSet;
use std::path::Path;

use floorguard_host::outcome::BadInput;
use floorguard_perception::any_scanner::{PeopleByAnyScanner, ScannerPose};
use floorguard_perception::people::{PeoplePipeline, RingAngles, Track};
use floorguard_robot::picture_files::read_text;
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{BeamReturn, Scan};
use floorguard_types::time::Stamp;
use serde::Serialize;

/// What is this near to the true place is the person, metres.
const NEAR_M: f32 = 0.6;
/// A true place more than this older or newer than a scan says nothing about it, nanoseconds: half a scan at 10 Hz, and
/// some jitter.
const FRESH_NS: u64 = 60_000_000;
/// Two legs are confirmed as a person once they were this probably moving: legs of chairs come in pairs, too.
const WALKED_MIN: f32 = 0.1;
/// The first scan is at this time of the player's own clock, microseconds.
const START_US: u64 = 1_000_000;

/// How a person was followed.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WalkerReport {
    /// Scans.
    pub scans: u64,
    /// Scans for which the true place is known.
    pub judged: u64,
    /// Of these: the share with a leg at the person, among those that are followed.
    pub seen: f64,
    /// With a track, confirmed or not.
    pub tracked: f64,
    /// With a confirmed person.
    pub confirmed: f64,
    /// Judged scans during which the scanner moved.
    pub judged_moving: u64,
    /// Of these: with a confirmed person.
    pub confirmed_moving: f64,
    /// Identities that the person had.
    pub identities: u64,
    /// Confirmed people elsewhere, a scan; all of them where no truth is given.
    pub others_per_scan: f64,
}

/// The scanner moved when fewer than this share of the ranges are, within so many metres, as they were so many nanoseconds
/// before.
const SAME_MAX: f32 = 0.6;
const SAME_M: f32 = 0.1;
const BEFORE_NS: u64 = 1_000_000_000;

/// A scan, with the time when it was measured, and when it was recorded, nanoseconds: the truth has that time.
struct TimedScan {
    at_ns: u64,
    scan: Scan,
}

/// Where the person was.
struct TruePlace {
    at_ns: u64,
    place: Point2,
}

/// Plays scans (`bag_time_ns,header_stamp_s,ranges`, blank where nothing returned, after a line that names the geometry);
/// the truth has columns `bag_time_ns,id,x,y` in the frame of the sensor.
///
/// # Errors
/// A file cannot be read or has another form.
pub fn walker(scans: &Path, truth: Option<&Path>) -> anyhow::Result<WalkerReport> {
    let played = read_scans(scans)?;
    let truth = truth.map(read_truth).transpose()?.unwrap_or_default();
    let mut legs = Box::new(PeopleByAnyScanner::new());
    let mut people = Box::new(PeoplePipeline::new(RingAngles::vlp16()));
    let (mut report, mut counts) = (WalkerReport::default(), [0_u64; 5]);
    let moves: Vec<bool> = (0..played.len()).map(|index| has_moved(&played, index)).collect();
    let (mut identities, mut walked) = (BTreeSet::new(), BTreeSet::new());
    for (TimedScan { at_ns, scan }, moves) in played.into_iter().zip(moves) {
        people.add_view(legs.process(&scan, ScannerPose::OnMovingRobot(Pose2::default())));
        let tracks = people.tracker().tracks();
        walked.extend(
            tracks.iter().filter(|track| track.moving_probability >= WALKED_MIN).map(|track| track.id),
        );
        let confirmed =
            || tracks.iter().filter(|track| track.is_taken_for_person() && walked.contains(&track.id));
        report.scans += 1;
        let place = truth
            .iter()
            .filter(|known| known.at_ns.abs_diff(at_ns) <= FRESH_NS)
            .min_by_key(|known| known.at_ns.abs_diff(at_ns))
            .map(|known| known.place);
        let is_near =
            |track: &&Track| place.is_some_and(|place| track.state.position.distance(place) < NEAR_M);
        counts[3] += confirmed().filter(|track| !is_near(track)).count() as u64;
        let Some(place) = place else { continue };
        report.judged += 1;
        let leg_near = legs.tracker().tracks().iter().any(|leg| leg.state.position.distance(place) < NEAR_M);
        counts[0] += u64::from(leg_near);
        counts[1] += u64::from(tracks.iter().any(|track| is_near(&track)));
        let is_confirmed = confirmed().any(|track| is_near(&track));
        counts[2] += u64::from(is_confirmed);
        report.judged_moving += u64::from(moves);
        counts[4] += u64::from(moves && is_confirmed);
        identities.extend(confirmed().filter(is_near).map(|track| track.id));
    }
    let share = |count: u64, of: u64| count as f64 / of.max(1) as f64;
    [report.seen, report.tracked, report.confirmed] =
        [counts[0], counts[1], counts[2]].map(|count| share(count, report.judged));
    report.confirmed_moving = share(counts[4], report.judged_moving);
    report.others_per_scan = share(counts[3], report.scans);
    report.identities = identities.len() as u64;
    Ok(report)
}

/// The ranges of a scan differ from those of a second before.
fn has_moved(scans: &[TimedScan], index: usize) -> bool {
    let Some(now) = scans.get(index) else { return false };
    let before = scans.get(..index).unwrap_or_default();
    let before = before.iter().rev().find(|scan| now.at_ns.saturating_sub(scan.at_ns) >= BEFORE_NS);
    let Some(before) = before else { return false };
    let (mut both, mut same) = (0.0_f32, 0.0_f32);
    for pair in now.scan.beams.iter().zip(before.scan.beams.iter()) {
        let (BeamReturn::Hit(one_mm), BeamReturn::Hit(other_mm)) = pair else { continue };
        both += 1.0;
        same += f32::from(u8::from(f32::from(one_mm.abs_diff(*other_mm)) < 1_000.0 * SAME_M));
    }
    same < SAME_MAX * both
}

fn read_scans(path: &Path) -> anyhow::Result<Vec<TimedScan>> {
    let text = read_text(path)?;
    let bad = |line: usize, problem: &str| BadInput(format!("{}, line {line}: {problem}", path.display()));
    let mut lines = text.lines().enumerate();
    let header = lines.next().map_or("", |(_, header)| header);
    let named = |name: &str| {
        let value = header.split_whitespace().find_map(|word| word.strip_prefix(name)?.strip_prefix('='));
        value.and_then(|value| value.parse::<f32>().ok())
    };
    let (Some(first_angle_rad), Some(step_rad), Some(range_max_m)) =
        (named("angle_min"), named("angle_increment"), named("range_max"))
    else {
        return Err(
            bad(1, "expected `angle_min=`, `angle_increment=` (radians) and `range_max=` (metres)").into()
        );
    };
    let (mut scans, mut first_s) = (Vec::new(), None);
    for (index, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let mut cells = line.split(',');
        let at_ns = cells.next().and_then(|cell| cell.trim().parse().ok());
        let at_ns = at_ns.ok_or_else(|| bad(index + 1, "the first cell is no time in nanoseconds"))?;
        let measured_s = cells.next().and_then(|cell| cell.trim().parse::<f64>().ok());
        let measured_s = measured_s.ok_or_else(|| bad(index + 1, "the second cell is no time in seconds"))?;
        let after_s = measured_s - *first_s.get_or_insert(measured_s);
        let stamp = Stamp::from_micros(START_US + (after_s.max(0.0) * 1.0e6) as u64);
        let mut scan = Scan { first_angle_rad, step_rad, stamp, ..Scan::default() };
        for cell in cells {
            let cell = cell.trim();
            let range_m: f32 = if cell.is_empty() {
                f32::INFINITY
            } else {
                cell.parse().map_err(|_| bad(index + 1, &format!("`{cell}` is no range")))?
            };
            let beam = if range_m > 0.02 && range_m < range_max_m.min(60.0) {
                BeamReturn::Hit((range_m * 1_000.0).round() as u16)
            } else {
                BeamReturn::Unknown
            };
            scan.beams
                .push(beam)
                .map_err(|_| bad(index + 1, "more ranges than any scanner has that we know"))?;
        }
        scans.push(TimedScan { at_ns, scan });
    }
    if scans.is_empty() {
        return Err(bad(1, "no scan").into());
    }
    Ok(scans)
}

fn read_truth(path: &Path) -> anyhow::Result<Vec<TruePlace>> {
    let text = read_text(path)?;
    let mut truth = Vec::new();
    for (index, line) in text.lines().enumerate().skip(1).filter(|(_, line)| !line.trim().is_empty()) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let parsed = match cells.as_slice() {
            [at, _, x, y] => at.parse().ok().zip(x.parse().ok().zip(y.parse().ok())),
            _ => None,
        };
        let (at_ns, (x_m, y_m)) = parsed.ok_or_else(|| {
            BadInput(format!("{}, line {}: expected `bag_time_ns,id,x,y`", path.display(), index + 1))
        })?;
        truth.push(TruePlace { at_ns, place: Point2::new(x_m, y_m) });
    }
    Ok(truth)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> tempfile::NamedTempFile {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        file
    }

    /// A wall 4 m ahead, three scans of it; the person of the truth stands where nothing was measured.
    #[test]
    fn person_without_returns_is_not_found() {
        let ranges = ",4".repeat(60);
        let header = "# angle_min=-0.3 angle_increment=0.01 n=60 range_max=5.6\n";
        let rows: String = (1..4).map(|scan| format!("{scan}00000000,0.{scan}{ranges}\n")).collect();
        let scans = file(&format!("{header}{rows}"));
        let truth = file("bag_time_ns,id,x,y\n200000000,1,2.0,0.0\n");
        let report = walker(scans.path(), Some(truth.path())).unwrap();
        assert_eq!((report.scans, report.judged), (3, 1));
        assert_eq!((report.seen, report.confirmed, report.others_per_scan), (0.0, 0.0, 0.0));
        for (text, problem) in
            [("", "angle_min"), (header, "no scan"), ("# angle_min=0\n1,1,2\n", "range_max")]
        {
            let refused = walker(file(text).path(), None).unwrap_err().to_string();
            assert!(refused.contains(problem), "{refused}");
        }
        let refused = walker(scans.path(), Some(file("time\n1,2\n").path())).unwrap_err().to_string();
        assert!(refused.contains("line 2"), "{refused}");
    }
}
