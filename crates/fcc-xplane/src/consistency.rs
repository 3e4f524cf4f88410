//! Whether X-Plane's values contradict each other.
//!
//! A simulator knows the truth beside what its instruments show, so a pitot tube
//! that is blocked by ice or a failed instrument can be found here; a real
//! aircraft has no such truth.

use core::time::Duration;

use fcc_core::flight::{SpecificForce, Suspect};
use fcc_core::framework::Time;

use crate::lasting::Lasting;
use crate::quantity::Quantity;
use crate::units::{GRAVITY_MPS2, KNOT_MPS};
use crate::values::Values;

/// The density of air at sea level in the standard atmosphere, kg/m³ (ISO 2533,
/// 1975).
const SEA_LEVEL_DENSITY_KGPM3: f64 = 1.225;

/// Indicated airspeed may differ from equivalent airspeed by compressibility, 7 %
/// at Mach 0.8 and 35,000 ft, and by the error of the pitot tube at a high angle
/// of attack.
const AIRSPEED_TOLERANCE: f64 = 0.2;
const AIRSPEED_TOLERANCE_MPS: f64 = 20.0 * KNOT_MPS;
/// Below this equivalent airspeed nothing is compared.
const AIRSPEED_FROM_MPS: f64 = 40.0 * KNOT_MPS;
/// A difference of load factors beyond rounding and the difference of a frame in
/// gusts, in g.
const LOAD_TOLERANCE: f64 = 0.3;

/// A contradiction counts once it has lasted for this long, and until it has
/// been absent for as long: a gust, or a value a frame older, is none.
const LASTS: Duration = Duration::from_secs(3);

/// Compares X-Plane's values with each other.
#[derive(Clone, Debug)]
pub(crate) struct ConsistencyCheck {
    airspeed: Lasting,
    load: Lasting,
}

impl Default for ConsistencyCheck {
    fn default() -> Self {
        Self {
            airspeed: Lasting::new(LASTS, LASTS),
            load: Lasting::new(LASTS, LASTS),
        }
    }
}

impl ConsistencyCheck {
    /// Evaluates the latest values, and the specific force that was computed
    /// from the local accelerations; what is not known is not suspect.
    pub(crate) fn step(
        &mut self,
        now: Time,
        values: &Values,
        computed: Option<SpecificForce>,
    ) -> Suspect {
        let recent = |quantity| values.recent(quantity, now);
        let airspeed = recent(Quantity::Airspeed)
            .zip(recent(Quantity::TrueAirspeed))
            .zip(recent(Quantity::AirDensity))
            .is_some_and(|((indicated, airspeed), density)| {
                airspeeds_differ(indicated, airspeed, density)
            });
        let load = recent(Quantity::LoadFactor)
            .zip(computed)
            .is_some_and(|(load_mps2, force)| {
                (load_mps2 + force.z_mps2).abs() > LOAD_TOLERANCE * GRAVITY_MPS2
            });
        Suspect {
            airspeed: self.airspeed.step(now, airspeed),
            specific_force: self.load.step(now, load),
        }
    }
}

/// Equivalent airspeed is true airspeed times the root of the density ratio
/// (Stevens, Lewis and Johnson, Aircraft Control and Simulation, 3rd ed. 2016).
fn airspeeds_differ(indicated_mps: f64, true_mps: f64, density_kgpm3: f64) -> bool {
    let equivalent_mps = true_mps * (density_kgpm3 / SEA_LEVEL_DENSITY_KGPM3).sqrt();
    let tolerance_mps = AIRSPEED_TOLERANCE_MPS.max(AIRSPEED_TOLERANCE * equivalent_mps);
    equivalent_mps >= AIRSPEED_FROM_MPS && (indicated_mps - equivalent_mps).abs() > tolerance_mps
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of the standard atmosphere at 10,000 ft (ISO 2533).
    const DENSITY_AT_10000_FT: f64 = 0.9046;
    const TICK: Duration = Duration::from_millis(25);

    /// Suspect after this many seconds of these values.
    fn after(seconds: u32, values: &[(Quantity, f64)], computed_z_mps2: Option<f64>) -> Suspect {
        let mut check = ConsistencyCheck::default();
        let mut known = Values::default();
        let mut now = Time::from_nanos(1_000_000_000);
        let mut suspect = Suspect::default();
        for _ in 0..=seconds * 40 {
            now = now + TICK;
            for (quantity, value) in values {
                known.set(*quantity, *value, now);
            }
            let force = computed_z_mps2.map(|z_mps2| SpecificForce {
                z_mps2,
                ..SpecificForce::default()
            });
            suspect = check.step(now, &known, force);
        }
        suspect
    }

    /// 100 kt indicated at 10,000 ft are 116.4 kt true, by pilots' tables.
    #[test]
    fn an_iced_pitot_tube_is_suspect_after_three_seconds_and_a_sound_one_is_not() {
        let at = |seconds, indicated_kt: f64| {
            let values = [
                (Quantity::Airspeed, indicated_kt * KNOT_MPS),
                (Quantity::TrueAirspeed, 116.4 * KNOT_MPS),
                (Quantity::AirDensity, DENSITY_AT_10000_FT),
            ];
            after(seconds, &values, None).airspeed
        };
        for sound in [85.0, 100.0, 115.0] {
            assert!(!at(10, sound), "{sound} kt");
        }
        for iced in [0.0, 60.0, 140.0] {
            assert!(!at(2, iced) && at(3, iced), "{iced} kt");
        }
    }

    #[test]
    fn a_parked_aircraft_in_wind_and_an_x_plane_without_density_are_not_suspect() {
        let parked = [
            (Quantity::Airspeed, 0.0),
            (Quantity::TrueAirspeed, 15.0 * KNOT_MPS),
            (Quantity::AirDensity, 1.225),
        ];
        assert!(!after(10, &parked, None).airspeed);
        assert!(
            !after(
                10,
                &[(Quantity::Airspeed, 0.0), (Quantity::TrueAirspeed, 60.0)],
                None
            )
            .airspeed
        );
    }

    /// A 60° banked turn loads an aircraft with 2 g (FAA-H-8083-25C, chapter 5);
    /// accelerations that contain gravity would give 1 g more or less.
    #[test]
    fn accelerations_that_contain_gravity_contradict_the_load_factor() {
        let turn = [(Quantity::LoadFactor, 2.0 * GRAVITY_MPS2)];
        assert!(!after(10, &turn, Some(-19.6)).specific_force);
        assert!(!after(2, &turn, Some(-9.8)).specific_force);
        assert!(after(3, &turn, Some(-9.8)).specific_force);
        assert!(after(3, &turn, Some(-29.4)).specific_force);
        assert!(!after(10, &[], Some(-29.4)).specific_force);
    }
}
