use super::*;
use crate::camera::WrongFrame;
use floorguard_configuration::{CameraSource, EXAMPLE, parse};
use floorguard_perception::floor::Plane;
use floorguard_sim::floor::{DirtKind, FloorCamera, FloorKind, FloorScene, PictureMoment, Spill};
use floorguard_types::geometry::Point2;
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::{ImageSize, PinholeCamera};

const SIZE: ImageSize = ImageSize { width: 320, height: 240 };
/// Of the pictures of another camera.
const SMALL: ImageSize = ImageSize { width: 160, height: 120 };
const FOCAL_PX: f32 = 262.5;
/// Between pictures: 12 cm at 0.6 m/s.
const STEP_MS: u64 = 200;
const SPILLED: Point2 = Point2 { x_m: 2.4, y_m: 0.1 };

/// Streams that say what they are given.
#[derive(Default)]
struct Fake {
    depth: Vec<FrameEvent<Vec<u16>>>,
    colour: Vec<FrameEvent<Vec<u8>>>,
}

impl FrameSource for Fake {
    fn name(&self) -> String {
        "fake".to_owned()
    }

    fn has_colour(&self) -> bool {
        true
    }

    fn depth(&mut self, _: Stamp) -> FrameEvent<Vec<u16>> {
        self.depth.pop().unwrap_or(FrameEvent::Nothing)
    }

    fn colour(&mut self, _: Stamp) -> FrameEvent<Vec<u8>> {
        self.colour.pop().unwrap_or(FrameEvent::Nothing)
    }
}

/// A robot that drives over vinyl towards a spill, and its camera.
struct Drive {
    watcher: Watcher,
    scene: FloorScene,
    rendered: FloorCamera,
    step: u64,
    words: Vec<String>,
}

fn at(step: u64) -> Stamp {
    Stamp::from_micros(1_000_000 + 1_000 * STEP_MS * step)
}

impl Drive {
    fn new() -> Self {
        let robot = parse("robot.toml", EXAMPLE).expect("the example is right").robot;
        let mut mounting = robot.lidar.mounting;
        (mounting.position.x_m, mounting.position.y_m, mounting.position.z_m) = (0.9, 0.0, 0.72);
        (mounting.pitch_rad, mounting.yaw_rad) = (0.85, 0.0);
        let centre = [(SIZE.width as f32 - 1.0) / 2.0, (SIZE.height as f32 - 1.0) / 2.0];
        let camera = CameraConfiguration {
            source: CameraSource::Folder { path: "".into(), rate_hz: None },
            size: SIZE,
            camera: PinholeCamera::new([FOCAL_PX; 2], centre).expect("a camera"),
            mounting,
        };
        let mut scene = FloorScene::new(FloorKind::Vinyl, 4.0, 7);
        let mut random = Pcg32::new(7, 7);
        let coffee = Spill {
            radii_m: [0.1; 2],
            strength: 1.0,
            ..Spill::random(DirtKind::Liquid, SPILLED, &mut random)
        };
        scene.spills.push(coffee);
        let rendered =
            FloorCamera { size: SIZE, focal_px: FOCAL_PX, forward_m: 0.9, ..FloorCamera::default() };
        let watcher = Watcher::new(&robot, &camera, true).expect("above the floor");
        Self { watcher, scene, rendered, step: 0, words: Vec::new() }
    }

    fn pose(&self) -> Pose2 {
        Pose2::new(0.12 * self.step as f32, 0.0, 0.0)
    }

    fn depth(&self) -> Vec<u16> {
        let plane = Plane::of_mounting(self.rendered.height_m, self.rendered.pitch_rad).expect("a plane");
        let centre = [(SIZE.width as f32 - 1.0) / 2.0, (SIZE.height as f32 - 1.0) / 2.0];
        let camera = PinholeCamera::new([FOCAL_PX; 2], centre).expect("a camera");
        let pixel = |index: usize| {
            let ray = camera.ray((index % SIZE.width) as f32, (index / SIZE.width) as f32);
            let down: f32 = plane.normal.iter().zip(ray).map(|(n, r)| -n * r).sum();
            let jitter = (index as u64 * 7 + self.step * 13) % 3;
            if down < 0.05 { 0 } else { (1_000.0 * plane.distance_m / down) as u16 + jitter as u16 }
        };
        (0..SIZE.width * SIZE.height).map(pixel).collect()
    }

    fn colour(&self) -> Vec<u8> {
        self.scene
            .picture(&self.rendered, self.pose(), PictureMoment { frame: self.step as u32, at_s: 0.0 })
            .rgb
    }

    /// One step on; the colour picture is changed, and is taken `late_ms` after the depth picture.
    fn drive(
        &mut self,
        late_ms: u64,
        change: impl FnOnce(Stamp, Vec<u8>) -> FrameEvent<Vec<u8>>,
    ) -> Attended {
        self.step += 1;
        let stamp = at(self.step);
        let colour_at = Stamp::from_micros(stamp.as_micros() + 1_000 * late_ms);
        let mut fake = Fake {
            depth: vec![FrameEvent::Picture(stamp, self.depth())],
            colour: vec![change(colour_at, self.colour())],
        };
        let attended = self.watcher.attend(&mut fake, self.pose(), || colour_at);
        self.words.extend(attended.words.iter().cloned());
        attended
    }

    fn spots(&self) -> Vec<Point2> {
        let seen = self.watcher.seen(at(self.step)).expect("a colour camera");
        seen.spots.spots.iter().map(|spot| spot.centre_in_map).collect()
    }

    fn seen_m2(&self) -> f32 {
        self.watcher.seen(at(self.step)).expect("a colour camera").seen_m2
    }
}

