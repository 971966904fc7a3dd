//! VectorNav VN-100: text output as delivered, set up by sentences, then frames (book, VectorNav).

use floorguard_types::random::Pcg32;

use super::imu::Motion;
use crate::wire::{
    COMMON_FIELDS, SATURATION_FIELD, VectorNavReader, VectorNavSample, vectornav_frame, vectornav_sentence,
};

/// It measures 800 times a second; the simulated one no oftener than it is asked at most.
const SAMPLE_US: u64 = 1_250;
const PERIOD_US: u64 = 10_000;
/// From power to the first output.
const BOOT_US: u64 = 400_000;
/// As delivered it writes text forty times a second: every third period here.
const TEXT_EVERY: u64 = 3;
const GRAVITY_MPS2: f32 = 9.81;

/// The device. What it is set to is gone with its power.
#[derive(Clone, Debug)]
pub struct VectorNav {
    reader: VectorNavReader,
    next_us: u64,
    started_us: u64,
    writes_text: bool,
    /// Divisor and fields of groups 1 and 3 of the first binary output.
    output: Option<(u64, u16, u16)>,
    is_sending: bool,
    bias_radps: f32,
    random: Pcg32,
}

impl VectorNav {
    /// Switched on at time 0.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut random = Pcg32::new(seed, 13);
        let bias_radps = random.normal() * 0.002;
        Self {
            reader: VectorNavReader::default(),
            next_us: 0,
            started_us: 0,
            writes_text: true,
            output: None,
            is_sending: true,
            bias_radps,
            random,
        }
    }

    /// Switched off and on again: starts after `off_us`, as delivered.
    pub fn power_cycle(&mut self, now_us: u64, off_us: u64) {
        self.started_us = now_us + off_us;
        self.next_us = self.next_us.max(self.started_us + BOOT_US).next_multiple_of(PERIOD_US);
        self.reader = VectorNavReader::default();
        (self.writes_text, self.output, self.is_sending) = (true, None, true);
    }

    /// The bias of the gyroscope about the vertical, counter-clockwise, rad/s.
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
        let noise = [self.random.normal_pair(), self.random.normal_pair(), self.random.normal_pair()];
        if !self.is_sending {
            return None;
        }
        let since_start_us = now_us - self.started_us;
        if let Some((divisor, common, imu)) = self.output
            && since_start_us.is_multiple_of(divisor * SAMPLE_US)
        {
            // Forward, right, down: at rest the floor pushes upward, which is against z.
            let sample = VectorNavSample {
                since_start_ns: since_start_us * 1_000,
                rate_radps: [
                    0.003 * noise[1].1,
                    0.003 * noise[2].0,
                    -(motion.yaw_radps + self.bias_radps) + 0.003 * noise[2].1,
                ],
                acceleration_mps2: [
                    motion.forward_mps2 + 0.02 * noise[0].0,
                    -motion.left_mps2 + 0.02 * noise[0].1,
                    -GRAVITY_MPS2 + 0.02 * noise[1].0,
                ],
                saturation: 0,
            };
            return Some(vectornav_frame(&sample, common, imu));
        }
        let is_text_due = (now_us / PERIOD_US).is_multiple_of(TEXT_EVERY);
        (self.writes_text && is_text_due).then(|| {
            let heading_deg = -motion.heading_rad.to_degrees();
            vectornav_sentence(&format!(
                "VNYMR,{heading_deg:+08.3},+000.100,+000.200,+00.2000,+00.0100,+00.4000,+00.000,+00.000,-09.810,\
                 +00.000000,+00.000000,+00.000000"
            ))
        })
    }

    /// Takes bytes from the host; the answers.
    pub fn receive(&mut self, bytes: &[u8], now_us: u64) -> Vec<u8> {
        let heard = self.reader.push(bytes);
        if now_us < self.started_us + if self.started_us == 0 { 0 } else { BOOT_US } {
            return Vec::new();
        }
        heard.into_iter().flat_map(|words| self.answer(words)).collect()
    }

    fn answer(&mut self, heard: Result<String, ()>) -> Vec<u8> {
        let error = |code: u8| vectornav_sentence(&format!("VNERR,{code:02X}"));
        let Ok(words) = heard else { return error(0x03) };
        let mut parts = words.split(',');
        let command = parts.next().unwrap_or_default();
        let numbers: Vec<&str> = parts.collect();
        match (command, numbers.as_slice()) {
            ("VNASY", [on @ ("0" | "1")]) => {
                self.is_sending = *on == "1";
                vectornav_sentence(&words)
            }
            ("VNRRG", ["1" | "01"]) => vectornav_sentence("VNRRG,01,VN-100S-CR"),
            ("VNWRG", ["6" | "06", kind]) => {
                self.writes_text = *kind != "0";
                vectornav_sentence(&format!("VNWRG,06,{kind}"))
            }
            ("VNWRG", ["75", ports, divisor, groups, fields @ ..]) => match output(divisor, groups, fields) {
                Some((divisor, common, imu)) => {
                    self.output = Some((divisor, common, imu)).filter(|_| *ports != "0");
                    let fields = [common, imu].into_iter().filter(|fields| *fields != 0);
                    let fields: String = fields.map(|fields| format!(",{fields:04X}")).collect();
                    vectornav_sentence(&format!("VNWRG,75,{ports},{divisor},{groups}{fields}"))
                }
                None => error(0x07),
            },
            ("VNRRG" | "VNWRG", [_, ..]) => error(0x08),
            _ => error(0x04),
        }
    }
}

