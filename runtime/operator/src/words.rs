//! The words of panel and reports in five languages, from one table, and numbers as each language writes them.

use std::collections::HashMap;
use std::sync::OnceLock;

/// The table: a script for the panel's page, and between its brackets rows of text, English first.
const TABLE: &str = include_str!("panel/page/words.js");
/// Its second part: what only the written pages say, so that the panel's page stays small.
const WRITTEN: &str = include_str!("report/words.json");

/// A language of panel and reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Language {
    /// English.
    #[default]
    English,
    /// German.
    German,
    /// French.
    French,
    /// Italian.
    Italian,
    /// Spanish.
    Spanish,
}

impl Language {
    /// All, in the order of the table's columns.
    pub const ALL: [Self; 5] = [Self::English, Self::German, Self::French, Self::Italian, Self::Spanish];

    /// Its two letters (ISO 639-1).
    #[must_use]
    pub const fn code(self) -> &'static str {
        match self {
            Self::English => "en",
            Self::German => "de",
            Self::French => "fr",
            Self::Italian => "it",
            Self::Spanish => "es",
        }
    }

    /// By its two letters.
    #[must_use]
    pub fn of_code(code: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|language| language.code() == code)
    }

    /// Words in this language; what the table does not have stays English.
    #[must_use]
    pub fn say(self, english: &str) -> &str {
        table().get(english).and_then(|row| row.get(self as usize)).map_or(english, String::as_str)
    }

    /// A sentence with gaps, each filled in its order.
    #[must_use]
    pub fn fill(self, english: &str, gaps: &[&str]) -> String {
        let mut pieces = self.say(english).split("{}");
        let mut text = pieces.next().unwrap_or_default().to_owned();
        for (index, piece) in pieces.enumerate() {
            text.push_str(gaps.get(index).copied().unwrap_or_default());
            text.push_str(piece);
        }
        text
    }

    /// Words that begin with some of the table and go on with numbers: the beginning in this language.
    #[must_use]
    pub fn begin(self, english: &str) -> String {
        let ends = english.char_indices().map(|(at, _)| at).filter(|at| *at > 0).rev();
        let known =
            std::iter::once(english.len()).chain(ends).find(|end| table().contains_key(&english[..*end]));
        known.map_or_else(|| english.to_owned(), |end| [self.say(&english[..end]), &english[end..]].concat())
    }

    /// The line of a cause with what was measured, the limit, the age and the action: all of it in this language.
    #[must_use]
    pub fn cause(self, english: &str) -> String {
        let (left, action) = english.split_once(" -> ").unwrap_or((english, ""));
        if let Some((reset, refusal)) = left.split_once(": ").filter(|(reset, _)| *reset == "reset refused") {
            let refusal = match refusal.strip_suffix(": it is still there") {
                Some(cause) => self.fill("still there: {}", &[self.say(cause)]),
                None => self.begin(refusal),
            };
            return format!("{}: {refusal}", self.say(reset));
        }
        // Names of causes may hold a colon themselves.
        let mut spoken =
            if table().contains_key(left) { vec![self.say(left).to_owned()] } else { self.measured(left) };
        if !action.is_empty() {
            spoken.push(self.say(action).to_owned());
        }
        spoken.join(", ")
    }

    /// `name: value, limit value, age`, piece by piece.
    fn measured(self, english: &str) -> Vec<String> {
        let mut pieces = english.split(", ");
        let first = pieces.next().unwrap_or_default();
        let (name, measured) = first.split_once(": ").unwrap_or((first, ""));
        let mut spoken = vec![self.begin(name)];
        if !measured.is_empty() {
            spoken.push(self.fill("measured: {}", &[&self.decimals(measured)]));
        }
        for piece in pieces {
            let parts =
                (piece.strip_prefix("limit "), piece.strip_suffix(" old"), piece.strip_prefix("code "));
            spoken.push(match parts {
                (Some(limit), ..) => self.fill("limit: {}", &[&self.decimals(limit)]),
                (_, Some(age), _) => self.fill("{} old", &[&self.decimals(age)]),
                (.., Some(code)) => self.fill("code {}", &[code]),
                _ => self.begin(piece),
            });
        }
        spoken
    }

    /// Numbers in a text with the point or comma of this language.
    #[must_use]
    pub fn decimals(self, text: &str) -> String {
        if self == Self::English { text.to_owned() } else { text.replace('.', ",") }
    }

    /// Digits in groups of three, as this language sets them apart.
    #[must_use]
    pub fn grouped(self, number: u64) -> String {
        let apart = match self {
            Self::English => ",",
            Self::French => "\u{202f}",
            Self::German | Self::Italian | Self::Spanish => ".",
        };
        let digits = number.to_string();
        let (first, rest) = digits.split_at((digits.len() - 1) % 3 + 1);
        rest.as_bytes().chunks(3).fold(first.to_owned(), |all, three| {
            let three = three.iter().copied().map(char::from);
            all + apart + &three.collect::<String>()
        })
    }

    /// What held the robot, or what came of a reset, as a recording says it.
    #[must_use]
    pub fn held(self, english: &str) -> String {
        match english.strip_prefix("held by: ") {
            Some(cause) if self != Self::English => self.fill("held by: {}", &[&self.cause(cause)]),
            None if self != Self::English => self.cause(english),
            _ => english.to_owned(),
        }
    }

    /// A number with so many digits behind the point, or comma.
    #[must_use]
    pub fn number(self, value: f64, digits: usize) -> String {
        let text = format!("{value:.digits$}");
        // Nothing is nothing: no −0.00.
        let is_nothing = text.chars().all(|letter| ['-', '0', '.'].contains(&letter));
        let text = if is_nothing { text.trim_start_matches('-') } else { &text };
        self.decimals(text)
    }
}

