//! Where the numbers of a record lie: one table, for whoever hands records out
//! as columns.

#![expect(
    unsafe_code,
    reason = "a record's fields are copied by their offsets, so that no table of getters is needed"
)]

use std::mem::offset_of;

use fcc_core::framework::{Flags, StateCode};

use crate::FlightRecord;

/// One number of a record: what it is called and where it lies.
///
/// Names are those of the columns of `fccd report --csv`, with the unit at
/// their end.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Field {
    /// What it is called.
    pub name: &'static str,
    /// Bytes from the record's beginning.
    pub offset: usize,
    /// What kind of number it is.
    pub kind: FieldKind,
}

/// What kind of number a field is, in the machine's own byte order.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FieldKind {
    /// A small code, or 0 and 1 for no and yes.
    U8,
    /// A set of conditions.
    U32,
    /// A count, or a span in ns.
    U64,
    /// An instant in ns on the loop's clock; the smallest number is never.
    I64,
    /// Anything measured or commanded.
    F64,
}

impl FieldKind {
    /// Bytes that it takes.
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }
}

macro_rules! fields {
    ($( $name:literal: $kind:ident = $($part:ident).+ $(+ $more:literal)? ),+ $(,)?) => {
        &[ $( Field {
            name: $name,
            offset: offset_of!(FlightRecord, $($part).+) $(+ $more)?,
            kind: FieldKind::$kind,
        } ),+ ]
    };
}

/// Every number of a record, in the order of the record. Instants end in
/// `_ns` and are [`i64::MIN`] where there never was one; the value beside such
/// a time means nothing.
pub const FIELDS: &[Field] = fields![
    "tick": U64 = tick.number,
    "scheduled_ns": I64 = tick.scheduled,
    "woke_ns": I64 = tick.woke,
    "missed": U64 = tick.missed,
    "dt_s": F64 = tick.dt_s,
    "sensors_time_ns": U64 = stages.sensors_ns,
    "navigation_time_ns": U64 = stages.navigation_ns,
    "guidance_time_ns": U64 = stages.guidance_ns,
    "control_time_ns": U64 = stages.control_ns,
    "actuators_time_ns": U64 = stages.actuators_ns,
    "total_time_ns": U64 = stages.total_ns,
    "pitch_rad": F64 = measurements.attitude.value.pitch_rad,
    "roll_rad": F64 = measurements.attitude.value.roll_rad,
    "attitude_taken_ns": I64 = measurements.attitude.taken,
    "heading_rad": F64 = measurements.heading_rad.value,
    "heading_taken_ns": I64 = measurements.heading_rad.taken,
    "roll_rate_radps": F64 = measurements.body_rates.value.roll_radps,
    "pitch_rate_radps": F64 = measurements.body_rates.value.pitch_radps,
    "yaw_rate_radps": F64 = measurements.body_rates.value.yaw_radps,
    "body_rates_taken_ns": I64 = measurements.body_rates.taken,
    "specific_force_x_mps2": F64 = measurements.specific_force.value.x_mps2,
    "specific_force_y_mps2": F64 = measurements.specific_force.value.y_mps2,
    "specific_force_z_mps2": F64 = measurements.specific_force.value.z_mps2,
    "specific_force_taken_ns": I64 = measurements.specific_force.taken,
    "airspeed_mps": F64 = measurements.airspeed_mps.value,
    "airspeed_taken_ns": I64 = measurements.airspeed_mps.taken,
    "altitude_m": F64 = measurements.altitude_m.value,
    "altitude_taken_ns": I64 = measurements.altitude_m.taken,
    "angle_of_attack_rad": F64 = measurements.angle_of_attack_rad.value,
    "angle_of_attack_taken_ns": I64 = measurements.angle_of_attack_rad.taken,
    "latitude_rad": F64 = measurements.position.value.latitude_rad,
    "longitude_rad": F64 = measurements.position.value.longitude_rad,
    "position_altitude_m": F64 = measurements.position.value.altitude_m,
    "position_taken_ns": I64 = measurements.position.taken,
    "north_mps": F64 = measurements.velocity.value.north_mps,
    "east_mps": F64 = measurements.velocity.value.east_mps,
    "down_mps": F64 = measurements.velocity.value.down_mps,
    "velocity_taken_ns": I64 = measurements.velocity.taken,
    "measured_throttle": F64 = measurements.surfaces.value.throttle,
    "measured_elevator": F64 = measurements.surfaces.value.elevator,
    "measured_aileron": F64 = measurements.surfaces.value.aileron,
    "measured_rudder": F64 = measurements.surfaces.value.rudder,
    "surfaces_taken_ns": I64 = measurements.surfaces.taken,
    "engage_switch": U8 = measurements.engage_switch.value,
    "engage_switch_taken_ns": I64 = measurements.engage_switch.taken,
    "plant_time_s": F64 = measurements.plant.value.time_s,
    "plant_state": U8 = measurements.plant.value.state,
    "plant_taken_ns": I64 = measurements.plant.taken,
    "desired_airspeed_mps": F64 = setpoints.airspeed_mps,
    "desired_heading_rad": F64 = setpoints.heading_rad,
    "desired_altitude_m": F64 = setpoints.altitude_m,
    "desired_roll_rad": F64 = setpoints.roll_rad,
    "desired_climb_rate_mps": F64 = setpoints.climb_rate_mps,
    "desired_pitch_rad": F64 = setpoints.pitch_rad,
    "commanded_throttle": F64 = outputs.throttle,
    "commanded_elevator": F64 = outputs.elevator,
    "commanded_aileron": F64 = outputs.aileron,
    "commanded_rudder": F64 = outputs.rudder,
    "sensor_faults": U64 = sensor_faults,
    "actuator_faults": U64 = actuator_faults,
    "records_dropped": U64 = records_dropped,
    "overruns": U64 = overruns,
    "page_faults": U64 = page_faults,
    "early_wake_ns": U64 = early_wake_ns,
    // A state's parts are its own: a phase, a cause, the faults that led there.
    "state": U8 = state,
    "state_cause": U8 = state + 1,
    "state_flags": U32 = state + 4,
    "engage_inhibits": U32 = engage_inhibits,
    "faults": U32 = faults,
    "sent": U8 = sent,
];

