//! Commands: results are those of MAVLink's `common.xml` and of `mavsdk_mavlink_tests` (2026-10).

use fcc_mavlink::{Action, Mode};
use mavlink::dialects::common::{
    COMMAND_LONG_DATA, HEARTBEAT_DATA, MavCmd, MavMessage, MavModeFlag, MavResult as Code,
    SET_MODE_DATA,
};

use crate::lossy::upload;
use crate::world::{World, flying, waypoint};

/// `COMMAND_LONG` with any number.
pub(crate) fn long(number: u16, parameters: [f32; 7], confirmation: u8) -> Vec<u8> {
    let mut payload: Vec<u8> = parameters.into_iter().flat_map(f32::to_le_bytes).collect();
    payload.extend(number.to_le_bytes());
    payload.extend([1, 1, confirmation]);
    payload
}

/// `COMMAND_INT` with any number.
fn int(number: u16, frame: u8, [a, b, c, d]: [f32; 4], (x, y, z): (i32, i32, f32)) -> Vec<u8> {
    let mut payload: Vec<u8> = [a, b, c, d]
        .into_iter()
        .flat_map(f32::to_le_bytes)
        .collect();
    payload.extend([x, y].into_iter().flat_map(i32::to_le_bytes));
    payload.extend(z.to_le_bytes());
    payload.extend(number.to_le_bytes());
    payload.extend([1, 1, frame, 0, 0]);
    payload
}

/// A frame of any payload: the crate makes only those of its enums.
pub(crate) fn frame(
    (system, component): (u8, u8),
    sequence: u8,
    id: u32,
    payload: &[u8],
) -> Vec<u8> {
    let [a, b, c, _] = id.to_le_bytes();
    let mut bytes = vec![
        0xfd,
        payload.len() as u8,
        0,
        0,
        sequence,
        system,
        component,
        a,
        b,
        c,
    ];
    bytes.extend(payload);
    let extra = <MavMessage as mavlink::Message>::extra_crc(id);
    bytes.extend(mavlink::calculate_crc(&bytes[1..], extra).to_le_bytes());
    bytes
}

pub(crate) struct Station<'a> {
    world: &'a mut World,
    sequence: u8,
}

impl Station<'_> {
    fn give(&mut self, id: u32, payload: &[u8]) -> Vec<Code> {
        self.sequence = self.sequence.wrapping_add(1);
        let bytes = frame((255, 190), self.sequence, id, payload);
        self.world.inbox.clear();
        self.world.send_bytes(1, bytes);
        let acks = self.world.all(1_500);
        acks.into_iter()
            .filter_map(|message| match message {
                MavMessage::COMMAND_ACK(ack) => Some(ack.result),
                _ => None,
            })
            .collect()
    }

    pub(crate) fn long(&mut self, number: u16, parameters: &[f32]) -> Code {
        let mut all = [0.0; 7];
        all[..parameters.len()].copy_from_slice(parameters);
        let codes = self.give(76, &long(number, all, 0));
        assert_eq!(codes.len(), 1, "command {number}: {codes:?}");
        codes[0]
    }
}

pub(crate) fn station(world: &mut World) -> Station<'_> {
    Station { world, sequence: 0 }
}

pub(crate) fn world_with_mission() -> World {
    let mut world = World::new();
    let items: Vec<_> = (0..4).map(waypoint).collect();
    upload(&mut world, 1, &items).expect("an answer");
    world.asked.clear();
    world
}

/// What a command came to, as set points of the daemon.
fn given(world: &World) -> Vec<String> {
    let commands = world.asked.iter().flat_map(|action| match action {
        Action::Commands(commands) => commands.clone(),
        Action::Plan { .. } => Vec::new(),
    });
    commands.map(|command| format!("{command:?}")).collect()
}

