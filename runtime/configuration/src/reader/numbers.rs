//! Numbers and flags of a table, each within its range.

use std::ops::RangeInclusive;

use toml::Spanned;
use toml::de::DeValue;

use super::Reader;
use super::units::unit_hint;

impl<'a> Reader<'a> {
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
}

/// Finite numbers only: `nan` and `inf` are legal TOML and never a legal length or speed.
pub(super) fn as_number(value: &DeValue<'_>) -> Option<f32> {
    let number = match value {
        DeValue::Integer(digits) => i64::from_str_radix(digits.as_str(), digits.radix()).ok()? as f32,
        DeValue::Float(digits) => digits.as_str().parse().ok()?,
        _ => return None,
    };
    number.is_finite().then_some(number)
}
