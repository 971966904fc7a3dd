//! `floorguard decode` of the bytes of an inertial sensor's line: every sample as a row.

use std::fs::File;
use std::io::{Read as _, Write};
use std::path::Path;

use floorguard_drivers::vectornav::{self, LineReceiver, Message};
use floorguard_drivers::xsens::{FrameReceiver, Measurement};
use floorguard_host::packing::unpacked;
use floorguard_types::time::Stamp;

use floorguard_host::outcome::BadInput;

/// Identifier of the message with measurements (book, Xsens MTi).
const MTDATA2: u8 = 0x36;
const HEADER: &str = "sample_time_us,packet_counter,acceleration_x_mps2,acceleration_y_mps2,acceleration_z_mps2,\
                      turn_x_radps,turn_y_radps,turn_z_radps,quaternion_w,quaternion_x,quaternion_y,quaternion_z,status";

/// Prints the samples of a file. What a sample does not have stays empty.
///
/// # Errors
/// The file cannot be read, or `out` takes no more.
pub fn decode_inertial(file: &Path, csv: bool, mut out: impl Write) -> anyhow::Result<()> {
    let bytes = bytes_of(file)?;
    if csv {
        writeln!(out, "{HEADER}")?;
    }
    let mut receiver = FrameReceiver::new();
    let (mut samples, mut refused, mut others) = (0_u64, 0_u64, 0_u64);
    let mut written = Ok(());
    for piece in bytes.chunks(256) {
        receiver.push(piece, Stamp::ZERO, |message, _| match Measurement::decode(message.data) {
            _ if message.id != MTDATA2 => others += 1,
            Ok(measured) => {
                samples += 1;
                if csv && written.is_ok() {
                    written = writeln!(out, "{}", row(&measured));
                }
            }
            Err(error) => {
                refused += 1;
                say!("sample {}: {error:?}", samples + refused);
            }
        });
    }
    written?;
    out.flush()?;
    let counters = receiver.counters();
    say!(
        "Xsens MTi: {samples} samples, {refused} refused, {others} other messages, {} frames with a wrong checksum",
        counters.checksum_failures
    );
    Ok(())
}

fn bytes_of(file: &Path) -> Result<Vec<u8>, BadInput> {
    let bad = |error: std::io::Error| BadInput(format!("{}: {error}", file.display()));
    let mut bytes = Vec::new();
    File::open(file).and_then(unpacked).and_then(|mut source| source.read_to_end(&mut bytes)).map_err(bad)?;
    Ok(bytes)
}

/// The same of a VectorNav, in the axes that it has itself: x forward, y right, z down. Its status is what is saturated.
///
/// # Errors
/// The file cannot be read, or `out` takes no more.
pub fn decode_vectornav(file: &Path, csv: bool, mut out: impl Write) -> anyhow::Result<()> {
    let bytes = bytes_of(file)?;
    if csv {
        writeln!(out, "{HEADER}")?;
    }
    let (mut receiver, mut samples, mut refused) = (LineReceiver::default(), 0_u64, 0_u64);
    let mut written = Ok(());
    for piece in bytes.chunks(256) {
        receiver.push(piece, Stamp::ZERO, |message| {
            let Message::Frame(payload) = message else { return };
            let Ok(measured) = vectornav::Measurement::decode(payload) else { return refused += 1 };
            samples += 1;
            if csv && written.is_ok() {
                let numbers = measured.linear_mps2.iter().chain(&measured.angular_radps);
                let numbers: Vec<String> = numbers.map(f32::to_string).collect();
                let time_us = measured.since_start_ns / 1_000;
                written = writeln!(out, "{time_us},,{},,,,,{}", numbers.join(","), measured.saturation);
            }
        });
    }
    written?;
    out.flush()?;
    let counters = receiver.counters();
    say!(
        "VectorNav: {samples} samples, {refused} refused, {} sentences, {} with a wrong checksum",
        counters.sentences,
        counters.checksum_failures
    );
    Ok(())
}

fn row(measured: &Measurement) -> String {
    fn one<T: std::fmt::Display>(value: Option<T>) -> String {
        value.map_or_else(String::new, |value| value.to_string())
    }
    fn each<const N: usize>(values: Option<[f64; N]>) -> String {
        (0..N)
            .map(|index| one(values.and_then(|values| values.get(index).copied())))
            .collect::<Vec<_>>()
            .join(",")
    }
    [
        one(measured.sample_time_fine.map(|ticks| u64::from(ticks) * 100)),
        one(measured.packet_counter),
        each(measured.acceleration_mps2),
        each(measured.rate_of_turn_radps),
        each(measured.quaternion),
        one(measured.status.map(|status| status.0)),
    ]
    .join(",")
}
