//! Changes of number type, in one place: every name says what becomes of a value that the new type cannot hold.
//!
//! *saturating*: the nearest end of the type, towards zero, and 0 for a NaN; *nearest*: the nearest float; *truncating*: the low
//! bits; no such word: nothing can be lost. Each is what `as` does (Rust Reference, Operator expressions: Numeric cast) and what it
//! compiles to; `From` serves wherever a type holds every value of the other, and elsewhere in the core `as` is refused.
#![allow(clippy::as_conversions)]

mod from_float;
mod whole;

pub use from_float::{
    nearest_f32_of_f64, saturating_i8, saturating_i16, saturating_i32, saturating_i64_of_f64, saturating_u8,
    saturating_u16, saturating_u32, saturating_u32_of_f64, saturating_u64, saturating_usize,
    saturating_usize_of_f64,
};
pub use whole::{
    Whole, count_f32, count_i32, count_u32, count_u64, exact_usize, nearest_f32, nearest_f64,
    saturating_u16_of_u32, short_usize, truncating_i32, truncating_i64, truncating_u8, truncating_u16,
    truncating_u32, truncating_u64, truncating_usize,
};
