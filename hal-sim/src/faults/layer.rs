//! Applies faults to events.

use std::collections::{BTreeMap, VecDeque};

use floorguard_types::random::Pcg32;

use super::edit::{self, Edit};
use super::{FaultKind, FaultSpec};
use crate::wire::{Payload, Stream, WireEvent};

/// Where a telegram of the scanner tells its size, and what the size leaves out (rule B; book, SICK S300: Size field).
const TELEGRAM_SIZE: std::ops::Range<usize> = 6..8;
const TELEGRAM_EXCLUDED: usize = 8;

struct Active {
    spec: FaultSpec,
    lost_in_burst: u32,
    first: Option<Payload>,
    held: Option<WireEvent>,
    /// Messages seen.
    count: u32,
    /// Pieces of a telegram that is to be changed as a whole.
    telegram: Vec<u8>,
    /// What the bus carried, to be repeated later.
    past: VecDeque<WireEvent>,
}

/// Stands between a simulation and its listener; events leave in the order of their time.
pub struct FaultLayer {
    faults: Vec<Active>,
    output: bool,
    random: Pcg32,
    late: BTreeMap<(u64, u64), WireEvent>,
    sequence: u64,
}

impl FaultLayer {
    /// With these faults; the same seed chooses the same messages.
    #[must_use]
    pub fn new(specs: &[FaultSpec], seed: u64) -> Self {
        Self::between(specs, false, Pcg32::new(seed, 31))
    }

    /// The same on the way from the robot's computer to the bus.
    #[must_use]
    pub fn for_output(specs: &[FaultSpec], seed: u64) -> Self {
        Self::between(specs, true, Pcg32::new(seed, 32))
    }

    fn between(specs: &[FaultSpec], output: bool, random: Pcg32) -> Self {
        let active = |spec: &FaultSpec| Active {
            spec: *spec,
            lost_in_burst: 0,
            first: None,
            held: None,
            count: 0,
            telegram: Vec::new(),
            past: VecDeque::new(),
        };
        Self {
            faults: specs.iter().filter(|spec| spec.target.is_output() == output).map(active).collect(),
            output,
            random,
            late: BTreeMap::new(),
            sequence: 0,
        }
    }

    /// When the next late message is due; `u64::MAX` without one.
    #[must_use]
    pub fn next_event_us(&self) -> u64 {
        self.late.keys().next().map_or(u64::MAX, |(at_us, _)| *at_us)
    }

    /// Hands out late messages up to and including a moment.
    pub fn release(&mut self, at_us: u64, sink: &mut dyn FnMut(WireEvent)) {
        while let Some(entry) = self.late.first_entry().filter(|entry| entry.key().0 <= at_us) {
            sink(entry.remove());
        }
    }

    /// Takes an event of the simulation and hands out what is left of it.
    pub fn pass(&mut self, event: WireEvent, sink: &mut dyn FnMut(WireEvent)) {
        self.release(event.at_us, sink);
        let now_us = event.at_us;
        let mut events = vec![event];
        for fault in &mut self.faults {
            let mut next = Vec::new();
            for event in events {
                if fault.spec.target.concerns(&event, self.output) && fault.spec.applies(now_us) {
                    corrupt(fault, &mut self.random, event, &mut next);
                } else {
                    next.push(event);
                }
            }
            events = next;
        }
        for event in events {
            if event.at_us <= now_us {
                sink(event);
            } else {
                self.sequence += 1;
                self.late.insert((event.at_us, self.sequence), event);
            }
        }
    }
}

