//! The board: what it takes, what it sends, and when it is on its own. The
//! messages are written out from X-Plane's layouts.

use fcc_servo_board::{
    Board, BoardConfig, Control, DIFFERENTIAL_PRESSURE, Drive, ENGAGE_SWITCH, MAX_MESSAGE,
    NotForBoard, Readings, Surfaces,
};
use proptest::prelude::*;

const AIRSPEED: &str = "sim/flightmodel/position/indicated_airspeed";
const JOYSTICK: &str = "sim/operation/override/override_joystick";
const THROTTLES: &str = "sim/operation/override/override_throttles";
const PITCH: &str = "sim/joystick/yoke_pitch_ratio";
const THROTTLE: &str = "sim/flightmodel/engine/ENGN_thro_use[0]";
const AS_IT_IS: f32 = -999.0;

fn padded(mut message: Vec<u8>, path: &str, length: usize) -> Vec<u8> {
    message.extend(path.as_bytes());
    message.resize(length, 0);
    message
}

fn rref(frequency_hz: i32, index: i32, path: &str) -> Vec<u8> {
    let head = [
        b"RREF\0",
        &frequency_hz.to_le_bytes()[..],
        &index.to_le_bytes(),
    ]
    .concat();
    padded(head, path, 413)
}

fn dref(path: &str, value: f32) -> Vec<u8> {
    padded([b"DREF\0", &value.to_le_bytes()[..]].concat(), path, 509)
}

fn row(index: i32, columns: &[f32]) -> Vec<u8> {
    let mut row = index.to_le_bytes().to_vec();
    for column in 0..8 {
        let value = columns.get(column).copied().unwrap_or(AS_IT_IS);
        row.extend(value.to_le_bytes());
    }
    row
}

fn surfaces(elevator: f32, aileron: f32, rudder: f32, throttle: f32) -> Vec<u8> {
    let [yoke, throttles] = [row(8, &[elevator, aileron, rudder]), row(25, &[throttle])];
    [b"DATA\0", &yoke[..], &throttles].concat()
}

fn pairs(reply: &[u8]) -> Vec<(i32, f32)> {
    assert_eq!(&reply[..4], b"RREF");
    let (pairs, rest) = reply[5..].as_chunks::<8>();
    assert!(rest.is_empty());
    let each = pairs.iter().map(|pair| {
        let (index, value) = pair.split_at(4);
        let index = i32::from_le_bytes(index.try_into().unwrap());
        let value = f32::from_le_bytes(value.try_into().unwrap());
        // An f32 of 100 may be 99.99999.
        (index, (value * 1e4).round() / 1e4)
    });
    each.collect()
}

/// A board with a clock, on a line to one computer.
struct Bench {
    board: Board,
    now_ms: u32,
    readings: Readings,
}

impl Bench {
    fn new() -> Self {
        Self {
            board: Board::new(BoardConfig::default()),
            now_ms: 5,
            readings: Readings::default(),
        }
    }

    fn holding() -> Self {
        let mut bench = Self::new();
        bench.take();
        bench.give(&surfaces(0.1, -0.2, 0.3, 0.4)).unwrap();
        bench
    }

    fn take(&mut self) {
        self.give(&dref(JOYSTICK, 1.0)).unwrap();
        self.give(&dref(THROTTLES, 1.0)).unwrap();
    }

    fn give(&mut self, message: &[u8]) -> Result<(), NotForBoard> {
        self.board.receive(self.now_ms, (), message)
    }

    fn subscribe(&mut self, paths: &[&str]) {
        for (index, path) in (100..).zip(paths) {
            self.give(&rref(250, index, path)).unwrap();
        }
    }

    /// After so long, polled every millisecond: what was sent.
    fn wait(&mut self, ms: u32) -> Vec<Vec<(i32, f32)>> {
        let mut sent = Vec::new();
        for _ in 0..ms {
            self.now_ms = self.now_ms.wrapping_add(1);
            let mut into = [0; MAX_MESSAGE];
            let reply = self.board.poll(self.now_ms, &self.readings, &mut into);
            sent.extend(reply.map(pairs));
        }
        sent
    }
}

fn drive(control: Control, surfaces: Option<[f32; 3]>, throttle: Option<f32>) -> Drive {
    Drive {
        control,
        surfaces,
        throttle,
        flaps: None,
        brakes: None,
        gear: None,
    }
}

const CENTRED: Option<[f32; 3]> = Some([0.0; 3]);

