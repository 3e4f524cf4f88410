//! The layouts in `docs/telemetry.md` are those of the structs: programs in
//! other languages are written from that page.
#![cfg(test)]
#![cfg(feature = "live")]

use std::fmt::Write as _;
use std::mem::offset_of;

use fcc_telemetry::FlightRecord;
use fcc_telemetry::live::{Event, Info, LAYOUT, Status};

const DOCUMENT: &str = include_str!("../../../docs/telemetry.md");

/// The layout that this version of the page describes: whoever changes a struct
/// or a meaning counts `LAYOUT` up, the service names with it.
const DESCRIBED: u32 = 1;

/// A table of fields: where they are in `$of`, what they are, what they mean.
macro_rules! table {
    ($of:ty; $($($field:ident).+: $kind:literal, $meaning:literal;)+) => {{
        let mut text = String::from("| offset | field | type | what |\n|---:|---|---|---|\n");
        $(
            let offset = offset_of!($of, $($field).+);
            let name = stringify!($($field).+).replace(' ', "");
            let _ = writeln!(text, "| {offset} | `{name}` | {} | {} |", $kind, $meaning);
        )+
        let _ = writeln!(text, "| {} | | | end |", size_of::<$of>());
        text
    }};
}

fn assert_written_down(table: &str) {
    assert!(
        DOCUMENT.contains(table),
        "docs/telemetry.md lacks this table:\n{table}"
    );
}

#[test]
fn the_version_is_the_described_one() {
    assert_eq!(LAYOUT, DESCRIBED);
    assert!(DOCUMENT.contains(&format!("record/v{LAYOUT}`")));
}

#[test]
fn record() {
    assert_written_down(&table!(FlightRecord;
        tick.number: "u64", "periods since the loop's start; a missed one counts too";
        tick.scheduled: "i64", "when the tick was due, ns";
        tick.woke: "i64", "when the loop woke, ns";
        tick.missed: "u64", "periods that passed unserved right before";
        tick.dt_s: "f64", "since the tick before, by schedule";
        stages.sensors_ns: "u64", "how long the stages took; 0 for one left out";
        stages.navigation_ns: "u64", "";
        stages.guidance_ns: "u64", "";
        stages.control_ns: "u64", "";
        stages.actuators_ns: "u64", "";
        stages.total_ns: "u64", "from the wake-up to the last actuator write";
        measurements.attitude.value.pitch_rad: "f64", "nose above the horizon, -π/2..π/2";
        measurements.attitude.value.roll_rad: "f64", "right wing down, -π..π";
        measurements.attitude.taken: "i64", "when it was taken, ns; so below";
        measurements.heading_rad.value: "f64", "magnetic, clockwise from north, 0..2π";
        measurements.heading_rad.taken: "i64", "";
        measurements.body_rates.value.roll_radps: "f64", "about the body axes: right wing down";
        measurements.body_rates.value.pitch_radps: "f64", "nose up";
        measurements.body_rates.value.yaw_radps: "f64", "nose right";
        measurements.body_rates.taken: "i64", "";
        measurements.specific_force.value.x_mps2: "f64", "acceleration less gravity: forward";
        measurements.specific_force.value.y_mps2: "f64", "right";
        measurements.specific_force.value.z_mps2: "f64", "down; level and at rest -9.81";
        measurements.specific_force.taken: "i64", "";
        measurements.airspeed_mps.value: "f64", "indicated";
        measurements.airspeed_mps.taken: "i64", "";
        measurements.altitude_m.value: "f64", "barometric, above the standard pressure level";
        measurements.altitude_m.taken: "i64", "";
        measurements.angle_of_attack_rad.value: "f64", "air from below the nose is positive";
        measurements.angle_of_attack_rad.taken: "i64", "";
        measurements.position.value.latitude_rad: "f64", "WGS 84, north";
        measurements.position.value.longitude_rad: "f64", "east";
        measurements.position.value.altitude_m: "f64", "above mean sea level";
        measurements.position.taken: "i64", "";
        measurements.velocity.value.north_mps: "f64", "over the ground, towards true north";
        measurements.velocity.value.east_mps: "f64", "";
        measurements.velocity.value.down_mps: "f64", "";
        measurements.velocity.taken: "i64", "";
        measurements.surfaces.value.throttle: "f64", "where the controls stand, as `outputs` below";
        measurements.surfaces.value.elevator: "f64", "";
        measurements.surfaces.value.aileron: "f64", "";
        measurements.surfaces.value.rudder: "f64", "";
        measurements.surfaces.taken: "i64", "";
        measurements.engage_switch.value: "u8", "0 off, 1 on";
        measurements.engage_switch.taken: "i64", "";
        measurements.plant.value.time_s: "f64", "a simulated plant's own time";
        measurements.plant.value.state: "u8", "0 running, 1 paused, 2 stalled, 3 slow, 4 jumped";
        measurements.plant.taken: "i64", "";
        setpoints.airspeed_mps: "f64", "set points; they mean something while engaged";
        setpoints.heading_rad: "f64", "0..2π";
        setpoints.altitude_m: "f64", "";
        setpoints.roll_rad: "f64", "bank that the heading loop asks for";
        setpoints.climb_rate_mps: "f64", "climb that the altitude loop asks for";
        setpoints.pitch_rad: "f64", "pitch that the climb loop asks for";
        outputs.throttle: "f64", "0 idle to 1 full";
        outputs.elevator: "f64", "-1 to 1, positive raises the nose";
        outputs.aileron: "f64", "-1 to 1, positive rolls right";
        outputs.rudder: "f64", "-1 to 1, positive yaws right";
        sensor_faults: "u64", "failed samples since the loop's start";
        actuator_faults: "u64", "failed writes since the loop's start";
        records_dropped: "u64", "records that the loop could not hand over since its start";
        overruns: "u64", "ticks that took longer than their budget since its start";
        page_faults: "u64", "page faults of the loop's thread since its start";
        early_wake_ns: "u64", "how long before the deadline the timer asked to be woken; 0 where it does not wake early";
        state: "u8, u8, u32", "phase: 0 standby, 1 engaged, 2 failsafe, 3 stopped; at +1 why failsafe: 1 faults, 2 invalid output, 3 overruns; at +4 those faults";
        engage_inhibits: "u32", "why it may not engage, a set of bits";
        faults: "u32", "what makes going on unsafe, a set of bits";
        sent: "u8", "1 if the outputs were handed to the actuators";
    ));
}

