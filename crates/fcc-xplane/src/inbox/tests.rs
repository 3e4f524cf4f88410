use core::slice;
use core::time::Duration;

use super::*;
use crate::config::RowsVersion;
use fcc_core::flight::PlantState;

const TICK: Duration = Duration::from_millis(25);

struct Bench {
    inbox: Inbox,
    link: SharedState,
    now: Time,
    measurements: Measurements,
}

impl Bench {
    fn new(rows: Option<DataRows>) -> Self {
        Self::of(PlantKind::Simulator, rows)
    }

    fn of(plant: PlantKind, rows: Option<DataRows>) -> Self {
        Self {
            inbox: Inbox::new(plant, rows, Duration::from_millis(500)),
            link: SharedState::new(None),
            now: Time::from_nanos(1_000_000_000),
            measurements: Measurements::default(),
        }
    }

    /// A tick in which these datagrams arrive.
    fn tick(&mut self, datagrams: &[Vec<u8>]) -> SimulatorState {
        self.now = self.now + TICK;
        self.inbox.begin();
        for datagram in datagrams {
            self.inbox.accept(datagram, self.now, &self.link).unwrap();
        }
        self.inbox
            .publish(self.now, &mut self.measurements, &self.link, &self.link)
    }
}

fn values(pairs: &[(Quantity, f32)]) -> Vec<u8> {
    let mut datagram = b"RREF,".to_vec();
    for (quantity, value) in pairs {
        datagram.extend((*quantity as i32).to_le_bytes());
        datagram.extend(value.to_le_bytes());
    }
    datagram
}

fn row(index: i32, columns: [f32; 8]) -> Vec<u8> {
    let mut row = index.to_le_bytes().to_vec();
    for column in columns {
        row.extend(column.to_le_bytes());
    }
    row
}

fn rows(rows: &[Vec<u8>]) -> Vec<u8> {
    [b"DATA*".to_vec(), rows.concat()].concat()
}

fn assert_close(got: f64, expected: f64) {
    assert!((got - expected).abs() < 1e-6, "{got} is not {expected}");
}

#[test]
fn attitude_waits_for_both_pitch_and_roll() {
    let mut bench = Bench::new(None);
    bench.tick(&[values(&[(Quantity::Pitch, 10.0)])]);
    assert!(bench.measurements.attitude.is_never());
    let first = bench.now;
    bench.tick(&[values(&[(Quantity::Roll, -20.0)])]);
    let attitude = bench.measurements.attitude;
    assert_eq!(attitude.taken, first, "as old as the older of the two");
    // 1° is 0.017 453 292 5 rad (Abramowitz and Stegun 1964, table 1.1).
    assert_close(attitude.value.pitch_rad, 0.174_532_925);
    assert_close(attitude.value.roll_rad, -0.349_065_850);
}

#[test]
fn an_overtaken_datagram_is_dropped_whole_and_a_doubled_one_is_harmless() {
    let mut bench = Bench::new(None);
    let frame = |time, knots| values(&[(Quantity::Airspeed, knots), (Quantity::FlightTime, time)]);
    bench.tick(&[frame(50.00, 100.0), frame(50.02, 101.0)]);
    let newest = bench.measurements;
    bench.tick(&[frame(50.00, 100.0)]);
    assert_eq!(bench.measurements, newest);
    bench.tick(&[frame(50.02, 101.0), frame(50.02, 101.0)]);
    // 101 kt are 51.958 888… m/s.
    assert_close(bench.measurements.airspeed_mps.value, 51.958_888_888);
}

/// A board's frame: its switch, its airspeed, who has control, and its clock if it sends it.
fn of_board(time_s: Option<f32>, switch: f32) -> Vec<u8> {
    let mut pairs = vec![(Quantity::EngageSwitch, switch), (Quantity::Airspeed, 60.0)];
    pairs.extend(time_s.map(|time_s| (Quantity::NetworkTime, time_s)));
    values(&pairs)
}

#[test]
fn of_a_board_with_a_clock_old_frames_are_dropped_and_a_new_start_is_followed() {
    let mut bench = Bench::of(PlantKind::ServoBoard, None);
    let mut dropped = 0;
    for tick in 0..400_i16 {
        let time_s = 100.0 + 0.025 * f32::from(tick);
        let frame = of_board(Some(time_s), f32::from(u8::from(tick >= 200)));
        // From before the switch was moved, up to 5 s late, each third after the new one.
        let mut frames = vec![frame];
        if (200..399).contains(&tick) && tick % 3 == 0 {
            frames.push(of_board(Some(time_s - 5.0), 0.0));
            dropped += 1;
        }
        bench.tick(&frames);
        let on = bench.measurements.engage_switch.value;
        assert_eq!(on == Switch::On, tick >= 200, "{tick}");
    }
    let late = bench
        .link
        .counters
        .late
        .load(core::sync::atomic::Ordering::Relaxed);
    assert_eq!(late, dropped);
    assert!(
        bench.measurements.plant.is_never(),
        "a board is no simulator"
    );
    // It starts again, with its switch off.
    for tick in 0..4_u8 {
        bench.tick(&[of_board(Some(0.025 * f32::from(tick)), 0.0)]);
    }
    assert_eq!(bench.measurements.engage_switch.value, Switch::Off);
}

