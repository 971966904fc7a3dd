//! What the task of the CAN bus needs of a base: the master of its devices, and how a permitted velocity becomes a command to them.

use floorguard_drivers::can::CanFrame;
use floorguard_drivers::motor_drives::MotorDrives;
use floorguard_drivers::three_wheel_base::{BaseEvent, DriveCommand, StopKind, ThreeWheelBase};
use floorguard_drivers::wheel_drives::{SideTargets, WheelCommand, WheelDrives};
use floorguard_localisation::odometry::{Ackermann, BaseModel, SideWheels, Tricycle};
use floorguard_types::geometry::Twist2;
use floorguard_types::sensing::DriveFeedback;
use floorguard_types::time::Stamp;

use crate::shared::BusReport;

/// A command that differs by less is the same, m/s.
const SAME_MPS: f32 = 1.0e-3;

/// The master of a base's devices: frames in, frames out, one command.
pub trait BusBase {
    /// What its drives are to do.
    type Command: Copy;

    /// A frame from the bus. `event` is called at most once.
    fn on_frame(&mut self, frame: &CanFrame, now: Stamp, event: &mut impl FnMut(BaseEvent));

    /// Ten milliseconds have passed.
    fn poll(&mut self, now: Stamp, event: &mut impl FnMut(BaseEvent), send: &mut impl FnMut(&CanFrame));

    /// What the drives are to do from now on.
    fn command(&mut self, command: Self::Command);

    /// The last command.
    fn commanded(&self) -> Self::Command;

    /// Sends the command at once: a stop does not wait for the next poll.
    fn send_command(&self, send: &mut impl FnMut(&CanFrame));

    /// The operator asked for a reset.
    fn reset_faults(&mut self);

    /// What it was configured with is what it was at the start; `false` after a flipped bit (FG-REQ-058).
    fn is_whole(&self) -> bool;

    /// How far its devices are.
    fn report(&self) -> BusReport;
}

/// The masters of the drivers have these methods of their own.
macro_rules! bus_base {
    ($master:ty, $command:ty, $report:path) => {
        impl BusBase for $master {
            type Command = $command;

            fn on_frame(&mut self, frame: &CanFrame, now: Stamp, event: &mut impl FnMut(BaseEvent)) {
                Self::on_frame(self, frame, now, event);
            }

            fn poll(
                &mut self,
                now: Stamp,
                event: &mut impl FnMut(BaseEvent),
                send: &mut impl FnMut(&CanFrame),
            ) {
                Self::poll(self, now, event, send);
            }

            fn command(&mut self, command: $command) {
                Self::command(self, command);
            }

            fn commanded(&self) -> $command {
                Self::commanded(self)
            }

            fn send_command(&self, send: &mut impl FnMut(&CanFrame)) {
                Self::send_command(self, send);
            }

            fn reset_faults(&mut self) {
                Self::reset_faults(self);
            }

            fn is_whole(&self) -> bool {
                Self::is_whole(self)
            }

            fn report(&self) -> BusReport {
                $report(self)
            }
        }
    };
}

bus_base!(ThreeWheelBase, DriveCommand, BusReport::of);
bus_base!(WheelDrives, WheelCommand, BusReport::of_wheels);
bus_base!(MotorDrives, WheelCommand, BusReport::of_motors);

/// How a base turns a permitted velocity into a command to its drives (book, Odometry: Bases).
pub trait BaseKinematics: Copy + PartialEq {
    /// What the drives take.
    type Command: Copy;
    /// No torque at once.
    const TORQUE_OFF: Self::Command;

    /// The command for a velocity, while the steering stands at `steering_rad`.
    fn moving(&self, permitted: Twist2, steering_rad: f32) -> Self::Command;

    /// Stand still.
    fn stopping(kind: StopKind) -> Self::Command;

    /// Slower, or a stop of a severer kind.
    fn is_tighter(new: Self::Command, old: Self::Command) -> bool;

    /// What the drives report, as the guard takes it: the speed of a steered wheel, `wheelbase_m` of its limits before the base
    /// point, and where it points.
    fn heard(&self, feedback: DriveFeedback) -> DriveFeedback {
        feedback
    }
}

const fn severity(kind: StopKind) -> u8 {
    match kind {
        StopKind::Hold => 1,
        StopKind::Ramp => 2,
        StopKind::TorqueOff => 3,
    }
}

/// The same for a base with one driven axle or wheel and one that steers.
fn is_tighter_drive(new: DriveCommand, old: DriveCommand) -> bool {
    let rank = |command| match command {
        DriveCommand::Move { .. } => 0,
        DriveCommand::Stop(kind) => severity(kind),
    };
    match (new, old) {
        (DriveCommand::Move { wheel_mps: new, .. }, DriveCommand::Move { wheel_mps: old, .. }) => {
            libm::fabsf(new) < libm::fabsf(old) - SAME_MPS
        }
        (new, old) => rank(new) > rank(old),
    }
}

