//! The record of a tick as a message.
//!
//! What a message leaves out decodes to the default, so that fields may be
//! added; what it says and nobody knows is refused.

use fcc_core::flight::{
    Attitude, BodyRates, Measurements, Plant, PlantState, Position, Setpoints, SpecificForce,
    Surfaces, Velocity,
};
use fcc_core::framework::{Flags, Reading, Record, StageTimes, StateCode, Switch, Tick, Time};

use super::{Unknown, fcc};
use crate::FlightRecord;

/// A record as a message.
pub(crate) fn encode(record: &FlightRecord) -> fcc::Record {
    let tick = &record.tick;
    fcc::Record {
        tick: tick.number,
        scheduled_ns: tick.scheduled.as_nanos(),
        woke_ns: tick.woke.as_nanos(),
        lateness_us: Some((tick.woke - tick.scheduled) as f64 * 1e-3),
        missed: tick.missed,
        dt_s: Some(tick.dt_s),
        stages: Some(stages_out(&record.stages)),
        measurements: Some(measurements_out(&record.measurements)),
        setpoints: Some(setpoints_out(&record.setpoints)),
        outputs: Some(surfaces_out(&record.outputs)),
        sent: record.sent,
        state: Some(state_out(record.state)),
        engage_inhibits: record.engage_inhibits.bits(),
        faults: record.faults.bits(),
        sensor_faults: record.sensor_faults,
        actuator_faults: record.actuator_faults,
        records_dropped: record.records_dropped,
        overruns: record.overruns,
        page_faults: record.page_faults,
        early_wake_ns: record.early_wake_ns,
    }
}

/// The record in a message.
pub(crate) fn decode(record: &fcc::Record) -> Result<FlightRecord, Unknown> {
    Ok(Record {
        tick: Tick {
            number: record.tick,
            scheduled: Time::from_nanos(record.scheduled_ns),
            woke: Time::from_nanos(record.woke_ns),
            missed: record.missed,
            dt_s: number(record.dt_s),
        },
        stages: stages_in(&record.stages.unwrap_or_default()),
        measurements: measurements_in(&record.measurements.unwrap_or_default())?,
        setpoints: setpoints_in(&record.setpoints.unwrap_or_default()),
        outputs: surfaces_in(&record.outputs.unwrap_or_default()),
        sensor_faults: record.sensor_faults,
        actuator_faults: record.actuator_faults,
        records_dropped: record.records_dropped,
        overruns: record.overruns,
        page_faults: record.page_faults,
        early_wake_ns: record.early_wake_ns,
        state: state_in(record.state.unwrap_or_default())?,
        engage_inhibits: Flags::from_bits(record.engage_inhibits),
        faults: Flags::from_bits(record.faults),
        sent: record.sent,
    })
}

/// A state as a message.
pub(super) fn state_out(code: StateCode) -> fcc::State {
    fcc::State {
        phase: i32::from(code.phase()),
        cause: i32::from(code.cause()),
        flags: code.flags().bits(),
    }
}

/// The state in a message.
pub(super) fn state_in(state: fcc::State) -> Result<StateCode, Unknown> {
    let phase = u8::try_from(state.phase).ok();
    let cause = u8::try_from(state.cause).ok();
    phase
        .zip(cause)
        .and_then(|(phase, cause)| {
            StateCode::from_parts(phase, cause, Flags::from_bits(state.flags))
        })
        .ok_or(Unknown("the loop's state"))
}

fn number(value: Option<f64>) -> f64 {
    value.unwrap_or_default()
}

fn stages_out(stages: &StageTimes) -> fcc::StageTimes {
    fcc::StageTimes {
        sensors_ns: stages.sensors_ns,
        navigation_ns: stages.navigation_ns,
        guidance_ns: stages.guidance_ns,
        control_ns: stages.control_ns,
        actuators_ns: stages.actuators_ns,
        total_ns: stages.total_ns,
    }
}

