//! The reference of `robot.toml`, out of the reading itself: every key that is asked for, with what is allowed.

use std::fmt::Write;

use super::asked::{Asked, asked_during};

/// More sections that the example robot does not have.
const OPTIONAL: &str = "
[mission]
map = \"hall.yaml\"
strategy = \"systematic\"
[navigation]
[fleet]
broker = \"127.0.0.1\"
serial = \"robot-7\"
[ros2]
address = \"192.168.1.5\"
[learning]
[panel]
[rear_scanner]
model = \"s300\"
source = \"serial:/dev/ttyUSB3\"
baud = 500000
mounting = { x_m = -0.43, y_m = 0.0, z_m = 0.15, yaw_deg = 180.0 }
[[field]]
direction = \"forward\"
speed_max_mps = 0.3
protective_m = [[-0.60, -0.60], [1.40, -0.60], [1.40, 0.60], [-0.60, 0.60]]
warning_m = [[-0.80, -0.80], [1.90, -0.80], [1.90, 0.80], [-0.80, 0.80]]
";

/// The scanner of the example robot, and the other one: each is asked for what the other does not have.
const LINE_SCANNER: &str = "model = \"s300\"\nsource = \"serial:/dev/ttyUSB0\"\nbaud = 500000\n";
const NETWORK_SCANNER: &str = "model = \"microscan3\"\nsource = \"udp:0.0.0.0:6060\"\n";
const RANGING_SCANNER: &str =
    "model = \"hokuyo-ust\"\nsource = \"tcp:192.168.0.10:10940\"\naccept_uncertified_mps = 0.3\n";

/// The inertial sensor of the example robot, and one behind a bridge.
const LINE_IMU: &str = "[imu]\nsource = \"serial:/dev/ttyUSB1\"\nbaud = 115200\n";
const BRIDGED_IMU: &str = "[imu]\nmodel = \"bridged\"\nsource = \"udp:127.0.0.1:2371\"\n";

/// The lidar of the example robot.
const LIDAR: &str = "model = \"vlp16\"\n";

/// The robot that a program outside drives; it has no route of its own.
const COMMANDED: [&str; 2] = [
    "[command]\nsource = \"serial:/dev/ttyUSB2\"\nbaud = 230400\n",
    "[command]\nsource = \"ros2:/cmd_vel\"\ndeadline_ms = 200\n",
];

/// Bases that take velocities, instead of drives on a CAN bus.
const BASES: [&str; 2] = [
    "[base]\nsource = \"udp:0.0.0.0:7100\"\ncontroller = \"192.168.1.20:7101\"\n",
    "[base]\nsource = \"serial:/dev/ttyUSB2\"\nbaud = 115200\n",
];

/// Wheels other than the example's, with their part of `[can]` instead of its.
const NODES: &str = "drive_node = 1\nsteering_node = 2\nleft_encoder_node = 3\nright_encoder_node = 4\n";
const WHEELS: [(&str, &str); 3] = [
    ("kind = \"differential\"\n", "left_drive_node = 1\nright_drive_node = 2\n"),
    ("kind = \"ackermann\"\nsteering_max_deg = 35.0\n", NODES),
    (
        "kind = \"omnidirectional\"\n",
        "front_left_drive_node = 1\nfront_right_drive_node = 2\nrear_left_drive_node = 3\nrear_right_drive_node = 4\n",
    ),
];

/// Motor controllers other than CiA 402 drives: on a bus, and on a line.
const MOTORS: [&str; 2] = [
    "kind = \"differential\"\ndrives = \"vesc\"\nmetres_per_turn = 0.05\npole_pairs = 7\nreversed = \"right\"\nbrakes = true\n",
    "kind = \"differential\"\ndrives = \"roboteq\"\nmetres_per_turn = 0.02\ncounts_per_turn = 2000\nreversed = \"none\"\nsource = \
     \"serial:/dev/ttyACM0\"\nbaud = 115200\n",
];

/// The example robot with such controllers.
fn with_motors(base: &str) -> String {
    let own = without("[can]", "[guard]")
        .replace("wheelbase_m = 0.80\n", "")
        .replace("ticks_per_m = 20000.0\n", "");
    let bus = if base.contains("serial:") {
        ""
    } else {
        "\n[can]\nsource = \"socketcan:can0\"\nleft_drive_node = 1\nright_drive_node = 2\n"
    };
    [&own, bus, "\n[base]\n", base].concat()
}

