//! What the camera of `run` tells: words for the console, its map of dirt for the recording and as JSON.

use std::thread;
use std::time::Instant;

use floorguard_mapping::seen_dirt::DirtSpot;
use serde_json::json;

use floorguard_configuration::HostedConfiguration;
use floorguard_host::executor::{Ring, StopFlag, take_priority};
use floorguard_operator::telemetry::TelemetrySender;
use floorguard_robot::assembly::PeopleInbox;
use floorguard_robot::assembly::{HostedShared, StopsAtEnd};
use floorguard_robot::camera::{CameraEvent, LiveSource, SeenDirt, watch_floor};

/// What the camera's thread needs to tell.
pub struct LiveCamera<'a> {
    /// What runs.
    pub configuration: &'a HostedConfiguration,
    /// The path of the recording.
    pub notes: &'a TelemetrySender<'a>,
    /// One object per line on standard output.
    pub has_json: bool,
}

impl LiveCamera<'_> {
    /// Runs `beside` while the camera, if there is one, looks at floor, people and dirt on a thread of its own.
    pub fn watch<T>(
        &self,
        source: Option<LiveSource>,
        (shared, inbox): (&HostedShared, &PeopleInbox),
        beside: impl FnOnce() -> T,
    ) -> T {
        let flag = &StopFlag::default();
        let configuration = self.configuration;
        let began = Instant::now();
        thread::scope(|scope| {
            if let Some((camera, source)) = configuration.carriers.camera.as_ref().zip(source) {
                let tell = move |event| self.tell(event, began);
                scope.spawn(move || {
                    let _ = take_priority(Ring::Camera);
                    watch_floor((&configuration.robot, camera), source, (shared, inbox, flag), tell);
                });
            }
            let _at_end = StopsAtEnd(flag.clone());
            beside()
        })
    }

    fn tell(&self, event: CameraEvent, began: Instant) {
        match event {
            CameraEvent::Message(words) => say!("floorguard run: camera: {words}"),
            CameraEvent::Picture(picture) => self.notes.camera_picture(picture),
            CameraEvent::Dirt(seen) => {
                if self.has_json {
                    // The reporter finds that its output is closed.
                    let _ = tell!("{}", dirt_line(&seen, began.elapsed().as_secs_f64()));
                } else {
                    say!("floorguard run: camera: {}", seen.words());
                }
                self.notes.seen_dirt(seen);
            }
        }
    }
}

/// The map of dirt in short, one object.
fn dirt_line(seen: &SeenDirt, time_s: f64) -> serde_json::Value {
    let spot = |spot: &DirtSpot| {
        let centre = spot.centre_in_map;
        json!({"x_m": centre.x_m, "y_m": centre.y_m, "area_m2": spot.area_m2, "age_s": spot.age_s})
    };
    let ([first_m2, now_m2], (judged, unknown)) = (seen.dirty_m2, seen.frames);
    json!({"type": "dirt", "time_s": time_s, "seen_m2": seen.seen_m2, "first_dirty_m2": first_m2, "dirty_m2": now_m2,
        "frames": judged, "frames_unknown": unknown, "spots": seen.spots.spots.iter().map(spot).collect::<Vec<_>>()})
}
