//! A folder of recorded pictures as a camera: they come at their own pace or at a fixed rate, stamped as if taken now.
//!
//! Without a camera it shows what `run` makes of pictures. A file `poses.csv` in the folder
//! (`name,x_m,y_m,heading_rad`) says from where each was taken; without it the robot's odometry does, as with a camera.

use std::path::{Path, PathBuf};

use floorguard_types::geometry::Pose2;
use floorguard_types::sensing::ImageSize;
use floorguard_types::time::{Age, Stamp};

use super::folder_names::{RecordedPicture, RecordedPictures};
use super::frame_source::{FrameEvent, FrameSource};
use super::pixels::WrongFrame;
use crate::picture_files::{read_colour, read_depth, read_text};
use floorguard_host::outcome::BadInput;

/// After the last picture the camera is silent, and that is reported after this time, microseconds.
const SILENT_US: u64 = 1_000_000;
/// Where the robot was.
const POSES: &str = "poses.csv";
const COLUMNS: [&str; 4] = ["name", "x_m", "y_m", "heading_rad"];

/// Pictures that are still to come.
struct Playback {
    pictures: Vec<RecordedPicture>,
    shown: usize,
}

impl Playback {
    /// The newest picture that is due; those that nobody took in time are left out, as a camera does.
    fn due(&mut self, since_start_us: u64) -> Option<&RecordedPicture> {
        let due = self.pictures.partition_point(|picture| picture.at_us <= since_start_us);
        let is_new = due > self.shown;
        self.shown = due;
        self.pictures.get(due.checked_sub(1)?).filter(|_| is_new)
    }

    fn is_over(&self, since_start_us: u64) -> bool {
        self.pictures.last().is_none_or(|last| since_start_us > last.at_us.saturating_add(SILENT_US))
    }
}

/// The folder.
pub struct FolderSource {
    root: PathBuf,
    size: ImageSize,
    started: Option<Stamp>,
    depth: Playback,
    colour: Playback,
    /// By the depth picture's index in the playback; empty without a file.
    poses: Vec<Pose2>,
}

impl FolderSource {
    /// Lists a folder of pictures of a size; with a rate they come so many times a second.
    ///
    /// # Errors
    /// The folder is no recording, or its file of poses is broken or incomplete.
    pub fn open(root: &Path, size: ImageSize, rate_hz: Option<f32>) -> anyhow::Result<Self> {
        let RecordedPictures { depth, colour } = RecordedPictures::list(root, rate_hz)?;
        let path = root.join(POSES);
        let poses = if path.exists() { read_poses(&path, &depth)? } else { Vec::new() };
        let playback = |pictures| Playback { pictures, shown: 0 };
        Ok(Self {
            root: root.to_owned(),
            size,
            started: None,
            depth: playback(depth),
            colour: playback(colour),
            poses,
        })
    }

    fn since_start_us(&mut self, now: Stamp) -> (Stamp, u64) {
        let started = *self.started.get_or_insert(now);
        let since_us = if let Age::Past(age_us) = started.age(now) { age_us } else { 0 };
        (started, since_us)
    }
}

/// The next picture of a playback, read and checked.
fn next<P>(
    playback: &mut Playback,
    (started, since_start_us): (Stamp, u64),
    read: impl FnOnce(&Path) -> anyhow::Result<Result<P, WrongFrame>>,
) -> FrameEvent<P> {
    let Some(picture) = playback.due(since_start_us) else {
        let count = playback.pictures.len();
        let over = playback.is_over(since_start_us) && count > 0;
        return if over {
            FrameEvent::Silent(format!("all {count} pictures were shown"))
        } else {
            FrameEvent::Nothing
        };
    };
    let stamp = Stamp::from_micros(started.as_micros().saturating_add(picture.at_us));
    let named =
        |problem: WrongFrame| WrongFrame::InFile(picture.path.display().to_string(), Box::new(problem));
    match read(&picture.path) {
        Ok(Ok(pixels)) => FrameEvent::Picture(stamp, pixels),
        Ok(Err(problem)) => FrameEvent::Damaged(named(problem)),
        // These say the name themselves.
        Err(problem) => FrameEvent::Damaged(WrongFrame::Unreadable(problem.to_string())),
    }
}

