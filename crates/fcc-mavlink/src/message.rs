//! Messages from the state of the vehicle: units and ranges of MAVLink's `common.xml`.

use mavlink::dialects::common::{
    ATTITUDE_DATA, AUTOPILOT_VERSION_DATA, AVAILABLE_MODES_DATA, AVAILABLE_MODES_MONITOR_DATA,
    CURRENT_MODE_DATA, EXTENDED_SYS_STATE_DATA, GLOBAL_POSITION_INT_DATA, GPS_RAW_INT_DATA,
    GpsFixType, HEARTBEAT_DATA, HIGH_LATENCY2_DATA, HOME_POSITION_DATA, HlFailureFlag,
    MISSION_CURRENT_DATA, MavAutopilot, MavLandedState, MavMessage, MavModeFlag,
    MavProtocolCapability, MavState, MavSysStatusSensor, MavSysStatusSensorExtended, MavType,
    NAV_CONTROLLER_OUTPUT_DATA, SYS_STATUS_DATA, SYSTEM_TIME_DATA, VFR_HUD_DATA, WIND_COV_DATA,
};

use crate::frame::Body;
use crate::mission::Missions;
use crate::mode::{MODES, row_of};
use crate::vehicle::{Identity, Mode, Now, Position, Sensors, VehicleState};

/// Numbers of messages that are asked for by number.
pub(crate) mod id {
    pub(crate) const HEARTBEAT: u32 = 0;
    pub(crate) const SYS_STATUS: u32 = 1;
    pub(crate) const SYSTEM_TIME: u32 = 2;
    pub(crate) const GPS_RAW_INT: u32 = 24;
    pub(crate) const ATTITUDE: u32 = 30;
    pub(crate) const GLOBAL_POSITION_INT: u32 = 33;
    pub(crate) const MISSION_CURRENT: u32 = 42;
    pub(crate) const NAV_CONTROLLER_OUTPUT: u32 = 62;
    pub(crate) const VFR_HUD: u32 = 74;
    pub(crate) const AUTOPILOT_VERSION: u32 = 148;
    pub(crate) const WIND_COV: u32 = 231;
    pub(crate) const HIGH_LATENCY2: u32 = 235;
    pub(crate) const HOME_POSITION: u32 = 242;
    pub(crate) const EXTENDED_SYS_STATE: u32 = 245;
    pub(crate) const AVAILABLE_MODES: u32 = 435;
    pub(crate) const CURRENT_MODE: u32 = 436;
    pub(crate) const AVAILABLE_MODES_MONITOR: u32 = 437;
    /// Of the dialect `development`.
    pub(crate) const CONTROL_STATUS: u32 = 512;
}

/// The version of this software in the encoding of `flight_sw_version`, type "dev".
fn software() -> u32 {
    let parts = env!("CARGO_PKG_VERSION").split(['.', '-']);
    let bytes = parts.map(|part| part.parse::<u8>().unwrap_or(0)).take(3);
    bytes.fold(0, |all, part| all << 8 | u32::from(part)) << 8
}

/// What messages are made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scene<'a> {
    pub(crate) state: &'a VehicleState,
    pub(crate) missions: &'a Missions,
    pub(crate) identity: Identity,
    pub(crate) system: u8,
    pub(crate) now: Now,
}

/// The messages that a request of this number gives; none: there is no such message now.
/// `index` chooses one of several.
pub(crate) fn requested(number: u32, index: u8, scene: &Scene<'_>) -> Vec<Body> {
    if number == id::AVAILABLE_MODES {
        let all = 1..=MODES.len() as u8;
        let chosen = all.filter(|n| index == 0 || index == *n);
        return chosen
            .filter_map(|n| available_mode(n).map(Body::from))
            .collect();
    }
    body(number, scene).into_iter().collect()
}

/// The message of this number.
pub(crate) fn body(number: u32, scene: &Scene<'_>) -> Option<Body> {
    message(number, scene).map(Body::from)
}

/// What tells how it moves: an old state does not.
const OF_MOTION: [u32; 8] = [
    id::GPS_RAW_INT,
    id::ATTITUDE,
    id::GLOBAL_POSITION_INT,
    id::NAV_CONTROLLER_OUTPUT,
    id::VFR_HUD,
    id::WIND_COV,
    id::HIGH_LATENCY2,
    id::EXTENDED_SYS_STATE,
];