/// Good pictures of both streams, a few milliseconds apart: dirt is where it was spilled, and nothing is
/// logged.
#[test]
fn dirt_is_mapped_live() {
    let mut drive = Drive::new();
    for _ in 0..14 {
        let attended = drive.drive(12, FrameEvent::Picture);
        assert!(attended.sight.is_some_and(|sight| sight.is_known));
    }
    let spots = drive.spots();
    assert!(spots.iter().any(|spot| spot.distance(SPILLED) < 0.08), "{spots:?}");
    assert_eq!(drive.words, Vec::<String>::new());
}

/// Every picture is an observation of its own: once the spill is gone two pictures are enough for nobody to call the place
/// dirty any more. Scores carried over from earlier pictures would agree with those for many more.
#[test]
fn earlier_pictures_do_not_validate_later_ones() {
    let mut drive = Drive::new();
    for _ in 0..8 {
        drive.drive(12, FrameEvent::Picture);
    }
    assert!(drive.spots().iter().any(|spot| spot.distance(SPILLED) < 0.1), "{:?}", drive.spots());
    drive.scene.spills.clear();
    for _ in 0..2 {
        drive.drive(12, FrameEvent::Picture);
    }
    assert_eq!(drive.spots(), [], "it is gone");
}

/// Each of these failures of the colour stream leaves the floor unknown, and is reported once; the floor's shape is
/// still known.
#[test]
fn bad_colour_is_unknown_and_reported_once() {
    type Change = fn(Stamp, Vec<u8>) -> FrameEvent<Vec<u8>>;
    let cases: [(&str, u64, Change); 7] = [
        ("at the same time", 26, FrameEvent::Picture),
        ("not 320 × 240", 0, |_, _| {
            FrameEvent::Damaged(WrongFrame::OtherSize { found: SMALL, wanted: SIZE })
        }),
        ("unplugged", 0, |_, _| FrameEvent::Silent("unplugged".to_owned())),
        ("no picture", 0, |stamp, mut rgb| {
            rgb.truncate(99);
            FrameEvent::Picture(stamp, rgb)
        }),
        ("black or overexposed", 0, |stamp, rgb| {
            FrameEvent::Picture(stamp, rgb.iter().map(|value| value % 9).collect())
        }),
        ("blinded camera", 0, |stamp, rgb| {
            FrameEvent::Picture(stamp, rgb.iter().map(|value| 254 + value % 2).collect())
        }),
        ("frozen", 0, |stamp, rgb| FrameEvent::Picture(stamp, vec![90; rgb.len()])),
    ];
    for (part, late_ms, change) in cases {
        let mut drive = Drive::new();
        let frames = if late_ms > 0 { 32 } else { 9 };
        for _ in 0..frames {
            let attended = drive.drive(late_ms, change);
            assert!(attended.sight.is_some_and(|sight| sight.is_known), "{part}");
        }
        let reported: Vec<&String> = drive.words.iter().filter(|word| word.starts_with("colour")).collect();
        assert!(reported.iter().filter(|word| word.contains(part)).count() == 1, "{part}: {reported:?}");
        assert!(reported.iter().all(|word| word.contains("unknown, not clean")), "{reported:?}");
        assert_eq!((drive.seen_m2(), drive.spots().len()), (0.0, 0), "{part}");
        let (_, unknown) = drive.watcher.seen(at(drive.step)).expect("a colour camera").frames;
        assert!(unknown > 0, "{part}: it is counted");
    }
}

/// Without a depth picture nobody knows where a colour picture's pixels lie; when both are back, it is reported
/// once.
#[test]
fn failed_depth_blinds_both_until_recovery() {
    depth_fails(|| FrameEvent::Silent("unplugged".to_owned()), "unplugged");
    depth_fails(
        || FrameEvent::Damaged(WrongFrame::OtherSize { found: SMALL, wanted: SIZE }),
        "not 320 × 240",
    );
}

fn depth_fails(event: impl Fn() -> FrameEvent<Vec<u16>>, why: &str) {
    let mut drive = Drive::new();
    for _ in 0..3 {
        drive.step += 1;
        let mut fake =
            Fake { depth: vec![event()], colour: vec![FrameEvent::Picture(at(drive.step), drive.colour())] };
        let attended = drive.watcher.attend(&mut fake, drive.pose(), || at(drive.step));
        assert!(attended.sight.is_some_and(|sight| !sight.is_known) && attended.people.is_none());
        drive.words.extend(attended.words);
    }
    let reported = drive.words.join("; ");
    assert!(
        drive.words.len() == 1 && reported.starts_with("depth: ") && reported.contains(why),
        "{reported}"
    );
    assert!(reported.ends_with("; the floor is unknown"), "{reported}");
    assert_eq!(drive.seen_m2(), 0.0);
    drive.words.clear();
    for _ in 0..14 {
        drive.drive(0, FrameEvent::Picture);
    }
    assert_eq!(drive.words, ["depth: the floor is known again"]);
    assert!(drive.seen_m2() > 0.5, "{}", drive.seen_m2());
}

/// A picture that comes half a second after it was taken says nothing about now.
#[test]
fn stale_colour_is_unknown_floor() {
    let mut drive = Drive::new();
    for _ in 0..5 {
        drive.step += 1;
        let stamp = at(drive.step);
        let mut fake = Fake {
            depth: vec![FrameEvent::Picture(stamp, drive.depth())],
            colour: vec![FrameEvent::Picture(stamp, drive.colour())],
        };
        let late = || Stamp::from_micros(stamp.as_micros() + 500_001);
        let attended = drive.watcher.attend(&mut fake, drive.pose(), late);
        drive.words.extend(attended.words);
    }
    assert!(drive.words.iter().any(|word| word.contains("500 ms late")), "{:?}", drive.words);
    assert_eq!(drive.seen_m2(), 0.0);
}
