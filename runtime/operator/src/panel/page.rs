//! The page: everything in one text, so that it works without a network. Its parts are files of their own, and nothing but this
//! puts them together.

use std::sync::OnceLock;

const PARTS: [(&str, &str); 10] = [
    ("/*style*/", include_str!("page/style.css")),
    ("/*words*/", include_str!("page/words.js")),
    ("/*language*/", include_str!("page/language.js")),
    ("/*state*/", include_str!("page/state.js")),
    ("/*map*/", include_str!("page/map.js")),
    ("/*sight*/", include_str!("page/sight.js")),
    ("/*areas*/", include_str!("page/areas.js")),
    ("/*records*/", include_str!("page/records.js")),
    ("/*upkeep*/", include_str!("page/upkeep.js")),
    ("/*main*/", include_str!("page/main.js")),
];

/// The page, complete.
#[must_use]
pub fn page() -> &'static str {
    static PAGE: OnceLock<String> = OnceLock::new();
    PAGE.get_or_init(|| {
        PARTS.iter().fold(include_str!("page/page.html").to_owned(), |page, (mark, part)| {
            page.replacen(mark, part, 1)
        })
    })
}
