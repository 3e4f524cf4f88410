//! Statistics against another program and against the thesis' tables.

use std::time::Duration;

use super::*;

const NOMINAL: Duration = Duration::from_millis(25);
const NOMINAL_NS: i64 = 25_000_000;

/// The wake-ups of a timer that starts at 0 and has these latenesses, ns.
fn recorded(lateness_ns: impl IntoIterator<Item = i64>) -> TimingSummary {
    let mut stats = TimingStats::new(NOMINAL).unwrap();
    for (number, late) in (1_i64..).zip(lateness_ns) {
        stats.record(&Expiry {
            number: number as u64,
            scheduled_ns: number * NOMINAL_NS,
            woke_ns: number * NOMINAL_NS + late,
            ..Expiry::default()
        });
    }
    stats.summary()
}

/// A timer with these periods, ns, from a first wake-up that was on time.
fn with_periods(nominal: Duration, periods_ns: &[i64]) -> TimingSummary {
    let mut stats = TimingStats::new(nominal).unwrap();
    let mut expiry = Expiry {
        number: 1,
        scheduled_ns: nominal.as_nanos() as i64,
        woke_ns: nominal.as_nanos() as i64,
        ..Expiry::default()
    };
    stats.record(&expiry);
    for period_ns in periods_ns {
        expiry.number += 1;
        expiry.scheduled_ns += nominal.as_nanos() as i64;
        expiry.woke_ns += period_ns;
        stats.record(&expiry);
    }
    stats.summary()
}

#[track_caller]
fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!(
        (value - expected).abs() <= tolerance,
        "{value} is not {expected} ± {tolerance}"
    );
}

// The expected figures are from numpy 2:
//
//     x, late = 1, []
//     for i in range(2000):
//         x = (1664525 * x + 1013904223) % 2**32
//         late.append(15000 + (x >> 16)**2 // 4000)
//     woke = 25_000_000 * np.arange(1, 2001) + late
//     np.percentile(late, [50, 99, 99.9], method="inverted_cdf")
//     p = np.diff(woke); p.mean(), np.median(p), p.min(), p.max(), np.ptp(p)
//     np.mean(np.abs(p - 25e6) <= 0.02 * 25e6)
#[test]
fn two_thousand_ticks_give_the_figures_of_numpy() {
    // The generator of Numerical Recipes (Press et al., 1992), so that both
    // programs have the same list.
    let mut x = 1_u32;
    let summary = recorded((0..2000).map(|_| {
        x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let high = i64::from(x >> 16);
        15_000 + high * high / 4_000
    }));
    assert_eq!(summary.ticks, 2000);
    assert_near(summary.rate_hz, 40.0, 1e-12);

    // Three figures.
    assert_near(summary.lateness_p50_us, 288.505, 0.3);
    assert_near(summary.lateness_p99_us, 1072.843, 1.0);
    assert_near(summary.lateness_p99_9_us, 1088.119, 1.0);
    // Exact.
    assert_near(summary.lateness_max_us, 1088.217, 1e-9);
    assert_near(summary.period_mean_ms, 25.000_219_307_653_826, 1e-12);
    assert_near(summary.period_min_ms, 23.930_887, 1e-12);
    assert_near(summary.period_max_ms, 26.067_362, 1e-12);
    assert_near(summary.period_range_ms, 2.136_475, 1e-12);
    assert_near(
        summary.period_within_2_percent,
        0.710_855_427_713_856_9,
        1e-15,
    );
    // Three figures of a deviation of 5.211 µs.
    assert_near(summary.period_median_ms, 24.994_789, 0.000_006);
}

// The thesis' tables 6.1 to 6.3: shortest and longest period and their range,
// ms, at 40, 50 and 100 Hz.
#[test]
fn the_range_is_that_of_the_thesis_tables() {
    for (nominal_ms, min_ns, max_ns, range_ms) in [
        (25, 16_785_000, 32_593_000, 15.808),
        (20, 10_559_000, 28_565_000, 18.006),
        (10, 3_662_000, 17_121_000, 13.459),
    ] {
        let nominal = Duration::from_millis(nominal_ms);
        let nominal_ns = nominal.as_nanos() as i64;
        let summary = with_periods(nominal, &[nominal_ns, max_ns, min_ns, nominal_ns]);
        assert_near(summary.period_range_ms, range_ms, 1e-12);
        assert_near(summary.period_min_ms, min_ns as f64 / 1e6, 1e-12);
        assert_near(summary.period_max_ms, max_ns as f64 / 1e6, 1e-12);
        assert_near(summary.period_median_ms, nominal_ms as f64, 1e-12);
    }
}

// Table 6.1 prints a median of 24.994 ms: the third decimal has to be right.
#[test]
fn a_median_period_is_kept_to_a_microsecond() {
    let summary = with_periods(NOMINAL, &[16_785_000, 24_994_000, 32_593_000]);
    assert_eq!(format!("{:.3}", summary.period_median_ms), "24.994");
}

#[test]
fn a_constant_lateness_is_no_error_of_the_period() {
    let summary = recorded([1_000_000; 100]);
    assert_near(summary.lateness_p50_us, 1000.0, 1.0);
    assert_near(summary.period_range_ms, 0.0, 0.0);
    assert_near(summary.period_within_2_percent, 1.0, 0.0);
    // A hundred periods of 25 ms, and the lateness of the last.
    assert_near(summary.runtime_s, 2.501, 1e-12);
}

#[test]
fn two_percent_of_25_ms_is_half_a_millisecond_and_counts_as_within() {
    let summary = with_periods(NOMINAL, &[24_500_000, 25_500_000, 24_499_999, 25_500_001]);
    assert_near(summary.period_within_2_percent, 0.5, 0.0);
}

