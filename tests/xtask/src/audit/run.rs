//! Collects the claims, writes the report, gives the verdict.

use std::collections::BTreeSet;

use anyhow::Result;
use clap::Args;

use super::claim::{Claim, Finding};
use super::evidence::Evidence;
use super::forbidden::{self, Forbidden};
use super::image::{self, Image};
use super::loops::{self, LoopSite};
use super::results::{self, Results};
use super::sources::SourceFile;
use super::{circles, dependencies, hosted_rooms, mutation, picture, records, report, seen, sources, trace};
use crate::shell;

/// How the audit speaks.
#[derive(Args)]
pub struct Options {
    /// Print the machine-readable result instead of words.
    #[arg(long)]
    json: bool,
}

/// The deepest stack that a root of the safety image may need, bytes (anchors P4).
const STACK_BUDGET_BYTES: u32 = 8 * 1024;

/// Stack of a stage that runs once, before any task: the whole of it is free then, bytes.
const START_BUDGET_BYTES: u32 = 128 * 1024;

/// Folders whose loops are not ours: their bounds are argued in the report.
const LIBRARIES: &[&str] = &[
    "compiler_builtins",
    "__aeabi_mem",
    "memcmp",
    "rust_begin_unwind",
    "libm",
    "/library/core/",
    "heapless",
    "nalgebra",
    "crc-",
];

/// Runs every check. True if all claims hold.
pub fn run(options: &Options) -> Result<bool> {
    let root = shell::root();
    let files = sources::read_layers(&root)?;
    let (mut claims, mut sites) = judge_sources(&files);
    claims.push(seen::compare(&root, &mut sites));
    claims.push(hosted_rooms::claim(&root, &files)?);
    // What does not compile can still be read: the mistakes in the sources are named all the same.
    let image = image::build()?.map(|path| image::read(&path)).transpose()?;
    claims.push(image_builds(image.is_some()));
    if let Some(image) = &image {
        claims.extend(image_claims(image, &files, &sites));
    }
    let documents = trace::Sources::read(&root)?;
    let results = if image.is_some() { results::run(&documents.targets())? } else { Results::default() };
    let (trace, traced) = documents.trace(&results.passed);
    let (dependencies, known) = dependencies::read(&root)?;
    claims.extend(traced.into_iter().chain([known, picture::claim(&root, &results.transitions)]));
    let (mutants, noticed) = mutation::read(&root);
    claims.push(noticed);
    let states = picture::svg(&results.transitions);
    let evidence = Evidence {
        claims,
        sites,
        image,
        trace,
        dependencies,
        records: records::read(&root),
        mutants,
        states,
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
        vec![finding(
            "tests/safety-image",
            "core and drivers do not build for the target: the compiler's words are above; no claim on compiled code is proven",
        )]
    };
    Claim {
        id: "image-builds",
        text: "Core and drivers build and link for the Cortex-M7.",
        evidence: String::from("cargo build with the profile of the firmware"),
        findings,
    }
}

fn image_claims(image: &Image, files: &[SourceFile], sites: &[LoopSite]) -> Vec<Claim> {
    let functions = format!("{} functions of the compiled image disassembled", image.functions.len());
    vec![
        Claim {
            id: "no-heap-linked",
            text: "No allocator is linked into the safety image.",
            evidence: format!("{} symbols read", image.symbols.len()),
            findings: symbols_with(image, &["__rust_alloc", "__rg_alloc", "__rdl_alloc", "malloc"]),
        },
        Claim {
            id: "no-panic-linked",
            text: "No panic can be reached in the safety image.",
            evidence: functions.clone(),
            findings: panic_callers(image),
        },
        Claim {
            id: "no-recursion-linked",
            text: "The call graph of the safety image has no cycle.",
            evidence: functions.clone(),
            findings: circles::cycles(&image.call_graph())
                .into_iter()
                .map(|cycle| finding(&cycle.join(" → "), "these functions call one another in a circle"))
                .chain(image.calling_themselves().map(|name| finding(name, "calls itself")))
                .collect(),
        },
        Claim {
            id: "no-indirect-calls-linked",
            text: "The safety image calls nothing through a register.",
            evidence: functions.clone(),
            findings: image
                .functions
                .values()
                .filter(|function| !function.flow.indirect_calls.is_empty())
                .map(|function| finding(&function.name, "calls or jumps through a register"))
                .collect(),
        },
        rooms_linked(image, files),
        hidden_loops(image, sites),
        stack(image),
    ]
}

fn finding(place: &str, message: &str) -> Finding {
    Finding { place: place.to_owned(), line: 0, message: message.to_owned() }
}

fn symbols_with(image: &Image, names: &[&str]) -> Vec<Finding> {
    let hit = |symbol: &&String| names.iter().any(|name| symbol.contains(name));
    image.symbols.iter().filter(hit).map(|symbol| finding(symbol, "is linked")).collect()
}

