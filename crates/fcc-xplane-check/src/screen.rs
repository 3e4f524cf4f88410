//! What a program that runs the check provides: where it is shown, and what the
//! person answers.

use crate::result::StepResult;

/// What a person answered.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Answer {
    /// It is done.
    Done,
    /// Leave this step out.
    Skip,
    /// End the check.
    Quit,
}

/// Shows the check, and passes on answers.
pub trait Screen {
    /// A step begins: its number, name, and what happens in it.
    fn begin(&mut self, number: u8, title: &str, action: &str);
    /// Tells the person what to do. `confirm` is whether the check waits for
    /// [`Answer::Done`]; otherwise it sees by itself that it was done.
    fn instruct(&mut self, text: &str, confirm: bool);
    /// What is seen now, often: it replaces the last such line.
    fn live(&mut self, text: &str);
    /// A step has ended.
    fn end(&mut self, result: &StepResult);
    /// An answer that was given since the last call. Does not wait.
    fn answer(&mut self) -> Option<Answer>;
    /// Whether the program was asked to end, by a signal for example.
    fn is_stopped(&self) -> bool;
}
