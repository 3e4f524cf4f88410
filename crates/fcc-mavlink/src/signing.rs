//! Signatures: who has the key may command (mavlink.io, "Message Signing").
//!
//! One table of time stamps serves all links. A station that was restarted accepts nothing
//! that was signed before its start, so that no recorded frame works again.

use std::collections::BTreeMap;

use sha2::{Digest as _, Sha256};

use crate::frame::Frame;
use crate::vehicle::Now;

/// 2015-01-01 in µs since 1970.
const EPOCH_US: u64 = 1_420_070_400_000_000;
/// A time stamp counts 10 µs.
const UNIT_US: u64 = 10;
/// A stream that is heard for the first time may be so far behind.
const BEHIND: u64 = 60_000_000 / UNIT_US;
/// Streams whose time stamps are kept.
const MOST_STREAMS: usize = 64;

/// The key.
#[derive(Clone)]
pub struct Key(pub [u8; 32]);

impl std::fmt::Debug for Key {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Key")
    }
}

/// System, component and link of a sender.
type Stream = (u8, u8, u8);

/// The state of signatures.
#[derive(Debug)]
pub(crate) struct Signing {
    key: Option<Key>,
    streams: BTreeMap<Stream, u64>,
    /// The newest time stamp of all, own ones included.
    newest: u64,
    /// What was signed before is refused.
    floor: u64,
}

impl Signing {
    /// Begins with the newest time stamp of the run before.
    pub(crate) fn new(key: Option<Key>, newest: u64, now: Now) -> Self {
        let newest = newest.max(stamp(now));
        Self {
            key,
            streams: BTreeMap::new(),
            newest,
            floor: newest,
        }
    }

    /// To be kept for the next run.
    pub(crate) const fn newest(&self) -> u64 {
        self.newest
    }

    /// Whether a frame may be read.
    pub(crate) fn permits(&mut self, frame: &Frame, now: Now) -> bool {
        let Some(Key(key)) = &self.key else {
            return true;
        };
        let Some((signed, signature)) = frame.signature() else {
            return false;
        };
        let [link, a, b, c, d, e, f, hash @ ..] = signature else {
            return false;
        };
        let at = u64::from_le_bytes([*a, *b, *c, *d, *e, *f, 0, 0]);
        let stamped = signature.get(..7).unwrap_or_default();
        if !is_same(&hash48(key, signed, stamped), hash) {
            return false;
        }
        self.newest = self.newest.max(stamp(now));
        let stream = (frame.system, frame.component, *link);
        let last = self.streams.get(&stream).copied();
        let oldest = last.unwrap_or_else(|| self.floor.max(self.newest.saturating_sub(BEHIND)));
        if at <= oldest || (last.is_none() && self.streams.len() >= MOST_STREAMS) {
            return false;
        }
        self.streams.insert(stream, at);
        // Only what has the key moves the clock on.
        self.newest = self.newest.max(at);
        true
    }

    /// What signs the next frame, if frames are signed.
    pub(crate) fn signer(&mut self, link: u8, now: Now) -> Option<impl FnOnce(&mut Vec<u8>)> {
        let Key(key) = self.key.clone()?;
        self.newest = stamp(now).max(self.newest + 1);
        let [a, b, c, d, e, f, ..] = self.newest.to_le_bytes();
        let stamped = [link, a, b, c, d, e, f];
        Some(move |bytes: &mut Vec<u8>| {
            let hash = hash48(&key, bytes, &stamped);
            bytes.extend_from_slice(&stamped);
            bytes.extend_from_slice(&hash);
        })
    }
}

fn stamp(now: Now) -> u64 {
    now.utc_us.saturating_sub(EPOCH_US) / UNIT_US
}

/// SHA-256 of key, frame, link and time stamp: its first 48 bits.
fn hash48(key: &[u8], frame: &[u8], stamped: &[u8]) -> [u8; 6] {
    let mut hash = Sha256::new();
    hash.update(key);
    hash.update(frame);
    hash.update(stamped);
    let mut first = [0; 6];
    for (to, from) in first.iter_mut().zip(hash.finalize()) {
        *to = from;
    }
    first
}

/// How long this takes does not tell how much is right.
fn is_same(a: &[u8], b: &[u8]) -> bool {
    let differs = a.iter().zip(b).fold(0, |all, (a, b)| all | (a ^ b));
    a.len() == b.len() && differs == 0
}

/// A key from the text of its file: 64 hexadecimal digits.
///
/// # Errors
/// What it has instead.
pub fn read_key(text: &str) -> Result<Key, String> {
    let text = text.trim();
    let digit = |n: usize| u8::from_str_radix(text.get(n..=n)?, 16).ok();
    let mut key = [0; 32];
    for (n, byte) in key.iter_mut().enumerate() {
        let (Some(high), Some(low)) = (digit(2 * n), digit(2 * n + 1)) else {
            return Err(wrong_key(text));
        };
        *byte = high << 4 | low;
    }
    if text.len() != 64 {
        return Err(wrong_key(text));
    }
    Ok(Key(key))
}

fn wrong_key(text: &str) -> String {
    format!(
        "has {} bytes that are no key: write 64 hexadecimal digits, as `openssl rand -hex 32` does",
        text.len()
    )
}