/// Rows of text, English first.
pub(crate) type Rows = Vec<Vec<String>>;

/// What the panel's page has, and what only the written pages have.
pub(crate) fn parts() -> [Rows; 2] {
    let page = TABLE.trim().strip_prefix("const WORDS =").and_then(|text| text.strip_suffix(';'));
    [page.unwrap_or_default(), WRITTEN].map(|rows| serde_json::from_str(rows).unwrap_or_default())
}

fn table() -> &'static HashMap<String, Vec<String>> {
    static READ: OnceLock<HashMap<String, Vec<String>>> = OnceLock::new();
    READ.get_or_init(|| {
        parts().into_iter().flatten().filter_map(|row| Some((row.first()?.clone(), row))).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Literals of a source that people read: with a letter, and neither a format nor a name of the program's.
    fn spoken(source: &str) -> impl Iterator<Item = String> {
        let code = source.split("#[cfg(test)]").next().unwrap_or_default();
        let code: Vec<&str> = code.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        let pieces: Vec<String> = code.join("\n").split('"').skip(1).step_by(2).map(str::to_owned).collect();
        let is_format = |text: &str| {
            text.contains(":.") || text.trim_start_matches("{}").trim() == "s" || text.contains("{date}")
        };
        pieces.into_iter().filter(move |text| text.chars().any(char::is_alphabetic) && !is_format(text))
    }

    /// What the PDF files say stands in the table.
    #[test]
    fn proofs_speak_five_languages() {
        let sources = [include_str!("report/pdf.rs"), include_str!("panel/pdf_of_day.rs")];
        let own = ["held by: ", "floorguard {}", "CARGO_PKG_VERSION", "{} m²", "m²"];
        let missing: Vec<String> = sources
            .iter()
            .flat_map(|source| spoken(source))
            .chain(floorguard_recording::mission::DOUBTS.iter().map(|(_, words)| (*words).to_owned()))
            .filter(|text| !table().contains_key(text) && !own.contains(&text.as_str()))
            .collect();
        assert!(missing.is_empty(), "{missing:#?}");
    }

    #[test]
    fn five_languages_come_from_the_table() {
        assert!(table().len() > 150, "{}", table().len());
        let (german, english) = (Language::German, Language::English);
        assert_eq!(german.say("to do"), "noch zu reinigen");
        assert_eq!(german.fill("The area {} is kept.", &["Halle"]), "Der Bereich Halle ist gespeichert.");
        assert_eq!(english.fill("{} {}", &["a"]), "a ");
        assert_eq!(
            german.begin("emergency stop pressed, 3 s"),
            format!("{}, 3 s", german.say("emergency stop pressed"))
        );
        let line = "obstacle in the protective field (lidar): 0.81 m, limit 0.84 m, 1 ms old -> stop and hold (category 2)";
        assert_eq!(
            german.cause(line),
            "Hindernis im Schutzfeld (Lidar), gemessen: 0,81 m, Grenze: 0,84 m, 1 ms alt, Halt mit gehaltenem Antrieb (Kategorie 2)"
        );
        assert_eq!(
            german.cause("reset refused: drive reports a fault: it is still there"),
            "Quittieren abgelehnt: noch da: Antrieb meldet eine Störung"
        );
        let start = "start-up check: not every required source was healthy yet";
        let action = "stop and hold (category 2)";
        assert_eq!(
            german.cause(&format!("{start} -> {action}")),
            format!("{}, {}", german.say(start), german.say(action))
        );
        assert_eq!(german.begin("größer"), "größer");
        let grouped = Language::ALL.map(|language| language.grouped(1_257_101));
        assert_eq!(grouped, ["1,257,101", "1.257.101", "1\u{202f}257\u{202f}101", "1.257.101", "1.257.101"]);
        assert_eq!([0, 7, 999].map(|number| english.grouped(number)), ["0", "7", "999"]);
        assert_eq!(
            german.held("held by: emergency stop pressed -> torque off (category 0)"),
            "gehalten durch: Not-Halt gedrückt, ohne Drehmoment (Kategorie 0)"
        );
        assert_eq!((german.number(1.25, 1), english.number(1.25, 1)), ("1,2".to_owned(), "1.2".to_owned()));
        assert_eq!([-0.001, -0.1].map(|value| german.number(value, 2)), ["0,00", "-0,10"]);
        for language in Language::ALL {
            assert_eq!(Language::of_code(language.code()), Some(language));
        }
    }
}
