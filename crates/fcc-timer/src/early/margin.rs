//! The margin, calculated from the lateness of recent wake-ups.
//!
//! A sliding window of lateness, each stored as the number of a bucket, and a
//! count for each bucket: integers in fixed memory, two of them changed per
//! tick.

use super::EarlyWake;

/// Wake-ups in the window: 51 s at 40 Hz, 2 s at 1 kHz.
const WINDOW: usize = 2048;
/// Buckets from no lateness to the longest margin: 1 µs each for 250 µs.
const BUCKETS: usize = 256;
/// Ticks between two reviews: under a second at 40 Hz.
const REVIEW_TICKS: u32 = 32;
/// A margin is shortened only by at least this part of it, so that it does not
/// oscillate.
const WORTH_SAVING: i64 = 8;

/// The present margin and the data it is calculated from.
#[derive(Debug)]
pub(super) struct Margin {
    shortest_ns: i64,
    longest_ns: i64,
    guard_ns: i64,
    /// The share of wake-ups that may be later than the margin.
    spared: f64,
    bucket_ns: i64,
    /// Buckets of the last wake-ups; the oldest is overwritten.
    window: Box<[u16]>,
    next: usize,
    seen: usize,
    /// How many wake-ups of the window are in each bucket; the last bucket holds
    /// those later than any margin.
    counts: Box<[u16]>,
    review_in: u32,
    now_ns: i64,
}

impl Margin {
    pub(super) fn new(config: &EarlyWake, period_ns: i64) -> Self {
        let ns = |time: std::time::Duration| time.as_nanos() as i64;
        let affordable_ns = (config.cpu_cap * period_ns as f64) as i64;
        let longest_ns = ns(config.max).min(affordable_ns);
        Self {
            shortest_ns: ns(config.min).min(longest_ns),
            longest_ns,
            guard_ns: ns(config.guard),
            spared: 1.0 - config.quantile,
            bucket_ns: longest_ns.unsigned_abs().div_ceil(BUCKETS as u64).max(1) as i64,
            window: vec![0; WINDOW].into(),
            next: 0,
            seen: 0,
            counts: vec![0; BUCKETS + 1].into(),
            review_in: REVIEW_TICKS,
            // Nothing is known yet: the longest.
            now_ns: longest_ns,
        }
    }

    pub(super) const fn ns(&self) -> i64 {
        self.now_ns
    }

    /// Its maximum.
    pub(super) const fn longest_ns(&self) -> i64 {
        self.longest_ns
    }

    /// Records the lateness of a wake-up.
    pub(super) fn observe(&mut self, lateness_ns: i64) {
        let bucket = (lateness_ns / self.bucket_ns).clamp(0, BUCKETS as i64) as u16;
        if let Some(slot) = self.window.get_mut(self.next) {
            let forgotten = std::mem::replace(slot, bucket);
            if self.seen < WINDOW {
                self.seen += 1;
            } else if let Some(count) = self.counts.get_mut(usize::from(forgotten)) {
                *count = count.saturating_sub(1);
            }
        }
        if let Some(count) = self.counts.get_mut(usize::from(bucket)) {
            *count = count.saturating_add(1);
        }
        self.next = (self.next + 1) % WINDOW;
    }

    /// To be called once a tick; whether the margin changed. It includes the time
    /// for a warm-up.
    pub(super) fn review(&mut self, warm_up_ns: i64) -> bool {
        self.review_in = self.review_in.saturating_sub(1);
        if self.review_in > 0 {
            return false;
        }
        self.review_in = REVIEW_TICKS;
        // A quantile of 0.998 needs 500 values: fewer underestimate it.
        if self.spared * (self.seen as f64) < 1.0 && self.seen < WINDOW {
            return false;
        }
        let wanted_ns = self.wanted_ns(warm_up_ns);
        let saved_ns = self.now_ns.saturating_sub(wanted_ns);
        if saved_ns < 0 || saved_ns > self.now_ns / WORTH_SAVING {
            self.now_ns = wanted_ns;
            return true;
        }
        false
    }

    /// Rounded up, so that a change of a nanosecond does not move an alarm.
    const fn in_buckets(&self, ns: i64) -> i64 {
        let bucket_ns = self.bucket_ns.unsigned_abs();
        (ns.unsigned_abs().div_ceil(bucket_ns) * bucket_ns) as i64
    }

