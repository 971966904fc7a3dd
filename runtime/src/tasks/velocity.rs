//! Velocities of a program outside: a navigation stack drives, the guard decides. Book, Velocity link.
//!
//! The task belongs to the guard ring: a deadline is kept however late perception is. It decides nothing itself; what counts
//! reaches the guard as any other request does.

use core::fmt::Write as _;

use embassy_futures::select::{Either3, select3};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::{Duration, Ticker, Timer, with_timeout};
use floorguard_drivers::velocity_link::{
    Acceptance, AcceptanceRules, Arrival, FRAME_BYTES_MAX, NO_CAUSE, Permit, PermitFlags, Reason,
};
use floorguard_guard::{Action, GuardState, Unit};
use floorguard_types::geometry::Twist2;
use floorguard_types::time::Stamp;

use crate::clock;
use crate::io::{FramePort, receive_from};
use crate::shared::Shared;

/// Pause after a failure of the link, microseconds. Deadlines are kept meanwhile.
const RETRY_US: u64 = 5_000;
/// A line that takes no bytes for so long loses the permit, milliseconds.
const SEND_MAX_MS: u64 = 2;

/// How a robot is driven from outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VelocityRules {
    /// Which requests count.
    pub acceptance: AcceptanceRules,
    /// Time between two permits, milliseconds, 20 to 50.
    pub period_ms: u64,
}

/// Guard ring. Runs for ever.
pub async fn velocity_input<M: RawMutex>(shared: &Shared<M>, mut port: impl FramePort, rules: VelocityRules) {
    let mut acceptance = Acceptance::new(rules.acceptance);
    let mut ticker = Ticker::every(Duration::from_millis(rules.period_ms));
    let mut buffer = [0; FRAME_BYTES_MAX];
    let mut sequence = 0_u32;
    // The deadline that is still ahead.
    let mut ends = None;
    // After a failure nothing is received before this.
    let mut begin = None;
    loop {
        match select3(receive_from(begin, &mut port, &mut buffer), ticker.next(), until(ends)).await {
            Either3::First(Ok(frame)) => {
                begin = None;
                let bytes = buffer.get(..frame.length).unwrap_or_default();
                let arrival = Arrival { peer: frame.peer, at: frame.arrival };
                if let Ok(accepted) = acceptance.offer(bytes, arrival) {
                    port.follow();
                    ends = Some(accepted.expires);
                    let wanted = if shared.is_paused() { Twist2::ZERO } else { accepted.twist };
                    shared.wanted.publish((accepted.stamp, wanted));
                }
            }
            Either3::First(Err(_)) => begin = Some(clock::now().plus_micros(RETRY_US)),
            Either3::Second(()) => {
                sequence = sequence.wrapping_add(1);
                let permit = permit(shared, (&acceptance, sequence), clock::now()).encode();
                // Deadlines wait for no line: what is not sent in time is lost, and the next one comes.
                let _ = with_timeout(Duration::from_millis(SEND_MAX_MS), port.send(&permit)).await;
            }
            Either3::Third(()) => {
                ends = None;
                shared.wanted.publish((clock::now(), Twist2::ZERO));
            }
        }
    }
}

/// Waits for a moment, or for ever.
async fn until(moment: Option<Stamp>) {
    match moment {
        Some(stamp) => Timer::at(clock::instant(stamp)).await,
        None => core::future::pending().await,
    }
}

/// What the guard permits now.
fn permit<M: RawMutex>(shared: &Shared<M>, (acceptance, sequence): (&Acceptance, u32), now: Stamp) -> Permit {
    let mut causes = 0_u64;
    shared.inspect(|guard| {
        for record in guard.causes() {
            causes |= 1_u64.wrapping_shl(record.cause.index() as u32);
        }
    });
    let expires = acceptance.expires();
    let holder = acceptance.holder(now);
    let mut permit = Permit {
        sender: holder.unwrap_or(0),
        sequence,
        acknowledged: acceptance.acknowledged().unwrap_or(0),
        stamp: now,
        permitted: Twist2::ZERO,
        requested: acceptance.requested(now),
        measured: shared.pose.get().map_or(Twist2::ZERO, |pose| pose.twist),
        speed_limit_mps: 0.0,
        state: 0,
        action: 0,
        flags: PermitFlags {
            is_held: holder.is_some(),
            is_expired: expires.is_some_and(|expires| expires <= now),
            ..PermitFlags::default()
        },
        cause: NO_CAUSE,
        causes,
        value: 0.0,
        limit: 0.0,
        unit: 0,
        counters: acceptance.counters(),
        reason: Reason::EMPTY,
    };
    let Some(decision) = shared.decision.get() else { return permit };
    permit.permitted = decision.permitted;
    permit.speed_limit_mps = decision.speed_limit_mps;
    (permit.state, permit.action) = (state_number(decision.state), action_number(decision.action));
    (permit.flags.torque_off, permit.flags.escaping) = (decision.torque_off, decision.escaping);
    if let Some(record) = decision.holding_cause {
        permit.cause = u8::try_from(record.cause.index()).unwrap_or(NO_CAUSE);
        (permit.value, permit.limit) = (record.measured, record.limit);
        permit.unit = unit_number(record.unit);
        // A reason that does not fit ends early; its numbers stand in the fields.
        let _ = write!(permit.reason, "{record}");
    }
    permit
}

const fn state_number(state: GuardState) -> u8 {
    match state {
        GuardState::Init => 0,
        GuardState::Run => 1,
        GuardState::Slow => 2,
        GuardState::Stop => 3,
        GuardState::Latched => 4,
        GuardState::AwaitsStart => 5,
    }
}

const fn action_number(action: Action) -> u8 {
    match action {
        Action::None => 0,
        Action::Limit => 1,
        Action::Category2 => 2,
        Action::Category1 => 3,
        Action::Category0 => 4,
    }
}

const fn unit_number(unit: Unit) -> u8 {
    match unit {
        Unit::None => 0,
        Unit::Metres => 1,
        Unit::MetresPerSecond => 2,
        Unit::RadiansPerSecond => 3,
        Unit::Seconds => 4,
        Unit::Percent => 5,
        Unit::Code => 6,
    }
}
