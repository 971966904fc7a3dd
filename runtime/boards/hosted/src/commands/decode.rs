//! `floorguard decode`: every return of a lidar capture, exactly as the driver sees it.

use std::io::{BufWriter, Write};

use floorguard_drivers::velodyne::{DecodeError, Decoder, Model, ModelChoice, Packet, Returns, ReturnsOf};

use super::arguments::{DecodeArguments, ModelArgument};
use super::exit::BadInput;
use crate::capture::{Capture, CaptureError, Datagram};

/// UDP port of lidar data.
pub const LIDAR_DATA_PORT: u16 = 2_368;
/// Packets looked at to tell an early VLP-16 from an HDL-32E.
const LOOK_AHEAD: usize = 50;

impl ModelArgument {
    /// As the decoder wants it.
    #[must_use]
    pub const fn choice(self) -> ModelChoice {
        match self {
            Self::Auto => ModelChoice::Auto,
            Self::Vlp16 => ModelChoice::Fixed(Model::Vlp16),
            Self::PuckHiRes => ModelChoice::Fixed(Model::HiRes),
            Self::Vlp32c => ModelChoice::Fixed(Model::Vlp32C),
            Self::Hdl32e => ModelChoice::Fixed(Model::Hdl32E),
        }
    }
}

/// Tells the model of a capture from its first packets, so that not even the first one is lost to the question.
///
/// # Errors
/// The file cannot be read, holds no lidar, or contradicts a model that was asked for.
pub fn settle_model(path: &std::path::Path, choice: ModelChoice) -> anyhow::Result<Model> {
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
        let arrival = floorguard_core::time::Stamp::from_micros(datagram.captured_us);
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

/// What standard error tells at the end.
#[derive(Default)]
struct Totals {
    packets: u64,
    refused: u64,
    returns: u64,
    revolutions: u64,
    revolution_returns: u64,
    last_azimuth: Option<u16>,
}

/// Runs the command.
///
/// # Errors
/// Bad input; what came before it has been printed.
pub fn run(arguments: &DecodeArguments) -> anyhow::Result<()> {
    let model = settle_model(&arguments.file, arguments.model.choice())?;
    let returns = Returns::new(model);
    let mut totals = Totals::default();
    let mut out = BufWriter::new(std::io::stdout().lock());
    if arguments.csv {
        writeln!(out, "time_us,laser,azimuth_cdeg,distance_raw,reflectivity,x_m,y_m,z_m")?;
    }
    let mut ended: Option<CaptureError> = None;
    for datagram in Capture::open(&arguments.file)? {
        match datagram {
            Ok(datagram) if datagram.destination_port == LIDAR_DATA_PORT => {
                print_packet(&datagram, &returns, arguments.csv, &mut totals, &mut out)?;
            }
            Ok(_) => {}
            Err(error) => ended = Some(error),
        }
    }
    out.flush()?;
    anstream::eprintln!(
        "{}: {} packets, {} refused, {} returns, {} revolutions",
        model.name(),
        totals.packets,
        totals.refused,
        totals.returns,
        totals.revolutions + u64::from(totals.revolution_returns > 0),
    );
    ended.map_or(Ok(()), |error| Err(error.into()))
}

fn print_packet(
    datagram: &Datagram,
    returns: &Returns,
    csv: bool,
    totals: &mut Totals,
    out: &mut impl Write,
) -> anyhow::Result<()> {
    totals.packets += 1;
    let packet = match Packet::new_checked(&datagram.payload) {
        Ok(packet) => packet,
        Err(error) => {
            totals.refused += 1;
            anstream::eprintln!("packet {}: {error}", totals.packets);
            return Ok(());
        }
    };
    for azimuth in packet.azimuths() {
        // A revolution starts at the first block whose azimuth falls by more than half a turn.
        if totals.last_azimuth.is_some_and(|last| last > azimuth && last - azimuth > 18_000) {
            totals.revolutions += 1;
            anstream::eprintln!("revolution {}: {} returns", totals.revolutions, totals.revolution_returns);
            totals.revolution_returns = 0;
        }
        totals.last_azimuth = Some(azimuth);
    }
    let mut count = 0;
    let mut failed = Ok(());
    returns.for_each(&packet, ReturnsOf::DistinctEchoes, |each| {
        count += 1;
        if csv && failed.is_ok() {
            let time_us = f64::from(packet.stamp_us()) + f64::from(each.offset_ns) / 1_000.0;
            let point = each.point_in_sensor;
            failed = writeln!(
                out,
                "{time_us:.3},{},{},{},{},{:.6},{:.6},{:.6}",
                each.laser,
                each.azimuth_cdeg,
                each.distance_raw,
                each.reflectivity,
                point.x_m,
                point.y_m,
                point.z_m
            );
        }
    });
    failed?;
    totals.returns += count;
    totals.revolution_returns += count;
    anstream::eprintln!("packet {}: {count} returns", totals.packets);
    Ok(())
}
