//! What `floorguard check` calls seen, judged by rays that are cast at the simulator's scenes through parry: beam angles of the data
//! sheets, rotations by parry, nothing of the guard and nothing of the coverage.

use floorguard_configuration::{BAR_M, Coverage, EXAMPLE, HEIGHTS_M, parse};
use floorguard_runtime::configuration::{Mounting, RobotConfiguration};
use floorguard_sim::scene::{Material, Scene, SceneBuilder};
use floorguard_types::geometry::Point2;
use floorguard_types::random::Pcg32;
use parry3d::math::{Rotation, Vector};

const CAMERA: &str = "\n[camera]\nsource = \"v4l2:/dev/video2\"\nwidth = 640\nheight = 480\nfx = 525.0\nfy = 525.0\ncx = 319.5\n\
                      cy = 239.5\nmounting = { x_m = 0.9, y_m = 0.0, z_m = 0.72, pitch_deg = 48.0 }\n";
const LIDAR: &str = "x_m = 0.50, y_m = 0.0, z_m = 0.80, roll_deg = 0.0, pitch_deg = 0.0, yaw_deg = 0.0";
const SCANNER: &str = "x_m = 0.90, y_m = 0.0, z_m = 0.15, roll_deg = 0.0, pitch_deg = 0.0, yaw_deg = 0.0";
const CORNER: &str = "x_m = 0.93, y_m = 0.38, z_m = 0.15, roll_deg = 0.0, pitch_deg = 0.0, yaw_deg = 45.0";
const REAR_SCANNER: &str = "\n[rear_scanner]\nmodel = \"s300\"\nsource = \"serial:/dev/ttyUSB3\"\nbaud = 500000\n\
                            mounting = { x_m = -0.43, y_m = -0.38, z_m = 0.15, yaw_deg = -135.0 }\n";
/// Higher than this above the floor a beam has met the object, metres.
const MET_M: f32 = 0.002;
/// A beam on lower objects may be taken for one on the floor, metres.
const CLEARANCE_M: f32 = 0.08;

/// A beam in the robot frame, and between which ranges it measures.
struct Beam {
    origin: Vector,
    direction: Vector,
    range_m: [f32; 2],
    is_lidar: bool,
}

fn beams_of(
    mounting: &Mounting,
    directions: impl Iterator<Item = Vector>,
    range_m: [f32; 2],
    is_lidar: bool,
) -> Vec<Beam> {
    let turn = Rotation::from_rotation_z(mounting.yaw_rad)
        * Rotation::from_rotation_y(mounting.pitch_rad)
        * Rotation::from_rotation_x(mounting.roll_rad);
    let origin = Vector::new(mounting.position.x_m, mounting.position.y_m, mounting.position.z_m);
    directions.map(|direction| Beam { origin, direction: turn * direction, range_m, is_lidar }).collect()
}

fn direction(azimuth_deg: f32, elevation_deg: f32) -> Vector {
    let (sin, cos) = azimuth_deg.to_radians().sin_cos();
    let (up, level) = elevation_deg.to_radians().sin_cos();
    Vector::new(level * cos, level * sin, up)
}

/// S300: 541 beams from −135° to 135°. VLP-16: sixteen rings from −15° to 15°, 0.2° apart at 600 rpm.
fn beams(robot: &RobotConfiguration, camera: Option<Mounting>) -> Vec<Beam> {
    let mut all = Vec::new();
    for scanner in [robot.scanner].into_iter().chain(robot.rear_scanner) {
        let [first, last] = scanner.sector_rad.map(f32::to_degrees);
        let plane = (0..541).map(|beam| beam as f32 * 0.5 - 135.0).filter(|deg| (first..=last).contains(deg));
        all.extend(beams_of(&scanner.mounting, plane.map(|deg| direction(deg, 0.0)), [0.0, 30.0], false));
    }
    let rings = (0..16).map(|ring| ring as f32 * 2.0 - 15.0);
    let lidar = rings.flat_map(|deg| (0..1_800).map(move |step| direction(step as f32 * 0.2, deg)));
    all.extend(beams_of(&robot.lidar.mounting, lidar, [0.45, 100.0], true));
    if let Some(mounting) = camera {
        let pixels = (0..240).flat_map(|row| (0..320).map(move |column| (row, column)));
        let rays = pixels.map(|(row, column)| {
            Vector::new(1.0, (159.5 - column as f32) / 262.5, (119.5 - row as f32) / 262.5).normalize()
        });
        all.extend(beams_of(&mounting, rays, [0.4, 8.0], false));
    }
    all
}

fn scene(at: Point2, side_m: f32, z_m: [f32; 2]) -> Scene {
    let mut builder = SceneBuilder::default();
    builder.cuboid((at.x_m, at.y_m, 0.0), (side_m, side_m), (z_m[0], z_m[1]), Material::Matte);
    builder.build()
}

