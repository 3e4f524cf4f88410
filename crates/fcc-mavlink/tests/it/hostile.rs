//! Whatever bytes come: no panic, and nothing is carried out that was not asked for.

use mavlink::dialects::common::MavMessage;
use proptest::collection::vec;
use proptest::prelude::*;

use crate::commands::{frame, long};
use crate::signing_key;
use crate::world::{World, flying};

/// Numbers of messages that are read, and some that are not.
fn known() -> impl Strategy<Value = u32> {
    prop_oneof![
        prop::sample::select(vec![
            0_u32, 11, 20, 21, 23, 38, 39, 40, 41, 43, 44, 45, 47, 51, 69, 73, 75, 76, 77, 110,
            111, 117, 119, 121, 122, 126, 256,
        ]),
        0..20_000_u32,
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn any_bytes_are_survived(pieces in vec(vec(any::<u8>(), 0..400), 0..8)) {
        let mut world = World::new();
        world.set_state(flying);
        for piece in pieces {
            world.send_bytes(1, piece);
            world.step();
        }
        prop_assert!(world.asked.is_empty(), "{:?}", world.asked);
    }

    #[test]
    fn any_payload_of_any_message_is_survived(
        frames in vec((known(), vec(any::<u8>(), 1..255), any::<u8>(), 0..4_u8), 1..30)
    ) {
        let mut world = World::new();
        world.set_state(flying);
        for (id, mut payload, sequence, target) in frames {
            // Often for this vehicle.
            for at in [0, 2, 4, 16, 30, 32] {
                if target > 0 && at + 1 < payload.len() {
                    payload[at] = 1;
                    payload[at + 1] = target - 1;
                }
            }
            world.send_bytes(1, frame((255, 190), sequence, id, &payload));
            world.step();
        }
        // Queues stay short: half a second more sends what waits.
        let before = world.sent.values().sum::<usize>();
        world.all(500);
        prop_assert!(world.sent.values().sum::<usize>() - before < 60_000);
    }

    /// CVE-2026-1579: who is not signed commands nothing.
    #[test]
    fn nothing_unsigned_is_carried_out_with_a_key(
        number in any::<u16>(),
        parameters in prop::array::uniform7(any::<f32>()),
        flags in any::<u8>(),
        tail in vec(any::<u8>(), 13),
    ) {
        let mut world = World::with(Some(signing_key()), crate::world::QUIET);
        world.set_state(flying);
        let mut bytes = frame((255, 190), 1, 76, &long(number, parameters, 0));
        bytes[2] = flags & 1;
        let end = bytes.len() - 2;
        let crc = mavlink::calculate_crc(&bytes[1..end], 152).to_le_bytes();
        bytes[end..].copy_from_slice(&crc);
        bytes.extend(tail);
        world.send_bytes(1, bytes);
        world.all(100);
        prop_assert!(world.asked.is_empty());
        let has_ack = world.inbox.iter().any(|heard| {
            matches!(heard.message, MavMessage::COMMAND_ACK(_))
        });
        prop_assert!(!has_ack);
    }
}

/// Its commands are not from a station; one text on each link says that it is there.
#[test]
fn another_vehicle_with_the_same_number_commands_nothing() {
    let mut world = World::new();
    world.set_state(flying);
    for sequence in 0..3 {
        let home = long(20, [0.0; 7], 0);
        world.send_bytes(2, frame((1, 1), sequence, 76, &home));
    }
    let told = world.all(100);
    let is_text = |message: &&MavMessage| matches!(message, MavMessage::STATUSTEXT(_));
    assert_eq!(told.iter().filter(is_text).count(), 3, "once on each link");
    assert!(world.asked.is_empty() && world.acks.is_empty());
}
