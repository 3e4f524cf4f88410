//! A station that uploads and reads missions as the guide says: times and tries of mavlink.io,
//! "Mission Protocol".

use mavlink::dialects::common::{
    MISSION_ACK_DATA, MISSION_COUNT_DATA, MISSION_ITEM_INT_DATA, MISSION_REQUEST_INT_DATA,
    MISSION_REQUEST_LIST_DATA, MavMessage, MavMissionResult, MavMissionType,
};

use crate::world::{Weather, World, waypoint};

const ACK_MS: u64 = 1_500;
const TRIES: usize = 5;
/// To read it, the station alone asks again: of 500 items one is lost 6 times in a row
/// nearly always.
const PATIENT: usize = 30;

/// Uploads; none: no answer at all came.
pub(crate) fn upload(
    world: &mut World,
    link: u16,
    items: &[MISSION_ITEM_INT_DATA],
) -> Option<MISSION_ACK_DATA> {
    let part = items
        .first()
        .map_or_else(MavMissionType::default, |item| item.mission_type);
    let mut to_send = MavMessage::MISSION_COUNT(MISSION_COUNT_DATA {
        count: items.len() as u16,
        target_system: 1,
        target_component: 1,
        mission_type: part,
        opaque_id: 0,
    });
    world.inbox.clear();
    world.send(link, &to_send);
    let mut tries = 0;
    while tries < TRIES {
        tries += 1;
        loop {
            let heard = world.wait(ACK_MS, |heard| match &heard.message {
                _ if heard.link != link => None,
                MavMessage::MISSION_REQUEST_INT(asked) if asked.mission_type == part => {
                    Some(Err(asked.seq))
                }
                MavMessage::MISSION_ACK(ack) if ack.mission_type == part => Some(Ok(ack.clone())),
                _ => None,
            });
            match heard {
                Some(Ok(ack)) => return Some(ack),
                Some(Err(seq)) => {
                    tries = 0;
                    let mut item = items[usize::from(seq)].clone();
                    item.seq = seq;
                    to_send = MavMessage::MISSION_ITEM_INT(item);
                    world.send(link, &to_send);
                }
                None => break,
            }
        }
        world.send(link, &to_send);
    }
    None
}

/// Reads a list; none: an answer did not come.
pub(crate) fn download(
    world: &mut World,
    link: u16,
    part: MavMissionType,
) -> Option<Vec<MISSION_ITEM_INT_DATA>> {
    let list = MavMessage::MISSION_REQUEST_LIST(MISSION_REQUEST_LIST_DATA {
        target_system: 1,
        target_component: 1,
        mission_type: part,
    });
    world.inbox.clear();
    let count = (0..PATIENT).find_map(|_| {
        world.send(link, &list);
        world.wait(ACK_MS, |heard| match &heard.message {
            MavMessage::MISSION_COUNT(count) if heard.link == link => Some(count.count),
            _ => None,
        })
    })?;
    let mut items = Vec::new();
    for seq in 0..count {
        let ask = MavMessage::MISSION_REQUEST_INT(MISSION_REQUEST_INT_DATA {
            seq,
            target_system: 1,
            target_component: 1,
            mission_type: part,
        });
        let item = (0..PATIENT).find_map(|_| {
            world.send(link, &ask);
            world.wait(ACK_MS, |heard| match &heard.message {
                MavMessage::MISSION_ITEM_INT(item) if heard.link == link && item.seq == seq => {
                    Some(item.clone())
                }
                _ => None,
            })
        })?;
        items.push(item);
    }
    Some(items)
}

/// Whether two lists are equal: all that a station has sent, bit by bit.
pub(crate) fn is_same(sent: &[MISSION_ITEM_INT_DATA], got: &[MISSION_ITEM_INT_DATA]) -> bool {
    let bits = |item: &MISSION_ITEM_INT_DATA| {
        let parameters = [item.param1, item.param2, item.param3, item.param4, item.z];
        let place = (
            item.x,
            item.y,
            item.frame as u32,
            item.command as u32,
            item.seq,
        );
        (parameters.map(f32::to_bits), place, item.autocontinue)
    };
    sent.iter().map(bits).eq(got.iter().map(bits))
}

fn mission(first: u16, count: u16) -> Vec<MISSION_ITEM_INT_DATA> {
    let items = (first..first + count).map(waypoint).enumerate();
    items
        .map(|(seq, item)| MISSION_ITEM_INT_DATA {
            seq: seq as u16,
            ..item
        })
        .collect()
}

/// The suite of Auterion (mavlink-testing-suite, 2021) asks for 500 items at 25 % loss, once.
#[test]
fn missions_of_500_items_pass_a_link_that_loses_a_quarter_of_all_frames() {
    let mut world = World::new();
    world.weather = Weather {
        loss: 0.25,
        // About 200 ms, and each frame another: they overtake each other.
        delay_ms: (120, 280),
    };
    let part = MavMissionType::MAV_MISSION_TYPE_MISSION;
    let mut old = Vec::new();
    for n in 0..100 {
        let new = mission(n * 7, 500);
        let ack = upload(&mut world, 1, &new);
        let is_accepted =
            ack.is_some_and(|ack| ack.mavtype == MavMissionResult::MAV_MISSION_ACCEPTED);
        let got = download(&mut world, 1, part).expect("every item is answered");
        if is_accepted {
            assert!(
                is_same(&new, &got),
                "upload {n}: {} items came back",
                got.len()
            );
        } else {
            assert!(
                is_same(&old, &got) || is_same(&new, &got),
                "upload {n} is a mixture"
            );
        }
        assert!(is_accepted, "upload {n}");
        assert_eq!(
            world.plan.items.len(),
            500,
            "the vehicle's plan after upload {n}"
        );
        old = got;
    }
}

/// `ArduPilot` #138: a plan that came in half was flown.
#[test]
fn a_link_that_is_cut_at_any_message_leaves_the_old_plan_or_the_new_one() {
    let (old, new) = (mission(0, 6), mission(100, 6));
    let part = MavMissionType::MAV_MISSION_TYPE_MISSION;
    let (mut olds, mut news) = (0, 0);
    // A count, six requests, six items and an answer are 14 frames.
    for cut_after in 0..20 {
        let mut world = World::new();
        upload(&mut world, 1, &old).expect("an answer");
        world.cut_after = Some(cut_after);
        let _ = upload(&mut world, 1, &new);
        world.cut_after = None;
        let got = download(&mut world, 2, part).expect("another station reads it");
        let flown = world.plan.items.clone();
        let is_old = is_same(&old, &got);
        assert!(
            is_old || is_same(&new, &got),
            "cut after {cut_after}: a mixture"
        );
        let first = flown
            .first()
            .and_then(fcc_plan::Item::place)
            .expect("a place");
        let is_old_flown = (first.latitude_deg - 47.5).abs() < 1e-9;
        assert_eq!(
            is_old, is_old_flown,
            "cut after {cut_after}: told and flown differ"
        );
        if is_old { olds += 1 } else { news += 1 }
    }
    assert!(olds >= 13 && news >= 2, "{olds} old, {news} new");
}
