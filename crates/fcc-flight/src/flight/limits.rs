//! What an aircraft permits of commanded set points.

use std::ops::RangeInclusive;

use fcc_fixed_wing::AutopilotConfig;
#[cfg(feature = "live")]
use fcc_fixed_wing::Setpoints;
#[cfg(feature = "live")]
use fcc_live::{Commandable, SentCommands};
use fcc_telemetry::PlantLimits;
use fcc_telemetry::units::COMMANDED_ALTITUDE_M;

#[cfg(feature = "live")]
use crate::config::items_of;

/// What an aircraft permits of the set points that are commanded from outside its
/// program.
pub fn setpoint_limits(autopilot: &AutopilotConfig) -> PlantLimits {
    vec![
        ("airspeed_mps", Ok(autopilot.envelope.allowed_airspeeds())),
        ("altitude_m", Ok(altitudes_m(autopilot))),
        (
            "height_m",
            heights_m(autopilot).ok_or(
                "a height needs the elevation of its field: set altimeter.field_elevation_ft in \
                 the configuration, or give an altitude",
            ),
        ),
        (
            "plan_item",
            autopilot
                .plan
                .map(|plan| 0.0..=plan.steps.len() as f64)
                .ok_or("there is no plan: give plan.file in the configuration"),
        ),
    ]
}

/// The plan that is flown, by its hash in the record: its items may be commanded.
#[cfg(feature = "live")]
#[derive(Debug, Default)]
pub(super) struct FlownPlan(u64);

#[cfg(feature = "live")]
impl FlownPlan {
    /// Follows what is flown: a plan that replaced another one has its own items.
    pub(super) fn follow<C: Commandable>(
        &mut self,
        setpoints: &Setpoints,
        commands: &mut SentCommands<C>,
    ) {
        let hash = setpoints.plan_hash;
        if std::mem::replace(&mut self.0, hash) != hash
            && let Some(items) = items_of(hash)
        {
            commands.limit("plan_item", 0.0..=items as f64);
        }
    }
}

/// The altitudes above mean sea level that may be commanded, m: none below the
/// floor and its margin, to a hundredth, as a message gives them.
fn altitudes_m(autopilot: &AutopilotConfig) -> RangeInclusive<f64> {
    above(autopilot, 0.0)
}

/// The heights above the field that may be commanded, m; none if its elevation is
/// not configured.
fn heights_m(autopilot: &AutopilotConfig) -> Option<RangeInclusive<f64>> {
    let elevation_m = autopilot.altimeter.field_elevation_m?;
    Some(above(autopilot, elevation_m))
}

fn above(autopilot: &AutopilotConfig, datum_m: f64) -> RangeInclusive<f64> {
    let lowest_m = autopilot.envelope.lowest_altitude_m();
    lowest_m.map_or(COMMANDED_ALTITUDE_M, |lowest_m| {
        ((lowest_m - datum_m) * 100.0).round() / 100.0..=*COMMANDED_ALTITUDE_M.end()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 ft is 0.3048 m.
    #[test]
    fn the_floor_and_its_margin_limit_altitudes_and_heights() {
        let mut autopilot = AutopilotConfig::default();
        assert_eq!(altitudes_m(&autopilot), -500.0..=20_000.0);
        assert_eq!(heights_m(&autopilot), None);
        autopilot.envelope.floor_m = 2_000.0 * 0.304_8;
        autopilot.altimeter.field_elevation_m = Some(1_000.0 * 0.304_8);
        assert_eq!(altitudes_m(&autopilot), 624.84..=20_000.0);
        assert_eq!(heights_m(&autopilot), Some(320.04..=20_000.0));
    }
}
