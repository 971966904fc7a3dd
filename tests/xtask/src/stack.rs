//! How much stack a linked firmware image can need, start-up included, from its compiled code.
//!
//! The thread starts up, or runs one task of perception; the guard's executor interrupts it with one of its tasks, then a
//! device, then the clock, then a fault: one chain each, and the frames that the processor pushes in between. A call
//! through a register may reach any function whose address the image holds, except the tasks themselves, which only
//! their executors call.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Context, Result, bail};
use object::{Object, ObjectSection, ObjectSymbol, SectionKind, SymbolKind};

use embedded_audit::image::thumb::{self, Flow};

/// What the processor pushes at an interrupt, bytes: registers, those of the floating-point unit, and alignment.
const EXCEPTION_BYTES: u32 = 112;
/// Interrupts that can lie above each other: guard, device, clock, fault.
const LEVELS: usize = 4;
/// Poll functions of tasks carry this in their names.
const TASK: &str = "TaskStorage<F>::poll";

/// What the stack must hold, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Need {
    /// From the first instruction until the executors run.
    pub start: u32,
    /// The deepest task.
    pub task: u32,
    /// All interrupts above each other, the guard's ring among them.
    pub interrupts: u32,
}

impl Need {
    /// The most at any time: start-up with interrupts, or a task with them.
    pub fn most(&self) -> u32 {
        self.start.max(self.task) + self.interrupts
    }
}

struct Function {
    name: String,
    end: u64,
    flow: Flow,
}

struct Graph {
    functions: BTreeMap<u64, Function>,
    /// Functions that a call through a register may reach.
    reachable: BTreeSet<u64>,
}

/// Reads the image. `handlers` are the names of all interrupt handlers by level, the guard's executor first.
pub fn need(path: &Path, handlers: &[&[&str]]) -> Result<Need> {
    if handlers.len() > LEVELS {
        bail!("more than {LEVELS} levels of interrupts");
    }
    let graph = read(path)?;
    let mut known = BTreeMap::new();
    let indirect = graph.indirect(&mut known);
    let mut depth = |name: &str| -> Result<u32> {
        let found = graph.functions.iter().filter(|(_, function)| function.name == name);
        let depths = found.map(|(address, _)| graph.depth(*address, indirect, &mut known));
        depths.max().with_context(|| format!("the image has no function {name}"))
    };
    let start = depth("main")?;
    let mut interrupts = 0;
    for level in handlers {
        let mut deepest = 0;
        for name in *level {
            deepest = deepest.max(depth(name)?);
        }
        interrupts += deepest + EXCEPTION_BYTES;
    }
    let tasks: Vec<u64> = graph.tasks().collect();
    if tasks.is_empty() {
        bail!("the image has no tasks: nothing would be proven");
    }
    let mut known = BTreeMap::new();
    let task = tasks.into_iter().map(|task| graph.depth(task, indirect, &mut known)).max().unwrap_or(0);
    // The guard's executor polls tasks, too: which ring a task is on, its code does not tell.
    Ok(Need { start, task, interrupts: interrupts + task })
}

fn read(path: &Path) -> Result<Graph> {
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    let file = object::File::parse(&*bytes).context("not an ELF image")?;
    let mut marks = BTreeMap::new();
    for symbol in file.symbols() {
        match symbol.name().unwrap_or("").get(..2) {
            Some("$d") => _ = marks.insert(symbol.address(), true),
            Some("$t") => _ = marks.insert(symbol.address() & !1, false),
            _ => {}
        }
    }
    let is_data = |at| marks.range(..=at).next_back().is_some_and(|(_, data)| *data);
    let mut functions = BTreeMap::new();
    for symbol in file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text && symbol.size() > 0) {
        let (address, size) = (symbol.address() & !1, symbol.size());
        let code = file.sections().find_map(|section| section.data_range(address, size).ok().flatten());
        let Some(code) = code else { continue };
        let name = format!("{:#}", rustc_demangle::demangle(symbol.name().unwrap_or("")));
        let flow = thumb::decode(code, address, is_data);
        functions.insert(address, Function { name, end: address + size, flow });
    }
    let mut reachable = BTreeSet::new();
    let constants = |kind| matches!(kind, SectionKind::ReadOnlyData | SectionKind::Data | SectionKind::Text);
    for section in file.sections().filter(|section| constants(section.kind())) {
        // A vector table lies by itself: the processor calls it, nobody else.
        if section.name().is_ok_and(|name| name.contains("vector")) {
            continue;
        }
        for word in section.data().unwrap_or_default().as_chunks::<4>().0 {
            let word = u64::from(u32::from_le_bytes(*word));
            if word & 1 == 1 && functions.contains_key(&(word - 1)) {
                reachable.insert(word - 1);
            }
        }
    }
    reachable.retain(|address| {
        functions
            .get(address)
            .is_some_and(|function| !function.name.contains(TASK) && function.name != "main")
    });
    Ok(Graph { functions, reachable })
}

impl Graph {
    fn tasks(&self) -> impl Iterator<Item = u64> {
        let tasks = self.functions.iter().filter(|(_, function)| function.name.contains(TASK));
        tasks.map(|(address, _)| *address)
    }

    /// The deepest of what a call through a register may reach, where it calls nothing through a register itself.
    fn indirect(&self, known: &mut BTreeMap<u64, u32>) -> u32 {
        let deepest = self.reachable.iter().map(|address| self.depth(*address, 0, known)).max().unwrap_or(0);
        known.clear();
        deepest
    }

    fn depth(&self, address: u64, indirect: u32, known: &mut BTreeMap<u64, u32>) -> u32 {
        let Some((start, function)) = self.functions.range(..=address).next_back() else { return 0 };
        if address >= function.end {
            return 0;
        }
        if let Some(depth) = known.get(start) {
            return *depth;
        }
        // On the path: what calls itself (formatting of numbers, one fault on purpose) counts once.
        known.insert(*start, 0);
        let direct = function.flow.calls.iter().map(|(_, target)| self.depth(*target, indirect, known));
        let through_register = if function.flow.indirect_calls.is_empty() { 0 } else { indirect };
        let below = direct.max().unwrap_or(0).max(through_register);
        let depth = function.flow.frame_bytes + below;
        known.insert(*start, depth);
        depth
    }
}
