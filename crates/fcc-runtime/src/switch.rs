//! From the engage switch's position to what the hand on it meant.

use std::time::Duration;

use fcc_core::framework::{Reading, Switch, Time};

/// What a hand did to the engage switch.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum SwitchEdge {
    On,
    Off,
}

/// Watches the engage switch for the moments it is thrown.
///
/// A loop that starts, or hears from the switch again, while the switch is
/// already on must not grab the controls: before an on counts, an off must
/// have been seen since the start or the last silence. An off counts after a
/// silence too: who switched off while nobody listened still wants it off.
#[derive(Debug)]
pub(crate) struct EngageSwitch {
    max_age: Duration,
    last_heard: Option<Switch>,
    off_seen_since_silence: bool,
}

impl EngageSwitch {
    pub(crate) const fn new(max_age: Duration) -> Self {
        Self {
            max_age,
            last_heard: None,
            off_seen_since_silence: false,
        }
    }

    /// Takes this tick's reading; a stale one is no reading.
    pub(crate) fn watch(&mut self, reading: Reading<Switch>, now: Time) -> Option<SwitchEdge> {
        let Some(position) = reading.fresh(now, self.max_age) else {
            self.off_seen_since_silence = false;
            return None;
        };
        let before = self.last_heard.replace(position);
        match position {
            Switch::Off => {
                self.off_seen_since_silence = true;
                (before == Some(Switch::On)).then_some(SwitchEdge::Off)
            }
            Switch::On => (before == Some(Switch::Off) && self.off_seen_since_silence)
                .then_some(SwitchEdge::On),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One reading per second, each fresh for 1.5 s; `None` is a second in
    /// which nothing came.
    fn watched<const N: usize>(positions: [Option<Switch>; N]) -> [Option<SwitchEdge>; N] {
        let mut switch = EngageSwitch::new(Duration::from_millis(1_500));
        let mut reading = Reading::new(Switch::Off, Time::NEVER);
        let mut second = 0;
        positions.map(|position| {
            second += 1;
            let now = Time::from_nanos(second * 1_000_000_000);
            if let Some(position) = position {
                reading = Reading::new(position, now);
            }
            switch.watch(reading, now)
        })
    }

    const OFF: Option<Switch> = Some(Switch::Off);
    const ON: Option<Switch> = Some(Switch::On);

    #[test]
    fn an_on_counts_once_after_an_off() {
        assert_eq!(
            watched([OFF, ON, ON, OFF, ON]),
            [
                None,
                Some(SwitchEdge::On),
                None,
                Some(SwitchEdge::Off),
                Some(SwitchEdge::On)
            ]
        );
    }

    #[test]
    fn a_switch_that_is_on_from_the_start_does_not_count() {
        assert_eq!(watched([ON, ON, None, ON]), [None; 4]);
    }

    #[test]
    fn one_missing_reading_is_no_silence() {
        assert_eq!(watched([OFF, None, ON]), [None, None, Some(SwitchEdge::On)]);
    }

    #[test]
    fn after_a_silence_the_off_must_be_seen_again() {
        assert_eq!(watched([OFF, None, None, ON]), [None; 4]);
        assert_eq!(
            watched([OFF, None, None, ON, OFF, ON]),
            [
                None,
                None,
                None,
                None,
                Some(SwitchEdge::Off),
                Some(SwitchEdge::On)
            ]
        );
    }

    #[test]
    fn an_off_counts_through_a_silence() {
        assert_eq!(
            watched([OFF, ON, None, None, None, OFF]),
            [
                None,
                Some(SwitchEdge::On),
                None,
                None,
                None,
                Some(SwitchEdge::Off)
            ]
        );
    }
}
