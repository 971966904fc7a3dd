//! A camera that is a folder of pictures.

use super::*;

/// Recorded pictures as the camera: dirt is mapped at the places given by the poses, a broken picture is reported by
/// its name, so is the end of the pictures, and the map is in the recording.
#[test]
fn a_folder_of_pictures_is_a_camera() {
    let folder = tempfile::tempdir().unwrap();
    let port = UdpSocket::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let file = robot_file(folder.path(), port);
    let robot = std::fs::read_to_string(&file).unwrap();
    render(&folder.path().join("frames"));
    let section = std::fs::read_to_string(folder.path().join("frames/camera.toml")).unwrap();
    let run = |section: &str| {
        std::fs::write(&file, format!("{robot}\n{section}")).unwrap();
        let record = folder.path().join("run.mcap");
        let output = Command::new(env!("CARGO_BIN_EXE_floorguard"))
            .args(["run", &file, "--duration", "4.5", "--json", "--record"])
            .arg(&record)
            .output()
            .unwrap();
        let stdout_text = String::from_utf8(output.stdout).unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap(), stdout_text)
    };
    let (code, stderr_text, stdout_text) = run(&section);
    assert_eq!(code, Some(0), "{stderr_text}");
    assert!(
        stderr_text.contains("1.400000.png") && stderr_text.contains("the floor is unknown"),
        "{stderr_text}"
    );
    assert!(stderr_text.contains("all 15 pictures were shown"), "{stderr_text}");
    let dirt =
        stdout_text.lines().rev().find(|line| line.contains("\"type\":\"dirt\"")).expect("a map of dirt");
    let dirt: serde_json::Value = serde_json::from_str(dirt).unwrap();
    let spots = dirt["spots"].as_array().unwrap();
    let is_near = |spot: &serde_json::Value| {
        let off = |key: &str, at: f64| spot[key].as_f64().unwrap() - at;
        off("x_m", f64::from(SPILLED.x_m)).hypot(off("y_m", f64::from(SPILLED.y_m))) < 0.08
    };
    assert!(spots.iter().any(is_near), "{dirt}");
    assert!(dirt["seen_m2"].as_f64().unwrap() > 1.0 && dirt["frames"].as_u64().unwrap() >= 12, "{dirt}");
    let record = std::fs::File::open(folder.path().join("run.mcap")).unwrap();
    let messages: Vec<_> = Recording::new(record).collect::<Result<_, _>>().unwrap();
    assert!(messages.iter().any(|message| &*message.topic == topics::SEEN_DIRT));
    for (from, to, why) in [
        ("frames\"", "nowhere\"", "nowhere"),
        ("frames\"", "frames/rgb\"", "no depth pictures"),
        ("[camera]", "[camera]\nrate_hz = 900.0", "rate_hz"),
    ] {
        let (code, stderr_text, _) = run(&section.replace(from, to));
        assert!(code == Some(3) && stderr_text.contains(why), "{stderr_text}");
    }
}

const SPILLED: Point2 = Point2 { x_m: 2.4, y_m: 0.1 };

/// Pictures of a drive towards a spill on vinyl, 12 cm and 200 ms apart, one of them cut off.
fn render(root: &std::path::Path) {
    let rendered = FloorCamera {
        size: ImageSize { width: 320, height: 240 },
        focal_px: 262.5,
        forward_m: 0.9,
        ..FloorCamera::default()
    };
    let mounting = FloorMounting {
        height_m: rendered.height_m,
        forward_m: rendered.forward_m,
        pitch_rad: rendered.pitch_rad,
    };
    let camera = PictureCamera { size: rendered.size, focal_px: rendered.focal_px, mounting };
    let mut pictures = PictureFolder::new(root, camera).unwrap();
    let mut scene = FloorScene::new(FloorKind::Vinyl, 4.0, 7);
    let coffee = Spill::random(DirtKind::Liquid, SPILLED, &mut Pcg32::new(7, 7));
    scene.spills.push(Spill { radii_m: [0.1; 2], strength: 1.0, ..coffee });
    let plane = Plane::of_mounting(rendered.height_m, rendered.pitch_rad).unwrap();
    let pinhole = PinholeCamera::new([rendered.focal_px; 2], [159.5, 119.5]).unwrap();
    for step in 0..15_u32 {
        let robot = Pose2::new(0.12 * step as f32, 0.0, 0.0);
        let depth = |index: u32| {
            let ray = pinhole.ray((index % 320) as f32, (index / 320) as f32);
            let down: f32 = plane.normal.iter().zip(ray).map(|(n, r)| -n * r).sum();
            let depth_mm = if down < 0.05 { 0.0 } else { 1_000.0 * plane.distance_m / down };
            depth_mm as u16 + ((index * 7 + step * 13) % 3) as u16
        };
        let depth_mm: Vec<u16> = (0..320 * 240).map(depth).collect();
        let stamp = Stamp::from_micros(u64::from(step) * 200_000);
        let picture = scene.picture(&rendered, robot, PictureMoment { frame: step, at_s: 0.0 });
        let depth = DepthPicture { depth_mm: &depth_mm, size: rendered.size };
        pictures.add((stamp, robot), depth, &picture.rgb).unwrap();
    }
    pictures.finish().unwrap();
    let broken = root.join("depth/1.400000.png");
    let whole = std::fs::read(&broken).unwrap();
    std::fs::write(broken, &whole[..whole.len() / 2]).unwrap();
}