#[test]
fn event() {
    assert_written_down(&table!(Event;
        tick: "u64", "the tick it happened in";
        time_ns: "i64", "that tick's wake-up";
        code: "u32", "what it was, see below";
        index: "u32", "which sensor or actuator, the first being 0";
        values: "u64[3]", "what the code says";
        text: "char[208]", "in words";
    ));
}

#[test]
fn status() {
    assert_written_down(&table!(Status;
        time_ns: "i64", "wake-up of the last tick";
        ticks: "u64", "since the loop's start";
        missed: "u64", "periods that passed unserved";
        lateness_p50_ns: "u64", "of all ticks since the start";
        lateness_p99_ns: "u64", "";
        lateness_p99_9_ns: "u64", "";
        lateness_max_ns: "u64", "";
        lateness_counts: "u64[14]", "ticks by lateness: up to 0.1, 0.316, 1, 3.16, ... µs, half a decade each, up to 100 ms; the last bin counts those above";
        not_published: "u64", "records that did not get into shared memory";
        cpu_ns: "u64", "CPU time of the publishing thread";
        watchers: "u32", "programs that watch the records";
        recorder_state: "u32", "0 off, 1 recording, 2 cannot write";
        recorded: "u64", "records in the file";
        not_recorded: "u64", "records that did not get into the file";
        recording_bytes: "u64", "size of the file";
        recording: "char[128]", "the file's name, or why there is none";
    ));
}

#[test]
fn info() {
    assert_written_down(&table!(Info;
        layout: "u32", "version of all other layouts";
        record_bytes: "u32", "size of a record";
        event_bytes: "u32", "size of an event";
        status_bytes: "u32", "size of a status";
        process_id: "u32", "the daemon's process";
        priority: "i32", "of the loop's thread under SCHED_FIFO, else 0";
        memory_locked: "u32", "1 if the daemon's memory is locked";
        requests_denied: "u32", "real-time wishes that the kernel refused";
        started_unix_ns: "i64", "when publishing began, since 1970, UTC";
        started_ns: "i64", "the same instant on the loop's clock";
        rate_hz: "f64", "nominal";
        software: "char[32]", "version of the daemon";
        commit: "char[48]", "what it was built from; empty if unknown";
        timer: "char[16]", "timerfd, posix or nanosleep";
        policy: "char[16]", "scheduling of the loop's thread";
        aircraft: "char[64]", "what is flown";
        refusals: "char[280]", "the refused wishes, in words";
    ));
}
