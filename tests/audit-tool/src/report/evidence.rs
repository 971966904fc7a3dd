//! Everything that the report shows.

use crate::claim::Claim;
use crate::dependencies::Dependency;
use crate::image::Image;
use crate::image::roots::Root;
use crate::loops::LoopSite;
use crate::mutants::Record;
use crate::records::Records;
use crate::records::since::CodeToday;
use crate::trace::Trace;
use crate::trace::results::{CauseLine, Explored};

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
