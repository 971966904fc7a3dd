//! What a file may mean, and is worth a second look: nothing here refuses it.

use core::f32::consts::FRAC_PI_2;

use floorguard_drivers::flexisoft::InputBits;
use floorguard_runtime::configuration::{BaseKind, Mounting, ScannerModel};

use super::motors::shortcomings;
use super::read::HostedConfiguration;

impl HostedConfiguration {
    /// What can be right and is more often a mistake, each with how to find out.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let robot = &self.robot;
        let imu = robot.imu.map(|imu| ("imu", imu.mounting));
        let sensors = [("lidar", robot.lidar.mounting), ("scanner", robot.scanner.mounting)];
        let mountings = sensors.into_iter().chain(imu);
        let mut warnings: Vec<String> =
            mountings.filter_map(|(name, mounting)| of_mounting(name, &mounting)).collect();
        if let (ScannerModel::Ranging(ranging), Some(mps)) = (robot.scanner.model, self.uncertified_mps) {
            warnings.push(format!(
                "[scanner]: a {} is no safety device: nothing about it is certified, and what it does not see stops nobody; at most {mps} m/s",
                ranging.name()
            ));
            let [_, farthest_m] = ranging.geometry().range_m;
            warnings.push(format!(
                "[scanner]: where nothing comes back to a {} nothing is known, and the robot stands while a part of its field is \
                 unknown: before walls farther than {farthest_m} m, black or tilted glass, and in the open it does not drive",
                ranging.name()
            ));
        }
        let inputs = &robot.can.inputs;
        let fitted =
            [("bumper_front_bits", Some(inputs.bumper_front)), ("bumper_rear_bits", inputs.bumper_rear)];
        let has_inputs = robot.base == BaseKind::CanBus && robot.can.inputs_node != 0;
        for (key, input) in fitted.into_iter().filter(|_| has_inputs || robot.motors.is_none()) {
            match input {
                None => warnings.push(format!(
                    "[inputs]: `{key}` is missing: what touches the body there is not noticed; fit a bumper there"
                )),
                Some(InputBits { bits: [first, second], .. }) if first == second => warnings.push(format!(
                    "[inputs]: `{key}` has one channel: a single fault and a contact is not noticed; wire both channels"
                )),
                Some(_) => {}
            }
        }
        warnings.extend(robot.motors.iter().flat_map(shortcomings));
        warnings
    }
}

/// A sensor that faces backwards or hangs upside down.
fn of_mounting(name: &str, mounting: &Mounting) -> Option<String> {
    let degrees = |radians: f32| radians.to_degrees().round();
    let is_over = |radians: f32| radians.abs() > FRAC_PI_2 + 1.0e-3;
    let (what, degrees) = if is_over(mounting.roll_rad) {
        ("hangs upside down", degrees(mounting.roll_rad))
    } else if is_over(mounting.yaw_rad) {
        ("faces backwards", degrees(mounting.yaw_rad))
    } else {
        return None;
    };
    Some(format!(
        "[{name}.mounting]: the {name} {what} ({degrees}°); if it does not, what lies before the robot is taken for what lies behind: \
         stand before the robot and look where the panel shows you, and turn it by hand to the left: the turning rate must be positive"
    ))
}

#[cfg(test)]
mod tests {
    use crate::{EXAMPLE, parse};

    fn warnings(changes: &[(&str, &str)]) -> Vec<String> {
        let text = changes.iter().fold(EXAMPLE.to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replacen(from, to, 1)
        });
        parse("robot.toml", &text).unwrap_or_else(|refused| panic!("{refused}")).warnings()
    }

    /// What a scanner without safety costs is reported with its range.
    #[test]
    fn fg_req_085_scanner_without_safety_is_pointed_out() {
        let safe = "model = \"s300\"\nsource = \"serial:/dev/ttyUSB0\"\nbaud = 500000\n";
        for (model, farthest) in [("hokuyo-ust", "30 m"), ("hokuyo-urg-04lx", "4 m"), ("rplidar-a", "12 m")] {
            let keys = format!(
                "model = \"{model}\"\nsource = \"serial:/dev/ttyACM0\"\naccept_uncertified_mps = 0.3\n"
            );
            let found = warnings(&[(safe, &keys)]);
            assert!(
                found.len() == 2 && found[0].contains("no safety device") && found[0].contains("0.3 m/s"),
                "{found:?}"
            );
            assert!(found[1].contains(farthest) && found[1].contains("it does not drive"), "{found:?}");
        }
    }

    #[test]
    fn turned_sensors_and_single_channels_are_pointed_out() {
        assert_eq!(warnings(&[]), Vec::<String>::new());
        for (place, name) in [("x_m = 0.50", "lidar"), ("x_m = 0.90", "scanner"), ("x_m = 0.30", "imu")] {
            let line = EXAMPLE.lines().find(|line| line.contains(place)).expect("a mounting");
            for (angle, what) in
                [("yaw_deg", "faces backwards (180°)"), ("roll_deg", "hangs upside down (180°)")]
            {
                let turned = line.replace(&format!("{angle} = 0.0"), &format!("{angle} = 180.0"));
                let found = warnings(&[(line, &turned)]);
                assert!(found.len() == 1 && found[0].contains(name) && found[0].contains(what), "{found:?}");
            }
        }
        let found = warnings(&[("bumper_front_bits = [34, 35]", "bumper_front_bits = [34]")]);
        assert!(found.len() == 1 && found[0].contains("one channel"), "{found:?}");
        let found = warnings(&[("bumper_rear_bits = [36, 37]\n", "")]);
        assert!(found.len() == 1 && found[0].contains("is missing"), "{found:?}");
    }
}
