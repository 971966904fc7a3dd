//! The panel's page without a browser: small, from nowhere else, readable in both themes, with a name for everything that one
//! can press. What it looks like, tests with a browser see where one is installed.

use std::collections::BTreeMap;

use super::page::page;

/// Variables of a theme, by name: the light one, or what the dark one changes of it.
fn theme(dark: bool) -> BTreeMap<String, [f64; 3]> {
    let page = page();
    let blocks: Vec<&str> = page.match_indices(":root{").map(|(at, _)| &page[at + 6..]).collect();
    let mut found = BTreeMap::new();
    for block in &blocks[..if dark { 2 } else { 1 }] {
        let block = block.split('}').next().expect("an end");
        for (name, value) in block.split(';').filter_map(|line| line.trim().split_once(':')) {
            found.insert(name.trim_start_matches("--").to_owned(), colour(value.trim()));
        }
    }
    found
}

/// `#abc` or `#aabbcc`, 0…1.
fn colour(text: &str) -> [f64; 3] {
    let digits = text.trim_start_matches('#');
    let step = digits.len() / 3;
    [0, 1, 2].map(|index| {
        let part = &digits[index * step..(index + 1) * step];
        let value = u32::from_str_radix(part, 16).expect("a colour");
        f64::from(if step == 1 { value * 17 } else { value }) / 255.0
    })
}

/// Contrast ratio (WCAG 2.2, definitions of relative luminance and contrast ratio).
fn contrast(a: [f64; 3], b: [f64; 3]) -> f64 {
    let luminance = |colour: [f64; 3]| {
        let linear = colour
            .map(|part| if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) });
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    };
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

#[test]
fn words_can_be_read_in_both_themes() {
    let pairs = [
        ("ink", "paper"),
        ("faint", "paper"),
        ("ink", "tile"),
        ("ink", "warn"),
        ("ink", "alarm"),
        ("slow", "paper"),
        ("holder", "paper"),
        ("chip-ink", "idle"),
        ("chip-ink", "good"),
        ("chip-ink", "slow"),
        ("chip-ink", "stop"),
        ("button-ink", "button"),
        ("disabled-ink", "disabled"),
    ];
    for dark in [false, true] {
        let theme = theme(dark);
        for (text, ground) in pairs {
            let ratio = contrast(theme[text], theme[ground]);
            assert!(ratio >= 4.5, "{text} on {ground}, dark {dark}: {ratio:.2}");
        }
    }
}

#[test]
fn page_is_small_and_needs_nothing_else() {
    assert!(page().len() <= 300_000, "{}", page().len());
    assert!(!page().contains("://") && !page().contains("<link") && !page().contains(" src="));
}

#[test]
fn everything_has_a_name_for_screen_readers() {
    for button in page().split("<button").skip(1) {
        let (attributes, rest) = button.split_once('>').expect("an end");
        let words = rest.split('<').next().unwrap_or_default().trim();
        assert!(words.len() > 1 || attributes.contains("data-label="), "{attributes}");
    }
    for part in [
        "<html lang=",
        "<h1",
        "<main",
        "aria-live=\"polite\"",
        "role=\"alert\"",
        "tabindex=\"0\" data-label=",
    ] {
        assert!(page().contains(part), "{part}");
    }
}

/// What the script takes out of the page by name is there.
#[test]
fn script_finds_its_elements() {
    for name in page().split("$(\"").skip(1).filter_map(|rest| rest.split('"').next()) {
        let is_there = page().contains(&format!("id=\"{name}\"")) || name == "m2";
        assert!(is_there, "{name}");
    }
}