#[test]
fn surfaces_are_followed_once_control_is_taken() {
    let mut bench = Bench::new();
    let free = drive(Control::Free, None, None);
    assert_eq!(bench.board.drive(), free);
    let written = surfaces(0.1, -0.2, 0.3, 0.4);
    assert_eq!(bench.give(&written), Err(NotForBoard::NotHeld));
    assert_eq!(bench.board.drive(), free);
    bench.take();
    // Nothing moves before the first write.
    assert_eq!(bench.board.drive(), drive(Control::Held, None, None));
    bench.give(&written).unwrap();
    let held = drive(Control::Held, Some([0.1, -0.2, 0.3]), Some(0.4));
    assert_eq!(bench.board.drive(), held);
    // One by one, and without the padding.
    let short = [b"DREF\0\0\0\0\xbf", PITCH.as_bytes()].concat();
    bench.give(&short).unwrap();
    bench.give(&dref(THROTTLE, 1.5)).unwrap();
    let held = drive(Control::Held, Some([-0.5, -0.2, 0.3]), Some(1.0));
    assert_eq!(bench.board.drive(), held);
    // A column that is to be left as it is.
    let left = [b"DATA\0", &row(8, &[AS_IT_IS, 2.0])[..]].concat();
    bench.give(&left).unwrap();
    let held = drive(Control::Held, Some([-0.5, 1.0, 0.3]), Some(1.0));
    assert_eq!(bench.board.drive(), held);
}

#[test]
fn flaps_brakes_and_gear_stay_as_written_until_the_release() {
    let [flaps, brakes] = [
        "sim/cockpit2/controls/flap_ratio",
        "sim/cockpit2/controls/left_brake_ratio",
    ];
    let mut bench = Bench::new();
    assert_eq!(bench.give(&dref(flaps, 0.5)), Err(NotForBoard::NotHeld));
    bench.take();
    bench.give(&surfaces(0.1, -0.2, 0.3, 0.4)).unwrap();
    assert_eq!(
        (bench.board.drive().flaps, bench.board.drive().brakes),
        (None, None)
    );
    // Column 3 of row 13, columns 0, 2 and 3 of row 14.
    let rows = [
        row(13, &[AS_IT_IS, AS_IT_IS, AS_IT_IS, 0.5]),
        row(14, &[0.0, 1.0, 0.25, 0.75]),
    ];
    bench
        .give(&[b"DATA\0", &rows.concat()[..]].concat())
        .unwrap();
    let driven = |bench: &Bench| (bench.board.drive().flaps, bench.board.drive().brakes);
    assert_eq!(driven(&bench), (Some(0.5), Some([0.25, 0.75])));
    assert_eq!(bench.board.drive().gear, Some(0.0));
    bench.give(&dref(brakes, 3.0)).unwrap();
    bench.give(&dref(flaps, -1.0)).unwrap();
    bench.subscribe(&[flaps, brakes]);
    assert_eq!(bench.wait(20), [[(100, 0.0), (101, 1.0)]]);
    bench.wait(200);
    assert_eq!(bench.board.control(), Control::Failsafe);
    assert_eq!(driven(&bench), (Some(0.0), Some([1.0, 0.75])));
    // The wheels are out where the aircraft comes down; back in control, as written.
    assert_eq!(bench.board.drive().gear, Some(1.0));
    bench.give(&dref(flaps, 0.0)).unwrap();
    assert_eq!(bench.board.drive().gear, Some(0.0));
    bench.give(&dref(JOYSTICK, 0.0)).unwrap();
    assert_eq!(driven(&bench), (None, None));
    assert_eq!(bench.board.drive().gear, None);
}

#[test]
fn a_release_frees_the_servos_and_what_was_written_is_forgotten() {
    let mut bench = Bench::holding();
    bench.give(&surfaces(0.0, 0.0, 0.0, AS_IT_IS)).unwrap();
    bench.give(&dref(JOYSTICK, 0.0)).unwrap();
    assert_eq!(bench.board.drive(), drive(Control::Held, None, Some(0.4)));
    bench.give(&dref(THROTTLES, 0.0)).unwrap();
    assert_eq!(bench.board.drive(), drive(Control::Free, None, None));
    bench.wait(1_000);
    assert_eq!(bench.board.control(), Control::Free);
    bench.take();
    assert_eq!(bench.board.drive(), drive(Control::Held, None, None));
}

