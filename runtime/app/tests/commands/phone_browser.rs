//! Both reports and the panel on a phone, laid out by a real browser: nothing is wider than the screen.

use std::path::Path;
use std::process::Command;

use crate::seen_support::browser;

/// Width of a phone, CSS pixels.
const PHONE_PX: u32 = 390;

fn floorguard(arguments: &[&str]) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_floorguard")).args(arguments).output().expect("the program starts");
    assert!(output.status.success(), "{output:?}");
}

/// How wide a page becomes in a frame of a phone's width. The page runs inside of another one, because a browser's window
/// cannot be made that narrow.
fn width_px(browser: &str, folder: &Path, page: &str) -> u32 {
    let tell = "<script>addEventListener('load',()=>{parent.document.title=document.documentElement.scrollWidth})</script>";
    let inner = format!("{page}{tell}").replace('&', "&amp;").replace('"', "&quot;");
    let outer = folder.join("phone.html");
    let frame = format!(
        "<!doctype html><title>?</title><iframe width={PHONE_PX} height=844 srcdoc=\"{inner}\"></iframe>"
    );
    std::fs::write(&outer, frame).expect("written");
    // Beside other tests a browser can be asked before it has laid out the page.
    let widths = (0..5).map(|_| laid_out(browser, folder, &outer));
    widths.flatten().next().expect("a width")
}

/// What the page of a phone says of its width.
fn laid_out(browser: &str, folder: &Path, outer: &Path) -> Option<u32> {
    let output = Command::new(browser)
        .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--dump-dom", "--timeout=3000"])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg(format!("file://{}", outer.display()))
        .output()
        .expect("the browser starts");
    let output_text = String::from_utf8_lossy(&output.stdout).into_owned();
    let title = output_text.split_once("<title>").and_then(|(_, rest)| rest.split_once("</title>"));
    let width = title.and_then(|(title, _)| title.parse().ok());
    if width.is_none() {
        println!("no width: {}", output_text.chars().take(300).collect::<String>());
    }
    width
}

#[test]
fn no_page_is_wider_than_a_phone() {
    let Some(browser) = browser() else {
        println!("skipped: no Chromium is installed");
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (recording, report) = (path("run.mcap"), path("report"));
    let run =
        ["simulate", "--scenario", "supermarket", "--strategy", "guarantee", "--duration", "16", "--json"];
    floorguard(
        &[run.as_slice(), &["--emergency-stop", "8..9", "--record", &recording, "--report", &report]]
            .concat(),
    );
    floorguard(&["report", &recording, "--out", &path("run.html")]);
    let panel = floorguard_operator::panel::page();
    let titled =
        panel.replace(">floorguard</h1>", ">a supermarket with customers in the aisles and more words</h1>");
    let read = |name: &str| std::fs::read_to_string(path(name)).expect("a page");
    for (name, page) in
        [("report/index.html", read("report/index.html")), ("run.html", read("run.html")), ("panel", titled)]
    {
        let width = width_px(browser, folder.path(), &page);
        assert!(width <= PHONE_PX, "{name}: {width} of {PHONE_PX} pixels");
    }
}
