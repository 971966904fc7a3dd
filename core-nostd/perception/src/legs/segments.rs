//! Cuts a scan into segments: returns that lie close together. Source: book, Legs: Segments.

use floorguard_types::geometry::Point2;
use floorguard_types::number::{nearest_f32, truncating_u16};
use floorguard_types::profile::{Entry, Native, Profile, Size, Table, TableOf};
use floorguard_types::sensing::{BeamReturn, ScanOf};

/// A return is compared with this many beams before it: bridges four that are missing.
const BEAMS_BACK: usize = 5;
/// No segment.
const NONE: u16 = u16::MAX;

/// One segment: its returns in the order of the beams.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment<'a> {
    /// The returns, sensor frame, metres.
    pub points: &'a [Point2],
    /// What the beam before the first one hit, where it hit something.
    pub previous: Option<Point2>,
    /// What the beam after the last one hit.
    pub next: Option<Point2>,
}

/// Working memory and result; one a scanner.
#[derive(Clone, Debug)]
pub struct SegmentsOf<P: Profile> {
    points: TableOf<Option<Point2>, P::Beams>,
    /// Per beam its label; labels count up from 0.
    labels: TableOf<u16, P::Beams>,
    /// Per label the label it was joined with, which is smaller, or itself.
    parents: TableOf<u16, P::Beams>,
    /// Per label the number of its returns, then the place after its last one.
    ends: TableOf<u16, P::Beams>,
    /// Returns sorted by segment, and the beam of each.
    sorted: TableOf<Point2, P::Beams>,
    beams: TableOf<u16, P::Beams>,
    label_count: usize,
}

/// The same in the memory of the target.
pub type Segments = SegmentsOf<Native>;

impl<P: Profile> Default for SegmentsOf<P> {
    fn default() -> Self {
        Self::new()
    }
}

impl<P: Profile> SegmentsOf<P> {
    /// Nothing yet.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            points: Entry::BLANK,
            labels: Entry::BLANK,
            parents: Entry::BLANK,
            ends: Entry::BLANK,
            sorted: Entry::BLANK,
            beams: Entry::BLANK,
            label_count: 0,
        }
    }

    /// Cuts a scan: returns nearer to each other than `gap_m`, at most five beams apart, belong together. Linear.
    pub fn cut(&mut self, scan: &ScanOf<P>, gap_m: f32) {
        for ((index, point), beam) in self.points.iter_mut().enumerate().zip(scan.beams.iter()) {
            *point = hit(*beam, scan.first_angle_rad + scan.step_rad * nearest_f32(index));
        }
        let used = scan.beams.len().min(P::Beams::N);
        self.points.iter_mut().skip(used).for_each(|point| *point = None);
        self.label(used, gap_m);
        self.sort(used);
    }

    /// Labels of the newest beams are always those that nothing was joined into later: joining relabels them.
    fn label(&mut self, used: usize, gap_m: f32) {
        self.label_count = 0;
        // Newest first: point and label.
        let mut newest: [Option<(Point2, u16)>; BEAMS_BACK] = [None; BEAMS_BACK];
        for (index, slot) in self.labels.iter_mut().enumerate().take(used) {
            *slot = NONE;
            let Some(point) = self.points.get(index).copied().flatten() else {
                newest.rotate_right(1);
                newest[0] = None;
                continue;
            };
            let mut label = NONE;
            for (other, theirs) in newest.iter().flatten() {
                if other.distance(point) < gap_m {
                    label = label.min(*theirs);
                }
            }
            if label == NONE {
                label = truncating_u16(self.label_count);
                if let Some(parent) = self.parents.get_mut(self.label_count) {
                    *parent = label;
                }
                self.label_count = self.label_count.saturating_add(1);
            }
            for (other, theirs) in newest.iter_mut().flatten() {
                let joins = other.distance(point) < gap_m && *theirs != label;
                if joins && let Some(parent) = self.parents.get_mut(usize::from(*theirs)) {
                    *parent = label;
                }
            }
            // The others of a joined segment follow.
            for (_, theirs) in newest.iter_mut().flatten() {
                *theirs = self.parents.get(usize::from(*theirs)).copied().unwrap_or(*theirs);
            }
            *slot = label;
            newest.rotate_right(1);
            newest[0] = Some((point, label));
        }
    }

    /// Puts the returns of a segment beside each other, in the order of the beams.
    fn sort(&mut self, used: usize) {
        self.ends.fill(0);
        for label in 0..self.label_count.min(P::Beams::N) {
            // A parent is smaller, so its own parent is already final.
            let parent = self.parents.get(label).copied().unwrap_or(0);
            let root = self.parents.get(usize::from(parent)).copied().unwrap_or(parent);
            if let Some(slot) = self.parents.get_mut(label) {
                *slot = root;
            }
        }
        for label in self.labels.iter_mut().take(used).filter(|label| **label != NONE) {
            *label = self.parents.get(usize::from(*label)).copied().unwrap_or(NONE);
            if let Some(count) = self.ends.get_mut(usize::from(*label)) {
                *count = count.saturating_add(1);
            }
        }
        let mut start = 0_u16;
        for end in self.ends.iter_mut().take(self.label_count) {
            let count = *end;
            *end = start;
            start = start.saturating_add(count);
        }
        for (index, label) in self.labels.iter().enumerate().take(used).filter(|(_, label)| **label != NONE) {
            let Some(end) = self.ends.get_mut(usize::from(*label)) else { continue };
            let point = self.points.get(index).copied().flatten();
            let slot = self.sorted.get_mut(usize::from(*end)).zip(self.beams.get_mut(usize::from(*end)));
            if let (Some(point), Some((place, beam))) = (point, slot) {
                (*place, *beam) = (point, truncating_u16(index));
            }
            *end = end.saturating_add(1);
        }
    }

    /// The segments of the newest scan.
    pub fn iter(&self) -> impl Iterator<Item = Segment<'_>> {
        let ends = self.ends.iter().take(self.label_count).map(|end| usize::from(*end));
        let starts = core::iter::once(0).chain(ends.clone());
        starts.zip(ends).filter_map(|(start, end)| {
            let points = self.sorted.as_ref().get(start..end).filter(|points| !points.is_empty())?;
            let beams = self.beams.as_ref().get(start..end)?;
            let at = |beam: Option<usize>| beam.and_then(|beam| self.points.get(beam).copied().flatten());
            let previous = at(beams.first().and_then(|beam| usize::from(*beam).checked_sub(1)));
            let next = at(beams.last().and_then(|beam| usize::from(*beam).checked_add(1)));
            Some(Segment { points, previous, next })
        })
    }
}

