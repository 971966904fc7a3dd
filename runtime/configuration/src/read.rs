//! The meaning of every key of `robot.toml`.
//!
//! Nothing starts half-configured: all mistakes are collected and any one refuses the whole file.

use std::path::Path;

use floorguard_core::capacities::FIELD_SETS_MAX;
use floorguard_core::geometry::{Point2, Point3};
use floorguard_core::guard::Thresholds;
use floorguard_core::sensing::PinholeCamera;
use floorguard_core::units::radians;
use floorguard_drivers::flexisoft::{InputBits, InputMap};
use floorguard_runtime::configuration::{
    CanConfiguration, Deadlines, DirectionOfTravel, FieldPair, Geometry, ImuConfiguration,
    LidarConfiguration, LidarModel, Limits, Mounting, Polygon, RobotConfiguration, ScannerConfiguration,
    ScannerModel,
};
use floorguard_runtime::mission::{ROUTE_WAYPOINTS_MAX, Route, RouteLimits};
use toml::de::DeTable;

use super::address::{CanAddress, DatagramAddress, ScannerAddress, SerialAddress, parse_serial};
use super::camera::{CameraConfiguration, parse_video};
use super::mission::{MissionConfiguration, read_mission};
use super::polygon;
use super::problem::{Problem, Refused};
use super::reader::{Problems, Reader};

/// Beams of the finest output of the microScan3 family (wire-formats 3.3); what there is room for is the guard's to say.
const MICROSCAN3_BEAMS: u16 = 2_751;
/// Scanner response, two scans of 40 ms (algorithms M.1).
const SCANNER_RESPONSE_S: f32 = 0.08;
/// General tolerance of the scanner, metres (algorithms M.1, Z_G).
const SCANNER_TOLERANCE_M: f32 = 0.10;
/// Reserve for brake wear, share of the braking distance (algorithms M.1, Z_B).
const BRAKE_WEAR: f32 = 0.10;

/// The addresses of the carriers.
#[derive(Clone, Debug, PartialEq)]
pub struct Carriers {
    /// Lidar.
    pub lidar: DatagramAddress,
    /// Safety scanner.
    pub scanner: ScannerAddress,
    /// Inertial measurement unit.
    pub imu: Option<SerialAddress>,
    /// CAN bus.
    pub can: CanAddress,
    /// Floor camera.
    pub camera: Option<CameraConfiguration>,
}

/// A complete, checked configuration.
#[derive(Clone, Debug)]
pub struct HostedConfiguration {
    /// What the robot is.
    pub robot: RobotConfiguration,
    /// Where its bytes come from.
    pub carriers: Carriers,
    /// What it cleans; without a mission it drives its route.
    pub mission: Option<MissionConfiguration>,
}

/// Reads and checks a file.
///
/// # Errors
/// The file cannot be read, or [`Refused`].
pub fn load(path: &Path) -> anyhow::Result<HostedConfiguration> {
    let text = std::fs::read_to_string(path).map_err(|error| {
        anyhow::anyhow!("{}: cannot be read ({error}); give the path of a robot.toml", path.display())
    })?;
    Ok(parse(&path.display().to_string(), &text)?)
}

/// Checks a text; `file` is the name for messages.
///
/// # Errors
/// Every mistake with its line.
pub fn parse(file: &str, text: &str) -> Result<HostedConfiguration, Refused> {
    let document = DeTable::parse(text).map_err(|error| {
        let offset = error.span().map_or(0, |span| span.start);
        let what = format!("not TOML: {}", error.message().lines().next().unwrap_or_default());
        Refused::new(file, text, vec![Problem { offset, what, remedy: "correct the syntax".to_owned() }])
    })?;
    let problems = Problems::default();
    let top = Reader::new(document.get_ref(), "", 0..0, &problems);
    let configuration = read_top(top);
    let problems = problems.into_inner();
    match configuration {
        Some(configuration) if problems.is_empty() => Ok(configuration),
        _ => Err(Refused::new(file, text, problems)),
    }
}

