//! Reads typed values out of a TOML table, keeps the place of every mistake, and knows the keys it was asked for.
//!
//! A derived deserialiser stops at the first mistake and cannot know ranges or units. This reader goes on, so that
//! one run shows everything that is wrong. An unknown key is refused with the nearest one that exists; a key that
//! differs only in its unit is distinguished from a misspelt one.

use std::cell::RefCell;
use std::ops::{Range, RangeInclusive};

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::asked::{Asked, note};
use super::problem::{Problem, did_you_mean};

/// Endings of keys that carry a unit.
const UNITS: [&str; 22] = [
    "_mps2", "_mps", "_kmh", "_radps", "_degps", "_deg", "_rad", "_mm", "_cm", "_km", "_m", "_us", "_ms",
    "_s", "_min", "_hz", "_khz", "_per_m", "_baud", "_kg", "_in", "_ft",
];

/// All mistakes found so far; shared by the readers of all tables.
pub type Problems = RefCell<Vec<Problem>>;

/// A table that is being read.
pub struct Reader<'a> {
    table: Option<&'a DeTable<'a>>,
    name: String,
    span: Range<usize>,
    asked: RefCell<Vec<&'static str>>,
    problems: &'a Problems,
}

impl<'a> Reader<'a> {
    /// Reads a table whose name (for messages) and place are given.
    #[must_use]
    pub fn new(table: &'a DeTable<'a>, name: &str, span: Range<usize>, problems: &'a Problems) -> Self {
        Self { table: Some(table), name: name.to_owned(), span, asked: RefCell::default(), problems }
    }

    /// Notes a mistake at a place of the text.
    pub fn refuse(&self, span: &Range<usize>, what: impl Into<String>, remedy: impl Into<String>) {
        self.problems.borrow_mut().push(Problem {
            offset: span.start,
            what: what.into(),
            remedy: remedy.into(),
        });
    }

    /// Where this table stands.
    #[must_use]
    pub fn span(&self) -> &Range<usize> {
        &self.span
    }

    /// Nothing is wrong so far. Checks that combine several values wait for this, so that one mistake gives one line.
    #[must_use]
    pub fn good_so_far(&self) -> bool {
        self.problems.borrow().is_empty()
    }

    /// The raw value of a key, if it is there.
    pub fn find(&self, key: &'static str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.asked.borrow_mut().push(key);
        self.table?.get(key)
    }

    /// The raw value of a key that must be there.
    fn require(&self, key: &'static str, example: &str) -> Option<&'a Spanned<DeValue<'a>>> {
        let found = self.find(key);
        if found.is_none() && self.table.is_some() && !self.has_unit_sibling(key) {
            self.refuse(
                &self.span,
                format!("{}: `{key}` is missing", self.title()),
                format!("add for example `{key} = {example}`"),
            );
        }
        found
    }

