//! Second pass over the candidates: all their returns, for the shape of each.

use crate::clusters::Cluster;
use crate::shapes::shape::{SHAPE_FEATURES, ShapeBuilder, ShapeVector};
use crate::tracking::Shades;
use floorguard_types::geometry::Point3;
use floorguard_types::number::truncating_u16;
use floorguard_types::profile::{Entry, List, ListOf, Profile, Table, TableOf};

/// No candidate.
const NO_CLUSTER: u16 = u16::MAX;

/// The slot of a candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Slot(u16);

impl Entry for Slot {
    const BLANK: Self = Self(NO_CLUSTER);
}

/// Which cluster each candidate came from, and its shape. Slots are those of the list of detections.
#[derive(Clone, Debug)]
pub(super) struct CandidateShapes<P: Profile> {
    slot_of_cluster: TableOf<Slot, P::Clusters>,
    candidates: ListOf<Look<P>, P::Detections>,
}

/// A candidate of which all returns are known.
pub(super) struct Examined<'a, P: Profile> {
    pub(super) slot: usize,
    pub(super) shape: &'a ShapeVector,
    pub(super) shades: &'a Shades<P>,
    /// Above the floor, metres.
    pub(super) top_m: f32,
    /// Something nearer hides a part of it.
    pub(super) is_occluded: bool,
    /// Its surface goes on above the height of people.
    pub(super) goes_on_above: bool,
}

/// Columns that end lower than this below the top are shoulders, metres.
const TOP_M: f32 = 0.4;
/// So many more columns must go on than end.
const ABOVE_MIN: i8 = 2;

/// One candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Look<P: Profile> {
    /// Index of its cluster while its returns are gathered, then [`NO_CLUSTER`].
    cluster: u16,
    occluded: bool,
    /// Columns whose surface goes on above the height of people, less those whose does not.
    above: i8,
    bounds: [Point3; 2],
    builder: ShapeBuilder,
    shape: ShapeVector,
    shades: Shades<P>,
}

impl<P: Profile> CandidateShapes<P> {
    pub(super) const fn new() -> Self {
        Self { slot_of_cluster: Entry::BLANK, candidates: List::EMPTY }
    }

    pub(super) fn clear(&mut self) {
        self.candidates.clear();
    }

    /// The candidate of a slot; the slot is the next one or a used one, whose candidate is given up.
    pub(super) fn set(&mut self, slot: usize, index: usize, builder: ShapeBuilder, cluster: &Cluster) {
        let candidate = Look {
            cluster: truncating_u16(index),
            occluded: cluster.occluded,
            above: 0,
            bounds: [cluster.lower, cluster.upper],
            builder,
            shape: [0.0; SHAPE_FEATURES],
            shades: Shades::NEW,
        };
        match self.candidates.get_mut(slot) {
            Some(used) => *used = candidate,
            // As many slots as detections: never full.
            None => drop(self.candidates.push(candidate)),
        }
    }

    /// Begins a pass over the returns; false where nobody is to be examined.
    pub(super) fn begin(&mut self) -> bool {
        self.slot_of_cluster.fill(Slot::BLANK);
        let mut any = false;
        for (slot, candidate) in
            self.candidates.iter().enumerate().filter(|(_, candidate)| candidate.cluster != NO_CLUSTER)
        {
            if let Some(entry) = self.slot_of_cluster.get_mut(usize::from(candidate.cluster)) {
                *entry = Slot(truncating_u16(slot));
                any = true;
            }
        }
        any
    }

    /// The candidate that a cluster belongs to.
    pub(super) fn slot(&self, cluster: usize) -> Option<usize> {
        let slot = self.slot_of_cluster.get(cluster).copied().filter(|slot| *slot != Slot::BLANK);
        slot.map(|Slot(slot)| usize::from(slot))
    }

    /// A return of a candidate.
    pub(super) fn add(&mut self, slot: usize, point: Point3, (ring, reflectivity): (usize, Option<&u8>)) {
        if let Some(candidate) = self.candidates.get_mut(slot) {
            candidate.builder.add(point, ring);
            candidate.shades.add(point.z_m, reflectivity);
        }
    }

    /// The highest return of a candidate in a column; `goes_on` says that its surface does, above the height of people.
    pub(super) fn add_top(&mut self, slot: usize, height_m: f32, goes_on: bool) {
        if let Some(candidate) = self.candidates.get_mut(slot) {
            let [_, upper] = candidate.bounds;
            if height_m >= upper.z_m - TOP_M {
                candidate.above = candidate.above.saturating_add(if goes_on { 1 } else { -1 });
            }
        }
    }

    /// Ends the pass; hands out every candidate that was examined in it.
    pub(super) fn finish(&mut self, mut found: impl FnMut(&Examined<'_, P>)) {
        for (slot, candidate) in
            self.candidates.iter_mut().enumerate().filter(|(_, candidate)| candidate.cluster != NO_CLUSTER)
        {
            candidate.shape = candidate.builder.finish(candidate.occluded);
            candidate.cluster = NO_CLUSTER;
            let [_, upper] = candidate.bounds;
            found(&Examined {
                slot,
                shape: &candidate.shape,
                shades: &candidate.shades,
                top_m: upper.z_m,
                is_occluded: candidate.occluded,
                goes_on_above: candidate.above >= ABOVE_MIN,
            });
        }
    }

    /// Lowest and highest coordinates of a candidate's returns, robot frame.
    pub(super) fn bounds(&self, slot: usize) -> Option<[Point3; 2]> {
        self.candidates.get(slot).map(|candidate| candidate.bounds)
    }

    /// The shape of a candidate.
    pub(super) fn shape(&self, slot: usize) -> Option<&ShapeVector> {
        self.candidates.get(slot).map(|candidate| &candidate.shape)
    }
}
