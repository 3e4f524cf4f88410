//! The check on a terminal: what it says, and what the person answers.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;

use fcc_xplane_check::{Answer, Outcome, Screen, StepResult};
use indicatif::ProgressBar;
use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGTSTP};

use super::super::answers::answers;
use super::Failure;
use crate::output;
use crate::process::tolerate;

/// The keys, once.
const KEYS: &str = "Enter: done; s, Enter: leave this step out; q, Enter: end the check.";

/// Standard error for what is said, standard input for answers.
pub(super) struct Terminal {
    /// Replaced all the time; hidden where standard error is no terminal.
    live: ProgressBar,
    answers: Option<Receiver<Answer>>,
    stopped: Arc<AtomicBool>,
    /// Ctrl-Z was pressed, and had no effect.
    suspended: Arc<AtomicBool>,
}

impl Terminal {
    /// Catches signals, so that the daemon is ended properly, and reads answers
    /// if there is a person. Ctrl-Z has no effect: a process that is stopped
    /// does not release the controls.
    pub(super) fn open(has_person: bool) -> Result<Self, Failure> {
        let [stopped, suspended] = <[Arc<AtomicBool>; 2]>::default();
        let uncaught = |error| Failure::new(format_args!("signals cannot be caught: {error}"));
        tolerate().map_err(uncaught)?;
        for (signal, flag) in [
            (SIGINT, &stopped),
            (SIGTERM, &stopped),
            (SIGQUIT, &stopped),
            (SIGHUP, &stopped),
            (SIGTSTP, &suspended),
        ] {
            signal_hook::flag::register(signal, Arc::clone(flag)).map_err(uncaught)?;
        }
        let terminal = Self {
            live: ProgressBar::new_spinner(),
            answers: has_person.then(|| {
                answers(|line| match line {
                    Some("s") => Some(Answer::Skip),
                    Some("q") | None => Some(Answer::Quit),
                    _ => Some(Answer::Done),
                })
            }),
            stopped,
            suspended,
        };
        if has_person {
            terminal.print(KEYS);
        }
        Ok(terminal)
    }

    fn print(&self, text: &str) {
        self.live.suspend(|| output::message(text));
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        self.live.finish_and_clear();
    }
}

impl Screen for Terminal {
    fn begin(&mut self, number: u8, title: &str, action: &str) {
        self.print(&format!("\n{number:2}. {title}"));
        if self.answers.is_some() {
            self.print(&format!("    {action}"));
        }
    }

    fn instruct(&mut self, text: &str, confirm: bool) {
        // An answer given before the question is none.
        if let Some(answers) = &self.answers {
            answers.try_iter().for_each(drop);
        }
        let how = if confirm {
            ""
        } else {
            " (It is seen when it is done.)"
        };
        self.print(&format!("  → {text}{how}"));
    }

    fn live(&mut self, text: &str) {
        if self.suspended.swap(false, Ordering::Relaxed) {
            self.print("Ctrl-Z does not stop this; Ctrl-C ends it");
        }
        self.live.set_message(text.to_owned());
        self.live.tick();
    }

    fn end(&mut self, result: &StepResult) {
        let mut text = format!(
            "    {} after {:.1} s",
            result.outcome.as_str(),
            result.duration_s
        );
        if let Some(why) = &result.why {
            text.push_str(": ");
            text.push_str(why);
        }
        if let Some(advice) = result.advice.filter(|_| result.outcome == Outcome::Failed) {
            text.push_str("\n    ");
            text.push_str(advice);
        }
        self.print(&text);
    }

    fn answer(&mut self) -> Option<Answer> {
        self.answers.as_ref()?.try_recv().ok()
    }

    fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }
}
