//! Everything that the report shows.

use super::claim::Claim;
use super::dependencies::Dependency;
use super::image::Image;
use super::loops::LoopSite;
use super::records::Records;
use super::results::{CauseLine, Explored};
use super::roots::Root;
use super::since::CodeToday;
use super::trace::Trace;
use crate::mutants::Record;

/// The whole evidence of one run.
pub struct Evidence {
    /// What is claimed, and whether it holds.
    pub claims: Vec<Claim>,
    /// Every loop of the sources.
    pub sites: Vec<LoopSite>,
    /// The compiled image; none when it does not build.
    pub image: Option<Image>,
    /// The stages that it calls, as its sources name them.
    pub roots: Vec<Root>,
    /// Requirements and hazards.
    pub trace: Trace,
    /// Crates of the image.
    pub dependencies: Vec<Dependency>,
    /// What other commands measured.
    pub records: Records,
    /// The fingerprints of the code, as records keep them.
    pub today: CodeToday,
    /// What mutation runs left alive.
    pub mutants: Vec<Record>,
    /// States and transitions of the guard, as SVG.
    pub states: String,
    /// What the search over the guard's states saw.
    pub explored: Explored,
    /// The guard's causes, each with what it demands and how it clears.
    pub causes: Vec<CauseLine>,
}

impl Evidence {
    /// All claims hold.
    pub fn holds(&self) -> bool {
        self.claims.iter().all(Claim::holds)
    }
}
