//! Values on the command line: what cannot be is wrong usage, and ends with 2 as every other mistake on it does.

use std::net::{SocketAddr, ToSocketAddrs as _};

#[cfg(any(test, feature = "laboratory"))]
use floorguard_configuration::{CommandConfiguration, RosTopic};
#[cfg(any(test, feature = "laboratory"))]
use floorguard_types::geometry::Pose2;

/// The longest simulated run, seconds: a day.
#[cfg(any(test, feature = "laboratory"))]
const DAY_S: f64 = 86_400.0;

/// Seconds of a simulated run: more than 0, up to a day.
///
/// # Errors
/// Anything else, in words.
#[cfg(any(test, feature = "laboratory"))]
pub(super) fn simulated_seconds(text: &str) -> Result<f64, String> {
    let in_a_day = text.parse::<f64>().ok().filter(|seconds| *seconds > 0.0 && *seconds <= DAY_S);
    in_a_day.ok_or_else(|| "give seconds, more than 0 and up to 86400 (a day)".to_owned())
}

/// Seconds of a run of the robot: more than 0.
///
/// # Errors
/// Anything else, in words.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    let some = text.parse::<f64>().ok().filter(|seconds| *seconds > 0.0 && seconds.is_finite());
    some.ok_or_else(|| "give seconds, more than 0".to_owned())
}

/// The side of a square that is explored: 5 to 150 m.
///
/// # Errors
/// Anything else, in words.
pub(super) fn side_m(text: &str) -> Result<f32, String> {
    let some = text.parse::<f32>().ok().filter(|side| (5.0..=150.0).contains(side));
    some.ok_or_else(|| "give metres, from 5 to 150".to_owned())
}

/// Where velocities come from outside: `udp:ADDRESS:PORT`.
///
/// # Errors
/// No address and port.
#[cfg(any(test, feature = "laboratory"))]
pub(super) fn command_address(text: &str) -> Result<CommandConfiguration, String> {
    let address = text.strip_prefix("udp:").and_then(|address| address.parse().ok());
    let port = address.map(CommandConfiguration::on_port);
    let topic = || RosTopic::parse(text).map(CommandConfiguration::on_topic);
    let command = port.or_else(topic);
    command.ok_or_else(|| {
        "write udp:ADDRESS:PORT or ros2:TOPIC, for example udp:127.0.0.1:7000 or ros2:/cmd_vel".to_owned()
    })
}

/// Where a panel listens: `127.0.0.1:8080`, `[::1]:8080`, or a name of this computer as `localhost:8080`.
///
/// # Errors
/// Metres or degrees of a place on a map.
///
/// # Errors
/// Anything else, in words.
pub(super) fn coordinate(text: &str) -> Result<f32, String> {
    let number = text.parse::<f32>().ok().filter(|number| number.abs() <= 10_000.0);
    number.ok_or_else(|| "write metres or degrees as a number, for example 14.5".to_owned())
}

/// A place and a heading of the map frame: `X,Y,YAW` in metres and degrees.
///
/// # Errors
/// Anything else, in words.
#[cfg(any(test, feature = "laboratory"))]
pub(super) fn goal(text: &str) -> Result<Pose2, String> {
    let numbers: Vec<f32> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    match numbers.as_slice() {
        &[x_m, y_m, yaw_deg]
            if numbers.iter().all(|number| number.abs() <= 10_000.0) && text.split(',').count() == 3 =>
        {
            Ok(Pose2::new(x_m, y_m, yaw_deg.to_radians()))
        }
        _ => Err("write X,Y,YAW in metres and degrees, for example 14.5,4.5,90".to_owned()),
    }
}

/// No address and port, or a name that nobody knows.
pub(super) fn panel_address(text: &str) -> Result<SocketAddr, String> {
    if let Ok(address) = text.parse() {
        return Ok(address);
    }
    let resolved = text
        .to_socket_addrs()
        .map_err(|error| format!("write ADDRESS:PORT, for example 127.0.0.1:8080 ({error})"))?;
    let all: Vec<SocketAddr> = resolved.collect();
    // A browser on this computer tries both; the older form is there everywhere.
    let first = all.iter().find(|address| address.is_ipv4()).or(all.first());
    first.copied().ok_or_else(|| format!("`{text}` is the name of no computer"))
}

/// `20..25`, seconds.
///
/// # Errors
/// Anything else, in words.
#[cfg(feature = "laboratory")]
pub(super) fn parse_span(text: &str) -> anyhow::Result<(u64, u64)> {
    use super::exit::WrongUsage;
    let micros = |part: &str| {
        part.parse::<f64>().ok().filter(|s| *s >= 0.0 && s.is_finite()).map(|s| (s * 1.0e6) as u64)
    };
    let span = text.split_once("..").and_then(|(from, to)| Some((micros(from)?, micros(to)?)));
    span.filter(|(from, to)| from < to).ok_or_else(|| {
        WrongUsage(format!("--emergency-stop {text}: write the seconds as FROM..TO, for example 20..25"))
            .into()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn infinite_duration_is_refused() {
        assert_eq!(simulated_seconds("9.5"), Ok(9.5));
        for text in ["0", "-1", "1e400", "nan", "inf", "90000", "ten"] {
            assert!(simulated_seconds(text).is_err(), "{text}");
        }
        assert_eq!(seconds("100000"), Ok(100_000.0));
        assert!(seconds("1e400").is_err() && seconds("0").is_err());
    }

    #[test]
    fn goal_is_three_finite_numbers() {
        let pose = goal("14.5,-4.5,90").unwrap();
        assert!(
            (pose.x_m, pose.y_m) == (14.5, -4.5)
                && (pose.heading_rad - std::f32::consts::FRAC_PI_2).abs() < 1.0e-6
        );
        assert!(coordinate("-3.5") == Ok(-3.5) && coordinate("nan").is_err() && coordinate("1,5").is_err());
        for text in ["", "1,2", "1,2,3,4", "1,2,x", "nan,1,2", "inf,1,2", "1;2;3", "1,2,,3"] {
            assert!(goal(text).is_err(), "{text}");
        }
    }

    #[test]
    fn panel_takes_names_of_this_computer() {
        let address = panel_address("localhost:8085").unwrap();
        assert!(address.ip().is_loopback() && address.port() == 8_085);
        assert_eq!(panel_address("[::1]:80").unwrap().port(), 80);
        assert!(panel_address("8080").is_err());
    }
}
