//! When it is said that datagrams arrive late or again and again.

use std::time::{Duration, Instant};

const SECOND: Duration = Duration::from_secs(1);
/// At least so many in each of so many seconds, of some 70 that arrive: a flight that
/// is loaded, or a network that was busy for a moment, are over sooner.
const MANY: u64 = 2;
const SECONDS: u32 = 5;

/// Follows the count of datagrams that were dropped because newer ones had arrived before.
///
/// ```
/// use std::time::{Duration, Instant};
///
/// let (began, mut old) = (Instant::now(), fcc_xplane::OldDatagrams::default());
/// // Seven in each second.
/// let rates: Vec<f64> = (0..20)
///     .filter_map(|second| old.step(began + second * Duration::from_secs(1), 7 * u64::from(second)))
///     .collect();
/// assert_eq!(rates, [7.0]);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct OldDatagrams {
    /// The beginning of this second, and the count then.
    second: Option<(Instant, u64)>,
    /// Of the seconds in a row that had many.
    began: Option<(Instant, u64)>,
    seconds: u32,
    is_said: bool,
}

impl OldDatagrams {
    /// How many there are in a second, 2 or more, once they have lasted for 5 s; once.
    pub fn step(&mut self, now: Instant, count: u64) -> Option<f64> {
        let (since, before) = *self.second.get_or_insert((now, count));
        if now.duration_since(since) < SECOND {
            return None;
        }
        self.second = Some((now, count));
        if count.saturating_sub(before) < MANY {
            (self.seconds, self.began) = (0, None);
            return None;
        }
        self.seconds += 1;
        let (began, first) = *self.began.get_or_insert((since, before));
        if self.is_said || self.seconds < SECONDS {
            return None;
        }
        self.is_said = true;
        Some(count.saturating_sub(first) as f64 / now.duration_since(began).as_secs_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seven_in_a_second_are_said_once_and_a_loaded_flight_is_not() {
        let began = Instant::now();
        let mut old = OldDatagrams::default();
        let mut said = Vec::new();
        let mut count = 0;
        for tenth in 0..400_u32 {
            // In the third second 20 at once, and seven in each from the tenth on.
            count += match tenth {
                25 => 20,
                100.. if tenth % 10 < 7 => 1,
                _ => 0,
            };
            let now = began + tenth * Duration::from_millis(100);
            said.extend(old.step(now, count).map(|rate| (tenth, rate)));
        }
        let [(tenth, rate)] = said[..] else {
            panic!("once: {said:?}")
        };
        assert!((150..=160).contains(&tenth), "{tenth}");
        assert!((rate - 7.0).abs() < 0.5, "{rate}");
    }
}
