//! The events of a tick, in the order in which they happened.
//!
//! What happens until the estimate of a tick is complete is reported in that tick, what
//! happens after it in the next one: guidance, control and commands. No decision depends
//! on an event.

use core::fmt;

use fcc_core::framework::Notice;

/// The number of the notice that events did not fit; the item is how many.
pub(super) const LEFT_OUT: u8 = 160;

/// How many events fit: each part of the autopilot reports one or two in a tick.
const MOST: usize = 16;

/// The events that have not been reported yet, and those of this tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Journal {
    events: [Notice; MOST],
    count: usize,
    /// How many of them are reported in this tick.
    reported: usize,
    left_out: u16,
}

impl Journal {
    const EMPTY: Notice = Notice {
        kind: 0,
        lasted_ns: 0,
        amount_permille: 0,
        item: 0,
    };

    pub(super) const NEW: Self = Self {
        events: [Self::EMPTY; MOST],
        count: 0,
        reported: 0,
        left_out: 0,
    };

    /// Adds an event. The last place is kept for the number of those that do not fit.
    pub(super) fn add(&mut self, event: Notice) {
        match self.events.get_mut(self.count) {
            Some(place) if self.count + 1 < MOST => {
                *place = event;
                self.count += 1;
            }
            _ => self.left_out = self.left_out.saturating_add(1),
        }
    }

    /// A tick begins: what was reported is forgotten.
    pub(super) fn begin(&mut self) {
        self.events.copy_within(self.reported..self.count, 0);
        self.count -= self.reported;
        self.reported = 0;
    }

    /// The estimate of a tick is complete: what has happened until now is reported.
    pub(super) fn report(&mut self) {
        if let Some(place) = self
            .events
            .get_mut(self.count)
            .filter(|_| self.left_out > 0)
        {
            *place = Notice {
                kind: LEFT_OUT,
                item: self.left_out,
                ..Notice::default()
            };
            self.count += 1;
            self.left_out = 0;
        }
        self.reported = self.count;
    }

    /// The events that are reported in this tick.
    pub(super) fn reported(&self) -> &[Notice] {
        self.events.get(..self.reported).unwrap_or_default()
    }
}

/// Writes that events did not fit.
pub(super) fn write(notice: &Notice, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, "{} events did not fit into the journal", notice.item)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    fn event(item: u16) -> Notice {
        Notice {
            item,
            ..Notice::default()
        }
    }

    fn items(journal: &Journal) -> Vec<u16> {
        journal.reported().iter().map(|event| event.item).collect()
    }

    #[test]
    fn events_are_reported_once_in_their_order() {
        let mut journal = Journal::NEW;
        journal.add(event(1));
        journal.begin();
        journal.add(event(2));
        journal.report();
        journal.add(event(3));
        assert_eq!(items(&journal), [1, 2]);
        journal.begin();
        journal.report();
        assert_eq!(items(&journal), [3]);
        journal.begin();
        journal.report();
        assert_eq!(items(&journal), []);
    }

    #[test]
    fn what_does_not_fit_is_counted_and_reported() {
        let mut journal = Journal::NEW;
        (1..=20).for_each(|item| journal.add(event(item)));
        journal.begin();
        journal.report();
        let reported = journal.reported();
        assert_eq!(reported.len(), MOST);
        assert!(
            reported[..MOST - 1]
                .iter()
                .map(|event| event.item)
                .eq(1..MOST as u16)
        );
        assert_eq!(
            (reported[MOST - 1].kind, reported[MOST - 1].item),
            (LEFT_OUT, 5)
        );
        journal.begin();
        journal.report();
        assert_eq!(items(&journal), []);
    }
}
