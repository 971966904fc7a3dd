//! Other robots of the site: this panel's server reads a few words of theirs, so that one page shows all.
//!
//! It only reads. What comes is text of another computer: a few kilobytes at most, passed on as text.

use std::io::{Read as _, Write as _};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context as _, ensure};
use floorguard_configuration::OtherRobot;
use serde_json::{Map, Value, json};

/// From one reading to the next.
const EVERY: Duration = Duration::from_secs(2);
/// A panel that takes longer is not there.
const PATIENCE: Duration = Duration::from_secs(2);
/// More is no brief.
const BYTES_MAX: usize = 8_192;

/// What a robot answered last, and when.
#[derive(Clone, Debug, Default)]
struct Heard {
    brief: Option<Map<String, Value>>,
    at: Option<Instant>,
    problem: String,
}

/// The other robots and what they answered last.
#[derive(Clone, Debug, Default)]
pub(super) struct Others {
    robots: Arc<[OtherRobot]>,
    heard: Arc<Mutex<Vec<Heard>>>,
}

impl Others {
    pub fn new(robots: &[OtherRobot]) -> Self {
        let heard = vec![Heard::default(); robots.len()];
        Self { robots: Arc::from(robots), heard: Arc::new(Mutex::new(heard)) }
    }

    /// Each robot with its name, the address of its panel, and what it answered last.
    pub fn list(&self) -> Value {
        let heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        let line = |(robot, heard): (&OtherRobot, &Heard)| {
            json!({"name": robot.name, "address": format!("http://{}/", robot.host), "brief": heard.brief,
                "age_s": heard.at.map(|at| at.elapsed().as_secs()), "problem": heard.problem})
        };
        self.robots.iter().zip(heard.iter()).map(line).collect()
    }

    /// Reads them for ever on a thread of its own, one after another; this robot's viewer token is shown to them.
    ///
    /// # Errors
    /// The thread cannot start.
    pub fn read(self, token: Option<String>) -> std::io::Result<()> {
        if self.robots.is_empty() {
            return Ok(());
        }
        let read = move || self.read_on(token.as_deref());
        std::thread::Builder::new().name("robots".to_owned()).spawn(read).map(drop)
    }

    fn read_on(&self, token: Option<&str>) {
        loop {
            for (index, robot) in self.robots.iter().enumerate() {
                let answer = brief_of(&robot.host, token);
                let mut heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
                let Some(heard) = heard.get_mut(index) else { continue };
                match answer {
                    Ok(brief) => {
                        *heard =
                            Heard { brief: Some(brief), at: Some(Instant::now()), problem: String::new() };
                    }
                    Err(error) => {
                        heard.problem = error.to_string();
                        // What it answered a while ago is not how it is now.
                        heard.brief = None;
                    }
                }
            }
            std::thread::sleep(EVERY);
        }
    }
}

/// Asks a panel for its brief (RFC 9112: one request, and the connection is closed behind the answer).
fn brief_of(host: &str, token: Option<&str>) -> anyhow::Result<Map<String, Value>> {
    let began = Instant::now();
    let address = host.to_socket_addrs().ok().and_then(|mut found| found.next());
    let address = address.context("its address is not known here")?;
    let mut stream = TcpStream::connect_timeout(&address, PATIENCE).context("it does not answer")?;
    stream.set_read_timeout(Some(PATIENCE)).and_then(|()| stream.set_write_timeout(Some(PATIENCE)))?;
    let shown = token.map(|token| format!("Authorization: Bearer {token}\r\n")).unwrap_or_default();
    let request = format!("GET /brief HTTP/1.1\r\nHost: {host}\r\n{shown}Connection: close\r\n\r\n");
    stream.write_all(request.as_bytes()).context("it does not answer")?;
    let (mut bytes, mut piece) = (Vec::new(), [0; 1_024]);
    // Each piece is at least a byte: the bound ends what drips.
    for _ in 0..BYTES_MAX {
        ensure!(began.elapsed() < 2 * PATIENCE && bytes.len() < BYTES_MAX, "it does not come to an end");
        let count = stream.read(&mut piece).context("it does not answer")?;
        if count == 0 {
            break;
        }
        bytes.extend_from_slice(piece.get(..count).unwrap_or_default());
    }
    understood(&bytes)
}

fn understood(bytes: &[u8]) -> anyhow::Result<Map<String, Value>> {
    let text = std::str::from_utf8(bytes).context("it answers in another way")?;
    let (head, body) = text.split_once("\r\n\r\n").context("it answers in another way")?;
    let code = head.split(' ').nth(1).unwrap_or_default();
    ensure!(code != "401", "it does not accept the viewer's token of this panel");
    ensure!(code == "200", "it answers in another way");
    match serde_json::from_str(body) {
        Ok(Value::Object(brief)) => Ok(brief),
        _ => anyhow::bail!("it answers in another way"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A robot that answers is shown with what it says; one that is not there, with the reason.
    #[test]
    fn robots_of_the_site_are_read() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let host = listener.local_addr().unwrap().to_string();
        std::thread::spawn(move || {
            for mut stream in listener.incoming().flatten() {
                let mut request = [0; 1_024];
                let count = stream.read(&mut request).unwrap_or(0);
                let is_shown =
                    String::from_utf8_lossy(&request[..count]).contains("Bearer viewer-viewer-viewer");
                let answer = if is_shown {
                    "HTTP/1.1 200 OK\r\n\r\n{\"state\":\"Run\"}"
                } else {
                    "HTTP/1.1 401 x\r\n\r\n"
                };
                let _ = stream.write_all(answer.as_bytes());
            }
        });
        let robot = |name: &str, host: &str| OtherRobot { name: name.to_owned(), host: host.to_owned() };
        let others = Others::new(&[robot("B", &host), robot("C", "127.0.0.1:1")]);
        others.clone().read(Some("viewer-viewer-viewer".to_owned())).unwrap();
        let mut list = Value::Null;
        for _ in 0..200 {
            list = others.list();
            if list[0]["brief"]["state"] == "Run" && list[1]["problem"] != "" {
                break;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        assert_eq!(list[0]["brief"]["state"], "Run", "{list}");
        assert_eq!(
            (&list[1]["brief"], &list[1]["problem"]),
            (&Value::Null, &json!("it does not answer")),
            "{list}"
        );
        assert_eq!(list[0]["address"], format!("http://{host}/"));
    }

    #[test]
    fn only_a_brief_is_passed_on() {
        let answer = |code: &str, body: &str| {
            understood(format!("HTTP/1.1 {code} x\r\ncontent-length: 9\r\n\r\n{body}").as_bytes())
        };
        assert_eq!(answer("200", r#"{"state":"Run"}"#).unwrap()["state"], "Run");
        for (code, body) in [("200", "[]"), ("200", "{"), ("404", "{}"), ("401", "{}")] {
            assert!(answer(code, body).is_err(), "{code} {body}");
        }
        assert!(understood(b"\xff").is_err() && understood(b"").is_err());
    }
}
