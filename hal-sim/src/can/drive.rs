//! A CiA 402 drive: state machine, quick stop, ramps (book, CANopen: CiA 402 drives).
//!
//! Traction follows 60FFh in mm/s of the wheel's rim (profile velocity, mode 3); steering follows 607Ah in thousandths
//! of a degree, counter-clockwise (profile position, mode 1). Ramps are 6083h, 6084h and 6085h in the same unit a
//! second.

use super::{CanFrame, Node};

/// What the drive turns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveKind {
    /// The powered front wheel.
    Traction,
    /// One of several powered wheels; 6064h is the count of its own encoder.
    Wheel,
    /// The angle of the front wheel.
    Steering,
}

/// States of the power drive system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveState {
    /// Waits for "shutdown".
    SwitchOnDisabled,
    /// Waits for "switch on".
    Ready,
    /// Power is on, no motion.
    SwitchedOn,
    /// Follows its target.
    Enabled,
    /// Ramps down, or stands after the ramp.
    QuickStop,
    /// Torque off until reset.
    Fault,
}

impl DriveState {
    const fn status_bits(self) -> u32 {
        match self {
            Self::SwitchOnDisabled => 0x0240,
            Self::Ready => 0x0231,
            Self::SwitchedOn => 0x0233,
            Self::Enabled => 0x0237,
            Self::QuickStop => 0x0217,
            Self::Fault => 0x0218,
        }
    }
}

/// What the mechanics really do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredMotion {
    /// Of the wheel's rim, m/s.
    pub speed_mps: f32,
    /// Of the steered wheel, counter-clockwise, radians.
    pub angle_rad: f32,
    /// Of the wheel's encoder.
    pub counts: i64,
}

/// A drive on the bus.
#[derive(Clone, Debug)]
pub struct Drive {
    /// The bus side.
    pub node: Node,
    kind: DriveKind,
    state: DriveState,
    last_control: u32,
    /// mm/s, what the ramp allows now.
    demand: f32,
    standing: bool,
}

impl Drive {
    /// A drive that has just been powered.
    #[must_use]
    pub fn new(id: u8, kind: DriveKind) -> Self {
        let mut node = Node::new(id, 0x0002_0192);
        let objects = &mut node.objects;
        objects.define(0x6040, 0, 2, 0);
        objects.define_read_only(0x6041, 0, 2, DriveState::SwitchOnDisabled.status_bits());
        objects.define(0x6060, 0, 1, 0);
        objects.define_read_only(0x6061, 0, 1, 0);
        objects.define(0x60FF, 0, 4, 0);
        objects.define_read_only(0x606C, 0, 4, 0);
        objects.define(0x607A, 0, 4, 0);
        objects.define_read_only(0x6064, 0, 4, 0);
        objects.define_read_only(0x6077, 0, 2, 0);
        objects.define(0x6081, 0, 4, 60_000);
        objects.define(0x6083, 0, 4, 1_000);
        objects.define(0x6084, 0, 4, 1_500);
        objects.define(0x6085, 0, 4, 2_000);
        objects.define(0x605A, 0, 2, 2);
        objects.define(0x605D, 0, 2, 1);
        objects.define(0x605E, 0, 2, 2);
        objects.define(0x6007, 0, 2, 3);
        objects.define_read_only(0x603F, 0, 2, 0);
        objects.define_read_only(0x6502, 0, 4, 0x0000_0005);
        Self { node, kind, state: DriveState::SwitchOnDisabled, last_control: 0, demand: 0.0, standing: true }
    }

    /// The state of the power drive system.
    #[must_use]
    pub const fn state(&self) -> DriveState {
        self.state
    }

    /// Torque is on the motor: it holds or follows. Otherwise the brake falls in.
    #[must_use]
    pub const fn powered(&self) -> bool {
        matches!(self.state, DriveState::Enabled | DriveState::QuickStop)
    }

    /// Rim speed that the traction drive now demands, m/s.
    #[must_use]
    pub fn demand_mps(&self) -> f32 {
        self.demand * 1.0e-3
    }

    /// Angle commanded to the steering drive, radians; `None` unless it moves.
    #[must_use]
    pub fn target_rad(&self) -> Option<f32> {
        let target_mdeg = self.node.objects.get(0x607A, 0) as i32;
        (self.state == DriveState::Enabled).then(|| (target_mdeg as f32 * 1.0e-3).to_radians())
    }

    /// Takes a frame from the bus.
    pub fn receive(&mut self, frame: &CanFrame, now_us: u64, out: &mut Vec<CanFrame>) {
        if self.node.receive(frame, now_us, out) {
            self.obey();
        }
    }

    /// An internal fault: torque off until a fault reset.
    pub fn fail(&mut self, code: u16, out: &mut Vec<CanFrame>) {
        self.enter(DriveState::Fault);
        self.node.objects.set(0x603F, 0, u32::from(code));
        self.node.emergency(code, 0x01, out);
    }