fn read_top(top: Reader<'_>) -> Option<HostedConfiguration> {
    let geometry = read_geometry(top.section("robot"));
    let limits = read_limits(top.section("limits"));
    let deadlines = read_deadlines(top.section("deadlines"));
    let lidar = read_lidar(top.section("lidar"));
    let scanner = read_scanner(top.section("scanner"));
    let imu = top.optional_section("imu").map(read_imu);
    let can = read_can(top.section("can"));
    let camera = top.optional_section("camera").map(read_camera);
    let inputs = read_inputs(top.section("inputs"));
    let thresholds = top.optional_section("guard").map_or_else(Thresholds::default, read_thresholds);
    let fields = read_fields(&top, &geometry, &limits);
    let (route, route_limits) =
        top.optional_section("route").map_or_else(Default::default, |section| read_route(section, &limits));
    let mission = top.optional_section("mission").and_then(read_mission);
    top.finish();
    let (lidar, lidar_address) = lidar?;
    let (scanner, scanner_address) = scanner?;
    let (can, can_address) = can?;
    let can = CanConfiguration { inputs: inputs?, ..can };
    let (imu, imu_address) = match imu {
        Some(read) => read.map(|(imu, address)| (Some(imu), Some(address)))?,
        None => (None, None),
    };
    Some(HostedConfiguration {
        robot: RobotConfiguration {
            geometry: geometry?,
            limits,
            deadlines,
            lidar,
            scanner,
            imu,
            can,
            fields,
            route,
            route_limits,
            thresholds,
        },
        carriers: Carriers {
            lidar: lidar_address,
            scanner: scanner_address,
            imu: imu_address,
            can: can_address,
            camera: camera.flatten(),
        },
        mission,
    })
}

fn read_geometry(section: Reader<'_>) -> Option<Geometry> {
    let footprint = read_polygon(&section, "footprint_m");
    let geometry = Geometry {
        footprint: footprint.unwrap_or_default(),
        wheelbase_m: section.number("wheelbase_m", 0.2..=3.0),
        track_m: section.number("track_m", 0.2..=2.0),
        ticks_per_m: section.number("ticks_per_m", 100.0..=1.0e6),
    };
    section.finish();
    (!geometry.footprint.is_empty()).then_some(geometry)
}

fn read_limits(section: Reader<'_>) -> Limits {
    let limits = Limits {
        speed_mps: section.number("speed_mps", 0.05..=2.0),
        reverse_mps: section.number("reverse_mps", 0.0..=0.5),
        turn_radps: section.number("turn_radps", 0.05..=2.0),
        acceleration_mps2: section.number("acceleration_mps2", 0.05..=2.0),
        braking_mps2: section.number("braking_mps2", 0.1..=5.0),
        response_s: section.number("response_s", 0.0..=1.0),
    };
    section.finish();
    limits
}

fn read_deadlines(section: Reader<'_>) -> Deadlines {
    // Microseconds are exact for every value that passes the range check.
    let micros = |key, longest_s| (section.number(key, 0.02..=longest_s) * 1.0e6) as u64;
    let deadlines = Deadlines {
        scanner_us: micros("scanner_s", 0.3),
        lidar_us: micros("lidar_s", 0.5),
        odometry_us: micros("odometry_s", 0.2),
        command_us: micros("command_s", 0.5),
    };
    section.finish();
    deadlines
}

fn read_mounting(section: Reader<'_>) -> Mounting {
    let mounting = Mounting {
        position: Point3::new(
            section.number("x_m", -2.0..=3.0),
            section.number("y_m", -1.5..=1.5),
            section.number("z_m", 0.02..=3.0),
        ),
        roll_rad: radians(section.number_or("roll_deg", -180.0..=180.0, 0.0)),
        pitch_rad: radians(section.number_or("pitch_deg", -90.0..=90.0, 0.0)),
        yaw_rad: radians(section.number_or("yaw_deg", -180.0..=180.0, 0.0)),
    };
    section.finish();
    mounting
}