#[test]
fn after_200_ms_of_silence_the_surfaces_are_centred() {
    let mut bench = Bench::holding();
    for _ in 0..10 {
        bench.wait(199);
        assert_eq!(bench.board.control(), Control::Held);
        bench.give(&surfaces(0.5, 0.0, 0.0, 0.6)).unwrap();
    }
    // Requests and overrides do not keep control.
    bench.wait(199);
    bench.subscribe(&[AIRSPEED]);
    bench.take();
    bench.wait(1);
    let failsafe = drive(Control::Failsafe, CENTRED, Some(0.0));
    assert_eq!(bench.board.drive(), failsafe);
    bench.take();
    bench.wait(10_000);
    assert_eq!(bench.board.drive(), failsafe);
    // The computer is back.
    bench.give(&surfaces(0.1, 0.2, 0.3, 0.4)).unwrap();
    let held = drive(Control::Held, Some([0.1, 0.2, 0.3]), Some(0.4));
    assert_eq!(bench.board.drive(), held);
    // Taken, and never written.
    let mut bench = Bench::new();
    bench.take();
    bench.wait(200);
    assert_eq!(bench.board.drive(), failsafe);
    bench.give(&dref(JOYSTICK, 0.0)).unwrap();
    bench.give(&dref(THROTTLES, 0.0)).unwrap();
    assert_eq!(bench.board.control(), Control::Free);
}

#[test]
fn the_failsafe_is_as_configured_also_while_the_clock_begins_again() {
    let mut bench = Bench::new();
    let glide = Surfaces {
        elevator: 0.1,
        aileron: 0.05,
        rudder: -0.02,
        throttle: 0.3,
    };
    bench.board = Board::new(BoardConfig {
        failsafe: glide,
        failsafe_after_ms: 500,
        ..BoardConfig::default()
    });
    bench.now_ms = u32::MAX - 250;
    bench.take();
    bench.give(&surfaces(1.0, 1.0, 1.0, 1.0)).unwrap();
    bench.wait(499);
    assert_eq!(bench.board.control(), Control::Held);
    bench.wait(1);
    let failsafe = drive(Control::Failsafe, Some([0.1, 0.05, -0.02]), Some(0.3));
    assert_eq!(bench.board.drive(), failsafe);
}

/// 100 kt are 51.444 m/s: the international knot is 1852 m an hour.
#[test]
fn requested_values_are_sent_together_every_20_ms() {
    let mut bench = Bench::new();
    bench.readings = Readings {
        airspeed_mps: Some(51.444_443),
        differential_pressure_pa: Some(-12.5),
        engage_switch: Some(true),
        pilot: None,
    };
    assert!(bench.wait(100).is_empty());
    bench.subscribe(&[
        AIRSPEED,
        DIFFERENTIAL_PRESSURE,
        ENGAGE_SWITCH,
        JOYSTICK,
        PITCH,
    ]);
    let sent = bench.wait(1_000);
    assert_eq!(sent.len(), 50);
    // Nobody knows where the pilot has the elevator.
    let expected = [(100, 100.0), (101, -12.5), (102, 1.0), (103, 0.0)];
    for reply in &sent {
        assert_eq!(reply.as_slice(), expected);
    }
    bench.readings.airspeed_mps = Some(f32::NAN);
    bench.readings.engage_switch = None;
    bench.readings.pilot = Some(Surfaces {
        elevator: 0.7,
        ..Surfaces::default()
    });
    assert_eq!(bench.wait(20), [[(101, -12.5), (103, 0.0), (104, 0.7)]]);
    bench.take();
    bench.give(&surfaces(-0.25, 0.0, 0.0, 0.0)).unwrap();
    assert_eq!(bench.wait(20), [[(101, -12.5), (103, 1.0), (104, -0.25)]]);
    // Ended, and requested less often.
    bench.give(&rref(0, 101, DIFFERENTIAL_PRESSURE)).unwrap();
    bench.give(&rref(10, 103, JOYSTICK)).unwrap();
    bench.give(&rref(0, 104, PITCH)).unwrap();
    assert_eq!(bench.wait(1_000).len(), 10);
}

/// By it the computer tells a message that arrives late from a new one.
#[test]
fn a_message_has_the_time_at_which_it_was_made_in_seconds() {
    let mut bench = Bench::new();
    bench.subscribe(&["sim/network/misc/network_time_sec"]);
    bench.wait(20);
    bench.now_ms = 12_500;
    assert_eq!(bench.wait(20), [[(100, 12.501)]]);
    let set = bench.give(&dref("sim/network/misc/network_time_sec", 1.0));
    assert_eq!(set, Err(NotForBoard::NoSuchValue));
}

