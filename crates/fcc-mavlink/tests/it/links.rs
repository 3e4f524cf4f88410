//! Links of a known rate: nothing is sent faster, and answers come before telemetry.

use fcc_mavlink::{LinkOptions, Parameter, Severity};
use mavlink::dialects::common::{
    MavMessage, MavParamError, PARAM_REQUEST_LIST_DATA, PARAM_SET_DATA, SERIAL_CONTROL_DATA,
};
use mavlink::types::CharArray;

use crate::commands::{frame, long};
use crate::world::{World, flying};

fn slow(bytes_per_s: f64) -> World {
    let options = LinkOptions {
        bytes_per_s,
        is_datagram: false,
        is_high_latency: false,
    };
    World::with(None, options)
}

/// 57,600 baud are 5,760 bytes in a second (8 bits, start, stop).
#[test]
fn a_line_of_57_600_baud_carries_all_telemetry() {
    let mut world = slow(5_760.0);
    world.set_state(flying);
    let all = world.all(20_000);
    assert!(
        world.sent[&1] <= 21 * 5_760,
        "{} bytes in 20 s",
        world.sent[&1]
    );
    let count = |wanted: fn(&MavMessage) -> bool| all.iter().filter(|one| wanted(one)).count();
    // Of three links, in 20 s, at 10 Hz and 1 Hz.
    let attitudes = count(|one| matches!(one, MavMessage::ATTITUDE(_)));
    assert!((585..=603).contains(&attitudes), "{attitudes}");
    let heartbeats = count(|one| matches!(one, MavMessage::HEARTBEAT(_)));
    assert!((57..=63).contains(&heartbeats), "{heartbeats}");
}