fn message(number: u32, scene: &Scene<'_>) -> Option<MavMessage> {
    let state = scene.state;
    if state.is_old && OF_MOTION.contains(&number) {
        return None;
    }
    let ms = scene.now.ms as u32;
    let us = scene.now.utc_us;
    Some(match number {
        id::HEARTBEAT => MavMessage::HEARTBEAT(heartbeat(scene)),
        id::SYS_STATUS => MavMessage::SYS_STATUS(sys_status(state)),
        id::SYSTEM_TIME => MavMessage::SYSTEM_TIME(SYSTEM_TIME_DATA {
            time_unix_usec: us,
            time_boot_ms: ms,
        }),
        id::GPS_RAW_INT => MavMessage::GPS_RAW_INT(gps_raw_int(state, us)),
        id::ATTITUDE => MavMessage::ATTITUDE(ATTITUDE_DATA {
            time_boot_ms: ms,
            roll: state.attitude.roll_rad as f32,
            pitch: state.attitude.pitch_rad as f32,
            yaw: wrap_pi(state.attitude.heading_rad) as f32,
            rollspeed: state.attitude.rates_radps[0] as f32,
            pitchspeed: state.attitude.rates_radps[1] as f32,
            yawspeed: state.attitude.rates_radps[2] as f32,
        }),
        id::GLOBAL_POSITION_INT => MavMessage::GLOBAL_POSITION_INT(global_position_int(state, ms)?),
        id::MISSION_CURRENT => MavMessage::MISSION_CURRENT(mission_current(scene)),
        id::NAV_CONTROLLER_OUTPUT => {
            MavMessage::NAV_CONTROLLER_OUTPUT(nav_controller_output(state))
        }
        id::VFR_HUD => MavMessage::VFR_HUD(VFR_HUD_DATA {
            airspeed: state.motion.airspeed_mps as f32,
            groundspeed: ground_speed_mps(state) as f32,
            alt: state.motion.position.unwrap_or_default().altitude_m as f32,
            climb: state.motion.climb_mps as f32,
            heading: degrees_360(state.attitude.heading_rad) as i16,
            throttle: percent(state.flight.throttle).into(),
        }),
        id::AUTOPILOT_VERSION => MavMessage::AUTOPILOT_VERSION(autopilot_version(scene)),
        id::WIND_COV => MavMessage::WIND_COV(wind_cov(state, us)?),
        id::HIGH_LATENCY2 => MavMessage::HIGH_LATENCY2(high_latency2(scene)),
        id::HOME_POSITION => MavMessage::HOME_POSITION(home_position(state, us)?),
        id::EXTENDED_SYS_STATE => MavMessage::EXTENDED_SYS_STATE(EXTENDED_SYS_STATE_DATA {
            landed_state: landed(state),
            ..EXTENDED_SYS_STATE_DATA::DEFAULT
        }),
        id::CURRENT_MODE => {
            let row = row_of(state.flight.mode);
            MavMessage::CURRENT_MODE(CURRENT_MODE_DATA {
                standard_mode: row.standard,
                custom_mode: row.custom_mode(),
                intended_custom_mode: 0,
            })
        }
        id::AVAILABLE_MODES_MONITOR => {
            MavMessage::AVAILABLE_MODES_MONITOR(AVAILABLE_MODES_MONITOR_DATA { seq: 1 })
        }
        _ => return None,
    })
}

/// One mode, counted from 1.
fn available_mode(number: u8) -> Option<MavMessage> {
    let row = MODES.get(usize::from(number).checked_sub(1)?)?;
    Some(MavMessage::AVAILABLE_MODES(AVAILABLE_MODES_DATA {
        custom_mode: row.custom_mode(),
        properties: row.properties(),
        number_modes: MODES.len() as u8,
        mode_index: number,
        standard_mode: row.standard,
        mode_name: row.name.into(),
    }))
}

const fn autopilot(identity: Identity) -> MavAutopilot {
    match identity {
        Identity::Generic => MavAutopilot::MAV_AUTOPILOT_GENERIC,
        Identity::Px4 => MavAutopilot::MAV_AUTOPILOT_PX4,
    }
}