#[test]
fn a_loaded_flight_is_reported_as_a_jump_and_followed() {
    let mut bench = Bench::new(None);
    bench.tick(&[values(&[(Quantity::FlightTime, 500.0)])]);
    // It may be a datagram that was overtaken, until another one continues it.
    let state = bench.tick(&[values(&[(Quantity::FlightTime, 3.0)])]);
    assert_eq!(state, SimulatorState::Running);
    let state = bench.tick(&[values(&[(Quantity::FlightTime, 3.025)])]);
    assert_eq!(state, SimulatorState::Jumped);
    assert_eq!(bench.measurements.plant.value.state, PlantState::Jumped);
    assert_close(bench.measurements.plant.value.time_s, 3.025);
}

/// Of longitude, latitude and elevation, and nothing else.
fn position(latitude_deg: f64) -> Vec<u8> {
    let mut datagram = b"RPOS4".to_vec();
    for value in [-88.0, latitude_deg, 300.0] {
        datagram.extend(value.to_le_bytes());
    }
    datagram.resize(69, 0);
    datagram
}

#[test]
fn a_position_that_arrives_beside_old_times_is_not_used() {
    let mut bench = Bench::new(None);
    let time = |time_s| values(&[(Quantity::FlightTime, time_s)]);
    let latitude_deg = |bench: &Bench| bench.measurements.position.value.latitude_rad.to_degrees();
    bench.tick(&[time(500.0), position(43.0)]);
    assert_close(latitude_deg(&bench), 43.0);
    bench.tick(&[time(500.02), time(497.0), position(42.9)]);
    assert_close(latitude_deg(&bench), 43.0);
    // For 0.4 s.
    for tick in 0..15_u8 {
        bench.tick(&[time(500.1 + 0.025 * f32::from(tick)), position(42.8)]);
        assert_close(latitude_deg(&bench), 43.0);
    }
    bench.tick(&[time(500.6), position(43.001)]);
    assert_close(latitude_deg(&bench), 43.001);
    // That of a loaded flight is used with its time.
    for tick in 0..2_u8 {
        bench.tick(&[time(3.0 + 0.025 * f32::from(tick)), position(10.0)]);
    }
    assert_close(latitude_deg(&bench), 10.0);
}

#[test]
fn a_heading_just_west_of_north_stays_below_a_full_turn() {
    let mut bench = Bench::new(None);
    for (degrees, radians) in [(-90.0, 4.712_388_980), (360.0, 0.0), (-1e-30, 0.0)] {
        bench.tick(&[values(&[(Quantity::MagneticHeading, degrees)])]);
        assert_close(bench.measurements.heading_rad.value, radians);
    }
}

#[test]
fn nan_leaves_the_old_reading() {
    let mut bench = Bench::new(None);
    bench.tick(&[values(&[(Quantity::PressureAltitude, 3_000.0)])]);
    let before = bench.measurements.altitude_m;
    assert_close(before.value, 914.4);
    for garbled in [f32::NAN, f32::INFINITY, 1e30] {
        bench.tick(&[values(&[(Quantity::PressureAltitude, garbled)])]);
        assert_eq!(bench.measurements.altitude_m, before);
    }
}

/// Repeated accelerations give a force that is unchanged to the last bit while
/// the aircraft rolls; new ones do not.
#[test]
fn frozen_accelerations_give_a_frozen_force() {
    let frame = |east: f32, roll_deg: f32| {
        values(&[
            (Quantity::AccelerationEast, east),
            (Quantity::AccelerationUp, 0.5),
            (Quantity::AccelerationSouth, 0.0),
            (Quantity::LocalHeading, 0.0),
            (Quantity::Pitch, 2.0),
            (Quantity::Roll, roll_deg),
        ])
    };
    let mut bench = Bench::new(None);
    bench.tick(&[frame(1.0, 0.0)]);
    let first = bench.measurements.specific_force;
    bench.tick(&[frame(1.0, 30.0)]);
    let frozen = bench.measurements.specific_force;
    assert_eq!(frozen.value, first.value);
    assert!(frozen.taken > first.taken);
    bench.tick(&[frame(1.1, 30.0)]);
    assert_ne!(bench.measurements.specific_force.value, first.value);
}

