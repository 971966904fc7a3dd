//! What the robot asks of its drives, read from the frames on the bus as the judge understands them.

use floorguard_drivers::can::CanFrame;
use floorguard_drivers::motor_drives::{MotorDrivesConfiguration, MotorProtocol};
use floorguard_runtime::configuration::RobotConfiguration;

/// Front wheel's target: object 60FFh in mm/s behind the controlword.
const ENABLE_OPERATION: u8 = 0x0F;

/// The last target of the front wheel's drive, or of those of all wheels.
pub(super) struct WheelTargets {
    /// Identifiers of the frames; none where a node number is 0.
    ids: [Option<u16>; 4],
    /// Controllers other than CiA 402 drives.
    motors: Option<MotorDrivesConfiguration>,
    /// What has come of a line of theirs.
    line: String,
    /// The last target of each, m/s.
    pub(super) mps: [f32; 4],
}

impl WheelTargets {
    pub(super) fn of(robot: &RobotConfiguration) -> Self {
        let id = |node: u8| (node != 0).then(|| 0x200 | u16::from(node));
        let can = &robot.can;
        let of_wheels = can.wheel_nodes.map(id);
        let ids = if of_wheels[0].is_some() { of_wheels } else { [id(can.drive_node), None, None, None] };
        Self { ids, motors: robot.motors, line: String::new(), mps: [0.0; 4] }
    }

    /// The speed that is asked for after a frame, m/s: that of the front wheel, or the mean of all wheels; `None`: another frame.
    pub(super) fn take(&mut self, frame: &CanFrame) -> Option<f32> {
        let wheels = match self.motors {
            Some(motors) => {
                self.take_motors(&motors, frame)?;
                motors.wheel_count()
            }
            None => {
                self.take_drive(frame.standard_id()?, frame.payload())?;
                self.ids.iter().flatten().count().max(1)
            }
        };
        Some(self.mps.iter().sum::<f32>() / wheels as f32)
    }

    fn take_drive(&mut self, id: u16, payload: &[u8]) -> Option<()> {
        let wheel = self.ids.iter().position(|known| *known == Some(id))?;
        let &[control, _, a, b, c, d] = payload else { return None };
        let target_mps = i32::from_le_bytes([a, b, c, d]) as f32 * 1.0e-3;
        self.mps[wheel] = if control == ENABLE_OPERATION { target_mps } else { 0.0 };
        Some(())
    }

    fn take_motors(&mut self, motors: &MotorDrivesConfiguration, frame: &CanFrame) -> Option<()> {
        let payload = frame.payload();
        let wheel_of =
            |node: u8| motors.nodes.iter().take(motors.wheel_count()).position(|known| *known == node);
        match motors.protocol {
            MotorProtocol::Odrive => {
                let id = frame.standard_id()?;
                let wheel = wheel_of((id >> 5) as u8)?;
                self.mps[wheel] = match (id & 0x1F, payload) {
                    (0x0D, &[a, b, c, d, ..]) => {
                        f32::from_le_bytes([a, b, c, d]) * motors.metres_per_turn[wheel]
                    }
                    (0x02, _) | (0x07, [1, ..]) => 0.0,
                    _ => return None,
                };
            }
            MotorProtocol::Vesc => {
                let id = frame.extended_id()?;
                let wheel = wheel_of(id as u8)?;
                self.mps[wheel] = match (id >> 8, payload) {
                    (3, &[a, b, c, d]) => {
                        let turns_per_s = i32::from_be_bytes([a, b, c, d]) as f32 / motors.pole_pairs / 60.0;
                        turns_per_s * motors.metres_per_turn[wheel]
                    }
                    (1, _) => 0.0,
                    _ => return None,
                };
            }
            MotorProtocol::RoboteqCan => {
                let id = frame.standard_id()?;
                let of_node = |wheel: &usize| motors.nodes[*wheel] == (id & 0x7F) as u8;
                let channels: Vec<usize> = (0..motors.wheel_count()).filter(of_node).collect();
                channels.first()?;
                match (id & 0x780, payload) {
                    (0x200, speeds) => {
                        for (wheel, rpm) in channels.into_iter().zip(speeds.chunks_exact(4)) {
                            let rpm = i32::from_le_bytes([rpm[0], rpm[1], rpm[2], rpm[3]]) as f32;
                            self.mps[wheel] = rpm / 60.0 * motors.metres_per_turn[wheel];
                        }
                    }
                    // The emergency stop.
                    (0x600, [0x2F, 0x0C, 0x20, ..]) => {
                        channels.into_iter().for_each(|wheel| self.mps[wheel] = 0.0);
                    }
                    _ => return None,
                }
            }
            MotorProtocol::Roboteq | MotorProtocol::WheelLine => {
                self.line += &String::from_utf8_lossy(payload);
                let (line, rest) = self
                    .line
                    .split_once(['\r', '\n'])
                    .map(|(line, rest)| (line.to_owned(), rest.to_owned()))?;
                self.line = rest;
                self.take_line(motors, &line)?;
            }
        }
        Some(())
    }

    fn take_line(&mut self, motors: &MotorDrivesConfiguration, line: &str) -> Option<()> {
        let words: Vec<&str> = line.split(['*', ' ']).collect();
        match words.as_slice() {
            ["!S", channel, rpm] => {
                let wheel = channel.parse::<usize>().ok()?.checked_sub(1)?;
                *self.mps.get_mut(wheel)? = rpm.parse::<f32>().ok()? / 60.0 * motors.metres_per_turn[wheel];
            }
            ["!EX"] | ["W", _, _, "0", ..] => self.mps = [0.0; 4],
            ["W", _, _, "1", speeds @ .., _] => {
                for (wheel, speed) in speeds.iter().enumerate() {
                    *self.mps.get_mut(wheel)? =
                        speed.parse::<f32>().ok()? * 1.0e-3 * motors.metres_per_turn[wheel];
                }
            }
            _ => return None,
        }
        Some(())
    }
}