fn stages_in(stages: &fcc::StageTimes) -> StageTimes {
    StageTimes {
        sensors_ns: stages.sensors_ns,
        navigation_ns: stages.navigation_ns,
        guidance_ns: stages.guidance_ns,
        control_ns: stages.control_ns,
        actuators_ns: stages.actuators_ns,
        total_ns: stages.total_ns,
    }
}

fn setpoints_out(setpoints: &Setpoints) -> fcc::Setpoints {
    fcc::Setpoints {
        airspeed_mps: Some(setpoints.airspeed_mps),
        heading_rad: Some(setpoints.heading_rad),
        altitude_m: Some(setpoints.altitude_m),
        roll_rad: Some(setpoints.roll_rad),
        climb_rate_mps: Some(setpoints.climb_rate_mps),
        pitch_rad: Some(setpoints.pitch_rad),
    }
}

fn setpoints_in(setpoints: &fcc::Setpoints) -> Setpoints {
    Setpoints {
        airspeed_mps: number(setpoints.airspeed_mps),
        heading_rad: number(setpoints.heading_rad),
        altitude_m: number(setpoints.altitude_m),
        roll_rad: number(setpoints.roll_rad),
        climb_rate_mps: number(setpoints.climb_rate_mps),
        pitch_rad: number(setpoints.pitch_rad),
    }
}

fn surfaces_out(surfaces: &Surfaces) -> fcc::Surfaces {
    fcc::Surfaces {
        throttle: Some(surfaces.throttle),
        elevator: Some(surfaces.elevator),
        aileron: Some(surfaces.aileron),
        rudder: Some(surfaces.rudder),
    }
}

fn surfaces_in(surfaces: &fcc::Surfaces) -> Surfaces {
    Surfaces {
        throttle: number(surfaces.throttle),
        elevator: number(surfaces.elevator),
        aileron: number(surfaces.aileron),
        rudder: number(surfaces.rudder),
    }
}

fn reading_out(reading: &Reading<f64>) -> fcc::Reading {
    fcc::Reading {
        taken_ns: reading.taken.as_nanos(),
        value: Some(reading.value),
    }
}

/// A reading that the message may leave out: then it never came.
fn reading_in<W, T: Default>(
    reading: Option<&W>,
    taken_ns: impl Fn(&W) -> i64,
    value: impl Fn(&W) -> T,
) -> Reading<T> {
    reading.map_or_else(Reading::default, |wire| {
        Reading::new(value(wire), Time::from_nanos(taken_ns(wire)))
    })
}

fn measurements_out(measured: &Measurements) -> fcc::Measurements {
    let Measurements {
        attitude,
        body_rates,
        specific_force,
        position,
        velocity,
        surfaces,
        engage_switch,
        plant,
        ..
    } = measured;
    fcc::Measurements {
        attitude: Some(fcc::Attitude {
            taken_ns: attitude.taken.as_nanos(),
            pitch_rad: Some(attitude.value.pitch_rad),
            roll_rad: Some(attitude.value.roll_rad),
        }),
        heading_rad: Some(reading_out(&measured.heading_rad)),
        body_rates: Some(fcc::BodyRates {
            taken_ns: body_rates.taken.as_nanos(),
            roll_radps: Some(body_rates.value.roll_radps),
            pitch_radps: Some(body_rates.value.pitch_radps),
            yaw_radps: Some(body_rates.value.yaw_radps),
        }),
        specific_force: Some(fcc::SpecificForce {
            taken_ns: specific_force.taken.as_nanos(),
            x_mps2: Some(specific_force.value.x_mps2),
            y_mps2: Some(specific_force.value.y_mps2),
            z_mps2: Some(specific_force.value.z_mps2),
        }),
        airspeed_mps: Some(reading_out(&measured.airspeed_mps)),
        altitude_m: Some(reading_out(&measured.altitude_m)),
        angle_of_attack_rad: Some(reading_out(&measured.angle_of_attack_rad)),
        position: Some(fcc::Position {
            taken_ns: position.taken.as_nanos(),
            latitude_rad: Some(position.value.latitude_rad),
            longitude_rad: Some(position.value.longitude_rad),
            altitude_m: Some(position.value.altitude_m),
        }),
        velocity: Some(fcc::Velocity {
            taken_ns: velocity.taken.as_nanos(),
            north_mps: Some(velocity.value.north_mps),
            east_mps: Some(velocity.value.east_mps),
            down_mps: Some(velocity.value.down_mps),
        }),
        surfaces: Some(fcc::MeasuredSurfaces {
            taken_ns: surfaces.taken.as_nanos(),
            stand: Some(surfaces_out(&surfaces.value)),
        }),
        engage_switch: Some(fcc::Switch {
            taken_ns: engage_switch.taken.as_nanos(),
            on: engage_switch.value == Switch::On,
        }),
        plant: Some(fcc::Plant {
            taken_ns: plant.taken.as_nanos(),
            time_s: Some(plant.value.time_s),
            state: i32::from(plant.value.state as u8),
        }),
    }
}

