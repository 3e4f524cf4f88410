//! The datagrams, byte by byte.

use super::*;

/// The datagrams that were sent.
fn sent(act: impl FnOnce(&mut dyn FnMut(&[u8]) -> Result<(), Errno>)) -> Vec<Vec<u8>> {
    let mut datagrams = Vec::new();
    act(&mut |datagram| {
        let each = datagram.chunks(dref::WRITE_BYTES);
        datagrams.extend(each.map(<[u8]>::to_vec));
        Ok(())
    });
    datagrams
}

fn named(datagrams: &[Vec<u8>]) -> Vec<(String, f32)> {
    datagrams
        .iter()
        .map(|datagram| {
            assert_eq!(datagram.len(), 509);
            assert_eq!(&datagram[..5], b"DREF\0");
            let value = f32::from_le_bytes(datagram[5..9].try_into().unwrap());
            let path = datagram[9..].split(|byte| *byte == 0).next().unwrap();
            (String::from_utf8(path.to_vec()).unwrap(), value)
        })
        .collect()
}

const SURFACES: Surfaces = Surfaces {
    throttle: 0.75,
    elevator: 0.5,
    aileron: -0.25,
    rudder: 0.125,
    ..Surfaces::IDLE
};

#[test]
fn each_surface_and_engine_is_written_separately() {
    let config = XPlaneConfig {
        engines: 2,
        ..XPlaneConfig::default()
    };
    let mut controls = Controls::new(&config).unwrap();
    let writes = named(&sent(|send| controls.set(&SURFACES, send).unwrap()));
    let expected = [
        ("sim/joystick/yoke_pitch_ratio", 0.5),
        ("sim/joystick/yoke_roll_ratio", -0.25),
        ("sim/joystick/yoke_heading_ratio", 0.125),
        ("sim/flightmodel/engine/ENGN_thro_use[0]", 0.75),
        ("sim/flightmodel/engine/ENGN_thro_use[1]", 0.75),
    ];
    assert_eq!(writes, expected.map(|(path, v)| (path.to_owned(), v)));
}

#[test]
fn a_release_centres_first_and_clears_the_overrides_last() {
    let mut controls = Controls::new(&XPlaneConfig::default()).unwrap();
    sent(|send| controls.set(&SURFACES, send).unwrap());
    let writes = named(&sent(|send| controls.release(send).unwrap()));
    let expected = [
        "sim/joystick/yoke_pitch_ratio",
        "sim/joystick/yoke_roll_ratio",
        "sim/joystick/yoke_heading_ratio",
        "sim/operation/override/override_joystick",
        "sim/operation/override/override_throttles",
    ];
    assert_eq!(writes, expected.map(|path| (path.to_owned(), 0.0)));
}

#[test]
fn the_trim_is_written_last_and_stays_at_a_release() {
    for output in [Output::Dref, Output::Data] {
        let config = XPlaneConfig {
            output,
            ..XPlaneConfig::default()
        };
        let mut controls = Controls::new(&config).unwrap();
        let trimmed = Surfaces {
            elevator_trim: Some(-0.375),
            ..SURFACES
        };
        let mut datagrams = sent(|send| controls.set(&trimmed, send).unwrap());
        let last = named(&[datagrams.pop().unwrap()]);
        let expected = ("sim/flightmodel/controls/elv_trim".to_owned(), -0.375);
        assert_eq!(last, [expected]);
        let without = sent(|send| controls.set(&SURFACES, send).unwrap());
        assert_eq!(without, datagrams);
        let released = sent(|send| controls.release(send).unwrap());
        assert!(!released.concat().windows(8).any(|path| path == b"elv_trim"));
    }
}

#[test]
fn by_rows_it_is_one_datagram_with_joystick_and_throttles() {
    let config = XPlaneConfig {
        output: Output::Data,
        engines: 2,
        ..XPlaneConfig::default()
    };
    let mut controls = Controls::new(&config).unwrap();
    let datagrams = sent(|send| controls.set(&SURFACES, send).unwrap());
    let mut expected = b"DATA\0\x08\0\0\0".to_vec();
    for column in [
        0.5_f32, -0.25, 0.125, -999.0, -999.0, -999.0, -999.0, -999.0,
    ] {
        expected.extend(column.to_le_bytes());
    }
    expected.extend([25, 0, 0, 0]);
    for column in [
        0.75_f32, 0.75, -999.0, -999.0, -999.0, -999.0, -999.0, -999.0,
    ] {
        expected.extend(column.to_le_bytes());
    }
    assert_eq!(datagrams, [expected]);
}