    /// A table that must be there.
    pub fn section(&self, key: &'static str) -> Reader<'a> {
        let section = self.optional_section(key);
        if section.is_none() && self.table.is_some() {
            self.refuse(
                &self.span,
                format!("{}: section `[{key}]` is missing", self.title()),
                "add the section",
            );
        }
        section.unwrap_or(Reader {
            table: None,
            name: key.to_owned(),
            span: self.span.clone(),
            asked: RefCell::default(),
            problems: self.problems,
        })
    }

    /// A table that may be there.
    pub fn optional_section(&self, key: &'static str) -> Option<Reader<'a>> {
        let value = self.find(key)?;
        let name = if self.name.is_empty() { key.to_owned() } else { format!("{}.{key}", self.name) };
        match value.get_ref() {
            DeValue::Table(table) => Some(Reader::new(table, &name, value.span(), self.problems)),
            other => {
                self.refuse_type(&value.span(), &name, "a table", other);
                None
            }
        }
    }

    /// A list of tables, such as `[[field]]`; empty when absent.
    pub fn sections(&self, key: &'static str) -> Vec<Reader<'a>> {
        let Some(value) = self.find(key) else { return Vec::new() };
        let DeValue::Array(items) = value.get_ref() else {
            self.refuse_type(&value.span(), key, "a list of tables", value.get_ref());
            return Vec::new();
        };
        let mut readers = Vec::new();
        for (index, item) in items.iter().enumerate() {
            let name = format!("{key} {}", index + 1);
            match item.get_ref() {
                DeValue::Table(table) => readers.push(Reader::new(table, &name, item.span(), self.problems)),
                other => self.refuse_type(&item.span(), &name, "a table", other),
            }
        }
        readers
    }

    fn note(&self, key: &'static str, kind: &'static str, (allowed, default): (String, Option<String>)) {
        note(|| Asked { section: self.name.clone(), key, kind, allowed, default });
    }

    /// A number that must be there and within a range.
    pub fn number(&self, key: &'static str, range: RangeInclusive<f32>) -> f32 {
        self.note(key, "number", (format!("{} to {}", range.start(), range.end()), None));
        let example = format!("{}", range.start().max(0.0).midpoint(*range.end()));
        self.require(key, &example).map_or(*range.start(), |value| self.checked_number(key, value, &range))
    }

    /// A number within a range, or a default when absent.
    pub fn number_or(&self, key: &'static str, range: RangeInclusive<f32>, default: f32) -> f32 {
        let allowed = format!("{} to {}", range.start(), range.end());
        self.note(key, "number", (allowed, Some(default.to_string())));
        self.find(key).map_or(default, |value| self.checked_number(key, value, &range))
    }

    fn checked_number(&self, key: &str, value: &Spanned<DeValue<'_>>, range: &RangeInclusive<f32>) -> f32 {
        let Some(number) = as_number(value.get_ref()) else {
            self.refuse_type(&value.span(), key, "a number", value.get_ref());
            return *range.start();
        };
        if !range.contains(&number) {
            self.refuse(
                &value.span(),
                format!(
                    "{}: `{key}` is {number}, allowed is {} to {}",
                    self.title(),
                    range.start(),
                    range.end()
                ),
                unit_hint(key, number, range),
            );
        }
        number
    }

    /// A number within a range, if the key is there; `without` says what holds if it is not.
    pub fn number_or_absent(
        &self,
        key: &'static str,
        range: RangeInclusive<f32>,
        without: &str,
    ) -> Option<f32> {
        let allowed = format!("{} to {}", range.start(), range.end());
        self.note(key, "number", (allowed, Some(without.to_owned())));
        self.find(key).map(|value| self.checked_number(key, value, &range))
    }

    /// A whole number within a range that must be there.
    pub fn integer(&self, key: &'static str, range: RangeInclusive<i64>) -> i64 {
        self.note(key, "whole number", (format!("{} to {}", range.start(), range.end()), None));
        let Some(value) = self.require(key, &range.start().to_string()) else { return *range.start() };
        self.checked_integer(key, value, &range)
    }

    /// A whole number within a range, or a default.
    pub fn integer_or(&self, key: &'static str, range: RangeInclusive<i64>, default: i64) -> i64 {
        let allowed = format!("{} to {}", range.start(), range.end());
        self.note(key, "whole number", (allowed, Some(default.to_string())));
        self.find(key).map_or(default, |value| self.checked_integer(key, value, &range))
    }

    /// A whole number within a range, if the key is there.
    pub fn integer_or_absent(&self, key: &'static str, range: RangeInclusive<i64>) -> Option<i64> {
        let allowed = format!("{} to {}", range.start(), range.end());
        self.note(key, "whole number", (allowed, Some("not fitted".to_owned())));
        self.find(key).map(|value| self.checked_integer(key, value, &range))
    }

    fn checked_integer(&self, key: &str, value: &Spanned<DeValue<'_>>, range: &RangeInclusive<i64>) -> i64 {
        let DeValue::Integer(digits) = value.get_ref() else {
            self.refuse_type(&value.span(), key, "a whole number", value.get_ref());
            return *range.start();
        };
        match i64::from_str_radix(digits.as_str(), digits.radix()) {
            Ok(number) if range.contains(&number) => number,
            _ => {
                let (start, end) = range.clone().into_inner();
                let what =
                    format!("{}: `{key}` is {}, allowed is {start} to {end}", self.title(), digits.as_str());
                self.refuse(&value.span(), what, "write a number within these limits");
                start
            }
        }
    }

    /// True or false; a default when absent.
    pub fn flag_or(&self, key: &'static str, default: bool) -> bool {
        self.note(key, "flag", ("true, false".to_owned(), Some(default.to_string())));
        let Some(value) = self.find(key) else { return default };
        value.get_ref().as_bool().unwrap_or_else(|| {
            self.refuse_type(&value.span(), key, "true or false", value.get_ref());
            default
        })
    }

    /// A text that must be there, with its place.
    pub fn text(&self, key: &'static str, example: &str) -> Option<(&'a str, Range<usize>)> {
        self.note(key, "text", (format!("for example `{example}`"), None));
        self.words(key, example)
    }

    /// A text that may be there, with its place; `without` says what holds if it is not.
    pub fn text_or_absent(
        &self,
        key: &'static str,
        example: &str,
        without: &str,
    ) -> Option<(&'a str, Range<usize>)> {
        self.note(key, "text", (format!("for example `{example}`"), Some(without.to_owned())));
        self.find(key).and_then(|_| self.words(key, example))
    }

    fn words(&self, key: &'static str, example: &str) -> Option<(&'a str, Range<usize>)> {
        let value = self.require(key, &format!("\"{example}\""))?;
        let text = value.get_ref().as_str();
        if text.is_none() {
            self.refuse_type(&value.span(), key, "a text in quotes", value.get_ref());
        }
        text.map(|text| (text, value.span()))
    }

    /// One of a list of words.
    pub fn choice<T: Copy>(&self, key: &'static str, choices: &[(&str, T)]) -> Option<T> {
        let words: Vec<String> = choices.iter().map(|(word, _)| format!("`{word}`")).collect();
        self.note(key, "word", (words.join(", "), None));
        let (text, span) = self.words(key, choices.first().map_or("", |(word, _)| word))?;
        let chosen = choices.iter().find(|(word, _)| *word == text).map(|(_, value)| *value);
        if chosen.is_none() {
            let words: Vec<&str> = choices.iter().map(|(word, _)| *word).collect();
            self.refuse(
                &span,
                format!("{}: `{key}` is \"{text}\", which is not known", self.title()),
                did_you_mean(text, &words).unwrap_or(format!("allowed are {}", words.join(", "))),
            );
        }
        chosen
    }

    /// A list of `[x, y]` pairs in metres, with its place.
    pub fn points(&self, key: &'static str) -> Option<(Vec<[f32; 2]>, Range<usize>)> {
        self.note(key, "list of points", ("pairs `[x, y]` in metres".to_owned(), None));
        let value = self.require(key, "[[0.0, 0.0], [1.0, 0.0]]")?;
        let points = value
            .get_ref()
            .as_array()
            .and_then(|items| items.iter().map(|item| pair(item.get_ref())).collect());
        match points {
            Some(points) => Some((points, value.span())),
            None => {
                self.refuse_type(&value.span(), key, "a list of [x, y] pairs in metres", value.get_ref());
                None
            }
        }
    }

    /// The numbers of one or two bits of a process image of four times eight bytes, for example `[32, 33]`; twice the
    /// same for a single one. `None` when the key is absent or wrong.
    pub fn bits_or_absent(&self, key: &'static str) -> Option<[u8; 2]> {
        match self.bits(key, "one or two bit numbers from 0 to 255", 1..=2)?[..] {
            [single] => Some([single, single]),
            [first, second] => Some([first, second]),
            _ => None,
        }
    }

    /// The numbers of any bits of a process image; none when the key is absent or wrong.
    pub fn bit_list(&self, key: &'static str) -> Vec<u8> {
        self.bits(key, "a list of bit numbers from 0 to 255", 0..=256).unwrap_or_default()
    }

    fn bits(
        &self,
        key: &'static str,
        expected: &str,
        count: core::ops::RangeInclusive<usize>,
    ) -> Option<Vec<u8>> {
        self.note(key, "bits", (expected.to_owned(), Some("not connected".to_owned())));
        let value = self.find(key)?;
        let numbers: Option<Vec<u8>> = value.get_ref().as_array().and_then(|items| {
            let bit = |item: &Spanned<DeValue<'_>>| match item.get_ref() {
                DeValue::Integer(digits) => digits.as_str().parse().ok(),
                _ => None,
            };
            items.iter().map(bit).collect()
        });
        let numbers = numbers.filter(|numbers| count.contains(&numbers.len()));
        if numbers.is_none() {
            self.refuse_type(&value.span(), key, expected, value.get_ref());
        }
        numbers
    }

    /// Refuses every unknown key.
    pub fn finish(self) {
        let asked = self.asked.borrow();
        for (key, _) in
            self.table.into_iter().flatten().filter(|(key, _)| !asked.contains(&key.get_ref().as_ref()))
        {
            let word = key.get_ref().as_ref();
            let (what, remedy) = match asked.iter().find(|known| stem(known) == stem(word)) {
                Some(known) => (
                    format!("{}: `{word}` has the wrong unit", self.title()),
                    format!("convert the value and write `{known}`"),
                ),
                None => (
                    format!("{}: `{word}` is not a known key", self.title()),
                    did_you_mean(word, &asked).unwrap_or(format!("known are {}", asked.join(", "))),
                ),
            };
            self.refuse(&key.span(), what, remedy);
        }
    }

    /// The key is there under another unit: one message about the unit is enough.
    fn has_unit_sibling(&self, key: &str) -> bool {
        stem(key) != key
            && self.table.into_iter().flatten().any(|(other, _)| stem(other.get_ref()) == stem(key))
    }

    /// The table's name for messages.
    #[must_use]
    pub fn title(&self) -> String {
        if self.name.is_empty() { "top level".to_owned() } else { format!("[{}]", self.name) }
    }

    fn refuse_type(&self, span: &Range<usize>, key: &str, wanted: &str, found: &DeValue<'_>) {
        let what = format!("{}: `{key}` must be {wanted}, this is {}", self.title(), describe(found));
        self.refuse(span, what, format!("write {wanted}"));
    }
}

fn describe(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a text",
        DeValue::Float(digits) if digits.as_str().contains(['n', 'N']) => "infinite or not a number",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list of something else",
        DeValue::Table(_) => "a table",
    }
}

/// Finite numbers only: `nan` and `inf` are legal TOML and never a legal length or speed.
fn as_number(value: &DeValue<'_>) -> Option<f32> {
    let number = match value {
        DeValue::Integer(digits) => i64::from_str_radix(digits.as_str(), digits.radix()).ok()? as f32,
        DeValue::Float(digits) => digits.as_str().parse().ok()?,
        _ => return None,
    };
    number.is_finite().then_some(number)
}

fn pair(value: &DeValue<'_>) -> Option<[f32; 2]> {
    match value.as_array()?.iter().map(|item| as_number(item.get_ref())).collect::<Option<Vec<f32>>>()?[..] {
        [x_m, y_m] => Some([x_m, y_m]),
        _ => None,
    }
}

/// A key without its unit.
fn stem(key: &str) -> &str {
    UNITS.iter().find_map(|unit| key.strip_suffix(unit)).unwrap_or(key)
}

/// The usual wrong unit explains most values that are far out of range.
fn unit_hint(key: &str, number: f32, range: &RangeInclusive<f32>) -> String {
    let candidates: &[(&str, f32)] = if key.ends_with("_m") || key.ends_with("_mps") || key.ends_with("_mps2")
    {
        &[("millimetres", 1.0e-3), ("centimetres", 1.0e-2)]
    } else if key.ends_with("_s") {
        &[("milliseconds", 1.0e-3)]
    } else if key.ends_with("_rad") {
        &[("degrees", core::f32::consts::PI / 180.0)]
    } else {
        &[]
    };
    let fitting = candidates.iter().find(|(_, factor)| number != 0.0 && range.contains(&(number * factor)));
    fitting.map_or("write a value within these limits".to_owned(), |(unit, factor)| {
        // Six digits: the factor must not show up as 0.90000004.
        format!("if {number} is meant in {unit}, write {}", (number * factor * 1.0e6).round() / 1.0e6)
    })
}
