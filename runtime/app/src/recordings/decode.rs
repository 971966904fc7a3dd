//! `floorguard decode`: every return of a lidar capture, or every sample of an inertial sensor, as the driver sees it.

use std::io::{BufWriter, Write};

use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice, Packet, Return, Returns, ReturnsOf};

use floorguard_types::time::Stamp;

use super::arguments::{DecodeArguments, ModelArgument};
use super::decode_can::decode_can;
use super::decode_inertial::{decode_inertial, decode_vectornav};
use super::inspect::{inertial, is_candump, vectornav};
use floorguard_host::packing::beginning;
use floorguard_recording::capture::{Capture, CaptureError, CaptureNotes, LIDAR_DATA_PORT, settle_model};

/// So much of a file tells whether it is an inertial sensor's line.
const INERTIAL_BYTES: u64 = 16_384;

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

/// Runs the command.
///
/// # Errors
/// Bad input; what came before it has been printed.
pub fn run(arguments: &DecodeArguments) -> anyhow::Result<()> {
    match decode_to(arguments, BufWriter::new(std::io::stdout().lock())) {
        // The reader of our output has closed it, as `head` does.
        Err(error) if is_broken_pipe(&error) => Ok(()),
        other => other,
    }
}

/// The same, with the machine output to `out`.
///
/// # Errors
/// Bad input, or `out` takes no more.
pub fn decode_to(arguments: &DecodeArguments, out: impl Write) -> anyhow::Result<()> {
    let begins = beginning(&arguments.file, INERTIAL_BYTES).unwrap_or_default();
    if inertial(&begins).is_some() {
        return decode_inertial(&arguments.file, arguments.csv, out);
    }
    if vectornav(&begins).is_some() {
        return decode_vectornav(&arguments.file, arguments.csv, out);
    }
    if is_candump(&begins) {
        return decode_can(&arguments.file, arguments.csv, out);
    }
    let model = settle_model(&arguments.file, arguments.model.choice())?;
    let mut printer = Printer {
        returns: Returns::new(model),
        decoder: Decoder::new(ModelChoice::Fixed(model)),
        csv: arguments.csv,
        out,
        totals: Totals::default(),
    };
    printer.print(&arguments.file)
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.downcast_ref::<std::io::Error>().is_some_and(|cause| cause.kind() == std::io::ErrorKind::BrokenPipe)
}

/// What standard error tells of a packet, a revolution or the whole file.
#[derive(Clone, Copy, Default)]
struct Sums {
    returns: u64,
    distance_raw: u64,
    reflectivity: u64,
}

impl Sums {
    fn add(&mut self, each: &Return) {
        self.returns += 1;
        self.distance_raw += u64::from(each.distance_raw);
        self.reflectivity += u64::from(each.reflectivity);
    }
}

impl std::fmt::Display for Sums {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { returns, distance_raw, reflectivity } = self;
        write!(f, "{returns} returns, sum of raw distances {distance_raw}, of reflectivities {reflectivity}")
    }
}

#[derive(Default)]
struct Totals {
    packets: u64,
    refused: u64,
    odd_blocks: u64,
    file: Sums,
    revolutions: u64,
    revolution: Sums,
    last_azimuth: Option<u16>,
}

impl Totals {
    /// A revolution starts at the first block whose azimuth falls by more than 10°: of a lidar that is set to a field of
    /// view it falls by little.
    fn enter_block(&mut self, azimuth_cdeg: u16) {
        if azimuth_cdeg >= 36_000 {
            return;
        }
        if self.last_azimuth.is_some_and(|last| last > azimuth_cdeg && last - azimuth_cdeg > 1_000) {
            self.end_revolution();
        }
        self.last_azimuth = Some(azimuth_cdeg);
    }

    fn end_revolution(&mut self) {
        self.revolutions += 1;
        say!("revolution {}: {}", self.revolutions, self.revolution);
        self.revolution = Sums::default();
    }
}

