//! From a picture to people.

use floorguard_mapping::people_removal::PersonBox;

use super::layout::{Layout, LayoutError};
use super::letterbox::Letterbox;
use super::model::{Model, ModelError};
use super::picture::RgbPicture;
use super::suppression::suppress;

/// Settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetectorConfig {
    /// Number of the class that is a person; 0 in models of COCO's 80 classes.
    pub class: usize,
    /// Boxes with a lower score are left out, 0 to 1.
    pub score_min: f32,
    /// Boxes that overlap by more show the same person: intersection over union, 0 to 1.
    pub overlap_max: f32,
    /// People of a picture, at most.
    pub most: usize,
}

impl Default for DetectorConfig {
    /// Class 0 from 0.3 on, overlap up to 0.45, 32 people.
    fn default() -> Self {
        Self { class: 0, score_min: 0.3, overlap_max: 0.45, most: 32 }
    }
}

/// Why a picture gives no answer.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DetectorError {
    /// The model fails.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Its output cannot be read.
    #[error(transparent)]
    Layout(#[from] LayoutError),
}

/// A model and how its output is read.
pub struct Detector {
    model: Box<dyn Model>,
    layout: Layout,
    config: DetectorConfig,
}

impl Detector {
    /// Runs the model once on an empty frame: its output says the layout.
    ///
    /// # Errors
    /// The model fails, or has another output.
    pub fn new(mut model: Box<dyn Model>, config: DetectorConfig) -> Result<Self, DetectorError> {
        let frame = model.frame();
        let output = model.run(vec![0.0; 3 * frame[0] as usize * frame[1] as usize])?;
        let layout = Layout::of(&output.shape, frame)?;
        Ok(Self { model, layout, config })
    }

    /// The layout that was found.
    #[must_use]
    pub const fn layout(&self) -> Layout {
        self.layout
    }

    /// People, the surest first; edges are pixels of the picture. Cost: one run of the model.
    ///
    /// # Errors
    /// The model fails.
    pub fn detect(&mut self, picture: &RgbPicture) -> Result<Vec<PersonBox>, DetectorError> {
        let frame = self.model.frame();
        let letterbox = Letterbox::new(picture.size(), frame, self.layout.placing());
        let (channels, factor) = self.layout.colours();
        let output = self.model.run(letterbox.fill(picture, channels, factor))?;
        let config = self.config;
        let candidates = self.layout.candidates(&output, frame, (config.class, config.score_min));
        let people = suppress(candidates, config.overlap_max, config.most);
        Ok(people
            .into_iter()
            .map(|each| {
                let [left, top, right, bottom] = each.edges;
                PersonBox {
                    confidence: each.score,
                    upper_left: letterbox.to_picture([left, top]),
                    lower_right: letterbox.to_picture([right, bottom]),
                }
            })
            .collect())
    }
}
