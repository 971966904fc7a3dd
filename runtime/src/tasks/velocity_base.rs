//! A base that takes velocities: the permitted one goes out, what it measures of itself comes in. Book, Velocity link.

use embassy_futures::select::{Either3, select3};
use embassy_sync::blocking_mutex::raw::RawMutex;
use embassy_time::{Duration, Ticker, with_timeout};
use floorguard_drivers::velocity_link::{FRAME_BYTES_MAX, MotionReport, StopDemand, VelocityRequest};
use floorguard_guard::{Action, Decision, FaultKind, Source};
use floorguard_localisation::odometry::WheelMotion;
use floorguard_types::geometry::Twist2;
use floorguard_types::sensing::DriveFeedback;
use floorguard_types::time::Stamp;

use crate::clock;
use crate::io::{FramePort, PortFrame, receive_from};
use crate::shared::Shared;

/// The permitted velocity is renewed this often, milliseconds.
const PERIOD_MS: u64 = 20;
/// How long a base may believe it, milliseconds: two are lost and it still drives, five and it stands.
const DEADLINE_MS: u16 = 100;
/// How the guard calls itself to the base.
const SENDER: u32 = 1;
/// Pause after a failure of the link, microseconds. Requests go on meanwhile.
const RETRY_US: u64 = 20_000;
/// A line that takes no bytes for so long loses the request, milliseconds.
const SEND_MAX_MS: u64 = 2;
/// A velocity that differs by less is the same, m/s and rad/s.
const SAME: f32 = 1.0e-3;
/// Microseconds of a millisecond.
const MS_US: u64 = 1_000;

/// The link's state.
struct Link {
    wheelbase_m: f32,
    sent: u32,
    newest_report: Option<u32>,
    /// When the base measured last.
    measured: Option<Stamp>,
    commanded: (Twist2, StopDemand),
}

/// Guard ring. Runs for ever. `wheelbase_m` is the guard's: by it a turning rate is a speed.
pub async fn velocity_base<M: RawMutex>(shared: &Shared<M>, mut port: impl FramePort, wheelbase_m: f32) {
    let commanded = (Twist2::ZERO, StopDemand::TorqueOff);
    let mut link = Link { wheelbase_m, sent: 0, newest_report: None, measured: None, commanded };
    let mut ticker = Ticker::every(Duration::from_millis(PERIOD_MS));
    let mut buffer = [0; FRAME_BYTES_MAX];
    // After a failure nothing is received before this.
    let mut begin = None;
    loop {
        let received = receive_from(begin, &mut port, &mut buffer);
        let decision = match select3(received, shared.decision.next(), ticker.next()).await {
            Either3::First(Ok(frame)) => {
                begin = None;
                link.take_in(shared, buffer.get(..frame.length).unwrap_or_default(), frame);
                continue;
            }
            Either3::First(Err(_)) => {
                fault(shared, FaultKind::LinkDown);
                begin = Some(clock::now().plus_micros(RETRY_US));
                continue;
            }
            // What asks for less goes out at once, what allows more with the next tick.
            Either3::Second(decision) if !link.is_tighter(&decision) => continue,
            Either3::Second(decision) => Some(decision),
            Either3::Third(()) => shared.decision.get(),
        };
        if let Some(decision) = decision {
            let request = link.request(&decision, clock::now()).encode();
            let sent = with_timeout(Duration::from_millis(SEND_MAX_MS), port.send(&request)).await;
            if !matches!(sent, Ok(Ok(()))) {
                fault(shared, FaultKind::LinkDown);
            }
            shared.count(|links| links.can_sent = links.can_sent.saturating_add(1));
        }
    }
}

fn fault<M: RawMutex>(shared: &Shared<M>, kind: FaultKind) {
    shared.count(|links| links.can_errors = links.can_errors.saturating_add(1));
    shared.decide(|guard| guard.on_source_fault(Source::Drive, kind, clock::now()));
}

