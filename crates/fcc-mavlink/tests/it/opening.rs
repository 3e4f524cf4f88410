//! What stations ask when they connect, with their first answers lost: the order is that of
//! `QGroundControl` 5.1 and of Mission Planner 1.3.

use fcc_mavlink::Parameter;
use mavlink::dialects::common::{
    FILE_TRANSFER_PROTOCOL_DATA, MISSION_REQUEST_LIST_DATA, MavMessage, MavMissionType,
    PARAM_REQUEST_LIST_DATA,
};

use crate::commands::{frame, long};
use crate::lossy::upload;
use crate::world::{World, waypoint};

fn request(number: f32, index: f32) -> Vec<u8> {
    let payload = long(512, [number, index, 0.0, 0.0, 0.0, 0.0, 0.0], 0);
    frame((255, 190), 1, 76, &payload)
}

fn list(part: MavMissionType) -> MavMessage {
    MavMessage::MISSION_REQUEST_LIST(MISSION_REQUEST_LIST_DATA {
        target_system: 1,
        target_component: 1,
        mission_type: part,
    })
}

/// `MAVLink` FTP: open the file of parameters, as Mission Planner does.
fn open_file() -> MavMessage {
    let mut payload = [0; 251];
    payload[..4].copy_from_slice(&[7, 0, 0, 4]);
    MavMessage::FILE_TRANSFER_PROTOCOL(FILE_TRANSFER_PROTOCOL_DATA {
        target_network: 0,
        target_system: 1,
        target_component: 1,
        payload,
    })
}

/// Asks until there is an answer, of which the first so many are lost; how often it asked.
fn asked_until(
    world: &mut World,
    lost: usize,
    ask: impl Fn(&mut World),
    mut is_answer: impl FnMut(&MavMessage) -> bool,
) -> usize {
    for n in 1..=5 {
        world.ms += 3_000;
        world.inbox.clear();
        ask(world);
        let found = world.wait(1_000, |heard| is_answer(&heard.message).then_some(()));
        if found.is_some() && n > lost {
            return n;
        }
    }
    usize::MAX
}

#[test]
fn everything_that_is_asked_is_answered_also_the_second_time() {
    for lost in 0..3 {
        let mut world = World::new();
        upload(&mut world, 1, &[waypoint(0), waypoint(1)]).expect("an answer");
        world.protocol.set_parameters(vec![Parameter {
            name: "A_M",
            value: 1.0,
            origin: String::new(),
            setpoint: None,
        }]);
        let mut check =
            |what: &str, ask: &dyn Fn(&mut World), is: &mut dyn FnMut(&MavMessage) -> bool| {
                let asked = asked_until(&mut world, lost, ask, is);
                assert_eq!(asked, lost + 1, "{what}, {lost} lost");
            };
        let by_bytes = |bytes: Vec<u8>| move |world: &mut World| world.send_bytes(1, bytes.clone());
        check(
            "AUTOPILOT_VERSION",
            &by_bytes(request(148.0, 0.0)),
            &mut |one| matches!(one, MavMessage::AUTOPILOT_VERSION(_)),
        );
        let mut modes = std::collections::BTreeSet::new();
        check(
            "AVAILABLE_MODES",
            &by_bytes(request(435.0, 0.0)),
            &mut |one| {
                if let MavMessage::AVAILABLE_MODES(mode) = one {
                    modes.insert(mode.mode_index);
                    return modes.len() == usize::from(mode.number_modes);
                }
                false
            },
        );
        // COMPONENT_METADATA: refused at once, or it is waited for.
        check(
            "COMPONENT_METADATA",
            &by_bytes(request(397.0, 0.0)),
            &mut |one| matches!(one, MavMessage::COMMAND_ACK(ack) if ack.result as u8 == 3),
        );
        check(
            "FTP",
            &|world| world.send(1, &open_file()),
            &mut |one| match one {
                // NAK, of opcode 4, file not found.
                MavMessage::FILE_TRANSFER_PROTOCOL(file) => {
                    (
                        file.payload[0],
                        file.payload[3],
                        file.payload[5],
                        file.payload[12],
                    ) == (8, 129, 4, 10)
                }
                _ => false,
            },
        );
        let parameters = MavMessage::PARAM_REQUEST_LIST(PARAM_REQUEST_LIST_DATA {
            target_system: 1,
            target_component: 1,
        });
        check(
            "parameters",
            &|world| world.send(1, &parameters),
            &mut |one| matches!(one, MavMessage::PARAM_VALUE(value) if value.param_count == 1),
        );
        for (part, count) in [
            (MavMissionType::MAV_MISSION_TYPE_MISSION, 2),
            (MavMissionType::MAV_MISSION_TYPE_FENCE, 0),
            (MavMissionType::MAV_MISSION_TYPE_RALLY, 0),
        ] {
            check(
                "a list",
                &|world| world.send(1, &list(part)),
                &mut |one| matches!(one, MavMessage::MISSION_COUNT(have) if have.mission_type == part && have.count == count),
            );
        }
    }
}