#[test]
fn rows_of_eleven_and_twelve_give_the_same_rates() {
    // 0.1 rad/s are 5.729 578 deg/s.
    let eleven = row(16, [0.1, 0.2, 0.3, -999.0, -999.0, -999.0, -999.0, -999.0]);
    let twelve = row(
        16,
        [
            11.459_156, 5.729_578, 17.188_734, -999.0, -999.0, -999.0, -999.0, -999.0,
        ],
    );
    let nine = row(17, [0.1, 0.2, 0.3, -999.0, -999.0, -999.0, -999.0, -999.0]);
    for (version, row) in [
        (RowsVersion::XPlane9, nine),
        (RowsVersion::XPlane10, eleven),
        (RowsVersion::XPlane12, twelve),
    ] {
        let mut bench = Bench::new(Some(DataRows::of(version)));
        bench.tick(&[rows(&[row])]);
        let rates = bench.measurements.body_rates.value;
        assert_close(rates.pitch_radps, 0.1);
        assert_close(rates.roll_radps, 0.2);
        assert_close(rates.yaw_radps, 0.3);
    }
}

#[test]
fn rows_fill_every_measurement_one_datagram_each_or_all_in_one() {
    let absent = -999.0;
    let all = [
        row(1, [70.0, 65.0, 60.0, 0.0, absent, 12.0, 12.0, 1.0]),
        row(3, [90.0, 91.0, 95.0, 94.0, absent, 103.6, 109.3, 108.2]),
        row(4, [0.14, absent, 500.0, absent, 1.5, 0.1, -0.05, absent]),
        row(16, [0.1, 0.2, 0.3, absent, absent, absent, absent, absent]),
        row(17, [5.0, -15.0, 80.0, 90.0, absent, absent, absent, absent]),
        row(18, [4.0, 0.5, 80.0, 1.0, absent, absent, absent, 0.1]),
        row(
            20,
            [47.5, -122.25, 3_280.84, 900.0, 0.0, 2_980.0, 47.0, -122.0],
        ),
        row(21, [0.0, 0.0, 0.0, 10.0, 2.0, -40.0, 0.0, 0.0]),
    ];
    let single: Vec<_> = all.iter().map(|row| rows(slice::from_ref(row))).collect();
    for datagrams in [vec![rows(&all)], single] {
        let mut bench = Bench::new(Some(DataRows::of(RowsVersion::XPlane10)));
        let setting = values(&[(Quantity::AltimeterSetting, 29.9)]);
        // X-Plane's own pressure altitude might come until then.
        for _ in 0..=12 {
            bench.tick(&[&datagrams[..], slice::from_ref(&setting)].concat());
        }
        let m = &bench.measurements;
        assert_close(m.plant.value.time_s, 60.0);
        // 90 kt are 46.3 m/s; 3280.84 ft are 1 km. At 29.9 inHg add 20 ft
        // (FAA-H-8083-25C, figure 11-3); 3000 ft are 914.4 m.
        assert_close(m.airspeed_mps.value, 46.3);
        assert!((m.altitude_m.value - 914.4).abs() < 0.2);
        assert!((m.position.value.altitude_m - 1_000.0).abs() < 1e-3);
        assert_close(m.position.value.latitude_rad.to_degrees(), 47.5);
        assert_close(m.position.value.longitude_rad.to_degrees(), -122.25);
        assert_close(m.specific_force.value.x_mps2, 0.980_665);
        assert_close(m.specific_force.value.y_mps2, -0.490_332_5);
        assert_close(m.specific_force.value.z_mps2, -14.709_975);
        assert_close(m.attitude.value.pitch_rad.to_degrees(), 5.0);
        assert_close(m.attitude.value.roll_rad.to_degrees(), -15.0);
        assert_close(m.heading_rad.value.to_degrees(), 90.0);
        assert_close(m.angle_of_attack_rad.value.to_degrees(), 4.0);
        assert_close(m.velocity.value.north_mps, 40.0);
        assert_close(m.velocity.value.east_mps, 10.0);
        assert_close(m.velocity.value.down_mps, -2.0);
        assert_eq!(bench.link.on_ground(), Some(false));
    }
}

#[test]
fn magnetic_heading_is_read_from_the_configured_column() {
    let mut layout = DataRows::of(RowsVersion::XPlane12);
    layout.magnetic_heading_column = 4;
    let mut bench = Bench::new(Some(layout));
    bench.tick(&[rows(&[row(
        17,
        [1.0, 2.0, 100.0, -999.0, 85.0, -999.0, -999.0, -999.0],
    )])]);
    assert_close(bench.measurements.heading_rad.value.to_degrees(), 85.0);
}

#[test]
fn rows_for_another_program_are_ignored() {
    let mut bench = Bench::new(None);
    bench.tick(&[rows(&[row(17, [5.0; 8])])]);
    assert_eq!(bench.measurements, Measurements::default());
}