#[test]
fn what_the_board_does_not_have_is_refused() {
    let mut bench = Bench::new();
    bench.take();
    let cases: [(&[u8], NotForBoard); 12] = [
        (b"", NotForBoard::Unknown),
        (b"RREF", NotForBoard::Unknown),
        (b"RREF\0\x01\0\0\0\x01\0\0\0", NotForBoard::Unknown),
        (b"CMND\0sim/none", NotForBoard::Unknown),
        (b"DATA\0\x08\0\0\0", NotForBoard::Unknown),
        (&rref(10, 1, "sim/time/paused"), NotForBoard::NoSuchValue),
        (&dref(AIRSPEED, 1.0), NotForBoard::NoSuchValue),
        (&dref(ENGAGE_SWITCH, 1.0), NotForBoard::NoSuchValue),
        (&dref(PITCH, f32::NAN), NotForBoard::NotFinite),
        (&dref(JOYSTICK, f32::INFINITY), NotForBoard::NotFinite),
        (
            &[b"DATA\0", &row(3, &[1.0])[..]].concat(),
            NotForBoard::NoSuchValue,
        ),
        (&surfaces(f32::NAN, 0.1, 0.1, 0.1), NotForBoard::NotFinite),
    ];
    for (message, expected) in cases {
        assert_eq!(bench.give(message), Err(expected), "{message:?}");
    }
    // The elevator was refused, so there are no surfaces to drive.
    assert_eq!(bench.board.drive(), drive(Control::Held, None, Some(0.1)));
}

#[test]
fn only_the_computer_that_holds_control_is_heard_until_it_is_lost() {
    let mut board = Board::new(BoardConfig::default());
    let [first, second] = [1, 2];
    board.receive(0, first, &rref(50, 7, JOYSTICK)).unwrap();
    board.receive(0, second, &rref(50, 8, JOYSTICK)).unwrap();
    assert_eq!(board.peer(), Some(second));
    board.receive(1, first, &dref(JOYSTICK, 1.0)).unwrap();
    board
        .receive(1, first, &surfaces(0.5, 0.5, 0.5, 0.5))
        .unwrap_err();
    assert_eq!(board.drive().surfaces, Some([0.5; 3]));
    for stranger in [&dref(JOYSTICK, 0.0), &surfaces(-1.0, -1.0, -1.0, 1.0)] {
        assert_eq!(
            board.receive(100, second, stranger),
            Err(NotForBoard::Stranger)
        );
    }
    assert_eq!(
        (board.peer(), board.control()),
        (Some(first), Control::Held)
    );
    board.receive(201, second, &dref(JOYSTICK, 0.0)).unwrap();
    assert_eq!(
        (board.peer(), board.control()),
        (Some(second), Control::Free)
    );
}

proptest! {
    /// Whatever arrives, a servo is driven within its range, and after 200 ms of
    /// silence by nobody or to the failsafe.
    #[test]
    fn any_bytes_move_no_servo_out_of_its_range(
        messages in prop::collection::vec(
            prop_oneof![
                prop::collection::vec(any::<u8>(), 0..100),
                any::<[f32; 4]>().prop_map(|[e, a, r, t]| surfaces(e, a, r, t)),
                (any::<f32>(), prop::sample::select(vec![JOYSTICK, THROTTLES, PITCH, THROTTLE]))
                    .prop_map(|(value, path)| dref(path, value)),
                (any::<i32>(), any::<i32>(), prop::sample::select(vec![JOYSTICK, AIRSPEED]))
                    .prop_map(|(frequency_hz, index, path)| rref(frequency_hz, index, path)),
            ],
            0..60,
        ),
        now_ms in any::<u32>(),
    ) {
        let mut bench = Bench::new();
        bench.now_ms = now_ms;
        for message in messages {
            let _ = bench.give(&message);
            bench.wait(3);
            let driven = bench.board.drive();
            for surface in driven.surfaces.into_iter().flatten() {
                prop_assert!((-1.0..=1.0).contains(&surface));
            }
            prop_assert!(driven.throttle.is_none_or(|throttle| (0.0..=1.0).contains(&throttle)));
        }
        bench.wait(200);
        let driven = bench.board.drive();
        prop_assert!(driven.control != Control::Held);
        prop_assert!(driven.surfaces.is_none_or(|surfaces| surfaces == [0.0; 3]));
        prop_assert!(driven.throttle.is_none_or(|throttle| throttle == 0.0));
    }
}
