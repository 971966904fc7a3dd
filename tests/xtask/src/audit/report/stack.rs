//! Stack of each root along its deepest chain, and the functions of the image.

use serde_json::{Value, json};

use super::table::{Table, code, escape, grouped, verdict};
use crate::audit::image::Image;
use crate::audit::image_claims::budget_of;
use crate::audit::roots::{Root, is_root, short};
use crate::firmware::STACK_MAX;

/// Which task of `runtime/src/tasks` runs the stage of a root; start-up runs before all of them.
const TASKS: &[(&str, &str)] = &[
    ("root_floor_plane", "none: the camera's thread on Linux"),
    ("root_floor_objects", "none: the camera's thread on Linux"),
    ("root_position", "none: recordings only"),
    ("root_motion", "perceive"),
    ("root_people", "perceive"),
    ("root_legs", "perceive"),
    ("root_odometry", "imu_input, can_bus"),
    ("root_guard_scan", "scanner_input, scanner_datagrams"),
    ("root_guard_tick", "supervise, operator_input"),
    ("root_guard_start", "start-up"),
    ("root_guard_advice", "advice_input"),
    ("root_guard_inputs", "can_bus"),
    ("root_guard_motion", "imu_input, can_bus, command_input"),
    ("root_guard_packet", "lidar_input"),
    ("root_velodyne", "lidar_input"),
    ("root_sweep", "perceive"),
    ("root_s300", "scanner_input"),
    ("root_microscan3", "scanner_datagrams"),
    ("root_xsens", "imu_input"),
    ("root_slcan", "can_bus"),
    ("root_canopen", "can_bus"),
    ("root_base_poll", "can_bus"),
    ("root_base_frame", "can_bus"),
    ("root_base_start", "start-up"),
];

fn task_of(root: &str) -> &'static str {
    TASKS.iter().find(|(name, _)| *name == short(root)).map_or("not told", |(_, task)| task)
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
        grouped(STACK_MAX),
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
    use super::TASKS;
    use crate::audit::roots;

    #[test]
    fn every_root_belongs_to_a_task_that_there_is() {
        let root = crate::shell::root();
        let files = std::fs::read_dir(root.join("runtime/src/tasks")).expect("tasks").filter_map(Result::ok);
        let tasks: String =
            files.map(|file| std::fs::read_to_string(file.path()).unwrap_or_default()).collect();
        let roots = roots::of_the_image(&root).expect("the sources of the image");
        let mut names: Vec<_> = roots.iter().map(|root| root.name.as_str()).collect();
        let mut told: Vec<_> = TASKS.iter().map(|(name, _)| *name).collect();
        names.sort_unstable();
        told.sort_unstable();
        assert!(names.len() > 15, "{names:?}");
        assert_eq!(names, told, "left the roots of the image, right the lines of TASKS");
        for (name, named) in TASKS {
            for task in named.split(", ").filter(|task| *task != "start-up" && !task.starts_with("none: ")) {
                assert!(tasks.contains(&format!("pub async fn {task}<")), "{name}: there is no task {task}");
            }
        }
    }
}
