//! What the targets share: how bytes become several messages, and the right messages of the simulator.

use std::sync::OnceLock;

use floorguard_drivers::ouster::Beams;
use floorguard_tests::fuzz::{Corpus, ouster_turn};
use floorguard_tests::fuzz::scanning::ScanningCorpus;

/// The robot's state is large, and moved by value when a run begins.
const STACK_BYTES: usize = 64 << 20;

/// Cuts bytes into messages: two bytes of length, low byte first, before each.
#[must_use]
pub fn pieces(data: &[u8]) -> Vec<Vec<u8>> {
    let (mut messages, mut rest) = (Vec::new(), data);
    while let Some((length, after)) = rest.split_first_chunk::<2>() {
        let length = usize::from(u16::from_le_bytes(*length)).min(after.len());
        messages.push(after[..length].to_vec());
        rest = &after[length..];
    }
    messages
}

/// Messages that [`pieces`] cuts again.
#[must_use]
pub fn joined(messages: &[Vec<u8>]) -> Vec<u8> {
    let with_length = |message: &Vec<u8>| [&(message.len() as u16).to_le_bytes()[..], message].concat();
    messages.iter().flat_map(with_length).collect()
}

/// Messages of the simulated devices, made once.
#[must_use]
pub fn corpus() -> &'static Corpus {
    static CORPUS: OnceLock<Corpus> = OnceLock::new();
    CORPUS.get_or_init(Corpus::simulated)
}

/// What a lidar and its motor sent, made once.
#[must_use]
pub fn scanning_corpus() -> &'static ScanningCorpus {
    static CORPUS: OnceLock<ScanningCorpus> = OnceLock::new();
    CORPUS.get_or_init(ScanningCorpus::simulated)
}

/// An Ouster and one turn of it, made once.
#[must_use]
pub fn ouster() -> &'static (Beams, Vec<Vec<u8>>) {
    static TURN: OnceLock<(Beams, Vec<Vec<u8>>)> = OnceLock::new();
    TURN.get_or_init(ouster_turn)
}

/// Runs on a thread whose stack holds a whole robot; its panic becomes ours.
pub fn on_a_large_stack(work: impl FnOnce() + Send) {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK_BYTES);
        if let Err(panic) = thread.spawn_scoped(scope, work).expect("a thread").join() {
            std::panic::resume_unwind(panic);
        }
    });
}
