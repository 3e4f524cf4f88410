//! The load of the board, and of the station on it.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use nix::sys::statvfs::statvfs;
use nix::sys::time::TimeValLike as _;
use nix::time::{ClockId, clock_gettime};
use serde_json::{Value, json};

/// Looked at as often as this, however many daemons run.
const EVERY: Duration = Duration::from_millis(900);

/// The load of the board.
#[derive(Clone, Debug)]
pub(crate) struct Machine(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    recordings: PathBuf,
    clients: AtomicUsize,
    last: Mutex<Option<Look>>,
}

#[derive(Debug)]
struct Look {
    at: Instant,
    cpu_ns: i64,
    found: Value,
}

/// Counts one page that is connected, until it is dropped.
#[derive(Debug)]
pub(crate) struct Client(Machine);

impl Drop for Client {
    fn drop(&mut self) {
        self.0.0.clients.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Machine {
    pub(crate) fn new(recordings: PathBuf) -> Self {
        Self(Arc::new(Inner {
            recordings,
            clients: AtomicUsize::new(0),
            last: Mutex::default(),
        }))
    }

    pub(crate) fn client(&self) -> Client {
        self.0.clients.fetch_add(1, Ordering::Relaxed);
        Client(self.clone())
    }

    /// What is known now.
    pub(super) fn now(&self) -> Value {
        let mut last = self.0.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(last) = last.as_ref().filter(|last| last.at.elapsed() < EVERY) {
            return last.found.clone();
        }
        let (at, cpu_ns) = (Instant::now(), cpu_ns());
        let percent = last.as_ref().map(|last| {
            let seconds = at.duration_since(last.at).as_secs_f64();
            100.0 * (cpu_ns - last.cpu_ns) as f64 * 1e-9 / seconds
        });
        let found = json!({
            "load": load(),
            "processors": std::thread::available_parallelism().ok(),
            "temperature_c": temperature_c(),
            "memory_available_bytes": memory_bytes("/proc/meminfo", "MemAvailable:"),
            "disk_available_bytes": self.disk_available_bytes(),
            "station": {
                "clients": self.0.clients.load(Ordering::Relaxed),
                "cpu_percent": percent,
                "memory_bytes": memory_bytes("/proc/self/status", "VmRSS:"),
            },
        });
        *last = Some(Look {
            at,
            cpu_ns,
            found: found.clone(),
        });
        found
    }

    fn disk_available_bytes(&self) -> Option<u64> {
        let found = statvfs(&self.0.recordings).ok()?;
        Some(found.blocks_available() as u64 * found.fragment_size() as u64)
    }
}

fn cpu_ns() -> i64 {
    let used = clock_gettime(ClockId::CLOCK_PROCESS_CPUTIME_ID);
    used.map_or(0, |used| used.num_nanoseconds())
}

/// Processes that ran or waited to, on average of 1, 5 and 15 minutes.
fn load() -> Option<Vec<f64>> {
    let text = fs::read_to_string("/proc/loadavg").ok()?;
    let words = text.split_whitespace().take(3);
    words.map(|word| word.parse().ok()).collect()
}

/// The highest of the board's sensors.
fn temperature_c() -> Option<f64> {
    let zones = fs::read_dir("/sys/class/thermal").ok()?.flatten();
    let millis = zones.filter_map(|zone| {
        let text = fs::read_to_string(zone.path().join("temp")).ok()?;
        text.trim().parse::<i64>().ok()
    });
    millis.max().map(|millis| millis as f64 * 1e-3)
}

/// A line `NAME: NUMBER kB` of a file of the kernel.
fn memory_bytes(file: &str, name: &str) -> Option<u64> {
    let text = fs::read_to_string(file).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let kib: u64 = line.trim().strip_suffix(" kB")?.trim().parse().ok()?;
    Some(kib * 1_024)
}
