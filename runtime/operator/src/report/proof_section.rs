//! The proof of cleaning for people: who, when, with what; what is claimed and what not.

use std::fmt::Write as _;

use super::proof::{Cleaning, NotClaimed, Proof};
use super::style::escaped;
use crate::words::Language;

/// The first section of the page: who, when, with what; and of a mission what was cleaned and what not.
#[must_use]
pub fn section(proof: &Proof, language: Language) -> String {
    let mut html = String::new();
    html.push_str("<dl class=facts>");
    for (name, text) in proof.facts() {
        let _ = write!(html, "<dt>{}<dd>{}", language.say(name), escaped(&text));
    }
    html.push_str("</dl>");
    if let Some(cleaning) = &proof.cleaning {
        html.push_str(&cleaned(cleaning, language));
    }
    html
}

/// What is claimed of the floor that was cleaned, in words.
pub fn claim(cleaning: &Cleaning, language: Language) -> String {
    match (cleaning.confidence_percent, cleaning.tolerated_units) {
        (Some(percent), Some(units)) => language.fill(
            "with {} % confidence no more than {} units of dirt in each cell",
            &[&language.number(percent, 1), &units.to_string()],
        ),
        _ => language.say("clean").to_owned(),
    }
}

/// What came of the dirt, in a sentence.
pub fn rest(cleaning: &Cleaning, language: Language) -> String {
    let figures = [cleaning.dirt_gone_percent, cleaning.waited_s].map(|value| language.number(value, 0));
    language.fill(
        "{} % of the expected dirt is gone; the robot waited {} s for people. At the end the mission was: {}.",
        &[&figures[0], &figures[1], language.say(&cleaning.phase)],
    )
}

fn cleaned(cleaning: &Cleaning, language: Language) -> String {
    let say = |words: &'static str| language.say(words);
    let [heading, floor, area, claimed] = ["Proof of cleaning", "floor", "area", "what is claimed"].map(say);
    let mut html =
        format!("<h2>{heading}</h2><table class=proof><tr><th>{floor}<th class=num>{area}<th>{claimed}</tr>");
    let claim = claim(cleaning, language);
    let rows = [
        ("cleaned", cleaning.cleaned_m2, claim.as_str()),
        ("assumed clean", cleaning.assumed_m2, say("no dirt was expected there; not cleaned in this run")),
        ("not claimed", cleaning.to_do_m2, say("nothing; the reasons stand below")),
    ];
    for (name, area_m2, claim) in rows {
        let area = language.number(area_m2, 1);
        let _ = write!(html, "<tr><td>{}<td class=num>{area} m²<td>{claim}</tr>", say(name));
    }
    let _ = write!(html, "</table><p>{}</p>", escaped(&rest(cleaning, language)));
    if !cleaning.not_claimed.is_empty() {
        let [because, cells] = ["not claimed, because", "cells"].map(say);
        let _ = write!(html, "<table class=proof><tr><th>{because}<th class=num>{cells}</tr>");
        for NotClaimed { reason, cells } in &cleaning.not_claimed {
            let reason = escaped(language.say(reason));
            let _ = write!(html, "<tr><td>{reason}<td class=num>{cells}</tr>");
        }
        html.push_str("</table>");
    }
    let [operator, customer, date] = ["operator", "customer", "date"].map(say);
    let _ = write!(html, "<div class=sign><div>{operator}</div><div>{customer}</div><div>{date}</div></div>");
    html
}
