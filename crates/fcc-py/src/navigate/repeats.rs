//! A source that repeats one sample while others show motion.

use super::kind::{Kind, Series};

/// What others show of motion: the root mean square of rates, rad/s, and of forces, m/s²,
/// beside their mean.
const TURNING: f64 = 0.05;
const SHAKEN: f64 = 0.5;
/// Three axes repeat a sample by chance no longer than this, s; a barometer of a coarse
/// resolution may for longer, in level flight.
const VECTOR_S: f64 = 10.0;
const PRESSURE_S: f64 = 60.0;

/// Whether a source shows the same to the last bit for long, while the gyroscope turns, or of
/// a gyroscope, the accelerometer is shaken.
pub(super) fn repeats(
    (kind, series): (&Kind, &Series),
    gyroscope: Option<&Series>,
    accelerometer: Option<&Series>,
) -> Option<String> {
    let (least_s, other, least, shows) = match kind.name {
        "gyroscope" => (VECTOR_S, accelerometer?, SHAKEN, "accelerometer"),
        "accelerometer" | "magnetometer" => (VECTOR_S, gyroscope?, TURNING, "gyroscope"),
        "static_pressure" => (PRESSURE_S, gyroscope?, TURNING, "gyroscope"),
        _ => return None,
    };
    let (from_s, to_s) = longest(series)?;
    let is_repeated = to_s - from_s >= least_s && varies(other, from_s, to_s) > least;
    is_repeated.then(|| {
        format!(
            "{}: it repeats one sample to the last bit for {:.0} s, from {from_s} s on, while the \
             {shows} shows motion: was it read?",
            kind.name,
            to_s - from_s
        )
    })
}

/// The longest time in which a source shows the same, s.
fn longest(series: &Series) -> Option<(f64, f64)> {
    let mut longest: Option<(f64, f64)> = None;
    let mut open: Option<(f64, [f64; 3])> = None;
    for (time_s, row) in series.times_s.iter().zip(&series.rows) {
        let since_s = match open {
            Some((since_s, same)) if same == *row => since_s,
            _ => *time_s,
        };
        open = Some((since_s, *row));
        if longest.is_none_or(|(from_s, to_s)| time_s - since_s > to_s - from_s) {
            longest = Some((since_s, *time_s));
        }
    }
    longest
}

/// The root mean square of samples beside their mean, in this time.
fn varies(other: &Series, from_s: f64, to_s: f64) -> f64 {
    let (mut n, mut sum, mut squares) = (0.0, [0.0; 3], 0.0);
    for (time_s, row) in other.times_s.iter().zip(&other.rows) {
        if (from_s..=to_s).contains(time_s) && row.iter().all(|one| one.is_finite()) {
            n += 1.0;
            for (sum, one) in sum.iter_mut().zip(row) {
                *sum += one;
                squares += one * one;
            }
        }
    }
    let mean: f64 = sum.iter().map(|sum| (sum / n).powi(2)).sum();
    (squares / n - mean).sqrt()
}
