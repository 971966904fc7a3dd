//! What belongs together in a folder of recorded pictures, and when each was taken, from the names.
//!
//! Either each kind has a folder, `depth/NAME.png` with `rgb/NAME.png` (or `frames`, `images`, `color`, as in sets of dirty
//! floors), or everything stands side by side: `NAME_depth.png` (or `NAME_depth_mm.png`) with `NAME_color.jpg`,
//! `NAME_rgb.png` or `NAME.png`. A name that ends in a stamp says when its picture was taken.

use std::path::{Path, PathBuf};

use crate::picture_files::{FRAME_FOLDERS, picture_files};
use floorguard_host::outcome::BadInput;

const DEPTH_FOLDERS: [&str; 3] = ["depth", "depths", "depth_mm"];
const DEPTH_ENDINGS: [&str; 2] = ["_depth_mm", "_depth"];
const COLOUR_ENDINGS: [&str; 3] = ["_color", "_colour", "_rgb"];

/// A picture of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedPicture {
    /// What it shares with the other pictures of the same moment.
    pub base: String,
    /// The file.
    pub path: PathBuf,
    /// After the first depth picture, microseconds.
    pub at_us: u64,
}

/// Depth and colour pictures of a folder, oldest first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordedPictures {
    /// Depth.
    pub depth: Vec<RecordedPicture>,
    /// Colour; none if dirt cannot be seen.
    pub colour: Vec<RecordedPicture>,
}

impl RecordedPictures {
    /// Lists a folder; with a rate the pictures come in the order of their names, without one at the pace of the stamps in
    /// them.
    ///
    /// # Errors
    /// The folder cannot be read, holds no depth pictures, or nobody knows when they were taken.
    pub fn list(root: &Path, rate_hz: Option<f32>) -> Result<Self, BadInput> {
        let bad = |problem: &str| BadInput(format!("{}: {problem}", root.display()));
        let (depth, colour) = sort_out(root)?;
        if depth.is_empty() {
            return Err(bad("no depth pictures: expected depth/NAME.png or NAME_depth.png"));
        }
        if let Some(rate_hz) = rate_hz {
            return Ok(by_number(depth, colour, rate_hz));
        }
        let by_stamp = |pictures: Vec<(String, PathBuf)>| -> Result<Vec<_>, BadInput> {
            let stamped = pictures.into_iter().map(|(base, path)| match stamp_us(&base) {
                Some(at_us) => Ok(RecordedPicture { base, path, at_us }),
                None => Err(BadInput(format!(
                    "{}: the name ends in no stamp; give `rate_hz` in [camera]",
                    path.display()
                ))),
            });
            let mut pictures = stamped.collect::<Result<Vec<_>, _>>()?;
            pictures.sort_by_key(|picture| picture.at_us);
            Ok(pictures)
        };
        let (mut depth, mut colour) = (by_stamp(depth)?, by_stamp(colour)?);
        if let Some([_, second]) = depth.array_windows().find(|[first, second]| first.at_us == second.at_us) {
            return Err(bad(&format!("two depth pictures of the same moment: {}", second.path.display())));
        }
        let first_us = depth.first().map_or(0, |picture| picture.at_us);
        colour.retain(|picture| picture.at_us >= first_us);
        depth.iter_mut().chain(&mut colour).for_each(|picture| picture.at_us -= first_us);
        Ok(Self { depth, colour })
    }
}

/// A colour picture has the moment of the depth picture of its name; without one it belongs to no floor.
fn by_number(
    depth: Vec<(String, PathBuf)>,
    colour: Vec<(String, PathBuf)>,
    rate_hz: f32,
) -> RecordedPictures {
    let at_us = |number: usize| (1.0e6 * number as f64 / f64::from(rate_hz)) as u64;
    let numbered = depth.into_iter().enumerate();
    let depth: Vec<RecordedPicture> =
        numbered.map(|(number, (base, path))| RecordedPicture { base, path, at_us: at_us(number) }).collect();
    let moment = |base: &str| depth.iter().find(|other| other.base == base).map(|other| other.at_us);
    let colour = colour.into_iter().filter_map(|(base, path)| {
        let at_us = moment(&base)?;
        Some(RecordedPicture { base, path, at_us })
    });
    let colour = colour.collect();
    RecordedPictures { depth, colour }
}

type Named = Vec<(String, PathBuf)>;