/// The pixels of a picture that has the size that is `wanted`.
fn fitting<P>(pixels: P, found: ImageSize, wanted: ImageSize) -> Result<P, WrongFrame> {
    if found == wanted { Ok(pixels) } else { Err(WrongFrame::OtherSize { found, wanted }) }
}

impl FrameSource for FolderSource {
    fn name(&self) -> String {
        self.root.display().to_string()
    }

    fn has_colour(&self) -> bool {
        !self.colour.pictures.is_empty()
    }

    fn depth(&mut self, now: Stamp) -> FrameEvent<Vec<u16>> {
        let (when, size) = (self.since_start_us(now), self.size);
        next(&mut self.depth, when, |path| {
            read_depth(path).map(|file| {
                fitting(file.depth_mm, ImageSize { width: file.width, height: file.height }, size)
            })
        })
    }

    fn colour(&mut self, now: Stamp) -> FrameEvent<Vec<u8>> {
        let (when, size) = (self.since_start_us(now), self.size);
        next(&mut self.colour, when, |path| {
            read_colour(path)
                .map(|file| fitting(file.rgb, ImageSize { width: file.width, height: file.height }, size))
        })
    }

    fn pose(&self) -> Option<Pose2> {
        self.poses.get(self.depth.shown.checked_sub(1)?).copied()
    }
}