fn measurements_in(wire: &fcc::Measurements) -> Result<Measurements, Unknown> {
    let scalar =
        |reading: Option<&fcc::Reading>| reading_in(reading, |w| w.taken_ns, |w| number(w.value));
    let plant_state = plant_state_in(wire.plant.as_ref().map_or(0, |plant| plant.state))?;
    Ok(Measurements {
        attitude: reading_in(
            wire.attitude.as_ref(),
            |w| w.taken_ns,
            |w| Attitude {
                pitch_rad: number(w.pitch_rad),
                roll_rad: number(w.roll_rad),
            },
        ),
        heading_rad: scalar(wire.heading_rad.as_ref()),
        body_rates: reading_in(
            wire.body_rates.as_ref(),
            |w| w.taken_ns,
            |w| BodyRates {
                roll_radps: number(w.roll_radps),
                pitch_radps: number(w.pitch_radps),
                yaw_radps: number(w.yaw_radps),
            },
        ),
        specific_force: reading_in(
            wire.specific_force.as_ref(),
            |w| w.taken_ns,
            |w| SpecificForce {
                x_mps2: number(w.x_mps2),
                y_mps2: number(w.y_mps2),
                z_mps2: number(w.z_mps2),
            },
        ),
        airspeed_mps: scalar(wire.airspeed_mps.as_ref()),
        altitude_m: scalar(wire.altitude_m.as_ref()),
        angle_of_attack_rad: scalar(wire.angle_of_attack_rad.as_ref()),
        position: reading_in(
            wire.position.as_ref(),
            |w| w.taken_ns,
            |w| Position {
                latitude_rad: number(w.latitude_rad),
                longitude_rad: number(w.longitude_rad),
                altitude_m: number(w.altitude_m),
            },
        ),
        velocity: reading_in(
            wire.velocity.as_ref(),
            |w| w.taken_ns,
            |w| Velocity {
                north_mps: number(w.north_mps),
                east_mps: number(w.east_mps),
                down_mps: number(w.down_mps),
            },
        ),
        surfaces: reading_in(
            wire.surfaces.as_ref(),
            |w| w.taken_ns,
            |w| surfaces_in(&w.stand.unwrap_or_default()),
        ),
        engage_switch: reading_in(
            wire.engage_switch.as_ref(),
            |w| w.taken_ns,
            |w| if w.on { Switch::On } else { Switch::Off },
        ),
        plant: reading_in(
            wire.plant.as_ref(),
            |w| w.taken_ns,
            |w| Plant {
                time_s: number(w.time_s),
                state: plant_state,
            },
        ),
    })
}

fn plant_state_in(state: i32) -> Result<PlantState, Unknown> {
    [
        PlantState::Running,
        PlantState::Paused,
        PlantState::Stalled,
        PlantState::Slow,
        PlantState::Jumped,
    ]
    .into_iter()
    .find(|known| i32::from(*known as u8) == state)
    .ok_or(Unknown("the plant's state"))
}