/// Depth and colour pictures with their names, by name.
fn sort_out(root: &Path) -> Result<(Named, Named), BadInput> {
    let folder = |names: &[&str]| names.iter().map(|name| root.join(name)).find(|path| path.is_dir());
    let (depth_folder, colour_folder) = (folder(&DEPTH_FOLDERS), folder(&FRAME_FOLDERS));
    let beside = picture_files(root)?;
    let depth = match &depth_folder {
        Some(folder) => picture_files(folder)?,
        None => beside.iter().filter(|path| ending(path, &DEPTH_ENDINGS).is_some()).cloned().collect(),
    };
    let colour = match &colour_folder {
        Some(folder) => picture_files(folder)?,
        None => beside.into_iter().filter(|path| ending(path, &DEPTH_ENDINGS).is_none()).collect(),
    };
    let named = |paths: Vec<PathBuf>, endings: &[&str]| -> Named {
        paths.into_iter().map(|path| (base(&path, endings), path)).collect()
    };
    let depth = named(depth, &DEPTH_ENDINGS);
    let mut colour = named(colour, &COLOUR_ENDINGS);
    if colour_folder.is_none() {
        // Beside depth pictures only what has the name of one is a frame: notes and montages are none.
        colour.retain(|(base, _)| depth.iter().any(|(other, _)| other == base));
    }
    Ok((depth, colour))
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn ending<'a>(path: &Path, endings: &[&'a str]) -> Option<&'a str> {
    let stem = stem(path);
    endings.iter().copied().find(|ending| stem.ends_with(ending))
}

fn base(path: &Path, endings: &[&str]) -> String {
    let stem = stem(path);
    let cut = ending(path, endings).map_or(stem.len(), |ending| stem.len() - ending.len());
    stem[..cut].to_owned()
}

/// The stamp at the end of a name, microseconds: seconds with a point, or whole milli-, micro- or nanoseconds since
/// 1970, recognised by their digits. A short whole number counts pictures and is none.
pub fn stamp_us(base: &str) -> Option<u64> {
    let from =
        base.rfind(|letter: char| !letter.is_ascii_digit() && letter != '.').map_or(0, |last| last + 1);
    let number = base.get(from..)?.trim_matches('.');
    if let Some((seconds, fraction)) = number.split_once('.') {
        let micros: u64 = format!("{fraction:0<6}").get(..6)?.parse().ok()?;
        return seconds.parse::<u64>().ok()?.checked_mul(1_000_000)?.checked_add(micros);
    }
    let value: u64 = number.parse().ok()?;
    match number.len() {
        12..=13 => value.checked_mul(1_000),
        15..=16 => Some(value),
        18..=19 => Some(value / 1_000),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamp_units_follow_from_their_digits() {
        for (name, expected) in [
            ("1305031102.160407", Some(1_305_031_102_160_407)),
            ("floor_1305031102.5", Some(1_305_031_102_500_000)),
            ("depth-1525354353123", Some(1_525_354_353_123_000)),
            ("1525354353123456", Some(1_525_354_353_123_456)),
            ("f_1525354353123456789", Some(1_525_354_353_123_456)),
            ("frame_000123", None),
            ("frame", None),
            ("99999999999999999999.1", None),
        ] {
            assert_eq!(stamp_us(name), expected, "{name}");
        }
    }

    fn names(pictures: &[RecordedPicture]) -> Vec<(&str, u64)> {
        pictures.iter().map(|picture| (picture.base.as_str(), picture.at_us)).collect()
    }

    fn folder(files: &[&str]) -> tempfile::TempDir {
        let root = tempfile::tempdir().expect("a folder");
        for file in files {
            let path = root.path().join(file);
            std::fs::create_dir_all(path.parent().expect("within")).expect("room");
            std::fs::write(path, b"").expect("room");
        }
        root
    }

    #[test]
    fn both_layouts_are_read() {
        let apart = folder(&["depth/10.5.png", "depth/10.7.png", "rgb/10.4.jpg", "rgb/10.51.jpg"]);
        let found = RecordedPictures::list(apart.path(), None).expect("stamps");
        assert_eq!(names(&found.depth), [("10.5", 0), ("10.7", 200_000)]);
        assert_eq!(names(&found.colour), [("10.51", 10_000)]);
        let beside =
            folder(&["a1_depth.png", "a1.png", "a2_depth_mm.png", "a2_color.jpg", "a1_floor.png", "n.png"]);
        let found = RecordedPictures::list(beside.path(), Some(5.0)).expect("a rate");
        assert_eq!(names(&found.depth), [("a1", 0), ("a2", 200_000)]);
        assert_eq!(names(&found.colour), [("a1", 0), ("a2", 200_000)]);
    }

    #[test]
    fn recordings_without_depth_or_stamps_are_refused() {
        let refused = |files: &[&str]| {
            RecordedPictures::list(folder(files).path(), None).expect_err("refused").to_string()
        };
        assert!(refused(&["a1.png"]).contains("no depth pictures"));
        assert!(refused(&["a1_depth.png"]).contains("rate_hz"));
        assert!(refused(&["depth/a_10.5.png", "depth/b_10.5.png"]).contains("same moment"));
        let absent = RecordedPictures::list(Path::new("no/such/folder"), None).expect_err("refused");
        assert!(absent.to_string().contains("no/such/folder"));
    }
}