/// The example robot on other wheels.
fn on_wheels((base, nodes): (&str, &str)) -> String {
    let own = super::EXAMPLE.replace(NODES, nodes);
    let own = if base.contains("differential") { own.replace("wheelbase_m = 0.80\n", "") } else { own };
    [&own, "\n[base]\n", base].concat()
}

/// The example robot without what stands from one section up to another.
fn without(from: &str, to: &str) -> String {
    let (before, rest) = super::EXAMPLE.split_once(from).unwrap_or((super::EXAMPLE, ""));
    let after = rest.split_once(to).map_or(String::new(), |(_, after)| [to, after].concat());
    [before, &after].concat()
}

/// Every key with its kind, what is allowed, its default, and its value in the example robot, as Markdown.
#[must_use]
pub fn reference() -> String {
    let with_all = [
        super::EXAMPLE,
        "\n",
        super::camera::EXAMPLE_SECTION,
        super::actuated_lidar::EXAMPLE_SECTION,
        OPTIONAL,
    ]
    .concat();
    let mut rows = rows_of(&with_all);
    let others = rows_of(&with_all.replace(LINE_SCANNER, NETWORK_SCANNER));
    let driven = super::EXAMPLE.split("[route]").next().unwrap_or_default();
    let commanded = COMMANDED.iter().flat_map(|command| rows_of(&[driven, command].concat()));
    let others = others.into_iter().chain(commanded);
    let based = BASES.iter().flat_map(|base| rows_of(&[&without("[can]", "[guard]"), "\n", base].concat()));
    let wheeled = WHEELS.iter().flat_map(|wheels| rows_of(&on_wheels(*wheels)));
    let motored = MOTORS.iter().flat_map(|base| rows_of(&with_motors(base)));
    let others = others.chain(based).chain(wheeled).chain(motored);
    let ouster = super::ouster_keys(&super::ouster_example());
    let others = others.chain(rows_of(&with_all.replace(LINE_SCANNER, RANGING_SCANNER)));
    let bridged = super::bridged_scanner_keys(&super::BRIDGED_EXAMPLE) + "accept_uncertified_mps = 0.3\n";
    let others = others.chain(rows_of(&with_all.replace(LINE_SCANNER, &bridged)));
    let others = others.chain(rows_of(&with_all.replace(LINE_IMU, BRIDGED_IMU)));
    let others = others.chain(rows_of(&super::EXAMPLE.replace(LIDAR, &ouster)));
    let others = others.chain(rows_of(&super::EXAMPLE.replace(LIDAR, &super::bridged_keys())));
    for row in others {
        if !rows.iter().any(|known| known.is_of(&row.section, row.key)) {
            rows.push(row);
        }
    }
    // A section is asked on behind the one within it: its keys stand together all the same.
    let order: Vec<String> = rows.iter().map(|row| row.section.clone()).collect();
    rows.sort_by_key(|row| order.iter().position(|section| *section == row.section));
    let mut text = String::from(HEAD);
    let mut section = String::new();
    for row in rows {
        let name = row.section.clone();
        if name != section {
            let _ =
                write!(text, "\n## `[{name}]`\n\n| key | kind | allowed | without it |\n|---|---|---|---|\n");
            section.clone_from(&name);
        }
        let without = row.default.unwrap_or_else(|| "refused".to_owned());
        let _ = writeln!(text, "| `{}` | {} | {} | {without} |", row.key, row.kind, row.allowed);
    }
    let _ = write!(
        text,
        "\n## A floor camera\n\n```toml\n{}```\n\n## The example robot\n\n```toml\n{}```\n",
        super::camera::EXAMPLE_SECTION,
        super::EXAMPLE
    );
    text
}

