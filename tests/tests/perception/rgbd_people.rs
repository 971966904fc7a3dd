//! People in depth pictures: simulated rooms, real frames without anybody, holes, and the command.

use std::path::Path;

use floorguard_laboratory::evaluate::{RgbdTask, rgbd_people};
use floorguard_perception::floor::Plane;
use floorguard_perception::rgbd_people::{RgbdDetection, RgbdKind, RgbdParameters, RgbdPeopleFinder};
use floorguard_sim::people::{Build, Person, PersonKind};
use floorguard_sim::scene::{Material, SceneBuilder};
use floorguard_sim::sensors::{DepthCamera, DepthPicture};
use floorguard_tests::data::recording;
use floorguard_tests::rgbd::{pinhole, run_rooms};
use floorguard_types::geometry::{Point2, Pose2};
use floorguard_types::sensing::{DepthImage, ImageSize};
use floorguard_types::time::Stamp;

/// Measured over 400 rooms of these seeds: 0.83, 0.93; legs 0.93, 0.90.
#[test]
fn people_are_found_in_simulated_rooms() {
    let figures = run_rooms(0, 150, DepthCamera::FORWARD_SMALL);
    let ([precision, recall], [leg_precision, leg_recall]) = (figures.upper_bodies(), figures.legs());
    assert!(precision > 0.78 && recall > 0.88, "{precision} {recall}");
    assert!(leg_precision > 0.8 && leg_recall > 0.82, "{leg_precision} {leg_recall}");
    let [error_m, normalised] = figures.position();
    assert!(error_m < 0.08 && normalised < 2.0, "{error_m} {normalised}");
}

const CAMERA: DepthCamera = DepthCamera { forward_m: 0.0, ..DepthCamera::FORWARD_SMALL };

fn picture(people: &[(f32, f32)], wall_m: f32) -> DepthPicture {
    let mut builder = SceneBuilder::default();
    builder.wall([wall_m, -9.0], [wall_m, 9.0], 3.0, Material::Matte);
    let people: Vec<Person> = people
        .iter()
        .zip(1..)
        .map(|((x_m, y_m), id)| Person {
            id,
            kind: PersonKind::Adult,
            build: Build::SAME,
            position: Point2::new(*x_m, *y_m),
            velocity: Point2::new(0.0, 0.0),
            heading_rad: 0.3,
            gait_rad: 0.0,
            goals: Vec::new(),
            goal: 0,
            speed_mps: 0.0,
            starts_us: 0,
            sees_robot: false,
            walk: None,
        })
        .collect();
    CAMERA.picture(&builder.build(), &people, Pose2::default(), 5)
}

fn find(picture: &DepthPicture) -> Vec<RgbdDetection> {
    let image = DepthImage::new(Stamp::ZERO, picture.size, &picture.depth_mm).unwrap();
    let plane = Plane::of_mounting(CAMERA.height_m, CAMERA.pitch_rad).unwrap();
    let mut finder = Box::new(RgbdPeopleFinder::new(RgbdParameters::new(pinhole(&CAMERA))));
    finder.find_people((&image, None), &plane, Pose2::default()).unwrap().people.to_vec()
}

fn is_at(found: &[RgbdDetection], x_m: f32, y_m: f32) -> bool {
    found.iter().any(|one| one.position_in_base.distance(Point2::new(x_m, y_m)) < 0.25)
}

/// Beside each other, one behind the other, and before the wall: nobody swallows anybody.
#[test]
fn two_people_and_a_wall_are_two_people() {
    for wall_m in [4.6, 12.0] {
        let found = find(&picture(&[(3.2, 0.45), (4.2, -0.4)], wall_m));
        assert!(is_at(&found, 3.2, 0.45) && is_at(&found, 4.2, -0.4) && found.len() == 2, "{found:#?}");
    }
}

/// A wall alone, an empty hall: nobody. A picture without depth: nobody, and the account says that nothing was seen.
#[test]
fn empty_scenes_have_no_people() {
    assert_eq!(find(&picture(&[], 4.0)), []);
    let mut blind = picture(&[(3.0, 0.0)], 5.0);
    blind.depth_mm.fill(0);
    assert_eq!(find(&blind), []);
}

