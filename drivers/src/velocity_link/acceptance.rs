//! Which requests count: of one sender, in order, in time, and until their deadline. Book, Velocity link: Acceptance.

use core::fmt;

use floorguard_types::geometry::Twist2;
use floorguard_types::time::{Age, Stamp};

use super::frame::FrameError;
use super::request::{StopDemand, VelocityRequest, field};

/// A sender that was silent for so long no longer holds the robot, microseconds: long enough that a swapped sender is
/// refused, short enough for a program that is started again.
const HOLD_US: u64 = 1_000_000;
/// After such a silence nothing is known of the sender's clock any more, microseconds.
const FORGET_US: u64 = 10_000_000;
/// Clocks of two computers drift apart by less than one part in so many.
const DRIFT_DIVISOR: u64 = 5_000;

/// Who is listened to, and for how long a request may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AcceptanceRules {
    /// The only sender; none: the first that sends holds the robot until it is silent.
    pub sender: Option<u32>,
    /// The longest deadline, microseconds: a longer one is shortened to it.
    pub deadline_max_us: u64,
}

/// Where and when a frame arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arrival {
    /// The carrier's number for the other end: another address is another sender.
    pub peer: u64,
    /// On the robot's clock.
    pub at: Stamp,
}

/// Why a request does not count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// Not a request at all, or one that cannot be driven.
    Frame(FrameError),
    /// Another sender holds the robot, or only another one is listened to.
    OtherSender {
        /// Who sent.
        found: u32,
    },
    /// The same sequence as the one before.
    Repeated {
        /// It.
        sequence: u32,
    },
    /// Sent before one that is here already.
    OutOfOrder {
        /// Its sequence.
        found: u32,
        /// The newest one.
        newest: u32,
    },
    /// Longer on its way than its deadline allows.
    Late {
        /// Longer than the fastest one, microseconds.
        late_us: u64,
    },
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frame(error) => error.fmt(f),
            Self::OtherSender { found } => write!(f, "sender {found} is not the one that is listened to"),
            Self::Repeated { sequence } => write!(f, "sequence {sequence} came twice"),
            Self::OutOfOrder { found, newest } => write!(f, "sequence {found} came after {newest}"),
            Self::Late { late_us } => write!(f, "{} ms late", late_us / 1_000),
        }
    }
}

impl core::error::Error for Refusal {}

/// What became of the requests; saturating.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LinkCounters {
    /// Accepted.
    pub accepted: u32,
    /// Of another length, start or checksum, or with a field outside of its range.
    pub damaged: u32,
    /// With a velocity that is infinite or not a number.
    pub non_finite: u32,
    /// Longer on their way than their deadline allows.
    pub late: u32,
    /// Sent before one that was here already.
    pub out_of_order: u32,
    /// The same sequence twice.
    pub repeated: u32,
    /// Of another sender.
    pub other_sender: u32,
}

/// A request that counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accepted {
    /// What is asked for.
    pub twist: Twist2,
    /// When it was sent, as far as the clocks show: its arrival less what it took longer than the fastest one.
    pub stamp: Stamp,
    /// From then on it is zero.
    pub expires: Stamp,
}

/// The newest accepted request and its sender.
#[derive(Clone, Copy, Debug)]
struct Held {
    sender: u32,
    peer: u64,
    sequence: u32,
    sent_ms: u32,
    arrived: Stamp,
    /// How much longer it took than the fastest one, microseconds.
    delay_us: u64,
    accepted: Accepted,
}

/// Judges requests. What it holds is the newest accepted one.
///
/// ```
/// use floorguard_drivers::velocity_link::{Acceptance, AcceptanceRules, Arrival, Refusal, StopDemand, VelocityRequest};
/// use floorguard_types::geometry::Twist2;
/// use floorguard_types::time::Stamp;
///
/// let mut acceptance = Acceptance::new(AcceptanceRules { sender: None, deadline_max_us: 200_000 });
/// let twist = Twist2 { linear_mps: 0.5, angular_radps: 0.0 };
/// let mut request =
///     VelocityRequest { sender: 7, sequence: 1, sent_ms: 0, deadline_ms: 100, stop: StopDemand::None, twist };
/// let at = |ms: u64| Arrival { peer: 0, at: Stamp::from_micros(ms * 1_000) };
/// assert!(acceptance.offer(&request.encode(), at(10)).is_ok());
/// assert_eq!(acceptance.offer(&request.encode(), at(20)), Err(Refusal::Repeated { sequence: 1 }));
/// request.sender = 8;
/// assert_eq!(acceptance.offer(&request.encode(), at(30)), Err(Refusal::OtherSender { found: 8 }));
/// assert_eq!(acceptance.requested(Stamp::from_micros(109_999)), twist);
/// assert_eq!(acceptance.requested(Stamp::from_micros(110_000)), Twist2::ZERO, "the deadline has passed");
/// ```
#[derive(Clone, Debug)]
pub struct Acceptance {
    rules: AcceptanceRules,
    held: Option<Held>,
    counters: LinkCounters,
}

impl Acceptance {
    /// Has heard of no sender.
    #[must_use]
    pub const fn new(rules: AcceptanceRules) -> Self {
        let counters = LinkCounters {
            accepted: 0,
            damaged: 0,
            non_finite: 0,
            late: 0,
            out_of_order: 0,
            repeated: 0,
            other_sender: 0,
        };
        Self { rules, held: None, counters }
    }