fn read_lidar(section: Reader<'_>) -> Option<(LidarConfiguration, DatagramAddress)> {
    let models = [
        ("vlp16", LidarModel::Vlp16),
        ("auto", LidarModel::Auto),
        ("puck-hi-res", LidarModel::PuckHiRes),
        ("vlp32c", LidarModel::Vlp32c),
        ("hdl32e", LidarModel::Hdl32e),
    ];
    let model = section.choice("model", &models);
    let source = read_source(&section, "udp:0.0.0.0:2368", DatagramAddress::parse);
    let mounting = read_mounting(section.section("mounting"));
    section.finish();
    Some((LidarConfiguration { model: model?, mounting }, source?))
}

fn read_scanner(section: Reader<'_>) -> Option<(ScannerConfiguration, ScannerAddress)> {
    let (model, source) = read_scanner_device(&section);
    let mounting = read_mounting(section.section("mounting"));
    if mounting.position.z_m > 0.2 {
        section.refuse(
            section.span(),
            format!("[scanner]: the scan plane is {} m high, allowed is up to 0.2 m", mounting.position.z_m),
            "mount the scanner lower: feet and children must cross the plane",
        );
    }
    let sector_rad = [
        radians(section.number_or("sector_first_deg", -135.0..=0.0, -135.0)),
        radians(section.number_or("sector_last_deg", 0.0..=135.0, 135.0)),
    ];
    section.finish();
    Some((ScannerConfiguration { model: model?, mounting, sector_rad }, source?))
}

/// The model, and what it is connected to: an S300 has a line, a microScan3 sends datagrams and says how many beams.
fn read_scanner_device(section: &Reader<'_>) -> (Option<ScannerModel>, Option<ScannerAddress>) {
    let finest = ScannerModel::MicroScan3 { beams: MICROSCAN3_BEAMS };
    let model = section.choice("model", &[("s300", ScannerModel::S300), ("microscan3", finest)]);
    let beams =
        section.integer_or("beams", 276..=i64::from(MICROSCAN3_BEAMS), i64::from(MICROSCAN3_BEAMS)) as u16;
    if let Some(ScannerModel::MicroScan3 { .. }) = model {
        let model = ScannerModel::MicroScan3 { beams };
        let source = read_source(section, "udp:0.0.0.0:6060", DatagramAddress::parse);
        return (Some(model), source.map(ScannerAddress::Datagrams));
    }
    if section.find("beams").is_some() {
        section.refuse(
            section.span(),
            "[scanner]: `beams` is given, and an S300 always sends 541",
            "leave `beams` out, or write model = \"microscan3\"",
        );
    }
    (model, read_serial(section).map(ScannerAddress::Serial))
}

fn read_imu(section: Reader<'_>) -> Option<(ImuConfiguration, SerialAddress)> {
    let source = read_serial(&section);
    let mounting = read_mounting(section.section("mounting"));
    section.finish();
    Some((ImuConfiguration { mounting }, source?))
}

fn read_can(section: Reader<'_>) -> Option<(CanConfiguration, CanAddress)> {
    let source = read_source(&section, "socketcan:can0", CanAddress::parse);
    let node = |key| section.integer(key, 1..=127) as u8;
    let can = CanConfiguration {
        drive_node: node("drive_node"),
        steering_node: node("steering_node"),
        left_encoder_node: node("left_encoder_node"),
        right_encoder_node: node("right_encoder_node"),
        inputs_node: node("inputs_node"),
        dirt_sensor_node: section.integer_or_absent("dirt_sensor_node", 1..=127).map(|node| node as u8),
        inputs: InputMap::default(),
    };
    let mut nodes = vec![
        can.drive_node,
        can.steering_node,
        can.left_encoder_node,
        can.right_encoder_node,
        can.inputs_node,
    ];
    nodes.extend(can.dirt_sensor_node);
    let different: std::collections::BTreeSet<u8> = nodes.iter().copied().collect();
    if different.len() < nodes.len() {
        section.refuse(
            section.span(),
            format!("[can]: node numbers {nodes:?} are not different"),
            "give every device on the bus its own number",
        );
    }
    section.finish();
    Some((can, source?))
}

