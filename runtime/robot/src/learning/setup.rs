//! What learning begins with: the section of robot.toml and the file it names, or what a recording says.

use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use floorguard_perception::online_learning::{LabelledShape, Weights};

use super::anchors::{anchors_fingerprint, shipped_anchors};
use super::learning_slot::{LearningSlot, LearningWriter};
use super::live::PeopleLearner;
use super::weights_file::{decode_weights, encode_weights, load_weights};
use floorguard_configuration::LearningConfiguration;

/// A robot that learns, before it is switched on.
#[derive(Clone, Debug)]
pub struct LearningSetup {
    anchors: Vec<LabelledShape>,
    fingerprint: u32,
    start: Weights,
    update_us: u64,
    path: Option<PathBuf>,
    /// Where the ring lays down what it has learned.
    pub slot: LearningSlot,
}

impl LearningSetup {
    /// By a section of robot.toml; `None` if it is switched off. `folder` is that of the file. A model that cannot be
    /// used is reported through `say`, and the robot begins with the shipped classifier.
    ///
    /// # Errors
    /// The folder of the model is not there: nothing could ever be kept.
    pub fn open(
        configuration: &LearningConfiguration,
        folder: &Path,
        say: &mut dyn FnMut(&str),
    ) -> anyhow::Result<Option<Self>> {
        if !configuration.enabled {
            return Ok(None);
        }
        let path = folder.join(&configuration.model);
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        ensure!(
            parent.is_dir(),
            "[learning]: model = {:?}: the folder {} is not there; make it, or name another file",
            configuration.model,
            parent.display()
        );
        ensure!(
            !path.is_dir(),
            "[learning]: model = {:?}: this is a folder; name a file",
            configuration.model
        );
        let mut setup = Self::from_nothing(configuration.update_us);
        match load_weights(&path, setup.fingerprint) {
            Ok(Some(kept)) => {
                kept.passed_over.iter().for_each(|what| say(&format!("learning: passed over {what}")));
                setup.start = kept.weights;
                if setup.learner().is_resumed() {
                    say(&format!("learning: goes on with {}, update {}", path.display(), kept.generation));
                } else {
                    setup.start = Weights::ZERO;
                    say(&format!(
                        "learning: {} does worse on the anchors than the shipped classifier; the shipped one is used",
                        path.display()
                    ));
                }
            }
            Ok(None) => say(&format!(
                "learning: begins with the shipped classifier; what is learned goes into {}",
                path.display()
            )),
            Err(error) => say(&format!(
                "learning: {error:#}; the shipped classifier is used, and the file is replaced with the first update that is taken over"
            )),
        }
        setup.path = Some(path);
        Ok(Some(setup))
    }

    /// With the shipped classifier; nothing is kept.
    #[must_use]
    pub fn from_nothing(update_us: u64) -> Self {
        Self::beside(shipped_anchors(), Weights::ZERO, update_us)
    }

    /// Beside other anchors, with weights that must do no worse on them; nothing is kept.
    #[must_use]
    pub fn beside(anchors: Vec<LabelledShape>, start: Weights, update_us: u64) -> Self {
        let fingerprint = anchors_fingerprint(&anchors);
        Self { anchors, fingerprint, start, update_us, path: None, slot: LearningSlot::default() }
    }

    /// As a recording tells of its start; nothing is kept.
    ///
    /// # Errors
    /// The text is damaged, or another version of the program wrote it.
    pub fn of_recording(update_us: u64, text: &str) -> anyhow::Result<Self> {
        let mut setup = Self::from_nothing(update_us);
        let digits = text.as_bytes().as_chunks::<2>().0;
        let bytes: Option<Vec<u8>> = digits
            .iter()
            .map(|pair| std::str::from_utf8(pair).ok().and_then(|pair| u8::from_str_radix(pair, 16).ok()))
            .collect();
        let bytes = bytes.context("what it had learned before is no list of bytes")?;
        setup.start = decode_weights(&bytes, setup.fingerprint)?.1;
        Ok(setup)
    }

    /// The start, for a recording.
    #[must_use]
    pub fn to_text(&self) -> String {
        let bytes = encode_weights(0, &self.start, self.fingerprint);
        bytes.iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"))
    }

    /// The same robot after its computer was switched off and on again: with what was kept.
    #[must_use]
    pub fn again(&self) -> Self {
        let start = self.slot.newest().map_or(self.start, |(_, weights)| weights);
        Self { start, ..self.clone() }
    }

    /// Begins.
    #[must_use]
    pub fn learner(&self) -> PeopleLearner {
        PeopleLearner::new(&self.anchors, &self.start, (self.update_us, self.slot.clone()))
    }

