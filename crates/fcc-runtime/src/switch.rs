//! Edges of the engage switch.

use std::time::Duration;

use fcc_core::framework::{Reading, Switch, Time};

/// A change of the engage switch.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum SwitchEdge {
    On,
    Off,
    /// It was switched on in a gap of the readings: it does not engage.
    OnUnseen,
}

/// After the switch went off, an on counts only once this time has passed and
/// the switch is still on: a contact that bounces disengages once, and does not
/// engage again before it is steady.
const LOCK_OUT: Duration = Duration::from_millis(500);

/// A single reading may be wrong. It counts once a second one agrees, or after
/// this time if none came: an off counts within it.
const AGREES_AFTER: Duration = Duration::from_millis(100);

/// The sensor to which the engage switch belongs: the most preferred one that
/// has ever delivered a switch. What others deliver while that one is silent is
/// no switch, since the difference between two sensors' switches is not a
/// movement of either.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct SwitchOwner(Option<u8>);

impl SwitchOwner {
    /// Takes the sensor that delivered a switch; whether the switch is its.
    pub fn owns(&mut self, source: u8) -> bool {
        let owner = self.0.unwrap_or(source).min(source);
        self.0 = Some(owner);
        owner == source
    }
}

/// A position that is not believed yet.
#[derive(Clone, Copy, Debug)]
struct Claimed {
    position: Switch,
    /// When it was first read, and the tick of that.
    taken: Time,
    since: Time,
    /// Whether a reading of the other position came after it.
    is_contradicted: bool,
}

/// Detects the edges of the engage switch, which [belongs](SwitchOwner) to one
/// sensor.
///
/// If the switch is already on when the loop starts, or when its readings
/// resume, the loop must not take control: an on edge counts only if an off
/// reading was received since the start or since the last gap in the readings.
/// An off edge counts across a gap too: the pilot switched off meanwhile.
#[derive(Debug)]
pub(crate) struct EngageSwitch {
    max_age: Duration,
    owner: SwitchOwner,
    last_position: Option<Switch>,
    claimed: Option<Claimed>,
    /// The last reading, believed or not.
    read: Option<Switch>,
    /// Whether it is read, and off.
    is_off: bool,
    off_since_gap: bool,
    went_off: Time,
    /// Switched on, but not yet counted.
    on_is_due: bool,
}

impl EngageSwitch {
    pub(crate) const fn new(max_age: Duration) -> Self {
        Self {
            max_age,
            owner: SwitchOwner(None),
            last_position: None,
            claimed: None,
            read: None,
            is_off: false,
            off_since_gap: false,
            went_off: Time::NEVER,
            on_is_due: false,
        }
    }

    /// Whether the switch is known to be off.
    pub(crate) const fn is_off(&self) -> bool {
        self.is_off
    }

    /// The position that the readings agree on: a new one once two readings have
    /// it, or for long enough if there was no second one. An on between two offs is
    /// a contact that bounces.
    fn believed(&mut self, position: Switch, taken: Time, now: Time) -> Option<Switch> {
        let is_recent = |claimed: &Claimed| now.since(claimed.since) <= AGREES_AFTER;
        if self.last_position == Some(position) {
            self.claimed = self
                .claimed
                .filter(|claimed| claimed.position == Switch::Off && is_recent(claimed))
                .map(|claimed| Claimed {
                    is_contradicted: true,
                    ..claimed
                });
            return Some(position);
        }
        let claimed = self
            .claimed
            .filter(|claimed| claimed.position == position)
            .filter(|claimed| !claimed.is_contradicted || is_recent(claimed))
            .unwrap_or(Claimed {
                position,
                taken,
                since: now,
                is_contradicted: false,
            });
        let lasts = !claimed.is_contradicted && now.since(claimed.since) >= AGREES_AFTER;
        if taken > claimed.taken || lasts {
            self.claimed = None;
            return Some(position);
        }
        self.claimed = Some(claimed);
        self.last_position
    }

