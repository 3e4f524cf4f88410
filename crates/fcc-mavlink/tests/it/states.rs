//! What a station believes of an aircraft that hangs, waits, has landed, or flies a plan of
//! another program.

use fcc_mavlink::{LinkOptions, Mode};
use mavlink::dialects::common::{
    MISSION_CLEAR_ALL_DATA, MISSION_REQUEST_LIST_DATA, MISSION_SET_CURRENT_DATA, MavMessage,
    MavMissionResult, MavMissionType, MavResult as Code, MavState, MavSysStatusSensor,
    MissionState,
};

use crate::commands::{station, world_with_mission};
use crate::world::{QUIET, World, flying};

const USUAL: LinkOptions = LinkOptions {
    is_high_latency: false,
    ..QUIET
};

#[test]
fn of_an_aircraft_whose_records_have_stopped_nothing_is_told_as_new() {
    let mut world = World::with(None, USUAL);
    world.set_state(flying);
    world.all(2_000);
    world.protocol.set_old();
    world.all(20);
    let later = world.all(3_000);
    let moves = |one: &&MavMessage| {
        matches!(
            one,
            MavMessage::ATTITUDE(_) | MavMessage::GLOBAL_POSITION_INT(_) | MavMessage::VFR_HUD(_)
        )
    };
    assert_eq!(later.iter().filter(moves).count(), 0);
    let (mut heartbeats, mut states) = (0, 0);
    for one in &later {
        match one {
            MavMessage::HEARTBEAT(beat) => {
                assert_eq!(beat.system_status, MavState::MAV_STATE_CRITICAL);
                heartbeats += 1;
            }
            MavMessage::SYS_STATUS(state) => {
                // MAVProxy takes a fence that is not healthy for a breach.
                let healthy = state.onboard_control_sensors_health;
                assert_eq!(healthy, MavSysStatusSensor::MAV_SYS_STATUS_GEOFENCE);
                states += 1;
            }
            _ => {}
        }
    }
    assert!(heartbeats >= 2 && states >= 2);
    world.set_state(|_| {});
    assert!(world.all(1_000).iter().any(|one| moves(&one)));
}

/// By another program, whose file is not known here.
#[test]
fn a_plan_that_is_not_known_is_no_empty_one() {
    let mut world = world_with_mission();
    world.set_state(|state| {
        flying(state);
        state.plan_hash = 77;
    });
    world.protocol.set_plan(77, None);
    let list = MISSION_REQUEST_LIST_DATA {
        target_system: 1,
        target_component: 1,
        mission_type: MavMissionType::MAV_MISSION_TYPE_MISSION,
    };
    world.send(1, &MavMessage::MISSION_REQUEST_LIST(list));
    let all = world.all(500);
    let refused = all.iter().any(|one| match one {
        MavMessage::MISSION_ACK(ack) => ack.mavtype == MavMissionResult::MAV_MISSION_ERROR,
        MavMessage::MISSION_COUNT(count) => panic!("{count:?}"),
        _ => false,
    });
    assert!(refused);
    assert_eq!(
        station(&mut world).long(512, &[42.0]),
        Code::MAV_RESULT_ACCEPTED
    );
    assert_eq!(current(&mut world).1, MissionState::MISSION_STATE_UNKNOWN);
    // Above the home that is shown.
    let items: Vec<_> = (0..2).map(crate::world::waypoint).collect();
    let ack = crate::lossy::upload(&mut world, 1, &items).expect("an answer");
    assert_eq!(ack.mavtype, MavMissionResult::MAV_MISSION_ACCEPTED);
    let home = world.plan.home.expect("a home");
    assert!((home.place.latitude_deg - 47.5).abs() < 1e-9);
}

