//! The command.

use anyhow::{Context, Result};
use clap::Args;

use super::claims::{self, Found};
use super::{drawing, known};
use crate::claim::Claim;
use crate::facts::facts;
use crate::shell;

/// Judge or draw.
#[derive(Args)]
pub struct Options {
    /// Draw the graph into the architecture, and take out of the list of known offenders what no longer is one.
    #[arg(long)]
    write: bool,
}

/// Judges the structure. True if all of it holds.
pub fn run(options: &Options) -> Result<bool> {
    let root = shell::root();
    let mut found = claims::read(&root)?;
    if options.write {
        write(&mut found)?;
    }
    let claims = claims::claims(&found);
    for claim in &claims {
        println!("{} {}: {}", if claim.holds() { "holds" } else { "FAILS" }, claim.id, claim.evidence);
        for finding in &claim.findings {
            println!("  {}:{}: {}", finding.place, finding.line, finding.message);
        }
    }
    Ok(claims.iter().all(Claim::holds))
}

fn write(found: &mut Found) -> Result<()> {
    let root = shell::root();
    let document = &facts().structure.document;
    let new = drawing::replaced(&found.document, &found.drawing())
        .with_context(|| format!("{document} has no markers between which the graph is drawn"))?;
    let now = found.offenders();
    // The first list has all that there is; any later one only less.
    let shrunk = if root.join(known::FILE).exists() { found.known.shrunk(&now) } else { now };
    std::fs::write(root.join(document), &new).with_context(|| format!("cannot write {document}"))?;
    std::fs::write(root.join(known::FILE), shrunk.written())
        .with_context(|| format!("cannot write {}", known::FILE))?;
    (found.document, found.known) = (new, shrunk);
    Ok(())
}
