//! What the compiled safety image shows: no allocator, no panic, no circle of calls, no hidden loop, and its stack.

use std::collections::BTreeSet;

use syn::visit::Visit;

use crate::claim::{Claim, Finding};
use crate::facts::facts;
use crate::forbidden::{circles, hosted_only};
use crate::image::roots::Root;
use crate::image::{Function, Image, roots};
use crate::loops::LoopSite;
use crate::sources;
use crate::sources::SourceFile;

/// Every claim on the compiled code.
pub fn judge(image: &Image, files: &[SourceFile], sites: &[LoopSite], roots: &[Root]) -> Vec<Claim> {
    let functions = format!("{} functions of the compiled image disassembled", image.functions.len());
    vec![
        Claim {
            id: "no-heap-linked",
            text: "No allocator is linked into the safety image.",
            evidence: format!("{} symbols read", image.symbols.len()),
            findings: heap(image),
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
            findings: circles_of_calls(image),
        },
        Claim {
            id: "no-indirect-calls-linked",
            text: "The safety image calls nothing through a register.",
            evidence: functions.clone(),
            findings: image
                .functions
                .values()
                .filter(|function| !function.flow.indirect_calls.is_empty())
                .map(|function| in_function(function, "calls or jumps through a register"))
                .collect(),
        },
        modules_linked(image, files),
        hidden_loops(image, sites),
        stack(image, roots),
    ]
}

/// A finding in a compiled function, with the place where it begins in the sources.
fn in_function(function: &Function, message: &str) -> Finding {
    let message = format!("{} {message}", function.name);
    Finding { place: function.place.0.clone(), line: function.place.1 as usize, message }
}

fn circles_of_calls(image: &Image) -> Vec<Finding> {
    let graph = circles::cycles(&image.call_graph()).into_iter().map(|cycle| {
        let first = image.functions.values().find(|function| cycle.first() == Some(&function.name));
        let message = format!("is on the circle {}", cycle.join(" → "));
        first.map_or_else(|| finding("", &message), |function| in_function(function, &message))
    });
    let themselves = image.calling_themselves().map(|function| in_function(function, "calls itself"));
    graph.chain(themselves).collect()
}

fn finding(place: &str, message: &str) -> Finding {
    Finding { place: place.to_owned(), line: 0, message: message.to_owned() }
}

/// Symbols of an allocator, and code that came from the library of the heap.
fn heap(image: &Image) -> Vec<Finding> {
    const NAMES: [&str; 4] = ["__rust_alloc", "__rg_alloc", "__rdl_alloc", "malloc"];
    let symbols = image.symbols.iter().filter(|symbol| NAMES.iter().any(|name| symbol.contains(name)));
    let symbols = symbols.map(|symbol| finding(symbol, "is linked"));
    let uses = image.heap_uses.iter().map(|used| Finding {
        place: used.place.0.clone(),
        line: used.place.1 as usize,
        message: format!("uses the heap (in {}); keep a container of fixed capacity", used.function),
    });
    symbols.chain(uses).collect::<BTreeSet<_>>().into_iter().collect()
}

fn panic_callers(image: &Image) -> Vec<Finding> {
    let calls = image.panic_calls.iter().map(|call| Finding {
        place: call.place.0.clone(),
        line: call.place.1 as usize,
        message: format!("can reach {} (in {}); handle the case that panics", call.callee, call.function),
    });
    calls.collect::<BTreeSet<_>>().into_iter().collect()
}

/// Every top module that runs on the MCU is linked: what is not there is not proven. One without a function has no code.
fn modules_linked(image: &Image, files: &[SourceFile]) -> Claim {
    let modules: BTreeSet<String> =
        files.iter().filter(|file| has_code(file)).map(|file| sources::module_of(&file.path)).collect();
    let linked: BTreeSet<String> = image.files.iter().map(|file| sources::module_of(file)).collect();
    let missing: Vec<&String> = modules.iter().filter(|module| !linked.contains(*module)).collect();
    let needed: Vec<&&String> =
        missing.iter().filter(|module| !hosted_only::is_hosted(&format!("{module}.rs"))).collect();
    Claim {
        id: "modules-linked",
        text: "Every module of core and drivers that runs on the MCU has code in the safety image.",
        evidence: format!(
            "{} of {} modules linked; {} are not, for the reasons in the report",
            modules.len() - missing.len(),
            modules.len(),
            missing.len() - needed.len(),
        ),
        findings: needed
            .iter()
            .map(|module| finding(module, &format!("is not linked; call it in {}", facts().image.sources)))
            .collect(),
    }
}

