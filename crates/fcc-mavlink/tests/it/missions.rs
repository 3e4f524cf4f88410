//! Missions, fences and rally points: what mavlink.io's guide and the cases of
//! `mavsdk_mavlink_tests` (2026-10) say.

use fcc_mavlink::Action;
use mavlink::dialects::common::{
    MISSION_CLEAR_ALL_DATA, MISSION_COUNT_DATA, MISSION_ITEM_DATA, MISSION_ITEM_INT_DATA,
    MISSION_REQUEST_DATA, MISSION_WRITE_PARTIAL_LIST_DATA, MavCmd, MavFrame, MavMessage,
    MavMissionResult as Code, MavMissionType as Part,
};

use crate::lossy::{download, is_same, upload};
use crate::world::{World, flying, waypoint};

const MISSION: Part = Part::MAV_MISSION_TYPE_MISSION;
const FENCE: Part = Part::MAV_MISSION_TYPE_FENCE;

fn mission(count: u16) -> Vec<MISSION_ITEM_INT_DATA> {
    (0..count).map(waypoint).collect()
}

pub(crate) fn corner(n: i32) -> MISSION_ITEM_INT_DATA {
    MISSION_ITEM_INT_DATA {
        param1: 3.0,
        param4: 0.0,
        x: 474_000_000 + (n % 2) * 2_000_000,
        y: 89_000_000 + (n / 2) * 2_000_000,
        z: 0.0,
        seq: n as u16,
        command: MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION,
        frame: MavFrame::MAV_FRAME_GLOBAL_INT,
        mission_type: FENCE,
        ..waypoint(0)
    }
}

#[test]
fn a_mission_needs_no_home_at_its_begin_and_comes_back_as_it_was_sent() {
    let mut world = World::new();
    let sent = mission(3);
    let ack = upload(&mut world, 1, &sent).expect("an answer");
    assert_eq!(ack.mavtype, Code::MAV_MISSION_ACCEPTED);
    assert!(is_same(
        &sent,
        &download(&mut world, 1, MISSION).expect("a list")
    ));
    assert_ne!(ack.opaque_id, 0, "the id of what it has");
    // 475000000 are 47.5 degrees; above home, which is where it stands.
    let place = world.plan.items[0].place().expect("a place");
    assert_eq!((place.latitude_deg, place.longitude_deg), (47.5, 9.0));
    assert_eq!(world.plan.home.map(|home| home.altitude_m), Some(400.0));
}

/// The guide: the id changes with the content, and is that of the content.
#[test]
fn the_id_is_that_of_the_content() {
    let mut world = World::new();
    let mut id = |items: &[_]| upload(&mut world, 1, items).expect("an answer").opaque_id;
    let (three, four) = (id(&mission(3)), id(&mission(4)));
    assert_ne!(three, four);
    assert_eq!(three, id(&mission(3)));
}

/// Frames of `MAV_FRAME`: those of a place are kept, all others are refused.
#[test]
fn a_frame_that_is_not_flown_is_refused_and_never_stored_changed() {
    for number in 0..=21 {
        let mut world = World::new();
        let Ok(frame) = fcc_frame(number) else {
            continue;
        };
        let mut item = waypoint(0);
        item.frame = frame;
        let ack = upload(&mut world, 1, &[item]).expect("an answer");
        let got = download(&mut world, 1, MISSION).expect("a list");
        if [0, 3, 5, 6, 10, 11].contains(&number) {
            assert_eq!(ack.mavtype, Code::MAV_MISSION_ACCEPTED, "frame {number}");
            assert_eq!(got[0].frame, frame, "frame {number}");
        } else {
            assert_eq!(
                ack.mavtype,
                Code::MAV_MISSION_UNSUPPORTED_FRAME,
                "frame {number}"
            );
            assert!(got.is_empty(), "frame {number} was stored");
        }
    }
}

