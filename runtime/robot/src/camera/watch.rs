//! The thread of the floor camera: takes pictures until the run ends, and waits for a camera that is not there.

use std::path::Path;
use std::thread;
use std::time::Duration;

use floorguard_runtime::clock;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_types::time::{Age, Stamp};

use super::dirt_stage::SeenDirt;
use super::folder_source::FolderSource;
use super::frame_source::{ColourPicture, FrameSource};
use super::kernel_source::KernelSource;
use super::watcher::Watcher;
use crate::assembly::HostedShared;
use crate::assembly::PeopleInbox;
use floorguard_configuration::{CameraConfiguration, CameraSource};
use floorguard_host::executor::StopFlag;

/// Between polls of the streams: a third of a frame at 30 Hz.
const POLL: Duration = Duration::from_millis(10);
/// The map of dirt is reported this often, microseconds.
const SEEN_EVERY_US: u64 = 10_000_000;

/// What the camera tells besides what the rings hear.
pub enum CameraEvent {
    /// For the console.
    Message(String),
    /// A picture for people, about once a second.
    Picture(ColourPicture),
    /// The map of dirt, from time to time and at the end.
    Dirt(Box<SeenDirt>),
}

/// Where the pictures of a configuration come from; a folder is relative to the configuration's.
///
/// # Errors
/// The folder is no recording.
pub fn open_source(camera: &CameraConfiguration, beside: &Path) -> anyhow::Result<LiveSource> {
    Ok(match &camera.source {
        CameraSource::Devices { depth, colour } => {
            LiveSource::Kernel(KernelSource::new(depth, colour.as_deref(), camera.size))
        }
        CameraSource::Folder { path, rate_hz } => {
            LiveSource::Folder(FolderSource::open(&beside.join(path), camera.size, *rate_hz)?)
        }
    })
}

/// The frame sources of `run`.
pub enum LiveSource {
    /// Devices.
    Kernel(KernelSource),
    /// A recording.
    Folder(FolderSource),
}

/// Publishes what the camera sees until `flag` stops; before the first picture, that nothing is known.
pub fn watch_floor(
    (robot, camera): (&RobotConfiguration, &CameraConfiguration),
    source: LiveSource,
    (shared, inbox, flag): (&HostedShared, &PeopleInbox, &StopFlag),
    tell: impl Fn(CameraEvent),
) {
    match source {
        LiveSource::Kernel(source) => watch((robot, camera), source, (shared, inbox, flag), tell),
        LiveSource::Folder(source) => watch((robot, camera), source, (shared, inbox, flag), tell),
    }
}

fn watch(
    (robot, camera): (&RobotConfiguration, &CameraConfiguration),
    mut source: impl FrameSource,
    (shared, inbox, flag): (&HostedShared, &PeopleInbox, &StopFlag),
    tell: impl Fn(CameraEvent),
) {
    let Some(mut watcher) = Watcher::new(robot, camera, source.has_colour()) else { return };
    shared.floor.publish(watcher.blind(clock::now()));
    tell(CameraEvent::Message(source.name()));
    let mut reported = clock::now();
    let is_due =
        |reported: Stamp| matches!(reported.age(clock::now()), Age::Past(age_us) if age_us >= SEEN_EVERY_US);
    while !flag.is_stopped() {
        let pose = shared.pose.get().unwrap_or_default().pose_in_odometry;
        let attended = watcher.attend(&mut source, pose, clock::now);
        attended.words.into_iter().for_each(|words| tell(CameraEvent::Message(words)));
        attended.people.into_iter().for_each(|view| inbox.put(view));
        attended.picture.into_iter().for_each(|picture| tell(CameraEvent::Picture(picture)));
        if let Some(sight) = attended.sight {
            shared.floor.publish(sight);
        } else {
            thread::sleep(POLL);
        }
        if is_due(reported) {
            reported = clock::now();
            watcher.seen(reported).into_iter().for_each(|seen| tell(CameraEvent::Dirt(Box::new(seen))));
        }
    }
    watcher.seen(clock::now()).into_iter().for_each(|seen| tell(CameraEvent::Dirt(Box::new(seen))));
}
