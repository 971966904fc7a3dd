//! Applies faults to events.

use std::collections::BTreeMap;

use floorguard_core::random::Pcg32;

use super::{FaultKind, FaultSpec};
use crate::simulation::{Payload, Stream, WireEvent};

struct Active {
    spec: FaultSpec,
    lost_in_burst: u32,
    first: Option<Payload>,
    held: Option<WireEvent>,
}

/// Stands between a simulation and its listener; events leave in the order of their time.
pub struct FaultLayer {
    faults: Vec<Active>,
    random: Pcg32,
    late: BTreeMap<(u64, u64), WireEvent>,
    sequence: u64,
}

impl FaultLayer {
    /// With these faults; the same seed chooses the same messages.
    #[must_use]
    pub fn new(specs: &[FaultSpec], seed: u64) -> Self {
        let active = |spec: &FaultSpec| Active { spec: *spec, lost_in_burst: 0, first: None, held: None };
        Self {
            faults: specs.iter().map(active).collect(),
            random: Pcg32::new(seed, 31),
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
                if event.stream == fault.spec.stream && fault.spec.applies(now_us) {
                    spoil(fault, &mut self.random, event, &mut next);
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

fn spoil(fault: &mut Active, random: &mut Pcg32, mut event: WireEvent, out: &mut Vec<WireEvent>) {
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
        FaultKind::Stuck => event.payload = fault.first.get_or_insert(event.payload).clone(),
        FaultKind::Silent => return,
        FaultKind::Flap(period_us) if (event.at_us / (period_us / 2)) % 2 == 1 => return,
        FaultKind::Blind(degrees) => blind(&mut event, degrees),
        _ => {}
    }
    out.push(event);
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
    let at = random.below(bytes.len() as u32 * 8);
    if let Some(byte) = bytes.get_mut((at / 8) as usize) {
        *byte ^= 1 << (at % 8);
    }
}

/// Dirt on the lidar's window: no returns from half the angle on either side of azimuth 0.
fn blind(event: &mut WireEvent, degrees: f32) {
    let (Stream::LidarData, Payload::Bytes(bytes)) = (event.stream, &mut event.payload) else { return };
    let half_cdeg = (degrees * 50.0) as u16;
    for block in bytes.chunks_exact_mut(100).take(12) {
        let azimuth = u16::from_le_bytes([block[2], block[3]]);
        if azimuth.min(36_000_u16.saturating_sub(azimuth)) <= half_cdeg {
            block[4..].fill(0);
        }
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