    /// Processes this tick's reading; a stale one, or one of another sensor, is
    /// ignored.
    pub(crate) fn watch(&mut self, reading: Reading<Switch>, now: Time) -> Option<SwitchEdge> {
        let before = self.owner;
        let delivered = reading.fresh(now, self.max_age);
        let position = delivered.filter(|_| self.owner.owns(reading.source));
        if self.owner != before {
            *self = Self {
                owner: self.owner,
                ..Self::new(self.max_age)
            };
        }
        let Some(position) = position else {
            self.claimed = None;
            self.is_off = false;
            self.off_since_gap = false;
            self.on_is_due = false;
            return None;
        };
        // While it bounces, too; a single bad reading of a switch that is off is
        // none.
        let is_going_off =
            self.last_position == Some(Switch::On) || now.since(self.went_off) < LOCK_OUT;
        if is_going_off && self.read == Some(Switch::On) && position == Switch::Off {
            self.went_off = now;
        }
        self.read = Some(position);
        let position = self.believed(position, reading.taken, now)?;
        self.is_off = position == Switch::Off;
        let before = self.last_position.replace(position);
        match position {
            Switch::Off => {
                self.off_since_gap |= self.read == Some(Switch::Off);
                self.on_is_due = false;
                (before == Some(Switch::On)).then_some(SwitchEdge::Off)
            }
            Switch::On => {
                let was_off = before == Some(Switch::Off);
                if was_off && !self.off_since_gap {
                    return Some(SwitchEdge::OnUnseen);
                }
                self.on_is_due |= was_off;
                let counts = self.on_is_due && now.since(self.went_off) >= LOCK_OUT;
                self.on_is_due &= !counts;
                counts.then_some(SwitchEdge::On)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two readings at the begin of each second, 50 ms apart, each fresh for 1.5 s;
    /// `None` is a second without a reading.
    fn watched<const N: usize>(positions: [Option<Switch>; N]) -> [Option<SwitchEdge>; N] {
        let mut switch = EngageSwitch::new(Duration::from_millis(1_500));
        let mut reading = Reading::new(Switch::Off, Time::NEVER);
        let mut second = 0;
        positions.map(|position| {
            second += 1;
            let mut watch = |ms: i64| {
                let now = Time::from_nanos(second * 1_000_000_000 + ms * 1_000_000);
                if let Some(position) = position {
                    reading = Reading::new(position, now);
                }
                switch.watch(reading, now)
            };
            let first = watch(0);
            first.or(watch(50))
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
        const UNSEEN: Option<SwitchEdge> = Some(SwitchEdge::OnUnseen);
        assert_eq!(
            watched([OFF, None, None, ON, ON]),
            [None, None, None, UNSEEN, None]
        );
        // On before and after it: not moved, as far as is known.
        assert_eq!(watched([ON, None, None, ON]), [None; 4]);
        assert_eq!(
            watched([OFF, None, None, ON, OFF, ON]),
            [
                None,
                None,
                None,
                UNSEEN,
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

    #[test]
    fn another_sensors_switch_makes_no_edge() {
        use Switch::{Off, On};
        let mut switch = EngageSwitch::new(Duration::from_millis(1_500));
        let mut second = 0;
        let mut watch = |source, position| {
            second += 1;
            let mut watch = |ms: i64| {
                let now = Time::from_nanos(second * 1_000_000_000 + ms * 1_000_000);
                let reading = Reading::new(position, now);
                switch.watch(Reading { source, ..reading }, now)
            };
            let first = watch(0);
            first.or(watch(50))
        };
        // The first to deliver one has it, until a more preferred one does.
        assert_eq!(watch(1, Off), None);
        assert_eq!(watch(0, On), None);
        assert_eq!(watch(0, Off), Some(SwitchEdge::Off));
        // A hiccup of the owner: the other's on engages nothing.
        assert_eq!(watch(1, On), None);
        assert_eq!(watch(0, Off), None);
        assert_eq!(watch(0, On), Some(SwitchEdge::On));
        // The other's off disengages nothing, and the owner's on is no edge.
        assert_eq!(watch(1, Off), None);
        assert_eq!(watch(1, On), None);
        assert_eq!(watch(0, On), None);
        assert_eq!(watch(1, Off), None);
        assert_eq!(watch(0, Off), Some(SwitchEdge::Off), "meanwhile");
    }

    #[test]
    fn a_single_bad_reading_changes_nothing() {
        let mut switch = EngageSwitch::new(Duration::from_secs(1));
        for tick in 0..400_i64 {
            let now = Time::from_nanos(tick * 25_000_000);
            let is_on = tick >= 100;
            let is_bad = tick % 10 == 5;
            let position = if is_on == is_bad {
                Switch::Off
            } else {
                Switch::On
            };
            let edge = switch.watch(Reading::new(position, now), now);
            assert_eq!(edge, (tick == 101).then_some(SwitchEdge::On), "{tick}");
        }
    }

    #[test]
    fn an_off_counts_within_a_tenth_of_a_second_without_a_second_reading() {
        let mut switch = EngageSwitch::new(Duration::from_secs(1));
        let ms = |ms: i64| Time::from_nanos(ms * 1_000_000);
        switch.watch(Reading::new(Switch::On, ms(0)), ms(0));
        switch.watch(Reading::new(Switch::On, ms(100)), ms(100));
        let off = Reading::new(Switch::Off, ms(200));
        for at_ms in [200, 225, 250, 275] {
            assert_eq!(switch.watch(off, ms(at_ms)), None);
        }
        assert_eq!(switch.watch(off, ms(300)), Some(SwitchEdge::Off));
        assert!(switch.is_off());
    }

    #[test]
    fn a_switch_that_bounces_counts_off_with_the_second_and_on_when_it_is_steady() {
        use SwitchEdge::{Off, On};
        let mut switch = EngageSwitch::new(Duration::from_millis(1_500));
        let mut edges = Vec::new();
        for tick in 0..160_i64 {
            let now = Time::from_nanos(tick * 25_000_000);
            // On from tick 2, bouncing from tick 40 to 80, then on.
            let is_on = tick >= 2 && (!(40..=80).contains(&tick) || tick % 2 == 1);
            let position = if is_on { Switch::On } else { Switch::Off };
            if let Some(edge) = switch.watch(Reading::new(position, now), now)
                && edges.last().is_none_or(|(_, last)| *last != edge)
            {
                edges.push((tick, edge));
            }
        }
        // The last off is in tick 80; 0.5 s are 20 ticks.
        assert_eq!(edges, [(3, On), (42, Off), (100, On)]);
    }
}