/// Plane is silent on 128 of them (`mavsdk_mavlink_tests`).
#[test]
fn every_number_has_exactly_one_final_answer_in_both_encodings() {
    const IN_PROGRESS: u8 = 5;
    let mut world = world_with_mission();
    let mut supported = [0, 0];
    let mut sequence = 0_u8;
    for number in 0..=u16::MAX {
        for is_int in [false, true] {
            sequence = sequence.wrapping_add(1);
            let (id, payload) = if is_int {
                (75, int(number, 6, [0.0; 4], (i32::MAX, i32::MAX, 0.0)))
            } else {
                let unset = [0.0, 0.0, 0.0, 0.0, f32::NAN, f32::NAN, 0.0];
                (76, long(number, unset, 0))
            };
            world.acks.clear();
            world.send_bytes(1, frame((255, 190), sequence, id, &payload));
            world.step();
            world.step();
            let [(answered, result)] = world.acks[..] else {
                panic!("command {number}, int: {is_int}: {:?}", world.acks);
            };
            assert_eq!(answered, number);
            assert_ne!(result, IN_PROGRESS, "command {number}");
            if result != Code::MAV_RESULT_UNSUPPORTED as u8 {
                supported[usize::from(is_int)] += 1;
            }
        }
    }
    // The 25 of docs/mavlink.md, without 512, which asks for message 0 here.
    assert_eq!(supported, [24, 24]);
}

/// Frames overtake each other on a link of several ways.
#[test]
fn a_command_that_a_later_one_has_overtaken_is_refused() {
    let mut world = world_with_mission();
    world.set_state(flying);
    for (sequence, number, result) in [
        (7, 20, Code::MAV_RESULT_ACCEPTED),
        (6, 193, Code::MAV_RESULT_TEMPORARILY_REJECTED),
        (7, 20, Code::MAV_RESULT_ACCEPTED),
        (8, 193, Code::MAV_RESULT_ACCEPTED),
    ] {
        world.acks.clear();
        world.send_bytes(
            1,
            frame((255, 190), sequence, 76, &long(number, [0.0; 7], 0)),
        );
        let _ = world.all(50);
        assert_eq!(world.acks, [(number, result as u8)], "frame {sequence}");
    }
    assert_eq!(given(&world).len(), 2, "each once");
}

