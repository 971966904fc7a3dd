//! All scans against all scans that saw the same walls, at once: the last centimetres.
//!
//! Source: Lu and Milios 1997, "Globally consistent range scan alignment"; Censi 2008 (point to line). The residuals of all
//! pairs enter one system of equations, so that no pair has to be trusted by itself.

mod align;
mod locate;
mod pairs;
mod scan_view;
mod terms;

pub use align::{AlignConfig, AlignRound, align};
pub use locate::{LocateConfig, locate};
pub use pairs::{PairConfig, overlapping_pairs};
pub use scan_view::ScanView;
pub use terms::{MatchLimits, PairMatch, match_pair};
