//! The thesis' measurements, to compare a flight with.
//!
//! Tables 6.1 to 6.3 and the text of section 6.1 on figures 6.1 to 6.3: a POSIX
//! timer on a Samsung Galaxy Nexus of 2012.

use serde::Serialize;

use super::box_plot::BoxPlot;
use fcc_telemetry::{Lateness, Period, Realtime, TimingReport};

/// The thesis' figures at one rate.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct ThesisFigures {
    /// Nominal rate.
    pub rate_hz: f64,
    /// Duration of the measurement, s.
    pub runtime_s: f64,
    /// Mean period, ms.
    pub mean_ms: f64,
    /// Median period, ms.
    pub median_ms: f64,
    /// Shortest period, ms.
    pub min_ms: f64,
    /// Longest period, ms.
    pub max_ms: f64,
    /// Half of the periods lie between these, ms, from the text.
    pub half_between_ms: (f64, f64),
    /// Missed periods.
    pub missed: u64,
}

const FIGURES: [ThesisFigures; 3] = [
    ThesisFigures {
        rate_hz: 40.0,
        runtime_s: 67.90,
        mean_ms: 25.0001,
        median_ms: 24.994,
        min_ms: 16.785,
        max_ms: 32.593,
        half_between_ms: (24.75, 25.25),
        missed: 0,
    },
    ThesisFigures {
        rate_hz: 50.0,
        runtime_s: 68.84,
        mean_ms: 20.0000,
        median_ms: 19.989,
        min_ms: 10.559,
        max_ms: 28.565,
        half_between_ms: (19.75, 20.25),
        missed: 0,
    },
    ThesisFigures {
        rate_hz: 100.0,
        runtime_s: 55.60,
        mean_ms: 10.0002,
        median_ms: 10.009,
        min_ms: 3.662,
        max_ms: 17.121,
        half_between_ms: (9.5, 10.5),
        missed: 0,
    },
];

impl ThesisFigures {
    /// The thesis' figures at a rate, if it measured there.
    pub fn at(rate_hz: f64) -> Option<Self> {
        FIGURES
            .into_iter()
            .find(|figures| (figures.rate_hz - rate_hz).abs() < 0.5)
    }

    /// As a column of the timing table.
    pub fn timing(&self) -> TimingReport {
        TimingReport {
            rate_hz: self.rate_hz,
            timer: "thesis".to_owned(),
            ticks: (self.runtime_s * self.rate_hz) as u64,
            missed: self.missed,
            runtime_s: self.runtime_s,
            period_ms: Period {
                mean: self.mean_ms,
                median: self.median_ms,
                min: self.min_ms,
                max: self.max_ms,
                range: self.max_ms - self.min_ms,
                within_2_percent: f64::NAN,
            },
            lateness_us: Lateness {
                p50: f64::NAN,
                p99: f64::NAN,
                p99_9: f64::NAN,
                max: f64::NAN,
            },
            realtime: Realtime::default(),
            cpu_percent: None,
            page_faults: None,
            early_wake: None,
        }
    }

    /// As a box plot; the whiskers reach the extremes where the text does not
    /// give their ends.
    pub(super) fn box_plot(&self) -> BoxPlot {
        let (q1, q3) = self.half_between_ms;
        BoxPlot {
            min: self.min_ms,
            whisker_low: self.min_ms,
            q1,
            median: self.median_ms,
            q3,
            whisker_high: self.max_ms,
            max: self.max_ms,
            outlier_count: 0,
            outliers: Vec::new(),
        }
    }
}
