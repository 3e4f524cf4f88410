//! Records of any bits at all, and every bit of a record.

use fcc_core::flight::{
    Attitude, BodyRates, Measurements, Plant, PlantState, Position, Setpoints, SpecificForce,
    Surfaces, Velocity,
};
use fcc_core::framework::{Cause, Flags, Reading, StageTimes, State, Switch, Tick, Time};
use fcc_telemetry::FlightRecord;
use proptest::prelude::*;

/// Every bit of a record, where a comparison of floats would take -0 for 0 and
/// nothing for NaN: its `Debug` output with each float as its bits would be
/// long; its fields, one by one, are exact.
pub(crate) fn bits(record: &FlightRecord) -> Vec<u64> {
    let m = &record.measurements;
    let floats = [
        record.tick.dt_s,
        m.attitude.value.pitch_rad,
        m.attitude.value.roll_rad,
        m.heading_rad.value,
        m.body_rates.value.roll_radps,
        m.body_rates.value.pitch_radps,
        m.body_rates.value.yaw_radps,
        m.specific_force.value.x_mps2,
        m.specific_force.value.y_mps2,
        m.specific_force.value.z_mps2,
        m.airspeed_mps.value,
        m.altitude_m.value,
        m.angle_of_attack_rad.value,
        m.position.value.latitude_rad,
        m.position.value.longitude_rad,
        m.position.value.altitude_m,
        m.velocity.value.north_mps,
        m.velocity.value.east_mps,
        m.velocity.value.down_mps,
        m.surfaces.value.throttle,
        m.surfaces.value.elevator,
        m.surfaces.value.aileron,
        m.surfaces.value.rudder,
        m.plant.value.time_s,
        record.setpoints.airspeed_mps,
        record.setpoints.heading_rad,
        record.setpoints.altitude_m,
        record.setpoints.roll_rad,
        record.setpoints.climb_rate_mps,
        record.setpoints.pitch_rad,
        record.outputs.throttle,
        record.outputs.elevator,
        record.outputs.aileron,
        record.outputs.rudder,
    ];
    let times = [
        record.tick.scheduled,
        record.tick.woke,
        m.attitude.taken,
        m.heading_rad.taken,
        m.body_rates.taken,
        m.specific_force.taken,
        m.airspeed_mps.taken,
        m.altitude_m.taken,
        m.angle_of_attack_rad.taken,
        m.position.taken,
        m.velocity.taken,
        m.surfaces.taken,
        m.engage_switch.taken,
        m.plant.taken,
    ];
    let counts = [
        record.tick.number,
        record.tick.missed,
        record.stages.sensors_ns,
        record.stages.navigation_ns,
        record.stages.guidance_ns,
        record.stages.control_ns,
        record.stages.actuators_ns,
        record.stages.total_ns,
        record.sensor_faults,
        record.actuator_faults,
        record.records_dropped,
        record.overruns,
        record.page_faults,
        record.early_wake_ns,
        u64::from(record.state.phase()),
        u64::from(record.state.cause()),
        u64::from(record.state.flags().bits()),
        u64::from(record.engage_inhibits.bits()),
        u64::from(record.faults.bits()),
        u64::from(record.sent),
        m.engage_switch.value as u64,
        m.plant.value.state as u64,
    ];
    let floats = floats.into_iter().map(f64::to_bits);
    let times = times.into_iter().map(|time| time.as_nanos() as u64);
    floats.chain(times).chain(counts).collect()
}

/// Any 64 bits: numbers, infinities, NaN of every payload; more often than
/// chance would, those that formats like to lose.
fn any_f64() -> BoxedStrategy<f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        prop_oneof![
            Just(0.0),
            Just(-0.0),
            Just(f64::NAN),
            Just(f64::from_bits(0xfff8_0000_dead_beef)),
            Just(f64::from_bits(0x7ff0_0000_0000_0001)),
            Just(f64::INFINITY),
            Just(f64::MIN_POSITIVE / 2.0),
        ],
    ]
    .boxed()
}

fn any_time() -> impl Strategy<Value = Time> {
    prop_oneof![Just(Time::NEVER), any::<i64>().prop_map(Time::from_nanos),]
}

fn reading<T: std::fmt::Debug>(
    value: impl Strategy<Value = T> + 'static,
) -> BoxedStrategy<Reading<T>> {
    (value, any_time())
        .prop_map(|(value, taken)| Reading::new(value, taken))
        .boxed()
}

