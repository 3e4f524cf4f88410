//! The words for what was recorded.

/// What a recorded loop, its plant and its controller are called.
#[derive(Clone, Copy, Debug)]
pub struct Words {
    /// What was recorded: a flight.
    pub run: &'static str,
    /// What was controlled: the aircraft.
    pub plant: &'static str,
    /// What controlled it: the autopilot.
    pub controller: &'static str,
}

/// With a capital first letter.
pub(crate) fn capitalized(words: &str) -> String {
    let mut letters = words.chars();
    let first: String = letters
        .next()
        .into_iter()
        .flat_map(char::to_uppercase)
        .collect();
    first + letters.as_str()
}
