//! The thread of the floor camera: takes frames until the run ends, and waits for a camera that is not there.

use std::path::Path;
use std::thread;
use std::time::{Duration, Instant};

use floorguard_runtime::clock;
use floorguard_runtime::configuration::RobotConfiguration;

use super::device::Device;
use super::look::FloorLook;
use super::people::PeopleLook;
use super::pixels::depth_of;
use crate::configuration::CameraConfiguration;
use crate::executor::StopFlag;
use crate::robot::HostedShared;
use crate::world::PeopleInbox;

/// Between looks at the device: a third of a frame at 30 Hz.
const POLL: Duration = Duration::from_millis(10);
/// Between attempts to open a device that is not there.
const RETRY: Duration = Duration::from_secs(2);
/// A device that sends nothing for this long is opened again.
const SILENT: Duration = Duration::from_secs(2);
/// Depth in whole millimetres.
const Z16: [u8; 4] = *b"Z16 ";

/// Publishes what the camera sees until `flag` stops; before the first picture, that nothing is known.
pub fn watch_floor(
    (robot, camera): (&RobotConfiguration, &CameraConfiguration),
    (shared, inbox): (&HostedShared, &PeopleInbox),
    flag: &StopFlag,
    say: impl Fn(String),
) {
    let Some(floor) = FloorLook::new(robot, camera) else { return };
    let mut look = (floor, PeopleLook::new(camera));
    shared.floor.publish(look.0.blind(clock::now()));
    let mut said = None;
    while !flag.is_stopped() {
        match Device::open(&camera.depth, camera.size, &[Z16]) {
            Ok(device) => {
                said = None;
                let why = follow(device, (&mut look, camera), (shared, inbox), flag);
                if !flag.is_stopped() {
                    say(format!("camera: {}: {why}; the floor is unknown", camera.depth.display()));
                }
            }
            Err(problem) => say_once(&mut said, &camera.depth, problem.to_string(), &say),
        }
        let until = Instant::now() + RETRY;
        while !flag.is_stopped() && Instant::now() < until {
            thread::sleep(POLL);
        }
    }
}

/// The same reason is not told again and again.
fn say_once(said: &mut Option<String>, device: &Path, why: String, say: &impl Fn(String)) {
    if said.as_deref() != Some(&why) {
        say(format!("camera: {}: {why}; waiting for it, the floor is unknown", device.display()));
        *said = Some(why);
    }
}

/// Looks at every frame; returns why it ended.
fn follow(
    mut device: Device,
    ((floor, people), camera): (&mut (FloorLook, PeopleLook), &CameraConfiguration),
    (shared, inbox): (&HostedShared, &PeopleInbox),
    flag: &StopFlag,
) -> String {
    let mut last = Instant::now();
    while !flag.is_stopped() {
        match device.newest() {
            Err(problem) => return problem.to_string(),
            Ok(None) if last.elapsed() > SILENT => return "no pictures any more".to_owned(),
            Ok(None) => thread::sleep(POLL),
            Ok(Some((stamp, bytes))) => {
                last = Instant::now();
                let pose = shared.pose.get().unwrap_or_default().pose_in_odometry;
                let Ok(depth_mm) = depth_of(&bytes, camera.size, device.line_bytes) else {
                    shared.floor.publish(floor.blind(stamp));
                    continue;
                };
                shared.floor.publish(floor.look(&depth_mm, pose, (stamp, clock::now())));
                let seen = floor.plane().and_then(|plane| people.look(&depth_mm, (plane, pose), stamp));
                seen.into_iter().for_each(|view| inbox.put(view));
            }
        }
    }
    "ended".to_owned()
}