/// The vehicle's contingency does the rest: `docs/plan.md`, "Contingencies".
#[test]
fn who_takes_control_promises_to_stay() {
    let promised = |world: &mut World| {
        let given = given(world);
        world.asked.clear();
        let seconds = given.iter().filter_map(|command| {
            let (_, rest) = command.split_once("heartbeat_s\", ")?;
            rest.split(')').next()?.parse().ok()
        });
        seconds.collect::<Vec<f64>>()
    };
    let alive = MavMessage::HEARTBEAT(HEARTBEAT_DATA::default());
    let operator = |world: &mut World, takes: f32| {
        world.ms += 6_000;
        let payload = long(32_100, [takes, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0);
        world.send_bytes(1, frame((255, 190), 1, 76, &payload));
        let _ = world.all(100);
    };
    let stay = |world: &mut World, seconds: u64| {
        for _ in 0..seconds {
            world.send(1, &alive);
            let _ = world.all(1_000);
        }
    };
    let mut world = world_with_mission();
    operator(&mut world, 1.0);
    stay(&mut world, 60);
    assert!(promised(&mut world).is_empty(), "on the ground");
    world.set_state(flying);
    stay(&mut world, 40);
    assert_eq!(promised(&mut world), [60.0, 60.0], "renewed");
    operator(&mut world, 0.0);
    assert_eq!(promised(&mut world), [0.0], "released");
    operator(&mut world, 1.0);
    let _ = world.all(11_000);
    assert_eq!(promised(&mut world), [60.0, 0.1], "not heard any more");
    assert_eq!(world.protocol.owner(), None);
}

#[test]
fn arming_takes_control_and_starts_the_mission() {
    let mut world = World::new();
    assert_eq!(
        station(&mut world).long(400, &[1.0]),
        Code::MAV_RESULT_DENIED,
        "no mission"
    );
    let mut world = world_with_mission();
    assert_eq!(
        station(&mut world).long(400, &[1.0]),
        Code::MAV_RESULT_ACCEPTED
    );
    assert_eq!(given(&world), ["Engage"]);
    world.set_state(flying);
    world.asked.clear();
    assert_eq!(
        station(&mut world).long(300, &[]),
        Code::MAV_RESULT_ACCEPTED
    );
    assert!(given(&world).is_empty(), "it is flown already");
    // In the air nothing would hold it: only by force (21196).
    assert_eq!(
        station(&mut world).long(400, &[0.0]),
        Code::MAV_RESULT_DENIED
    );
    assert_eq!(
        station(&mut world).long(400, &[0.0, 21_196.0]),
        Code::MAV_RESULT_ACCEPTED
    );
    assert_eq!(given(&world), ["Disengage"]);
}

#[test]
fn a_value_that_the_vehicle_refuses_is_denied() {
    let mut world = world_with_mission();
    world.set_state(|state| {
        flying(state);
        state.flight.mode = Mode::Hold;
    });
    world.refuses = Some("an airspeed of 33 to 69 m/s".to_owned());
    let code = station(&mut world).long(178, &[0.0, 500.0]);
    assert_eq!(code, Code::MAV_RESULT_DENIED);
}

#[test]
fn a_refusal_of_the_vehicle_goes_back_with_its_text() {
    let mut world = world_with_mission();
    world.refuses = Some("too slow, bank or pitch beyond 60 degrees".to_owned());
    world.inbox.clear();
    world.send_bytes(
        1,
        frame(
            (255, 190),
            9,
            76,
            &long(400, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0),
        ),
    );
    let all = world.all(500);
    let texts = all.iter().filter_map(|message| match message {
        MavMessage::STATUSTEXT(text) => text.text.to_str().ok(),
        _ => None,
    });
    assert_eq!(
        texts.collect::<String>(),
        "too slow, bank or pitch beyond 60 degrees"
    );
    let code = all.iter().find_map(|message| match message {
        MavMessage::COMMAND_ACK(ack) => Some(ack.result),
        _ => None,
    });
    assert_eq!(code, Some(Code::MAV_RESULT_TEMPORARILY_REJECTED));
}

/// The matrix of `DO_SET_MISSION_CURRENT` in `mavsdk_mavlink_tests`.
#[test]
fn set_mission_current_has_the_results_of_its_definition() {
    let mut world = World::new();
    for first in [-1.0, 0.0, 99.0] {
        assert_eq!(
            station(&mut world).long(224, &[first]),
            Code::MAV_RESULT_FAILED,
            "no mission"
        );
    }
    let mut world = world_with_mission();
    for (parameters, code) in [
        (vec![-1.0], Code::MAV_RESULT_ACCEPTED),
        (vec![2.0], Code::MAV_RESULT_ACCEPTED),
        (vec![100.0], Code::MAV_RESULT_FAILED),
        (vec![-2.0], Code::MAV_RESULT_DENIED),
        (vec![0.0, 1.0], Code::MAV_RESULT_ACCEPTED),
        (vec![0.0, 2.0], Code::MAV_RESULT_DENIED),
        (vec![0.0, 0.0, 1.0], Code::MAV_RESULT_DENIED),
        (
            vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
            Code::MAV_RESULT_DENIED,
        ),
    ] {
        assert_eq!(
            station(&mut world).long(224, &parameters),
            code,
            "{parameters:?}"
        );
        world.ms += 10_000;
    }
    assert!(given(&world).is_empty(), "on the ground it is remembered");
    assert_eq!(
        station(&mut world).long(224, &[2.0]),
        Code::MAV_RESULT_ACCEPTED
    );
    assert_eq!(
        station(&mut world).long(400, &[1.0]),
        Code::MAV_RESULT_ACCEPTED
    );
    // Items count from 0 there, and from 1 here.
    assert_eq!(given(&world), ["Engage", r#"Set([("plan_item", 3.0)])"#]);
}

#[test]
fn nan_and_int32_max_mean_unset() {
    let mut world = world_with_mission();
    world.set_state(flying);
    let nan = f32::NAN;
    let codes = station(&mut world).give(76, &long(21, [nan; 7], 0));
    assert_eq!(codes, [Code::MAV_RESULT_ACCEPTED]);
    let place = (i32::MAX, i32::MAX, nan);
    let codes = station(&mut world).give(75, &int(21, 6, [nan; 4], place));
    assert_eq!(codes, [Code::MAV_RESULT_ACCEPTED]);
    // A place that is given is none of what landing does.
    let codes = station(&mut world).give(75, &int(21, 6, [nan; 4], (475_000_000, 90_000_000, nan)));
    assert_eq!(codes, [Code::MAV_RESULT_DENIED]);
    // PX4 #4944: NaN became 0, 0. As QGroundControl pauses, and changes the altitude.
    for (command, expected) in [
        (
            int(192, 6, [-1.0, 1.0, 0.0, nan], place),
            "(\"pause\", 1.0)",
        ),
        (
            int(192, 0, [-1.0, 1.0, 0.0, nan], (i32::MAX, i32::MAX, 650.0)),
            "(\"go_to_altitude_m\", 650.0)",
        ),
    ] {
        world.asked.clear();
        let codes = station(&mut world).give(75, &command);
        assert_eq!(codes, [Code::MAV_RESULT_ACCEPTED]);
        let [given] = &given(&world)[..] else {
            panic!("{:?}", given(&world));
        };
        assert!(given.contains(expected), "{given}");
    }
}

/// `QGroundControl` chooses the mode, waits until it is shown, and arms.
#[test]
fn the_mission_is_shown_once_it_is_chosen_in_standby() {
    let mut world = world_with_mission();
    let shown = |world: &mut World| {
        world.inbox.clear();
        let heartbeat = world.wait(6_000, |heard| match &heard.message {
            MavMessage::HIGH_LATENCY2(state) => Some(state.custom_mode),
            _ => None,
        });
        heartbeat.expect("a state")
    };
    let before = shown(&mut world);
    let code = station(&mut world).long(176, &[1.0, 4.0, 4.0]);
    assert_eq!(code, Code::MAV_RESULT_ACCEPTED);
    world.set_state(|_| {});
    let chosen = shown(&mut world);
    assert_ne!(before, chosen);
    assert_eq!(
        station(&mut world).long(400, &[1.0]),
        Code::MAV_RESULT_ACCEPTED
    );
    world.set_state(flying);
    assert_eq!(shown(&mut world), chosen, "the same when it is flown");
    world.set_state(|state| state.flight = fcc_mavlink::Flight::default());
    assert_eq!(shown(&mut world), before);
}

#[test]
fn a_place_is_taken_in_its_frame() {
    let mut world = world_with_mission();
    world.set_state(flying);
    let place = (476_000_000, 91_000_000, 300.0);
    let give = |world: &mut World, frame| {
        let mut station = Station {
            world,
            sequence: frame,
        };
        station.give(75, &int(192, frame, [-1.0, 1.0, 0.0, 0.0], place))
    };
    assert_eq!(give(&mut world, 0), [Code::MAV_RESULT_ACCEPTED]);
    // Home is at 400 m.
    assert_eq!(give(&mut world, 6), [Code::MAV_RESULT_ACCEPTED]);
    assert_eq!(
        give(&mut world, 10),
        [Code::MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME]
    );
    let [above_sea, above_home] = &given(&world)[..] else {
        panic!("{:?}", given(&world));
    };
    assert!(
        above_sea.contains("(\"go_to_altitude_m\", 300.0)"),
        "{above_sea}"
    );
    assert!(
        above_home.contains("(\"go_to_altitude_m\", 700.0)"),
        "{above_home}"
    );
    assert!(
        above_sea.contains("(\"go_to_latitude_rad\", 0.83077"),
        "47.6 degrees: {above_sea}"
    );
}

#[test]
fn a_command_that_takes_long_is_in_progress_first() {
    let mut world = world_with_mission();
    world.takes_ms = 2_000;
    world.inbox.clear();
    world.send_bytes(
        1,
        frame(
            (255, 190),
            9,
            76,
            &long(400, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0),
        ),
    );
    let mut codes = Vec::new();
    let _ = world.wait(4_000, |heard| {
        if let MavMessage::COMMAND_ACK(ack) = &heard.message {
            codes.push(ack.result);
        }
        None::<()>
    });
    let (last, before) = codes.split_last().expect("answers");
    assert_eq!(*last, Code::MAV_RESULT_ACCEPTED);
    assert!(
        !before.is_empty()
            && before
                .iter()
                .all(|code| *code == Code::MAV_RESULT_IN_PROGRESS)
    );
}

/// The guide: a command that is sent again has a higher `confirmation`.
#[test]
fn a_repeated_command_is_answered_and_not_carried_out_again() {
    let mut world = world_with_mission();
    world.set_state(flying);
    let go_around = |confirmation| long(191, [0.0; 7], confirmation);
    let once = frame((255, 190), 7, 76, &go_around(0));
    world.send_bytes(1, once.clone());
    world.send_bytes(1, once);
    world.all(300);
    world.send_bytes(1, frame((255, 190), 8, 76, &go_around(1)));
    let again = world.all(300);
    assert_eq!(given(&world).len(), 1);
    assert!(again.iter().any(|message| matches!(
        message,
        MavMessage::COMMAND_ACK(ack) if ack.result == Code::MAV_RESULT_ACCEPTED
    )));
    // Another one of the same kind is carried out.
    world.send_bytes(1, frame((255, 190), 9, 76, &go_around(0)));
    world.all(300);
    assert_eq!(given(&world).len(), 2);
}

/// `px4_custom_mode.h`, which MAVSDK sends.
#[test]
fn modes_are_chosen_by_number_by_pair_and_by_message() {
    let mut world = world_with_mission();
    world.set_state(flying);
    let hold = (3_u32 << 24 | 4 << 16) as f32;
    assert_eq!(
        station(&mut world).long(176, &[1.0, 4.0, 3.0]),
        Code::MAV_RESULT_ACCEPTED
    );
    assert_eq!(
        station(&mut world).long(176, &[1.0, hold]),
        Code::MAV_RESULT_ACCEPTED
    );
    let message = SET_MODE_DATA {
        custom_mode: 3 << 24 | 4 << 16,
        target_system: 1,
        base_mode: MavModeFlag::MAV_MODE_FLAG_CUSTOM_MODE_ENABLED,
    };
    world.send(1, &MavMessage::SET_MODE(message));
    world.all(100);
    let pause = r#"Set([("pause", 1.0)])"#;
    assert_eq!(given(&world), [pause, pause, pause]);
    // Safe recovery is 5 of MAV_STANDARD_MODE; 99 is none.
    assert_eq!(
        station(&mut world).long(262, &[5.0]),
        Code::MAV_RESULT_ACCEPTED
    );
    assert_eq!(
        station(&mut world).long(262, &[99.0]),
        Code::MAV_RESULT_DENIED
    );
    assert_eq!(given(&world)[3], r#"Set([("return_home", 1.0)])"#);
    assert_eq!(
        station(&mut world).long(176, &[1.0, 6.0]),
        Code::MAV_RESULT_DENIED,
        "offboard"
    );
}

#[test]
fn a_speed_does_not_end_the_mission() {
    let mut world = world_with_mission();
    world.set_state(flying);
    let speed = [0.0, 40.0, -1.0];
    assert_eq!(
        station(&mut world).long(178, &speed),
        Code::MAV_RESULT_TEMPORARILY_REJECTED
    );
    world.set_state(|state| state.flight.mode = Mode::Hold);
    world.ms += 10_000;
    assert_eq!(
        station(&mut world).long(178, &speed),
        Code::MAV_RESULT_ACCEPTED
    );
    assert_eq!(given(&world), [r#"Set([("airspeed_mps", 40.0)])"#]);
    // Above home, which is at 400 m.
    assert_eq!(
        station(&mut world).long(186, &[200.0, 3.0]),
        Code::MAV_RESULT_ACCEPTED
    );
    assert_eq!(given(&world)[1], r#"Set([("altitude_m", 600.0)])"#);
}

/// `REQUEST_OPERATOR_CONTROL` of `development.xml`.
#[test]
fn who_has_taken_control_is_the_only_one_to_command() {
    let mut world = world_with_mission();
    world.set_state(flying);
    let from = |world: &mut World, system, number, first| {
        world.ms += 6_000;
        let payload = long(number, [first, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0);
        // It is heard, or it loses control.
        let alive = world.frame(
            (255, 190),
            &MavMessage::HEARTBEAT(HEARTBEAT_DATA::default()),
        );
        world.send_bytes(1, alive);
        world.send_bytes(1, frame((system, 190), 1, 76, &payload));
        world.inbox.clear();
        world.wait(300, |heard| match &heard.message {
            MavMessage::COMMAND_ACK(ack) => Some(ack.result),
            _ => None,
        })
    };
    let take = |world: &mut World, system, parameter| {
        let now = world.now();
        let payload = long(32_100, [parameter, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0);
        world
            .protocol
            .receive(1, &frame((system, 190), 2, 76, &payload), now);
    };
    assert_eq!(
        from(&mut world, 42, 20, 0.0),
        Some(Code::MAV_RESULT_ACCEPTED),
        "all may"
    );
    take(&mut world, 255, 1.0);
    assert_eq!(world.protocol.owner(), Some(255));
    assert_eq!(
        from(&mut world, 42, 20, 0.0),
        Some(Code::MAV_RESULT_NOT_IN_CONTROL)
    );
    assert_eq!(
        from(&mut world, 255, 20, 0.0),
        Some(Code::MAV_RESULT_ACCEPTED)
    );
    assert_eq!(
        from(&mut world, 42, 512, 148.0),
        Some(Code::MAV_RESULT_ACCEPTED),
        "who asks"
    );
    take(&mut world, 42, 1.0);
    assert_eq!(world.protocol.owner(), Some(255), "it does not let go");
    take(&mut world, 255, 0.0);
    assert_eq!(world.protocol.owner(), None);
    take(&mut world, 42, 1.0);
    world.ms += 20_000;
    world.step();
    assert_eq!(world.protocol.owner(), None, "it was not heard any more");
}

#[test]
fn a_long_command_of_the_crate_is_read_as_it_is() {
    let mut world = world_with_mission();
    let command = COMMAND_LONG_DATA {
        param1: 148.0,
        command: MavCmd::MAV_CMD_REQUEST_MESSAGE,
        target_system: 1,
        target_component: 1,
        ..COMMAND_LONG_DATA::default()
    };
    world.send(1, &MavMessage::COMMAND_LONG(command));
    let capabilities = world.wait(300, |heard| match &heard.message {
        MavMessage::AUTOPILOT_VERSION(version) => Some(version.capabilities.bits()),
        _ => None,
    });
    // MISSION_INT 4, COMMAND_INT 8, MAVLINK2 8192, FENCE 16384, RALLY 32768.
    assert_eq!(capabilities.unwrap_or(0) & 0xe00c, 0xe00c);
}
