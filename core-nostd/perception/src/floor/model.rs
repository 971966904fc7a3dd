//! The floor from frame to frame: fit, gate, reuse for a while, then the configured plane — and whether it is known.
//!
//! A frame that shows no floor says nothing about the floor. The last good plane serves for two seconds, because a
//! camera does not move on its robot; then the mounting does. But after one second without a fit the floor is
//! unknown, neither free nor clean: [`FloorEstimate::is_known`] (book, Floor and dirt: Validity).

use core::marker::PhantomData;

use super::curvature::Curvature;
use super::depth_noise::DepthNoise;
use super::gate::{FitFault, FitLimits, check};
use super::lattice::Lattice;
use super::plane::Plane;
use super::refine::{BANDS_AFTER_PREDICTION_M, BANDS_AFTER_SEARCH_M, FitQuality, quality, refine};
use super::search::{Expectation, search};
use floorguard_types::number::nearest_f32;
use floorguard_types::profile::{Native, Profile};
use floorguard_types::random::Pcg32;
use floorguard_types::sensing::{DepthImage, FrameFault, FrameWatch, PinholeCamera};
use floorguard_types::time::{Age, Stamp};

/// A good plane serves this long after its frame, µs (book, Floor and dirt: Validity).
pub const REUSE_MAX_US: u64 = 2_000_000;
/// Without a good frame for this long the floor is unknown, µs (book, Floor and dirt: Validity).
pub const KNOWN_MAX_US: u64 = 1_000_000;
/// Fewest returns of an image, as a part of its pixels; fewer are sunlight or a covered lens (book,
/// Floor and dirt: Validity).
const RETURNS_MIN: f32 = 0.02;

/// Camera, noise and limits of a floor model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloorParameters {
    /// The depth camera.
    pub camera: PinholeCamera,
    /// Its noise.
    pub noise: DepthNoise,
    /// What the mounting allows.
    pub expectation: Expectation,
    /// When a fit is valid.
    pub limits: FitLimits,
    /// Lattice points a row, see [`Profile::FLOOR_LATTICE_COLUMNS`] (book, Floor and dirt: Floor plane).
    pub lattice_columns: u16,
    /// Range in which curvature is fitted and objects are looked for, metres (book, Floor and dirt: Objects).
    pub working_range_m: f32,
}

impl FloorParameters {
    /// The usual limits for a camera that is `height_m` above the floor and looks down by `pitch_rad`: 10° and 8 cm
    /// around the mounting. `None` for a mounting that makes no plane.
    #[must_use]
    pub fn mounted(camera: PinholeCamera, height_m: f32, pitch_rad: f32) -> Option<Self> {
        let mounted = Plane::of_mounting(height_m, pitch_rad)?;
        let expectation = Expectation {
            mounted,
            tilt_max_rad: 0.174_533,
            distance_range_m: [height_m - 0.08, height_m + 0.08],
        };
        Some(Self::expecting(camera, expectation))
    }

    /// The usual limits around an expectation.
    #[must_use]
    pub fn expecting(camera: PinholeCamera, expectation: Expectation) -> Self {
        Self {
            camera,
            noise: DepthNoise::NGUYEN,
            expectation,
            limits: FitLimits::default(),
            lattice_columns: Native::FLOOR_LATTICE_COLUMNS,
            working_range_m: 2.0,
        }
    }
}

/// Why a frame brought no plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FloorFault {
    /// Too few pixels have a depth.
    NoReturns {
        /// Pixels with a depth.
        found: usize,
        /// Pixels that were looked at.
        pixels: usize,
    },
    /// The frame is none of a living camera's.
    Frame(FrameFault),
    /// No plane that faces up and has nothing below it.
    NoPlane,
    /// A plane, but not the floor.
    Rejected(FitFault),
}

impl core::fmt::Display for FloorFault {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::NoReturns { found, pixels: of } => {
                write!(formatter, "only {found} of {of} pixels have a depth: sunlight, or a covered camera")
            }
            Self::Frame(fault) => write!(formatter, "{fault}"),
            Self::NoPlane => write!(formatter, "no floor in the image"),
            Self::Rejected(fault) => write!(formatter, "{fault}"),
        }
    }
}