    /// One step of the ramps.
    pub fn tick(&mut self, now_us: u64, step_s: f32, measured: MeasuredMotion, out: &mut Vec<CanFrame>) {
        self.watch_master(out);
        self.ramp(step_s);
        let MeasuredMotion { speed_mps, angle_rad, .. } = measured;
        self.standing = speed_mps.abs() < 0.005;
        self.node.objects.set(0x606C, 0, ((speed_mps * 1.0e3).round() as i32) as u32);
        if self.kind == DriveKind::Steering {
            let mdeg = (angle_rad.to_degrees() * 1.0e3).round() as i32;
            self.node.objects.set(0x6064, 0, mdeg as u32);
        }
        self.place(measured.counts);
        if self.state == DriveState::QuickStop && self.standing && self.node.objects.get(0x605A, 0) <= 4 {
            self.enter(DriveState::SwitchOnDisabled);
        }
        self.publish_status();
        self.node.tick(now_us, out);
    }

    /// Where the wheel is at this moment: a drive latches its position by SYNC.
    pub fn place(&mut self, counts: i64) {
        if self.kind == DriveKind::Wheel {
            self.node.objects.set(0x6064, 0, counts as u32);
        }
    }

    fn watch_master(&mut self, out: &mut Vec<CanFrame>) {
        // Object 6007h names both as a loss of the connection (CiA 402).
        if !(self.node.master_lost || self.node.stopped()) || !self.powered() {
            return;
        }
        match self.node.objects.get(0x6007, 0) {
            0 => {}
            1 => self.fail(0x8130, out),
            2 => self.enter(DriveState::SwitchOnDisabled),
            _ if self.state == DriveState::Enabled => {
                self.enter(DriveState::QuickStop);
                self.node.emergency(0x8130, 0x11, out);
            }
            _ => {}
        }
    }

    fn ramp(&mut self, step_s: f32) {
        let target = self.node.objects.get(0x60FF, 0) as i32 as f32;
        let halted = self.node.objects.get(0x6040, 0) & 0x0100 != 0;
        let (target, deceleration) = match self.state {
            DriveState::Enabled if halted => (0.0, 0x6084),
            DriveState::Enabled => (target, 0x6084),
            _ => (0.0, 0x6085),
        };
        let slower = target.abs() < self.demand.abs() || target * self.demand < 0.0;
        let rate = self.node.objects.get(if slower { deceleration } else { 0x6083 }, 0) as f32;
        let step = rate * step_s;
        self.demand += (target - self.demand).clamp(-step, step);
        if !self.powered() {
            self.demand = 0.0;
        }
    }

    fn obey(&mut self) {
        let control = self.node.objects.get(0x6040, 0);
        let rising_reset = control & 0x80 != 0 && self.last_control & 0x80 == 0;
        self.last_control = control;
        let mode = self.node.objects.get(0x6060, 0);
        self.node.objects.set(0x6061, 0, mode);
        let next = self.next_state(control, rising_reset);
        self.enter(next);
        self.publish_status();
    }

    /// The transitions of the book, CANopen: CiA 402 drives; the low four bits of the controlword are the command.
    fn next_state(&self, control: u32, rising_reset: bool) -> DriveState {
        use DriveState::{Enabled, Fault, QuickStop, Ready, SwitchOnDisabled, SwitchedOn};
        let command = control & 0x0F;
        if self.state == Fault {
            return if rising_reset { SwitchOnDisabled } else { Fault };
        }
        if command & 0x02 == 0 {
            return SwitchOnDisabled;
        }
        if command & 0x04 == 0 {
            return match self.state {
                Enabled | QuickStop => QuickStop,
                _ => SwitchOnDisabled,
            };
        }
        match (self.state, command) {
            (Ready | SwitchedOn | Enabled, 0x06) | (SwitchOnDisabled, 0x06) => Ready,
            (Ready | Enabled, 0x07) | (SwitchedOn, 0x07) => SwitchedOn,
            (Ready, 0x0F) => SwitchedOn,
            (SwitchedOn | Enabled | QuickStop, 0x0F) => Enabled,
            (state, _) => state,
        }
    }

    fn enter(&mut self, state: DriveState) {
        self.state = state;
    }