fn hit(beam: BeamReturn, angle_rad: f32) -> Option<Point2> {
    let BeamReturn::Hit(range_mm) = beam else { return None };
    let range_m = f32::from(range_mm) * 1.0e-3;
    let (sin, cos) = libm::sincosf(angle_rad);
    (range_mm > 0).then(|| Point2::new(range_m * cos, range_m * sin))
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec::Vec;

    use floorguard_types::sensing::Scan;

    use super::*;

    fn scan(ranges_mm: &[u16]) -> Scan {
        let mut scan = Scan { step_rad: 0.01, ..Scan::default() };
        for range_mm in ranges_mm {
            let beam = if *range_mm == 0 { BeamReturn::Unknown } else { BeamReturn::Hit(*range_mm) };
            scan.beams.push(beam).expect("room");
        }
        scan
    }

    fn sizes(ranges_mm: &[u16]) -> Vec<usize> {
        let mut segments = Box::new(Segments::new());
        segments.cut(&scan(ranges_mm), 0.1);
        segments.iter().map(|segment| segment.points.len()).collect()
    }

    #[test]
    fn jumps_cut_and_missing_beams_do_not() {
        assert_eq!(sizes(&[1_000, 1_000, 1_010, 2_000, 2_000]), [3, 2]);
        assert_eq!(sizes(&[1_000, 0, 0, 0, 0, 1_000, 1_000]), [3]);
        assert_eq!(sizes(&[1_000, 0, 0, 0, 0, 0, 1_000]), [1, 1]);
        assert_eq!(sizes(&[0, 0]), [0; 0]);
    }

    #[test]
    fn thin_foreground_does_not_split_background() {
        assert_eq!(sizes(&[2_000, 2_000, 1_000, 1_000, 2_000, 2_000]), [4, 2]);
    }

    /// Two that began apart meet later; what was joined with them before follows.
    #[test]
    fn segments_that_meet_become_one() {
        assert_eq!(sizes(&[1_000, 1_150, 1_000, 1_150, 1_075, 1_075]), [6]);
        assert_eq!(sizes(&[1_000, 1_150, 1_300, 1_075, 1_225, 1_300]), [6]);
    }

    #[test]
    fn neighbours_are_known_across_segments() {
        let mut segments = Box::new(Segments::new());
        segments.cut(&scan(&[3_000, 1_000, 1_000, 1_000, 0]), 0.1);
        let leg = segments.iter().nth(1).expect("two segments");
        assert!(leg.previous.is_some_and(|point| (point.norm() - 3.0).abs() < 1e-5));
        assert_eq!((leg.points.len(), leg.next), (3, None));
    }

    /// Every return is in exactly one segment, and two that are linked are in the same, whatever the scan.
    #[test]
    fn random_scans_agree_with_the_definition() {
        let mut random = floorguard_types::random::Pcg32::new(5, 1);
        for _ in 0..200 {
            let ranges: Vec<u16> = (0..60).map(|_| 1_000 + 60 * random.below(6) as u16).collect();
            let mut segments = Box::new(Segments::new());
            segments.cut(&scan(&ranges), 0.1);
            let members: Vec<Vec<Point2>> = segments.iter().map(|segment| segment.points.to_vec()).collect();
            assert_eq!(members.iter().map(Vec::len).sum::<usize>(), ranges.len());
            let points: Vec<Point2> = segments.points.iter().flatten().copied().collect();
            let of = |point: Point2| members.iter().position(|each| each.contains(&point));
            for (index, point) in points.iter().enumerate() {
                for other in points.iter().skip(index + 1).take(BEAMS_BACK) {
                    if point.distance(*other) < 0.1 {
                        assert_eq!(of(*point), of(*other));
                    }
                }
            }
        }
    }
}
