//! The operator's buttons for reset and start as bits of the safety controller's image: a robot without panel and terminal
//! can be started by them.
//!
//! A button acts when it is released (ISO 13849-1, 5.2.2), and only if it was seen released before it was pressed: one
//! that is stuck or tied down does nothing. The guard judges what it asks for, as from anywhere else.

use embassy_sync::blocking_mutex::raw::RawMutex;
use floorguard_drivers::can::CanFrame;
use floorguard_types::time::{Age, Stamp};

use crate::clock;
use crate::configuration::CanConfiguration;
use crate::io::CanBus;
use crate::shared::Shared;

/// Shorter is a bouncing contact, microseconds.
const PRESSED_MIN_US: u64 = 30_000;
/// Longer is a button that is stuck, microseconds.
const PRESSED_MAX_US: u64 = 5_000_000;
/// An image that is silent for longer tells nothing of what happened meanwhile, microseconds.
const SILENT_MAX_US: u64 = 500_000;
/// First identifier of the objects of an image; each further object lies this much higher (CiA 301, 7.3.5).
const OBJECT_IDS: u16 = 0x180;
const OBJECT_STEP: u16 = 0x100;
/// Bits of an object.
const OBJECT_BITS: u8 = 64;

/// One button.
#[derive(Clone, Copy, Debug)]
struct Button {
    bit: u8,
    seen_at: Option<Stamp>,
    /// It was seen released, so that pressing it counts.
    armed: bool,
    pressed_at: Option<Stamp>,
}

impl Button {
    const fn new(bit: u8) -> Self {
        Self { bit, seen_at: None, armed: false, pressed_at: None }
    }

    /// Takes in an object of the image; true when the button has just been released.
    fn take(&mut self, object: u16, payload: &[u8], now: Stamp) -> bool {
        if object != u16::from(self.bit / OBJECT_BITS) {
            return false;
        }
        let Some(byte) = payload.get(usize::from(self.bit % OBJECT_BITS / 8)) else { return false };
        let is_pressed = byte & 1_u8.wrapping_shl(u32::from(self.bit % 8)) != 0;
        let silent = self.seen_at.replace(now).is_none_or(|seen| !is_within(seen, (0, SILENT_MAX_US), now));
        if silent {
            (self.armed, self.pressed_at) = (false, None);
        }
        if is_pressed {
            if self.armed && self.pressed_at.is_none() {
                self.pressed_at = Some(now);
            }
            return false;
        }
        self.armed = true;
        let pressed = self.pressed_at.take();
        pressed.is_some_and(|at| is_within(at, (PRESSED_MIN_US, PRESSED_MAX_US), now))
    }
}

fn is_within(from: Stamp, (least_us, most_us): (u64, u64), now: Stamp) -> bool {
    matches!(from.age(now), Age::Past(us) if us >= least_us && us <= most_us)
}

/// A bus on which the buttons of a robot are heard, too.
pub struct BusWithButtons<'a, M: RawMutex, B> {
    bus: B,
    shared: &'a Shared<M>,
    inputs_node: u8,
    reset: Option<Button>,
    start: Option<Button>,
}

impl<'a, M: RawMutex, B> BusWithButtons<'a, M, B> {
    /// For the bits that a robot's file names; without any nothing is heard.
    pub fn new(bus: B, shared: &'a Shared<M>, can: &CanConfiguration) -> Self {
        let button = |bit: Option<u8>| bit.map(Button::new);
        Self {
            bus,
            shared,
            inputs_node: can.inputs_node,
            reset: button(can.buttons.reset_bit),
            start: button(can.buttons.start_bit),
        }
    }

    fn hear(&mut self, frame: &CanFrame) {
        let Some(id) = frame.standard_id().filter(|id| id & 0x7F == u16::from(self.inputs_node)) else {
            return;
        };
        let Some(above) = (id & !0x7F).checked_sub(OBJECT_IDS).filter(|above| above % OBJECT_STEP == 0)
        else {
            return;
        };
        let (object, now) = (above / OBJECT_STEP, clock::now());
        let released = |button: &mut Option<Button>| {
            button.as_mut().is_some_and(|button| button.take(object, frame.payload(), now))
        };
        if released(&mut self.reset) {
            self.shared.reset.signal(());
        }
        if released(&mut self.start) {
            self.shared.start.signal(());
        }
    }
}

impl<M: RawMutex, B: CanBus> CanBus for BusWithButtons<'_, M, B> {
    type Error = B::Error;

    async fn receive(&mut self) -> Result<CanFrame, Self::Error> {
        let frame = self.bus.receive().await?;
        self.hear(&frame);
        Ok(frame)
    }

    async fn send(&mut self, frame: &CanFrame) -> Result<(), Self::Error> {
        self.bus.send(frame).await
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Milliseconds, and whether the bit is set; gives the moments at which the button acted.
    fn acted(readings: &[(u64, bool)]) -> std::vec::Vec<u64> {
        let mut button = Button::new(64 + 9);
        let moments = readings.iter().filter(|(ms, set)| {
            let payload = [0, if *set { 2 } else { 0 }];
            button.take(1, &payload, Stamp::from_micros(ms * 1_000))
        });
        moments.map(|(ms, _)| *ms).collect()
    }

    #[test]
    fn button_acts_when_released() {
        assert_eq!(acted(&[(0, false), (100, true), (200, true), (300, false), (400, false)]), [300]);
        assert_eq!(acted(&[(0, false), (100, true), (110, false)]), [], "a bouncing contact");
    }

    #[test]
    fn stuck_button_does_nothing() {
        assert_eq!(acted(&[(0, true), (100, true), (200, false)]), [], "pressed since the start");
        let held: std::vec::Vec<_> = (1..60).map(|step| (step * 100, true)).collect();
        let held = [&[(0, false)], held.as_slice(), &[(6_000, false)]].concat();
        assert_eq!(acted(&held), [], "tied down for 5.9 s");
        assert_eq!(acted(&[(0, false), (100, true), (900, false)]), [], "silent meanwhile");
    }

    #[test]
    fn other_objects_are_not_the_button() {
        let mut button = Button::new(3);
        let at = |ms: u64| Stamp::from_micros(ms * 1_000);
        assert!(!button.take(0, &[0], at(0)) && !button.take(0, &[8], at(100)));
        assert!(!button.take(1, &[0], at(200)) && !button.take(0, &[], at(200)));
        assert!(button.take(0, &[0], at(300)));
    }
}
