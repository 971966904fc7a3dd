//! The same worlds driven with each lidar and each scanner: the judge of contacts, which knows nothing of sensors, says the same.

use floorguard_configuration::{bridged_keys, ouster_example, ouster_keys};
use floorguard_drivers::ouster::{Beams, DataFormat};
use floorguard_laboratory::plan::Plan;
use floorguard_laboratory::world::{Observer, load_scenario, run_virtual};
use floorguard_runtime::configuration::{RangingModel, RangingScanner, ScannerModel};

/// How far the robot came, metres, and its contacts while it moved.
fn drive(world: &str, duration_s: u64, fit: impl Fn(Plan) -> Plan) -> (f64, u32) {
    let path = format!("{}/../hal-sim/scenarios/hazards/{world}.toml", env!("CARGO_MANIFEST_DIR"));
    let scenario = load_scenario(path.as_ref()).unwrap();
    let mut plan = fit(Plan::of(world, scenario, 1, duration_s * 1_000_000).unwrap());
    plan.lidar_grain = 4;
    let mut show = |_: f64, _: &_, _: usize, _: &[_]| {};
    let mut observer = Observer::new(&plan, &mut show);
    run_virtual(&plan, &mut observer).unwrap();
    let verdict = observer.into_observation().verdict;
    (f64::from(verdict.distance_m), verdict.bodies.counts.while_moving() as u32)
}

/// A board at 0.7 m, which the lidar alone sees in time.
#[test]
fn every_lidar_stops_before_the_board() {
    let os2 = Beams { format: DataFormat::Legacy, ..Beams::even(64, (11_250, -11_250)) };
    let lidars = [
        ("PandarXT-16", "model = \"pandar-xt16\"".to_owned()),
        ("PandarXT-32", "model = \"pandar-xt32\"".to_owned()),
        ("Ouster OS1-32", ouster_keys(&ouster_example())),
        ("Ouster OS2-64", ouster_keys(&os2)),
        ("bridged", bridged_keys()),
    ];
    let (reference_m, contacts) = drive("board-70", 9, |plan| plan);
    assert!(reference_m > 2.0 && contacts == 0, "VLP-16: {reference_m} m, {contacts} contacts");
    for (name, keys) in lidars {
        let (distance_m, contacts) = drive("board-70", 9, |plan| plan.with_lidar(&keys).unwrap());
        assert!(contacts == 0, "{name}: {contacts} contacts");
        assert!((distance_m - reference_m).abs() < 0.4, "{name}: {distance_m} m, a VLP-16 {reference_m} m");
    }
}

/// A box of 30 cm, which the scanner sees.
#[test]
fn every_scanner_stops_before_the_box() {
    let (reference_m, contacts) = drive("box-30", 10, |plan| plan);
    assert!(reference_m > 1.0 && contacts == 0, "S300: {reference_m} m, {contacts} contacts");
    let ranging = [
        RangingModel::HokuyoUst,
        RangingModel::HokuyoUrg04lx,
        RangingModel::SickTim5xx,
        RangingModel::SickLms1xx,
    ];
    let fine = ScannerModel::MicroScan3 { beams: 2_751 };
    let ranging = ranging.map(|model| ScannerModel::Ranging(RangingScanner { model, no_return_mm: 4_000 }));
    for model in [fine].into_iter().chain(ranging) {
        // The slow ones have as much longer to come there.
        let duration_s = if model == fine { 10 } else { 18 };
        let (distance_m, contacts) = drive("box-30", duration_s, |plan| plan.with_scanner(model).unwrap());
        assert!(contacts == 0, "{model:?}: {contacts} contacts");
        assert!(
            distance_m > 1.0 && distance_m < reference_m + 0.3,
            "{model:?}: {distance_m} m, an S300 {reference_m} m"
        );
    }
}
