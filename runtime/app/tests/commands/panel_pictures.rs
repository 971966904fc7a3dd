//! The panel's page with fixed answers in place of the robot's program, in a real browser without a screen: compared with kept
//! pictures at three widths, light and dark, and read in five languages for text that does not fit.
//!
//! Pictures are compared after each 12 × 12 pixels have become one grey value: the mean difference may be 1.5 of 255, and 1 % of
//! the values may differ by more than 32. `FLOORGUARD_REFRESH=1` keeps the pictures of today's page in place of those before. They
//! hold for the typeface that this computer shows; where it is another, only the texts are compared.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::seen_support::browser;
use image::{GrayImage, imageops};

/// The typeface of the kept pictures.
const TYPEFACE: &str = "DejaVu Sans";
/// Widths of a phone, a tablet and a desk, CSS pixels.
const WIDTHS: [u32; 3] = [390, 768, 1_280];
/// Height of each picture, CSS pixels.
const HEIGHT: u32 = 1_200;
/// This many pixels in a row become one.
const BLOCK: u32 = 12;
const MEAN_MAX: f64 = 1.5;
const FAR: u8 = 32;
const FAR_SHARE_MAX: f64 = 0.01;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/panel")
}

/// The page, answered by a file, beside a page that holds it in frames.
fn write_pages(root: &Path, frames: &str) -> String {
    let read = |name: &str| std::fs::read_to_string(folder().join(name)).expect("a file of the test");
    let stub = read("stub.js").replace("/*answers*/", &read("answers.json"));
    let page = floorguard_operator::panel::page().replacen(
        "<script>",
        &format!("<script>{stub}</script>\n<script>"),
        1,
    );
    std::fs::write(root.join("page.html"), page).expect("written");
    let collect = "const all={};addEventListener('message',e=>{all[e.data.name]=e.data.out;document.getElementById('found')\
                   .textContent=JSON.stringify(all)})";
    let harness = format!(
        "<!doctype html><meta charset=utf-8><style>body{{margin:0;font-size:0}}iframe{{border:0;height:{HEIGHT}px}}</style>\
         <script>{collect}</script>{frames}<pre id=found hidden></pre>"
    );
    let path = root.join("all.html");
    std::fs::write(&path, harness).expect("written");
    format!("file://{}", path.display())
}

fn open(browser: &str, root: &Path, arguments: &[&str]) -> Vec<u8> {
    let profile = format!("--user-data-dir={}", root.join("profile").display());
    let fixed = [
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--hide-scrollbars",
        "--allow-file-access-from-files",
    ];
    let time = "--virtual-time-budget=4000";
    let output =
        Command::new(browser).args(fixed).args([time, &profile]).args(arguments).env("TZ", "UTC").output();
    output.expect("the browser starts").stdout
}

fn frame(width: u32, query: &str, theme: &str) -> String {
    format!("<iframe style='width:{width}px;color-scheme:{theme}' src='page.html?{query}'></iframe>")
}

/// Rows for light and dark, columns for the widths.
fn picture(browser: &str) -> GrayImage {
    let root = tempfile::tempdir().expect("a folder");
    let mut frames = String::new();
    for theme in ["light", "dark"] {
        let _ = write!(frames, "<div style='width:{}px'>", WIDTHS.iter().sum::<u32>());
        WIDTHS.iter().for_each(|width| frames.push_str(&frame(*width, &format!("theme={theme}"), theme)));
        frames.push_str("</div>");
    }
    let address = write_pages(root.path(), &frames);
    let file = root.path().join("all.png");
    let size = format!("--window-size={},{}", WIDTHS.iter().sum::<u32>(), 2 * HEIGHT);
    open(browser, root.path(), &[&size, &format!("--screenshot={}", file.display()), &address]);
    let picture = image::open(&file).expect("a picture").to_luma8();
    imageops::thumbnail(&picture, picture.width() / BLOCK, picture.height() / BLOCK)
}

/// Mean difference, and the share of values that are far apart.
fn difference(a: &GrayImage, b: &GrayImage) -> [f64; 2] {
    assert_eq!(a.dimensions(), b.dimensions());
    let apart: Vec<u8> = a.iter().zip(b.iter()).map(|(a, b)| a.abs_diff(*b)).collect();
    let count = apart.len() as f64;
    let far = apart.iter().filter(|apart| **apart > FAR).count() as f64;
    [apart.iter().map(|apart| f64::from(*apart)).sum::<f64>() / count, far / count]
}

fn is_same([mean, far]: [f64; 2]) -> bool {
    mean <= MEAN_MAX && far <= FAR_SHARE_MAX
}

#[test]
fn panel_equals_its_kept_pictures() {
    let Some(browser) = browser() else {
        println!("skipped: no Chromium is installed");
        return;
    };
    let matched = Command::new("fc-match").args(["--format=%{family}", "system-ui"]).output();
    let typeface = matched.map(|it| String::from_utf8_lossy(&it.stdout).into_owned()).unwrap_or_default();
    if typeface != TYPEFACE {
        println!("skipped: this computer shows {typeface}, the kept pictures {TYPEFACE}");
        return;
    }
    let (today, kept) = (picture(browser), folder().join("pictures.png"));
    if std::env::var_os("FLOORGUARD_REFRESH").is_some() {
        today.save(&kept).expect("kept");
    }
    let kept = image::open(&kept).expect("kept pictures").to_luma8();
    let found = difference(&today, &kept);
    assert!(is_same(found), "mean difference {:.2}, share far apart {:.4}", found[0], found[1]);
    // What is compared shows the page: two blocks of drift, or the other theme, are another picture.
    let (width, height) = kept.dimensions();
    let part = |x: u32, y: u32| imageops::crop_imm(&kept, x, y, width - 2, height / 2).to_image();
    assert!(!is_same(difference(&part(0, 0), &part(2, 0))));
    assert!(!is_same(difference(&part(0, 0), &part(0, height / 2))));
}

#[test]
fn panel_text_fits_in_five_languages() {
    let Some(browser) = browser() else {
        println!("skipped: no Chromium is installed");
        return;
    };
    let root = tempfile::tempdir().expect("a folder");
    let languages = ["en", "de", "fr", "it", "es"];
    let pages = WIDTHS.iter().flat_map(|width| languages.map(|language| (*width, language)));
    let frames: String = pages
        .map(|(width, language)| frame(width, &format!("language={language}&width={width}&open=1"), "light"))
        .collect();
    let address = write_pages(root.path(), &frames);
    let text = open(browser, root.path(), &["--window-size=1300,900", "--dump-dom", &address]);
    let text = String::from_utf8_lossy(&text).into_owned();
    let found =
        text.split_once("<pre id=\"found\" hidden=\"\">").and_then(|(_, rest)| rest.split_once("</pre>"));
    let found =
        found.unwrap_or_else(|| panic!("the frames say nothing: {}", text.len())).0.replace("&amp;", "&");
    let found: serde_json::Map<String, serde_json::Value> = serde_json::from_str(&found).expect("findings");
    assert_eq!(found.len(), WIDTHS.len() * languages.len(), "{found:?}");
    let bad: Vec<_> =
        found.iter().filter(|(_, out)| out.as_array().is_none_or(|out| !out.is_empty())).collect();
    assert!(bad.is_empty(), "{bad:#?}");
}