/// What is asked for while a text is read, each key once: `[[field]]` is asked for as often as it stands there.
fn rows_of(configuration: &str) -> Vec<Asked> {
    let (read, asked) = asked_during(|| super::parse("robot.toml", configuration));
    debug_assert!(read.is_ok(), "the example is a right configuration");
    let mut rows = Vec::<Asked>::new();
    for mut row in asked {
        // One of several is counted: "field 1".
        let counted = row.section.rsplit_once(' ');
        row.section = counted.map_or(row.section.as_str(), |(name, _)| name).to_owned();
        if !rows.iter().any(|known| known.is_of(&row.section, row.key)) {
            rows.push(row);
        }
    }
    rows
}

const HEAD: &str = "# Configuration reference

Made from the code that reads `robot.toml`, by `FLOORGUARD_REFRESH=1 cargo test -p floorguard-configuration reference`; a
test fails when this page is old. `floorguard check robot.toml` tells every mistake of a file with line, limit and remedy.

Units stand at the end of each key. The robot's frame lies on the floor in the middle of the rear axle, x forward, y left,
z up.

`[deadlines]`, `[lidar]`, `[rear_scanner]`, `[imu]`, `[guard]`, `[route]`, `[camera]`, `[actuated_lidar]`, `[mission]`, `[navigation]`, `[learning]`, `[fleet]`, `[ros2]`, `[command]`, `[panel]` and every `[[field]]` may be missing as a whole.
`floorguard check` and the start of `run` say what each missing section costs. The safety scanner cannot be left out: it is what
sees feet and children in time when all else fails. `[base]`, a base that takes velocities and measures its own, stands for `[can]`
and `[inputs]`; then `wheelbase_m`, `track_m` and `ticks_per_m` may be missing, and a recording cannot be replayed, because it
holds the frames of a CAN bus. A base that does not report its motion cannot be driven: without it the guard does not know how
much it needs to stop. `kind` in `[base]` names the wheels ([Odometry: Bases](algorithms/odometry.md#bases)); without `source` their drives
are on the CAN bus, and `[can]` names those that this base has: `drive_node`, `steering_node` and two encoders of a tricycle or a car
(`steering_max_deg` is its alone), a drive on each wheel of a differential or omnidirectional base. Those have no `wheelbase_m` where they
have one axle, and `ticks_per_m` counts the encoder of one wheel's drive. With `[command]` a program outside drives the robot by velocities (book, Velocity link) and there is neither `[route]` nor
`[mission]`; `baud` is that of a serial `source`, `deadline_ms` of a topic of ROS 2 (`ros2:/cmd_vel`), `sender` and `subscribers` belong to a port, and a `sender_id` of 0 stands for
the first sender that comes. In `[lidar]`, `profile`, `columns_per_turn`, `columns_per_packet` and the keys that begin with `beam_` are an
Ouster's: `floorguard lidar-metadata FILE.json` writes them from the metadata that the sensor serves
([Devices](devices.md#lidar-ouster-os0-os1-os2)). With `model = \"columns\"` a bridge sends the columns of any lidar of 16 rings, whose elevations
`elevations_deg` names ([Lidar link](wire-formats/lidar-link.md)); of a Livox it names the rings that its points become
([Livox](wire-formats/livox.md)). Fields follow from
`[robot]` and `[limits]`; what is drawn in `[[field]]` must contain them and is added. `[learning]`: the robot corrects its
classifier of people from the tracks that it sees (hosted only; `run`, and `simulate` and `demo` with `--robot FILE`; a replay learns
as its recording did). `model` is relative to the folder of this file. The guard hears of what was learned only where that adds a
person: no stop is loosened by it. `[navigation]` is how `goto` drives on a map, and `simulate --navigate` on that of its
scenario; `start_…` is where the robot is switched on, in the map's frame. With `[fleet]`, `run` waits for the orders of a fleet's
master on the map of `[navigation]`, and cleans on order where `[mission]` has the same map (book, Fleets and live views); the program must be built with the feature `fleet`, and with
`fleet-tls` where `authority` is given. The broker's password stands in `FLOORGUARD_FLEET_PASSWORD`. With `[ros2]`, or a `source` of ROS 2 in
`[command]`, the robot is live in ROS 2 ([ROS 2](ros2.md)); the program must be built with the feature `ros2`. In `[scanner]`, `baud` is an S300's; `beams` and `sender` are a microScan3's, whose `source` is like
the lidar's; a Hokuyo, a TiM, an LMS and an RPLidar are no safety devices: their `source` is `tcp:ADDRESS:PORT` or `serial:DEVICE` (with `baud`), and no robot drives behind it
without `accept_uncertified_mps`, the greatest speed of any direction; where nothing comes back to them it is unknown, never free ([Ranging scanners](wire-formats/ranging.md)). With `model = \"bridged\"` a
program beside sends the scans of any scanner, which is no safety device then: `beams` (60 or more), `first_deg`, `step_deg`, `period_s`,
`nearest_m` and `farthest_m` describe them, and its `source` is like the lidar's ([Scan link](wire-formats/scan-link.md)). In `[imu]`,
`model = \"bridged\"` stands for any sensor whose samples a program beside sends, to a port (`sender` as in `[lidar]`, no `baud`) or on a line
([IMU link](wire-formats/imu-link.md)). `[rear_scanner]` is a second S300 on a line of its own, which looks behind and beside the rear: the guard watches the same
fields with it, and waits for it as for the first (`rear_scanner_s` in `[deadlines]`; without it `scanner_s` counts); a program for a
microcontroller lacks the memory for it. No two devices share a line, a UDP port or a bit of the safety controller's image, and an S300's `baud` is 500000, 250000,
125000 or 115200: at any other its scans come too late, or not at all.

`[actuated_lidar]` is a Hokuyo lidar on its side that a CiA 402 motor turns about a vertical axis: `run` builds the window of surfaces
around the robot from both ([Sliding window](algorithms/sliding-window.md)). The guard does not hear of it. With `people_source` a
program beside, which looks at the pictures of a panoramic camera, sends one datagram a picture: `{\"age_s\": 0.05, \"boxes\": [[-0.1, 0.1,
-0.7, 0.4]]}`, how old the picture is, and for each person least and largest azimuth and least and largest elevation from the camera,
radians, left and up positive. What lies in a box leaves the window, and where two sweeps saw the same person walk, the list of people
hears of it: that can only add a person.

`accept_unseen` in `[guard]` names what no sensor sees of the volume that the body goes into, as `floorguard check` prints it; `run`
refuses a gap that is not named, and a name without a gap ([Coverage of the sensors](algorithms/coverage.md)).

In `[inputs]`, `reset_bit` and `start_bit` are push buttons of the operator, 1 = pressed: with them a robot without panel and terminal can
be reset and started, for example as a service. A button acts when it is released, after 0.03 to 5 s: one that is stuck or tied down
does nothing. Wire them to the safety controller beside the emergency stop, where one sees the whole robot; `inverted_bits` does not
concern them. A recording holds what the buttons did, because it holds the frames of the bus.

`[panel]` is what the operator's panel shows besides the robot; the guard does not know it. `consumables` are parts that wear out, each with
its hours of driving: the panel counts them and a technician acknowledges there that a part was changed. `battery_low_bit`,
`clean_water_low_bit` and `dirty_water_full_bit` are bits of the safety controller's image, 1 = reported. `battery_node` is a battery
computer on the CAN bus: the first byte of its message 0x180 + node is the charge in percent. `robots` are other robots whose panels
this one reads every two seconds, with the viewer's token of this panel (`FLOORGUARD_PANEL_VIEWER_TOKEN`, the same for all robots of a
site): their state stands in the page, and a link opens their own panel. Nothing can be ordered of a robot but at its own panel.
";

#[cfg(test)]
mod tests {
    use std::path::Path;

    #[test]
    fn configuration_page_matches_the_code() {
        let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/src/configuration.md");
        let made = super::reference();
        assert!(made.matches("\n| `").count() > 50, "{made}");
        let scanner =
            made.split("## `[scanner]`").nth(1).and_then(|rest| rest.split("\n## ").next()).unwrap_or("");
        for key in ["baud", "beams", "sender"] {
            assert_eq!(scanner.matches(&format!("| `{key}` |")).count(), 1, "{key}: {scanner}");
        }
        if std::env::var_os("FLOORGUARD_REFRESH").is_some() {
            std::fs::write(&page, &made).expect("the page is written");
        }
        let written = std::fs::read_to_string(&page).unwrap_or_default();
        assert!(
            written == made,
            "docs/src/configuration.md is old: FLOORGUARD_REFRESH=1 cargo test -p floorguard-configuration reference"
        );
    }
}