fn corrupt(fault: &mut Active, random: &mut Pcg32, mut event: WireEvent, out: &mut Vec<WireEvent>) {
    match fault.spec.kind {
        FaultKind::Drop(share) if random.bernoulli(share) => return,
        FaultKind::Burst(length) => {
            if fault.lost_in_burst == 0 && random.bernoulli(0.01) {
                fault.lost_in_burst = length;
            }
            if fault.lost_in_burst > 0 {
                fault.lost_in_burst -= 1;
                return;
            }
        }
        FaultKind::Delay(delay_us) => event.at_us += delay_us,
        FaultKind::Reorder(share) => {
            if let Some(mut held) = fault.held.take() {
                held.at_us = event.at_us;
                out.push(event);
                out.push(held);
            } else if random.bernoulli(share) {
                fault.held = Some(event);
            } else {
                out.push(event);
            }
            return;
        }
        FaultKind::Duplicate(share) if random.bernoulli(share) => out.push(event.clone()),
        FaultKind::Truncate(share) if random.bernoulli(share) => truncate(&mut event.payload),
        FaultKind::Flip(share) if random.bernoulli(share) => flip(&mut event.payload, random),
        FaultKind::SpinningTask => event.payload = fault.first.get_or_insert(event.payload).clone(),
        FaultKind::Silent => return,
        FaultKind::Flap(period_us) if (event.at_us / (period_us / 2)) % 2 == 1 => return,
        FaultKind::Reset => return,
        FaultKind::Rate(of) => {
            fault.count = fault.count.wrapping_add(1);
            if !fault.count.is_multiple_of(of) {
                return;
            }
        }
        FaultKind::Past(back_us) if event.stream == Stream::Can => repeat_past(fault, back_us, &mut event),
        _ => {
            if let Some((edit, share)) = edit_of(&fault.spec, event.at_us, random) {
                change(fault, (edit, share), random, (event, out));
                return;
            }
        }
    }
    out.push(event);
}

/// The change that a fault makes inside a message, and in which share of the messages.
fn edit_of(spec: &FaultSpec, at_us: u64, random: &mut Pcg32) -> Option<(Edit, f32)> {
    let since_us = at_us.saturating_sub(spec.from_us) as f32;
    Some(match spec.kind {
        FaultKind::Extreme(share) => (Edit::Extreme(random.below(12)), share),
        FaultKind::Stranger(share) => (Edit::Stranger, share),
        FaultKind::Past(back_us) => (Edit::Clock(-(back_us as i64)), 1.0),
        FaultKind::Future(ahead_us) => (Edit::Clock(ahead_us as i64), 1.0),
        FaultKind::Drift(share) => (Edit::Clock((since_us * share) as i64), 1.0),
        FaultKind::Blind(degrees) => (Edit::Blind(degrees), 1.0),
        _ => return None,
    })
}

/// Changes a message as a whole; those of the scanner come in pieces and are put together first.
fn change(
    fault: &mut Active,
    (edit, share): (Edit, f32),
    random: &mut Pcg32,
    (mut event, out): (WireEvent, &mut Vec<WireEvent>),
) {
    if let (Stream::ScannerSerial, Payload::Bytes(bytes)) = (event.stream, &event.payload) {
        fault.telegram.extend(bytes);
        let size = fault.telegram.get(TELEGRAM_SIZE).map_or(0, |size| u16::from_be_bytes([size[0], size[1]]));
        let whole = usize::from(size) * 2 + TELEGRAM_EXCLUDED;
        if !fault.telegram.starts_with(&[0; 6]) {
            // The fault began in the middle of a telegram.
            fault.telegram.clear();
        } else if fault.telegram.len() < whole {
            return;
        } else {
            event.payload = Payload::Bytes(std::mem::take(&mut fault.telegram));
        }
    }
    if random.bernoulli(share) {
        edit::apply(edit, &mut event);
    }
    out.push(event);
}

/// An earlier message of the same device, in place of the present one.
fn repeat_past(fault: &mut Active, back_us: u64, event: &mut WireEvent) {
    let id = |event: &WireEvent| match &event.payload {
        Payload::Frame(frame) => frame.id,
        Payload::Bytes(_) => u32::MAX,
    };
    fault.past.push_back(event.clone());
    while fault.past.front().is_some_and(|old| old.at_us + 2 * back_us < event.at_us) {
        fault.past.pop_front();
    }
    let old_enough = |old: &&WireEvent| id(old) == id(event) && old.at_us + back_us <= event.at_us;
    let same = |old: &&WireEvent| id(old) == id(event);
    // In the beginning: the oldest that there is.
    let old = fault.past.iter().rev().find(old_enough).or_else(|| fault.past.iter().find(same));
    if let Some(payload) = old.map(|old| old.payload.clone()) {
        event.payload = payload;
    }
}

