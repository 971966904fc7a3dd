//! Stack of each root along its deepest chain, and the functions of the image.

use serde_json::{Value, json};

use super::table::{Table, code, escape, grouped, verdict};
use crate::facts::facts;
use crate::image::Image;
use crate::image::claims::budget_of;
use crate::image::roots::{Root, is_root, short};

/// The tasks that run a stage.
fn task_of(root: &str) -> &'static str {
    facts().image.tasks.get(short(root)).map_or("not assigned", String::as_str)
}

fn roots_of<'a>(image: &'a Image, roots: &'a [Root]) -> impl Iterator<Item = &'a str> {
    image.functions.values().map(|function| function.name.as_str()).filter(|name| is_root(name, roots))
}

/// Each root for machines.
pub fn list(image: &Image, roots: &[Root]) -> Vec<Value> {
    let entry = |root| {
        let (bytes, chain) = image.deepest_stack(root);
        let (name, tasks, budget_bytes) = (short(root), task_of(root), budget_of(root));
        json!({"root": name, "tasks": tasks, "bytes": bytes, "budget_bytes": budget_bytes, "chain": chain})
    };
    roots_of(image, roots).map(entry).collect()
}

/// Both tables.
pub fn section(image: Option<&Image>, roots: &[Root]) -> String {
    let Some(image) = image else { return String::from("<p>The image does not build.</p>") };
    format!(
        "<p>{} functions, {} B of program and constants, {} B of statics. A frame is what the disassembly shows that a \
         function takes from the stack. Nothing is assumed of assembly: the routines of the compiler's library that are written \
         in it (copies, divisions) are disassembled like all others, and a function that moves the stack pointer by a register \
         fails. A root is the work that a task does for one input. What the executors, the interrupts above each other and \
         start-up add is computed from the linked firmware by <code>cargo xtask firmware --wired</code> and \
         <code>cargo xtask firmware --board stm32h743</code>, which fail above {} B for all together.</p>{}<details><summary>all functions</summary>{}\
         </details>",
        image.functions.len(),
        grouped(image.flash_bytes),
        grouped(image.ram_bytes),
        facts().firmware.as_ref().map_or_else(|| String::from("?"), |firmware| grouped(firmware.stack_bytes)),
        stages(image, roots),
        functions(image)
    )
}

fn stages(image: &Image, roots: &[Root]) -> String {
    let mut table =
        Table::new(&["tasks that run it", "root", "needs, bytes", "budget, bytes", "deepest chain"]);
    for root in roots_of(image, roots) {
        let (bytes, chain) = image.deepest_stack(root);
        let budget = budget_of(root);
        table.row(&[
            escape(task_of(root)),
            code(short(root)),
            grouped(u64::from(bytes)),
            verdict(bytes <= budget, &grouped(u64::from(budget))),
            escape(&chain.iter().map(|name| short(name)).collect::<Vec<_>>().join(" → ")),
        ]);
    }
    table.finish()
}

fn functions(image: &Image) -> String {
    let mut table = Table::new(&["function", "bytes", "frame, bytes", "loops"]);
    for function in image.functions.values() {
        table.row(&[
            code(&function.name),
            grouped(function.size),
            grouped(u64::from(function.flow.frame_bytes)),
            function.flow.back_edges.len().to_string(),
        ]);
    }
    table.finish()
}

#[cfg(test)]
mod tests {
    use crate::facts::facts;
    use crate::image::roots;

    #[test]
    fn every_root_belongs_to_an_existing_task() {
        let root = crate::shell::root();
        let files =
            std::fs::read_dir(root.join(&facts().image.tasks_folder)).expect("tasks").filter_map(Result::ok);
        let tasks: String =
            files.map(|file| std::fs::read_to_string(file.path()).unwrap_or_default()).collect();
        let roots = roots::of_the_image(&root).expect("the sources of the image");
        let mut names: Vec<_> = roots.iter().map(|root| root.name.as_str()).collect();
        let mut reported: Vec<_> = facts().image.tasks.keys().map(String::as_str).collect();
        names.sort_unstable();
        reported.sort_unstable();
        assert!(names.len() > 15, "{names:?}");
        assert_eq!(names, reported, "left the roots of the image, right those of the facts");
        for (name, named) in &facts().image.tasks {
            for task in named.split(", ").filter(|task| *task != "start-up" && !task.starts_with("none: ")) {
                let is_there =
                    ["pub async fn", "pub fn"].iter().any(|kind| tasks.contains(&format!("{kind} {task}<")));
                assert!(is_there, "{name}: there is no task {task}");
            }
        }
    }
}