    /// The margin required by the wake-ups in the window.
    fn wanted_ns(&self, warm_up_ns: i64) -> i64 {
        let beyond = self.counts.last().copied().map_or(0, usize::from);
        if 2 * beyond >= self.seen {
            return self.longest_ns;
        }
        let mut spared = (self.spared * (self.seen - beyond) as f64) as usize;
        let mut covered_ns = 0;
        for (bucket, count) in self.counts.iter().enumerate().take(BUCKETS).rev() {
            let count = usize::from(*count);
            if count > spared {
                covered_ns = (bucket as i64 + 1).saturating_mul(self.bucket_ns);
                break;
            }
            spared -= count;
        }
        covered_ns
            .saturating_add(self.guard_ns)
            .saturating_add(self.in_buckets(warm_up_ns))
            .clamp(self.shortest_ns, self.longest_ns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    const US: i64 = 1_000;
    const PERIOD_NS: i64 = 25_000 * US;

    fn at_40_hz() -> Margin {
        Margin::new(&EarlyWake::default(), PERIOD_NS)
    }

    /// Lets the timer tick with these latenesses, and counts how often the
    /// margin moved.
    fn ticks(margin: &mut Margin, latenesses_us: impl IntoIterator<Item = i64>) -> u32 {
        latenesses_us
            .into_iter()
            .map(|us| {
                margin.observe(us * US);
                u32::from(margin.review(0))
            })
            .sum()
    }

    fn steady(us: i64, count: usize) -> impl Iterator<Item = i64> {
        std::iter::repeat_n(us, count)
    }

    #[test]
    fn begins_with_the_longest_margin() {
        assert_eq!(at_40_hz().ns(), 250 * US);
        let capped = EarlyWake {
            cpu_cap: 0.004,
            ..EarlyWake::default()
        };
        assert_eq!(Margin::new(&capped, PERIOD_NS).ns(), 100 * US);
        assert_eq!(Margin::new(&EarlyWake::default(), 100 * US).ns(), 25 * US);
    }

    #[test]
    fn is_a_steady_lateness_plus_the_guard() {
        let mut margin = at_40_hz();
        ticks(&mut margin, steady(60, 544));
        // 60 µs and 20 µs of guard, rounded up to a bucket of a microsecond.
        assert!(
            (80 * US..=81 * US).contains(&margin.ns()),
            "{}",
            margin.ns()
        );
    }

    #[test]
    fn is_the_longest_until_the_quantile_is_known() {
        let mut margin = at_40_hz();
        // One in 500 is 0.002: of fewer, nothing is left of the quantile.
        ticks(&mut margin, steady(60, 499));
        assert_eq!(margin.ns(), 250 * US);
        ticks(&mut margin, steady(60, 32));
        assert!(margin.ns() < 100 * US, "{}", margin.ns());
    }

    #[test]
    fn keeps_between_its_bounds() {
        let mut margin = at_40_hz();
        ticks(&mut margin, steady(0, 544));
        assert!(
            (20 * US..=21 * US).contains(&margin.ns()),
            "{}",
            margin.ns()
        );
        ticks(&mut margin, steady(245, 2048));
        assert_eq!(margin.ns(), 250 * US);
        let floor = EarlyWake {
            min: Duration::from_micros(100),
            ..EarlyWake::default()
        };
        let mut margin = Margin::new(&floor, PERIOD_NS);
        ticks(&mut margin, steady(3, 544));
        assert_eq!(margin.ns(), 100 * US);
    }

    #[test]
    fn covers_the_configured_share_of_wake_ups() {
        let config = EarlyWake {
            quantile: 0.9,
            guard: Duration::ZERO,
            min: Duration::ZERO,
            ..EarlyWake::default()
        };
        let mut margin = Margin::new(&config, PERIOD_NS);
        // 0 to 199 µs, each as often as the others: nine tenths are below 180.
        ticks(&mut margin, (0..2000).map(|n| (n * 7) % 200));
        assert!(
            (176 * US..=182 * US).contains(&margin.ns()),
            "{}",
            margin.ns()
        );
    }

    #[test]
    fn an_outlier_does_not_move_it() {
        let mut margin = at_40_hz();
        ticks(&mut margin, steady(60, 2048));
        let before_ns = margin.ns();
        let moved = ticks(
            &mut margin,
            steady(200, 4).chain(steady(60, 500)).chain([9_000]),
        );
        assert_eq!((moved, margin.ns()), (0, before_ns));
    }

    #[test]
    fn a_busier_machine_has_an_effect_within_a_second_and_for_a_window() {
        let mut margin = at_40_hz();
        ticks(&mut margin, steady(60, 2048));
        ticks(&mut margin, steady(150, 40));
        assert!(margin.ns() >= 170 * US, "{}", margin.ns());
        ticks(&mut margin, steady(60, 2000));
        assert!(margin.ns() >= 170 * US, "{}", margin.ns());
        ticks(&mut margin, steady(60, 48 + 32));
        assert!(margin.ns() <= 81 * US, "{}", margin.ns());
    }

    #[test]
    fn wake_ups_that_no_margin_reaches_count_only_when_they_are_half_of_all() {
        let mut margin = at_40_hz();
        // Three in ten are milliseconds late: no reason to spend 250 µs.
        let moody = |n: i64| if n % 10 < 3 { 5_000 } else { 60 };
        ticks(&mut margin, (0..2048).map(moody));
        assert!(margin.ns() <= 81 * US, "{}", margin.ns());
        ticks(&mut margin, steady(400, 1200));
        assert_eq!(margin.ns(), 250 * US);
    }

    #[test]
    fn a_small_change_does_not_move_the_margin() {
        let mut margin = at_40_hz();
        ticks(&mut margin, steady(100, 2048));
        assert_eq!(ticks(&mut margin, steady(90, 5000)), 0);
        assert_eq!(ticks(&mut margin, steady(70, 5000)), 1);
    }
}
