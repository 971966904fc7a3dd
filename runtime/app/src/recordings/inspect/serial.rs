//! The bytes of a serial line: an MTi's Xbus frames, a VectorNav's or an S300's telegrams, known by right checksums.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use floorguard_drivers::s300::{Configuration, Event, Receiver};
use floorguard_drivers::xsens::{FrameReceiver, Measurement};
use floorguard_host::packing::unpacked;
use floorguard_types::time::Stamp;

use super::page::{Page, Stream};
use super::timeline::Timeline;
use super::vectornav::vectornav;
use floorguard_host::outcome::BadInput;

/// So many right checksums make no accident.
const RIGHT_MIN: u64 = 2;
/// A line of an hour at 500 kBd fits.
const BYTES_MAX: u64 = 256 << 20;
/// An S300 sends a scan every 40 ms.
const SCAN_US: u64 = 40_000;

/// The page of bytes, if they are of a kind.
type PageOf = fn(&[u8]) -> Option<Page>;

/// The page, if the bytes are one of the three.
///
/// # Errors
/// It cannot be read.
pub fn page(file: &Path, begins: &[u8]) -> anyhow::Result<Option<Page>> {
    let kinds: [PageOf; 3] = [inertial, vectornav, scanner];
    let Some(kind) = kinds.into_iter().find(|kind| kind(begins).is_some()) else { return Ok(None) };
    let bad = |error: std::io::Error| BadInput(format!("{}: {error}", file.display()));
    let source = File::open(file).and_then(unpacked).map_err(bad)?;
    let mut bytes = Vec::new();
    source.take(BYTES_MAX).read_to_end(&mut bytes).map_err(bad)?;
    Ok(kind(&bytes))
}

/// An MTi.
pub fn inertial(bytes: &[u8]) -> Option<Page> {
    let mut receiver = FrameReceiver::new();
    let mut messages = BTreeMap::<u8, u64>::new();
    let (mut timeline, mut good, mut refusal) = (Timeline::default(), 0_u64, None);
    let mut fields = BTreeMap::<&str, u64>::new();
    for piece in bytes.chunks(256) {
        receiver.push(piece, Stamp::ZERO, |message, _| {
            *messages.entry(message.id).or_default() += 1;
            if message.id != 0x36 {
                return;
            }
            match Measurement::decode(message.data) {
                Ok(measured) => {
                    good += 1;
                    // Tenths of a millisecond.
                    if let Some(fine) = measured.sample_time_fine {
                        timeline.add(u64::from(fine) * 100);
                    }
                    let present = [
                        ("sample time", measured.sample_time_fine.is_some()),
                        ("packet counter", measured.packet_counter.is_some()),
                        ("acceleration", measured.acceleration_mps2.is_some()),
                        ("rate of turn", measured.rate_of_turn_radps.is_some()),
                        ("orientation", measured.quaternion.is_some() || measured.euler_deg.is_some()),
                        ("status", measured.status.is_some()),
                    ];
                    present
                        .iter()
                        .filter(|(_, is)| *is)
                        .for_each(|(name, _)| *fields.entry(name).or_default() += 1);
                }
                Err(error) => refusal = Some(format!("{error:?}")),
            }
        });
    }
    let all: u64 = messages.values().sum();
    if all < RIGHT_MIN {
        return None;
    }
    let mut page = Page::new("the bytes of an inertial sensor's line (Xsens MTi, Xbus)");
    let mut stream = Stream::new("MTData2", "inertial samples", &timeline);
    stream.count = messages.get(&0x36).copied().unwrap_or(0);
    stream.fields = fields.iter().map(|(name, count)| format!("{name} in {count}")).collect();
    if timeline.count() == 0 && good > 0 {
        stream.faults.push("no sample times: rates cannot be judged".to_owned());
    }
    if let Some(error) = refusal {
        stream.faults.push(format!("{} cannot be used, the last: {error}", stream.count - good));
    }
    page.streams.push(stream);
    for (id, count) in messages.iter().filter(|(id, _)| **id != 0x36) {
        page.streams.push(Stream {
            count: *count,
            ..Stream::new(format!("{id:02X}h"), "Xbus message", &Timeline::default())
        });
    }
    let counters = receiver.counters();
    if counters.checksum_failures > 0 {
        page.faults.push(format!("{} frames with a wrong checksum", counters.checksum_failures));
    }
    page.commands.push("floorguard decode --csv: every sample as a row".to_owned());
    Some(page)
}

/// An S300.
pub fn scanner(bytes: &[u8]) -> Option<Page> {
    let mut receiver = Box::new(Receiver::new(Configuration::default()));
    let (mut timeline, mut refusal, mut stand_by) = (Timeline::default(), None, 0_u64);
    let mut arrival_us = 1_000_000;
    for piece in bytes.chunks(64) {
        arrival_us += 1_280;
        receiver.push(piece, Stamp::from_micros(arrival_us), |event| match event {
            Event::Scan(scan) => timeline.add(u64::from(scan.sequence) * SCAN_US),
            Event::StandBy { .. } => stand_by += 1,
            Event::Refused(error) => refusal = Some(error.to_string()),
        });
    }
    let counters = receiver.counters();
    if u64::from(counters.telegrams) < RIGHT_MIN {
        return None;
    }
    let mut page = Page::new("the bytes of a scanner's line (SICK S300)");
    let mut stream = Stream::new("telegrams", "scans", &timeline);
    stream.fields.push(format!("{} telegrams, {stand_by} in stand-by", counters.telegrams));
    if let Some(error) = refusal {
        stream.faults.push(error);
    }
    if counters.lost_scans > 0 {
        stream.faults.push(format!("{} scans missing", counters.lost_scans));
    }
    page.streams.push(stream);
    if counters.checksum_failures > 0 {
        page.faults.push(format!("{} telegrams with a wrong checksum", counters.checksum_failures));
    }
    page.commands.push("floorguard replay: legs and people in its scans".to_owned());
    Some(page)
}