fn heartbeat(scene: &Scene<'_>) -> HEARTBEAT_DATA {
    let flight = &scene.state.flight;
    let mut base_mode = MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED;
    if flight.is_engaged {
        base_mode |= MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED
            | MavModeFlag::MAV_MODE_FLAG_STABILIZE_ENABLED
            | MavModeFlag::MAV_MODE_FLAG_GUIDED_ENABLED;
        if !matches!(flight.mode, Mode::Hold) {
            base_mode |= MavModeFlag::MAV_MODE_FLAG_AUTO_ENABLED;
        }
    } else {
        base_mode |= MavModeFlag::MAV_MODE_FLAG_MANUAL_INPUT_ENABLED;
    }
    HEARTBEAT_DATA {
        custom_mode: row_of(flight.mode).custom_mode(),
        mavtype: MavType::MAV_TYPE_FIXED_WING,
        autopilot: autopilot(scene.identity),
        base_mode,
        system_status: match (
            scene.state.is_connected,
            flight.is_failsafe || scene.state.is_old,
            flight.is_engaged,
        ) {
            (false, ..) => MavState::MAV_STATE_UNINIT,
            (_, true, _) => MavState::MAV_STATE_CRITICAL,
            (_, _, true) => MavState::MAV_STATE_ACTIVE,
            _ => MavState::MAV_STATE_STANDBY,
        },
        mavlink_version: 3,
    }
}

fn sys_status(state: &VehicleState) -> SYS_STATUS_DATA {
    type Sensor = MavSysStatusSensor;
    let [present, healthy] = state.health.sensors.map(|sensors: Sensors| {
        let inertial = Sensor::MAV_SYS_STATUS_SENSOR_3D_GYRO
            | Sensor::MAV_SYS_STATUS_SENSOR_3D_ACCEL
            | Sensor::MAV_SYS_STATUS_AHRS;
        [
            (sensors.inertial, inertial),
            (
                sensors.barometer,
                Sensor::MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE,
            ),
            (
                sensors.airspeed,
                Sensor::MAV_SYS_STATUS_SENSOR_DIFFERENTIAL_PRESSURE,
            ),
            (sensors.gnss, Sensor::MAV_SYS_STATUS_SENSOR_GPS),
            (sensors.compass, Sensor::MAV_SYS_STATUS_SENSOR_3D_MAG),
        ]
        .into_iter()
        .filter(|(is_there, _)| *is_there)
        .fold(Sensor::empty(), |all, (_, bits)| all | bits)
    });
    let check = Sensor::MAV_SYS_STATUS_PREARM_CHECK;
    let may = !state.is_old && (state.health.may_engage || state.flight.is_engaged);
    let healthy = if state.is_old {
        Sensor::empty()
    } else {
        healthy
    };
    let charge = state.health.battery_charge;
    // MAVProxy takes a fence that is not healthy for a breach, also where there is none.
    let healthy = healthy | Sensor::MAV_SYS_STATUS_GEOFENCE;
    SYS_STATUS_DATA {
        onboard_control_sensors_present: present | check,
        onboard_control_sensors_enabled: present | check,
        onboard_control_sensors_health: if may { healthy | check } else { healthy },
        voltage_battery: state
            .health
            .battery_v
            .map_or(u16::MAX, |v| (v * 1e3) as u16),
        current_battery: -1,
        onboard_control_sensors_present_extended: MavSysStatusSensorExtended::empty(),
        onboard_control_sensors_enabled_extended: MavSysStatusSensorExtended::empty(),
        onboard_control_sensors_health_extended: MavSysStatusSensorExtended::empty(),
        battery_remaining: charge.map_or(-1, |charge| percent(charge) as i8),
        ..SYS_STATUS_DATA::DEFAULT
    }
}

fn gps_raw_int(state: &VehicleState, us: u64) -> GPS_RAW_INT_DATA {
    let mut raw = GPS_RAW_INT_DATA {
        time_usec: us,
        eph: u16::MAX,
        epv: u16::MAX,
        vel: u16::MAX,
        cog: u16::MAX,
        satellites_visible: u8::MAX,
        fix_type: GpsFixType::GPS_FIX_TYPE_NO_FIX,
        ..GPS_RAW_INT_DATA::DEFAULT
    };
    let is_measured = state.health.sensors[1].gnss;
    if let Some(position) = state.motion.position.filter(|_| is_measured) {
        (raw.lat, raw.lon, raw.alt) = (
            degrees_e7(position.latitude_rad),
            degrees_e7(position.longitude_rad),
            millimetres(position.altitude_m),
        );
        raw.fix_type = GpsFixType::GPS_FIX_TYPE_3D_FIX;
        raw.vel = (ground_speed_mps(state) * 100.0) as u16;
        raw.cog = (degrees_360(course_rad(state)) * 100.0) as u16;
        let uncertainty_mm = state.motion.position_uncertainty_m.map(millimetres);
        raw.h_acc = uncertainty_mm.map_or(0, |mm| mm as u32);
    }
    raw
}

