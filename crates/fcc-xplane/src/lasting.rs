//! A condition that counts only once it has lasted.

use core::time::Duration;

use fcc_core::framework::Time;

/// Begins once a condition has held without interruption, and ends once it has
/// not held for a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lasting {
    begins_after: Duration,
    ends_after: Duration,
    holds: bool,
    /// Since when the condition has been the opposite of `holds`; never while
    /// it is the same.
    since: Time,
}

impl Lasting {
    pub(crate) const fn new(begins_after: Duration, ends_after: Duration) -> Self {
        Self {
            begins_after,
            ends_after,
            holds: false,
            since: Time::NEVER,
        }
    }

    /// Whether it held at the last evaluation.
    pub(crate) const fn holds(&self) -> bool {
        self.holds
    }

    /// Evaluates the condition at `now`; returns whether it holds.
    pub(crate) fn step(&mut self, now: Time, condition: bool) -> bool {
        if condition == self.holds {
            self.since = Time::NEVER;
            return self.holds;
        }
        if self.since.is_never() {
            self.since = now;
        }
        let after = if self.holds {
            self.ends_after
        } else {
            self.begins_after
        };
        if now.since(self.since) >= after {
            self.holds = condition;
            self.since = Time::NEVER;
        }
        self.holds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_begins_and_ends_after_its_times_and_not_by_a_moment() {
        let seconds = Duration::from_secs;
        let mut lasting = Lasting::new(seconds(3), seconds(5));
        let at = |second: i64| Time::from_nanos(second * 1_000_000_000);
        let conditions = "..###.####....#......##";
        let expected = ".........###########...";
        for (second, (condition, expected)) in conditions.chars().zip(expected.chars()).enumerate()
        {
            let holds = lasting.step(at(second as i64), condition == '#');
            assert_eq!(holds, expected == '#', "second {second}");
        }
    }
}