/// X-Plane's dataref is an int, 0 up and 1 down; in rows it is a dataref, too.
#[test]
fn the_gears_handle_is_up_or_down_and_stays_at_a_release() {
    for output in [Output::Dref, Output::Data] {
        let config = XPlaneConfig {
            output,
            ..XPlaneConfig::default()
        };
        let mut controls = Controls::new(&config).unwrap();
        let without = sent(|send| controls.set(&SURFACES, send).unwrap());
        for (gear, handle) in [(0.0, 0.0), (1.0, 1.0), (0.49, 0.0), (7.0, 1.0)] {
            let moved = Surfaces {
                gear: Some(gear),
                ..SURFACES
            };
            assert_eq!(controls.messages(&moved), without.len() + 1);
            // Each time, as a datagram may be lost.
            for _ in 0..2 {
                let mut datagrams = sent(|send| controls.set(&moved, send).unwrap());
                let last = named(&[datagrams.pop().unwrap()]);
                let path = "sim/cockpit2/controls/gear_handle_down".to_owned();
                assert_eq!(last, [(path, handle)]);
                assert_eq!(datagrams, without);
            }
        }
        let unknown = Surfaces {
            gear: Some(f64::NAN),
            ..SURFACES
        };
        assert_eq!(sent(|send| controls.set(&unknown, send).unwrap()), without);
        let released = sent(|send| controls.release(send).unwrap());
        assert!(!released.concat().windows(4).any(|path| path == b"gear"));
    }
}

/// The rows are X-Plane's: 13 has the flaps in column 3, 14 the gear in 0 and the brakes
/// in 2 and 3.
#[test]
fn a_servo_board_has_flaps_brakes_and_gear_in_each_eighth_datagram() {
    let config = XPlaneConfig {
        output: Output::Data,
        plant: PlantKind::ServoBoard,
        ..XPlaneConfig::default()
    };
    let mut controls = Controls::new(&config).unwrap();
    let braking = Surfaces {
        flaps: Some(0.5),
        left_brake: Some(0.25),
        right_brake: Some(1.0),
        gear: Some(1.0),
        ..SURFACES
    };
    let mut lengths = Vec::new();
    let mut first = Vec::new();
    for _ in 0..10 {
        assert_eq!(controls.messages(&braking), 1);
        let sent = sent(|send| controls.set(&braking, send).unwrap());
        lengths.extend(sent.iter().map(Vec::len));
        first.extend(sent);
    }
    assert_eq!(lengths, [149, 77, 77, 77, 77, 77, 77, 77, 149, 77]);
    let rows: Vec<_> = data::parse(&first[0]).unwrap().skip(2).collect();
    let row = |index, columns| data::Row { index, columns };
    let none = None;
    assert_eq!(
        rows,
        [
            row(13, [none, none, none, Some(0.5), none, none, none, none]),
            row(
                14,
                [
                    Some(1.0),
                    none,
                    Some(0.25),
                    Some(1.0),
                    none,
                    none,
                    none,
                    none
                ]
            ),
        ]
    );
    // Nothing but surfaces and overrides is written at the release.
    let released = sent(|send| controls.release(send).unwrap());
    assert_eq!(released.len(), 4);
}

#[test]
fn values_out_of_range_are_limited_or_not_sent() {
    let mut controls = Controls::new(&XPlaneConfig::default()).unwrap();
    let surfaces = Surfaces {
        throttle: -3.0,
        elevator: f64::NAN,
        aileron: f64::INFINITY,
        rudder: -7.0,
        elevator_trim: Some(1.5),
        ..Surfaces::IDLE
    };
    let writes = named(&sent(|send| controls.set(&surfaces, send).unwrap()));
    let expected = [
        ("sim/joystick/yoke_roll_ratio", 1.0),
        ("sim/joystick/yoke_heading_ratio", -1.0),
        ("sim/flightmodel/engine/ENGN_thro_use[0]", 0.0),
        ("sim/flightmodel/controls/elv_trim", 1.0),
    ];
    assert_eq!(writes, expected.map(|(path, v)| (path.to_owned(), v)));
}

#[test]
fn one_refused_datagram_does_not_prevent_the_others() {
    let mut controls = Controls::new(&XPlaneConfig::default()).unwrap();
    let mut tried = 0;
    let outcome = controls.release(|_| {
        tried += 1;
        if tried == 1 { Err(11) } else { Ok(()) }
    });
    assert_eq!((outcome, tried), (Err(11), 5));
}
