//! A lead-acid battery, and the alternator that charges it while the engine turns.
//!
//! A Cessna 172's: 28 V of the alternator, which gives 60 A, on a battery of 24 V
//! (handbook, section 7) with 12.75 Ah. A cell without load has the specific gravity of its
//! acid and 0.84 V (Linden and Reddy, *Handbook of Batteries*, 2002, ch. 23), 1.28 when it
//! is full and 1.12 when it is empty.

use core::f64::consts::TAU;

/// The voltage while the alternator feeds.
const ALTERNATOR_V: f64 = 28.0;
/// The most that the alternator gives.
const ALTERNATOR_A: f64 = 60.0;
/// From this speed of the engine on it feeds: 800 rpm, rad/s.
const FEEDS_RADPS: f64 = 800.0 * TAU / 60.0;
/// The voltage of 12 cells without load, full and empty.
const FULL_V: f64 = 12.0 * (1.28 + 0.84);
const EMPTY_V: f64 = 12.0 * (1.12 + 0.84);
const RESISTANCE_OHM: f64 = 0.02;
const HOUR_S: f64 = 3_600.0;

/// The electrical system as configured.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Electrical {
    /// What a full battery gives, Ah, more than 0.
    pub capacity_ah: f64,
    /// The share of it that is left at the start, 0..=1.
    pub charge: f64,
    /// What everything on board takes, A, 0..=60.
    pub load_a: f64,
    /// When the alternator fails, s of simulated time; none: never.
    pub alternator_stops_at_s: Option<f64>,
}

impl Default for Electrical {
    fn default() -> Self {
        Self {
            capacity_ah: 12.75,
            charge: 1.0,
            load_a: 15.0,
            alternator_stops_at_s: None,
        }
    }
}

/// The battery in flight.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Battery {
    system: Electrical,
    charge: f64,
    is_fed: bool,
}

impl Battery {
    /// At the start.
    pub fn new(system: Electrical) -> Self {
        Self {
            system,
            charge: system.charge,
            is_fed: false,
        }
    }

    /// Takes the load, or charges with what the alternator has left, but in an hour at least,
    /// until a time; the engine turns at this speed.
    pub fn step(&mut self, dt_s: f64, time_s: f64, engine_radps: f64) {
        let system = &self.system;
        let failed = system
            .alternator_stops_at_s
            .is_some_and(|stops_s| time_s >= stops_s);
        self.is_fed = !failed && engine_radps >= FEEDS_RADPS;
        let current_a = if self.is_fed {
            (ALTERNATOR_A - system.load_a).min(system.capacity_ah)
        } else {
            -system.load_a
        };
        let change = current_a * dt_s / (HOUR_S * system.capacity_ah);
        self.charge = (self.charge + change).clamp(0.0, 1.0);
    }

    /// What is left, 0 empty, 1 full.
    pub fn charge(&self) -> f64 {
        self.charge
    }

    /// The voltage that it and what it feeds have; an empty one has none.
    pub fn voltage_v(&self) -> f64 {
        if self.is_fed {
            ALTERNATOR_V
        } else if self.charge > 0.0 {
            let cells_v = EMPTY_V + (FULL_V - EMPTY_V) * self.charge;
            (cells_v - RESISTANCE_OHM * self.system.load_a).max(0.0)
        } else {
            0.0
        }
    }
}
