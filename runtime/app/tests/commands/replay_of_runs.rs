//! `floorguard replay` of runs that the program recorded: what was decided comes back to the bit.

use std::path::Path;

use floorguard_recording::{RUN_METADATA, RawStream, Recorder, Recording, Times, octets_of, topics};

use super::replay_command::{floorguard, replay, rows, text};

#[test]
fn a_recorded_run_gives_the_recorded_digest() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("run.mcap");
    let arguments =
        ["simulate", "--scenario", "crossing", "--seed", "3", "--duration", "6", "--json", "--record"];
    let simulated = floorguard(&[arguments.as_slice(), &[text(&file)]].concat());
    assert_eq!(simulated.status.code(), Some(0), "{simulated:?}");
    let digest = rows(&simulated)[0]["digest"].as_str().expect("a digest").to_owned();
    let (output, rows) = replay(&file);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let output_text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output_text.contains(&digest) && output_text.contains("as recorded"), "{output_text}");
    assert!(rows.len() > 50 && rows.iter().all(|row| row["digest"].is_string()));
    // Cut in the middle: what was complete is played, and the cut is reported.
    let bytes = std::fs::read(&file).expect("the recording");
    std::fs::write(&file, &bytes[..bytes.len() / 2]).expect("written");
    let (output, cut) = replay(&file);
    assert_eq!(output.status.code(), Some(3));
    assert_eq!(cut.as_slice(), &rows[..cut.len()]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("is cut"), "{output:?}");
}

/// Threads are not scheduled the same way twice, so the recording keeps their order: what was decided comes back to the bit,
/// and bytes that were exchanged are found.
#[test]
fn real_time_run_is_repeated_to_the_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let (file, other) = (folder.path().join("run.mcap"), folder.path().join("other.mcap"));
    let arguments =
        ["simulate", "--scenario", "crossing", "--seed", "3", "--duration", "6", "--real-io", "--record"];
    let stop = ["--emergency-stop", "4..5"];
    let simulated = floorguard(&[arguments.as_slice(), &[text(&file)], &stop].concat());
    assert!(matches!(simulated.status.code(), Some(0 | 1)), "{simulated:?}");
    let checked = floorguard(&["replay", "--check", text(&file)]);
    let stderr = String::from_utf8_lossy(&checked.stderr).into_owned();
    assert_eq!(checked.status.code(), Some(0), "{stderr}");
    assert!(stderr.contains("as recorded, to the bit") && stderr.contains("torque off"), "{stderr}");
    // The same run with other frames on the bus: encoders, drive and safety image are all zeros.
    exchange(&file, &other, |message| {
        let inputs = message.topic.as_ref() == RawStream::CanReceived.topic();
        inputs && octets_of(&message.data).is_some_and(|bytes| bytes[1] == 1 && bytes.len() > 4)
    });
    let found = floorguard(&["replay", "--check", text(&other)]);
    let stderr = String::from_utf8_lossy(&found.stderr).into_owned();
    assert_eq!(found.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("first difference") && stderr.contains("today:"), "{stderr}");
}

/// Copies a recording; the bytes of some messages become zeros behind the identifier.
fn exchange(from: &Path, to: &Path, chosen: impl Fn(&floorguard_recording::Recorded) -> bool) {
    let mut recording = Recording::new(std::fs::File::open(from).expect("the recording"));
    let messages: Vec<_> = recording.by_ref().map(|message| message.expect("whole")).collect();
    let mut recorder = Recorder::new(std::fs::File::create(to).expect("a file")).expect("written");
    let texts = recording.metadata(RUN_METADATA).expect("about the run").clone();
    recorder.metadata(RUN_METADATA, texts).expect("written");
    for message in messages {
        let Some(bytes) = octets_of(&message.data) else { continue };
        let times = Times { logged: message.at, published: message.published };
        let mut bytes = bytes.to_vec();
        if chosen(&message) {
            bytes.iter_mut().skip(2).for_each(|byte| *byte = 0);
        }
        match RawStream::of_topic(&message.topic) {
            Some(stream) => recorder.raw(stream, times, &bytes).expect("written"),
            None if &*message.topic == topics::ORDER => recorder.order(message.at, &bytes).expect("written"),
            None => {}
        }
    }
    recorder.finish().expect("closed");
}

/// A recording from before robots waited for a start command, and before one channel of the emergency stop was too few: it is
/// played, and the replay says why the robot stands, and why it would not run today.
#[test]
fn old_recordings_are_played_with_notes() {
    let folder = tempfile::tempdir().expect("a folder");
    let (file, old) = (folder.path().join("run.mcap"), folder.path().join("old.mcap"));
    let arguments =
        ["simulate", "--scenario", "crossing", "--duration", "4", "--json", "--record", text(&file)];
    assert!(floorguard(&arguments).status.success());
    let mut recording = Recording::new(std::fs::File::open(&file).expect("the recording"));
    let messages: Vec<_> = recording.by_ref().map(|message| message.expect("whole")).collect();
    let mut recorder = Recorder::new(std::fs::File::create(&old).expect("a file")).expect("written");
    let mut texts = recording.metadata(RUN_METADATA).expect("about the run").clone();
    // Then one channel was enough, too.
    let robot = texts.get_mut("robot.toml").expect("the robot");
    *robot = robot.replace("emergency_stop_bits = [32, 33]", "emergency_stop_bits = [32]");
    recorder.metadata(RUN_METADATA, texts).expect("written");
    for message in messages {
        let stream = RawStream::of_topic(&message.topic).filter(|stream| *stream != RawStream::Operator);
        if let (Some(stream), Some(bytes)) = (stream, octets_of(&message.data)) {
            let times = Times { logged: message.at, published: message.published };
            recorder.raw(stream, times, bytes).expect("written");
        }
    }
    recorder.finish().expect("closed");
    let says =
        |path: &Path| String::from_utf8_lossy(&floorguard(&["replay", text(path)]).stderr).into_owned();
    for words in ["holds no start command", "note: `run` refuses this robot", "one channel"] {
        assert!(says(&old).contains(words), "{words}: {}", says(&old));
        assert!(!says(&file).contains(words), "{words}");
    }
    let explained = floorguard(&["explain", text(&old), "--at", "2"]);
    let notes = String::from_utf8_lossy(&explained.stderr).into_owned();
    assert!(explained.status.success() && notes.contains("one channel"), "{notes}");
}
