//! Stack of each root along its deepest chain, and the functions of the image.

use super::table::{Table, code, escape, grouped, verdict};
use crate::audit::image::Image;
use crate::audit::image_claims::budget_of;

/// Both tables.
pub fn section(image: Option<&Image>) -> String {
    let Some(image) = image else { return String::from("<p>The image does not build.</p>") };
    format!(
        "<p>{} functions, {} B of program and constants, {} B of statics. A frame is what the disassembly shows that a \
         function takes from the stack, assembly routines included.</p>{}<details><summary>all functions</summary>{}\
         </details>",
        image.functions.len(),
        grouped(image.flash_bytes),
        grouped(image.ram_bytes),
        roots(image),
        functions(image)
    )
}

fn roots(image: &Image) -> String {
    let mut table = Table::new(&["root", "needs, bytes", "budget, bytes", "deepest chain"]);
    let names = image.functions.values().map(|function| function.name.as_str());
    for root in names.filter(|name| name.contains("root_")) {
        let (bytes, chain) = image.deepest_stack(root);
        let budget = budget_of(root);
        let short = |name: &str| name.rsplit("::").next().unwrap_or(name).to_owned();
        table.row(&[
            code(&short(root)),
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