    fn publish_status(&mut self) {
        let at_rest = if self.standing && self.powered() { 0x1000 } else { 0 };
        self.node.objects.set(0x6041, 0, self.state.status_bits() | at_rest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn send(drive: &mut Drive, control: u16, target: i32) -> Vec<CanFrame> {
        let mut out = Vec::new();
        let [c0, c1] = control.to_le_bytes();
        drive.receive(&CanFrame::new(0x605, &[0x2B, 0x40, 0x60, 0, c0, c1, 0, 0]), 0, &mut out);
        let [a, b, c, d] = target.to_le_bytes();
        drive.receive(&CanFrame::new(0x605, &[0x23, 0xFF, 0x60, 0, a, b, c, d]), 0, &mut out);
        out
    }

    fn enabled() -> Drive {
        let mut drive = Drive::new(5, DriveKind::Traction);
        for control in [0x06, 0x07, 0x0F] {
            send(&mut drive, control, 500);
        }
        drive
    }

    fn moving_at(speed_mps: f32) -> MeasuredMotion {
        MeasuredMotion { speed_mps, angle_rad: 0.0, counts: 0 }
    }

    #[test]
    fn climbs_only_in_order() {
        let mut drive = Drive::new(5, DriveKind::Traction);
        send(&mut drive, 0x0F, 0);
        assert_eq!(drive.state(), DriveState::SwitchOnDisabled);
        assert_eq!(enabled().state(), DriveState::Enabled);
    }

    #[test]
    fn quick_stop_ramps_down_and_then_disables() {
        let mut drive = enabled();
        let mut out = Vec::new();
        for step in 0..100 {
            drive.tick(step * 10_000, 0.01, moving_at(drive.demand_mps()), &mut out);
        }
        assert!((drive.demand_mps() - 0.5).abs() < 1e-3);
        send(&mut drive, 0x02, 500);
        assert_eq!(drive.state(), DriveState::QuickStop);
        drive.tick(0, 0.1, moving_at(0.4), &mut out);
        assert!((drive.demand_mps() - 0.3).abs() < 1e-3, "2 m/s² for 0.1 s");
        drive.tick(0, 0.5, moving_at(0.0), &mut out);
        assert_eq!(drive.state(), DriveState::SwitchOnDisabled);
    }

    /// The frames of the book, CANopen: Process data.
    #[test]
    fn the_written_mapping_is_honoured() {
        let mut drive = enabled();
        let mut out = Vec::new();
        let writes: [[u8; 8]; 8] = [
            [0x23, 0x00, 0x18, 0x01, 0x85, 0x01, 0x00, 0x80],
            [0x2F, 0x00, 0x1A, 0x00, 0x00, 0x00, 0x00, 0x00],
            [0x23, 0x00, 0x1A, 0x01, 0x10, 0x00, 0x41, 0x60],
            [0x23, 0x00, 0x1A, 0x02, 0x20, 0x00, 0x6C, 0x60],
            [0x2F, 0x00, 0x1A, 0x00, 0x02, 0x00, 0x00, 0x00],
            [0x2F, 0x00, 0x18, 0x02, 0x01, 0x00, 0x00, 0x00],
            [0x23, 0x00, 0x18, 0x01, 0x85, 0x01, 0x00, 0x00],
            [0x23, 0x16, 0x10, 0x01, 0xC8, 0x00, 0x7F, 0x00],
        ];
        for write in writes {
            drive.receive(&CanFrame::new(0x605, &write), 0, &mut out);
            assert_eq!(out.pop().map(|answer| answer.data[0]), Some(0x60), "{write:02X?}");
        }
        drive.receive(&CanFrame::new(0x000, &[1, 0]), 0, &mut out);
        drive.tick(0, 0.001, moving_at(-1.234), &mut out);
        out.clear();
        drive.receive(&CanFrame::new(0x080, &[]), 0, &mut out);
        assert_eq!(out, [CanFrame::new(0x185, &[0x37, 0x02, 0x2E, 0xFB, 0xFF, 0xFF])]);
    }

    #[test]
    fn a_dead_master_stops_the_drive() {
        let mut drive = enabled();
        let mut out = Vec::new();
        drive.receive(&CanFrame::new(0x605, &[0x23, 0x16, 0x10, 0x01, 0xC8, 0, 0x7F, 0]), 0, &mut out);
        drive.receive(&CanFrame::new(0x77F, &[5]), 0, &mut out);
        drive.tick(190_000, 0.01, moving_at(0.5), &mut out);
        assert_eq!(drive.state(), DriveState::Enabled);
        drive.tick(210_000, 0.01, moving_at(0.5), &mut out);
        drive.tick(220_000, 0.01, moving_at(0.5), &mut out);
        assert_eq!(drive.state(), DriveState::QuickStop);
    }

    /// CiA 301, object 1029h sub-index 1: 0, the default, falls to pre-operational, 1 keeps the state, 2 stops.
    #[test]
    fn dead_master_follows_object_1029h() {
        for (behaviour, state) in [(None, 0x7F), (Some(0), 0x7F), (Some(1), 5), (Some(2), 4)] {
            let mut drive = enabled();
            let mut out = Vec::new();
            drive.receive(&CanFrame::new(0x605, &[0x23, 0x16, 0x10, 0x01, 0xC8, 0, 0x7F, 0]), 0, &mut out);
            drive.receive(&CanFrame::new(0x605, &[0x2B, 0x17, 0x10, 0, 100, 0, 0, 0]), 0, &mut out);
            if let Some(value) = behaviour {
                let write = CanFrame::new(0x605, &[0x2F, 0x29, 0x10, 1, value, 0, 0, 0]);
                drive.receive(&write, 0, &mut out);
            }
            drive.receive(&CanFrame::new(0x000, &[1, 0]), 0, &mut out);
            drive.receive(&CanFrame::new(0x77F, &[5]), 0, &mut out);
            drive.tick(210_000, 0.01, moving_at(0.5), &mut out);
            out.clear();
            drive.tick(310_000, 0.01, moving_at(0.5), &mut out);
            let beat = out.iter().find(|frame| frame.id == 0x705).expect("a heartbeat");
            assert_eq!(beat.payload(), [state], "{behaviour:?}");
        }
    }
}
