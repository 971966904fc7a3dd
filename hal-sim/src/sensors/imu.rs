//! Xsens MTi: handshake and measurement data (book, Xsens MTi).

use floorguard_types::random::Pcg32;

use crate::wire::{XbusParser, encode_message};

/// A sample every 10 ms.
const PERIOD_US: u64 = 10_000;
/// How long the wake-up message waits for its acknowledge.
const WAKE_UP_US: u64 = 500_000;
/// From a reset to the wake-up message.
const BOOT_US: u64 = 300_000;
/// Ticks of 100 µs after which the sample time starts over (book, Xsens MTi: Data items).
const DAY_TICKS: u64 = 864_000_000;
const GRAVITY_MPS2: f32 = 9.81;
/// The robot profile (book, Xsens MTi: Start-up): counter, fine time, quaternion, acceleration, rate of turn, status
/// word.
const PROFILE: [[u8; 4]; 6] = [
    [0x10, 0x20, 0xFF, 0xFF],
    [0x10, 0x60, 0xFF, 0xFF],
    [0x20, 0x10, 0x00, 0x64],
    [0x40, 0x20, 0x00, 0x64],
    [0x80, 0x20, 0x00, 0x64],
    [0xE0, 0x20, 0xFF, 0xFF],
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    WakingUp,
    Configuration,
    Measurement,
}

/// What the IMU feels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Forward, m/s².
    pub forward_mps2: f32,
    /// Left, m/s².
    pub left_mps2: f32,
    /// Counter-clockwise, rad/s.
    pub yaw_radps: f32,
    /// Of the world, radians.
    pub heading_rad: f32,
}

/// The IMU.
#[derive(Clone, Debug)]
pub struct Imu {
    state: State,
    parser: XbusParser,
    items: Vec<[u8; 4]>,
    counter: u16,
    next_us: u64,
    clock_offset: u32,
    bias_radps: f32,
    random: Pcg32,
    /// When the wake-up message was sent.
    announced_us: Option<u64>,
}