/// What a decision means for the base.
fn demanded(decision: &Decision) -> (Twist2, StopDemand) {
    let permitted = decision.permitted;
    let moves = permitted.linear_mps != 0.0 || permitted.angular_radps != 0.0;
    if decision.torque_off {
        return (Twist2::ZERO, StopDemand::TorqueOff);
    }
    match decision.action {
        Action::Category1 if !moves => (Twist2::ZERO, StopDemand::Ramp),
        Action::Category2 if !moves => (Twist2::ZERO, StopDemand::Hold),
        _ => (permitted, StopDemand::None),
    }
}

impl Link {
    fn is_tighter(&self, decision: &Decision) -> bool {
        let rank = |stop| match stop {
            StopDemand::None => 0,
            StopDemand::Hold => 1,
            StopDemand::Ramp => 2,
            StopDemand::TorqueOff => 3,
        };
        let ((new, new_stop), (old, old_stop)) = (demanded(decision), self.commanded);
        let slower = libm::fabsf(new.linear_mps) < libm::fabsf(old.linear_mps) - SAME
            || libm::fabsf(new.angular_radps) < libm::fabsf(old.angular_radps) - SAME;
        rank(new_stop) > rank(old_stop) || (rank(new_stop) == rank(old_stop) && slower)
    }

    fn request(&mut self, decision: &Decision, now: Stamp) -> VelocityRequest {
        self.commanded = demanded(decision);
        self.sent = self.sent.wrapping_add(1);
        let (twist, stop) = self.commanded;
        let millis = now.as_micros().checked_div(MS_US).unwrap_or(0) & u64::from(u32::MAX);
        let sent_ms = u32::try_from(millis).unwrap_or(0);
        VelocityRequest {
            sender: SENDER,
            sequence: self.sent,
            sent_ms,
            deadline_ms: DEADLINE_MS,
            stop,
            twist,
        }
    }

    /// The motion since the measurement before; none from the first or an old one.
    fn motion(&mut self, twist: Twist2, stamp: Stamp) -> Option<WheelMotion> {
        let before = self.measured;
        if before.is_some_and(|before| before >= stamp) {
            return None;
        }
        self.measured = Some(stamp);
        let seconds = stamp.seconds_since(before?);
        let (distance_m, turn_rad) = (twist.linear_mps * seconds, twist.angular_radps * seconds);
        let still = twist.linear_mps == 0.0 && twist.angular_radps == 0.0;
        Some(WheelMotion { stamp, twist, distance_m, turn_rad, still })
    }

    /// A report is evidence of the wheels and of the drive. One that is not newer is none.
    fn take_in<M: RawMutex>(&mut self, shared: &Shared<M>, bytes: &[u8], frame: PortFrame) {
        let newest = self.newest_report;
        let is_newer = |report: &MotionReport| {
            newest.is_none_or(|newest| (1..1 << 31).contains(&report.sequence.wrapping_sub(newest)))
        };
        let Some(report) = MotionReport::decode(bytes).ok().filter(is_newer) else {
            shared.count(|links| links.can_errors = links.can_errors.saturating_add(1));
            return;
        };
        self.newest_report = Some(report.sequence);
        let now = clock::now();
        let stamp = frame.arrival.minus_micros(u64::from(report.age_ms).saturating_mul(MS_US));
        if let Some(motion) = self.motion(report.twist, stamp) {
            shared.move_by(|known| known.on_motion(&motion));
            shared.decide(|guard| guard.on_wheels(motion.twist, motion.stamp, now));
        }
        let across_mps = report.twist.angular_radps * self.wheelbase_m;
        let feedback = DriveFeedback {
            stamp,
            state: report.state,
            wheel_speed_mps: libm::hypotf(report.twist.linear_mps, across_mps),
            steering_rad: libm::atan2f(across_mps, report.twist.linear_mps),
        };
        shared.decide(|guard| guard.on_drive(&feedback, now));
    }
}
