//! Captures of the network.

use std::collections::BTreeMap;
use std::path::Path;

use floorguard_drivers::velodyne::{Decoder, Model, ModelChoice};
use floorguard_recording::capture::{Capture, LIDAR_DATA_PORT, settle_model};
use floorguard_types::time::Stamp;

use super::page::{Page, Stream};
use super::timeline::Timeline;

/// A capture, to its end or its cut.
///
/// # Errors
/// It cannot be opened.
pub fn page(file: &Path) -> anyhow::Result<Page> {
    let mut page = Page::new("a capture of the network");
    let mut ports = BTreeMap::<u16, (Timeline, usize)>::new();
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
        let (timeline, bytes) = ports.entry(datagram.destination_port).or_default();
        timeline.add(datagram.captured_us);
        *bytes = datagram.payload.len();
        if datagram.destination_port == LIDAR_DATA_PORT {
            let decoded = decoder.decode(&datagram.payload, Stamp::from_micros(datagram.captured_us));
            refusal = decoded.err().or(refusal);
        }
    }
    for (port, (timeline, bytes)) in &ports {
        let kind = match *port {
            LIDAR_DATA_PORT => "lidar data",
            8_308 => "lidar position",
            6_060 => "microScan3 data",
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
        Ok(Model::Vlp16 | Model::HiRes) => {
            page.commands.push("floorguard replay: people in its sweeps".to_owned());
            page.commands.push("floorguard decode --csv: every return".to_owned());
        }
        Ok(_) => page
            .commands
            .push("floorguard decode --csv: every return (people stages take 16 rings)".to_owned()),
        Err(error) => page.faults.push(error.to_string()),
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
