//! A table of the page, and text that cannot break it.

use std::fmt::Write as _;

/// A table under construction.
pub struct Table {
    html: String,
}

impl Table {
    /// With these columns.
    pub fn new(columns: &[&str]) -> Self {
        let mut html = String::from("<div class=wide><table><thead><tr>");
        for column in columns {
            let _ = write!(html, "<th>{}", escape(column));
        }
        html.push_str("</tr></thead><tbody>");
        Self { html }
    }

    /// A row of cells that are HTML already.
    pub fn row(&mut self, cells: &[String]) {
        self.html.push_str("<tr>");
        for cell in cells {
            let _ = write!(self.html, "<td>{cell}");
        }
        self.html.push_str("</tr>");
    }

    /// The finished table.
    pub fn finish(mut self) -> String {
        self.html.push_str("</tbody></table></div>");
        self.html
    }
}

/// Text as HTML, within an attribute in quotes too.
pub fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    text.replace('\'', "&#39;").replace('"', "&quot;")
}

/// A name that the page can be led to.
pub fn anchor(id: &str) -> String {
    format!("<b id='{0}'>{0}</b>", escape(id))
}

/// The link to a name on the page.
pub fn link(id: &str) -> String {
    format!("<a href='#{0}'>{0}</a>", escape(id))
}

/// Text in the type of code.
pub fn code(text: &str) -> String {
    format!("<code>{}</code>", escape(text))
}

/// A line of a source, with the path to its file from the folder of the page.
pub fn source(file: &str, line: usize) -> String {
    format!("<a href='../../{0}'><code>{0}:{line}</code></a>", escape(file))
}

/// A verdict, in colour and in words.
pub fn verdict(good: bool, words: &str) -> String {
    let class = if good { "good" } else { "bad" };
    format!("<span class={class}>{}</span>", escape(words))
}

/// What is neither good nor bad, in grey and in words.
pub fn aside(words: &str) -> String {
    format!("<span class=aside>{}</span>", escape(words))
}

/// `1234567` as `1 234 567`.
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_cannot_break_a_page() {
        let mut table = Table::new(&["a<b"]);
        table.row(&[code("Vec<u8>"), grouped(1_234_567)]);
        let html = table.finish();
        assert!(
            html.contains("a&lt;b")
                && html.contains("Vec&lt;u8&gt;")
                && html.contains("1\u{202f}234\u{202f}567")
        );
    }

    #[test]
    fn text_cannot_leave_an_attribute() {
        let id = "x' onclick='a()\" <b>&";
        let safe = "x&#39; onclick=&#39;a()&quot; &lt;b&gt;&amp;";
        assert_eq!(anchor(id), format!("<b id='{safe}'>{safe}</b>"));
        assert_eq!(link(id), format!("<a href='#{safe}'>{safe}</a>"));
        assert_eq!(source("a'b.rs", 3), "<a href='../../a&#39;b.rs'><code>a&#39;b.rs:3</code></a>");
    }
}
