//! Whether pressures and a receiver are in the same units: heights, and velocities through the
//! air and over the ground.

use fcc_core::flight::atmosphere::{density_ratio, pressure_altitude_m};
use fcc_core::units::FOOT_M;

use super::kind::{Kind, Series};
use super::plausible::CLEARLY;

/// Fewer samples, or of less time, s, say nothing.
const LEAST: usize = 20;
const LEAST_S: f64 = 60.0;
/// A barometer and a receiver differ by less than this, m: by weather and a geoid.
const APART_M: f64 = 1_000.0;
/// Heights that change by more than this, root mean square, m, show their unit by it.
const CLIMBED_M: f64 = 20.0;
/// What moves faster than this, m/s, flies.
const FLYING_MPS: f64 = 5.0;
/// The velocity over the ground of what turns in a steady wind varies by no more than its
/// airspeed, root mean square: so many times as much and by some gusts, m/s, is another unit.
const VARIES: f64 = 2.0;
const GUSTS_MPS: f64 = 5.0;
/// Without turns: no wind of this strength, m/s, and so many times the slower of both, lasts for
/// half of a flight.
const GALE_MPS: f64 = 30.0;
const FASTER: f64 = 2.5;
/// A true airspeed, and the velocity over the ground to the north and east, m/s.
type Pair = (f64, [f64; 2]);

/// Density at sea level, kg/m³ (ISO 2533).
const DENSITY: f64 = 1.225;

/// Whether altitudes of a receiver are those of the barometer in ft.
pub(super) fn in_feet((kind, position): (&Kind, &Series), barometer: &Series) -> Option<String> {
    let mut pressures = Latest::of(barometer);
    let mut heights: Vec<(f64, f64)> = Vec::new();
    for (time_s, row) in position.times_s.iter().zip(&position.rows) {
        if let (Some([pressure, ..]), true) = (pressures.at(*time_s), kind.is_possible(row)) {
            heights.push((row[2], pressure_altitude_m(pressure)));
        }
    }
    heights.retain(|(_, by_pressure)| by_pressure.is_finite());
    let n = heights.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| heights.iter().map(of).sum::<f64>() / n;
    let means = (mean(|(shown, _)| *shown), mean(|(_, pressure)| *pressure));
    // The root mean square of what is left in a unit, of heights or of how they change.
    let left = |metres: f64, (shown_0, pressure_0): (f64, f64)| -> f64 {
        let apart = heights.iter().map(|(shown, pressure)| {
            (metres * (shown - shown_0) - (pressure - pressure_0)).powi(2)
        });
        (apart.sum::<f64>() / n).sqrt()
    };
    let is_in_feet = |least_m: f64, from: (f64, f64)| {
        let given = left(1.0, from);
        given > least_m && given > CLEARLY * left(FOOT_M, from)
    };
    let has_climbed = left(0.0, means) > CLIMBED_M;
    let is_other = is_in_feet(APART_M, (0.0, 0.0)) || (has_climbed && is_in_feet(CLIMBED_M, means));
    (heights.len() >= LEAST && is_other).then(|| {
        "gnss_position: altitudes agree with static_pressure if they are in ft: they are in m"
            .to_owned()
    })
}

/// Whether an airspeed and a velocity over the ground differ by more than any wind.
pub(super) fn airspeed(
    (kind, air): (&Kind, &Series),
    velocity: &Series,
    barometer: Option<&Series>,
) -> Option<String> {
    let is_pressure = match kind.name {
        "airspeed" => false,
        "differential_pressure" => true,
        _ => return None,
    };
    let (mut grounds, mut pressures) = (Latest::of(velocity), barometer.map(Latest::of));
    let mut pairs: Vec<Pair> = Vec::new();
    let (mut first_s, mut last_s) = (f64::INFINITY, 0.0);
    for (time_s, row) in air.times_s.iter().zip(&air.rows) {
        let Some([north, east, _]) = grounds.at(*time_s) else {
            continue;
        };
        if north.hypot(east).is_nan() || north.hypot(east) < FLYING_MPS || !kind.is_possible(row) {
            continue;
        }
        let [shown, ..] = row;
        let equivalent = if is_pressure {
            (2.0 * shown.max(0.0) / DENSITY).sqrt()
        } else {
            shown.max(0.0)
        };
        let pressure = pressures
            .as_mut()
            .and_then(|pressures| pressures.at(*time_s));
        let density = pressure.map(|[pascals, ..]| density_ratio(pressure_altitude_m(pascals)));
        let density = density.filter(|density| *density > 0.0).unwrap_or(1.0);
        pairs.push((equivalent / density.sqrt(), [north, east]));
        (first_s, last_s) = (first_s.min(*time_s), *time_s);
    }
    if pairs.len() < LEAST || last_s - first_s < LEAST_S {
        return None;
    }
    let n = pairs.len() as f64;
    let mean = |of: &dyn Fn(&Pair) -> f64| pairs.iter().map(of).sum::<f64>() / n;
    let (north, east) = (mean(&|(_, v)| v[0]), mean(&|(_, v)| v[1]));
    let varies = mean(&|(_, v)| (v[0] - north).powi(2) + (v[1] - east).powi(2)).sqrt();
    let allowed = VARIES * mean(&|(air, _)| air * air).sqrt() + GUSTS_MPS;
    let middle = |of: fn(&Pair) -> f64| -> f64 {
        let mut all: Vec<f64> = pairs.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    let (through, over) = (middle(|(air, _)| *air), middle(|(_, v)| v[0].hypot(v[1])));
    let is_gale =
        (through - over).abs() > GALE_MPS && through.max(over) > FASTER * through.min(over);
    let question = match (is_pressure, through < over) {
        (true, true) => "it is in Pa; is it in hPa, or is the tube covered?",
        (true, false) => "it is in Pa; is it in another unit?",
        (false, _) => "it is in m/s; is it in another unit, or is the tube covered?",
    };
    (varies > allowed || is_gale).then(|| {
        format!(
            "{}: the middle airspeed is {through:.1} m/s, and that over the ground {over:.1} m/s, \
             by more than any wind: {question}",
            kind.name
        )
    })
}

/// The latest sample of a source at times that increase.
struct Latest<'a> {
    series: &'a Series,
    next: usize,
}

impl<'a> Latest<'a> {
    fn of(series: &'a Series) -> Self {
        Self { series, next: 0 }
    }

    fn at(&mut self, time_s: f64) -> Option<[f64; 3]> {
        let later = self.series.times_s.iter().skip(self.next);
        self.next += later.take_while(|taken_s| **taken_s <= time_s).count();
        self.series.rows.get(self.next.checked_sub(1)?).copied()
    }
}
