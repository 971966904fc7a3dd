//! The bytes of a VectorNav's line, known by right checksums.

use floorguard_drivers::vectornav::{LineReceiver, Measurement, Message};
use floorguard_types::time::Stamp;

use super::page::{Page, Stream};
use super::timeline::Timeline;

/// So many right checksums make no accident.
const RIGHT_MIN: u32 = 2;

/// A VectorNav, if it is one.
pub fn vectornav(bytes: &[u8]) -> Option<Page> {
    let mut receiver = LineReceiver::default();
    let (mut timeline, mut infinite, mut saturated, mut sentences) =
        (Timeline::default(), 0_u64, 0_u64, 0_u64);
    for piece in bytes.chunks(256) {
        receiver.push(piece, Stamp::ZERO, |message| match message {
            Message::Frame(payload) => match Measurement::decode(payload) {
                Ok(measured) => {
                    timeline.add(measured.since_start_ns / 1_000);
                    saturated += u64::from(measured.is_saturated());
                }
                Err(_) => infinite += 1,
            },
            Message::Sentence(words) => sentences += u64::from(words.starts_with(b"VN")),
        });
    }
    let counters = receiver.counters();
    if counters.frames < RIGHT_MIN && sentences < u64::from(RIGHT_MIN) {
        return None;
    }
    let mut page = Page::new("the bytes of an inertial sensor's line (VectorNav)");
    let mut stream = Stream::new("binary frames", "inertial samples", &timeline);
    stream.fields.push("time, rate of turn, acceleration, saturation".to_owned());
    let faults = [(infinite, "with infinite numbers"), (saturated, "with a saturated axis")];
    stream
        .faults
        .extend(faults.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")));
    page.streams.push(stream);
    page.streams.push(Stream { count: sentences, ..Stream::new("sentences", "text", &Timeline::default()) });
    if counters.checksum_failures > 0 {
        page.faults.push(format!("{} with a wrong checksum", counters.checksum_failures));
    }
    page.commands.push("floorguard decode --csv: every sample as a row".to_owned());
    Some(page)
}
