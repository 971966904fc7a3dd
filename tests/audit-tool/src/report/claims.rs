//! The claims with their verdicts, and what speaks against believing them.

use std::fmt::Write as _;

use super::explain;
use super::manual::inline;
use super::table::{Table, code, escape, source, verdict};
use crate::claim::Claim;

/// The table of claims.
pub fn section(claims: &[Claim]) -> String {
    let mut table = Table::new(&[
        "verdict",
        "claim",
        "how it is checked, and what came of it",
        "what the check cannot show",
    ]);
    for claim in claims {
        let explanation = explain::of(claim.id);
        let how = explanation.map_or("", |explanation| explanation.how);
        let mut text = format!("{}<br><b>{}</b>", escape(how), inline(&claim.evidence));
        if claim.id == "stack-budget" {
            text = format!("{}<br><b>each root and its chain: see the table</b>", escape(how));
        }
        if let Some(explanation) = explanation {
            let _ = write!(
                text,
                "<br><a href='#{}'>the evidence</a> · watch it fail: {}",
                explanation.anchor,
                code(explanation.broken_by)
            );
        }
        text.push_str(&findings(claim));
        let shown = verdict(claim.holds(), if claim.holds() { "holds" } else { "fails" });
        let limit = explanation.map_or("", |explanation| explanation.limit);
        table.row(&[shown, format!("<b>{}</b><br>{}", claim.id, escape(claim.text)), text, escape(limit)]);
    }
    table.finish()
}

/// The first few in sight, all of them in a fold.
fn findings(claim: &Claim) -> String {
    let lines: Vec<String> = claim
        .findings
        .iter()
        .map(|finding| format!("<br>{} {}", source(&finding.place, finding.line), escape(&finding.message)))
        .collect();
    let (first, rest) = lines.split_at(lines.len().min(5));
    let mut html = first.concat();
    if !rest.is_empty() {
        let _ =
            write!(html, "<details><summary>and {} more</summary>{}</details>", rest.len(), rest.concat());
    }
    html
}
