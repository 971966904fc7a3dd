//! Configurations with one mistake each: every one is refused with file, line, limit and remedy.
//!
//! Each case replaces one line of the example; the golden is the whole message, so that a change of wording or place
//! shows in review.

use floorguard_configuration::{EXAMPLE, parse};

struct Mistake {
    /// The text to replace, which must occur in the example exactly once or is replaced at its first occurrence.
    good: &'static str,
    bad: &'static str,
    /// `LINE:COLUMN: message`, the whole of it.
    refusal: &'static str,
}

const fn mistake(good: &'static str, bad: &'static str, refusal: &'static str) -> Mistake {
    Mistake { good, bad, refusal }
}

const MISTAKES: [Mistake; 43] = include!("config_mistakes.in");

fn refusal_of(mistake: &Mistake) -> String {
    assert!(EXAMPLE.contains(mistake.good), "the example has no `{}` any more", mistake.good);
    let text = EXAMPLE.replacen(mistake.good, mistake.bad, 1);
    match parse("robot.toml", &text) {
        Ok(_) => format!("accepted although `{}`", mistake.bad),
        Err(refused) => refused.to_string(),
    }
}

#[test]
fn single_mistakes_name_line_limit_and_remedy() {
    let mut differences = Vec::new();
    for mistake in &MISTAKES {
        let refusal = refusal_of(mistake);
        let expected = format!("robot.toml:{}", mistake.refusal);
        if refusal != expected {
            differences.push(format!("bad: {}\nis:     {refusal}\nshould: {expected}", mistake.bad));
        }
    }
    assert!(differences.is_empty(), "{}", differences.join("\n\n"));
}

#[test]
fn two_mistakes_give_two_lines() {
    let text =
        EXAMPLE.replacen("track_m = 0.60", "track_m = 600.0", 1).replacen("wheelbase_m", "wheelbse_m", 1);
    let refused = parse("robot.toml", &text).expect_err("two mistakes");
    // The misspelt key counts twice: one key is unknown and one is missing.
    assert_eq!(refused.count(), 3, "{refused}");
}