/// Depth that is missing speaks neither for nor against a person: with a third of all pixels gone, and with everything
/// around the body gone, the person is still there.
#[test]
fn missing_depth_does_not_make_a_person_disappear() {
    let whole = picture(&[(3.0, 0.2)], 5.0);
    let mut thinned = whole.clone();
    for (index, depth) in thinned.depth_mm.iter_mut().enumerate() {
        if (index * 7_919) % 10 < 3 {
            *depth = 0;
        }
    }
    let mut alone = whole.clone();
    for (depth, person) in alone.depth_mm.iter_mut().zip(&whole.person) {
        if *person == 0 {
            *depth = 0;
        }
    }
    for (name, picture) in [("whole", whole), ("thinned", thinned), ("alone", alone)] {
        let found = find(&picture);
        assert!(is_at(&found, 3.0, 0.2), "{name}: {found:#?}");
    }
}

/// At 1.3 m the head is out of view: legs alone.
#[test]
fn near_person_is_found_by_the_legs() {
    let found = find(&picture(&[(1.4, 0.0)], 5.0));
    assert!(is_at(&found, 1.4, 0.0), "{found:#?}");
    assert!(found.iter().all(|one| one.kind == RgbdKind::Legs), "{found:#?}");
}

/// The frames show an office desk and a corridor with doors and cabinets, and nobody.
#[test]
fn empty_real_frames_have_one_detection_at_most() {
    for (name, most) in [("tum", 0), ("sun", 1)] {
        let Some(depth) = recording(&format!("rgbd_floor/{name}_depth_mm.png")) else { return };
        let Some(colour) = recording(&format!("rgbd_floor/{name}_color.jpg")) else { return };
        let task = RgbdTask {
            depths: vec![depth],
            colours: vec![colour],
            intrinsics: [525.0, 525.0, 319.5, 239.5],
            mounting: None,
            key: None,
            out: None,
        };
        let report = rgbd_people(&task).unwrap();
        assert!(report.found <= most, "{name}: {report:#?}");
        assert!(report.pictures[0].people.iter().all(|person| person.confidence < 0.7), "{report:#?}");
        let account = report.pictures[0].account.0;
        assert!(account.returns > 50_000 && account.heads > 0);
    }
}

fn write_depth(path: &Path, picture: &DepthPicture) {
    let ImageSize { width, height } = picture.size;
    let image: image::ImageBuffer<image::Luma<u16>, Vec<u16>> =
        image::ImageBuffer::from_raw(width as u32, height as u32, picture.depth_mm.clone()).unwrap();
    image.save(path).unwrap();
}

/// Files in, figures out; what does not fit is refused with its name.
#[test]
fn the_command_reads_pictures_and_a_key() {
    let folder = tempfile::tempdir().unwrap();
    let depth = folder.path().join("one.png");
    write_depth(&depth, &picture(&[(3.0, 0.5), (4.0, -0.6)], 6.0));
    let key = folder.path().join("key.csv");
    std::fs::write(&key, "x,file,y\n3.0,one.png,0.5\n4.0,one.png,-0.6\n").unwrap();
    let centre = [79.5, 59.5];
    let mut task = RgbdTask {
        depths: vec![depth.clone()],
        colours: Vec::new(),
        intrinsics: [131.25, 131.25, centre[0], centre[1]],
        mounting: Some([CAMERA.height_m, CAMERA.pitch_rad]),
        key: Some(key.clone()),
        out: Some(folder.path().join("out")),
    };
    let report = rgbd_people(&task).unwrap();
    assert_eq!((report.precision, report.recall), (Some(1.0), Some(1.0)), "{report:#?}");
    assert!(folder.path().join("out/one_people.png").exists());
    task.colours = vec![depth.clone(), depth];
    assert!(rgbd_people(&task).unwrap_err().to_string().contains("2 colour pictures"));
    task.colours.clear();
    std::fs::write(&key, "file,x\none.png,3.0\n").unwrap();
    assert!(rgbd_people(&task).unwrap_err().to_string().contains("`file`, `x` and `y`"));
}
