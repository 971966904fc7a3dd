//! Writes the evidence: one HTML file for people, one JSON file for machines, a few lines for the terminal.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use super::claim::Claim;
use super::image::Image;
use super::loops::LoopSite;

/// Most findings that the terminal shows for one claim; the files hold all.
const SHOWN_FINDINGS: usize = 12;

/// Writes `index.html` and `audit.json`.
pub fn write(folder: &Path, claims: &[Claim], sites: &[LoopSite], image: &Image) -> Result<()> {
    fs::create_dir_all(folder).with_context(|| format!("cannot create {}", folder.display()))?;
    fs::write(folder.join("audit.json"), json(claims, sites, image)?)?;
    fs::write(folder.join("index.html"), html(claims, sites, image))?;
    Ok(())
}

/// Prints the verdict.
pub fn print(folder: &Path, claims: &[Claim], as_json: bool) -> Result<()> {
    if as_json {
        println!("{}", fs::read_to_string(folder.join("audit.json"))?);
        return Ok(());
    }
    for claim in claims {
        println!("{} {:26} {}", if claim.holds() { "holds " } else { "FAILS " }, claim.id, claim.evidence);
        for finding in claim.findings.iter().take(SHOWN_FINDINGS) {
            println!("         {}:{} {}", finding.place, finding.line, finding.message);
        }
        if claim.findings.len() > SHOWN_FINDINGS {
            println!("         … and {} more in the report", claim.findings.len() - SHOWN_FINDINGS);
        }
    }
    let failed = claims.iter().filter(|claim| !claim.holds()).count();
    println!("{} claims, {failed} fail; the evidence is in target/audit/index.html", claims.len());
    Ok(())
}

fn json(claims: &[Claim], sites: &[LoopSite], image: &Image) -> Result<String> {
    let functions: Vec<_> = image
        .functions
        .values()
        .map(|function| {
            serde_json::json!({
                "name": function.name,
                "bytes": function.size,
                "frame_bytes": function.flow.frame_bytes,
                "loops": function.flow.back_edges.len(),
            })
        })
        .collect();
    let value = serde_json::json!({
        "verdict": if claims.iter().all(Claim::holds) { "holds" } else { "fails" },
        "claims": claims,
        "loops": sites,
        "image": { "flash_bytes": image.flash_bytes, "ram_bytes": image.ram_bytes, "functions": functions },
    });
    Ok(serde_json::to_string_pretty(&value)?)
}

fn html(claims: &[Claim], sites: &[LoopSite], image: &Image) -> String {
    let mut page = String::from(HEAD);
    let _ = write!(
        page,
        "<h1>floorguard: the evidence</h1><p>Safety image: {} functions, {} B flash, {} B RAM.</p>",
        image.functions.len(),
        image.flash_bytes,
        image.ram_bytes
    );
    page.push_str("<table><tr><th>verdict<th>claim<th>evidence</tr>");
    for claim in claims {
        let (class, verdict) = if claim.holds() { ("good", "holds") } else { ("bad", "fails") };
        let _ = write!(
            page,
            "<tr><td class={class}>{verdict}<td><b>{}</b><br>{}<td>{}",
            claim.id,
            escape(claim.text),
            escape(&claim.evidence)
        );
        for finding in &claim.findings {
            let _ = write!(
                page,
                "<br><code>{}:{}</code> {}",
                escape(&finding.place),
                finding.line,
                escape(&finding.message)
            );
        }
        page.push_str("</tr>");
    }
    page.push_str(
        "</table><h2>Loops</h2><table><tr><th>place<th>function<th>kind<th>bound<th>how it is known</tr>",
    );
    for site in sites {
        let _ = write!(
            page,
            "<tr><td>{}:{}<td>{}<td>{}<td>{}<td>{}</tr>",
            escape(&site.file),
            site.line,
            escape(&site.function),
            escape(&site.kind),
            escape(&site.bound),
            site.how
        );
    }
    page.push_str("</table>");
    page
}

const HEAD: &str = "<!doctype html><meta charset=utf-8><meta name=viewport content='width=device-width'>\
<title>floorguard audit</title><style>body{font:15px/1.45 system-ui,sans-serif;margin:2em auto;max-width:75em;\
padding:0 1em}table{border-collapse:collapse;width:100%;margin:1em 0}td,th{border:1px solid #ccc;padding:.3em .5em;\
text-align:left;vertical-align:top}code{font-size:.9em}.good{background:#dff2df}.bad{background:#f9d6d6}</style>";

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
