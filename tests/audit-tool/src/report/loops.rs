//! Every loop with its bound, folded by module.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::table::{Table, escape, grouped, source};
use crate::loops::LoopSite;
use crate::sources;

/// A fold for each module, with what its tests reached.
pub fn section(sites: &[LoopSite]) -> String {
    let mut modules = BTreeMap::<String, Vec<&LoopSite>>::new();
    for site in sites {
        let module = sources::module_of(&site.file);
        modules.entry(module).or_default().push(site);
    }
    let mut html = String::from(
        "<p>Open a module for its loops. <i>Its value</i> is the bound as the program computed it while it counted; \
         <i>most turns seen</i> is the largest count of any test or campaign. Fills and comparisons of whole arrays are \
         written by the compiler and cannot be counted; nor can a chain whose source the counting copy cannot name.</p>",
    );
    for (module, sites) in modules {
        let ran = sites.iter().filter(|site| site.seen.largest_seen.is_some()).count();
        let never = sites.iter().filter(|site| site.seen.counted && site.seen.largest_seen.is_none()).count();
        let _ = write!(
            html,
            "<details><summary><code>{}</code>: {} loops, {ran} counted, {never} never ran, {} cannot be counted</summary>{}\
             </details>",
            escape(&module),
            sites.len(),
            sites.len() - ran - never,
            table(&sites)
        );
    }
    html
}

/// The largest count, or why there is none.
fn seen(site: &LoopSite) -> String {
    match (site.seen.largest_seen, site.seen.counted) {
        (Some(largest), _) => grouped(largest),
        (None, true) => format!("never ran while it was counted; see {}", escape(&site.seen.why_not)),
        (None, false) => format!("not counted: {}", escape(&site.seen.why_not)),
    }
}

fn table(sites: &[&LoopSite]) -> String {
    let mut table = Table::new(&[
        "place",
        "function",
        "kind",
        "bound",
        "its value",
        "most turns seen",
        "how the bound is known",
    ]);
    for site in sites {
        table.row(&[
            source(&site.file, site.line),
            escape(&site.function),
            escape(&site.kind),
            escape(&site.bound),
            site.seen.bound_value.map_or_else(String::new, grouped),
            seen(site),
            escape(site.how),
        ]);
    }
    table.finish()
}
