//! The whole screen, drawn from a fixed picture.

use fcc_core::flight::{AltitudeReference, Attitude, Surfaces};
use fcc_core::framework::{Flags, Reading, RecordOf, State, Tick, Time};
use fcc_fixed_wing::Autopilot;
use fcc_guidance::Mode;
use fcc_live::{Event, EventCode, Info, RecorderState, Status, Text};
use fcc_telemetry::Instance;
use ratatui::Terminal;
use ratatui::backend::TestBackend;

use super::picture::Picture;
use super::screen;

/// 60 s into a flight: turning right and climbing.
fn picture() -> Picture<Autopilot> {
    let mut picture = Picture::of(&Info {
        rate_hz: 40.0,
        timer: Text::new("timerfd"),
        policy: Text::new("SCHED_FIFO"),
        priority: 80,
        plant: Text::new("built-in aircraft"),
        ..Info::default()
    });
    for (at_s, code, text) in [
        (0.5, EventCode::Remark, "X-Plane at 127.0.0.1:49000 answers"),
        (2.0, EventCode::StateChanged, "standby -> engaged"),
    ] {
        picture.event(Event {
            // The first tick is a period after publishing began, and time counts from it.
            time_ns: ((0.025 + at_s) * 1e9) as i64,
            code: code as u32,
            text: Text::new(text),
            ..Event::default()
        });
    }
    let woke = Time::from_nanos(60_000_000_000);
    let mut record = RecordOf::<Autopilot> {
        tick: Tick {
            number: 2_400,
            scheduled: woke,
            woke,
            missed: 0,
            dt_s: 0.025,
        },
        state: State::Engaged.into(),
        sent: true,
        outputs: Surfaces {
            throttle: 0.75,
            elevator: -0.5,
            aileron: 1.0,
            rudder: 0.0,
            ..Surfaces::IDLE
        },
        ..RecordOf::<Autopilot>::default()
    };
    let taken = Time::from_nanos(59_980_000_000);
    let measured = &mut record.measurements;
    measured.attitude = Reading::new(
        Attitude {
            pitch_rad: 5_f64.to_radians(),
            roll_rad: 30_f64.to_radians(),
        },
        taken,
    );
    measured.heading_rad = Reading::new(80_f64.to_radians(), taken);
    measured.altitude_m = Reading::new(914.4, taken);
    measured.airspeed_mps = Reading::new(185.2 / 3.6, Time::from_nanos(58_000_000_000));
    record.setpoints.heading_rad = 90_f64.to_radians();
    record.setpoints.altitude_m = 960.12;
    record.setpoints.airspeed_mps = 185.2 / 3.6;
    record.setpoints.guidance.mode = Mode::TimedPattern;
    record.setpoints.guidance.item = 1;
    record.early_wake_ns = 142_000;
    record.stages.control_ns = 1_500;
    record.stages.total_ns = 12_345;
    picture.record(&record);
    picture.status = Some(Status {
        time_ns: 60_000_000_000,
        ticks: 2_400,
        lateness_p50_ns: 15_200,
        lateness_p99_ns: 43_000,
        lateness_p99_9_ns: 98_000,
        lateness_max_ns: 1_230_000,
        lateness_counts: [0, 0, 0, 0, 400, 1_900, 99, 0, 0, 1, 0, 0, 0, 0],
        cpu_ns: 180_000_000,
        watchers: 2,
        recorder_state: RecorderState::Recording as u32,
        recorded: 2_390,
        recording_bytes: 3 * 1_048_576,
        recording: Text::new("2026-01-02T03-04-05.mcap"),
        ..Status::default()
    });
    picture
}

fn drawn(picture: &Picture<Autopilot>, width: u16, height: u16) -> Vec<String> {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
    terminal
        .draw(|frame| screen::draw(frame, &Instance::default(), picture))
        .unwrap();
    let buffer = terminal.backend().buffer();
    (0..height)
        .map(|y| {
            let row: String = (0..width).map(|x| buffer[(x, y)].symbol()).collect();
            row.trim_end().to_owned()
        })
        .collect()
}

#[test]
fn the_whole_screen() {
    let rows = drawn(&picture(), 80, 24).join("\n") + "\n";
    let expected = include_str!("screen.txt");
    assert!(rows == expected, "the screen is now:\n{rows}");
}

#[test]
fn any_size_is_drawn() {
    for (width, height) in [(1, 1), (79, 24), (80, 23), (80, 25), (200, 60), (500, 24)] {
        drawn(&picture(), width, height);
    }
    assert!(drawn(&picture(), 60, 20)[0].contains("needs 80 x 24"));
    // New events are visible on a larger screen, too.
    assert!(
        drawn(&picture(), 132, 50)
            .concat()
            .contains("standby -> engaged")
    );
}

#[test]
fn nothing_known_yet_is_drawn() {
    let rows = drawn(&Picture::<Autopilot>::of(&Info::default()), 80, 24).concat();
    assert!(rows.contains("waiting for the first tick"), "{rows}");
}

#[test]
fn its_end_is_shown() {
    let mut picture = picture();
    picture.ended = true;
    let rows = drawn(&picture, 80, 24);
    assert!(rows[0].contains("ENDED"));
    assert!(rows[23].contains("fccd 'fccd' has ended"));
}

/// At 30.2 inHg an altitude is 257 ft more than its pressure altitude
/// (FAA-H-8083-25C, figure 11-3): 3,000 and 3,150 ft.
#[test]
fn altitudes_are_shown_above_what_they_refer_to() {
    let mut picture = picture();
    let mut record = picture.record.unwrap();
    record.setpoints.altimeter_setting_pa = 30.2 * 3_386.389;
    record.setpoints.altitude_reference = AltitudeReference::SeaLevel;
    picture.record(&record);
    let rows = drawn(&picture, 80, 24).join("\n");
    assert!(rows.contains("timed-pattern, QNH 1023"), "{rows}");
    assert!(rows.contains("altitude  3257 →   3407 ft"), "{rows}");
    record.setpoints.altitude_reference = AltitudeReference::PressureLevel;
    picture.record(&record);
    let rows = drawn(&picture, 80, 24).join("\n");
    assert!(rows.contains("pressure  3000 →   3150 ft"), "{rows}");
}

#[test]
fn engage_inhibits_are_shown() {
    let mut picture = picture();
    let mut record = picture.record.unwrap();
    record.state = State::Standby.into();
    record.engage_inhibits = Flags::bit(0);
    picture.record(&record);
    let rows = drawn(&picture, 80, 24);
    assert!(rows[0].contains("STANDBY"));
    assert!(rows[23].contains("not ready: "), "{}", rows[23]);
}
