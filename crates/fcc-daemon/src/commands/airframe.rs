//! `fccd airframe`: the keys of an airframe, scaled from what was measured of it.
//!
//! The gains were tuned on a Cessna 172. By similarity a control's rate is as V over
//! span or tail arm, the acceleration by throttle as thrust over weight, and times as
//! the root of the size (Froude).

use std::fmt::Write as _;

use fcc_flight::config::Config;
use serde::Serialize;
use serde_json::Value;

use super::failure::Failure;
use crate::cli::AirframeArgs;
use crate::exit::Exit;
use crate::output;

const MPS_PER_KT: f64 = 1852.0 / 3600.0;
const FPM_PER_MPS: f64 = 60.0 / 0.3048;
const GRAVITY_MPS2: f64 = 9.80665;
/// Of the standard atmosphere at sea level.
const AIR_KGPM3: f64 = 1.225;
/// Of a wing without flaps, before it stalls.
const GREATEST_LIFT: f64 = 1.3;
/// A Cessna 172's: rates by full aileron and elevator times span and tail arm over V,
/// thrust over weight in cruise, span.
const AILERON_PER_S: f64 = 4.7;
const ELEVATOR_PER_S: f64 = 10.7;
const THRUST: f64 = 0.34;
const SPAN_M: f64 = 11.0;
/// What a propeller keeps of its static thrust in cruise.
const LEFT_IN_CRUISE: f64 = 0.6;
/// Rolling friction on grass.
const FRICTION: f64 = 0.1;
/// g times the tangent of 30° of bank.
const TURN_MPS2: f64 = 5.66;

/// A key, its value, and where that comes from.
#[derive(Serialize)]
struct Row {
    key: &'static str,
    value: Value,
    why: String,
}

pub(super) fn airframe(args: &AirframeArgs) -> Result<Exit, Failure> {
    let rows = rows(args);
    let text = text(&rows);
    Config::parse_without_aircraft(&text, "the scaled airframe").map_err(|error| {
        Failure::usage(format_args!(
            "fccd: what was measured does not fit together: {error}"
        ))
    })?;
    Ok(if args.json {
        output::json(&rows, Exit::Success)
    } else {
        output::result(text, Exit::Success)
    })
}

fn row(key: &'static str, value: impl Into<Value>, why: impl Into<String>) -> Row {
    Row {
        key,
        value: value.into(),
        why: why.into(),
    }
}

fn rows(of: &AirframeArgs) -> Vec<Row> {
    let stall_kt = of.stall_kt.unwrap_or_else(|| {
        let (mass, area) = (of.mass_kg.unwrap_or(0.0), of.wing_area_m2.unwrap_or(1.0));
        let lift = AIR_KGPM3 * area * GREATEST_LIFT;
        ((2.0 * mass * GRAVITY_MPS2 / lift).sqrt() / MPS_PER_KT).round()
    });
    let cruise_kt = of.cruise_kt.unwrap_or(2.0 * stall_kt);
    let scaled = Scaled {
        of,
        stall_kt,
        cruise_kt,
        cruise_mps: cruise_kt * MPS_PER_KT,
        glide_kt: (1.4 * stall_kt).round(),
        thrust: LEFT_IN_CRUISE * of.thrust_over_weight,
    };
    let mut rows = Vec::from(scaled.control());
    rows.extend(scaled.envelope());
    rows.extend(scaled.runway());
    rows.extend(scaled.plan());
    rows
}

/// What the keys follow from.
struct Scaled<'a> {
    of: &'a AirframeArgs,
    stall_kt: f64,
    cruise_kt: f64,
    cruise_mps: f64,
    glide_kt: f64,
    /// Over weight, in cruise.
    thrust: f64,
}

