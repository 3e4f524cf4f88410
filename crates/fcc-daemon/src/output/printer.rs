//! Prints by threads of their own, so that nothing of a flight in real time waits for who
//! reads the output: a pipe that is full, a terminal that Ctrl-S stopped.
//!
//! A thread that nobody reads stays in its call of the system, and ends with the process.

use std::io;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Messages that may wait while the output is blocked: some minutes of status.
const WAITING: usize = 256;
/// How long the end of the program waits until all is printed.
const PATIENCE: Duration = Duration::from_secs(2);
/// The part of it that the result leaves to the messages before it. Then it is printed
/// beside them: it may go elsewhere.
const MESSAGES_FIRST: Duration = Duration::from_secs(1);
/// With locked memory, all of a stack is resident.
const STACK: usize = 256 << 10;

static QUEUE: Mutex<Option<Queue>> = Mutex::new(None);

fn queue() -> MutexGuard<'static, Option<Queue>> {
    QUEUE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// While this lives, messages and results are printed in the background. Messages that do
/// not fit into the queue are dropped, and their number is printed later.
pub(crate) struct Printer(());

impl Printer {
    /// Begins it; `write` prints one line. Without a thread, printing waits for the output.
    pub(super) fn begin(write: fn(&str)) -> Option<Self> {
        let (to, from) = sync_channel::<String>(WAITING);
        let waiting = Arc::new(AtomicUsize::new(0));
        let left = Arc::clone(&waiting);
        let print = move |line: String| {
            write(&line);
            left.fetch_sub(1, Ordering::Release);
        };
        begin_thread("fccd-printer", move || from.iter().for_each(print)).ok()?;
        *queue() = Some(Queue {
            to,
            waiting,
            dropped: 0,
            ends: None,
        });
        Some(Self(()))
    }
}

impl Drop for Printer {
    /// Waits for a limited time until all is printed.
    fn drop(&mut self) {
        wait_until_printed();
        *queue() = None;
    }
}

/// Queues a line; gives it back if nothing is printed in the background.
pub(super) fn queued(line: String) -> Result<(), String> {
    match queue().as_mut() {
        Some(lines) => {
            lines.give(line);
            Ok(())
        }
        None => Err(line),
    }
}

/// Waits until the messages are printed, as long as the end of the program may wait.
pub(crate) fn wait_until_printed() {
    if let Some(deadline) = deadline() {
        wait_for_messages(deadline);
    }
}

/// Performs the printing of a result after the messages before it; `None` if nobody read it
/// for as long as the end of the program may wait.
pub(super) fn in_time(
    print: impl FnOnce() -> io::Result<()> + Send + 'static,
) -> Option<io::Result<()>> {
    let Some(deadline) = deadline() else {
        return Some(print());
    };
    wait_for_messages(deadline.min(Instant::now() + MESSAGES_FIRST));
    let (tell, told) = channel();
    let printing = begin_thread("fccd-result", move || {
        // Nobody waits for it any more.
        let _ = tell.send(print());
    });
    if let Err(error) = printing {
        return Some(Err(error));
    }
    let left = deadline.saturating_duration_since(Instant::now());
    told.recv_timeout(left).ok()
}

fn begin_thread(name: &str, run: impl FnOnce() + Send + 'static) -> io::Result<()> {
    let thread = thread::Builder::new().name(name.to_owned());
    thread.stack_size(STACK).spawn(run).map(drop)
}

/// Until when the end of the program waits, from the first call on; `None` if nothing is
/// printed in the background.
fn deadline() -> Option<Instant> {
    let mut queue = queue();
    let ends = &mut queue.as_mut()?.ends;
    Some(*ends.get_or_insert_with(|| Instant::now() + PATIENCE))
}

fn wait_for_messages(deadline: Instant) {
    let is_waiting = || queue().as_ref().is_some_and(Queue::is_waiting);
    while is_waiting() && Instant::now() < deadline {
        thread::sleep(Duration::from_millis(1));
    }
}

/// The queue of messages for the thread that prints them.
struct Queue {
    to: SyncSender<String>,
    /// Those that are not printed yet.
    waiting: Arc<AtomicUsize>,
    dropped: u64,
    /// When the end of the program no longer waits.
    ends: Option<Instant>,
}

impl Queue {
    fn is_waiting(&self) -> bool {
        self.waiting.load(Ordering::Acquire) > 0
    }

    fn give(&mut self, line: String) {
        if self.dropped > 0 {
            let gap = format!(
                "{} lines were dropped here: the terminal was blocked\n",
                self.dropped
            );
            if !self.fits(gap) {
                self.dropped += 1;
                return;
            }
            self.dropped = 0;
        }
        if !self.fits(line) {
            self.dropped += 1;
        }
    }

    fn fits(&self, line: String) -> bool {
        // Before the thread can take it.
        self.waiting.fetch_add(1, Ordering::Relaxed);
        let fits = self.to.try_send(line).is_ok();
        if !fits {
            self.waiting.fetch_sub(1, Ordering::Relaxed);
        }
        fits
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dropped_lines_are_counted_where_they_are_missing() {
        let (to, from) = sync_channel(2);
        let mut lines = Queue {
            to,
            waiting: Arc::default(),
            dropped: 0,
            ends: None,
        };
        for line in ["a", "b", "c", "d"] {
            lines.give(line.to_owned());
        }
        let printed: Vec<String> = from.try_iter().collect();
        assert_eq!(printed, ["a", "b"]);
        lines.give("e".to_owned());
        let printed: Vec<String> = from.try_iter().collect();
        assert_eq!(
            printed,
            ["2 lines were dropped here: the terminal was blocked\n", "e"]
        );
    }
}
