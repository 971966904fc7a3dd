//! A room as both scanners see it: a ring of sectors, each with a pattern and a range.

use crate::campaign::Random;

/// Sectors of the lidar, 4° each.
pub const LIDAR_SECTORS: usize = 90;
/// Sectors of the safety scanner, 10 beams each, the last one a beam longer.
pub const SCANNER_SECTORS: usize = 54;
/// Patterns of [`Sector`].
pub const PATTERNS: u8 = 10;
/// A step of range, metres.
const STEP_M: f32 = 0.05;

/// What one sector shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sector {
    /// 0 nothing; 1 the floor; 2 a wall; 3 poles; 4 a chequer; 5 noise; 6 stairs; 7 a person; 8 a fence of gaps; 9 noise
    /// over the floor.
    pub pattern: u8,
    /// Range, steps of 5 cm.
    pub steps: u8,
}

impl Sector {
    /// Range, metres.
    #[must_use]
    pub fn range_m(self) -> f32 {
        0.4 + f32::from(self.steps) * STEP_M
    }
}

/// The whole room.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scene {
    /// Of the lidar, clockwise from the front.
    pub lidar: Vec<Sector>,
    /// Of the safety scanner, from its first beam.
    pub scanner: Vec<Sector>,
}

fn drawn(random: &mut Random) -> Sector {
    Sector { pattern: random.below(u64::from(PATTERNS)) as u8, steps: random.below(256) as u8 }
}

impl Scene {
    /// Anything: every sector for itself, or long stretches of one kind.
    #[must_use]
    pub fn random(random: &mut Random) -> Self {
        let stretch = 1 + random.below(30) as usize;
        let mut ring = |sectors: usize| {
            let mut sector = drawn(random);
            (0..sectors)
                .map(|index| {
                    if index % stretch == 0 {
                        sector = drawn(random);
                    }
                    sector
                })
                .collect()
        };
        Self { lidar: ring(LIDAR_SECTORS), scanner: ring(SCANNER_SECTORS) }
    }

    /// A neighbour: a stretch of one ring drawn anew, shifted in range, or copied from elsewhere.
    #[must_use]
    pub fn mutated(&self, random: &mut Random) -> Self {
        let mut scene = self.clone();
        let ring = if random.seldom(3) { &mut scene.scanner } else { &mut scene.lidar };
        let length = ring.len() as u64;
        let (from, longest) = (random.below(length), 1 + random.below(length / 2));
        let count = 1 + random.below(longest);
        let (new, shift, source) = (drawn(random), random.below(21) as i16 - 10, random.below(length));
        let kind = random.below(4);
        let before = ring.clone();
        for step in 0..count {
            let at = ((from + step) % length) as usize;
            let sector = &mut ring[at];
            match kind {
                0 => *sector = new,
                1 => sector.steps = (i16::from(sector.steps) + shift).clamp(0, 255) as u8,
                2 => sector.pattern = new.pattern,
                _ => *sector = before[((source + step) % length) as usize],
            }
        }
        scene
    }

    /// Three hexadecimal digits a sector: pattern, range.
    #[must_use]
    pub fn to_text(&self) -> [String; 2] {
        let text = |ring: &[Sector]| {
            ring.iter().map(|sector| format!("{:x}{:02x}", sector.pattern, sector.steps)).collect()
        };
        [text(&self.lidar), text(&self.scanner)]
    }

    /// From [`Self::to_text`]; `None` where it is none.
    #[must_use]
    pub fn from_text(lidar: &str, scanner: &str) -> Option<Self> {
        let ring = |text: &str, sectors: usize| -> Option<Vec<Sector>> {
            let digits: Vec<u8> = text
                .chars()
                .map(|digit| digit.to_digit(16).map(|value| value as u8))
                .collect::<Option<_>>()?;
            let ring =
                digits.chunks_exact(3).map(|part| Sector { pattern: part[0], steps: part[1] * 16 + part[2] });
            let ring: Vec<Sector> = ring.collect();
            (ring.len() == sectors && digits.len() == 3 * sectors).then_some(ring)
        };
        Some(Self { lidar: ring(lidar, LIDAR_SECTORS)?, scanner: ring(scanner, SCANNER_SECTORS)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::Slice;

    #[test]
    fn a_scene_survives_being_written_down() {
        let mut random = Slice::from_environment(1).random(3);
        let mut scene = Scene::random(&mut random);
        for _ in 0..50 {
            let [lidar, scanner] = scene.to_text();
            assert_eq!(Scene::from_text(&lidar, &scanner), Some(scene.clone()));
            scene = scene.mutated(&mut random);
        }
        assert_eq!(Scene::from_text("1", ""), None);
    }
}
