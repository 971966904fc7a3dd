//! Which lidar made a capture.

use std::path::Path;

use floorguard_drivers::velodyne::{DecodeError, Decoder, Model, ModelChoice};
use floorguard_host::outcome::BadInput;
use floorguard_types::time::Stamp;

use super::reader::Capture;

/// UDP port of lidar data.
pub const LIDAR_DATA_PORT: u16 = 2_368;
/// Packets looked at to tell an early VLP-16 from an HDL-32E.
const LOOK_AHEAD: usize = 50;

/// Tells the model of a capture from its first packets, so that not even the first one is lost to the question.
///
/// # Errors
/// The file cannot be read, holds no lidar, or contradicts a model that was asked for.
pub fn settle_model(path: &Path, choice: ModelChoice) -> anyhow::Result<Model> {
    let mut decoder = Decoder::new(choice);
    let mut last_error = None;
    let mut seen = 0;
    for datagram in Capture::open(path)? {
        let datagram = match datagram {
            Ok(datagram) => datagram,
            // What is wrong with the file tells more than what is missing in it.
            Err(error) if seen == 0 => return Err(error.into()),
            Err(_) => break,
        };
        if datagram.destination_port != LIDAR_DATA_PORT {
            continue;
        }
        let arrival = Stamp::from_micros(datagram.captured_us);
        match decoder.decode(&datagram.payload, arrival) {
            Err(error @ DecodeError::WrongModel { .. }) => {
                return Err(BadInput(format!("{}: {error}", path.display())).into());
            }
            Err(error) => last_error = Some(error),
            Ok(_) => {}
        }
        seen += 1;
        if seen >= LOOK_AHEAD {
            break;
        }
    }
    decoder.model().ok_or_else(|| {
        let reason = last_error.map_or_else(
            || format!("no datagram to port {LIDAR_DATA_PORT} in it"),
            |error| format!("none of its first {seen} lidar packets can be decoded; the last: {error}"),
        );
        BadInput(format!("{}: {reason}", path.display())).into()
    })
}
