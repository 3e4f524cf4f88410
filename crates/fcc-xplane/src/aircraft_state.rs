//! What the aircraft reports beside its motion, a value each: pressure, wheels,
//! height, engine, battery.

use fcc_core::flight::{Battery, Measurements};
use fcc_core::framework::Reading;

use crate::values::{Group, Values};

/// Publishes what arrived since the last call.
pub(crate) fn publish(values: &mut Values, into: &mut Measurements) {
    if let Some(([pressure_pa], taken)) = values.whole(Group::DifferentialPressure) {
        into.differential_pressure_pa = Reading::new(pressure_pa, taken);
    }
    if let Some(([on_ground], taken)) = values.whole(Group::Wheels) {
        into.weight_on_wheels = Reading::new(on_ground, taken);
    }
    if let Some(([height_m], taken)) = values.whole(Group::Height) {
        into.range_m = Reading::new(height_m, taken);
    }
    if let Some(([speed_radps], taken)) = values.whole(Group::EngineSpeed) {
        into.engine_speed_radps = Reading::new(speed_radps, taken);
    }
    if let Some(([volts], taken)) = values.whole(Group::BatteryVoltage) {
        let battery = Battery {
            voltage_v: Some(volts),
            charge: None,
        };
        into.battery = Reading::new(battery, taken);
    }
}
