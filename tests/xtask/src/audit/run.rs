//! Collects the claims, writes the report, gives the verdict.

use std::collections::BTreeSet;

use anyhow::Result;
use clap::Args;

use super::claim::{Claim, Finding};
use super::forbidden::{self, Forbidden};
use super::image::{self, Image};
use super::loops::{self, LoopSite};
use super::{report, sources};
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

/// Folders whose loops are not ours: their bounds are argued in the report.
const LIBRARIES: &[&str] = &[
    "compiler_builtins",
    "__aeabi_mem",
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
    let mut forbidden = Forbidden::default();
    let mut sites = Vec::new();
    let mut unbounded = Vec::new();
    for file in &files {
        forbidden::inspect(file, &mut forbidden);
        let (listed, findings) = loops::list(file);
        sites.extend(listed);
        unbounded.extend(findings);
    }
    let compiled = image::read(&image::build()?)?;
    let mut claims = source_claims(files.len(), sites.len(), unbounded, forbidden);
    claims.extend(image_claims(&compiled, &sites));
    let folder = root.join("target/audit");
    report::write(&folder, &claims, &sites, &compiled)?;
    report::print(&folder, &claims, options.json)?;
    Ok(claims.iter().all(Claim::holds))
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

fn image_claims(image: &Image, sites: &[LoopSite]) -> Vec<Claim> {
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
            findings: forbidden::cycles(&image.call_graph())
                .into_iter()
                .map(|cycle| finding(&cycle.join(" → "), "these functions call one another in a circle"))
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

fn is_panic(name: &str) -> bool {
    name.contains("core::panicking")
        || name.contains("panic_fmt")
        || name.contains("_fail::")
        || name.ends_with("_fail")
}

fn panic_callers(image: &Image) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (caller, callees) in image.call_graph() {
        if is_panic(&caller) {
            continue;
        }
        for callee in callees.iter().filter(|callee| is_panic(callee)) {
            findings.push(finding(&caller, &format!("can reach {callee}")));
        }
    }
    findings
}

/// Each backward branch must belong to a listed loop or to a named library.
fn hidden_loops(image: &Image, sites: &[LoopSite]) -> Claim {
    let mut findings = BTreeSet::new();
    let (mut ours, mut library) = (0, 0);
    for compiled in &image.loops {
        let is_listed = |(file, line): &(String, u32)| {
            let lines = |site: &LoopSite| site.line..=site.end_line;
            sites.iter().any(|site| site.file == *file && lines(site).contains(&(*line as usize)))
        };
        let listed = compiled.places.iter().any(is_listed) || compiled.head.iter().any(is_listed);
        let innermost = compiled.places.first().map_or("", |(file, _)| file.as_str());
        let from_library =
            LIBRARIES.iter().any(|name| innermost.contains(name) || compiled.function.contains(name));
        let own = compiled
            .places
            .iter()
            .find(|(file, _)| sources::LAYERS.iter().any(|layer| file.starts_with(layer)));
        if listed {
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
        evidence: format!("{ours} backward branches matched to listed loops, {library} in libraries"),
        findings: findings.into_iter().collect(),
    }
}

fn stack(image: &Image) -> Claim {
    let roots: Vec<&str> =
        image.functions.values().map(|f| f.name.as_str()).filter(|name| name.contains("root_")).collect();
    let mut lines = Vec::new();
    let mut findings = Vec::new();
    for root in roots {
        let (bytes, chain) = image.deepest_stack(root);
        lines.push(format!("{root} {bytes} B"));
        if bytes > STACK_BUDGET_BYTES {
            let message = format!("needs {bytes} B of {STACK_BUDGET_BYTES} B through {}", chain.join(" → "));
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
