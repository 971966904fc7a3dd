//! Collects the claims, writes the report, gives the verdict.

use anyhow::Result;
use clap::Args;

use crate::claim::{Claim, Finding};
use crate::facts::facts;
use crate::forbidden::{Forbidden, circles, hosted_only};
use crate::image::roots;
use crate::loops::{LoopSite, seen};
use crate::records::mutation;
use crate::records::since::CodeToday;
use crate::report::evidence::Evidence;
use crate::sources::SourceFile;
use crate::trace::results::Results;
use crate::trace::{picture, results};
use crate::{dependencies, forbidden, image, loops, records, report, sources, trace};
use crate::{shell, structure};

/// How the audit speaks.
#[derive(Args)]
pub struct Options {
    /// Print the machine-readable result instead of words.
    #[arg(long)]
    json: bool,
}

/// Runs every check. True if all claims hold.
pub fn run(options: &Options) -> Result<bool> {
    let root = shell::root();
    let files = sources::read_audited(&root)?;
    let (mut claims, mut sites) = judge_sources(&files);
    claims.push(super::tasks::judge(&super::tasks::read(&root)?));
    claims.push(seen::compare(&root, &mut sites));
    claims.push(hosted_only::claim(&root, &files)?);
    claims.extend(structure::judge(&root)?);
    let documents = trace::Sources::read(&root)?;
    let tests = results::build(&documents.targets())?;
    // What does not compile can still be read: the mistakes in the sources are named all the same.
    let image = image::build()?.map(|path| image::read(&path)).transpose()?;
    claims.push(image_builds(image.is_some()));
    let roots = image.is_some().then(|| roots::of_the_image(&root)).transpose()?.unwrap_or_default();
    if let Some(image) = &image {
        claims.extend(image::claims::judge(image, &files, &sites, &roots));
        let linked = image.functions.values().map(|function| function.name.as_str());
        claims.push(image::claims::roots_linked(linked, &roots));
    }
    let results =
        if image.is_some() { results::run(tests, &documents.targets())? } else { Results::default() };
    let (trace, traced) = documents.trace(&results.passed);
    let (dependencies, known) = dependencies::read(&root)?;
    let pictured = picture::claim(&root, (&results.explored, &results.causes), documents.printed_causes());
    claims.extend(traced.into_iter().chain([known, pictured]));
    let code = sources::fingerprint(&files);
    let today = CodeToday { code, whole: sources::fingerprint(&sources::read_robot(&root)?) };
    let (mutants, noticed) = mutation::read(&root, &today.code);
    claims.push(noticed);
    let states = picture::svg(&results.explored.transitions);
    let evidence = Evidence {
        claims,
        sites,
        image,
        roots,
        trace,
        dependencies,
        records: records::read(&root),
        today,
        mutants,
        states,
        explored: results.explored,
        causes: results.causes,
    };
    let folder = root.join("target/audit");
    report::write(&folder, &evidence)?;
    report::print(&folder, &evidence, options.json)?;
    Ok(evidence.holds())
}

/// What the sources alone prove, and their loops.
pub fn judge_sources(files: &[SourceFile]) -> (Vec<Claim>, Vec<LoopSite>) {
    let mut forbidden = Forbidden::default();
    let mut sites = Vec::new();
    let mut unbounded = Vec::new();
    for file in files {
        forbidden::inspect(file, &mut forbidden);
        let (listed, findings) = loops::list(file);
        sites.extend(listed);
        unbounded.extend(findings);
    }
    forbidden.recursion.extend(circles::inspect(files));
    (source_claims(files.len(), sites.len(), unbounded, forbidden), sites)
}

fn source_claims(files: usize, sites: usize, unbounded: Vec<Finding>, found: Forbidden) -> Vec<Claim> {
    let read = format!("{files} files read as syntax");
    vec![
        Claim {
            id: "loops-bounded",
            text: "Every loop of core and drivers has a bound that a reader can see.",
            evidence: format!("{sites} loops and iterator chains listed with their bound; {read}"),
            findings: unbounded,
        },
        Claim {
            id: "no-unsafe",
            text: "Core and drivers contain no unsafe code.",
            evidence: format!("{read}; the compiler forbids it too"),
            findings: found.unsafe_code,
        },
        Claim {
            id: "no-heap-in-sources",
            text: "Core and drivers name nothing that allocates.",
            evidence: read.clone(),
            findings: found.heap,
        },
        Claim {
            id: "no-panic-in-sources",
            text: "Core and drivers call nothing that panics by name.",
            evidence: read.clone(),
            findings: found.panics,
        },
        Claim {
            id: "no-pointers",
            text: "Core and drivers call nothing through a function pointer or a trait object.",
            evidence: read.clone(),
            findings: found.pointers,
        },
        Claim {
            id: "no-recursion-in-sources",
            text: "No function of core and drivers calls itself.",
            evidence: read,
            findings: found.recursion,
        },
    ]
}

fn image_builds(builds: bool) -> Claim {
    let findings = if builds {
        vec![]
    } else {
        let place = facts().image.sources.clone();
        let message = "core and drivers do not build for the target: the compiler's words are above; no claim on compiled code is proven";
        vec![Finding { place, line: 0, message: message.to_owned() }]
    };
    Claim {
        id: "image-builds",
        text: "Core and drivers build and link for the Cortex-M7.",
        evidence: String::from("cargo build with the profile of the firmware"),
        findings,
    }
}
