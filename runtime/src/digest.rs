//! A fingerprint of everything that the robot puts out, equal on every machine that runs the same tasks on the same
//! bytes.

use floorguard_drivers::can::CanFrame;

use crate::shared::{PeopleReport, RobotStatus};
use crate::tape::frame_identifier;

/// FNV-1a, 64 bits (Fowler, Noll, Vo): offset basis and prime of the published algorithm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fnv64(u64);

impl Fnv64 {
    /// Of nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Adds bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// The number.
    #[must_use]
    pub const fn value(self) -> u64 {
        self.0
    }
}

impl Default for Fnv64 {
    fn default() -> Self {
        Self::new()
    }
}

/// Drive frames, people and decisions, each in its own order, so that it does not matter when it is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OutputDigest {
    frames: Fnv64,
    people: Fnv64,
    decisions: Fnv64,
    counts: [u32; 3],
}

impl OutputDigest {
    /// A frame of the robot on the bus.
    pub fn on_frame(&mut self, frame: &CanFrame, now_us: u64) {
        self.frames.add(&now_us.to_le_bytes());
        self.frames.add(&frame_identifier(frame).unwrap_or(u16::MAX).to_le_bytes());
        self.frames.add(frame.payload());
        self.count(0);
    }

    /// What a sweep showed.
    pub fn on_people(&mut self, report: &PeopleReport) {
        self.people.add(&report.sweep.stamp.as_micros().to_le_bytes());
        self.people.add(&report.sweep.counters.points.to_le_bytes());
        self.people.add(&report.sweep.counters.clusters.to_le_bytes());
        for person in &report.people {
            self.people.add(&person.id.to_le_bytes());
            self.people.add(&[person.sensors.bits()]);
            let place = [person.position, person.velocity_mps];
            for number in place.iter().flat_map(|place| [place.x_m, place.y_m]) {
                self.people.add(&number.to_bits().to_le_bytes());
            }
        }
        self.count(1);
    }

    /// How probably each is a person; after [`Self::on_people`], for robots that learn: else it follows from the rest.
    pub fn on_probabilities(&mut self, report: &PeopleReport) {
        for person in &report.people {
            self.people.add(&person.person_probability.to_bits().to_le_bytes());
        }
    }

    /// How everything was, ten times a second.
    pub fn on_status(&mut self, status: &RobotStatus) {
        let decision = &status.decision;
        self.decisions.add(&decision.stamp.as_micros().to_le_bytes());
        self.decisions.add(&[decision.action as u8, decision.state as u8, decision.field_set as u8]);
        let pose = status.pose.pose_in_odometry;
        let numbers = [
            decision.permitted.linear_mps,
            decision.permitted.angular_radps,
            decision.speed_limit_mps,
            pose.x_m,
            pose.y_m,
            pose.heading_rad,
        ];
        for number in numbers {
            self.decisions.add(&number.to_bits().to_le_bytes());
        }
        self.count(2);
    }

    fn count(&mut self, which: usize) {
        if let Some(count) = self.counts.get_mut(which) {
            *count = count.saturating_add(1);
        }
    }

    /// Frames, reports about people, and decisions that went in.
    #[must_use]
    pub const fn counts(&self) -> [u32; 3] {
        self.counts
    }

    /// The fingerprints of frames, people and decisions.
    #[must_use]
    pub const fn parts(&self) -> [u64; 3] {
        [self.frames.value(), self.people.value(), self.decisions.value()]
    }

    /// All in one.
    #[must_use]
    pub fn value(&self) -> u64 {
        let mut all = Fnv64::new();
        for part in self.parts() {
            all.add(&part.to_le_bytes());
        }
        all.value()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vectors of the authors' test suite.
    #[test]
    fn published_vectors() {
        let digest = |text: &str| {
            let mut digest = Fnv64::new();
            digest.add(text.as_bytes());
            digest.value()
        };
        assert_eq!(digest(""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(digest("a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(digest("foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn order_matters_only_within_a_kind() {
        let [a, b] = [1, 2].map(|id| CanFrame::standard(id, &[7]));
        let people = PeopleReport::default();
        let mut one = OutputDigest::default();
        one.on_frame(&a, 1);
        one.on_people(&people);
        one.on_frame(&b, 2);
        let mut two = OutputDigest::default();
        two.on_frame(&a, 1);
        two.on_frame(&b, 2);
        two.on_people(&people);
        assert_eq!(one, two);
        let mut three = OutputDigest::default();
        three.on_frame(&b, 2);
        three.on_frame(&a, 1);
        three.on_people(&people);
        assert_ne!(one.value(), three.value());
    }
}
