//! Writes the evidence: one HTML file for people, one JSON file for machines, a few lines for the terminal.

mod claims;
pub mod evidence;
mod explain;
mod goals;
mod instructions;
mod loops;
mod manual;
mod page;
mod stack;
mod states;
mod table;

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::report::evidence::Evidence;

/// Most findings that the terminal shows for one claim; the files hold all.
const SHOWN_FINDINGS: usize = 12;

/// Writes `index.html`, `audit.json` and the picture of the states.
pub fn write(folder: &Path, evidence: &Evidence) -> Result<()> {
    if let Some(claim) = evidence.claims.iter().find(|claim| explain::of(claim.id).is_none()) {
        bail!("the claim {} has no explanation in report/explain.rs", claim.id);
    }
    fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
    fs::write(folder.join("audit.json"), json(evidence)?)?;
    fs::write(folder.join("index.html"), page::html(evidence))?;
    fs::write(folder.join("guard-states.svg"), &evidence.states)?;
    Ok(())
}

/// Prints the verdict.
pub fn print(folder: &Path, evidence: &Evidence, as_json: bool) -> Result<()> {
    if as_json {
        println!("{}", fs::read_to_string(folder.join("audit.json"))?);
        return Ok(());
    }
    for claim in &evidence.claims {
        println!("{} {:26} {}", if claim.holds() { "holds " } else { "FAILS " }, claim.id, claim.evidence);
        for finding in claim.findings.iter().take(SHOWN_FINDINGS) {
            println!("         {}:{} {}", finding.place, finding.line, finding.message);
        }
        if claim.findings.len() > SHOWN_FINDINGS {
            println!("         … and {} more in the report", claim.findings.len() - SHOWN_FINDINGS);
        }
    }
    for why in &evidence.records.missing {
        println!("cannot be read, and is missing in the report: {why}");
    }
    let failed = evidence.claims.iter().filter(|claim| !claim.holds()).count();
    println!("{} claims, {failed} fail; the evidence is in target/audit/index.html", evidence.claims.len());
    Ok(())
}

fn json(evidence: &Evidence) -> Result<String> {
    let image = evidence.image.as_ref().map(|image| {
        let functions = image.functions.values().map(|function| {
            serde_json::json!({
                "name": function.name,
                "bytes": function.size,
                "frame_bytes": function.flow.frame_bytes,
                "loops": function.flow.back_edges.len(),
            })
        });
        serde_json::json!({
            "flash_bytes": image.flash_bytes,
            "ram_bytes": image.ram_bytes,
            "functions": functions.collect::<Vec<_>>(),
        })
    });
    let value = serde_json::json!({
        "verdict": if evidence.holds() { "holds" } else { "fails" },
        "claims": evidence.claims,
        "requirements": evidence.trace.requirements,
        "hazards": evidence.trace.hazards,
        "dependencies": evidence.dependencies,
        "instructions": evidence.records.firmware,
        "worst_inputs": evidence.records.worst,
        "missing": evidence.records.missing,
        "code": evidence.today.code,
        "whole": evidence.today.whole,
        "campaigns": evidence.records.campaigns,
        "aims": goals::list(evidence.records.campaigns.as_ref(), &evidence.today),
        "states": evidence.explored,
        "causes": evidence.causes,
        "stack": evidence.image.as_ref().map(|image| stack::list(image, &evidence.roots)),
        "mutants": evidence.mutants,
        "loops": evidence.sites,
        "image": image,
    });
    Ok(serde_json::to_string_pretty(&value)?)
}