/// A camera that looks down at the floor before the robot.
fn read_camera(section: Reader<'_>) -> Option<CameraConfiguration> {
    let depth = read_source(&section, "v4l2:/dev/video2", parse_video);
    let colour = section.find("colour_source").and_then(|_| {
        let (text, span) = section.text("colour_source", "v4l2:/dev/video4")?;
        let device = parse_video(text);
        if device.is_none() {
            section.refuse(
                &span,
                format!("[camera]: `colour_source` is \"{text}\", no address of this kind"),
                "write for example \"v4l2:/dev/video4\"",
            );
        }
        device
    });
    // The core has room for pictures of this size.
    let size = (section.integer("width", 64..=640) as usize, section.integer("height", 48..=480) as usize);
    let focal = [section.number("fx", 30.0..=2_000.0), section.number("fy", 30.0..=2_000.0)];
    let centre = [section.number("cx", 0.0..=640.0), section.number("cy", 0.0..=480.0)];
    let mounting = read_mounting(section.section("mounting"));
    if mounting.roll_rad.abs() > 0.1 || !(0.2..1.5).contains(&mounting.pitch_rad) {
        section.refuse(
            section.span(),
            "[camera]: rolled by more than 6°, or not pitched down by 11° to 86°",
            "mount the camera so that it looks down at the floor before the robot",
        );
    }
    section.finish();
    let camera = PinholeCamera::new(focal, centre)?;
    Some(CameraConfiguration { depth: depth?, colour, size, camera, mounting })
}

/// Which bit of the safety controller's process image means what.
fn read_inputs(section: Reader<'_>) -> Option<InputMap> {
    let inverted = section.bit_list("inverted_bits");
    let with_polarity = |bits: [u8; 2]| InputBits { bits, inverted: bits.map(|bit| inverted.contains(&bit)) };
    let required = |key| {
        let bits = section.bits_or_absent(key);
        if bits.is_none() && section.good_so_far() {
            section.refuse(
                section.span(),
                format!("[inputs]: `{key}` is missing; nothing moves without it"),
                format!("add for example `{key} = [32, 33]`: the bits of both channels in the process image"),
            );
        }
        bits.map(with_polarity)
    };
    let optional = |key| section.bits_or_absent(key).map(with_polarity);
    let (emergency_stop, bumper_front) = (required("emergency_stop_bits"), required("bumper_front_bits"));
    let (bumper_rear, cliff_front) = (optional("bumper_rear_bits"), optional("cliff_front_bits"));
    let cliff_rear = optional("cliff_rear_bits");
    let discrepancy_us = (section.number_or("discrepancy_s", 0.01..=1.0, 0.5) * 1.0e6) as u64;
    section.finish();
    Some(InputMap {
        emergency_stop: emergency_stop?,
        bumper_front: bumper_front?,
        bumper_rear,
        cliff_front,
        cliff_rear,
        discrepancy_us,
    })
}

/// The guard's thresholds that a site may want to change; the others follow from the standards.
fn read_thresholds(section: Reader<'_>) -> Thresholds {
    let defaults = Thresholds::default();
    let thresholds = Thresholds {
        warning_speed_mps: section.number_or("warning_speed_mps", 0.05..=0.5, defaults.warning_speed_mps),
        person_speed_mps: section.number_or("person_speed_mps", 0.05..=0.5, defaults.person_speed_mps),
        person_near_m: section.number_or("person_near_m", 0.5..=5.0, defaults.person_near_m),
        ..defaults
    };
    section.finish();
    thresholds
}

fn read_source<T>(section: &Reader<'_>, example: &str, parse: impl Fn(&str) -> Option<T>) -> Option<T> {
    let (text, span) = section.text("source", example)?;
    let address = parse(text);
    if address.is_none() {
        section.refuse(
            &span,
            format!("{}: `source` is \"{text}\", no address of this kind", section.title()),
            format!("write for example \"{example}\""),
        );
    }
    address
}

