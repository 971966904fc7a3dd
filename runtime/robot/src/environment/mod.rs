//! What the robot has learned about a place, kept across power cycles, and the answers that come of it.

mod answer;
mod answer_people;
pub(crate) mod bytes;
mod calendar;
mod codec;
mod live;
mod merge;
mod model;
pub mod pictures;
mod question;
mod sight;
mod store;
mod teach;
mod tracks;
mod tracks_named;
mod zones;

pub use answer::{Answer, answer};
pub(crate) use bytes::{Reader, Writer};
pub use calendar::{Calendar, CivilMoment};
pub use codec::{FORMAT_VERSION, decode, encode};
pub use live::LiveLearner;
pub use merge::merge;
pub use model::{CoreModel, HOURS, Model, PERIODS};
pub use question::{Question, WeekHours};
pub use store::{Loaded, load, save};
pub use store::{places, read_newest, replace_file};
pub use teach::{Lesson, PeopleSeen, teach_recording, teach_run};
pub use tracks::{ReadTracks, Recording, TrackFormat, TrackPoint, TrackReading, read_tracks};
pub use zones::{Zone, read_zones};