fn fcc_frame(number: u8) -> Result<MavFrame, ()> {
    let all = [
        MavFrame::MAV_FRAME_GLOBAL,
        MavFrame::MAV_FRAME_LOCAL_NED,
        MavFrame::MAV_FRAME_MISSION,
        MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        MavFrame::MAV_FRAME_LOCAL_ENU,
        MavFrame::MAV_FRAME_GLOBAL_INT,
        MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
        MavFrame::MAV_FRAME_LOCAL_OFFSET_NED,
        MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT,
        MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT_INT,
        MavFrame::MAV_FRAME_BODY_FRD,
        MavFrame::MAV_FRAME_LOCAL_FRD,
        MavFrame::MAV_FRAME_LOCAL_FLU,
    ];
    let found = all
        .into_iter()
        .find(|frame| *frame as u32 == u32::from(number));
    found.ok_or(())
}

#[test]
fn what_is_not_carried_out_is_refused_by_its_code() {
    let changed = |change: fn(&mut MISSION_ITEM_INT_DATA)| {
        let mut world = World::new();
        let mut item = waypoint(0);
        change(&mut item);
        upload(&mut world, 1, &[item]).expect("an answer").mavtype
    };
    assert_eq!(
        changed(|item| item.param1 = 10.0),
        Code::MAV_MISSION_INVALID_PARAM1
    );
    assert_eq!(
        changed(|item| item.param4 = 90.0),
        Code::MAV_MISSION_INVALID_PARAM4
    );
    assert_eq!(
        changed(|item| item.x = 910_000_000),
        Code::MAV_MISSION_INVALID_PARAM5_X
    );
    assert_eq!(
        changed(|item| item.y = 1_810_000_000),
        Code::MAV_MISSION_INVALID_PARAM6_Y
    );
    assert_eq!(
        changed(|item| item.z = 30_000.0),
        Code::MAV_MISSION_INVALID_PARAM7
    );
    let gripper = |item: &mut MISSION_ITEM_INT_DATA| item.command = MavCmd::MAV_CMD_DO_GRIPPER;
    assert_eq!(changed(gripper), Code::MAV_MISSION_UNSUPPORTED);
}

#[test]
fn the_vehicle_refuses_a_plan_and_the_old_one_stays() {
    let mut world = World::new();
    upload(&mut world, 1, &mission(3)).expect("an answer");
    world.refuses = Some("the aircraft is landing".to_owned());
    let ack = upload(&mut world, 1, &mission(5)).expect("an answer");
    assert_eq!(ack.mavtype, Code::MAV_MISSION_DENIED);
    assert!(is_same(
        &mission(3),
        &download(&mut world, 1, MISSION).expect("a list")
    ));
}

#[test]
fn one_item_is_changed_by_a_partial_list() {
    let mut world = World::new();
    upload(&mut world, 1, &mission(4)).expect("an answer");
    let partial = MISSION_WRITE_PARTIAL_LIST_DATA {
        start_index: 2,
        end_index: 2,
        target_system: 1,
        target_component: 1,
        mission_type: MISSION,
    };
    world.send(1, &MavMessage::MISSION_WRITE_PARTIAL_LIST(partial));
    let asked = world.wait(500, |heard| match &heard.message {
        MavMessage::MISSION_REQUEST_INT(asked) => Some(asked.seq),
        _ => None,
    });
    assert_eq!(asked, Some(2));
    let mut moved = waypoint(2);
    moved.y += 5_000;
    world.send(1, &MavMessage::MISSION_ITEM_INT(moved.clone()));
    let code = world.wait(500, |heard| match &heard.message {
        MavMessage::MISSION_ACK(ack) => Some(ack.mavtype),
        _ => None,
    });
    assert_eq!(code, Some(Code::MAV_MISSION_ACCEPTED));
    let mut expected = mission(4);
    expected[2] = moved;
    assert!(is_same(
        &expected,
        &download(&mut world, 1, MISSION).expect("a list")
    ));
}

