//! The compiled safety image: its functions, who calls whom, its loops, its stack, and what must not be in it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};

use crate::facts::facts;
use crate::image::lines::Lines;
use crate::image::thumb;
use crate::image::thumb::Flow;
use crate::{shell, sources};

/// One function of the image.
pub struct Function {
    /// Readable name.
    pub name: String,
    /// Address.
    pub address: u64,
    /// Size in bytes.
    pub size: u64,
    /// Branches, calls and frame.
    pub flow: Flow,
    /// Where it begins in the sources, in our layers if any of it is ours.
    pub place: (String, u32),
}

/// A loop in compiled code, traced back to the sources.
pub struct CompiledLoop {
    /// Function that holds it.
    pub function: String,
    /// Address of the backward branch.
    pub address: u64,
    /// Inlining chain of the branch, innermost first: (file from the workspace root or library path, line).
    pub places: Vec<(String, u32)>,
    /// The same of the branch's target, the head of the loop: where the compiler merged branches of several blocks
    /// into one, only the head still tells whose loop it is.
    pub head: Vec<(String, u32)>,
    /// Name of the innermost inlined function where no instruction of the loop has a line, as in copies that the
    /// compiler wrote.
    pub without_lines_in: Option<String>,
}

/// A call of what panics, or code of the allocator's library.
pub struct PanicCall {
    /// Compiled function that holds it.
    pub function: String,
    /// Source place, in our layers if possible.
    pub place: (String, u32),
    /// What is called.
    pub callee: String,
}

/// The image, read.
pub struct Image {
    /// Functions by address.
    pub functions: BTreeMap<u64, Function>,
    /// Loops in address order.
    pub loops: Vec<CompiledLoop>,
    /// Calls of what panics.
    pub panic_calls: Vec<PanicCall>,
    /// Code that came from the library of the heap, inlined or not.
    pub heap_uses: Vec<PanicCall>,
    /// Source files with code in the image, inlined code included.
    pub files: BTreeSet<String>,
    /// All symbol names, undefined ones too.
    pub symbols: BTreeSet<String>,
    /// Bytes of program and constants.
    pub flash_bytes: u64,
    /// Bytes of statics.
    pub ram_bytes: u64,
}

/// Builds the safety image with the profile of the firmware. The compiler says itself why it cannot.
pub fn build() -> Result<Option<PathBuf>> {
    let mut command = shell::cargo();
    let image = &facts().image;
    command.args(["build", "--quiet", "--package", &image.package, "--profile", &image.profile]);
    command.args(["--target", &image.target]);
    let variable = image.target.to_uppercase().replace('-', "_");
    command.env(format!("CARGO_TARGET_{variable}_RUSTFLAGS"), format!("-C target-cpu={}", image.cpu));
    if !shell::succeeds(&mut command)? {
        return Ok(None);
    }
    Ok(Some(shell::target_folder().join(&image.target).join(&image.profile).join(&image.package)))
}

/// Reads a linked image.
pub fn read(path: &Path) -> Result<Image> {
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let file = object::File::parse(&*bytes).context("not an ELF image")?;
    let lines = Lines::of(path)?;
    let data_marks = mapping_symbols(&file);
    let mut functions = BTreeMap::new();
    let mut symbols = BTreeSet::new();
    for symbol in file.symbols() {
        let name = format!("{:#}", rustc_demangle::demangle(symbol.name().unwrap_or("")));
        symbols.insert(name.clone());
        if symbol.kind() != SymbolKind::Text || symbol.size() == 0 {
            continue;
        }
        let address = symbol.address() & !1;
        let Some(code) = code_at(&file, address, symbol.size()) else { continue };
        let flow = thumb::decode(code, address, |at| is_data(&data_marks, at));
        let place = lines.place(address)?;
        functions.insert(address, Function { name, address, size: symbol.size(), flow, place });
    }
    if functions.is_empty() {
        bail!("{} holds no function: nothing would be proven", path.display());
    }
    let loops = trace_loops(&lines, &functions)?;
    let panic_calls = panic_calls(&lines, &functions)?;
    let heap_uses = heap_uses(&lines, &functions)?;
    let files = linked_files(&lines, &functions)?;
    let size = |names: &[&str]| {
        file.sections()
            .filter(|section| {
                section.name().is_ok_and(|name| names.iter().any(|start| name.starts_with(start)))
            })
            .map(|section| section.size())
            .sum()
    };
    Ok(Image {
        functions,
        loops,
        panic_calls,
        heap_uses,
        files,
        symbols,
        flash_bytes: size(&[".text", ".rodata", ".data", ".ARM"]),
        ram_bytes: size(&[".data", ".bss"]),
    })
}

fn code_at<'data>(file: &object::File<'data>, address: u64, size: u64) -> Option<&'data [u8]> {
    file.sections().find_map(|section| section.data_range(address, size).ok().flatten())
}

/// `$t` starts code, `$d` starts data inside a code section (ARM ELF specification, 5.5.5).
fn mapping_symbols(file: &object::File) -> BTreeMap<u64, bool> {
    let mut marks = BTreeMap::new();
    for symbol in file.symbols() {
        let name = symbol.name().unwrap_or("");
        if name == "$d" || name.starts_with("$d.") {
            marks.insert(symbol.address(), true);
        } else if name == "$t" || name.starts_with("$t.") {
            marks.insert(symbol.address() & !1, false);
        }
    }
    marks
}

