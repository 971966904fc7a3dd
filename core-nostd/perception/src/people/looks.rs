//! Looks at the candidates once more: all their returns, for the shape of each.

use heapless::Vec;

use super::appearance::Shades;
use super::association::DETECTIONS_MAX;
use super::cluster::Cluster;
use super::shape::{SHAPE_FEATURES, ShapeBuilder, ShapeVector};
use floorguard_types::capacities::CLUSTERS_MAX;
use floorguard_types::geometry::Point3;

/// No candidate.
const NOBODY: u16 = u16::MAX;

/// Which cluster each candidate came from, and its shape. Slots are those of the list of detections.
#[derive(Clone, Debug)]
pub(super) struct Looks {
    slot_of_cluster: [u16; CLUSTERS_MAX],
    candidates: Vec<Look, DETECTIONS_MAX>,
}

/// One candidate.
#[derive(Clone, Copy, Debug)]
struct Look {
    /// Index of its cluster while its returns are gathered, then [`NOBODY`].
    cluster: u16,
    occluded: bool,
    bounds: [Point3; 2],
    builder: ShapeBuilder,
    shape: ShapeVector,
    shades: Shades,
}

impl Looks {
    pub(super) const fn new() -> Self {
        Self { slot_of_cluster: [NOBODY; CLUSTERS_MAX], candidates: Vec::new() }
    }

    pub(super) fn clear(&mut self) {
        self.candidates.clear();
    }

    /// The candidate of a slot; the slot is the next one or a used one, whose candidate is given up.
    pub(super) fn set(&mut self, slot: usize, index: usize, builder: ShapeBuilder, thing: &Cluster) {
        let look = Look {
            cluster: index as u16,
            occluded: thing.occluded,
            bounds: [thing.lower, thing.upper],
            builder,
            shape: [0.0; SHAPE_FEATURES],
            shades: Shades::default(),
        };
        match self.candidates.get_mut(slot) {
            Some(used) => *used = look,
            // As many slots as detections: never full.
            None => drop(self.candidates.push(look)),
        }
    }

    /// Begins a pass over the returns; false where nobody is to be looked at.
    pub(super) fn begin(&mut self) -> bool {
        self.slot_of_cluster.fill(NOBODY);
        let mut any = false;
        for (slot, look) in self.candidates.iter().enumerate().filter(|(_, look)| look.cluster != NOBODY) {
            if let Some(entry) = self.slot_of_cluster.get_mut(usize::from(look.cluster)) {
                *entry = slot as u16;
                any = true;
            }
        }
        any
    }

    /// The candidate that a cluster belongs to.
    pub(super) fn slot(&self, cluster: usize) -> Option<usize> {
        let slot = self.slot_of_cluster.get(cluster).copied().filter(|slot| *slot != NOBODY);
        slot.map(usize::from)
    }

    /// A return of a candidate.
    pub(super) fn add(&mut self, slot: usize, point: Point3, (ring, reflectivity): (usize, Option<&u8>)) {
        if let Some(look) = self.candidates.get_mut(slot) {
            look.builder.add(point, ring);
            look.shades.add(point.z_m, reflectivity);
        }
    }

    /// Ends the pass; hands out slot, shape, shades, top and whether it is half hidden of every candidate that was looked at in it.
    pub(super) fn finish(&mut self, mut found: impl FnMut(usize, &ShapeVector, &Shades, (f32, bool))) {
        for (slot, look) in self.candidates.iter_mut().enumerate().filter(|(_, look)| look.cluster != NOBODY)
        {
            look.shape = look.builder.finish(look.occluded);
            look.cluster = NOBODY;
            let [_, upper] = look.bounds;
            found(slot, &look.shape, &look.shades, (upper.z_m, look.occluded));
        }
    }

    /// Lowest and highest coordinates of a candidate's returns, robot frame.
    pub(super) fn bounds(&self, slot: usize) -> Option<[Point3; 2]> {
        self.candidates.get(slot).map(|look| look.bounds)
    }

    /// The shape of a candidate.
    pub(super) fn shape(&self, slot: usize) -> Option<&ShapeVector> {
        self.candidates.get(slot).map(|look| &look.shape)
    }
}