/// Some beam ends on the object, above a height.
fn is_met(beams: &[Beam], scene: &Scene, at: Point2, above_m: f32) -> bool {
    beams.iter().any(|beam| {
        let (dx, dy) = (at.x_m - beam.origin.x, at.y_m - beam.origin.y);
        let aside = (beam.direction.x * dy - beam.direction.y * dx).abs();
        let plane = beam.direction.x.hypot(beam.direction.y);
        let is_towards = beam.direction.x * dx + beam.direction.y * dy > 0.0 && aside < 0.08 * plane;
        is_towards
            && scene.cast(beam.origin, beam.direction, beam.range_m[1]).is_some_and(|hit| {
                let z = beam.origin.z + beam.direction.z * hit.range_m;
                let lowest = if beam.is_lidar { above_m.max(MET_M) } else { MET_M };
                hit.range_m >= beam.range_m[0] && z > lowest
            })
    })
}

/// How many objects and bars were called seen, and how many unseen.
#[derive(Debug, Default)]
struct Compared {
    seen: usize,
    unseen: usize,
    bars: usize,
}

fn compare(text: &str, seed: u64) -> Compared {
    let configuration = parse("robot.toml", text).unwrap_or_else(|refused| panic!("{refused}"));
    let camera = configuration.carriers.camera.as_ref();
    let coverage = Coverage::of(&configuration.robot, camera);
    let beams = beams(&configuration.robot, camera.map(|camera| camera.mounting));
    let (mut random, mut compared) = (Pcg32::new(seed, 1), Compared::default());
    for _ in 0..60 {
        let (at, _) = coverage.places[random.below(coverage.places.len() as u32) as usize];
        let height_m = HEIGHTS_M[random.below(HEIGHTS_M.len() as u32) as usize];
        let sight = coverage.sight(at);
        if sight.upright_from_m <= height_m {
            compared.seen += 1;
            assert!(
                is_met(&beams, &scene(at, 0.10, [0.0, height_m]), at, 0.0),
                "{at:?}, {height_m} m is not met"
            );
        } else if camera.is_none()
            && sight.upright_from_m > height_m + 0.02
            && is_far_from_lidar(&configuration.robot, at)
        {
            compared.unseen += 1;
            let thin = scene(at, 0.01, [0.0, height_m]);
            assert!(!is_met(&beams, &thin, at, CLEARANCE_M + 0.01), "{at:?}, {height_m} m is met");
        }
        let low_m = 0.10 + 0.02 * random.below(64) as f32;
        if sight.meets_bar(low_m) {
            compared.bars += 1;
            let bar = scene(at, 0.10, [low_m, low_m + BAR_M]);
            assert!(is_met(&beams, &bar, at, 0.0), "{at:?}, a bar at {low_m} m is not met");
        }
    }
    compared
}

/// Near the lidar its least range differs by model.
fn is_far_from_lidar(robot: &RobotConfiguration, at: Point2) -> bool {
    let lidar = robot.lidar.mounting.position;
    Point2::new(lidar.x_m, lidar.y_m).distance(at) > 0.65
}

#[test]
fn seen_places_are_met_by_rays() {
    let mountings = [
        EXAMPLE.to_owned(),
        EXAMPLE.replace(
            LIDAR,
            "x_m = 0.20, y_m = 0.10, z_m = 1.10, roll_deg = 4.0, pitch_deg = 12.0, yaw_deg = 30.0",
        ),
        EXAMPLE.replace(
            LIDAR,
            "x_m = -0.40, y_m = 0.0, z_m = 0.30, roll_deg = 0.0, pitch_deg = -3.0, yaw_deg = 180.0",
        ),
        EXAMPLE.replace(
            SCANNER,
            "x_m = 0.95, y_m = 0.40, z_m = 0.10, roll_deg = 0.0, pitch_deg = 0.0, yaw_deg = 45.0",
        ),
        EXAMPLE.replace(
            SCANNER,
            "x_m = 0.90, y_m = 0.0, z_m = 0.18, roll_deg = 0.0, pitch_deg = 1.0, yaw_deg = 180.0",
        ),
        EXAMPLE
            .replace(SCANNER, &format!("{SCANNER} }}\nsector_first_deg = -10.0\nsector_last_deg = 10.0\n#")),
        format!("{EXAMPLE}{CAMERA}"),
        format!("{}{REAR_SCANNER}", EXAMPLE.replace(SCANNER, CORNER)),
    ];
    let mut all = Compared::default();
    for (seed, text) in (1..).zip(&mountings) {
        let compared = compare(text, seed);
        assert!(compared.seen > 5, "mounting {seed}: {compared:?}");
        all = Compared {
            seen: all.seen + compared.seen,
            unseen: all.unseen + compared.unseen,
            bars: all.bars + compared.bars,
        };
    }
    assert!(all.seen > 150 && all.unseen > 40 && all.bars > 20, "{all:?}");
}