fn read_serial(section: &Reader<'_>) -> Option<SerialAddress> {
    let device = read_source(section, "serial:/dev/ttyUSB0", parse_serial);
    let baud = section.integer("baud", 9_600..=4_000_000) as u32;
    Some(SerialAddress { device: device?, baud })
}

fn read_polygon(section: &Reader<'_>, key: &'static str) -> Option<Polygon> {
    let (points, span) = section.points(key)?;
    match polygon::checked(&points) {
        Ok(polygon) => Some(polygon),
        Err(reason) => {
            section.refuse(&span, format!("`{key}`: {reason}"), "give 3 to 16 corners, counter-clockwise");
            None
        }
    }
}

fn read_fields(
    top: &Reader<'_>,
    geometry: &Option<Geometry>,
    limits: &Limits,
) -> heapless::Vec<FieldPair, FIELD_SETS_MAX> {
    let mut fields = heapless::Vec::new();
    let mut last = top.span().clone();
    for section in top.sections("field") {
        let span = section.span().clone();
        last = span.clone();
        if let Some(field) = read_field(section, geometry.as_ref(), limits)
            && fields.push(field).is_err()
        {
            top.refuse(
                &span,
                format!("more than {FIELD_SETS_MAX} fields"),
                "remove speed bins that are not needed",
            );
        }
    }
    if top.good_so_far() {
        check_cover((top, &last), &fields, (DirectionOfTravel::Forward, "forward"), limits.speed_mps);
        check_cover((top, &last), &fields, (DirectionOfTravel::Reverse, "reverse"), limits.reverse_mps);
    }
    fields
}

