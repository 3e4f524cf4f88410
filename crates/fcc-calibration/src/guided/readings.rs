//! The readings of a tick, each once.

use fcc_core::flight::{GnssFix, Measurements};
use fcc_core::framework::{Reading, Time};

/// What arrived since the last tick; nothing of a sensor that gave nothing new.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Arrived {
    /// When the newest was taken.
    pub(super) at: Time,
    /// m/s².
    pub(super) force: Option<[f64; 3]>,
    /// rad/s.
    pub(super) rates: Option<[f64; 3]>,
    /// When these were taken.
    pub(super) rates_at: Time,
    /// µT.
    pub(super) field: Option<[f64; 3]>,
    pub(super) differential_pa: Option<f64>,
    pub(super) temperature_k: Option<f64>,
    pub(super) gnss: Option<GnssFix>,
}

/// Finds what is new in the measurements.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Arrivals {
    seen: Seen,
    newest: Time,
}

/// When each was last taken.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    force: Time,
    rates: Time,
    field: Time,
    differential: Time,
    temperature: Time,
    gnss: Time,
}

impl Arrivals {
    pub(super) fn take(&mut self, from: &Measurements) -> Arrived {
        let (seen, newest) = (&mut self.seen, &mut self.newest);
        let force = new(&mut seen.force, newest, &from.raw_specific_force);
        let rates = new(&mut seen.rates, newest, &from.raw_body_rates);
        let field = new(&mut seen.field, newest, &from.magnetic_field);
        Arrived {
            force: force.map(|f| [f.x_mps2, f.y_mps2, f.z_mps2]),
            rates: rates.map(|r| [r.roll_radps, r.pitch_radps, r.yaw_radps]),
            field: field.map(|m| [m.x_ut, m.y_ut, m.z_ut]),
            differential_pa: new(
                &mut seen.differential,
                newest,
                &from.differential_pressure_pa,
            ),
            temperature_k: new(&mut seen.temperature, newest, &from.air_temperature_k),
            gnss: new(&mut seen.gnss, newest, &from.gnss),
            rates_at: self.seen.rates,
            at: self.newest,
        }
    }
}

/// The value of a reading that is younger than the last.
fn new<T: Copy>(seen: &mut Time, newest: &mut Time, reading: &Reading<T>) -> Option<T> {
    if reading.taken <= *seen {
        return None;
    }
    *seen = reading.taken;
    *newest = reading.taken.max(*newest);
    Some(reading.value)
}