struct Printer<W> {
    returns: Returns,
    /// Knows from packet to packet what is closed.
    decoder: Decoder,
    csv: bool,
    out: W,
    totals: Totals,
}

impl<W: Write> Printer<W> {
    fn print(&mut self, file: &std::path::Path) -> anyhow::Result<()> {
        if self.csv {
            writeln!(self.out, "time_us,laser,azimuth_cdeg,distance_raw,reflectivity,x_m,y_m,z_m")?;
        }
        let mut ended: Option<CaptureError> = None;
        let mut capture = Capture::open(file)?;
        for datagram in &mut capture {
            match datagram {
                Ok(datagram) if datagram.destination_port == LIDAR_DATA_PORT => {
                    let arrival = Stamp::from_micros(datagram.captured_us);
                    let _ = self.decoder.decode(&datagram.payload, arrival);
                    self.packet(&datagram.payload)?
                }
                Ok(_) => {}
                Err(error) => ended = Some(error),
            }
        }
        self.out.flush()?;
        if self.totals.last_azimuth.is_some() {
            self.totals.end_revolution();
        }
        let Totals { packets, refused, odd_blocks, file, revolutions, .. } = &self.totals;
        let CaptureNotes { fragments, other, .. } = capture.notes();
        if let Some(closed) = self.decoder.closed_sector() {
            say!("the lidar is set to a field of view: {closed}");
        }
        if *odd_blocks > 0 {
            say!("{odd_blocks} blocks left out: azimuth above 36000 cdeg");
        }
        say!(
            "{}: {packets} packets, {refused} refused, {revolutions} revolutions (the first and the last may be \
             parts), {file}; {fragments} IP fragments and {other} other frames skipped",
            self.returns.model().name(),
        );
        ended.map_or(Ok(()), |error| Err(error.into()))
    }

    fn packet(&mut self, payload: &[u8]) -> anyhow::Result<()> {
        let totals = &mut self.totals;
        totals.packets += 1;
        let packet = match Packet::new_checked(payload) {
            Ok(packet) => packet,
            Err(error) => {
                totals.refused += 1;
                say!("packet {}: {error}", totals.packets);
                return Ok(());
            }
        };
        for error in packet.odd_blocks() {
            totals.odd_blocks += 1;
            say!("packet {}: {error}", totals.packets);
        }
        let mut sums = Sums::default();
        let mut failed = Ok(());
        let mut azimuths = packet.azimuths().into_iter();
        let mut entered = 0;
        self.returns.for_each(&packet, ReturnsOf::DistinctEchoes, |each| {
            // Blocks without a return are entered with the next one that has some.
            let entering = usize::from(each.block) + 1;
            azimuths.by_ref().take(entering - entered).for_each(|azimuth| totals.enter_block(azimuth));
            entered = entering;
            totals.revolution.add(&each);
            sums.add(&each);
            if self.csv && failed.is_ok() {
                failed = write_row(&mut self.out, packet.stamp_us(), &each);
            }
        });
        azimuths.for_each(|azimuth| totals.enter_block(azimuth));
        failed?;
        totals.file.returns += sums.returns;
        totals.file.distance_raw += sums.distance_raw;
        totals.file.reflectivity += sums.reflectivity;
        say!("packet {} at {} us: {sums}", totals.packets, packet.stamp_us());
        Ok(())
    }
}

/// One return: the sensor's time in its hour, wire values, and metres in robot axes.
fn write_row(out: &mut impl Write, stamp_us: u32, each: &Return) -> std::io::Result<()> {
    let time_us = f64::from(stamp_us) + f64::from(each.offset_ns) / 1_000.0;
    let Return { laser, azimuth_cdeg, distance_raw, reflectivity, point_in_sensor: point, .. } = each;
    let (x_m, y_m, z_m) = (point.x_m, point.y_m, point.z_m);
    writeln!(
        out,
        "{time_us:.3},{laser},{azimuth_cdeg},{distance_raw},{reflectivity},{x_m:.6},{y_m:.6},{z_m:.6}"
    )
}
