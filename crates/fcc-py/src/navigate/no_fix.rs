//! Samples of a receiver that are no fix: what it shows without one, and what it repeats.

use std::collections::HashSet;

use super::kind::Series;

/// What moves faster than this, m/s, is not where it was.
const MOVING_MPS: f64 = 2.0;

/// The times, as bits, at which a receiver shows zeros, or its last place or velocity to the
/// last bit while it moves.
pub(super) fn times(position: Option<&Series>, velocity: Option<&Series>) -> HashSet<u64> {
    let mut without = HashSet::new();
    let fast: HashSet<u64> = velocity
        .into_iter()
        .flat_map(timed)
        .filter(|(_, [north, east, down])| north.hypot(*east).hypot(*down) > MOVING_MPS)
        .map(|(time, _)| time)
        .collect();
    for (series, is_position) in [(position, true), (velocity, false)] {
        let mut last = None;
        for (time, row) in series.into_iter().flat_map(timed) {
            let [latitude_rad, longitude_rad, _] = row;
            let is_nowhere = is_position && latitude_rad == 0.0 && longitude_rad == 0.0;
            let is_repeated = last == Some(row) && fast.contains(&time);
            if is_nowhere || is_repeated {
                without.insert(time);
            }
            last = Some(row);
        }
    }
    without
}

fn timed(series: &Series) -> impl Iterator<Item = (u64, [f64; 3])> {
    let times = series.times_s.iter().map(|time_s| time_s.to_bits());
    times.zip(series.rows.iter().copied())
}