fn any_state() -> impl Strategy<Value = State> {
    prop_oneof![
        Just(State::Standby),
        Just(State::Engaged),
        Just(State::Stopped),
        Just(State::Failsafe(Cause::InvalidOutput)),
        Just(State::Failsafe(Cause::Overrun)),
        any::<u32>().prop_map(|bits| State::Failsafe(Cause::Faults(Flags::from_bits(bits)))),
    ]
}

fn any_surfaces() -> BoxedStrategy<Surfaces> {
    (any_f64(), any_f64(), any_f64(), any_f64())
        .prop_map(|(throttle, elevator, aileron, rudder)| Surfaces {
            throttle,
            elevator,
            aileron,
            rudder,
        })
        .boxed()
}

fn any_triple() -> BoxedStrategy<[f64; 3]> {
    [any_f64(), any_f64(), any_f64()].boxed()
}

fn any_measurements() -> BoxedStrategy<Measurements> {
    let attitude = (any_f64(), any_f64()).prop_map(|(pitch_rad, roll_rad)| Attitude {
        pitch_rad,
        roll_rad,
    });
    let rates = any_triple().prop_map(|[roll_radps, pitch_radps, yaw_radps]| BodyRates {
        roll_radps,
        pitch_radps,
        yaw_radps,
    });
    let force = any_triple().prop_map(|[x_mps2, y_mps2, z_mps2]| SpecificForce {
        x_mps2,
        y_mps2,
        z_mps2,
    });
    let position = any_triple().prop_map(|[latitude_rad, longitude_rad, altitude_m]| Position {
        latitude_rad,
        longitude_rad,
        altitude_m,
    });
    let velocity = any_triple().prop_map(|[north_mps, east_mps, down_mps]| Velocity {
        north_mps,
        east_mps,
        down_mps,
    });
    let switch = prop_oneof![Just(Switch::Off), Just(Switch::On)];
    let plant_state = prop_oneof![
        Just(PlantState::Running),
        Just(PlantState::Paused),
        Just(PlantState::Stalled),
        Just(PlantState::Slow),
        Just(PlantState::Jumped),
    ];
    let plant = (any_f64(), plant_state).prop_map(|(time_s, state)| Plant { time_s, state });
    (
        (reading(attitude), reading(rates), reading(force)),
        (
            reading(any_f64()),
            reading(any_f64()),
            reading(any_f64()),
            reading(any_f64()),
        ),
        (
            reading(position),
            reading(velocity),
            reading(any_surfaces()),
        ),
        (reading(switch), reading(plant)),
    )
        .prop_map(|(body, scalars, place, rest)| Measurements {
            attitude: body.0,
            body_rates: body.1,
            specific_force: body.2,
            heading_rad: scalars.0,
            airspeed_mps: scalars.1,
            altitude_m: scalars.2,
            angle_of_attack_rad: scalars.3,
            position: place.0,
            velocity: place.1,
            surfaces: place.2,
            engage_switch: rest.0,
            plant: rest.1,
        })
        .boxed()
}

pub(crate) fn any_record() -> impl Strategy<Value = FlightRecord> {
    let tick = (
        any::<u64>(),
        any_time(),
        any_time(),
        any::<u64>(),
        any_f64(),
    )
        .prop_map(|(number, scheduled, woke, missed, dt_s)| Tick {
            number,
            scheduled,
            woke,
            missed,
            dt_s,
        });
    let setpoints = (any_triple(), any_triple()).prop_map(|(outer, inner)| Setpoints {
        airspeed_mps: outer[0],
        heading_rad: outer[1],
        altitude_m: outer[2],
        roll_rad: inner[0],
        climb_rate_mps: inner[1],
        pitch_rad: inner[2],
    });
    let stages = any::<[u64; 6]>().prop_map(|ns| StageTimes {
        sensors_ns: ns[0],
        navigation_ns: ns[1],
        guidance_ns: ns[2],
        control_ns: ns[3],
        actuators_ns: ns[4],
        total_ns: ns[5],
    });
    (
        (tick, stages, any_measurements(), setpoints, any_surfaces()),
        (
            any::<[u64; 6]>(),
            any_state(),
            any::<[u32; 2]>(),
            any::<bool>(),
        ),
    )
        .prop_map(|((tick, stages, measurements, setpoints, outputs), rest)| {
            let (counts, state, flags, sent) = rest;
            FlightRecord {
                tick,
                stages,
                measurements,
                setpoints,
                outputs,
                sensor_faults: counts[0],
                actuator_faults: counts[1],
                records_dropped: counts[2],
                overruns: counts[3],
                page_faults: counts[4],
                early_wake_ns: counts[5],
                state: state.into(),
                engage_inhibits: Flags::from_bits(flags[0]),
                faults: Flags::from_bits(flags[1]),
                sent,
            }
        })
}