/// A function that the compiler does not evaluate by itself.
fn has_code(file: &SourceFile) -> bool {
    #[derive(Default)]
    struct Functions(bool);
    impl<'ast> Visit<'ast> for Functions {
        fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
            self.0 |= function.sig.constness.is_none();
        }
        fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
            self.0 |= function.sig.constness.is_none();
        }
    }
    let mut functions = Functions::default();
    functions.visit_file(&file.syntax);
    functions.0 && !file.path.ends_with("/src/lib.rs")
}

/// Every root is a function of the image: what the optimiser takes away, because it knows that nothing comes of it, is not
/// proven.
pub fn roots_linked<'a>(functions: impl Iterator<Item = &'a str>, roots: &[Root]) -> Claim {
    let linked: BTreeSet<&str> = functions.map(roots::short).collect();
    let missing = roots.iter().filter(|root| !linked.contains(root.name.as_str()));
    let gone = |root: &Root| Finding {
        place: root.file.clone(),
        line: root.line,
        message: format!(
            "{} is not in the linked image: the compiler knows what it gets, and took it away; hand it over by black_box",
            root.name
        ),
    };
    let mut findings: Vec<Finding> = missing.map(gone).collect();
    let evidence = format!("{} of {} roots linked", roots.len() - findings.len(), roots.len());
    if roots.is_empty() {
        findings.push(finding(&facts().image.sources, "has no function root_…: no stage is called"));
    }
    Claim {
        id: "roots-linked",
        text: "Every stage that the safety image calls is in the linked image.",
        evidence,
        findings,
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
        let libraries: Vec<&str> = facts().image.libraries.iter().map(String::as_str).collect();
        let from_library =
            libraries.iter().any(|name| innermost.contains(name) || compiled.function.contains(name));
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
    let image = &facts().image;
    if root.ends_with("_start") { image.start_stack_bytes } else { image.stack_bytes }
}

fn stack(image: &Image, roots: &[Root]) -> Claim {
    let functions = image.functions.values().map(|function| function.name.as_str());
    let linked: Vec<&str> = functions.filter(|name| roots::is_root(name, roots)).collect();
    let mut lines = Vec::new();
    let mut findings = Vec::new();
    if linked.is_empty() {
        findings.push(finding(&facts().image.sources, "no function root_… is linked: no stack was measured"));
    }
    for root in linked {
        let (bytes, chain) = image.deepest_stack(root);
        let short = roots::short(root);
        let budget = budget_of(root);
        lines.push(format!("{short} {bytes} of {budget} B"));
        if bytes > budget {
            let message = format!("needs {bytes} B of {budget} B through {}", chain.join(" → "));
            let on_chain = image.functions.values().filter(|function| chain.contains(&function.name));
            let largest = on_chain.max_by_key(|function| function.flow.frame_bytes);
            findings.push(largest.map_or_else(
                || finding(root, &message),
                |function| {
                    in_function(function, &format!("has the largest frame below {root}, which {message}"))
                },
            ));
        }
    }
    for function in image.functions.values().filter(|function| function.flow.dynamic_frame) {
        findings
            .push(in_function(function, "moves the stack pointer by a register: its frame cannot be known"));
    }
    Claim {
        id: "stack-budget",
        text: "No stage of the safety image needs more stack than its budget.",
        evidence: format!("{}; frames from the disassembly, assembly routines included", lines.join(", ")),
        findings,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn optimised_away_root_is_named() {
        let text = "#[inline(never)]\nfn root_here(bytes: &[u8]) {}\n\npub fn root_gone<T>(state: T) {}\n";
        let roots = roots::in_text("tests/safety-image/src/drivers.rs", text.to_owned()).expect("it parses");
        let claim = roots_linked(["image::drivers::root_here", "memcpy"].into_iter(), &roots);
        assert_eq!(claim.findings.iter().map(|finding| finding.line).collect::<Vec<_>>(), [4]);
        assert!(claim.findings[0].message.starts_with("root_gone"), "{:?}", claim.findings);
        assert_eq!(claim.evidence, "1 of 2 roots linked");
    }

    #[test]
    fn an_image_without_roots_proves_nothing() {
        let claim = roots_linked(["memcpy"].into_iter(), &[]);
        assert_eq!((claim.findings.len(), claim.evidence.as_str()), (1, "0 of 0 roots linked"));
    }
}