/// A pose for each depth picture.
fn read_poses(path: &Path, pictures: &[RecordedPicture]) -> anyhow::Result<Vec<Pose2>> {
    let text = read_text(path)?;
    let bad = |line: usize, problem: &str| BadInput(format!("{}, line {line}: {problem}", path.display()));
    let mut lines = text.lines().enumerate();
    let (_, head) = lines.next().unwrap_or_default();
    let place = |wanted: &str| head.split(',').position(|name| name.trim() == wanted);
    let [Some(name), Some(x), Some(y), Some(heading)] = COLUMNS.map(place) else {
        return Err(bad(1, "expected the columns name, x_m, y_m, heading_rad").into());
    };
    let mut known: Vec<(&str, Pose2)> = Vec::new();
    for (index, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let number = |column: usize| {
            let value = cells.get(column).and_then(|cell| cell.parse::<f32>().ok());
            value
                .filter(|value| value.is_finite())
                .ok_or_else(|| bad(index + 1, "three numbers after the name"))
        };
        let pose = Pose2::new(number(x)?, number(y)?, number(heading)?);
        known.push((cells.get(name).copied().unwrap_or_default(), pose));
    }
    known.sort_by_key(|(name, _)| *name);
    let pose_of = |picture: &RecordedPicture| {
        let found = known.binary_search_by_key(&picture.base.as_str(), |(name, _)| *name);
        let missing = || BadInput(format!("{}: no pose of {}", path.display(), picture.base));
        found.ok().and_then(|index| known.get(index)).map(|(_, pose)| *pose).ok_or_else(missing)
    };
    Ok(pictures.iter().map(pose_of).collect::<Result<_, _>>()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageBuffer, Luma, RgbImage};

    const TWO_BY_ONE: ImageSize = ImageSize { width: 2, height: 1 };

    fn depth(path: &Path, (width, height): (u32, u32), value: u16) {
        ImageBuffer::<Luma<u16>, _>::from_pixel(width, height, Luma([value])).save(path).expect("room");
    }

    fn at(ms: u64) -> Stamp {
        Stamp::from_micros(5_000_000 + 1_000 * ms)
    }

    /// They come when they are due, late ones are left out, and stamps are those of the recording, moved to now.
    #[test]
    fn pictures_come_at_their_pace() {
        let root = tempfile::tempdir().expect("a folder");
        for (name, value) in [("10.0", 1), ("10.1", 2), ("10.3", 3)] {
            depth(&root.path().join(format!("{name}_depth.png")), (2, 1), value);
        }
        RgbImage::new(2, 1).save(root.path().join("10.1.png")).expect("room");
        let poses = "name,x_m,y_m,heading_rad\n10.1,2.0,0,0\n10.0,1.0,0,0\n10.3,3.0,0,0.5\n";
        std::fs::write(root.path().join(POSES), poses).expect("room");
        let mut source = FolderSource::open(root.path(), TWO_BY_ONE, None).expect("a recording");
        assert!(source.has_colour() && source.pose().is_none());
        assert_eq!(source.depth(at(0)), FrameEvent::Picture(at(0), vec![1; 2]));
        assert_eq!(
            (source.pose().map(|pose| pose.x_m), source.depth(at(99))),
            (Some(1.0), FrameEvent::Nothing)
        );
        assert_eq!(source.colour(at(310)), FrameEvent::Picture(at(100), vec![0; 6]));
        assert_eq!(source.depth(at(310)), FrameEvent::Picture(at(300), vec![3; 2]));
        assert_eq!(source.pose(), Some(Pose2::new(3.0, 0.0, 0.5)));
        assert_eq!(source.depth(at(1_300)), FrameEvent::Nothing);
        assert_eq!(source.depth(at(1_301)), FrameEvent::Silent("all 3 pictures were shown".to_owned()));
    }

    /// A file that is cut off, of another size or of other pixels is reported by its name, and the next one is
    /// taken.
    #[test]
    fn bad_pictures_are_reported_by_name() {
        let root = tempfile::tempdir().expect("a folder");
        let path = |name: &str| root.path().join(name);
        depth(&path("a1_depth.png"), (2, 1), 1);
        depth(&path("a2_depth.png"), (3, 1), 1);
        let whole = std::fs::read(path("a1_depth.png")).expect("there");
        std::fs::write(path("a3_depth.png"), &whole[..whole.len() / 2]).expect("room");
        RgbImage::new(2, 1).save(path("a4_depth.png")).expect("room");
        depth(&path("a5_depth.png"), (2, 1), 5);
        let mut source = FolderSource::open(root.path(), TWO_BY_ONE, Some(10.0)).expect("a recording");
        assert!(matches!(source.depth(at(0)), FrameEvent::Picture(..)));
        for (number, part) in [(2, "3 × 1"), (3, "a3_depth.png"), (4, "16 bits")] {
            let FrameEvent::Damaged(problem) = source.depth(at(100 * (number - 1))) else {
                panic!("{number}")
            };
            let text = problem.to_string();
            assert!(text.contains(part) && text.contains(&format!("a{number}_depth.png")), "{text}");
        }
        assert!(matches!(source.depth(at(400)), FrameEvent::Picture(..)));
    }

    #[test]
    fn poses_must_be_complete() {
        let root = tempfile::tempdir().expect("a folder");
        depth(&root.path().join("a1_depth.png"), (2, 1), 1);
        for (poses, part) in [
            ("x,y\n", "expected the columns"),
            ("name,x_m,y_m,heading_rad\na1,1,NaN,0\n", "line 2"),
            ("name,x_m,y_m,heading_rad\na1,1,2\n", "line 2"),
            ("name,x_m,y_m,heading_rad\nb1,1,2,0\n", "no pose of a1"),
        ] {
            std::fs::write(root.path().join(POSES), poses).expect("room");
            let refused = FolderSource::open(root.path(), TWO_BY_ONE, Some(9.0)).err().expect("refused");
            assert!(refused.is::<BadInput>() && refused.to_string().contains(part), "{refused}");
        }
    }
}
