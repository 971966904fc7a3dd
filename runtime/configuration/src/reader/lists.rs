//! Lists of a table: points and bit numbers.

use std::ops::Range;

use toml::Spanned;
use toml::de::DeValue;

use super::Reader;
use super::numbers::as_number;

impl<'a> Reader<'a> {
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

    /// A list of angles in degrees, with its place.
    pub fn angles(&self, key: &'static str) -> Option<(Vec<f32>, Range<usize>)> {
        self.note(key, "list of numbers", ("degrees, −90 to 90".to_owned(), None));
        let value = self.require(key, "[15.0, 13.0]")?;
        let is_angle = |degrees: &f32| (-90.0..=90.0).contains(degrees);
        let angles = value.get_ref().as_array().and_then(|items| {
            items.iter().map(|item| as_number(item.get_ref()).filter(is_angle)).collect::<Option<Vec<f32>>>()
        });
        match angles {
            Some(angles) => Some((angles, value.span())),
            None => {
                self.refuse_type(&value.span(), key, "a list of degrees from -90 to 90", value.get_ref());
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
}

fn pair(value: &DeValue<'_>) -> Option<[f32; 2]> {
    match value.as_array()?.iter().map(|item| as_number(item.get_ref())).collect::<Option<Vec<f32>>>()?[..] {
        [x_m, y_m] => Some([x_m, y_m]),
        _ => None,
    }
}
