//! How often a change that another program can cause again and again is said.

use std::time::{Duration, Instant};

/// Changes that are said at once, and in which time; the others are counted.
const AT_ONCE: u32 = 4;
const OVER: Duration = Duration::from_secs(10);

/// Passes texts on, or counts them.
#[derive(Debug, Default)]
pub(crate) struct ChangeLimit {
    since: Option<Instant>,
    passed: u32,
    counted: u32,
    last: String,
}

impl ChangeLimit {
    /// What is to be said now: the text of a change, or the last of many.
    pub(crate) fn step(&mut self, now: Instant, change: Option<String>) -> Option<String> {
        let is_over = |since: Instant| now.duration_since(since) >= OVER;
        if self.since.is_none_or(is_over) {
            let counted = std::mem::take(&mut self.counted);
            self.since = Some(now);
            self.passed = 0;
            if counted > 0 {
                self.passed = AT_ONCE;
                self.counted = u32::from(change.is_some());
                let last = std::mem::take(&mut self.last);
                self.last = change.unwrap_or_default();
                let over_s = OVER.as_secs();
                return Some(format!(
                    "{last} (the last of {counted} such changes in {over_s} s)"
                ));
            }
        }
        let text = change?;
        if self.passed < AT_ONCE {
            self.passed += 1;
            return Some(text);
        }
        self.counted += 1;
        self.last = text;
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A change in each twentieth of a second, for 25 s; then none.
    #[test]
    fn four_are_said_and_then_one_in_ten_seconds() {
        let begun = Instant::now();
        let mut limit = ChangeLimit::default();
        let said: Vec<_> = (0..1_200_u32)
            .filter_map(|step| {
                let change = (step < 500).then(|| format!("change {step}"));
                limit.step(begun + step * Duration::from_millis(50), change)
            })
            .collect();
        assert_eq!(
            said,
            [
                "change 0",
                "change 1",
                "change 2",
                "change 3",
                "change 199 (the last of 196 such changes in 10 s)",
                "change 399 (the last of 200 such changes in 10 s)",
                "change 499 (the last of 100 such changes in 10 s)",
            ]
        );
        // Long after, each is said at once.
        let later = begun + Duration::from_secs(70);
        let said = limit.step(later, Some("change".to_owned()));
        assert_eq!(said.as_deref(), Some("change"));
    }
}