impl Imu {
    /// Switched on at time 0.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut random = Pcg32::new(seed, 13);
        let clock_offset = random.below(100_000_000);
        let bias_radps = random.normal() * 0.002;
        Self {
            state: State::WakingUp,
            parser: XbusParser::default(),
            items: PROFILE.to_vec(),
            counter: random.below(65_536) as u16,
            next_us: 0,
            clock_offset,
            bias_radps,
            random,
            announced_us: None,
        }
    }

    /// Switched off and on again: starts after `off_us`. The output configuration is kept, counter and sample time are
    /// not.
    pub fn power_cycle(&mut self, now_us: u64, off_us: u64) {
        self.state = State::WakingUp;
        self.announced_us = None;
        self.parser = XbusParser::default();
        self.counter = 0;
        self.next_us = self.next_us.max(now_us + off_us + BOOT_US).next_multiple_of(PERIOD_US);
        let ticks_at_start = self.next_us / 100 % DAY_TICKS;
        self.clock_offset = (DAY_TICKS - ticks_at_start) as u32;
    }

    /// The bias of the gyroscope about the vertical, rad/s: what a filter should find.
    #[must_use]
    pub const fn bias_radps(&self) -> f32 {
        self.bias_radps
    }

    /// When the next sample is due, microseconds.
    #[must_use]
    pub const fn due_us(&self) -> u64 {
        self.next_us
    }

    /// One sampling instant; what goes on the line.
    pub fn sample(&mut self, now_us: u64, motion: Motion) -> Option<Vec<u8>> {
        self.next_us += PERIOD_US;
        match self.state {
            State::WakingUp => match self.announced_us {
                None => {
                    self.announced_us = Some(now_us);
                    Some(encode_message(0x3E, &[]))
                }
                Some(since_us) if now_us >= since_us + WAKE_UP_US => {
                    self.state = State::Measurement;
                    None
                }
                Some(_) => None,
            },
            State::Configuration => None,
            State::Measurement => Some(self.data(now_us, motion)),
        }
    }

    /// Takes bytes from the host; the answers. Before it has woken up it hears nothing.
    pub fn receive(&mut self, bytes: &[u8], now_us: u64) -> Vec<u8> {
        if self.state == State::WakingUp && self.announced_us.is_none() {
            return Vec::new();
        }
        let messages = self.parser.push(bytes);
        messages.into_iter().flat_map(|(id, data)| self.answer(id, &data, now_us)).collect()
    }

    fn answer(&mut self, id: u8, data: &[u8], now_us: u64) -> Vec<u8> {
        let configuring = self.state == State::Configuration;
        match id {
            0x3F => {
                // Too late is no error: it measures by then.
                if self.state == State::WakingUp {
                    self.state = State::Configuration;
                }
                Vec::new()
            }
            0x30 => {
                self.state = State::Configuration;
                encode_message(0x31, &[])
            }
            0x10 => {
                self.state = State::Measurement;
                encode_message(0x11, &[])
            }
            0x40 => {
                self.power_cycle(now_us, 0);
                encode_message(0x41, &[])
            }
            0x00 if configuring => encode_message(0x01, &[0x03, 0x78, 0x00, 0x2A]),
            0x12 if configuring => encode_message(0x13, &[1, 8, 0]),
            0x1C if configuring => encode_message(0x1D, b"MTi-30-2A8G4          "),
            0xC0 if configuring => {
                if !data.is_empty() {
                    self.items = data.chunks_exact(4).map(|c| [c[0], c[1], c[2], c[3]]).collect();
                }
                encode_message(0xC1, &self.items.concat())
            }
            _ => encode_message(0x42, &[0x04]),
        }
    }

    fn data(&mut self, now_us: u64, motion: Motion) -> Vec<u8> {
        self.counter = self.counter.wrapping_add(1);
        let noise = [self.random.normal_pair(), self.random.normal_pair(), self.random.normal_pair()];
        let half = motion.heading_rad / 2.0;
        let mut body = Vec::with_capacity(96);
        for item in &self.items {
            let value: Vec<u8> = match (u16::from_be_bytes([item[0], item[1]])) & 0xFFF0 {
                0x1020 => self.counter.to_be_bytes().to_vec(),
                0x1060 => {
                    let ticks = (u64::from(self.clock_offset) + now_us / 100) % DAY_TICKS;
                    (ticks as u32).to_be_bytes().to_vec()
                }
                0x2010 => floats(&[libm::cosf(half), 0.0, 0.0, libm::sinf(half)]),
                0x4020 => floats(&[
                    motion.forward_mps2 + 0.02 * noise[0].0,
                    motion.left_mps2 + 0.02 * noise[0].1,
                    GRAVITY_MPS2 + 0.02 * noise[1].0,
                ]),
                0x8020 => floats(&[
                    0.003 * noise[1].1,
                    0.003 * noise[2].0,
                    motion.yaw_radps + self.bias_radps + 0.003 * noise[2].1,
                ]),
                0xE020 => 0x0000_0003_u32.to_be_bytes().to_vec(),
                0xE010 => vec![3],
                _ => continue,
            };
            body.extend([item[0], item[1], value.len() as u8]);
            body.extend(value);
        }
        encode_message(0x36, &body)
    }
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_be_bytes()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_start_up_sequence_of_the_specification_works() {
        let mut imu = Imu::new(1);
        assert_eq!(imu.sample(0, Motion::default()), Some(encode_message(0x3E, &[])));
        assert_eq!(imu.receive(&encode_message(0x30, &[]), 0), encode_message(0x31, &[]));
        assert_eq!(imu.sample(10_000, Motion::default()), None);
        let profile = PROFILE.concat();
        assert_eq!(imu.receive(&encode_message(0xC0, &profile), 10_000), encode_message(0xC1, &profile));
        assert_eq!(imu.receive(&encode_message(0x10, &[]), 10_000), encode_message(0x11, &[]));
        let data = imu.sample(20_000, Motion::default()).unwrap();
        assert_eq!((data[2], data[4], data[5], data[6]), (0x36, 0x10, 0x20, 2));
        assert_eq!(data[3] as usize + 5, data.len());
    }

    /// After a reset the message comes again, and waits as long for its acknowledgement as after the first start.
    #[test]
    fn a_reset_starts_over() {
        let mut imu = Imu::new(1);
        imu.sample(0, Motion::default());
        assert_eq!(imu.receive(&encode_message(0x40, &[]), 2_000_000), encode_message(0x41, &[]));
        let wake_us = imu.due_us();
        assert_eq!(imu.receive(&encode_message(0x30, &[]), 2_000_000), [], "it is starting");
        assert_eq!(wake_us, 2_300_000);
        assert_eq!(imu.sample(wake_us, Motion::default()), Some(encode_message(0x3E, &[])));
        for step in 1..=50 {
            assert_eq!(imu.sample(wake_us + step * 10_000, Motion::default()), None);
        }
        let data = imu.sample(wake_us + 510_000, Motion::default()).unwrap();
        assert_eq!(data[2], 0x36);
        let ticks = u32::from_be_bytes([data[12], data[13], data[14], data[15]]);
        assert_eq!(ticks, 5_100);
    }
}
