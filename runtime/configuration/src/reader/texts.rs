//! Texts and words of a table.

use std::ops::Range;

use super::Reader;
use crate::problem::did_you_mean;

impl<'a> Reader<'a> {
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

    /// A list of texts that may be there, each with its place; empty when the key is absent or wrong.
    pub fn texts(&self, key: &'static str, example: &str) -> Vec<(&'a str, Range<usize>)> {
        self.note(key, "list of texts", (format!("for example `{example}`"), Some("none".to_owned())));
        let Some(value) = self.find(key) else { return Vec::new() };
        let items = value.get_ref().as_array();
        let texts = items.and_then(|items| {
            items.iter().map(|item| Some((item.get_ref().as_str()?, item.span()))).collect::<Option<Vec<_>>>()
        });
        texts.unwrap_or_else(|| {
            self.refuse_type(&value.span(), key, "a list of texts in quotes", value.get_ref());
            Vec::new()
        })
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
        self.chosen(key, choices)
    }

    /// One of a list of words, or a default when absent.
    pub fn choice_or<T: Copy + PartialEq>(&self, key: &'static str, choices: &[(&str, T)], default: T) -> T {
        let words: Vec<String> = choices.iter().map(|(word, _)| format!("`{word}`")).collect();
        let without =
            choices.iter().find(|(_, value)| *value == default).map(|(word, _)| format!("`{word}`"));
        self.note(key, "word", (words.join(", "), without));
        self.find(key).and_then(|_| self.chosen(key, choices)).unwrap_or(default)
    }

    fn chosen<T: Copy>(&self, key: &'static str, choices: &[(&str, T)]) -> Option<T> {
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
}