#[test]
fn the_expected_item_is_asked_for_again_after_a_wrong_one() {
    let mut world = World::new();
    begin(&mut world, 1, 3);
    assert_eq!(next_asked(&mut world), Some(0));
    world.send(1, &MavMessage::MISSION_ITEM_INT(waypoint(2)));
    assert_eq!(next_asked(&mut world), Some(0));
}

fn begin(world: &mut World, link: u16, count: u16) {
    let count = MISSION_COUNT_DATA {
        count,
        target_system: 1,
        target_component: 1,
        mission_type: MISSION,
        opaque_id: 0,
    };
    world.send(link, &MavMessage::MISSION_COUNT(count));
}

fn next_asked(world: &mut World) -> Option<u16> {
    world.wait(2_000, |heard| match &heard.message {
        MavMessage::MISSION_REQUEST_INT(asked) => Some(asked.seq),
        _ => None,
    })
}

#[test]
fn two_stations_that_upload_at_the_same_time_are_never_mixed() {
    let mut world = World::new();
    begin(&mut world, 1, 2);
    assert_eq!(next_asked(&mut world), Some(0));
    world.send(1, &MavMessage::MISSION_ITEM_INT(waypoint(0)));
    let ack = upload(&mut world, 2, &mission(3)).expect("an answer");
    assert_eq!(ack.mavtype, Code::MAV_MISSION_DENIED);
    world.send(1, &MavMessage::MISSION_ITEM_INT(waypoint(1)));
    world.all(300);
    assert!(is_same(
        &mission(2),
        &download(&mut world, 2, MISSION).expect("a list")
    ));
}

#[test]
fn a_station_that_reads_while_another_uploads_gets_one_plan() {
    let mut world = World::new();
    upload(&mut world, 1, &mission(3)).expect("an answer");
    let list =
        MavMessage::MISSION_REQUEST_LIST(mavlink::dialects::common::MISSION_REQUEST_LIST_DATA {
            target_system: 1,
            target_component: 1,
            mission_type: MISSION,
        });
    world.send(2, &list);
    world.all(100);
    let mut other = mission(3);
    for item in &mut other {
        item.y += 7;
    }
    upload(&mut world, 1, &other).expect("an answer");
    // By the old request, which is answered with the newer message (the guide).
    for seq in 0..3 {
        let ask = MISSION_REQUEST_DATA {
            seq,
            target_system: 1,
            target_component: 1,
            mission_type: MISSION,
        };
        world.send(2, &MavMessage::MISSION_REQUEST(ask));
        let y = world.wait(500, |heard| match &heard.message {
            MavMessage::MISSION_ITEM_INT(item) if heard.link == 2 => Some(item.y),
            _ => None,
        });
        assert_eq!(
            y,
            Some(90_000_000),
            "item {seq} of the list that it began to read"
        );
    }
}

#[test]
fn lists_are_cleared_on_the_ground_and_not_in_flight() {
    let mut world = World::new();
    upload(&mut world, 1, &mission(3)).expect("an answer");
    let fence: Vec<_> = (0..3).map(corner).collect();
    let ack = upload(&mut world, 1, &fence).expect("an answer");
    assert_eq!(ack.mavtype, Code::MAV_MISSION_ACCEPTED);
    assert_eq!(world.plan.fence.polygons.len(), 1);
    assert_eq!(world.plan.items.len(), 3, "the mission stays");
    assert!(is_same(
        &fence,
        &download(&mut world, 1, FENCE).expect("a list")
    ));
    assert_eq!(clear(&mut world, FENCE), Some(Code::MAV_MISSION_ACCEPTED));
    assert!(world.plan.fence.polygons.is_empty());
    world.set_state(flying);
    assert_eq!(clear(&mut world, MISSION), Some(Code::MAV_MISSION_DENIED));
    assert_eq!(download(&mut world, 1, MISSION).expect("a list").len(), 3);
    world.set_state(|state| state.flight = fcc_mavlink::Flight::default());
    assert_eq!(clear(&mut world, MISSION), Some(Code::MAV_MISSION_ACCEPTED));
    assert!(download(&mut world, 1, MISSION).expect("a list").is_empty());
    assert_eq!(
        clear(&mut world, Part::MAV_MISSION_TYPE_ALL),
        Some(Code::MAV_MISSION_ACCEPTED)
    );
}