#[test]
fn no_quantile_lies_outside_of_the_limits() {
    let summary = recorded([1_520_711, 35_001, 1_520_711]);
    assert_near(summary.lateness_p99_9_us, 1520.711, 0.0);
    let summary = with_periods(NOMINAL, &[23_505_364; 3]);
    assert_near(summary.period_median_ms, 23.505_364, 0.0);
}

#[test]
fn misses_add_up() {
    let mut stats = TimingStats::new(NOMINAL).unwrap();
    for (number, missed) in [(1, 0), (4, 2), (5, 0), (10, 4)] {
        stats.record(&Expiry {
            number,
            scheduled_ns: number as i64 * NOMINAL_NS,
            woke_ns: number as i64 * NOMINAL_NS,
            missed,
            ..Expiry::default()
        });
    }
    let summary = stats.summary();
    assert_eq!((summary.ticks, summary.missed), (4, 6));
    assert_near(summary.runtime_s, 0.25, 1e-12);
    assert_near(summary.period_max_ms, 125.0, 1e-12);

    stats.reset();
    assert_eq!((stats.summary().ticks, stats.summary().missed), (0, 0));
    assert!(stats.summary().period_mean_ms.is_nan());
}

#[test]
fn what_was_not_measured_is_not_a_number() {
    let none = recorded([]);
    assert!(none.lateness_p50_us.is_nan() && none.lateness_max_us.is_nan());
    assert!(none.period_mean_ms.is_nan() && none.period_median_ms.is_nan());
    let one = recorded([5_000]);
    assert_near(one.lateness_max_us, 5.0, 1e-12);
    assert!(one.period_min_ms.is_nan() && one.period_range_ms.is_nan());
    assert!(one.period_within_2_percent.is_nan());
}

#[test]
fn an_hour_late_is_still_counted() {
    let summary = recorded([0, 3_600_000_000_000]);
    assert_near(summary.lateness_max_us, 3.6e9, 1e-3);
    assert_near(summary.period_max_ms, 3_600_025.0, 1e-6);
}

#[test]
fn the_memory_is_what_the_documentation_says() {
    let kib_of = |period| {
        let stats = TimingStats::new(period).unwrap();
        let counters = stats.lateness.distinct_values() + stats.deviations.distinct_values();
        counters * size_of::<u32>() / 1024
    };
    assert!(
        (200..=250).contains(&kib_of(NOMINAL)),
        "{}",
        kib_of(NOMINAL)
    );
    let longest = kib_of(Duration::from_secs(3600));
    assert!((400..=450).contains(&longest), "{longest}");
}

/// Counted by hand: periods 24.999, 25.000 twice, 25.001 and 26.5 ms.
#[test]
fn periods_and_latenesses_are_reported_one_by_one() {
    let mut stats = TimingStats::new(NOMINAL).unwrap();
    for (number, woke_ns) in [
        (1, 25_000_000),
        (2, 50_000_000),
        (3, 75_001_000),
        (4, 100_000_000),
        (5, 125_000_000),
        (6, 151_500_000),
    ] {
        stats.record(&Expiry {
            number,
            scheduled_ns: number as i64 * NOMINAL_NS,
            woke_ns,
            ..Expiry::default()
        });
    }
    let periods: Vec<_> = stats.period_counts().collect();
    assert_eq!(
        periods.iter().map(|(_, count)| count).sum::<u64>(),
        5,
        "{periods:?}"
    );
    for ((period_ms, count), (expected_ms, expected_count)) in
        periods
            .into_iter()
            .zip([(24.999, 1), (25.0, 2), (25.001, 1), (26.5, 1)])
    {
        // 0.1 % of the distance from 25 ms.
        assert_near(
            period_ms,
            expected_ms,
            1e-6 + 1e-3 * (expected_ms - 25.0).abs(),
        );
        assert_eq!(count, expected_count);
    }
    let latenesses: Vec<_> = stats.lateness_counts().collect();
    assert_eq!(latenesses.len(), 3, "{latenesses:?}");
    for ((late_us, count), (expected_us, expected_count)) in
        latenesses
            .into_iter()
            .zip([(0.0, 4), (1.0, 1), (1500.0, 1)])
    {
        assert_near(late_us, expected_us, 1e-6 + 1e-3 * expected_us);
        assert_eq!(count, expected_count);
    }
}

/// Ticks at 25, 50, 51 + 1000, 76 + 1000 ms: two periods, of 25 ms each.
#[test]
fn what_is_missing_makes_no_period() {
    let mut stats = TimingStats::new(NOMINAL).unwrap();
    for (number, woke_ns) in [
        (1, 25_000_000),
        (2, 50_000_000),
        (42, 1_051_000_000),
        (43, 1_076_000_000),
    ] {
        if number == 42 {
            stats.interrupt();
        }
        stats.record(&Expiry {
            number,
            scheduled_ns: number as i64 * NOMINAL_NS,
            woke_ns,
            ..Expiry::default()
        });
    }
    let summary = stats.summary();
    assert_eq!(summary.ticks, 4);
    assert_near(summary.period_mean_ms, 25.0, 1e-12);
    assert_near(summary.period_max_ms, 25.0, 1e-12);
    assert_near(summary.period_within_2_percent, 1.0, 1e-12);
    assert_eq!(
        stats.period_counts().map(|(_, count)| count).sum::<u64>(),
        2
    );
    assert_near(summary.runtime_s, 1.076, 1e-12);
}