impl core::error::Error for FloorFault {}

/// Where a plane comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FloorSource {
    /// Fitted to this frame.
    Measured,
    /// Fitted to an earlier frame, this many µs ago.
    Reused(u64),
    /// The mounting.
    Configured,
}

/// The floor as of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloorEstimate {
    /// The plane.
    pub plane: Plane,
    /// What it is not plane by.
    pub curvature: Curvature,
    /// Where the plane comes from.
    pub source: FloorSource,
    /// False where the floor is unknown, neither free nor clean.
    pub is_known: bool,
    /// The last fit's quality.
    pub quality: FitQuality,
    /// Why this frame brought no plane.
    pub fault: Option<FloorFault>,
}

#[derive(Clone, Copy, Debug)]
struct Good {
    plane: Plane,
    curvature: Curvature,
    stamp: Stamp,
}

/// The floor under one camera. Invariant: `good` passed the gate.
///
/// ```
/// use floorguard_perception::floor::{FloorModel, FloorParameters, FloorSource, Plane};
/// use floorguard_types::sensing::{DepthImage, ImageSize, PinholeCamera};
/// use floorguard_types::time::Stamp;
///
/// // What a camera would see of a level floor, 0.9 m below it.
/// let camera = PinholeCamera::new([131.25, 131.25], [79.5, 59.5]).unwrap();
/// let level = Plane::of_mounting(0.9, 0.7).unwrap();
/// let depth_mm: Vec<u16> = (0..120_u8).flat_map(|row| (0..160_u8).map(move |column| (column, row)))
///     .map(|(column, row)| {
///         let ray = camera.ray(f32::from(column), f32::from(row));
///         (900.0 / (0.9 - level.height_m(ray))).round() as u16
///     })
///     .collect();
/// let size = ImageSize { width: 160, height: 120 };
/// let image = DepthImage::new(Stamp::from_micros(40_000), size, &depth_mm).unwrap();
///
/// let mut model = FloorModel::new(FloorParameters::mounted(camera, 0.9, 0.7).unwrap(), 1);
/// let estimate = model.update(&image, Stamp::from_micros(50_000));
/// assert!(matches!(estimate.source, FloorSource::Measured) && estimate.is_known);
/// assert!((estimate.plane.distance_m - 0.9).abs() < 0.005);
/// assert!(estimate.plane.tilt_from_rad(&level) < 0.005);
/// ```
#[derive(Clone, Debug)]
pub struct FloorModelOf<P: Profile> {
    parameters: FloorParameters,
    random: Pcg32,
    good: Option<Good>,
    watch: FrameWatch,
    profile: PhantomData<P>,
}

/// A model in the memory of the target.
pub type FloorModel = FloorModelOf<Native>;

impl<P: Profile> FloorModelOf<P> {
    /// A model that has seen nothing; `seed` drives the search.
    #[must_use]
    pub const fn new(parameters: FloorParameters, seed: u64) -> Self {
        Self {
            parameters,
            random: Pcg32::new(seed, 0xF1),
            good: None,
            watch: FrameWatch::NEW,
            profile: PhantomData,
        }
    }

    /// What the model was made with.
    #[must_use]
    pub const fn parameters(&self) -> &FloorParameters {
        &self.parameters
    }

    /// Takes a frame; `now` is the time of the call.
    pub fn update(&mut self, image: &DepthImage<'_>, now: Stamp) -> FloorEstimate {
        match self.fit(image, now) {
            Ok((good, quality)) => {
                self.good = Some(good);
                self.estimate(now, Ok(quality))
            }
            Err(fault) => self.estimate(now, Err(fault)),
        }
    }

    /// The floor when no frame came: the camera is silent.
    #[must_use]
    pub fn without_frame(&self, now: Stamp) -> FloorEstimate {
        self.estimate(now, Err(FloorFault::NoReturns { found: 0, pixels: 0 }))
    }

