//! What a person answers on standard input.

use std::io::{self, BufRead};
use std::sync::mpsc::{self, Receiver};
use std::thread;

/// Reads lines in a thread, which ends with the program. After the last one nobody answers any
/// more: the answer of `None`.
pub(super) fn answers<T: Send + 'static>(of: fn(Option<&str>) -> T) -> Receiver<T> {
    let (to, answers) = mpsc::channel();
    thread::spawn(move || {
        for line in io::stdin().lock().lines().map_while(Result::ok) {
            if to.send(of(Some(line.trim()))).is_err() {
                return;
            }
        }
        let _ = to.send(of(None));
    });
    answers
}
