//! One page in a browser without a screen, which stays open: pictures are taken of it until they show what they must, however slow the
//! computer is. Orders go through a pair of pipes (Chrome DevTools Protocol, `--remote-debugging-pipe`).

use base64::prelude::{BASE64_STANDARD, Engine};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

/// Names under which Chromium is installed.
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
/// Time for a page to become what is asked of it, with all other tests beside.
const PATIENCE: Duration = Duration::from_secs(180);
/// Between two pictures.
const PAUSE: Duration = Duration::from_millis(300);

/// A browser, where one is installed.
pub fn browser() -> Option<&'static str> {
    let there =
        |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|it| it.status.success());
    BROWSERS.into_iter().find(there)
}

/// An open page.
pub struct Page {
    child: Child,
    orders: ChildStdin,
    answers: BufReader<ChildStdout>,
    session: Option<String>,
    number: u64,
    _folder: tempfile::TempDir,
}

impl Page {
    /// Opens an address in a window of this size, pixels.
    pub fn open(browser: &str, address: &str, (width, height): (u32, u32)) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let fixed = ["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"];
        // The browser reads orders from its third file and writes answers to its fourth.
        let mut child = Command::new("sh")
            .args(["-c", "exec \"$0\" \"$@\" 3<&0 4>&1 0</dev/null 1>&2", browser])
            .args(fixed)
            .args(["--remote-debugging-pipe", "--no-first-run"])
            .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
            .arg("about:blank")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the browser starts");
        let orders = child.stdin.take().expect("a pipe");
        let answers = BufReader::new(child.stdout.take().expect("a pipe"));
        let mut page = Self { child, orders, answers, session: None, number: 0, _folder: folder };
        let target = page.ask("Target.createTarget", json!({"url": "about:blank"}));
        let attach = json!({"targetId": target["targetId"], "flatten": true});
        let session = page.ask("Target.attachToTarget", attach);
        page.session = session["sessionId"].as_str().map(str::to_owned);
        let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        page.ask("Emulation.setDeviceMetricsOverride", size);
        page.ask("Page.navigate", json!({"url": address}));
        page
    }

    /// Pictures of the page until one shows what it must, and what each showed.
    pub fn until<T>(&mut self, look: impl Fn(&image::RgbImage) -> T, good: impl Fn(&T) -> bool) -> Vec<T> {
        let mut seen = Vec::new();
        let begun = Instant::now();
        while begun.elapsed() < PATIENCE {
            if let Some(picture) = self.picture() {
                seen.push(look(&picture));
                if seen.last().is_some_and(&good) {
                    break;
                }
            }
            std::thread::sleep(PAUSE);
        }
        seen
    }

    /// `None` while the browser changes from page to page. With `FLOORGUARD_KEEP_PICTURES` it stays in that folder too.
    fn picture(&mut self) -> Option<image::RgbImage> {
        let answer = self.try_ask("Page.captureScreenshot", json!({"format": "png"})).ok()?;
        let bytes = BASE64_STANDARD.decode(answer["data"].as_str().expect("a picture")).expect("its bytes");
        let picture = image::load_from_memory(&bytes).expect("a picture").to_rgb8();
        if let Some(kept) = std::env::var_os("FLOORGUARD_KEEP_PICTURES") {
            let name = std::path::Path::new(&kept).join(format!("page-{}.png", picture.width()));
            picture.save(name).expect("the picture is kept");
        }
        Some(picture)
    }

    fn ask(&mut self, method: &str, parameters: Value) -> Value {
        self.try_ask(method, parameters).unwrap_or_else(|error| panic!("{method}: {error}"))
    }

    /// Sends an order and reads on until its answer, or until the browser refuses; events between are passed over.
    fn try_ask(&mut self, method: &str, parameters: Value) -> Result<Value, Value> {
        self.number += 1;
        let mut order = json!({"id": self.number, "method": method, "params": parameters});
        if let Some(session) = &self.session {
            order["sessionId"] = json!(session);
        }
        self.orders.write_all(format!("{order}\0").as_bytes()).expect("the browser reads");
        loop {
            let mut bytes = Vec::new();
            let count = self.answers.read_until(0, &mut bytes).expect("the browser answers");
            assert!(count > 0, "the browser has ended, asked for {method}");
            bytes.pop();
            let mut answer: Value = serde_json::from_slice(&bytes).expect("JSON");
            if answer["id"] == json!(self.number) {
                return if answer["error"].is_null() {
                    Ok(answer["result"].take())
                } else {
                    Err(answer["error"].take())
                };
            }
        }
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