/// `MISSION_CURRENT`: its item and state.
fn current(world: &mut World) -> (u16, MissionState) {
    world.inbox.clear();
    let request = crate::commands::long(512, [42.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0);
    let frame = crate::commands::frame((255, 190), 200, 76, &request);
    world.send_bytes(1, frame);
    let found = world.wait(1_000, |heard| match &heard.message {
        MavMessage::MISSION_CURRENT(current) => Some((current.seq, current.mission_state)),
        _ => None,
    });
    found.expect("an item")
}

#[test]
fn an_aircraft_that_waits_goes_on_with_the_item_that_is_shown() {
    let mut world = world_with_mission();
    world.set_state(|state| {
        flying(state);
        state.flight.item = 3;
    });
    world.set_state(|state| (state.flight.mode, state.flight.item) = (Mode::Loiter, 0));
    let paused = (2, MissionState::MISSION_STATE_PAUSED);
    assert_eq!(current(&mut world), paused);
}

/// MAVSDK sends it again at each answer with another item.
#[test]
fn an_item_is_set_once_and_answered_when_it_is_the_current_one() {
    let mut world = world_with_mission();
    world.takes_ms = 300;
    world.set_state(flying);
    let set = |world: &mut World, seq| {
        world.send(
            1,
            &MavMessage::MISSION_SET_CURRENT(MISSION_SET_CURRENT_DATA {
                seq,
                target_system: 1,
                target_component: 1,
            }),
        );
    };
    let answers = |world: &mut World| {
        let all = world.all(200);
        let items = all.iter().filter_map(|one| match one {
            MavMessage::MISSION_CURRENT(current) => Some(current.seq),
            _ => None,
        });
        items.collect::<Vec<_>>()
    };
    set(&mut world, 2);
    assert_eq!(answers(&mut world), [0_u16; 0]);
    set(&mut world, 2);
    assert_eq!(answers(&mut world), [2]);
    assert_eq!(answers(&mut world), [0_u16; 0]);
    assert_eq!(world.asked.len(), 1);
    set(&mut world, 55);
    let all = world.all(200);
    let told = |one: &MavMessage| match one {
        MavMessage::STATUSTEXT(text) => text
            .text
            .to_str()
            .is_ok_and(|text| text.contains("item 55: the mission has 4")),
        _ => false,
    };
    assert!(all.iter().any(told), "{all:?}");
}

#[test]
fn a_clear_that_is_sent_again_has_one_answer() {
    let mut world = world_with_mission();
    world.takes_ms = 700;
    let fence: Vec<_> = (0..3).map(crate::missions::corner).collect();
    crate::lossy::upload(&mut world, 1, &fence).expect("an answer");
    world.inbox.clear();
    let clear = MISSION_CLEAR_ALL_DATA {
        target_system: 1,
        target_component: 1,
        mission_type: MavMissionType::MAV_MISSION_TYPE_FENCE,
    };
    world.send(1, &MavMessage::MISSION_CLEAR_ALL(clear.clone()));
    let mut codes = Vec::new();
    for _ in 0..2 {
        let all = world.all(500);
        codes.extend(all.into_iter().filter_map(|one| match one {
            MavMessage::MISSION_ACK(ack) => Some(ack.mavtype),
            _ => None,
        }));
        if codes.is_empty() {
            world.send(1, &MavMessage::MISSION_CLEAR_ALL(clear.clone()));
        }
    }
    assert_eq!(codes, [MavMissionResult::MAV_MISSION_ACCEPTED]);
}

#[test]
fn an_aircraft_that_has_landed_does_not_take_off_before_it_was_disarmed() {
    let mut world = world_with_mission();
    world.set_state(|state| {
        flying(state);
        (state.flight.mode, state.flight.is_airborne) = (Mode::Land, false);
    });
    for number in [22, 300] {
        let code = station(&mut world).long(number, &[]);
        assert_eq!(code, Code::MAV_RESULT_TEMPORARILY_REJECTED, "{number}");
    }
}

/// MAVSDK chooses Hold where it is shown a mission, and arms then.
#[test]
fn hold_can_be_chosen_before_arming() {
    let mut world = world_with_mission();
    let hold = [1.0, 4.0, 3.0];
    let code = station(&mut world).long(176, &hold);
    assert_eq!(code, Code::MAV_RESULT_ACCEPTED);
    world.ms += 10_000;
    world.set_state(|state| state.flight.is_airborne = true);
    let code = station(&mut world).long(176, &hold);
    assert_eq!(code, Code::MAV_RESULT_NOT_IN_CONTROL, "the pilot flies");
}

/// It puts an aircraft that stands somewhere back to where the plan begins.
#[test]
fn the_same_mission_again_begins_anew_in_standby_only() {
    let mut world = world_with_mission();
    let items: Vec<_> = (0..4).map(crate::world::waypoint).collect();
    crate::lossy::upload(&mut world, 1, &items).expect("an answer");
    assert_eq!(world.asked.len(), 1);
    world.set_state(flying);
    crate::lossy::upload(&mut world, 1, &items).expect("an answer");
    assert_eq!(world.asked.len(), 1);
}
