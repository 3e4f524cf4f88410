//! Terms for the recorded loop.

/// Terms for a recorded loop, its plant and its controller.
#[derive(Clone, Copy, Debug)]
pub struct Terms {
    /// The run, such as "flight".
    pub run: &'static str,
    /// The plant, such as "Aircraft".
    pub plant: &'static str,
    /// The controller, such as "autopilot".
    pub controller: &'static str,
}

/// With a capital first letter.
pub(crate) fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    let first: String = letters
        .next()
        .into_iter()
        .flat_map(char::to_uppercase)
        .collect();
    first + letters.as_str()
}
