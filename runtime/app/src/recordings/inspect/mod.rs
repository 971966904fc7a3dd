//! `floorguard inspect`: what is in a recording, what is wrong with it, and what can be done with it, on one page.

mod bag;
mod capture;
mod cloud;
mod lines;
mod page;
mod run;
mod serial;
mod timeline;
mod vectornav;

pub use lines::{can_frame, can_service, is_candump};
pub use run::{InspectArguments, page as page_of, run};
pub use serial::{inertial, scanner};
pub use vectornav::vectornav;
