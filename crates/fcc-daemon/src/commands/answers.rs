//! What a person answers on standard input.

use std::io::{self, BufRead};
use std::sync::mpsc::{self, Receiver};
use std::thread;

/// Reads lines in a thread, which ends with the program: `of` says what each means, if anything,
/// and what the end of the input does.
pub(super) fn answers<T: Send + 'static>(of: fn(Option<&str>) -> Option<T>) -> Receiver<T> {
    let (to, answers) = mpsc::channel();
    thread::spawn(move || {
        let lines = io::stdin().lock().lines().map_while(Result::ok);
        let meant = lines.filter_map(|line| of(Some(line.trim())));
        // Nobody waits for what cannot be sent.
        let _ = meant.chain(of(None)).try_for_each(|one| to.send(one));
    });
    answers
}
