//! What a user should know before a flight begins.

use fcc_fixed_wing::AutopilotConfig;

use super::x_plane::InputChoice;
use super::{BuiltInSection, Config, NavigationMethod, RawSensorsChoice};

impl Config {
    /// What keeps the aircraft from engaging, what is watched and not measured, and what is
    /// worth a look in the plan.
    pub fn remarks_at_start(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        if let Some(section) = &self.built_in
            && section.raw_sensors == RawSensorsChoice::None
            && !self.has_inertial_unit()
            && self.navigation.method != NavigationMethod::Measured
        {
            remarks.push(
                "navigation.method computes attitude from raw readings, and built-in.raw_sensors \
                 is \"none\", its default: nothing will engage; choose \"board\" or \"phone\" for \
                 them, or \"measured\" for the method"
                    .to_owned(),
            );
        }
        remarks.extend(self.start_airspeed_remark());
        if self.built_in.as_ref().is_some_and(|start| start.on_runway) && !self.flies_plan() {
            remarks.push(
                "built-in.on_runway is true, and only a plan takes off: nothing will engage; choose \
                 guidance.mode = \"plan\", or fly with --plan FILE"
                    .to_owned(),
            );
        }
        if self.has_board()
            && self.is_without_simulator()
            && self.navigation.method == NavigationMethod::Measured
        {
            remarks.push(
                "the sensors of a board give raw readings, and navigation.method is \"measured\", \
                 its default: nothing will engage; choose \"kalman\""
                    .to_owned(),
            );
        }
        remarks.extend(self.airspeed_remark());
        remarks.extend(self.latency_remark());
        remarks.extend(self.unmeasured_limits());
        if let Some(plan) = self.plan.plan().filter(|_| self.flies_plan()) {
            let file = self.plan.file.as_ref();
            let of = file.map(|file| format!("plan.file: {}: ", file.display()));
            let of = of.unwrap_or_default();
            let found = self.plan_remarks(plan);
            remarks.extend(found.iter().map(|remark| format!("{of}{remark}")));
        }
        remarks
    }

    /// The airspeed at which the built-in aircraft starts in the air, if it is outside the
    /// envelope.
    fn start_airspeed_remark(&self) -> Option<String> {
        let start = self.built_in.as_ref().filter(|start| !start.on_runway)?;
        let envelope = &self.autopilot.envelope;
        let (at, least, most) = (
            start.airspeed_kt,
            envelope.min_airspeed_kt,
            envelope.max_airspeed_kt,
        );
        let is_default = at == BuiltInSection::default().airspeed_kt;
        let default = if is_default { ", the default" } else { "" };
        (!(least..=most).contains(&at)).then(|| {
            format!(
                "built-in.airspeed_kt is {at}{default}, and the envelope's airspeeds are {least} to {most} \
                 kt: engaging is refused until the aircraft flies within them"
            )
        })
    }

    /// The greatest latency for the gains of an aircraft in which nothing measures it, as long
    /// as none is given.
    fn latency_remark(&self) -> Option<String> {
        let config = self.autopilot_config();
        let greatest_s = config.unmeasured_latency_s()?;
        let is_default = config.assumed_latency_s == AutopilotConfig::default().assumed_latency_s;
        is_default.then(|| {
            format!(
                "autopilot.pace is {}, and below 0.8 the latency is not measured in flight: from \
                 {:.0} ms on the pitch may oscillate; set autopilot.assumed_latency_ms to the time \
                 from an output to its effect",
                config.pace,
                1e3 * greatest_s,
            )
        })
    }

    /// Limits of `[contingency]` for what no sensor of the configuration measures. X-Plane's
    /// datarefs have the voltage of a battery and the speed of an engine, the built-in aircraft
    /// also the charge, and nothing else has.
    fn unmeasured_limits(&self) -> Vec<String> {
        if self.built_in.is_some() {
            return Vec::new();
        }
        let section = &self.contingency;
        let has_datarefs = self
            .x_planes()
            .any(|(_, section)| section.input == InputChoice::Rref);
        let low = "before a take-off it does not engage, and in flight a low battery is not found; \
                   take the limit out";
        let out = "an engine that is out is not found; set contingency.engine_out_by_thrust = \
                   true, or take the limit out";
        let limits = [
            (
                "battery_charge_percent",
                section.battery_charge_percent,
                "the charge of a battery",
                low,
            ),
            (
                "battery_voltage_v",
                section.battery_voltage_v.filter(|_| !has_datarefs),
                "the voltage of a battery",
                low,
            ),
            (
                "engine_out_below_rpm",
                section
                    .engine_out_below_rpm
                    .filter(|_| !has_datarefs && !section.engine_out_by_thrust),
                "the speed of an engine",
                out,
            ),
        ];
        let limits = limits.into_iter();
        let without = limits.filter_map(|(key, limit, what, so)| {
            let limit = limit?;
            Some(format!(
                "contingency.{key} is {limit}, and no sensor here measures {what}: {so}"
            ))
        });
        without.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Config;

    #[test]
    fn a_start_outside_the_envelope_is_remarked_on() {
        let remarks = |keys: &str| {
            let text = format!("[built-in]\n{keys}\n");
            Config::parse(&text, "f").unwrap().remarks_at_start()
        };
        let [remark] = &remarks("airspeed_kt = 50.0")[..] else {
            panic!("one remark");
        };
        assert!(remark.contains("65 to 135 kt"), "{remark}");
        assert_eq!(remarks("airspeed_kt = 66.0"), [""; 0]);
        let [remark] = &remarks("airspeed_kt = 50.0\non_runway = true")[..] else {
            panic!("one remark");
        };
        assert!(remark.contains("only a plan takes off"), "{remark}");
    }

    /// As JSBSim's OV10, which oscillates from 125 ms on, and not with 75.
    #[test]
    fn an_aircraft_whose_latency_is_not_measured_is_remarked_on() {
        let remarks = |keys: &str| {
            let text = format!("[built-in]\n[autopilot]\n{keys}\n");
            Config::parse(&text, "f").unwrap().remarks_at_start()
        };
        let [remark] = &remarks("scale.pace = 0.675")[..] else {
            panic!("one remark");
        };
        assert!(remark.contains("from 119 ms on"), "{remark}");
        for keys in [
            "scale.pace = 0.9",
            "scale.pace = 0.675\nassumed_latency_ms = 150",
        ] {
            assert_eq!(remarks(keys), [""; 0], "{keys}");
        }
    }
}