fn panic_callers(image: &Image) -> Vec<Finding> {
    let calls = image.panic_calls.iter().map(|call| Finding {
        place: call.place.0.clone(),
        line: call.place.1 as usize,
        message: format!("can reach {} (in {}); handle the case that panics", call.callee, call.function),
    });
    calls.collect::<BTreeSet<_>>().into_iter().collect()
}

/// Every room of the drivers, and every room that runs on the MCU, is linked: what is not there is not proven.
fn rooms_linked(image: &Image, files: &[SourceFile]) -> Claim {
    let room = |file: &str| file.split('/').take(3).collect::<Vec<_>>().join("/");
    let has_code = |file: &&SourceFile| file.path.split('/').count() > 3;
    let rooms: BTreeSet<String> = files.iter().filter(has_code).map(|file| room(&file.path)).collect();
    let linked: BTreeSet<String> = image.files.iter().map(|file| room(file)).collect();
    let missing: Vec<&String> = rooms.iter().filter(|room| !linked.contains(*room)).collect();
    let needed = |room: &&&String| !hosted_rooms::is_hosted(room);
    Claim {
        id: "rooms-linked",
        text: "Every room of core and drivers that runs on the MCU has code in the safety image.",
        evidence: format!(
            "{} of {} rooms linked; not linked, for the reasons in the report: {}",
            rooms.len() - missing.len(),
            rooms.len(),
            missing.iter().filter_map(|room| room.rsplit('/').next()).collect::<Vec<_>>().join(", ")
        ),
        findings: missing
            .iter()
            .filter(needed)
            .map(|room| finding(room, "is not linked; call it in tests/safety-image/src"))
            .collect(),
    }
}

/// Each backward branch must belong to a listed loop, to a method of a fixed-size array, or to a named library.
fn hidden_loops(image: &Image, sites: &[LoopSite]) -> Claim {
    let mut findings = BTreeSet::new();
    let (mut ours, mut library) = (0, 0);
    for compiled in &image.loops {
        let is_listed = |(file, line): &(String, u32)| {
            let lines = |site: &LoopSite| site.line..=site.end_line;
            sites.iter().any(|site| site.file == *file && lines(site).contains(&(*line as usize)))
        };
        let has_loop = |function: &String| sites.iter().any(|site| site.function == *function);
        let listed = compiled.places.iter().chain(&compiled.head).any(is_listed)
            || compiled.without_lines_in.as_ref().is_some_and(has_loop);
        let innermost = compiled.places.first().map_or("", |(file, _)| file.as_str());
        let from_library =
            LIBRARIES.iter().any(|name| innermost.contains(name) || compiled.function.contains(name));
        let own = compiled.places.iter().find(|(file, _)| sources::is_own(file));
        let over_array = compiled.places.iter().any(|(file, _)| file.contains("/library/core/src/array/"));
        if listed || over_array {
            ours += 1;
        } else if from_library && own.is_none() {
            library += 1;
        } else {
            let (place, line) = own.cloned().unwrap_or_else(|| (compiled.function.clone(), 0));
            let message =
                format!("compiled loop at {:#x} in {} is in no list", compiled.address, compiled.function);
            findings.insert(Finding { place, line: line as usize, message });
        }
    }
    Claim {
        id: "loops-complete",
        text: "Each loop in the compiled code belongs to a loop of the list or to a library loop.",
        evidence: format!(
            "{ours} backward branches matched to listed loops and array methods, {library} in libraries"
        ),
        findings: findings.into_iter().collect(),
    }
}

/// Stack that a root may need, bytes.
pub fn budget_of(root: &str) -> u32 {
    if root.ends_with("_start") { START_BUDGET_BYTES } else { STACK_BUDGET_BYTES }
}

fn stack(image: &Image) -> Claim {
    let roots: Vec<&str> =
        image.functions.values().map(|f| f.name.as_str()).filter(|name| name.contains("root_")).collect();
    let mut lines = Vec::new();
    let mut findings = Vec::new();
    for root in roots {
        let (bytes, chain) = image.deepest_stack(root);
        let short = root.rsplit("::").next().unwrap_or(root);
        let budget = budget_of(root);
        lines.push(format!("{short} {bytes} of {budget} B"));
        if bytes > budget {
            let message = format!("needs {bytes} B of {budget} B through {}", chain.join(" → "));
            findings.push(finding(root, &message));
        }
    }
    for function in image.functions.values().filter(|function| function.flow.dynamic_frame) {
        findings.push(finding(
            &function.name,
            "moves the stack pointer by a register: its frame cannot be known",
        ));
    }
    Claim {
        id: "stack-budget",
        text: "No stage of the safety image needs more stack than its budget.",
        evidence: format!("{}; frames from the disassembly, assembly routines included", lines.join(", ")),
        findings,
    }
}