fn clear(world: &mut World, part: Part) -> Option<Code> {
    let clear = MISSION_CLEAR_ALL_DATA {
        target_system: 1,
        target_component: 1,
        mission_type: part,
    };
    world.inbox.clear();
    world.send(1, &MavMessage::MISSION_CLEAR_ALL(clear));
    world.wait(500, |heard| match &heard.message {
        MavMessage::MISSION_ACK(ack) if ack.mission_type == part => Some(ack.mavtype),
        _ => None,
    })
}

#[test]
fn another_fence_in_flight_goes_on_at_the_item_that_is_flown() {
    let mut world = World::new();
    upload(&mut world, 1, &mission(5)).expect("an answer");
    world.set_state(|state| {
        flying(state);
        state.flight.item = 4;
    });
    world.asked.clear();
    upload(&mut world, 1, &(0..3).map(corner).collect::<Vec<_>>()).expect("an answer");
    let items: Vec<u16> = world
        .asked
        .iter()
        .map(|action| match action {
            Action::Plan { item, .. } => *item,
            Action::Commands(_) => 0,
        })
        .collect();
    assert_eq!(items, [4]);
}

#[test]
fn a_vehicle_that_takes_long_keeps_the_station_waiting() {
    let mut world = World::new();
    world.takes_ms = 6_000;
    let ack = upload(&mut world, 1, &mission(3)).expect("an answer");
    assert_eq!(ack.mavtype, Code::MAV_MISSION_ACCEPTED);
}

/// A rally point among the corners of a fence would be flown as neither.
#[test]
fn an_item_of_another_list_is_refused() {
    for (part, command) in [
        (FENCE, MavCmd::MAV_CMD_NAV_RALLY_POINT),
        (
            Part::MAV_MISSION_TYPE_RALLY,
            MavCmd::MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION,
        ),
        (FENCE, MavCmd::MAV_CMD_NAV_WAYPOINT),
        (MISSION, MavCmd::MAV_CMD_NAV_RALLY_POINT),
    ] {
        let mut world = World::new();
        let item = MISSION_ITEM_INT_DATA {
            command,
            mission_type: part,
            param4: 0.0,
            ..waypoint(0)
        };
        let ack = upload(&mut world, 1, &[item]).expect("an answer");
        assert_eq!(ack.mavtype, Code::MAV_MISSION_UNSUPPORTED, "{command:?}");
    }
}

/// The older message, which has degrees as `f32`: 1 m at most.
#[test]
fn an_item_in_degrees_is_stored_as_one_in_whole_numbers() {
    let mut world = World::new();
    begin(&mut world, 1, 1);
    let item = MISSION_ITEM_DATA {
        x: 47.5,
        y: 9.0,
        z: 300.0,
        command: MavCmd::MAV_CMD_NAV_WAYPOINT,
        frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        target_system: 1,
        target_component: 1,
        autocontinue: 1,
        ..MISSION_ITEM_DATA::default()
    };
    world.send(1, &MavMessage::MISSION_ITEM(item));
    let _ = world.all(100);
    let got = download(&mut world, 1, MISSION).expect("a list");
    assert_eq!((got[0].x, got[0].y), (475_000_000, 90_000_000));
}

/// The guide: who may not upload gets an answer, and not a time-out.
#[test]
fn an_upload_of_a_station_that_is_not_in_control_is_denied() {
    let mut world = World::new();
    let takes = crate::commands::long(32_100, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0);
    world.send_bytes(2, crate::commands::frame((42, 190), 1, 76, &takes));
    world.step();
    let ack = upload(&mut world, 1, &mission(2)).expect("an answer");
    assert_eq!(ack.mavtype, Code::MAV_MISSION_DENIED);
    assert_eq!(clear(&mut world, MISSION), Some(Code::MAV_MISSION_DENIED));
}
