//! Learning on the robot: whether it corrects its classifier of people, where that is kept, and how often it may change.

use std::path::PathBuf;

use super::reader::Reader;

/// What learned corrections are kept in without a word about it.
const MODEL: &str = "people.learned";
/// Shortest and longest time from one judgement to the next, seconds: below, the samples are always the same.
const UPDATE_S: (f32, f32) = (5.0, 3_600.0);

/// How the robot learns what people look like. Paths are relative to the folder of the file that names them.
#[derive(Clone, Debug, PartialEq)]
pub struct LearningConfiguration {
    /// Without it, the section is only checked.
    pub enabled: bool,
    /// Where the learned correction is kept.
    pub model: PathBuf,
    /// From one judgement of what was learned to the next, at least, microseconds.
    pub update_us: u64,
}

pub(super) fn read_learning(section: Reader<'_>) -> Option<LearningConfiguration> {
    let enabled = section.flag_or("enabled", true);
    let model = section.text_or_absent("model", MODEL, MODEL);
    let model = match model {
        Some(("", span)) => {
            section.refuse(
                &span,
                "[learning]: `model` is empty",
                "write the name of a file, such as \"people.learned\"",
            );
            None
        }
        Some((text, _)) => Some(PathBuf::from(text)),
        None => Some(PathBuf::from(MODEL)),
    };
    let (shortest_s, longest_s) = UPDATE_S;
    let update_s = section.number_or("update_s", shortest_s..=longest_s, 30.0);
    section.finish();
    Some(LearningConfiguration { enabled, model: model?, update_us: (update_s * 1.0e6) as u64 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EXAMPLE, parse};

    fn read(section: &str) -> Result<Option<LearningConfiguration>, String> {
        let parsed = parse("robot.toml", &format!("{EXAMPLE}\n{section}"));
        parsed.map(|configuration| configuration.learning).map_err(|refused| refused.to_string())
    }

    #[test]
    fn robot_learns_only_when_configured() {
        assert_eq!(read(""), Ok(None));
        let default = read("[learning]").unwrap().unwrap();
        assert_eq!(
            default,
            LearningConfiguration { enabled: true, model: MODEL.into(), update_us: 30_000_000 }
        );
        let off = read("[learning]\nenabled = false\nmodel = \"a/b\"\nupdate_s = 5").unwrap().unwrap();
        assert_eq!(off, LearningConfiguration { enabled: false, model: "a/b".into(), update_us: 5_000_000 });
        for (wrong, reported) in [
            ("update_s = 1.0", "update_s"),
            ("update_s = 7200", "update_s"),
            ("update_ms = 30", "wrong unit"),
            ("model = \"\"", "is empty"),
            ("model = 3", "a text in quotes"),
            ("enabled = 1", "true or false"),
            ("modle = \"x\"", "did you mean `model`"),
        ] {
            let refused = read(&format!("[learning]\n{wrong}")).unwrap_err();
            assert!(refused.contains(reported), "{wrong}: {refused}");
        }
    }
}
