//! What waits on the disk: messages that no broker has confirmed, and the order that the vehicle holds.

use std::collections::VecDeque;
use std::fs::{File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::messages::Topic;
use super::order::HeldOrder;

/// Messages at most: a week without a broker at one change in half a minute. The oldest go first, counted.
pub const MESSAGES_MAX: usize = 20_000;
/// After so many confirmed messages the file is written anew.
const COMPACT_AFTER: usize = 2_000;
const QUEUE_FILE: &str = "queue.log";
const ORDER_FILE: &str = "order.json";

/// A message that waits.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Waiting {
    /// Its kind.
    pub topic: Topic,
    /// JSON.
    pub payload: String,
}

/// A line of the file.
#[derive(Serialize, Deserialize)]
enum Line {
    /// A message was put in.
    Message(Waiting),
    /// The oldest one has left.
    Left,
}

/// Messages in their order. With a folder they outlive the program.
pub struct OfflineQueue {
    waiting: VecDeque<Waiting>,
    file: Option<(PathBuf, File)>,
    left_since: usize,
    /// Messages that did not fit.
    pub dropped: u64,
}

impl OfflineQueue {
    /// With what was left when the program ended.
    ///
    /// # Errors
    /// The folder cannot be made, or its file cannot be read or written.
    pub fn open(folder: Option<&Path>) -> io::Result<Self> {
        let mut queue = Self { waiting: VecDeque::new(), file: None, left_since: 0, dropped: 0 };
        let Some(folder) = folder else { return Ok(queue) };
        std::fs::create_dir_all(folder)?;
        let path = folder.join(QUEUE_FILE);
        if path.exists() {
            // A last line that was cut when the power went is no message.
            for line in
                std::fs::read_to_string(&path)?.lines().map_while(|line| serde_json::from_str(line).ok())
            {
                match line {
                    Line::Message(message) => queue.waiting.push_back(message),
                    Line::Left => _ = queue.waiting.pop_front(),
                }
            }
        }
        queue.file = Some((path.clone(), rewritten(&path, &queue.waiting)?));
        Ok(queue)
    }

    /// One of them, the oldest is 0.
    pub fn get(&self, index: usize) -> Option<&Waiting> {
        self.waiting.get(index)
    }

    /// Puts a message in. True if the oldest had to go for it.
    ///
    /// # Errors
    /// The disk; the message waits in memory all the same.
    pub fn push(&mut self, message: Waiting) -> io::Result<bool> {
        let is_full = self.waiting.len() >= MESSAGES_MAX;
        if is_full {
            self.dropped += 1;
            self.leave()?;
        }
        let written = self.write(&Line::Message(message.clone()));
        self.waiting.push_back(message);
        written.map(|()| is_full)
    }

    /// The oldest message was confirmed.
    ///
    /// # Errors
    /// The disk; the message has left all the same.
    pub fn leave(&mut self) -> io::Result<()> {
        if self.waiting.pop_front().is_none() {
            return Ok(());
        }
        self.left_since += 1;
        if self.left_since < COMPACT_AFTER {
            return self.write(&Line::Left);
        }
        self.left_since = 0;
        if let Some((path, file)) = &mut self.file {
            *file = rewritten(path, &self.waiting)?;
        }
        Ok(())
    }

    fn write(&mut self, line: &Line) -> io::Result<()> {
        let Some((_, file)) = &mut self.file else { return Ok(()) };
        file.write_all(text_of(line).as_bytes())
    }
}

fn text_of(line: &Line) -> String {
    serde_json::to_string(line).map(|text| text + "\n").unwrap_or_default()
}

/// The file with nothing but what waits, written whole before it takes the old one's place.
fn rewritten(path: &Path, waiting: &VecDeque<Waiting>) -> io::Result<File> {
    let text: String = waiting.iter().map(|message| text_of(&Line::Message(message.clone()))).collect();
    replace(path, &text)?;
    OpenOptions::new().append(true).open(path)
}

fn replace(path: &Path, text: &str) -> io::Result<()> {
    let beside = path.with_extension("new");
    let mut file = File::create(&beside)?;
    file.write_all(text.as_bytes())?;
    file.sync_data()?;
    std::fs::rename(&beside, path)
}

/// The order that a vehicle held when its program ended.
///
/// # Errors
/// The folder cannot be made, or its file cannot be read.
pub fn read_order(folder: &Path) -> io::Result<Option<HeldOrder>> {
    std::fs::create_dir_all(folder)?;
    let path = folder.join(ORDER_FILE);
    if !path.exists() {
        return Ok(None);
    }
    let text = std::fs::read_to_string(&path)?;
    serde_json::from_str(&text).map(Some).map_err(io::Error::other)
}

/// Keeps the order. A disk that is full is reported and stops nobody: the vehicle goes on with what it knows.
pub fn write_order(folder: &Path, order: &HeldOrder) {
    let text = serde_json::to_string(order).map_err(io::Error::other);
    if let Err(error) = text.and_then(|text| replace(&folder.join(ORDER_FILE), &text)) {
        say!("  fleet: the order is not kept on the disk ({error})");
    }
}

/// Writes a log report; gives its name.
///
/// # Errors
/// The disk.
pub fn write_log(folder: &Path, action_id: &str, text: &str) -> io::Result<String> {
    let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '-' };
    let name = format!("report-{}.log", action_id.chars().take(64).map(plain).collect::<String>());
    std::fs::write(folder.join(&name), text)?;
    Ok(name)
}
