//! `floorguard mission --report`: one page, nothing outside it, and numbers that add up.

use std::fmt::Write as _;
use std::process::Command;

use serde_json::Value;

#[test]
fn report_is_one_page_with_consistent_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    // Two spots, one of them on the sill of a wall where the brush cannot pass; one cell that is no spot.
    let mut dirt = String::from("x_m,y_m,units\n");
    for (x, y) in
        [(1.05, 1.05), (1.15, 1.05), (1.05, 1.15), (4.05, 3.05), (2.95, 0.02), (2.95, 0.06), (3.05, 0.06)]
    {
        let _infallible = writeln!(dirt, "{x},{y},20");
    }
    std::fs::write(path("dirt.csv"), dirt).unwrap();
    let zones = "[[zone]]\nname = \"west <1>\"\ncorners_m = [[0, 0], [3, 0], [3, 4], [0, 4]]\n\
                 [[zone]]\nname = \"east\"\ncorners_m = [[3, 0], [6, 0], [6, 4], [3, 4]]\n";
    std::fs::write(path("zones.toml"), zones).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_floorguard"))
        .args(["mission", "--map", "plain", "--dirt", &path("dirt.csv"), "--trials", "1", "--seed", "4"])
        .args(["--out", &path("out"), "--report", &path("report"), "--zones", &path("zones.toml")])
        .output()
        .unwrap();
    let stderr_text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{stderr_text}");
    let status: Value = serde_json::from_slice(&std::fs::read(path("report/status.json")).unwrap()).unwrap();
    let number = |value: &Value, key: &str| value[key].as_f64().unwrap();
    let total = &status["total"];
    let zones = status["zones"].as_array().unwrap();
    for key in
        ["floor_m2", "answered_m2", "swept_m2", "dirty_before_m2", "cleaned_m2", "dirty_unreachable_m2"]
    {
        let sum: f64 = zones.iter().map(|zone| number(zone, key)).sum();
        assert!((sum - number(total, key)).abs() < 1e-3, "{key}: {sum} of {total}");
    }
    let parts = ["cleaned_m2", "dirty_after_m2", "uncertain_m2", "dirty_unreachable_m2"];
    let sum: f64 = parts.iter().map(|part| number(total, part)).sum();
    assert!(sum >= number(total, "dirty_before_m2") - 1e-6, "{total}");
    assert!(number(total, "dirty_unreachable_m2") > 0.0, "{total}");
    assert!(status["sentence"].as_str().unwrap().starts_with("Not everything"), "{status}");
    let spots = status["spots"].as_array().unwrap();
    let share =
        |y_m: f64| &spots.iter().find(|spot| (number(spot, "y_m") - y_m).abs() < 0.2).unwrap()["clean_share"];
    assert_eq!((spots.len(), share(1.0), share(0.0)), (2, &Value::from(1.0), &Value::from(0.0)), "{status}");

    let page = std::fs::read_to_string(path("report/index.html")).unwrap();
    assert_eq!(page.matches("data:image/png;base64,").count(), 2);
    for outside in ["http:", "https:", "src=", "<script", "@import", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(page.contains("west &lt;1&gt;") && page.contains("width=device-width"));
    assert!(page.len() < 1_000_000);
}

/// The first evening sets the clock, the second shows how fast which place gets dirty, and then the robot knows.
#[test]
fn missions_teach_the_model_what_to_expect() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let mut dirt = String::from("x_m,y_m,units\n");
    for (column, row) in (0..14).flat_map(|column| (0..14).map(move |row| (column, row))) {
        let _infallible =
            writeln!(dirt, "{:.1},{:.1},8", 0.3 + 0.1 * f64::from(column), 0.3 + 0.1 * f64::from(row));
    }
    std::fs::write(path("dirt.csv"), dirt).unwrap();
    let mission = |strategy: &str, day: &str| {
        let now = format!("2026-04-{day}T22:00");
        let output = Command::new(env!("CARGO_BIN_EXE_floorguard"))
            .args(["mission", "--map", "plain", "--dirt", &path("dirt.csv"), "--strategy", strategy])
            .args(["--trials", "1", "--seed", day, "--json", "--out", &path("out")])
            .args(["--environment", &path("model"), "--now", &now])
            .output()
            .unwrap();
        let stderr_text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{stderr_text}");
        serde_json::from_slice::<Value>(&output.stdout).unwrap()
    };
    // Nobody knows anything: every cell counts as dirty.
    assert!(mission("systematic", "06")["dirty_cells"].as_u64().unwrap() > 2_000);
    mission("systematic", "07");
    let third = mission("guarantee", "08");
    let dirty = third["dirty_cells"].as_u64().unwrap();
    assert!((150..500).contains(&dirty), "the dirty corner and little else: {third}");
    assert!(third["falsely_claimed_cells"].as_u64().unwrap() <= 4, "{third}");
    let output = Command::new(env!("CARGO_BIN_EXE_floorguard"))
        .args(["ask", "dirt", "--model", &path("model"), "--now", "2026-04-09T22:00", "--json"])
        .output()
        .unwrap();
    let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(answer["details"]["zones"][0]["zone"], "A1", "{answer}");
    assert!(answer["details"]["zones"][0]["measured_places"].as_u64().unwrap() > 0);
}
