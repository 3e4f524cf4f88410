//! The state of an aircraft, from its newest record, for MAVLink.

use std::time::Duration;

use fcc_core::flight::atmosphere::pressure_altitude_m;
use fcc_fixed_wing::flags;
use fcc_guidance::Mode as Guidance;
use fcc_mavlink::{Attitude, Flight, Health, Mode, Motion, Position, Sensors, VehicleState};
use fcc_navigation::inertial::{GeodeticPosition, earth_field_ut};
use fcc_plan::Plan;
use fcc_telemetry::FlightRecord;

/// A sensor that gave nothing for so long is not there.
const FRESH: Duration = Duration::from_secs(2);
/// Without a switch at the wheels, an aircraft that is slower over the ground stands, m/s:
/// slower than any aeroplane flies, but in as much wind.
const STANDS_MPS: f64 = 5.0;
/// `state.phase`.
const ENGAGED: u8 = 1;
const FAILSAFE: u8 = 2;

/// What a record says.
pub(super) fn state(
    record: &FlightRecord,
    plan: Option<&Plan>,
    variation_rad: f64,
) -> VehicleState {
    let now = record.tick.woke;
    let (measured, estimate) = (&record.measurements, &record.estimate);
    let setpoints = &record.setpoints;
    // Above mean sea level by the altimeter, as commands are.
    let datum_m = pressure_altitude_m(setpoints.altimeter_setting_pa);
    let is_position_known =
        estimate.position_uncertainty_m > 0.0 || measured.position.is_fresh(now, FRESH);
    let [latitude_rad, longitude_rad] = if estimate.latitude_rad == 0.0 {
        [
            measured.position.value.latitude_rad,
            measured.position.value.longitude_rad,
        ]
    } else {
        [estimate.latitude_rad, estimate.longitude_rad]
    };
    let position = is_position_known.then_some(Position {
        latitude_rad,
        longitude_rad,
        altitude_m: estimate.altitude_m - datum_m,
    });
    let phase = record.state.phase();
    let speed_mps = estimate.north_mps.hypot(estimate.east_mps);
    let on_wheels = measured.weight_on_wheels.fresh(now, FRESH);
    let battery = measured.battery.fresh(now, FRESH);
    let faults = record.faults | record.engage_inhibits;
    let has = |flag| faults.contains(flag);
    let inertial =
        measured.attitude.is_fresh(now, FRESH) || measured.raw_body_rates.is_fresh(now, FRESH);
    let barometer = measured.altitude_m.is_fresh(now, FRESH)
        || measured.static_pressure_pa.is_fresh(now, FRESH);
    let airspeed = measured.airspeed_mps.is_fresh(now, FRESH)
        || measured.differential_pressure_pa.is_fresh(now, FRESH);
    let gnss = measured.position.is_fresh(now, FRESH) || measured.gnss.is_fresh(now, FRESH);
    let compass =
        measured.heading_rad.is_fresh(now, FRESH) || measured.magnetic_field.is_fresh(now, FRESH);
    let present = Sensors {
        inertial,
        barometer,
        airspeed,
        gnss,
        compass,
    };
    let healthy = Sensors {
        inertial: inertial && !has(flags::DOUBTED_ATTITUDE) && !has(flags::DOUBTED_BODY_RATES),
        barometer: barometer && !has(flags::DOUBTED_ALTITUDE),
        airspeed: airspeed && !has(flags::DOUBTED_AIRSPEED),
        gnss: gnss && !has(flags::DEAD_RECKONING) && !has(flags::IMPOSSIBLE_FIX),
        compass: compass && !has(flags::HEADING) && !has(flags::FROZEN_HEADING),
    };
    VehicleState {
        is_connected: true,
        is_old: false,
        attitude: Attitude {
            roll_rad: estimate.roll_rad,
            pitch_rad: estimate.pitch_rad,
            heading_rad: estimate.heading_rad + variation_rad,
            rates_radps: [
                estimate.body_rates.roll_radps,
                estimate.body_rates.pitch_radps,
                estimate.body_rates.yaw_radps,
            ],
        },
        motion: Motion {
            position,
            north_east_mps: [estimate.north_mps, estimate.east_mps],
            climb_mps: estimate.climb_rate_mps,
            airspeed_mps: estimate.airspeed_mps,
            wind_mps: Some([estimate.wind_north_mps, estimate.wind_east_mps]),
            position_uncertainty_m: Some(estimate.position_uncertainty_m).filter(|m| *m > 0.0),
        },
        flight: Flight {
            mode: mode(setpoints.guidance.mode),
            is_engaged: matches!(phase, ENGAGED | FAILSAFE),
            is_failsafe: phase == FAILSAFE,
            is_airborne: on_wheels.map_or(speed_mps > STANDS_MPS, |on| on < 0.5),
            item: item(setpoints.guidance.mode, setpoints.guidance.item),
            airspeed_mps: setpoints.airspeed_mps,
            altitude_m: setpoints.altitude_m - datum_m,
            roll_pitch_course_rad: [
                setpoints.roll_rad,
                setpoints.pitch_rad,
                setpoints.course_rad,
            ],
            cross_track_m: setpoints.cross_track_m,
            to_go_m: setpoints.to_go_m,
            magnetic_heading_rad: estimate.heading_rad,
            throttle: record.outputs.throttle,
        },
        health: Health {
            may_engage: record.engage_inhibits.is_empty(),
            sensors: [present, healthy],
            battery_v: battery.and_then(|battery| battery.voltage_v),
            battery_charge: battery.and_then(|battery| battery.charge),
        },
        home: home(record, plan),
        plan_hash: setpoints.plan_hash,
    }
}

