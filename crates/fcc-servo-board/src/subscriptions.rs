//! Which values were requested.

use crate::message::NotForBoard;
use crate::value::Value;

/// Each value under one index, and some for a second program.
const MOST: usize = 2 * Value::COUNT;

#[derive(Clone, Copy, Debug)]
struct Subscription {
    index: i32,
    value: Value,
    period_ms: u32,
    sent_ms: Option<u32>,
}

/// The subscriptions of one computer, each with its index.
#[derive(Clone, Debug, Default)]
pub(crate) struct Subscriptions([Option<Subscription>; MOST]);

impl Subscriptions {
    /// Begins, changes or, at a frequency of 0, ends a subscription.
    pub(crate) fn subscribe(
        &mut self,
        frequency_hz: i32,
        index: i32,
        value: Value,
    ) -> Result<(), NotForBoard> {
        let is_this = |place: &&mut Option<Subscription>| {
            place.is_some_and(|subscription| subscription.index == index)
        };
        let place = match self.0.iter_mut().find(is_this) {
            Some(place) => place,
            None if frequency_hz <= 0 => return Ok(()),
            None => self
                .0
                .iter_mut()
                .find(|place| place.is_none())
                .ok_or(NotForBoard::Full)?,
        };
        *place = (frequency_hz > 0).then(|| Subscription {
            index,
            value,
            period_ms: 1_000 / frequency_hz.unsigned_abs(),
            sent_ms: None,
        });
        Ok(())
    }

    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Calls with the index and the value of each subscription that is due;
    /// `tolerance_ms` earlier is due, too.
    pub(crate) fn due(&mut self, now_ms: u32, tolerance_ms: u32, mut send: impl FnMut(i32, Value)) {
        for subscription in self.0.iter_mut().flatten() {
            let is_due = subscription.sent_ms.is_none_or(|sent_ms| {
                now_ms.wrapping_sub(sent_ms).saturating_add(tolerance_ms) >= subscription.period_ms
            });
            if is_due {
                subscription.sent_ms = Some(now_ms);
                send(subscription.index, subscription.value);
            }
        }
    }
}
