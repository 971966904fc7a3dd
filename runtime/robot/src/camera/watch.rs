//! The thread of the floor camera: takes pictures until the run ends, and waits for a camera that is not there.

use std::path::Path;
use std::thread;
use std::time::Duration;

use floorguard_runtime::clock;
use floorguard_runtime::configuration::RobotConfiguration;
use floorguard_types::time::{Age, Stamp};

use super::dirt_look::SeenDirt;
use super::eye::Eye;
use super::folder_eye::FolderEye;
use super::kernel_eye::KernelEye;
use super::watcher::Watcher;
use crate::assembly::HostedShared;
use crate::assembly::PeopleInbox;
use floorguard_configuration::{CameraConfiguration, CameraSource};
use floorguard_host::executor::StopFlag;

/// Between looks at the streams: a third of a frame at 30 Hz.
const POLL: Duration = Duration::from_millis(10);
/// The map of dirt is told this often, microseconds.
const SEEN_EVERY_US: u64 = 10_000_000;

/// What the camera tells besides what the rings hear.
pub enum CameraNews {
    /// For the console.
    Says(String),
    /// The map of dirt, from time to time and at the end.
    Dirt(Box<SeenDirt>),
}

/// Where the pictures of a configuration come from; a folder is relative to the configuration's.
///
/// # Errors
/// The folder is no recording.
pub fn open_eye(camera: &CameraConfiguration, beside: &Path) -> anyhow::Result<LiveEye> {
    Ok(match &camera.source {
        CameraSource::Devices { depth, colour } => {
            LiveEye::Kernel(KernelEye::new(depth, colour.as_deref(), camera.size))
        }
        CameraSource::Folder { path, rate_hz } => {
            LiveEye::Folder(FolderEye::open(&beside.join(path), camera.size, *rate_hz)?)
        }
    })
}

/// The eyes that `run` knows.
pub enum LiveEye {
    /// Devices.
    Kernel(KernelEye),
    /// A recording.
    Folder(FolderEye),
}

/// Publishes what the camera sees until `flag` stops; before the first picture, that nothing is known.
pub fn watch_floor(
    (robot, camera): (&RobotConfiguration, &CameraConfiguration),
    eye: LiveEye,
    (shared, inbox, flag): (&HostedShared, &PeopleInbox, &StopFlag),
    tell: impl Fn(CameraNews),
) {
    match eye {
        LiveEye::Kernel(eye) => watch((robot, camera), eye, (shared, inbox, flag), tell),
        LiveEye::Folder(eye) => watch((robot, camera), eye, (shared, inbox, flag), tell),
    }
}

fn watch(
    (robot, camera): (&RobotConfiguration, &CameraConfiguration),
    mut eye: impl Eye,
    (shared, inbox, flag): (&HostedShared, &PeopleInbox, &StopFlag),
    tell: impl Fn(CameraNews),
) {
    let Some(mut watcher) = Watcher::new(robot, camera, eye.has_colour()) else { return };
    shared.floor.publish(watcher.blind(clock::now()));
    tell(CameraNews::Says(eye.name()));
    let mut told = clock::now();
    let is_due = |told: Stamp| matches!(told.age(clock::now()), Age::Past(age_us) if age_us >= SEEN_EVERY_US);
    while !flag.is_stopped() {
        let pose = shared.pose.get().unwrap_or_default().pose_in_odometry;
        let attended = watcher.attend(&mut eye, pose, clock::now);
        attended.words.into_iter().for_each(|words| tell(CameraNews::Says(words)));
        attended.people.into_iter().for_each(|view| inbox.put(view));
        if let Some(sight) = attended.sight {
            shared.floor.publish(sight);
        } else {
            thread::sleep(POLL);
        }
        if is_due(told) {
            told = clock::now();
            watcher.seen(told).into_iter().for_each(|seen| tell(CameraNews::Dirt(Box::new(seen))));
        }
    }
    watcher.seen(clock::now()).into_iter().for_each(|seen| tell(CameraNews::Dirt(Box::new(seen))));
}