    /// What became of the requests.
    #[must_use]
    pub const fn counters(&self) -> LinkCounters {
        self.counters
    }

    /// Judges a frame.
    ///
    /// # Errors
    /// Why it does not count; that is counted.
    pub fn offer(&mut self, bytes: &[u8], arrival: Arrival) -> Result<Accepted, Refusal> {
        let judged = VelocityRequest::decode(bytes).map_err(Refusal::Frame);
        let judged = judged.and_then(|request| self.judge(&request, arrival));
        let counters = &mut self.counters;
        let count = match judged {
            Ok(_) => &mut counters.accepted,
            Err(Refusal::Frame(FrameError::NonFinite)) => &mut counters.non_finite,
            Err(Refusal::Frame(_)) => &mut counters.damaged,
            Err(Refusal::OtherSender { .. }) => &mut counters.other_sender,
            Err(Refusal::Repeated { .. }) => &mut counters.repeated,
            Err(Refusal::OutOfOrder { .. }) => &mut counters.out_of_order,
            Err(Refusal::Late { .. }) => &mut counters.late,
        };
        *count = count.saturating_add(1);
        judged
    }

    /// What is asked for now; zero before the first request and from the deadline of the newest one on.
    #[must_use]
    pub fn requested(&self, now: Stamp) -> Twist2 {
        let holds = |held: &&Held| held.arrived <= now && now < held.accepted.expires;
        self.held.as_ref().filter(holds).map_or(Twist2::ZERO, |held| held.accepted.twist)
    }

    /// When the newest request is zero.
    #[must_use]
    pub fn expires(&self) -> Option<Stamp> {
        self.held.map(|held| held.accepted.expires)
    }

    /// The sender that holds the robot.
    #[must_use]
    pub fn holder(&self, now: Stamp) -> Option<u32> {
        self.holding(now).map(|held| held.sender)
    }

    /// Sequence of the newest accepted request.
    #[must_use]
    pub fn acknowledged(&self) -> Option<u32> {
        self.held.map(|held| held.sequence)
    }

    /// The sender that was accepted within the last second.
    fn holding(&self, now: Stamp) -> Option<Held> {
        self.held.filter(|held| silent_us(held, now) < HOLD_US)
    }

    fn judge(&mut self, request: &VelocityRequest, arrival: Arrival) -> Result<Accepted, Refusal> {
        let VelocityRequest { sender, sequence, sent_ms, .. } = *request;
        if request.stop != StopDemand::None {
            let found = u32::from(request.stop.code());
            return Err(Refusal::Frame(FrameError::Field { offset: field::STOP, found }));
        }
        let is_other = |held: &Held| held.sender != sender || held.peer != arrival.peer;
        if self.rules.sender.is_some_and(|only| only != sender)
            || self.holding(arrival.at).is_some_and(|held| is_other(&held))
        {
            return Err(Refusal::OtherSender { found: sender });
        }
        let mut delay_us = 0;
        if let Some(held) = self.held.filter(|held| !is_other(held)) {
            let step = sequence.wrapping_sub(held.sequence);
            let is_newer = (1..1 << 31).contains(&step);
            let silent_us = silent_us(&held, arrival.at);
            if silent_us < HOLD_US && step == 0 {
                return Err(Refusal::Repeated { sequence });
            }
            if silent_us < HOLD_US && !is_newer {
                return Err(Refusal::OutOfOrder { found: sequence, newest: held.sequence });
            }
            // Who goes on counting after a silence has the same clock: a burst of old requests is late all the same.
            if is_newer && silent_us < FORGET_US {
                delay_us = delay_after_us(&held, sent_ms, arrival.at);
            }
        }
        let deadline_us =
            u64::from(request.deadline_ms).saturating_mul(1_000).min(self.rules.deadline_max_us);
        if delay_us >= deadline_us {
            return Err(Refusal::Late { late_us: delay_us });
        }
        let stamp = arrival.at.minus_micros(delay_us);
        let accepted = Accepted { twist: request.twist, stamp, expires: stamp.plus_micros(deadline_us) };
        let (peer, arrived) = (arrival.peer, arrival.at);
        self.held = Some(Held { sender, peer, sequence, sent_ms, arrived, delay_us, accepted });
        Ok(accepted)
    }
}

/// Since the newest accepted request, microseconds.
fn silent_us(held: &Held, now: Stamp) -> u64 {
    match held.arrived.age(now) {
        Age::Past(us) => us,
        Age::Future(_) => 0,
    }
}

/// How much longer a request took than the fastest one: what the one before took longer, and what passed here less what
/// passed at the sender. Clocks that drift apart are forgiven their drift.
fn delay_after_us(held: &Held, sent_ms: u32, at: Stamp) -> u64 {
    let here_us = silent_us(held, at);
    let micros = |from_ms: u32, to_ms: u32| match to_ms.wrapping_sub(from_ms) {
        passed_ms @ ..0x8000_0000 => u64::from(passed_ms).saturating_mul(1_000),
        _ => 0,
    };
    // A newer number with an older stamp was sent before the one that is here.
    let (there_us, back_us) = (micros(held.sent_ms, sent_ms), micros(sent_ms, held.sent_ms));
    let drift_us = here_us.checked_div(DRIFT_DIVISOR).unwrap_or(0);
    let since_us = held.delay_us.saturating_add(here_us).saturating_add(back_us);
    since_us.saturating_sub(there_us).saturating_sub(drift_us)
}
