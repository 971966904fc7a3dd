//! Captures of the network.

use std::collections::BTreeMap;
use std::path::Path;

use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice};
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
    let mut refusal = None;
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
        let mut stream = Stream::new(format!("port {port}"), kind, timeline);
        stream.fields.push(format!("{bytes} bytes in the last"));
        if *port == LIDAR_DATA_PORT {
            lidar(&mut stream, &decoder, refusal.map(|error| error.to_string()));
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

fn lidar(stream: &mut Stream, decoder: &Decoder, refusal: Option<String>) {
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
    if counters.odd_blocks > 0 {
        stream.faults.push(format!("{} blocks with an azimuth above 36000", counters.odd_blocks));
    }
    if decoder.clock_restarts() > 0 {
        stream.faults.push(format!("the lidar's clock was set {} times", decoder.clock_restarts()));
    }
}
