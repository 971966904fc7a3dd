//! Real tracks as heat maps, and an independent count of what must be in them.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;

use floorguard_robot::environment::pictures::{Layer, write};
use floorguard_robot::environment::{Calendar, Model, Recording, TrackReading, read_tracks, teach_recording};

use crate::data::recording;

/// The recordings.
pub const RECORDED: [(&str, &str); 3] = [
    ("eth", "trajectories/eth_obsmat.txt.gz"),
    ("lcas", "trajectories/lcas_vlp16_people.ndjson.gz"),
    ("hermes", "trajectories/hermes_corridor2d_bo-360-050-050.txt.gz"),
];
/// When they are taken to have been made: any day will do.
const START: &str = "2026-04-06T12:05";

/// What a recording came to.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// Its name.
    pub name: &'static str,
    /// People in it, and those who moved a metre.
    pub people: (usize, usize),
    /// Seconds that the latter spent, counted from the tracks alone.
    pub counted_s: f64,
    /// Seconds in the heat map.
    pub heat_s: f64,
    /// Cells that anybody entered, and visits in all.
    pub cells: usize,
    /// Visits in all cells.
    pub visits: u64,
    /// The same from 20 points a step between neighbouring positions: cells that must have been entered.
    pub counted_cells: usize,
    /// Of those, cells that are missing in the heat map.
    pub missing_cells: usize,
    /// Most visits of one cell.
    pub busiest: u32,
}

/// Makes a recording into a model, and pictures of it in `folder`. `None` where the recording is absent.
///
/// # Errors
/// A recording that cannot be read, a picture that cannot be written.
pub fn recorded(
    (name, file): (&'static str, &str),
    folder: Option<&Path>,
) -> anyhow::Result<Option<Recorded>> {
    let Some(path) = recording(file) else { return Ok(None) };
    let tracks = read_tracks(&path, TrackReading::default())?.recording;
    let bounds = tracks.bounds().ok_or_else(|| anyhow::anyhow!("{name} is empty"))?;
    let calendar = Calendar::default();
    let start = calendar.parse(START)?;
    let mut model = Model::over(name, calendar, bounds)?;
    teach_recording(&mut model, &tracks, start)?;
    if let Some(folder) = folder {
        write(&folder.join(format!("{name}_trajectories.png")), &model, Layer::Trajectories, None)?;
        write(&folder.join(format!("{name}_presence.png")), &model, Layer::Presence, None)?;
    }
    Ok(Some(count(name, &model, &tracks)))
}

/// Counts again, from the positions alone and in another way.
fn count(name: &'static str, model: &Model, tracks: &Recording) -> Recorded {
    let mut paths: BTreeMap<u64, Vec<(i64, f32, f32)>> = BTreeMap::new();
    for (micros, points) in &tracks.moments {
        for point in points {
            paths.entry(point.id).or_default().push((*micros, point.position.x_m, point.position.y_m));
        }
    }
    let heat = model.core.heat.cells();
    let origin = heat.geometry().origin_in_map();
    let (mut moved, mut counted_s, mut entered) = (0, 0.0, BTreeSet::new());
    for path in paths.values() {
        let (_, x0, y0) = path[0];
        if !path.iter().any(|(_, x, y)| (x - x0).hypot(y - y0) >= 1.0) {
            continue;
        }
        moved += 1;
        for pair in path.windows(2) {
            let [(t0, x0, y0), (t1, x1, y1)] = [pair[0], pair[1]];
            if t1 - t0 > 2_000_000 || (x1 - x0).hypot(y1 - y0) > 3.0 {
                continue;
            }
            counted_s += (t1 - t0) as f64 * 1e-6;
            for part in 0..=20 {
                let share = part as f32 / 20.0;
                let cell = |from: f32, to: f32, origin: f32| {
                    ((from + share * (to - from) - origin) / 0.2).floor() as i32
                };
                entered.insert((cell(x0, x1, origin.x_m), cell(y0, y1, origin.y_m)));
            }
        }
    }
    let visits_of = |(column, row): &(i32, i32)| {
        heat.geometry().index(*column, *row).and_then(|index| heat.get(index)).map_or(0, |cell| cell.visits)
    };
    Recorded {
        name,
        people: (paths.len(), moved),
        counted_s,
        heat_s: heat.values().iter().map(|cell| f64::from(cell.dwell_cs) * 0.01).sum(),
        cells: heat.values().iter().filter(|cell| cell.visits > 0).count(),
        visits: heat.values().iter().map(|cell| u64::from(cell.visits)).sum(),
        counted_cells: entered.len(),
        missing_cells: entered.iter().filter(|cell| visits_of(cell) == 0).count(),
        busiest: heat.values().iter().map(|cell| cell.visits).max().unwrap_or(0),
    }
}

impl Recorded {
    /// No time and no cell was lost (a hundredth of the cells may differ by the rounding of a corner), and nobody was
    /// counted who was not there.
    #[must_use]
    pub fn holds(&self) -> bool {
        (self.heat_s - self.counted_s).abs() < 0.02 * self.counted_s
            && self.missing_cells * 100 <= self.counted_cells
            && self.busiest as usize <= self.people.1
    }
}

/// The table.
#[must_use]
pub fn table(all: &[Recorded]) -> String {
    let mut text = String::from(
        "Real tracks as heat maps of 0.2 m, beside a count from the positions alone\n\
         place   people  moved  seconds  counted  cells  counted  missing  visits  busiest cell\n",
    );
    for one in all {
        let _infallible = writeln!(
            text,
            "{:<7} {:>6} {:>6} {:>8.0} {:>8.0} {:>6} {:>8} {:>8} {:>7} {:>13}",
            one.name,
            one.people.0,
            one.people.1,
            one.heat_s,
            one.counted_s,
            one.cells,
            one.counted_cells,
            one.missing_cells,
            one.visits,
            one.busiest
        );
    }
    text
}