/// Divisor and fields of the two groups that are known, if nothing else is asked for.
fn output(divisor: &str, groups: &str, fields: &[&str]) -> Option<(u64, u16, u16)> {
    let hexadecimal = |text: &str| u16::from_str_radix(text, 16).ok();
    let groups = hexadecimal(groups)?;
    let mut fields = fields.iter();
    let mut of_group = |bit: u16| match groups & bit {
        0 => Some(0),
        _ => hexadecimal(fields.next()?),
    };
    let (common, imu) = (of_group(1)?, of_group(4)?);
    let known: u16 = COMMON_FIELDS.iter().sum();
    let is_known = groups & !5 == 0 && common & !known == 0 && imu & !SATURATION_FIELD == 0;
    let divisor: u64 = divisor.parse().ok().filter(|divisor| *divisor > 0)?;
    (is_known && fields.next().is_none()).then_some((divisor, common, imu))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answers(device: &mut VectorNav, words: &str) -> String {
        String::from_utf8(device.receive(&vectornav_sentence(words), 0)).unwrap()
    }

    #[test]
    fn delivered_device_writes_text_until_set_up() {
        let mut device = VectorNav::new(1);
        let text = device.sample(0, Motion::default()).unwrap();
        assert!(text.starts_with(b"$VNYMR,"), "{text:?}");
        assert!(text.len() <= 144, "{}", text.len());
        assert_eq!(answers(&mut device, "VNASY,0"), "$VNASY,0*4F\r\n");
        assert_eq!(device.sample(30_000, Motion::default()), None);
        assert!(answers(&mut device, "VNRRG,1").starts_with("$VNRRG,01,VN-100S-CR*"));
        assert_eq!(answers(&mut device, "VNWRG,6,0"), "$VNWRG,06,0*6C\r\n");
        assert!(answers(&mut device, "VNWRG,75,3,8,5,121,800").starts_with("$VNWRG,75,3,8,5,0121,0800*"));
        assert_eq!(answers(&mut device, "VNASY,1"), "$VNASY,1*4E\r\n");
        let turning = Motion { yaw_radps: 1.0, ..Motion::default() };
        let frame = device.sample(40_000, turning).unwrap();
        assert_eq!((frame.len(), &frame[..6]), (42, &[0xFA, 5, 0x21, 1, 0, 8][..]));
        let down = f32::from_le_bytes(frame[22..26].try_into().unwrap());
        assert!((down + 1.0).abs() < 0.05, "to the left is negative about z: {down}");
    }

    #[test]
    fn what_it_cannot_is_an_error() {
        let mut device = VectorNav::new(1);
        for (words, code) in [
            ("VNWRG,75,3,8,02,0001", "07"),
            ("VNWRG,75,3,8,01,0129", "07"),
            ("VNWRG,75,3,0,01,0001", "07"),
            ("VNRRG,200", "08"),
            ("VNTAR,1", "04"),
        ] {
            assert!(answers(&mut device, words).starts_with(&format!("$VNERR,{code}*")), "{words}");
        }
        assert_eq!(device.receive(b"$VNASY,0*00\r\n", 0), vectornav_sentence("VNERR,03"));
    }

    #[test]
    fn power_takes_the_settings_with_it() {
        let mut device = VectorNav::new(1);
        answers(&mut device, "VNWRG,6,0");
        answers(&mut device, "VNWRG,75,1,8,01,0001");
        assert_eq!(device.sample(0, Motion::default()).map(|frame| frame[0]), Some(0xFA));
        device.power_cycle(100_000, 200_000);
        assert_eq!(device.receive(&vectornav_sentence("VNASY,0"), 500_000), [], "it is starting");
        assert!(device.due_us() >= 700_000);
        let spoken: Vec<u8> =
            (70..73).filter_map(|step| device.sample(step * 10_000, Motion::default())).flatten().collect();
        assert!(spoken.starts_with(b"$VNYMR,"));
    }
}
