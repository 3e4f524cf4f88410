//! Edges of the engage switch.

use std::time::Duration;

use fcc_core::framework::{Reading, Switch, Time};

/// A change of the engage switch.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum SwitchEdge {
    On,
    Off,
}

/// Detects the edges of the engage switch.
///
/// If the switch is already on when the loop starts, or when its readings
/// resume, the loop must not take control: an on edge counts only if an off
/// reading was received since the start or since the last gap in the readings.
/// An off edge counts across a gap too: the pilot switched off meanwhile.
#[derive(Debug)]
pub(crate) struct EngageSwitch {
    max_age: Duration,
    last_position: Option<Switch>,
    off_since_gap: bool,
}

impl EngageSwitch {
    pub(crate) const fn new(max_age: Duration) -> Self {
        Self {
            max_age,
            last_position: None,
            off_since_gap: false,
        }
    }

    /// Processes this tick's reading; a stale one is ignored.
    pub(crate) fn watch(&mut self, reading: Reading<Switch>, now: Time) -> Option<SwitchEdge> {
        let Some(position) = reading.fresh(now, self.max_age) else {
            self.off_since_gap = false;
            return None;
        };
        let before = self.last_position.replace(position);
        match position {
            Switch::Off => {
                self.off_since_gap = true;
                (before == Some(Switch::On)).then_some(SwitchEdge::Off)
            }
            Switch::On => {
                (before == Some(Switch::Off) && self.off_since_gap).then_some(SwitchEdge::On)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One reading per second, each fresh for 1.5 s; `None` is a second without a
    /// reading.
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
    fn one_missing_reading_is_no_gap() {
        assert_eq!(watched([OFF, None, ON]), [None, None, Some(SwitchEdge::On)]);
    }

    #[test]
    fn after_a_gap_an_off_is_required_again() {
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
    fn an_off_counts_across_a_gap() {
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