#[test]
fn noise_on_the_switch_does_not_switch() {
    let mut bench = Bench::new(None);
    for (value, switch) in [
        (0.51, Switch::Off),
        (0.49, Switch::Off),
        (0.75, Switch::On),
        (0.49, Switch::On),
        (0.25, Switch::On),
        (0.24, Switch::Off),
        (0.74, Switch::Off),
    ] {
        bench.tick(&[values(&[(Quantity::EngageSwitch, value)])]);
        assert_eq!(bench.measurements.engage_switch.value, switch);
    }
}

/// X-Plane's local axes lean by 1° and step when their origin moves; attitude,
/// specific force and velocity are those at the aircraft.
#[test]
fn attitude_is_that_at_the_aircraft_where_x_plane_has_it() {
    let frame = |lean_deg: f32| {
        values(&[
            (Quantity::Pitch, 3.0 + lean_deg),
            (Quantity::Roll, 10.0 - lean_deg),
            (Quantity::LocalHeading, 90.0 - lean_deg),
            (Quantity::TruePitch, 3.0),
            (Quantity::TrueRoll, 10.0),
            (Quantity::TrueHeading, 90.0),
            (Quantity::AccelerationEast, lean_deg * 1e-6),
            (Quantity::AccelerationUp, 0.0),
            (Quantity::AccelerationSouth, 0.0),
            (Quantity::VelocityEast, 50.0),
            (Quantity::VelocityUp, 0.0),
            (Quantity::VelocitySouth, 0.0),
        ])
    };
    let mut bench = Bench::new(None);
    for lean_deg in [0.0, 1.0, -1.0] {
        bench.tick(&[frame(lean_deg)]);
        let measured = bench.measurements;
        assert_close(measured.attitude.value.pitch_rad.to_degrees(), 3.0);
        assert_close(measured.attitude.value.roll_rad.to_degrees(), 10.0);
        // g·sin 3° = 0.513 238 m/s², g·cos 3°·sin 10° = 1.700 581 m/s².
        let force = measured.specific_force.value;
        assert!((force.x_mps2 - 0.513_238).abs() < 1e-4, "{force:?}");
        assert!((force.y_mps2 + 1.700_581).abs() < 1e-4, "{force:?}");
        // East in axes whose north is 1° right of true north: 0.8726 m/s south.
        let north = -50.0 * f64::from(lean_deg).to_radians().sin();
        assert!((measured.velocity.value.north_mps - north).abs() < 1e-4);
    }
}

#[test]
fn without_true_angles_or_where_they_are_answered_by_zero_the_local_ones_are_used() {
    let local = [(Quantity::Pitch, 3.0), (Quantity::Roll, 10.0)];
    let zero = [(Quantity::TruePitch, 0.0), (Quantity::TrueRoll, 0.0)];
    for frame in [local.to_vec(), [local, zero].concat()] {
        let mut bench = Bench::new(None);
        bench.tick(&[values(&frame)]);
        assert_close(
            bench.measurements.attitude.value.pitch_rad.to_degrees(),
            3.0,
        );
    }
}

#[test]
fn a_throttle_in_reverse_does_not_hide_the_controls() {
    let mut bench = Bench::new(None);
    for (throttle, read) in [(-0.4, 0.0), (0.6, 0.6), (1.2, 1.0)] {
        bench.tick(&[values(&[
            (Quantity::Throttle, throttle),
            (Quantity::YokePitch, 0.1),
            (Quantity::YokeRoll, 0.0),
            (Quantity::YokeHeading, 0.0),
        ])]);
        let measured = bench.measurements;
        assert_eq!(measured.surfaces.taken, bench.now);
        assert!((measured.surfaces.value.throttle - read).abs() < 1e-6);
    }
}

/// With the nose 4° high an accelerometer measures 0.0698 g forwards: a row that
/// has it negative is positive backwards.
#[test]
fn the_sign_of_the_axial_load_is_found_out_in_flight() {
    let absent = -999.0;
    let mut bench = Bench::new(Some(DataRows::of(RowsVersion::XPlane12)));
    for _ in 0..240 {
        bench.tick(&[rows(&[
            row(3, [90.0, 90.0, 95.0, 94.0, absent, 0.0, 0.0, 0.0]),
            row(4, [0.14, absent, 0.0, absent, 1.0, -0.0698, 0.0, absent]),
            row(17, [4.0, 0.0, 80.0, 90.0, absent, absent, absent, absent]),
        ])]);
    }
    let force = bench.measurements.specific_force.value;
    assert!((force.x_mps2 - 0.684_5).abs() < 1e-3, "{force:?}");
    assert!(bench.link.is_axial_backwards());
}
