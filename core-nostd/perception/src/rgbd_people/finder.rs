//! The whole finder: one picture in, people out.

use super::band::Band;
use super::detection::{RgbdCounters, RgbdDetection, RgbdKind, RgbdPeople};
use super::floor_frame::{CameraMount, FloorFrame};
use super::floor_grid::FloorGrid;
use super::leg_pairs::{Legs, pairs};
use super::leg_parts::LegCandidate;
use super::parameters::RgbdParameters;
use super::regions::Regions;
use super::upper_bodies::{Scene, UpperBodies};
use crate::floor::{ImageTooWide, Plane};
use floorguard_types::capacities::FLOOR_IMAGE_COLUMNS_MAX;
use floorguard_types::sensing::{ColorImage, DepthImage};

/// Legs this near to an upper body are its own, metres.
const SAME_PERSON_M: f32 = 0.5;

/// The finder of one camera. It remembers nothing from picture to picture.
#[derive(Clone, Debug)]
pub struct RgbdPeopleFinder {
    parameters: RgbdParameters,
    grid: FloorGrid,
    regions: Regions,
    upper_bodies: UpperBodies,
    band: Band,
    legs: Legs,
}

impl RgbdPeopleFinder {
    /// A finder with the given rules.
    #[must_use]
    pub fn new(parameters: RgbdParameters) -> Self {
        Self {
            parameters,
            grid: FloorGrid::default(),
            regions: Regions::default(),
            upper_bodies: UpperBodies::default(),
            band: Band::default(),
            legs: Legs::new(),
        }
    }

    /// What the finder was made with.
    #[must_use]
    pub const fn parameters(&self) -> &RgbdParameters {
        &self.parameters
    }

    /// Finds the people of a picture above a known floor. `colour` has the size of the depth picture and looks the same
    /// way; without it legs are judged by their shape alone. `mount` is the camera's foot point on the robot.
    ///
    /// # Errors
    /// The picture is wider than this profile's rows.
    pub fn find_people(
        &mut self,
        (image, colour): (&DepthImage<'_>, Option<&ColorImage<'_>>),
        plane: &Plane,
        mount: CameraMount,
    ) -> Result<RgbdPeople, ImageTooWide> {
        let width = image.width();
        if width > FLOOR_IMAGE_COLUMNS_MAX {
            return Err(ImageTooWide { width, columns_max: FLOOR_IMAGE_COLUMNS_MAX });
        }
        let frame = FloorFrame::new(self.parameters.camera, *plane);
        let scene = Scene { image: *image, frame, mount, parameters: self.parameters };
        let rules = self.parameters.upper_body;
        let mut found = RgbdPeople::default();
        found.counters.returns = self.grid.project(image, &frame, &rules);
        self.regions.locate(&self.grid, (image, &frame), &rules);
        self.find_legs(&scene, colour, &mut found.counters);
        let bodies = self.upper_bodies.search_all(&scene, &self.regions, &mut found.counters);
        let legs = pairs(&scene, &self.legs, &self.grid);
        merge(bodies, &legs, &mut found);
        found.counters.dropped = found.counters.dropped.saturating_add(self.regions.dropped);
        Ok(found)
    }

    /// Objects of the shape of a leg in the last picture.
    #[must_use]
    pub fn legs(&self) -> &[LegCandidate] {
        &self.legs
    }

    fn find_legs(&mut self, scene: &Scene<'_>, colour: Option<&ColorImage<'_>>, counters: &mut RgbdCounters) {
        self.legs.clear();
        self.band.read(&scene.image, &scene.frame, &scene.parameters);
        let last_row = u16::try_from(scene.image.height().saturating_sub(1)).unwrap_or(u16::MAX);
        for part in self.band.parts() {
            counters.leg_parts = counters.leg_parts.saturating_add(1);
            let Some(mut leg) = LegCandidate::of(part, &scene.parameters, last_row) else { continue };
            counters.leg_candidates = counters.leg_candidates.saturating_add(1);
            if let Some(colour) = colour.filter(|colour| colour.width() == scene.image.width()) {
                leg.colour((&scene.image, colour), &scene.frame, part);
            }
            if self.legs.push(leg).is_err() {
                counters.dropped = counters.dropped.saturating_add(1);
            }
        }
        counters.dropped = counters.dropped.saturating_add(self.band.dropped);
    }
}

/// One list: legs below an upper body make it certain, the others are people of their own.
fn merge(bodies: &[RgbdDetection], legs: &[RgbdDetection], found: &mut RgbdPeople) {
    for body in bodies {
        let near =
            |pair: &&RgbdDetection| body.position_in_base.distance(pair.position_in_base) < SAME_PERSON_M;
        let mut person = *body;
        if let Some(pair) = legs.iter().find(near) {
            person.kind = RgbdKind::UpperBodyAndLegs;
            person.confidence = 1.0 - (1.0 - body.confidence) * (1.0 - pair.confidence);
        }
        found.keep(person);
    }
    for pair in legs {
        let near =
            |body: &RgbdDetection| body.position_in_base.distance(pair.position_in_base) < SAME_PERSON_M;
        if !bodies.iter().any(near) {
            found.keep(*pair);
        }
    }
}
