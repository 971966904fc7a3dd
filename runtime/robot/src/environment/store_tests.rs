//! The power goes at every byte of a save, and every byte of a file is damaged.

use super::*;
use crate::environment::{Calendar, Zone, teach_recording};
use crate::environment::{Recording, TrackPoint};
use floorguard_mapping::environment::WallTime;
use floorguard_types::geometry::Point2;
use std::fs;

/// A Monday, 00:00 UTC.
const MONDAY_S: i64 = 1_775_433_600;

/// People who cross a small room, `hours` of it, two a minute.
fn model(hours: i64) -> Model {
    let corners = (Point2::new(0.1, 0.1), Point2::new(3.9, 1.9));
    let mut model = Model::over("room", Calendar::named("+01:00").unwrap(), corners).unwrap();
    model.zones.push(Zone::parse("door=0,0,2,2", &[]).unwrap());
    let mut recording = Recording::default();
    for tenth in 0..hours * 36_000 {
        let (person, step) = (tenth / 300, tenth % 300);
        if step < 50 {
            let position = Point2::new(0.1 + step as f32 * 0.07, 1.0 + (person % 3) as f32 * 0.3);
            recording
                .moments
                .entry(tenth * 100_000)
                .or_default()
                .push(TrackPoint { id: person as u64, position });
        }
    }
    teach_recording(&mut model, &recording, WallTime::from_seconds(MONDAY_S + 12 * 3_600)).unwrap();
    model
}

/// The content alone: generations differ.
fn content(model: &Model) -> Vec<u8> {
    encode(model).unwrap()[26..].to_vec()
}

#[test]
fn a_model_survives_the_file_unchanged() {
    let before = model(3);
    let bytes = encode(&before).unwrap();
    let after = decode(&bytes).unwrap();
    assert_eq!(encode(&after).unwrap(), bytes);
    assert_eq!((after.name.as_str(), after.calendar.name(), after.zones.len()), ("room", "+01:00", 1));
    let place = |model: &Model| *model.core.places.grid().values().iter().max_by_key(|p| p.stays.0).unwrap();
    assert_eq!(place(&before), place(&after));
    assert!(place(&after).week.total().visits > 100.0);
    assert_eq!(before.core.newest(), after.core.newest());
}

#[test]
fn cut_loses_at_most_the_newest_update() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m");
    let (new, old) = (beside(&path, ".new"), beside(&path, ".old"));
    let (mut first, mut second) = (model(1), model(2));
    save(&path, &mut first).unwrap();
    let first_bytes = fs::read(&path).unwrap();
    save(&path, &mut second).unwrap();
    let second_bytes = fs::read(&path).unwrap();
    assert_eq!(fs::read(&old).unwrap(), first_bytes);
    let generation = || load(&path).unwrap().unwrap().model.generation;
    assert_eq!(generation(), 2);
    for cut in 0..=second_bytes.len() {
        let torn = &second_bytes[..cut];
        let whole = if cut == second_bytes.len() { 2 } else { 1 };
        // While it is written beside the file.
        fs::write(&path, &first_bytes).unwrap();
        fs::write(&new, torn).unwrap();
        let _absent = fs::remove_file(&old);
        assert_eq!(generation(), whole, "written up to byte {cut}");
        // Between the two renamings, with a disk that lied about having written.
        fs::rename(&path, &old).unwrap();
        assert_eq!(generation(), whole, "put aside, cut at byte {cut}");
        // In place, with the same disk.
        fs::rename(&new, &path).unwrap();
        assert_eq!(generation(), whole, "in place, cut at byte {cut}");
    }
    assert_eq!(content(&load(&path).unwrap().unwrap().model), content(&second));
    // The next save goes on from what was found.
    fs::write(&path, &second_bytes[..100]).unwrap();
    let mut found = load(&path).unwrap().unwrap();
    assert_eq!((found.model.generation, found.passed_over.len()), (1, 1));
    save(&path, &mut found.model).unwrap();
    assert_eq!(generation(), 2);
}

#[test]
fn damage_at_any_byte_is_found() {
    let bytes = encode(&model(1)).unwrap();
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        assert!(decode(&damaged).is_err(), "byte {at}");
    }
    for cut in 0..bytes.len() {
        assert!(decode(&bytes[..cut]).is_err(), "cut at {cut}");
    }
}

#[test]
fn status_names_faults_and_absent_is_not_lost() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m");
    assert!(load(&path).unwrap().is_none());
    fs::write(&path, b"hello").unwrap();
    let error = load(&path).err().unwrap().to_string();
    assert!(error.contains("no environment model"), "{error}");
    let mut newer = encode(&model(1)).unwrap();
    newer[8] = 9;
    fs::write(&path, newer).unwrap();
    let error = load(&path).err().unwrap().to_string();
    assert!(error.contains("version 9"), "{error}");
    let nowhere = folder.path().join("no/such/folder/m");
    assert!(save(&nowhere, &mut model(1)).is_err());
}
