//! How both pages look: on a phone, on a screen and on paper, without anything from elsewhere.

use floorguard_host::words::beside;

use crate::words::Language;

/// The style sheet. A picture is drawn for a screen; on a phone its words and marks grow, and every other mark of an axis
/// goes, so that what is left can be read without a magnifying glass. In the dark the page is dark and its pictures stay on
/// paper: their legends name colours. Paper is always light.
pub const STYLE: &str = include_str!("style.css");

/// The page up to its heading, in English.
pub fn head(title: &str) -> String {
    head_in(Language::English, title)
}

/// The page up to its heading; the title is in the language already.
pub fn head_in(language: Language, title: &str) -> String {
    format!(
        "<!doctype html><html lang=\"{code}\"><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width,initial-scale=1\"><meta name=\"color-scheme\" content=\"light dark\"><title>floorguard: {t}</title><style>{STYLE}</style>\
         <main><h1>{t}</h1>",
        t = escaped(title),
        code = language.code()
    )
}

/// Text that means nothing to HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// One figure of the first glance: the value, what it is, and a class for its colour.
pub type Tile = (String, &'static str, &'static str);

/// The figures of the first glance.
pub fn tiles(tiles: impl IntoIterator<Item = Tile>) -> String {
    let tiles = tiles.into_iter().map(|(value, what, class)| {
        let class = if class.is_empty() { String::new() } else { format!(" class={class}") };
        format!("<li{class}><b>{}</b>{what}</li>", escaped(&value))
    });
    format!("<ul class=sum>{}</ul>", tiles.collect::<String>())
}

/// A tile that counts: what is counted, one and many of it.
pub fn count_tile(count: u64, one: &'static str, many: &'static str) -> Tile {
    count_tile_in(Language::English, count, [one, many])
}

/// The same in a language; one and many in English.
pub fn count_tile_in(language: Language, count: u64, [one, many]: [&'static str; 2]) -> Tile {
    (language.grouped(count), language.say(beside(count, one, many)), "")
}

/// A chart over time.
pub fn chart(svg: &str) -> String {
    format!("<div class=chart>{svg}</div>")
}

/// A picture with marks that grow on a phone.
pub fn map(svg: &str) -> String {
    format!("<div class=map>{svg}</div>")
}

#[cfg(test)]
mod tests {
    use super::{count_tile, tiles};

    #[test]
    fn one_is_not_many_on_a_tile() {
        let html = tiles([0, 1, 2].map(|count| count_tile(count, "stop", "stops")));
        assert_eq!(
            html,
            "<ul class=sum><li><b>0</b>stops</li><li><b>1</b>stop</li><li><b>2</b>stops</li></ul>"
        );
    }
}