fn truncate(payload: &mut Payload) {
    match payload {
        Payload::Bytes(bytes) => bytes.truncate(bytes.len() / 2),
        Payload::Frame(frame) => {
            frame.len /= 2;
            for byte in frame.data.iter_mut().skip(usize::from(frame.len)) {
                *byte = 0;
            }
        }
    }
}

fn flip(payload: &mut Payload, random: &mut Pcg32) {
    let bytes = match payload {
        Payload::Bytes(bytes) => bytes.as_mut_slice(),
        Payload::Frame(frame) => &mut frame.data[..usize::from(frame.len)],
    };
    let at = random.below((bytes.len() as u32 * 8).max(1));
    if let Some(byte) = bytes.get_mut((at / 8) as usize) {
        *byte ^= 1 << (at % 8);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(text: &str, count: u64) -> Vec<WireEvent> {
        let mut layer = FaultLayer::new(&[FaultSpec::parse(text).unwrap()], 7);
        let mut seen = Vec::new();
        for step in 0..count {
            let bytes = (step as u32).to_be_bytes().to_vec();
            let event = WireEvent::bytes(step * 1_000, Stream::ImuSerial, bytes);
            layer.pass(event, &mut |event| seen.push(event));
        }
        layer.release(u64::MAX, &mut |event| seen.push(event));
        assert!(seen.windows(2).all(|pair| pair[0].at_us <= pair[1].at_us), "{text}: out of order");
        seen
    }

    #[test]
    fn losses_have_their_share_and_their_time() {
        let kept = run("imu:drop=10%", 10_000).len();
        assert!((8_800..9_200).contains(&kept), "{kept}");
        assert_eq!(run("imu:silent,from=1s,to=2s", 3_000).len(), 2_000);
        assert_eq!(run("imu:flap=200ms", 1_000).len(), 500);
        assert_eq!(run("scanner:silent", 100).len(), 100, "another stream is untouched");
    }

    /// What of the real devices' messages reaches the listener under a fault, and without it.
    fn world(text: &str, stream: Stream) -> (Vec<WireEvent>, Vec<WireEvent>) {
        let scenario = crate::scenario::Scenario::named("empty").unwrap();
        let mut simulation = crate::simulation::Simulation::new(&scenario, 3).unwrap();
        let mut layer = FaultLayer::new(&[FaultSpec::parse(text).unwrap()], 7);
        let (mut plain, mut corrupted) = (Vec::new(), Vec::new());
        simulation.advance_to(900_000, &mut |event| {
            if event.stream == stream {
                plain.push(event.clone());
                layer.pass(event, &mut |event| corrupted.push(event));
            }
        });
        (plain, corrupted)
    }

    fn bytes(events: &[WireEvent]) -> Vec<u8> {
        let parts = events.iter().map(|event| match &event.payload {
            Payload::Bytes(bytes) => bytes.as_slice(),
            Payload::Frame(_) => &[],
        });
        parts.flatten().copied().collect()
    }

    #[test]
    fn scanner_telegrams_are_changed_as_a_whole() {
        for kind in ["extreme", "past=200ms", "future=200ms", "drift=10%", "stranger", "blind=90deg"] {
            let (plain, corrupted) = world(&format!("scanner:{kind}"), Stream::ScannerSerial);
            let (plain, corrupted) = (bytes(&plain), bytes(&corrupted));
            assert_eq!(plain.len(), corrupted.len(), "{kind}: nothing gets lost");
            // The clock of a drift has not gone wrong by a whole scan yet in the first ones.
            let pairs = plain.chunks_exact(1_108).zip(corrupted.chunks_exact(1_108));
            assert!(pairs.clone().any(|(a, b)| a != b), "{kind}: changed");
            for (before, after) in pairs {
                assert_eq!(before[..9], after[..9], "{kind}: the frame is kept");
                let mut sealed = after.to_vec();
                crate::wire::reseal_telegram(&mut sealed);
                assert_eq!(sealed, after, "{kind}: the checksum is right");
            }
        }
    }

    #[test]
    fn lidar_clock_and_value_faults_apply() {
        let clock = |event: &WireEvent| {
            let bytes = bytes(std::slice::from_ref(event));
            i64::from(u32::from_le_bytes([bytes[1200], bytes[1201], bytes[1202], bytes[1203]]))
        };
        for (kind, wanted_us) in [("past=30ms", -30_000_i64), ("future=30ms", 30_000), ("drift=1%", 8_999)] {
            let (plain, corrupted) = world(&format!("lidar:{kind}"), Stream::LidarData);
            let off_us = clock(corrupted.last().unwrap()) - clock(plain.last().unwrap());
            assert!((off_us - wanted_us).abs() < 20, "{kind}: {off_us}");
        }
        for kind in ["extreme", "stranger", "blind=120deg"] {
            let (plain, corrupted) = world(&format!("lidar:{kind}"), Stream::LidarData);
            assert!(plain.len() == corrupted.len() && plain != corrupted, "{kind}");
        }
        let (plain, corrupted) = world("lidar:rate=3", Stream::LidarData);
        assert_eq!(plain.len() / 3, corrupted.len());
    }

    #[test]
    fn bus_repeats_frames_and_swaps_identifiers() {
        let run = |text: &str| {
            let mut layer = FaultLayer::new(&[FaultSpec::parse(text).unwrap()], 7);
            let mut seen = Vec::new();
            for step in 0..100_u8 {
                let frame = crate::can::CanFrame::new(0x181 + u32::from(step % 2), &[step]);
                let at_us = u64::from(step) * 1_000;
                let event = WireEvent { at_us, stream: Stream::Can, payload: Payload::Frame(frame) };
                layer.pass(event, &mut |event| seen.push(event));
            }
            let frames = seen.into_iter().filter_map(|event| match event.payload {
                Payload::Frame(frame) => Some((frame.id, frame.data[0])),
                Payload::Bytes(_) => None,
            });
            frames.collect::<Vec<_>>()
        };
        assert_eq!(run("can:past=20ms")[98..], [(0x181, 78), (0x182, 79)]);
        assert_eq!(run("can:stranger")[98..], [(0x182, 98), (0x181, 99)]);
        assert_eq!(run("traction:silent").len(), 50);
        // Three of the four extreme bytes are at least 7Fh.
        let extreme = run("can:extreme=50%").iter().filter(|(_, byte)| *byte >= 0x7F).count();
        assert!((25..50).contains(&extreme), "{extreme}");
        assert_eq!(run("commands:silent").len(), 100, "the other direction is untouched");
    }

    #[test]
    fn messages_are_changed_moved_and_repeated() {
        assert!(run("imu:stuck", 50).iter().all(|event| event.payload == Payload::Bytes(vec![0; 4])));
        assert_eq!(run("imu:delay=20ms", 50).last().map(|event| event.at_us), Some(69_000));
        assert_eq!(run("imu:duplicate=100%", 50).len(), 100);
        let flipped = run("imu:flip=100%", 50);
        let distance = flipped.iter().enumerate().map(|(step, event)| match &event.payload {
            Payload::Bytes(bytes) => {
                (u32::from_be_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) ^ step as u32).count_ones()
            }
            Payload::Frame(_) => 99,
        });
        assert!(distance.eq(std::iter::repeat_n(1, 50)));
        assert_eq!(run("imu:reorder=30%", 1_000), run("imu:reorder=30%", 1_000), "same seed, same run");
    }
}