impl Scaled<'_> {
    fn control(&self) -> [Row; 7] {
        let (span_m, mps) = (self.of.span_m, self.cruise_mps);
        let arm_m = self.of.tail_arm_m.unwrap_or(0.5 * span_m);
        let elevator = hundredth(ELEVATOR_PER_S * arm_m / mps);
        [
            row(
                "autopilot.reference_airspeed_kt",
                self.cruise_kt,
                "cruise, V",
            ),
            row(
                "autopilot.trim",
                false,
                "until an elevator trim is measured",
            ),
            row(
                "autopilot.scale.aileron",
                hundredth(AILERON_PER_S * span_m / mps),
                format!("{AILERON_PER_S} / ({mps:.1} m/s / {span_m} m): V over span"),
            ),
            row(
                "autopilot.scale.elevator",
                elevator,
                format!("{ELEVATOR_PER_S} / ({mps:.1} m/s / {arm_m} m): V over tail arm"),
            ),
            row("autopilot.scale.rudder", elevator, "as the elevator"),
            row(
                "autopilot.scale.throttle",
                hundredth(THRUST / self.thrust),
                format!(
                    "{THRUST} / {:.2}: thrust over weight in cruise",
                    self.thrust
                ),
            ),
            row(
                "autopilot.scale.pace",
                hundredth((SPAN_M / span_m).sqrt().min(1.0)),
                "the root of 11 m over span, 1 at most",
            ),
        ]
    }

    fn envelope(&self) -> [Row; 15] {
        let (stall_kt, of) = (self.stall_kt, self.of);
        let never_exceed_kt = of.never_exceed_kt.unwrap_or((1.8 * self.cruise_kt).round());
        let margin_kt = (0.1 * self.cruise_kt).floor().max(2.0);
        // A third of the excess: 720 ft/min for a Cessna 172, as its handbook says.
        let climb_mps = (self.thrust - 1.0 / of.glide_ratio).max(0.0) * self.cruise_mps / 3.0;
        let sink_mps = self.glide_kt * MPS_PER_KT / of.glide_ratio;
        [
            row(
                "autopilot.envelope.stall_airspeed_kt",
                stall_kt,
                "at the greatest weight, Vs",
            ),
            row(
                "autopilot.envelope.min_airspeed_kt",
                (1.2 * stall_kt).round(),
                "1.2 Vs",
            ),
            row(
                "autopilot.envelope.max_airspeed_kt",
                (never_exceed_kt - 3.0 * margin_kt).round(),
                "three margins below Vne",
            ),
            row(
                "autopilot.envelope.never_exceed_airspeed_kt",
                never_exceed_kt,
                "Vne",
            ),
            row(
                "autopilot.envelope.maneuvering_airspeed_kt",
                (stall_kt * of.load_limit_g.sqrt()).round(),
                "Vs times the root of the limit load",
            ),
            row(
                "autopilot.envelope.best_glide_airspeed_kt",
                self.glide_kt,
                "1.4 Vs",
            ),
            row("autopilot.envelope.airspeed_margin_kt", margin_kt, "V / 10"),
            row(
                "autopilot.envelope.max_climb_fpm",
                fifties_fpm(climb_mps),
                "a third of what thrust and glide ratio permit",
            ),
            row(
                "autopilot.envelope.max_sink_fpm",
                fifties_fpm(sink_mps),
                "a glide at idle",
            ),
            row(
                "autopilot.envelope.max_bank_deg",
                30.0,
                "for the first flights",
            ),
            row(
                "autopilot.envelope.max_load_factor_g",
                2.0,
                "for the first flights",
            ),
            row(
                "autopilot.envelope.limit_load_factor_g",
                of.load_limit_g,
                "the structure's",
            ),
            row(
                "autopilot.envelope.limit_negative_load_factor_g",
                -(4.0 * of.load_limit_g).round() / 10.0,
                "0.4 times",
            ),
            row(
                "autopilot.envelope.max_angle_of_attack_deg",
                10.0,
                "below the stall's",
            ),
            row(
                "autopilot.airspeed.trim_throttle",
                of.cruise_throttle,
                "level flight in cruise",
            ),
        ]
    }

    fn runway(&self) -> [Row; 11] {
        let (stall_kt, span_m) = (self.stall_kt, self.of.span_m);
        let touch_mps = 1.3 * stall_kt * MPS_PER_KT;
        let roll_m = touch_mps * touch_mps / (2.0 * FRICTION * GRAVITY_MPS2);
        [
            row(
                "autopilot.runway.rotate_kt",
                (1.15 * stall_kt).round(),
                "1.15 Vs",
            ),
            row(
                "autopilot.runway.climb_kt",
                (1.5 * stall_kt).round(),
                "1.5 Vs",
            ),
            row("autopilot.runway.approach_kt", self.glide_kt, "1.4 Vs"),
            row(
                "autopilot.runway.longest_roll_m",
                tens(roll_m),
                "from 1.3 Vs on grass, without a brake",
            ),
            row(
                "autopilot.runway.steering_radius_m",
                span_m,
                "the span, until measured",
            ),
            row(
                "autopilot.runway.height_on_wheels_m",
                hundredth(0.1 * span_m),
                "a tenth of the span, until measured",
            ),
            row("autopilot.runway.brake", 0.0, "none"),
            row(
                "autopilot.runway.decision_height_ft",
                100.0,
                "for your runway",
            ),
            row(
                "autopilot.runway.most_cross_track_m",
                5.0,
                "for your runway",
            ),
            row("autopilot.runway.most_off_path_m", 8.0, "for your runway"),
            row(
                "autopilot.runway.most_off_airspeed_kt",
                (0.2 * self.glide_kt).floor().max(3.0),
                "a fifth of the approach",
            ),
        ]
    }

    fn plan(&self) -> [Row; 6] {
        let wind_kt = (0.3 * self.cruise_kt).floor();
        let mps = self.cruise_mps + wind_kt * MPS_PER_KT;
        [
            row(
                "plan.wind_kt",
                wind_kt,
                "the strongest that plans are checked for",
            ),
            row(
                "plan.loiter_radius_m",
                tens(1.25 * mps * mps / TURN_MPS2),
                "1.25 (V + wind)^2 / 5.66",
            ),
            row("plan.return_height_ft", 200.0, "over home, for your field"),
            row("plan.service_ceiling_ft", 3000.0, "for your airspace"),
            row("contingency.glide_ratio", self.of.glide_ratio, "at idle"),
            row(
                "contingency.glide_spare_ft",
                60.0,
                "height to spare over a place",
            ),
        ]
    }
}

/// Lines of TOML, a table for each section.
fn text(rows: &[Row]) -> String {
    let mut text = "# The airframe.\n".to_owned();
    let mut before = "";
    for Row { key, value, why } in rows {
        let (section, name) = key.rsplit_once('.').unwrap_or(("", key));
        if section != before {
            let gap = if before.is_empty() { "" } else { "\n" };
            let _ = writeln!(text, "{gap}[{section}]");
            before = section;
        }
        let line = format!("{name} = {value}");
        let _ = writeln!(text, "{line:<39} # {why}");
    }
    text
}

fn hundredth(value: f64) -> f64 {
    (100.0 * value).round() / 100.0
}

fn tens(value: f64) -> f64 {
    10.0 * (0.1 * value).ceil()
}

fn fifties_fpm(mps: f64) -> f64 {
    (50.0 * (mps * FPM_PER_MPS / 50.0).floor()).max(50.0)
}