impl BaseKinematics for Tricycle {
    type Command = DriveCommand;
    const TORQUE_OFF: DriveCommand = DriveCommand::Stop(StopKind::TorqueOff);

    fn moving(&self, permitted: Twist2, steering_rad: f32) -> DriveCommand {
        let target_rad = self.steering_rad(permitted, steering_rad);
        let wheel_mps = self.wheel_mps(permitted, steering_rad, target_rad);
        DriveCommand::Move { wheel_mps, steering_rad: target_rad }
    }

    fn stopping(kind: StopKind) -> DriveCommand {
        DriveCommand::Stop(kind)
    }

    fn is_tighter(new: DriveCommand, old: DriveCommand) -> bool {
        is_tighter_drive(new, old)
    }
}

impl BaseKinematics for Ackermann {
    type Command = DriveCommand;
    const TORQUE_OFF: DriveCommand = DriveCommand::Stop(StopKind::TorqueOff);

    fn moving(&self, permitted: Twist2, steering_rad: f32) -> DriveCommand {
        let target_rad = self.steering_rad(permitted, steering_rad);
        let wheel_mps = self.rear_mps(permitted, steering_rad, target_rad);
        DriveCommand::Move { wheel_mps, steering_rad: target_rad }
    }

    fn stopping(kind: StopKind) -> DriveCommand {
        DriveCommand::Stop(kind)
    }

    fn is_tighter(new: DriveCommand, old: DriveCommand) -> bool {
        is_tighter_drive(new, old)
    }

    /// The drive reports the rear axle; a front wheel that rolls with it is faster by the cosine of its angle.
    fn heard(&self, feedback: DriveFeedback) -> DriveFeedback {
        let cos = libm::cosf(feedback.steering_rad).max(0.1);
        DriveFeedback { wheel_speed_mps: feedback.wheel_speed_mps / cos, ..feedback }
    }
}

impl BaseKinematics for SideWheels {
    type Command = WheelCommand;
    const TORQUE_OFF: WheelCommand = WheelCommand::Stop(StopKind::TorqueOff);

    fn moving(&self, permitted: Twist2, _: f32) -> WheelCommand {
        let wheels = self.wheels(permitted);
        WheelCommand::Move(SideTargets { left_mps: wheels.left_mps, right_mps: wheels.right_mps })
    }

    fn stopping(kind: StopKind) -> WheelCommand {
        WheelCommand::Stop(kind)
    }

    fn is_tighter(new: WheelCommand, old: WheelCommand) -> bool {
        let rank = |command| match command {
            WheelCommand::Move(_) => 0,
            WheelCommand::Stop(kind) => severity(kind),
        };
        match (new, old) {
            (WheelCommand::Move(new), WheelCommand::Move(old)) => {
                new.fastest_mps() < old.fastest_mps() - SAME_MPS
            }
            (new, old) => rank(new) > rank(old),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_asks_for_less_is_urgent() {
        let go = |wheel_mps| DriveCommand::Move { wheel_mps, steering_rad: 0.0 };
        let (stop, is_tighter) = (DriveCommand::Stop, <Tricycle as BaseKinematics>::is_tighter);
        assert!(is_tighter(go(0.3), go(0.5)) && is_tighter(stop(StopKind::Hold), go(0.0)));
        assert!(is_tighter(stop(StopKind::TorqueOff), stop(StopKind::Ramp)));
        assert!(is_tighter(go(-0.1), go(0.5)));
        assert!(!is_tighter(go(0.5), go(0.3)) && !is_tighter(go(0.5), stop(StopKind::Hold)));
        let base = SideWheels::differential(0.5);
        let go = |linear_mps, angular_radps| base.moving(Twist2 { linear_mps, angular_radps }, 0.0);
        assert!(SideWheels::is_tighter(go(0.3, 0.1), go(0.3, 0.2)), "the outer wheel counts");
        assert!(!SideWheels::is_tighter(go(0.1, 1.0), go(0.2, 0.0)));
        assert!(SideWheels::is_tighter(SideWheels::stopping(StopKind::Hold), go(0.0, 0.0)));
    }

    /// A car's front wheel at 60° is twice as fast as its rear axle.
    #[test]
    fn rear_axle_is_heard_as_a_front_wheel() {
        let base = Ackermann { wheelbase_m: 1.0, track_m: 0.6, steering_max_rad: 1.1 };
        let state = floorguard_types::sensing::DriveState::Enabled;
        let steering_rad = core::f32::consts::FRAC_PI_3;
        let rear = DriveFeedback { stamp: Stamp::ZERO, state, wheel_speed_mps: 0.3, steering_rad };
        assert!((base.heard(rear).wheel_speed_mps - 0.6).abs() < 1e-6);
    }
}