fn is_data(marks: &BTreeMap<u64, bool>, address: u64) -> bool {
    marks.range(..=address).next_back().is_some_and(|(_, data)| *data)
}

fn trace_loops(lines: &Lines, functions: &BTreeMap<u64, Function>) -> Result<Vec<CompiledLoop>> {
    let mut loops = Vec::new();
    for function in functions.values() {
        for (branch, head) in &function.flow.back_edges {
            let places = lines.places_near(*branch, (*head..*branch).rev().step_by(2))?;
            let lineless = places.first().is_none_or(|(_, line)| *line == 0);
            loops.push(CompiledLoop {
                function: function.name.clone(),
                address: *branch,
                without_lines_in: if lineless { lines.innermost(*branch)? } else { None },
                places,
                head: lines.places_near(*head, (*head..*branch).step_by(2).skip(1))?,
            });
        }
    }
    Ok(loops)
}

/// A function that does not come back.
pub fn is_panic(name: &str) -> bool {
    name.contains("core::panicking")
        || name.contains("panic_fmt")
        || name.contains("_fail::")
        || name.ends_with("_fail")
}

fn panic_calls(lines: &Lines, functions: &BTreeMap<u64, Function>) -> Result<Vec<PanicCall>> {
    let mut found = Vec::new();
    for function in functions.values().filter(|function| !is_panic(&function.name)) {
        for (call, target) in &function.flow.calls {
            let Some(callee) = functions.get(target).filter(|callee| is_panic(&callee.name)) else {
                continue;
            };
            let place = lines.place(*call)?;
            found.push(PanicCall { function: function.name.clone(), place, callee: callee.name.clone() });
        }
    }
    Ok(found)
}

/// Places with code of the heap's library: its functions may be inlined until no symbol is left.
fn heap_uses(lines: &Lines, functions: &BTreeMap<u64, Function>) -> Result<Vec<PanicCall>> {
    let mut found = Vec::new();
    for function in functions.values() {
        for address in (function.address..function.address + function.size).step_by(2) {
            let places = lines.places(address)?;
            if let Some((file, _)) = places.iter().find(|(file, _)| file.contains("/library/alloc/")) {
                let (place, callee) = (lines.place(address)?, file.clone());
                found.push(PanicCall { function: function.name.clone(), place, callee });
            }
        }
    }
    Ok(found)
}

fn linked_files(lines: &Lines, functions: &BTreeMap<u64, Function>) -> Result<BTreeSet<String>> {
    let mut files = BTreeSet::new();
    for function in functions.values() {
        for address in (function.address..function.address + function.size).step_by(4) {
            files.extend(lines.places(address)?.into_iter().map(|(file, _)| file));
        }
    }
    files.retain(|file| sources::is_own(file));
    Ok(files)
}

impl Image {
    /// Who calls whom, by name; calls into the middle of nowhere are dropped.
    pub fn call_graph(&self) -> BTreeMap<String, BTreeSet<String>> {
        self.functions
            .values()
            .map(|function| {
                let callees = function
                    .flow
                    .calls
                    .iter()
                    .filter_map(|(_, target)| self.at(*target))
                    .map(|f| f.name.clone());
                (function.name.clone(), callees.filter(|name| *name != function.name).collect())
            })
            .collect()
    }

    /// Functions that call their own beginning. The graph leaves them out: two copies of a generic share their name.
    pub fn calling_themselves(&self) -> impl Iterator<Item = &Function> {
        let itself = |function: &&Function| {
            function.flow.calls.iter().any(|(_, target)| target & !1 == function.address & !1)
        };
        self.functions.values().filter(itself)
    }

    fn at(&self, address: u64) -> Option<&Function> {
        self.functions
            .range(..=address)
            .next_back()
            .map(|(_, function)| function)
            .filter(|function| address < function.address + function.size)
    }

    /// Deepest stack below each function, with the chain that needs it. Recursion must have been excluded before.
    pub fn deepest_stack(&self, start: &str) -> (u32, Vec<String>) {
        let graph = self.call_graph();
        let frames: BTreeMap<&str, u32> = self
            .functions
            .values()
            .map(|function| (function.name.as_str(), function.flow.frame_bytes))
            .collect();
        let mut known = BTreeMap::new();
        depth(start, &graph, &frames, &mut known);
        known.remove(start).unwrap_or_default()
    }
}

fn depth(
    name: &str,
    graph: &BTreeMap<String, BTreeSet<String>>,
    frames: &BTreeMap<&str, u32>,
    known: &mut BTreeMap<String, (u32, Vec<String>)>,
) {
    if known.contains_key(name) {
        return;
    }
    // Marks the function while it is on the path, so that a cycle (reported elsewhere) cannot hang the audit.
    known.insert(name.to_owned(), (0, vec![]));
    let mut deepest = (0, vec![]);
    for callee in graph.get(name).into_iter().flatten() {
        depth(callee, graph, frames, known);
        if let Some(below) = known.get(callee).filter(|below| below.0 >= deepest.0) {
            deepest = below.clone();
        }
    }
    let mut chain = vec![name.to_owned()];
    chain.extend(deepest.1);
    known.insert(name.to_owned(), (deepest.0 + frames.get(name).copied().unwrap_or(0), chain));
}
