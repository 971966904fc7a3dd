//! Reads typed values out of a TOML table, keeps the place of every mistake, and knows the keys it was asked for.
//!
//! A derived deserialiser stops at the first mistake and cannot know ranges or units. This reader goes on, so that
//! one run shows everything that is wrong. An unknown key is refused with the nearest one that exists; a key that
//! differs only in its unit is distinguished from a misspelt one.

mod lists;
mod numbers;
mod texts;
mod units;

use std::cell::RefCell;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::asked::{Asked, note};
use super::problem::{Problem, did_you_mean};
use units::stem;

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
        let (what, remedy) = (what.into(), remedy.into());
        self.found(Problem { offset: span.start, what, remedy, is_understood: false });
    }

    /// Notes something with which no robot drives, although it is clear what is meant: recordings of robots that did are still
    /// read.
    pub fn refuse_to_drive(&self, span: &Range<usize>, what: impl Into<String>, remedy: impl Into<String>) {
        let (what, remedy) = (what.into(), remedy.into());
        self.found(Problem { offset: span.start, what, remedy, is_understood: true });
    }

    fn found(&self, problem: Problem) {
        self.problems.borrow_mut().push(problem);
    }

    /// Where this table stands.
    #[must_use]
    pub fn span(&self) -> &Range<usize> {
        &self.span
    }

    /// Everything was understood so far. Checks that combine several values wait for this, so that one mistake gives one line.
    #[must_use]
    pub fn good_so_far(&self) -> bool {
        self.problems.borrow().iter().all(|problem| problem.is_understood)
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
        self.section_because(key, "add the section")
    }

    /// The same, with why it must.
    pub fn section_because(&self, key: &'static str, reason: &str) -> Reader<'a> {
        let section = self.optional_section(key);
        if section.is_none() && self.table.is_some() {
            self.refuse(&self.span, format!("{}: section `[{key}]` is missing", self.title()), reason);
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
