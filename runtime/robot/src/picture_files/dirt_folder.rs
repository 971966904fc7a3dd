//! Folders of floor pictures with masks: which file belongs to which frame, in the layouts in use.
//!
//! Either everything stands side by side, `NAME.png` with `NAME_mask.png` (the dirt), `NAME_floor.png` (where free floor
//! is) and `NAME_laser.png` (where the safety scanner marks it); or each kind has a folder, `frames/NAME.png` with
//! `masks/NAME.png`, `floor/NAME.png` and `laser/NAME.png`. Floor and laser are optional.

use floorguard_types::sensing::ImageSize;
use std::path::{Path, PathBuf};

use super::images::{ColourFile, read_colour, read_mask};
use floorguard_host::outcome::BadInput;

/// Largest side and most blocks of 16 × 16 that the detectors take; larger pictures are reduced.
const SIDE_MAX: usize = 640;
const BLOCKS_MAX: usize = 1_200;
/// Endings of files that are pictures.
const FORMATS: [&str; 5] = ["png", "jpg", "jpeg", "ppm", "pgm"];
/// Folders that may hold the frames.
pub const FRAME_FOLDERS: [&str; 7] = ["frames", "images", "image", "rgb", "color", "colour", "frame"];

/// A kind of mask: endings of names beside the frame, and folders of its own.
struct Kind {
    endings: &'static [&'static str],
    folders: &'static [&'static str],
}

const DIRT: Kind = Kind {
    endings: &["_mask", "_dirt", "_dirt_mask", "_gt"],
    folders: &["masks", "mask", "dirt", "dirt_masks", "dirt_mask", "gt"],
};
const FLOOR: Kind =
    Kind { endings: &["_floor", "_floor_mask"], folders: &["floor", "floor_masks", "floor_mask", "floors"] };
const LASER: Kind =
    Kind { endings: &["_laser", "_laser_mask"], folders: &["laser", "laser_masks", "laser_mask", "lasers"] };

/// A frame and what belongs to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DirtFrame {
    /// Name without folder and ending.
    pub name: String,
    /// The picture, reduced if it was too large.
    pub picture: ColourFile,
    /// Where dirt is.
    pub dirt: Vec<bool>,
    /// Where free floor without laser marking is.
    pub usable: Vec<bool>,
    /// Pixels of the file along one of the picture.
    pub reduced_by: usize,
}

/// The frames of a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DirtFolder {
    root: PathBuf,
    /// Frames with a mask, by name.
    pub frames: Vec<PathBuf>,
    /// Pictures that belong to no series with masks: notes, montages.
    pub others: usize,
}

impl DirtFolder {
    /// Lists the frames. A picture is a frame if the pictures of its series, the names that differ only in their
    /// digits, have masks: where one of them misses its own, the folder is broken.
    ///
    /// # Errors
    /// The folder cannot be read, has no frame, or a frame has no mask.
    pub fn open(root: &Path) -> anyhow::Result<Self> {
        let inner = FRAME_FOLDERS.iter().map(|name| root.join(name)).find(|path| path.is_dir());
        let folder = inner.as_deref().unwrap_or(root);
        let pictures = picture_files(folder)?;
        let mask = |path: &PathBuf| companion(root, path, &DIRT);
        let series: Vec<String> =
            pictures.iter().filter(|path| mask(path).is_some()).map(|p| series(p)).collect();
        if series.is_empty() {
            let problem = format!("{}: no frame with a mask of its dirt beside it", root.display());
            return Err(BadInput(problem).into());
        }
        let (frames, others): (Vec<_>, Vec<_>) =
            pictures.into_iter().partition(|path| inner.is_some() || series.contains(&self::series(path)));
        if let Some(missing) = frames.iter().find(|path| mask(path).is_none()) {
            let problem = format!("{}: the mask of its dirt is missing", missing.display());
            return Err(BadInput(problem).into());
        }
        Ok(Self { root: root.to_owned(), frames, others: others.len() })
    }