#[test]
fn a_link_that_is_too_slow_for_telemetry_has_room_for_commands() {
    let mut world = slow(600.0);
    world.set_state(flying);
    world.all(10_000);
    let before = world.sent[&1];
    // One after the other, each is answered within 0.7 s of 600 bytes a second.
    for n in 0..10 {
        let payload = long(512, [148.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0);
        world.send_bytes(1, frame((255, 190), n, 76, &payload));
        let is_answered = world.wait(700, |heard| match &heard.message {
            MavMessage::COMMAND_ACK(_) if heard.link == 1 => Some(()),
            _ => None,
        });
        assert!(is_answered.is_some(), "command {n}");
    }
    let all = world.all(20_000);
    let rate = (world.sent[&1] - before) as f64 / 20.0;
    assert!(rate <= 900.0, "{rate} bytes a second");
    // Slower by the same share: none stays away, and heartbeats do not become fewer.
    let heartbeats = all
        .iter()
        .filter(|one| matches!(one, MavMessage::HEARTBEAT(_)));
    assert!(heartbeats.count() >= 57);
    let homes = all
        .iter()
        .filter(|one| matches!(one, MavMessage::HOME_POSITION(_)));
    assert!(homes.count() >= 3, "every 5 s on a faster link");
}

fn parameters() -> Vec<Parameter> {
    let names = ["A_M", "B_MPS", "QNH_HPA"];
    let parameter = |(n, name)| Parameter {
        name,
        value: n as f64,
        origin: "a.b_kt, 1 to 2".to_owned(),
        setpoint: (name == "QNH_HPA").then_some(("altimeter_setting_pa", 100.0)),
    };
    names.into_iter().enumerate().map(parameter).collect()
}

#[test]
fn all_parameters_are_read_on_the_link_that_asks() {
    let mut world = slow(5_760.0);
    world.protocol.set_parameters(parameters());
    let list = PARAM_REQUEST_LIST_DATA {
        target_system: 1,
        target_component: 1,
    };
    world.send(2, &MavMessage::PARAM_REQUEST_LIST(list));
    let mut read = Vec::new();
    let _ = world.wait(2_000, |heard| {
        if let MavMessage::PARAM_VALUE(value) = &heard.message {
            let name = value.param_id.to_str().unwrap_or_default().to_owned();
            read.push((heard.link, name, value.param_index, value.param_count));
        }
        None::<()>
    });
    let expected = [(2, "A_M", 0, 3), (2, "B_MPS", 1, 3), (2, "QNH_HPA", 2, 3)];
    let expected = expected.map(|(link, name, n, count)| (link, name.to_owned(), n, count));
    assert_eq!(read, expected);
}

#[test]
fn a_parameter_that_cannot_change_in_flight_is_answered_with_its_old_value() {
    let mut world = World::new();
    world.protocol.set_parameters(parameters());
    let mut set = |name: &str, value: f32| {
        let set = PARAM_SET_DATA {
            param_value: value,
            target_system: 1,
            target_component: 1,
            param_id: CharArray::from(name),
            ..PARAM_SET_DATA::default()
        };
        world.inbox.clear();
        world.send(1, &MavMessage::PARAM_SET(set));
        let all = world.all(500);
        let value = all.iter().find_map(|message| match message {
            MavMessage::PARAM_VALUE(value) => Some(value.param_value),
            _ => None,
        });
        let error = all.iter().find_map(|message| match message {
            MavMessage::PARAM_ERROR(error) => Some(error.error),
            _ => None,
        });
        let says = |message: &MavMessage| match message {
            MavMessage::STATUSTEXT(text) => text.text.to_str().ok().map(str::to_owned),
            _ => None,
        };
        (value, error, all.iter().find_map(says))
    };
    let read_only = MavParamError::MAV_PARAM_ERROR_READ_ONLY;
    assert_eq!(
        set("B_MPS", 50.0),
        (
            Some(1.0),
            Some(read_only),
            Some("B_MPS is not changed: a.b_kt, 1 to 2".to_owned())
        )
    );
    assert_eq!(set("QNH_HPA", 1_020.0), (Some(1_020.0), None, None));
    let unknown = MavParamError::MAV_PARAM_ERROR_DOES_NOT_EXIST;
    assert_eq!(set("NO_SUCH", 1.0), (None, Some(unknown), None));
    let asked = format!("{:?}", world.asked);
    assert!(
        asked.contains("(\"altimeter_setting_pa\", 102000.0)"),
        "{asked}"
    );
}

/// Stations that get the old value alone ask again until they give up.
#[test]
fn a_parameter_that_the_vehicle_refuses_is_answered_with_an_error() {
    let mut world = World::new();
    world.protocol.set_parameters(parameters());
    world.refuses = Some("94000 to 106000 Pa".to_owned());
    let set = PARAM_SET_DATA {
        param_value: 5.0,
        target_system: 1,
        target_component: 1,
        param_id: CharArray::from("QNH_HPA"),
        ..PARAM_SET_DATA::default()
    };
    world.send(1, &MavMessage::PARAM_SET(set));
    let all = world.all(500);
    let is_out = |one: &MavMessage| match one {
        MavMessage::PARAM_ERROR(error) => {
            error.param_id == CharArray::from("QNH_HPA")
                && error.error == MavParamError::MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE
        }
        _ => false,
    };
    assert!(all.iter().any(is_out), "{all:?}");
    let is_old =
        |one: &MavMessage| matches!(one, MavMessage::PARAM_VALUE(now) if now.param_value == 2.0);
    assert!(all.iter().any(is_old));
}

#[test]
fn a_long_text_comes_in_numbered_pieces() {
    let mut world = World::new();
    let text = "airspeed excluded: 12 m/s behind the ground speed; airspeed by forces and motion";
    world.protocol.event(Severity::Warning, text);
    let mut pieces = Vec::new();
    let _ = world.wait(100, |heard| {
        if let (1, MavMessage::STATUSTEXT(piece)) = (heard.link, &heard.message) {
            pieces.push((
                piece.id,
                piece.chunk_seq,
                piece.text.to_str().unwrap_or("").to_owned(),
            ));
        }
        None::<()>
    });
    assert_eq!(pieces.len(), 2);
    assert!(pieces[0].0 != 0 && pieces[0].0 == pieces[1].0);
    assert_eq!((pieces[0].1, pieces[1].1), (0, 1));
    assert_eq!(format!("{}{}", pieces[0].2, pieces[1].2), text);
}

/// Where the vehicle is on another link, it does not speak of itself.
#[test]
fn messages_for_others_have_no_answer() {
    let mut world = World::new();
    let shell = SERIAL_CONTROL_DATA {
        target_system: 1,
        target_component: 1,
        ..SERIAL_CONTROL_DATA::default()
    };
    world.send(1, &MavMessage::SERIAL_CONTROL(shell));
    let mut payload = long(400, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0);
    payload[30] = 9;
    world.send_bytes(1, frame((255, 190), 1, 76, &payload));
    // Another vehicle with this one's number.
    world.send_bytes(1, frame((1, 1), 1, 76, &long(400, [1.0; 7], 0)));
    let all = world.all(500);
    let is_ack = |one: &MavMessage| matches!(one, MavMessage::COMMAND_ACK(_));
    assert!(!all.iter().any(is_ack), "{all:?}");
    assert!(world.asked.is_empty());
    let is_told = |one: &MavMessage| matches!(one, MavMessage::STATUSTEXT(text) if text.text.to_str().is_ok_and(|text| text.contains("system number 1")));
    assert!(all.iter().any(is_told), "two vehicles with one number");
}