/// The plan's, or where the aircraft took off.
fn home(record: &FlightRecord, plan: Option<&Plan>) -> Option<Position> {
    let of_plan = plan.and_then(|plan| plan.home).map(|home| Position {
        latitude_rad: home.place.latitude_deg.to_radians(),
        longitude_rad: home.place.longitude_deg.to_radians(),
        altitude_m: home.altitude_m,
    });
    let took_off = &record.setpoints.took_off;
    let is_known = took_off.latitude_rad != 0.0 || took_off.longitude_rad != 0.0;
    of_plan.or(is_known.then_some(Position {
        latitude_rad: took_off.latitude_rad,
        longitude_rad: took_off.longitude_rad,
        altitude_m: took_off.elevation_m,
    }))
}

const fn mode(mode: Guidance) -> Mode {
    match mode {
        Guidance::None => Mode::Standby,
        Guidance::Hold => Mode::Hold,
        Guidance::TimedPattern => Mode::Pattern,
        Guidance::Plan => Mode::Plan,
        Guidance::Loiter => Mode::Loiter,
        Guidance::GoTo => Mode::GoTo,
        Guidance::Return => Mode::Return,
        Guidance::Takeoff => Mode::Takeoff,
        Guidance::Land => Mode::Land,
        Guidance::GoAround => Mode::GoAround,
        Guidance::Glide => Mode::Glide,
    }
}

/// The item of the plan; in a pattern it is a leg.
const fn item(mode: Guidance, item: u32) -> u16 {
    match mode {
        Guidance::None | Guidance::Hold | Guidance::TimedPattern => 0,
        _ if item > u16::MAX as u32 => 0,
        _ => item as u16,
    }
}

/// True less magnetic heading at a place, rad, by the World Magnetic Model; 0 where it gives
/// none.
pub(super) fn variation_rad(position: Position, year: f64) -> f64 {
    let place = GeodeticPosition {
        latitude_rad: position.latitude_rad,
        longitude_rad: position.longitude_rad,
        altitude_m: position.altitude_m,
    };
    let field = earth_field_ut(place, year);
    field.map_or(0.0, |[north_ut, east_ut, _]| east_ut.atan2(north_ut))
}