    /// Reads one frame.
    ///
    /// # Errors
    /// A file is cut off, no picture, or a mask has another size than the frame.
    pub fn read(&self, frame: &Path) -> anyhow::Result<DirtFrame> {
        let picture = read_colour(frame)?;
        let size = ImageSize { width: picture.width, height: picture.height };
        let read = |kind: &Kind| {
            companion(&self.root, frame, kind)
                .map(|path| read_mask(&path, size).map(|mask| mask.marked))
                .transpose()
        };
        let dirt = read(&DIRT)?.ok_or_else(|| BadInput(format!("{}: no mask", frame.display())))?;
        let mut usable = read(&FLOOR)?.unwrap_or_else(|| vec![true; size.width * size.height]);
        if let Some(laser) = read(&LASER)? {
            usable.iter_mut().zip(laser).for_each(|(usable, is_laser)| *usable &= !is_laser);
        }
        let name = frame.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(DirtFrame { name, picture, dirt, usable, reduced_by: 1 }.reduced())
    }
}

impl DirtFrame {
    /// Means of squares of pixels, so that the picture fits the detectors.
    fn reduced(self) -> Self {
        let (wide, high) = (self.picture.width, self.picture.height);
        let fits =
            |by: usize| wide.max(high) / by <= SIDE_MAX && (wide / by / 16) * (high / by / 16) <= BLOCKS_MAX;
        let by = (1..=wide.max(high)).find(|by| fits(*by)).unwrap_or(1);
        if by == 1 {
            return self;
        }
        let (width, height) = (wide / by, high / by);
        let square = |index: usize| {
            let (left, top) = (index % width * by, index / width * by);
            (0..by * by).map(move |inner| (top + inner / by) * wide + left + inner % by)
        };
        let mean = |index: usize, channel: usize| {
            let sum: usize =
                square(index).map(|place| usize::from(self.picture.rgb[3 * place + channel])).sum();
            ((sum + by * by / 2) / (by * by)) as u8
        };
        let rgb =
            (0..width * height).flat_map(|index| [0, 1, 2].map(|channel| mean(index, channel))).collect();
        let count = |mask: &[bool], index| square(index).filter(|place| mask[*place]).count();
        Self {
            dirt: (0..width * height).map(|index| 2 * count(&self.dirt, index) >= by * by).collect(),
            usable: (0..width * height).map(|index| count(&self.usable, index) == by * by).collect(),
            picture: ColourFile { width, height, rgb },
            name: self.name,
            reduced_by: by,
        }
    }
}

/// Pictures of a folder that are nobody's mask, by name.
///
/// # Errors
/// The folder cannot be read.
pub fn picture_files(folder: &Path) -> Result<Vec<PathBuf>, BadInput> {
    let bad = |problem: std::io::Error| BadInput(format!("{}: {problem}", folder.display()));
    let mut pictures = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(bad)? {
        let path = entry.map_err(bad)?.path();
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let is_mask =
            [DIRT, FLOOR, LASER].iter().flat_map(|kind| kind.endings).any(|end| stem.ends_with(end));
        if FORMATS.contains(&ending.as_str()) && !is_mask && path.is_file() {
            pictures.push(path);
        }
    }
    pictures.sort();
    Ok(pictures)
}

/// The mask of a frame: beside it under an ending of its kind, or in a folder of its kind.
fn companion(root: &Path, frame: &Path, kind: &Kind) -> Option<PathBuf> {
    let stem = frame.file_stem()?.to_string_lossy().into_owned();
    let beside = kind.endings.iter().map(|ending| frame.with_file_name(format!("{stem}{ending}")));
    let apart = kind.folders.iter().flat_map(|folder| {
        let names = kind.endings.iter().copied().chain([""]).map(|ending| format!("{stem}{ending}"));
        names.map(|name| root.join(folder).join(name)).collect::<Vec<_>>()
    });
    let with_format =
        |base: PathBuf| FORMATS.map(|format| PathBuf::from(format!("{}.{format}", base.display())));
    beside.chain(apart).flat_map(with_format).find(|path| path.is_file())
}

/// The name without its digits.
fn series(frame: &Path) -> String {
    frame.file_stem().unwrap_or_default().to_string_lossy().chars().filter(|c| !c.is_ascii_digit()).collect()
}