    fn fit(&mut self, image: &DepthImage<'_>, now: Stamp) -> Result<(Good, FitQuality), FloorFault> {
        self.accept(image, now)?;
        let FloorParameters { camera, noise, expectation, limits, lattice_columns, working_range_m } =
            self.parameters;
        let lattice = Lattice::new(*image, camera, lattice_columns);
        let predicted = self.good.filter(|good| age_us(good.stamp, now) <= REUSE_MAX_US);
        // A prediction that no longer holds (the camera was knocked) must not block the search.
        let mut result = Err(FloorFault::NoPlane);
        if let Some(good) = predicted {
            result = refine(&lattice, &noise, good.plane, &BANDS_AFTER_PREDICTION_M)
                .ok_or(FloorFault::Rejected(FitFault::Degenerate))
                .and_then(|plane| judged(&lattice, &noise, plane, (&limits, &expectation)));
        }
        if result.is_err() {
            let start = search::<P::FloorSamples>(&lattice, &expectation, &mut self.random)
                .ok_or(FloorFault::NoPlane)?;
            result = refine(&lattice, &noise, start, &BANDS_AFTER_SEARCH_M)
                .ok_or(FloorFault::Rejected(FitFault::Degenerate))
                .and_then(|plane| judged(&lattice, &noise, plane, (&limits, &expectation)));
        }
        let (plane, quality) = result?;
        let curvature = Curvature::fit(&lattice, &noise, &plane, working_range_m);
        Ok((Good { plane, curvature, stamp: image.stamp() }, quality))
    }

    /// Questions to the frame before anybody looks for a plane in it.
    fn accept(&mut self, image: &DepthImage<'_>, now: Stamp) -> Result<(), FloorFault> {
        let fingerprint = image.fingerprint();
        let living = self.watch.accept(image.stamp(), fingerprint, now).map_err(FloorFault::Frame);
        // A frozen image without a return is a dark camera first.
        if let Err(FloorFault::Frame(FrameFault::FromTheFuture(_) | FrameFault::OutOfOrder)) = living {
            return living;
        }
        let (returns, pixels) = (image.returns(), image.depth_mm().len());
        if nearest_f32(returns) < RETURNS_MIN * nearest_f32(pixels) || returns == 0 {
            return Err(FloorFault::NoReturns { found: returns, pixels });
        }
        living
    }

    fn estimate(&self, now: Stamp, result: Result<FitQuality, FloorFault>) -> FloorEstimate {
        let age = self.good.map_or(u64::MAX, |good| age_us(good.stamp, now));
        let usable = self.good.filter(|_| age <= REUSE_MAX_US);
        let configured = self.parameters.expectation.mounted;
        let source = match (result, usable) {
            (Ok(_), _) => FloorSource::Measured,
            (Err(_), Some(_)) => FloorSource::Reused(age),
            (Err(_), None) => FloorSource::Configured,
        };
        FloorEstimate {
            plane: usable.map_or(configured, |good| good.plane),
            curvature: usable.map_or(Curvature::none(&configured), |good| good.curvature),
            source,
            // A frozen camera shows an old floor, however young its stamps are.
            is_known: age <= KNOWN_MAX_US && !matches!(result, Err(FloorFault::Frame(FrameFault::Frozen(_)))),
            quality: result.unwrap_or_default(),
            fault: result.err(),
        }
    }
}

fn judged(
    lattice: &Lattice<'_>,
    noise: &DepthNoise,
    plane: Plane,
    rules: (&FitLimits, &Expectation),
) -> Result<(Plane, FitQuality), FloorFault> {
    let quality = quality(lattice, noise, &plane);
    check(&plane, &quality, rules, lattice.size()).map_err(FloorFault::Rejected)?;
    Ok((plane, quality))
}

/// Age of a good plane; one from the future is as old as can be.
fn age_us(stamp: Stamp, now: Stamp) -> u64 {
    match stamp.age(now) {
        Age::Past(age) => age,
        Age::Future(_) => u64::MAX,
    }
}
