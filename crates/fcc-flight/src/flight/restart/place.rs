//! Where a simulated aircraft was when its flight was interrupted: it may have
//! been moved since, or another flight was loaded.

use std::time::Duration;

use fcc_core::flight::{Measurements, Plant, PlantState, Position};
use fcc_core::framework::{Reading, Time};
use fcc_fixed_wing::can_be_reached;

/// Readings older than this are not stored: the aircraft has flown on.
const MAX_AGE: Duration = Duration::from_secs(1);
/// A clock that is behind by less was not set back, s: what is stored, and what
/// arrives first, may be that much apart.
const SET_BACK_S: f64 = 1.0;

/// A value and the sensor that it came from.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Sourced<T> {
    pub(super) value: T,
    pub(super) source: u8,
}

/// Where the aircraft was, as far as it was known.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct SavedPlace {
    /// The plant's time, s.
    pub(super) plant_time_s: Option<Sourced<f64>>,
    pub(super) position: Option<Sourced<Position>>,
}

impl SavedPlace {
    pub(super) fn of(measured: &Measurements, now: Time) -> Self {
        let (plant, position) = (&measured.plant, &measured.position);
        Self {
            plant_time_s: plant
                .fresh(now, MAX_AGE)
                .filter(|plant| plant.state != PlantState::Replaying && plant.time_s.is_finite())
                .map(|is| sourced(is.time_s, plant)),
            position: position
                .fresh(now, MAX_AGE)
                .filter(|is| is.latitude_rad.is_finite() && is.longitude_rad.is_finite())
                .map(|is| sourced(is, position)),
        }
    }
}

const fn sourced<T, U>(value: U, of: &Reading<T>) -> Sourced<U> {
    Sourced {
        value,
        source: of.source,
    }
}

/// What the sensors say about the place since the start.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PresentPlace {
    plant: Reading<Plant>,
    /// The latest position and the one before: a single one may be wrong.
    positions: [Reading<Position>; 2],
}

/// Whether the flight can be continued at the present place.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Continuity {
    /// Nothing is against it.
    Given,
    /// It is not known yet.
    Unknown,
    /// The plant's clock was set back.
    SetBack,
    /// The aircraft cannot have flown to where it is.
    Moved,
}

impl PresentPlace {
    pub(super) fn take(&mut self, measured: &Measurements) {
        self.plant = measured.plant;
        if measured.position.taken > self.positions[0].taken {
            self.positions = [measured.position, self.positions[0]];
        }
    }

    /// Compares with what was stored `age` ago. The clocks and positions of two
    /// sensors are not compared.
    pub(super) fn continues(&self, saved: &SavedPlace, age: Duration) -> Continuity {
        if let Some(was) = saved.plant_time_s {
            if self.plant.is_never() {
                return Continuity::Unknown;
            }
            let is_same = self.plant.source == was.source;
            if is_same && self.plant.value.time_s < was.value - SET_BACK_S {
                return Continuity::SetBack;
            }
        }
        let Some(was) = saved.position else {
            return Continuity::Given;
        };
        let [latest, before] = self.positions.map(|is| {
            let near =
                is.source != was.source || can_be_reached(&is.value, &was.value, age.as_secs_f64());
            (!is.is_never()).then_some(near)
        });
        match (latest, before) {
            (Some(true), _) => Continuity::Given,
            (Some(false), Some(false)) => Continuity::Moved,
            _ => Continuity::Unknown,
        }
    }
}
