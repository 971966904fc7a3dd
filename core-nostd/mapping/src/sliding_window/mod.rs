//! A window of surfaces around the robot from a lidar on its side that a motor turns, and the plan of the floor that it fills
//! (Dalmedico et al. 2019; book, Sliding window).

mod arrow;
mod capacities;
mod cell;
mod clearing;
mod column;
mod compensation;
mod error;
mod export;
mod face;
mod fusion;
mod geometry;
mod insert;
mod lidar;
mod look;
mod motor;
mod panorama;
mod people;
mod plan;
mod sight;
mod turn;
mod window;

pub use arrow::{MovementArrow, MovementArrows, PassedPerson, SIGHTING_SIGMA_M, Sighting};
pub use capacities::{
    FINE_WINDOW_CELLS, PERSON_BOXES_MAX, SIGHT_BEARINGS, WINDOW_BEAMS_MAX, WINDOW_CELLS, WINDOW_HALF_WIDTH_M,
    WINDOW_HEIGHT_M,
};
pub use cell::{CellContent, ELEVATION_STEP_M, PERSON_EXPIRY_US, WindowCell};
pub use clearing::SweptWedge;
pub use compensation::Movement;
pub use error::{BoxError, MotorError, ScanError};
pub use export::OccupancyScale;
pub use face::{Face, FacePoint};
pub use geometry::WindowGeometry;
pub use insert::Inserted;
pub use lidar::{ColumnScan, LidarMount};
pub use motor::{ANGLE_GAP_MAX_US, MotorSample, MotorTrack};
pub use panorama::{MIRROR_STEPS, Mirror, MirrorMark, NO_SOURCE, PanoramaGeometry, PictureSize, StripPixel};
pub use people::{BOX_VALID_US, PersonBox, PersonBoxes};
pub use plan::{PLAN_RESOLUTION_M, Plan, PlanCell, PlanChange};
pub use sight::{SightLimits, SightPolygon};
pub use window::{
    CellPolicy, FixedFineSlidingWindow, FixedSlidingWindow, SlidingWindow, WindowCounters, WindowOptions,
    WindowPoint,
};
