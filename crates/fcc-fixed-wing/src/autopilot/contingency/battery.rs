//! The battery: low below a share of its charge, or below a voltage, for a while.

use core::time::Duration;

use super::super::{Autopilot, flags};
use super::Contingency;
use fcc_core::flight::Battery;
use fcc_core::framework::{Flags, Time};

/// A reading is used for so long: batteries change slowly, and some report seldom.
const READING_AGE: Duration = Duration::from_secs(10);

/// Whether a battery is below one of its limits, where it has some; none if that is not
/// known, because what is limited is not measured.
fn is_below(battery: Battery, charge: Option<f64>, voltage_v: Option<f64>) -> Option<bool> {
    let limited = [(charge, battery.charge), (voltage_v, battery.voltage_v)];
    let below = limited.map(|(limit, value)| match (limit, value) {
        (None, _) => Some(false),
        (Some(_), None) => None,
        (Some(limit), Some(value)) => Some(value < limit),
    });
    match below {
        [Some(true), _] | [_, Some(true)] => Some(true),
        [Some(false), Some(false)] => Some(false),
        _ => None,
    }
}

impl Autopilot {
    /// Whether the battery's last reading is below its limits; none if it is not known.
    fn battery_is_below(&self, now: Time) -> Option<bool> {
        let config = &self.config.contingency;
        let battery = self.intake.accepted.battery.fresh(now, READING_AGE);
        is_below(
            battery.unwrap_or_default(),
            config.battery_charge,
            config.battery_voltage_v,
        )
    }

    /// Follows the battery, engaged or not. Without a reading it stays what it was.
    pub(in super::super) fn follow_battery(&mut self, now: Time, dt_s: f64) {
        if let Some(is_below) = self.battery_is_below(now) {
            let after_s = self.config.contingency.battery_after_s;
            self.supervisor.battery.step(is_below, after_s, dt_s);
        }
    }

    /// With a low battery, or one that is limited and not measured, nothing takes off.
    pub(in super::super) fn battery_inhibits(&self, now: Time) -> Flags {
        let is_good = self.battery_is_below(now) == Some(false) && !self.supervisor.battery.is_on;
        Flags::NONE.with(flags::BATTERY, self.waits_for_takeoff() && !is_good)
    }

    /// Acts on a low battery, once; again after the fence was turned away from.
    pub(super) fn meet_low_battery(&mut self) {
        let contingencies = &mut self.supervisor.contingencies;
        let is_at_fence = contingencies.active == Contingency::Fence;
        if !self.supervisor.battery.is_on || is_at_fence {
            contingencies.is_battery_met = false;
        }
        let turns_away =
            is_at_fence && (contingencies.stage.is_on_circle() || contingencies.kept.is_some());
        if self.supervisor.battery.is_on && !contingencies.is_battery_met && !turns_away {
            let action = self.config.contingency.battery;
            self.supervisor.contingencies.is_battery_met =
                self.meet(Contingency::BatteryLow, action);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn battery(voltage_v: Option<f64>, charge: Option<f64>) -> Battery {
        Battery { voltage_v, charge }
    }

    #[test]
    fn either_limit_makes_it_low_and_what_is_not_limited_does_not_matter() {
        let full = battery(Some(12.6), Some(1.0));
        assert_eq!(is_below(full, Some(0.25), Some(10.5)), Some(false));
        assert_eq!(
            is_below(battery(Some(12.6), Some(0.2)), Some(0.25), Some(10.5)),
            Some(true)
        );
        assert_eq!(
            is_below(battery(Some(10.4), None), Some(0.25), Some(10.5)),
            Some(true)
        );
        assert_eq!(is_below(battery(Some(12.6), None), Some(0.25), None), None);
        assert_eq!(is_below(battery(None, None), None, None), Some(false));
    }
}
