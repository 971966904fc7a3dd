//! Where the dirt of a mission comes from: drawn at random, or read from a file.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::Context;
use floorguard_types::geometry::Point2;
use floorguard_types::random::Pcg32;

use super::floor::Floor;

/// Most units that can be expected in a cell.
const UNITS_MAX: f32 = 70.0;

/// What the user asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum DirtSource {
    /// A share of the reachable cells, with expected units drawn uniformly from a range.
    Random {
        /// Share of the reachable cells, within (0, 1].
        share: f32,
        /// Range of the expected units.
        units: (f32, f32),
    },
    /// A fixed number of cells, the expected units going through a list in turn: the published Table I.
    Cells {
        /// Number of cells.
        count: usize,
        /// Expected units.
        units: Vec<f32>,
    },
    /// A CSV file with the columns x_m, y_m, expected units.
    File(PathBuf),
}

impl FromStr for DirtSource {
    type Err = String;

    /// `random:5%:10-15`, or the path of a CSV file.
    fn from_str(text: &str) -> Result<Self, String> {
        let Some(rest) = text.strip_prefix("random:") else {
            return Ok(Self::File(PathBuf::from(text)));
        };
        let wrong = || format!("'{text}' is not random:SHARE%:LOW-HIGH, for example random:5%:10-15");
        let (share, units) = rest.split_once(':').ok_or_else(wrong)?;
        let share: f32 = share.trim_end_matches('%').parse().map_err(|_| wrong())?;
        let (low, high) = units.split_once('-').ok_or_else(wrong)?;
        let (low, high): (f32, f32) = low.parse().ok().zip(high.parse().ok()).ok_or_else(wrong)?;
        if !(share > 0.0 && share <= 100.0 && low >= 0.0 && low <= high && high <= UNITS_MAX) {
            return Err(format!("{}: the share lies within 0-100 %, the units within 0-70", wrong()));
        }
        Ok(Self::Random { share: share / 100.0, units: (low, high) })
    }
}

impl DirtSource {
    /// Expected units for every cell of the raster. Dirt on cells that cannot be reached is kept: it is reported as
    /// not guaranteed.
    ///
    /// # Errors
    /// A file that cannot be read or has a wrong line.
    pub fn expected_units(&self, floor: &Floor, random: &mut Pcg32) -> anyhow::Result<Vec<f32>> {
        let mut expected = vec![0.0; floor.cells.cell_count()];
        let mut reachable: Vec<usize> = (0..expected.len()).filter(|&i| floor.reachable[i]).collect();
        let mut pick = |count: usize, random: &mut Pcg32| -> Vec<usize> {
            // Fisher–Yates, as far as needed.
            let count = count.min(reachable.len());
            for place in 0..count {
                let other = place + random.below((reachable.len() - place) as u32) as usize;
                reachable.swap(place, other);
            }
            reachable[..count].to_vec()
        };
        match self {
            Self::Random { share, units } => {
                let all = floor.reachable.iter().filter(|&&r| r).count();
                let count = (share * all as f32).round() as usize;
                for cell in pick(count, random) {
                    expected[cell] = random.uniform_between(units.0, units.1);
                }
            }
            Self::Cells { count, units } => {
                for (cell, &units) in pick(*count, random).into_iter().zip(units.iter().cycle()) {
                    expected[cell] = units;
                }
            }
            Self::File(path) => {
                read(path, floor, &mut expected)?;
            }
        }
        Ok(expected)
    }
}

impl DirtSource {
    /// Lines of the file whose place lies beyond the raster of the mission: nothing is known or claimed there. 0 where
    /// dirt is drawn.
    ///
    /// # Errors
    /// A file that cannot be read, has a wrong line, or has no dirt within the raster.
    pub fn lines_beyond(&self, floor: &Floor) -> anyhow::Result<usize> {
        let Self::File(path) = self else { return Ok(0) };
        let mut expected = vec![0.0; floor.cells.cell_count()];
        let beyond = read(path, floor, &mut expected)?;
        let (origin, cells) = (floor.cells.origin_in_map(), &floor.cells);
        let size = |count: u16| f32::from(count) * cells.resolution_m();
        anyhow::ensure!(
            expected.iter().any(|&units| units > 0.0),
            "{}: no dirt within x {:.1} to {:.1} m, y {:.1} to {:.1} m of the map; {beyond} lines lie beyond",
            path.display(),
            origin.x_m,
            origin.x_m + size(cells.width()),
            origin.y_m,
            origin.y_m + size(cells.height()),
        );
        Ok(beyond)
    }
}