const _: () = assert!(
    size_of::<StateCode>() == 8 && size_of::<Flags>() == 4,
    "the parts of a state lie elsewhere"
);

/// Bytes of a record.
pub const RECORD_BYTES: usize = size_of::<FlightRecord>();

/// The bytes of a record, aligned as one.
pub type RecordWords = [u64; RECORD_BYTES / size_of::<u64>()];

const _: () = assert!(
    size_of::<RecordWords>() == RECORD_BYTES,
    "a record is a whole number of words"
);

/// The bytes of a record, laid out as [`FIELDS`] say; those between fields,
/// which a record leaves undefined, are zero: two equal records have the same
/// bytes.
pub fn words_of(record: &FlightRecord) -> RecordWords {
    let mut words: RecordWords = [0; RECORD_BYTES / size_of::<u64>()];
    let from = std::ptr::from_ref(record).cast::<u8>();
    let into = words.as_mut_ptr().cast::<u8>();
    for field in FIELDS {
        // SAFETY: both are `RECORD_BYTES` long and apart, and each field lies
        // inside: its offset is that of a field of a record, its size that of
        // the field (checked by a test). Fields are initialized.
        unsafe {
            std::ptr::copy_nonoverlapping(
                from.add(field.offset),
                into.add(field.offset),
                field.kind.bytes(),
            );
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::{Cause, Record, State, Tick};

    use super::*;

    /// A number that is in the record and not in the table leaves a hole:
    /// between fields there may only be what alignment asks for.
    #[test]
    fn the_table_is_whole() {
        let mut end = 0;
        for field in FIELDS {
            let size = field.kind.bytes();
            assert_eq!(field.offset % size, 0, "{}: not aligned", field.name);
            let aligned = end + (size - end % size) % size;
            assert!(
                field.offset >= end,
                "{} lies on the field before it",
                field.name
            );
            // The faults of a state lie behind two bytes and two holes.
            assert_eq!(
                field.offset, aligned,
                "before {} there is a number that is not in the table",
                field.name
            );
            end = field.offset + size;
        }
        assert!(
            RECORD_BYTES - end < 8,
            "a record's last {} bytes are not in the table",
            RECORD_BYTES - end
        );
    }

    #[test]
    fn equal_records_have_the_same_bytes_and_numbers_are_where_they_are_said() {
        let tick = Tick {
            number: 7,
            dt_s: 0.025,
            ..Tick::default()
        };
        let mut record: FlightRecord = Record::new(tick, State::Engaged);
        record.outputs.rudder = -0.25;
        let words = words_of(&record);
        assert_eq!(words, words_of(&record.clone()));
        let at = |name: &str| {
            let field = FIELDS.iter().find(|field| field.name == name).unwrap();
            words[field.offset / 8]
        };
        assert_eq!(at("tick"), 7);
        assert_eq!(f64::from_bits(at("dt_s")), 0.025);
        assert_eq!(f64::from_bits(at("commanded_rudder")), -0.25);
        assert_eq!(at("airspeed_taken_ns") as i64, i64::MIN);
    }

    #[test]
    fn no_name_twice() {
        let mut names: Vec<_> = FIELDS.iter().map(|field| field.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), FIELDS.len());
    }

    /// The parts of a state are found where the table says.
    #[test]
    fn the_state_lies_where_it_is_said() {
        let state = State::Failsafe(Cause::Faults(Flags::from_bits(0x0102_0304)));
        let mut record: FlightRecord = Record::new(Tick::default(), state);
        record.sent = true;
        let at = |name: &str| {
            let field = FIELDS.iter().find(|field| field.name == name).unwrap();
            field.offset - offset_of!(FlightRecord, state)
        };
        assert_eq!(
            (at("state"), at("state_cause"), at("state_flags")),
            (0, 1, 4)
        );
        assert_eq!((record.state.phase(), record.state.cause()), (2, 1));
    }
}