/// Every speed that the robot may drive needs a field.
fn check_cover(
    (top, last): (&Reader<'_>, &std::ops::Range<usize>),
    fields: &[FieldPair],
    direction: (DirectionOfTravel, &str),
    speed_mps: f32,
) {
    let of_direction = fields.iter().filter(|field| field.direction == direction.0);
    let covered_mps = of_direction.map(|field| field.speed_max_mps).fold(0.0, f32::max);
    if covered_mps < speed_mps {
        top.refuse(
            last,
            format!(
                "[[field]]: {} fields end at {covered_mps} m/s, the limit is {speed_mps} m/s",
                direction.1
            ),
            "add a field for the higher speeds or lower the limit",
        );
    }
}

fn read_field(section: Reader<'_>, geometry: Option<&Geometry>, limits: &Limits) -> Option<FieldPair> {
    let directions = [("forward", DirectionOfTravel::Forward), ("reverse", DirectionOfTravel::Reverse)];
    let direction = section.choice("direction", &directions);
    let speed_max_mps = section.number("speed_max_mps", 0.05..=2.5);
    let protective = read_polygon(&section, "protective_m");
    let warning = read_polygon(&section, "warning_m");
    let span = section.find("protective_m").map_or(section.span().clone(), |value| value.span());
    if let (Some(protective), Some(warning)) = (&protective, &warning)
        && !polygon::covers(warning, protective)
    {
        section.refuse(
            &span,
            "the protective zone reaches beyond its warning zone",
            "make the warning zone larger",
        );
    }
    if section.good_so_far()
        && let (Some(direction), Some(protective), Some(geometry)) = (direction, &protective, geometry)
    {
        check_zone(&section, &span, (direction, speed_max_mps, protective), (geometry, limits));
    }
    section.finish();
    Some(FieldPair { direction: direction?, speed_max_mps, protective: protective?, warning: warning? })
}

/// A zone must enclose the body and reach as far as the robot needs to stop.
fn check_zone(
    section: &Reader<'_>,
    span: &std::ops::Range<usize>,
    (direction, speed_mps, protective): (DirectionOfTravel, f32, &Polygon),
    (geometry, limits): (&Geometry, &Limits),
) {
    if polygon::covers(&geometry.footprint, protective) {
        section.refuse(span, "the protective zone lies inside the footprint", "let it reach beyond the body");
        return;
    }
    if !polygon::covers(protective, &geometry.footprint) {
        section.refuse(span, "the protective zone does not enclose the footprint", "include the whole body");
        return;
    }
    let (zone, body) = (polygon::x_extent_m(protective), polygon::x_extent_m(&geometry.footprint));
    let reach_m = match direction {
        DirectionOfTravel::Forward => zone.1 - body.1,
        DirectionOfTravel::Reverse => body.0 - zone.0,
    };
    let driven_mps = match direction {
        DirectionOfTravel::Forward => speed_mps.min(limits.speed_mps),
        DirectionOfTravel::Reverse => speed_mps.min(limits.reverse_mps),
    };
    let needed_m = field_length_m(driven_mps, limits);
    if reach_m + 1.0e-3 < needed_m {
        section.refuse(
            span,
            format!("the protective zone reaches {reach_m:.2} m ahead; stopping from {driven_mps} m/s takes {needed_m:.2} m"),
            "lengthen the zone or lower speed_max_mps",
        );
    }
}

/// Field length ahead of the body that a speed needs (algorithms M.1 without retro-reflectors and ground clearance).
fn field_length_m(speed_mps: f32, limits: &Limits) -> f32 {
    let braking_m = speed_mps * speed_mps / (2.0 * limits.braking_mps2);
    speed_mps * (SCANNER_RESPONSE_S + limits.response_s)
        + braking_m * (1.0 + BRAKE_WEAR)
        + SCANNER_TOLERANCE_M
}

fn read_route(section: Reader<'_>, limits: &Limits) -> (Route, RouteLimits) {
    let mut route = Route { repeat: section.flag_or("repeat", false), ..Route::default() };
    if let Some((points, span)) = section.points("waypoints_m") {
        for [x_m, y_m] in points {
            if route.waypoints.push(Point2::new(x_m, y_m)).is_err() {
                section.refuse(
                    &span,
                    format!("more than {ROUTE_WAYPOINTS_MAX} waypoints"),
                    "shorten the route",
                );
                break;
            }
        }
    }
    let defaults = RouteLimits::default();
    let greatest_mps = if section.good_so_far() { limits.speed_mps } else { f32::MAX };
    let speed_mps = section.number_or("speed_mps", 0.05..=greatest_mps, defaults.speed_mps.min(greatest_mps));
    section.finish();
    (route, RouteLimits { speed_mps, turn_radps: defaults.turn_radps.min(limits.turn_radps), ..defaults })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::EXAMPLE;

    const CAMERA: &str = "[camera]\nsource = \"v4l2:/dev/video2\"\ncolour_source = \"v4l2:/dev/video4\"\n\
        width = 640\nheight = 480\nfx = 525.0\nfy = 525.0\ncx = 319.5\ncy = 239.5\n\
        mounting = { x_m = 0.9, y_m = 0.0, z_m = 0.72, pitch_deg = 45.0 }\n";

    #[test]
    fn a_camera_is_read_and_one_that_looks_up_is_refused() {
        let text = format!("{EXAMPLE}\n{CAMERA}");
        let camera = parse("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}")).carriers.camera;
        let camera = camera.expect("there is a camera");
        assert_eq!((camera.size, camera.mounting.position.z_m), ((640, 480), 0.72));
        assert_eq!(camera.colour.as_deref(), Some(std::path::Path::new("/dev/video4")));
        for (from, to) in [("45.0", "-45.0"), ("v4l2:/dev/video4", "udp:1"), ("width = 640", "width = 6400")]
        {
            let refused = parse("robot.toml", &text.replace(from, to)).expect_err("refused").to_string();
            assert!(refused.contains("[camera]") || refused.contains("width"), "{refused}");
        }
    }

    #[test]
    fn the_example_is_accepted() {
        let configuration = parse("robot.toml", EXAMPLE).unwrap_or_else(|refused| panic!("{refused}"));
        assert_eq!(configuration.robot.fields.len(), 4);
        assert_eq!(configuration.robot.can.drive_node, 1);
        configuration.robot.guard().validate().unwrap();
    }
}
