//! What the robot learns about people in a place: where they walk, when, and how sure that is (book, Environment).
//!
//! Two rasters. The fine one (0.2 m) counts who passed which cell, for every hour of the week. The coarse one (2 m)
//! holds, in fixed memory, how the number of visitors varies with the time, as a histogram and as a spectrum, and
//! predicts it. Both know how long they were watched: an unobserved place is unknown, not empty.

mod contest;
mod correction;
mod dirt_seen;
mod environment_map;
mod evidence;
mod heat;
mod hour_table;
mod line;
mod place;
mod places;
mod questions;
mod rhythm;
mod spectrum;
mod visitors;
mod wall_time;
mod week;

pub use contest::Contest;
pub use correction::{Correction, HourlyVisits};
pub use dirt_seen::{Cleaning, DirtPerVisit, DirtSeen, SinceCleaning};
pub use environment_map::{Environment, Sighting};
pub use evidence::{Confidence, Rate};
pub use heat::{HEAT_CELL_M, HeatCell, HourCount, PeopleHeat};
pub use hour_table::{HourEntry, HourTable};
pub use place::{FORMULAS, Forecast, Place, PlaceSlice, RateModel, SLICE_S};
pub use places::{PLACE_CELL_M, Places};
pub use questions::{
    BestTime, DRYING_HOURS, PROFILE_STEP_S, PROFILE_STEPS, Profile, ProfileStep, STARTS_MAX, Wetness,
    best_time, cost_multiplier, presence, removal_per_encounter, wetness,
};
pub use rhythm::Rhythm;
pub use spectrum::{Complex, ORDER_MAX, Spectrum, SpectrumParts, Tone};
pub use visitors::{Footprint, PersonAt, Visitors};
pub use wall_time::{HOURS_OF_WEEK, LocalTime, WallTime};
pub use week::{Evidence, HourBin, Week};