fn global_position_int(state: &VehicleState, ms: u32) -> Option<GLOBAL_POSITION_INT_DATA> {
    let position = state.motion.position?;
    let above_home_m = position.altitude_m - home_altitude_m(state);
    let [north_mps, east_mps] = state.motion.north_east_mps;
    Some(GLOBAL_POSITION_INT_DATA {
        time_boot_ms: ms,
        lat: degrees_e7(position.latitude_rad),
        lon: degrees_e7(position.longitude_rad),
        alt: millimetres(position.altitude_m),
        relative_alt: millimetres(above_home_m),
        vx: (north_mps * 100.0) as i16,
        vy: (east_mps * 100.0) as i16,
        vz: (-state.motion.climb_mps * 100.0) as i16,
        hdg: (degrees_360(state.attitude.heading_rad) * 100.0) as u16,
    })
}

pub(crate) fn mission_current(scene: &Scene<'_>) -> MISSION_CURRENT_DATA {
    let [mission_id, fence_id, rally_points_id] = scene.missions.opaque_ids();
    MISSION_CURRENT_DATA {
        seq: scene.missions.current(scene.state),
        total: scene.missions.total(),
        mission_state: scene.missions.state(scene.state),
        mission_mode: if scene.state.flies_mission() { 1 } else { 2 },
        mission_id,
        fence_id,
        rally_points_id,
    }
}

fn nav_controller_output(state: &VehicleState) -> NAV_CONTROLLER_OUTPUT_DATA {
    let flight = &state.flight;
    let [roll_rad, pitch_rad, course_rad] = flight.roll_pitch_course_rad;
    let course_deg = wrap_pi(course_rad).to_degrees() as i16;
    let altitude_m = state.motion.position.unwrap_or_default().altitude_m;
    NAV_CONTROLLER_OUTPUT_DATA {
        nav_roll: roll_rad.to_degrees() as f32,
        nav_pitch: pitch_rad.to_degrees() as f32,
        alt_error: (flight.altitude_m - altitude_m) as f32,
        aspd_error: (flight.airspeed_mps - state.motion.airspeed_mps) as f32,
        xtrack_error: flight.cross_track_m as f32,
        nav_bearing: course_deg,
        target_bearing: course_deg,
        wp_dist: flight.to_go_m as u16,
    }
}

fn autopilot_version(scene: &Scene<'_>) -> AUTOPILOT_VERSION_DATA {
    type Capability = MavProtocolCapability;
    AUTOPILOT_VERSION_DATA {
        capabilities: Capability::MAV_PROTOCOL_CAPABILITY_MISSION_INT
            | Capability::MAV_PROTOCOL_CAPABILITY_COMMAND_INT
            | Capability::MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST
            | Capability::MAV_PROTOCOL_CAPABILITY_MAVLINK2
            | Capability::MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
            | Capability::MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
            | Capability::MAV_PROTOCOL_CAPABILITY_COMPONENT_ACCEPTS_GCS_CONTROL,
        flight_sw_version: software(),
        uid: scene.system.into(),
        ..AUTOPILOT_VERSION_DATA::DEFAULT
    }
}

fn wind_cov(state: &VehicleState, us: u64) -> Option<WIND_COV_DATA> {
    let [north_mps, east_mps] = state.motion.wind_mps?;
    // NaN: not known.
    Some(WIND_COV_DATA {
        time_usec: us,
        wind_x: north_mps as f32,
        wind_y: east_mps as f32,
        wind_z: f32::NAN,
        var_horiz: f32::NAN,
        var_vert: f32::NAN,
        wind_alt: state.motion.position?.altitude_m as f32,
        horiz_accuracy: f32::NAN,
        vert_accuracy: f32::NAN,
    })
}

fn home_position(state: &VehicleState, us: u64) -> Option<HOME_POSITION_DATA> {
    let home = state.home?;
    Some(HOME_POSITION_DATA {
        latitude: degrees_e7(home.latitude_rad),
        longitude: degrees_e7(home.longitude_rad),
        altitude: millimetres(home.altitude_m),
        x: f32::NAN,
        y: f32::NAN,
        z: f32::NAN,
        q: [f32::NAN; 4],
        approach_x: f32::NAN,
        approach_y: f32::NAN,
        approach_z: f32::NAN,
        time_usec: us,
    })
}

