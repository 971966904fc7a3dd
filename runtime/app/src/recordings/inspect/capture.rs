//! Captures of the network.

use std::collections::BTreeMap;
use std::path::Path;

use floorguard_drivers::velodyne::{ClosedSector, Decoder, Model, ModelChoice};
use floorguard_host::words::counted;
use floorguard_recording::capture::{Capture, LIDAR_DATA_PORT, is_scanner_datagram, settle_model};
use floorguard_types::time::Stamp;

use super::page::{Page, Stream};
use super::timeline::Timeline;

/// A capture, to its end or its cut.
///
/// # Errors
/// It cannot be opened.
pub fn page(file: &Path) -> anyhow::Result<Page> {
    let mut page = Page::new("a capture of the network");
    let mut ports = BTreeMap::<u16, (Timeline, usize, bool)>::new();
    let model = settle_model(file, ModelChoice::Auto);
    let mut decoder =
        Decoder::new(model.as_ref().map_or(ModelChoice::Auto, |model| ModelChoice::Fixed(*model)));
    let (mut refusal, mut odd_block) = (None, None);
    for datagram in Capture::open(file)? {
        let datagram = match datagram {
            Ok(datagram) => datagram,
            Err(error) => {
                page.faults.push(error.to_string());
                break;
            }
        };
        let (timeline, bytes, is_scanner) = ports.entry(datagram.destination_port).or_default();
        timeline.add(datagram.captured_us);
        *bytes = datagram.payload.len();
        *is_scanner |= is_scanner_datagram(&datagram.payload);
        if datagram.destination_port == LIDAR_DATA_PORT {
            let decoded = decoder.decode(&datagram.payload, Stamp::from_micros(datagram.captured_us));
            refusal = decoded.err().or(refusal);
            odd_block = decoder.odd_block().or(odd_block);
        }
    }
    let has_scanner = ports.values().any(|(.., is_scanner)| *is_scanner);
    for (port, (timeline, bytes, is_scanner)) in &ports {
        let kind = match *port {
            _ if *is_scanner => "microScan3 data",
            LIDAR_DATA_PORT => "lidar data",
            8_308 => "lidar position",
            _ => "datagrams",
        };
        let is_lidar = *port == LIDAR_DATA_PORT;
        let closed_s = decoder.closed_sector().filter(|_| is_lidar).map_or(0.0, closed_s);
        let mut stream = Stream::with_pauses(format!("port {port}"), kind, (timeline, closed_s));
        stream.fields.push(format!("{bytes} bytes in the last"));
        if is_lidar {
            let refusals = [refusal.map(|error| error.to_string()), odd_block.map(|error| error.to_string())];
            lidar(&mut stream, &decoder, refusals);
        }
        page.streams.push(stream);
    }
    match model {
        Ok(model) => {
            page.commands.push("floorguard replay: people in its sweeps".to_owned());
            page.commands.push("floorguard decode --csv: every return".to_owned());
            page.commands.push("floorguard map3d: a map of the place in space".to_owned());
            if matches!(model, Model::Vlp16) {
                page.commands
                    .push("cargo xtask firmware --replay: the same on the emulated board".to_owned());
            }
        }
        Err(_) if has_scanner => {}
        Err(error) => page.faults.push(error.to_string()),
    }
    if has_scanner {
        page.commands.push("floorguard replay: legs and people in the scans of the microScan3".to_owned());
    }
    Ok(page)
}

/// For how long nothing comes out of a closed sector at most, seconds: a lidar turns five times a second or faster.
fn closed_s(closed: ClosedSector) -> f64 {
    f64::from(closed.width_cdeg()) / 36_000.0 * 0.2 + 0.01
}

fn lidar(stream: &mut Stream, decoder: &Decoder, [refusal, odd_block]: [Option<String>; 2]) {
    let counters = decoder.counters();
    if let Some(model) = decoder.model() {
        stream.fields.push(model.name().to_owned());
    }
    if let Some(closed) = decoder.closed_sector() {
        stream.fields.push(format!("a field of view is set: {closed}"));
    }
    if let Some(error) = refusal {
        stream.faults.push(format!("{} packets refused, the last: {error}", counters.refused));
    }
    if counters.lost > 0 {
        stream.faults.push(format!("{} packets lost", counters.lost));
    }
    // One that lies alone beside a closed sector, before that is known, is left out without a fault.
    if let Some(error) = odd_block {
        let left_out = counted(u64::from(counters.odd_blocks), "block");
        stream.faults.push(format!("{left_out} left out, the last: {error}"));
    }
    if decoder.clock_restarts() > 0 {
        stream.faults.push(format!("the lidar's clock was set {} times", decoder.clock_restarts()));
    }
}