    /// The writer of accepted updates.
    #[must_use]
    pub fn writer(&self) -> LearningWriter {
        LearningWriter::new(self.slot.clone(), self.path.clone(), (self.fingerprint, self.start))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learning::{LearningReport, save_weights};

    const UPDATE_US: u64 = 5_000_000;

    fn open(folder: &Path) -> (Option<LearningSetup>, String) {
        let model = PathBuf::from("people.learned");
        let configuration = LearningConfiguration { enabled: true, model, update_us: UPDATE_US };
        let mut message = String::new();
        let setup = LearningSetup::open(&configuration, folder, &mut |what| message += what).unwrap();
        (setup, message)
    }

    /// A correction that the anchors permit.
    fn small() -> Weights {
        Weights { offset: 0.05, steps: 2_000, ..Weights::ZERO }
    }

    #[test]
    fn saved_learning_resumes_bad_file_uses_shipped() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("people.learned");
        let (new, message) = open(folder.path());
        let new = new.expect("it is enabled");
        assert!(
            message.contains("begins with the shipped classifier") && !new.learner().is_resumed(),
            "{message}"
        );
        // An update is taken over: the keeper writes it once.
        let mut writer = new.writer();
        assert_eq!(writer.attend(), None);
        new.slot.put(LearningReport::default(), &Weights::ZERO);
        assert_eq!(writer.attend(), None);
        assert!(!path.exists());
        new.slot.put(LearningReport { accepted: 1, ..LearningReport::default() }, &small());
        let update = writer.attend().expect("something was taken over");
        assert!(update.contains("1 update taken over"), "{update}");
        assert_eq!(writer.attend(), None);
        let (again, message) = open(folder.path());
        assert!(message.contains("goes on with") && message.contains("update 1"), "{message}");
        assert!(again.is_some_and(|setup| setup.start == small() && setup.learner().is_resumed()));
        // Whatever the file may be, the robot starts, says why, and is the shipped one.
        let whole = std::fs::read(&path).unwrap();
        let mut damaged = whole.clone();
        damaged[40] ^= 1;
        let wrong = |bytes: &[u8], expected: &str| {
            std::fs::write(&path, bytes).unwrap();
            let (setup, message) = open(folder.path());
            assert!(message.contains(expected) && message.contains("shipped"), "{message}");
            assert!(setup.is_some_and(|setup| setup.start == Weights::ZERO));
        };
        wrong(&whole[..100], "cut short or damaged");
        wrong(&damaged, "cut short or damaged");
        wrong(b"", "ends too early");
        wrong(b"PNG and so on, longer than a header", "nothing learned by floorguard");
        // Sound numbers that forget people.
        let forgets = Weights { offset: -4.0, ..Weights::ZERO };
        save_weights(&path, &forgets, new.fingerprint).unwrap();
        let (setup, message) = open(folder.path());
        assert!(message.contains("does worse on the anchors"), "{message}");
        assert!(setup.is_some_and(|setup| setup.start == Weights::ZERO));
    }

    #[test]
    fn missing_folder_refused_failing_disk_reported_once() {
        let folder = tempfile::tempdir().unwrap();
        let of = |model: &str, enabled| {
            let configuration = LearningConfiguration { enabled, model: model.into(), update_us: UPDATE_US };
            LearningSetup::open(&configuration, folder.path(), &mut |_| {})
        };
        let refused = of("nowhere/people.learned", true).unwrap_err().to_string();
        assert!(refused.contains("nowhere") && refused.contains("make it"), "{refused}");
        assert!(of(".", true).unwrap_err().to_string().contains("name a file"));
        assert!(of("nowhere/people.learned", false).unwrap().is_none());
        let inner = folder.path().join("inner");
        std::fs::create_dir(&inner).unwrap();
        let setup = of("inner/people.learned", true).unwrap().unwrap();
        let mut writer = setup.writer();
        std::fs::remove_dir(&inner).unwrap();
        setup.slot.put(LearningReport::default(), &small());
        assert!(writer.attend().is_some_and(|message| message.contains("cannot be kept")));
        setup.slot.put(LearningReport::default(), &Weights { steps: 4_000, ..small() });
        assert_eq!(writer.attend(), None);
        // There is space again, and then there is none again: that is a new fault.
        std::fs::create_dir(&inner).unwrap();
        setup.slot.put(LearningReport::default(), &Weights { steps: 6_000, ..small() });
        assert!(writer.attend().is_some_and(|message| message.contains("taken over")));
        std::fs::remove_dir_all(&inner).unwrap();
        setup.slot.put(LearningReport::default(), &Weights { steps: 8_000, ..small() });
        assert!(writer.attend().is_some_and(|message| message.contains("cannot be kept")));
    }

    #[test]
    fn the_start_travels_in_a_recording() {
        let setup = LearningSetup { start: small(), ..LearningSetup::from_nothing(UPDATE_US) };
        let text = setup.to_text();
        assert_eq!(LearningSetup::of_recording(UPDATE_US, &text).unwrap().start, small());
        assert!(LearningSetup::of_recording(UPDATE_US, &text[2..]).is_err());
        assert!(LearningSetup::of_recording(UPDATE_US, "zz").is_err());
    }
}
