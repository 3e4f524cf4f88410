//! The envelope in which the controls are deflected: beyond it the aircraft is
//! handed back.

use crate::bench::{Bench, Stop, failed};
use crate::watched::Watched;

/// The state at the begin, and what must be kept.
pub(crate) struct Envelope {
    pitch_deg: f64,
    airspeed_kt: f64,
}

const MOST_BANK_DEG: f64 = 25.0;
const MOST_PITCH_DEG: f64 = 8.0;
const LOADS_G: std::ops::RangeInclusive<f64> = 0.4..=1.7;
const LEAST_AIRSPEED: f64 = 0.85;

impl Envelope {
    pub(crate) fn now(bench: &Bench<'_>) -> Self {
        Self {
            pitch_deg: bench.number(Watched::Pitch),
            airspeed_kt: bench.number(Watched::Airspeed),
        }
    }

    pub(crate) fn check(&self, bench: &Bench<'_>) -> Result<(), Stop> {
        let bank = bench.number(Watched::Roll).abs();
        let pitch = (bench.number(Watched::Pitch) - self.pitch_deg).abs();
        let airspeed = bench.number(Watched::Airspeed);
        let load = bench.number(Watched::LoadNormal);
        let within = bank <= MOST_BANK_DEG
            && pitch <= MOST_PITCH_DEG
            && airspeed >= LEAST_AIRSPEED * self.airspeed_kt
            && (load.is_nan() || LOADS_G.contains(&load));
        if within {
            return Ok(());
        }
        failed(format!(
            "ended outside the envelope: bank {bank:.0}°, pitch changed by {pitch:.0}°, \
             {airspeed:.0} kt, load {load:.1} g"
        ))
    }
}
