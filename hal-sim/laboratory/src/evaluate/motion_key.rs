//! Ground truth of who walked where: the key of a recording, rows of `frame,time_s,track,x,y`.

use std::collections::BTreeMap;
use std::path::Path;

use floorguard_types::geometry::Point2;

use floorguard_host::outcome::BadInput;
use floorguard_robot::picture_files::{numbers, read_text};

/// A keyed person walks if this fast, m/s, over [`BASELINE_S`]: below, he stands and shifts his weight.
pub const WALKING_MPS: f32 = 0.3;
/// Half the time over which the speed is taken from the key: its positions jump by several centimetres.
const BASELINE_S: f64 = 0.5;
/// Columns that a key needs.
const COLUMNS: [&str; 5] = ["frame", "time_s", "track", "x", "y"];

/// One keyed position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeyRow {
    /// Frame of the recording.
    pub frame: u64,
    /// Start of the frame, seconds after the first packet.
    pub time_s: f64,
    /// Whose it is.
    pub track: u64,
    /// In the sensor's axes, metres.
    pub position: Point2,
    /// It is the last one of this person.
    pub is_last: bool,
    /// He walks, by the key itself.
    pub walking: bool,
}

/// The rows of a key in the order of the file.
///
/// # Errors
/// It cannot be read, lacks a column, or has a cell that is no number.
pub fn read_key(path: &Path) -> anyhow::Result<Vec<KeyRow>> {
    let text = read_text(path)?;
    let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let header: Vec<&str> =
        lines.next().map(|(_, line)| line.split(',').map(str::trim).collect()).unwrap_or_default();
    let bad = |problem: String| BadInput(format!("{}: {problem}", path.display()));
    let mut places = [0; COLUMNS.len()];
    for (place, name) in places.iter_mut().zip(COLUMNS) {
        *place = header.iter().position(|column| *column == name).ok_or_else(|| {
            bad(format!("no column `{name}` in its first line; keys are frame,time_s,track,x,y"))
        })?;
    }
    let mut rows = Vec::new();
    for (index, line) in lines {
        let cells = numbers(path, index + 1, line)?;
        let [frame, time_s, track, x, y] = places.map(|place| cells.get(place).copied().unwrap_or(f64::NAN));
        if ![frame, time_s, track, x, y].iter().all(|value| value.is_finite()) || frame < 0.0 || track < 0.0 {
            return Err(bad(format!("line {}: frame {frame}, time {time_s} s, track {track}, place {x}, {y}: a cell is missing (is the file cut off?), not finite, or below 0", index + 1)).into());
        }
        let position = Point2::new(x as f32, y as f32);
        rows.push(KeyRow {
            frame: frame as u64,
            time_s,
            track: track as u64,
            position,
            is_last: false,
            walking: false,
        });
    }
    if rows.is_empty() {
        return Err(bad("no rows below its first line".to_owned()).into());
    }
    complete(&mut rows);
    Ok(rows)
}

/// What a row does not say but its track does: speed, from the key's own positions, and end.
fn complete(rows: &mut [KeyRow]) {
    let mut tracks: BTreeMap<u64, Vec<(f64, Point2)>> = BTreeMap::new();
    for row in rows.iter() {
        tracks.entry(row.track).or_default().push((row.time_s, row.position));
    }
    for track in tracks.values_mut() {
        track.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    for row in rows {
        let near = |(time_s, _): &&(f64, Point2)| (time_s - row.time_s).abs() <= BASELINE_S;
        let mut around = tracks.get(&row.track).into_iter().flatten().filter(near);
        let Some(first) = around.next() else { continue };
        let last = around.next_back().unwrap_or(first);
        let elapsed_s = (last.0 - first.0) as f32;
        row.is_last = !tracks.get(&row.track).into_iter().flatten().any(|(time_s, _)| *time_s > row.time_s);
        row.walking = elapsed_s > 0.0 && first.1.distance(last.1) >= WALKING_MPS * elapsed_s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walking_follows_from_speed_around_a_row() {
        let mut rows: Vec<_> = (0..40)
            .map(|frame| KeyRow {
                frame,
                time_s: frame as f64 * 0.1,
                track: 7,
                position: Point2::new((frame as f32 - 20.0).max(0.0) * 0.08, 0.0),
                is_last: false,
                walking: false,
            })
            .collect();
        complete(&mut rows);
        assert!(rows[..17].iter().all(|row| !row.walking));
        assert!(rows[20..].iter().all(|row| row.walking));
    }
}
