//! A flight's stream at the highest rates, for decoders of others: `make test-mavlink`.

use std::collections::BTreeMap;
use std::io::{BufWriter, Write as _};

use fcc_mavlink::LinkOptions;
use mavlink::dialects::common::{COMMAND_LONG_DATA, MavCmd, MavMessage};

use crate::world::{STEP_MS, World, flying};

/// All that are sent by themselves, but `HIGH_LATENCY2`, and `CONTROL_STATUS` of another dialect.
const STREAMS: [u16; 13] = [30, 33, 74, 24, 62, 1, 2, 245, 42, 231, 436, 242, 437];

/// Seconds of `FCC_MAVLINK_SECONDS`, by default 60, into the file `FCC_MAVLINK_STREAM`.
#[test]
fn a_flight_is_streamed_at_50_hz() {
    let seconds = std::env::var("FCC_MAVLINK_SECONDS").map(|text| text.parse::<u64>().unwrap());
    let seconds = seconds.unwrap_or(60);
    let options = LinkOptions {
        bytes_per_s: 1e6,
        is_datagram: true,
        is_high_latency: false,
    };
    let file = std::env::var_os("FCC_MAVLINK_STREAM");
    let mut file = file.map(|path| BufWriter::new(std::fs::File::create(path).unwrap()));
    let mut world = World::with(None, options);
    world.set_state(flying);
    for number in STREAMS {
        let frame = world.frame((255, 190), &often(number));
        world.protocol.receive(1, &frame, world.now());
    }
    let mut counts = BTreeMap::<u32, u64>::new();
    let mut last: Option<u8> = None;
    while world.ms < 1_000 * seconds {
        // All that changes in flight, so that no byte stays 0.
        let at = world.ms as f64 / 1_000.0;
        world.set_state(|state| {
            state.attitude.roll_rad = 0.5 * (0.3 * at).sin();
            state.attitude.rates_radps = [0.1 * at.cos(), 0.1 * at.sin(), -0.05];
            state.motion.airspeed_mps = 50.0 + at.sin();
            state.motion.climb_mps = (0.1 * at).cos();
            state.motion.wind_mps = Some([3.0, -2.0]);
            state.health.battery_v = Some(24.0);
            state.flight.to_go_m = 5_000.0 - at % 5_000.0;
        });
        world.ms += STEP_MS;
        world.protocol.step(world.now(), |link, frame| {
            if link != 1 {
                return;
            }
            let id = u32::from_le_bytes([frame[7], frame[8], frame[9], 0]);
            *counts.entry(id).or_default() += 1;
            assert!(last.is_none_or(|last| frame[4] == last.wrapping_add(1)));
            last = Some(frame[4]);
            if let Some(file) = &mut file {
                file.write_all(&frame).unwrap();
            }
        });
    }
    if let Some(mut file) = file {
        file.flush().unwrap();
    }
    for number in STREAMS {
        let sent = counts.get(&number.into()).copied().unwrap_or(0);
        assert!(
            sent >= 48 * seconds,
            "message {number}: {sent} in {seconds} s"
        );
    }
}

fn often(number: u16) -> MavMessage {
    MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
        param1: number.into(),
        param2: 20_000.0,
        command: MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
        target_system: 1,
        target_component: 1,
        ..COMMAND_LONG_DATA::default()
    })
}