/// Returns the number of lines whose place lies beyond the raster.
fn read(path: &Path, floor: &Floor, expected: &mut [f32]) -> anyhow::Result<usize> {
    let mut beyond = 0;
    for (place, units) in read_places(path)? {
        match floor.cells.cell_at(place) {
            // Two lines about one cell: both lie there.
            Some(cell) => expected[cell] = (expected[cell] + units).min(UNITS_MAX),
            None => beyond += 1,
        }
    }
    Ok(beyond)
}

/// Places and expected units of a CSV file with the columns x_m, y_m, units.
///
/// # Errors
/// The file cannot be read, or a line says something else.
pub fn read_places(path: &Path) -> anyhow::Result<Vec<(Point2, f32)>> {
    let mut places = Vec::new();
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let text = text.trim_start_matches('\u{feff}');
    for (number, line) in text.lines().enumerate() {
        let number_of = |field: &str| field.trim().parse::<f32>().ok().filter(|number| number.is_finite());
        let fields: Vec<Option<f32>> = line.split(',').map(number_of).collect();
        match fields.as_slice() {
            [Some(x), Some(y), Some(units)] if (0.0..=UNITS_MAX).contains(units) => {
                places.push((Point2::new(*x, *y), *units));
            }
            // A heading without a number in it, an empty line or a comment.
            _ if (number == 0 && fields.iter().all(Option::is_none))
                || line.trim().is_empty()
                || line.starts_with('#') => {}
            _ => anyhow::bail!(
                "{}:{}: expected x_m,y_m,units with units within 0-70, found '{line}'",
                path.display(),
                number + 1
            ),
        }
    }
    Ok(places)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_without_dirt_is_refused() {
        let floor = Floor::new("plain", super::super::rooms::plain().unwrap(), 0.17).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("dirt.csv");
        let beyond = |text: &str| {
            std::fs::write(&path, text).unwrap();
            DirtSource::File(path.clone()).lines_beyond(&floor)
        };
        assert_eq!(beyond("x_m,y_m,units\n1,1,12\n1,100,12\n").unwrap(), 1);
        assert_eq!(beyond("\u{feff}1,1,12\r\n1.01,1.01,60\r\n").unwrap(), 0);
        let expected = DirtSource::File(path.clone()).expected_units(&floor, &mut Pcg32::new(1, 1)).unwrap();
        assert_eq!(
            expected.iter().copied().fold(0.0, f32::max),
            70.0,
            "both lines lie there, up to the most"
        );
        for wrong in ["1;1;12\n", "1,1,12\nnan,1,12\n", "1,inf,12\n", "1,1,-1\n", "1,1\n1,1,12\n"] {
            assert!(beyond(wrong).is_err(), "{wrong}");
        }
        assert!(beyond("").is_err() && beyond("x_m,y_m,units\n1,100,12\n").is_err());
        for wrong in ["1,1", "1,nan,12", "inf,1,12"] {
            let problem = beyond(&format!("x_m,y_m,units\n{wrong}\n")).unwrap_err().to_string();
            assert!(problem.contains(":2:"), "{problem}");
        }
    }

    #[test]
    fn reads_the_random_form_and_refuses_others() {
        let source: DirtSource = "random:5%:10-15".parse().unwrap();
        assert_eq!(source, DirtSource::Random { share: 0.05, units: (10.0, 15.0) });
        assert_eq!("a/b.csv".parse(), Ok(DirtSource::File(PathBuf::from("a/b.csv"))));
        for wrong in ["random:5%", "random:x%:1-2", "random:5%:9-3", "random:0%:1-2", "random:5%:1-99"] {
            assert!(wrong.parse::<DirtSource>().is_err(), "{wrong}");
        }
    }
}