fn high_latency2(scene: &Scene<'_>) -> HIGH_LATENCY2_DATA {
    let state = scene.state;
    let position = state.motion.position.unwrap_or_default();
    let [wind_north_mps, wind_east_mps] = state.motion.wind_mps.unwrap_or_default();
    let half_degrees = |rad: f64| (degrees_360(rad) / 2.0) as u8;
    let fifths = |mps: f64| (mps * 5.0) as u8;
    let [present, healthy] = state.health.sensors;
    let mut failures = HlFailureFlag::empty();
    if present.gnss && !healthy.gnss {
        failures |= HlFailureFlag::HL_FAILURE_FLAG_GPS;
    }
    if present.airspeed && !healthy.airspeed {
        failures |= HlFailureFlag::HL_FAILURE_FLAG_DIFFERENTIAL_PRESSURE;
    }
    HIGH_LATENCY2_DATA {
        timestamp: scene.now.ms as u32,
        latitude: degrees_e7(position.latitude_rad),
        longitude: degrees_e7(position.longitude_rad),
        // Its upper half, as PX4 sends it.
        custom_mode: (row_of(state.flight.mode).custom_mode() >> 16) as u16,
        altitude: position.altitude_m as i16,
        target_altitude: state.flight.altitude_m as i16,
        target_distance: (state.flight.to_go_m / 10.0) as u16,
        wp_num: scene.missions.current(state),
        failure_flags: failures,
        mavtype: MavType::MAV_TYPE_FIXED_WING,
        autopilot: autopilot(scene.identity),
        heading: half_degrees(state.attitude.heading_rad),
        target_heading: half_degrees(state.flight.roll_pitch_course_rad[2]),
        throttle: percent(state.flight.throttle),
        airspeed: fifths(state.motion.airspeed_mps),
        airspeed_sp: fifths(state.flight.airspeed_mps),
        groundspeed: fifths(ground_speed_mps(state)),
        windspeed: fifths(wind_north_mps.hypot(wind_east_mps)),
        // Where it comes from.
        wind_heading: half_degrees((-wind_east_mps).atan2(-wind_north_mps)),
        eph: u8::MAX,
        epv: u8::MAX,
        temperature_air: i8::MIN,
        climb_rate: (state.motion.climb_mps * 10.0) as i8,
        battery: state
            .health
            .battery_charge
            .map_or(-1, |charge| percent(charge) as i8),
        // Whether control is held, which its mode does not say.
        custom0: i8::from(state.flight.is_engaged),
        custom1: 0,
        custom2: 0,
    }
}

const fn landed(state: &VehicleState) -> MavLandedState {
    match (
        state.is_connected,
        state.flight.mode,
        state.flight.is_airborne,
    ) {
        (false, ..) => MavLandedState::MAV_LANDED_STATE_UNDEFINED,
        (_, _, false) => MavLandedState::MAV_LANDED_STATE_ON_GROUND,
        (_, Mode::Takeoff, _) => MavLandedState::MAV_LANDED_STATE_TAKEOFF,
        (_, Mode::Land, _) => MavLandedState::MAV_LANDED_STATE_LANDING,
        _ => MavLandedState::MAV_LANDED_STATE_IN_AIR,
    }
}

/// Of home, or of mean sea level without one.
pub(crate) fn home_altitude_m(state: &VehicleState) -> f64 {
    state.home.map_or(0.0, |home: Position| home.altitude_m)
}

fn ground_speed_mps(state: &VehicleState) -> f64 {
    let [north_mps, east_mps] = state.motion.north_east_mps;
    north_mps.hypot(east_mps)
}

fn course_rad(state: &VehicleState) -> f64 {
    let [north_mps, east_mps] = state.motion.north_east_mps;
    east_mps.atan2(north_mps)
}

/// Degrees times 10⁷.
fn degrees_e7(rad: f64) -> i32 {
    (rad.to_degrees() * 1e7).round() as i32
}

fn millimetres(m: f64) -> i32 {
    (m * 1e3).round() as i32
}

fn percent(share: f64) -> u8 {
    (share.clamp(0.0, 1.0) * 100.0).round() as u8
}

/// 0 to 360.
fn degrees_360(rad: f64) -> f64 {
    rad.to_degrees().rem_euclid(360.0)
}

/// -π to π.
fn wrap_pi(rad: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    (rad + turn / 2.0).rem_euclid(turn) - turn / 2.0
}
