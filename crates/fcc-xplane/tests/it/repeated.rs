//! A network that delivers 30 % of the datagrams again, up to ten seconds later.

use std::time::{Duration, Instant};

use crate::support::bench::Bench;
use crate::support::{FLIGHT_TIME, position_reply};
use fcc_core::flight::PlantState;
use fcc_core::framework::ControlAuthority;
use fcc_xplane::XPlaneAuthority;

/// Ticks at 40 Hz, frames at 20: in every other tick nothing new arrives.
struct Network {
    bench: Bench,
    /// Frames and positions, in turn.
    sent: Vec<Vec<u8>>,
    ticks: usize,
    repeated: u64,
    random: u64,
}

impl Network {
    fn new() -> Self {
        let mut bench = Bench::new();
        bench.settle();
        Self {
            bench,
            sent: Vec::new(),
            ticks: 0,
            repeated: 0,
            random: 1,
        }
    }

    /// Knuth's MMIX generator; its upper half.
    fn random(&mut self, below: usize) -> usize {
        let next = self.random.wrapping_mul(6_364_136_223_846_793_005);
        self.random = next.wrapping_add(1_442_695_040_888_963_407);
        (self.random >> 33) as usize % below
    }

    /// A tick: two datagrams in every other one, and three copies to seven of them.
    fn tick(&mut self) {
        self.ticks += 1;
        let simulator = &mut self.bench.simulator;
        simulator.listen();
        if self.ticks.is_multiple_of(2) {
            let time = simulator.value(FLIGHT_TIME) + 0.05;
            simulator.set(FLIGHT_TIME, time);
            // To the north by 60 m/s: a degree is 111,200 m.
            simulator.position[1] += 60.0 * 0.05 / 111_200.0;
            for datagram in [simulator.frame(), position_reply(simulator.position)] {
                simulator.send(&datagram);
                self.sent.push(datagram);
            }
        }
        let old = self.sent.len().saturating_sub(4);
        if old > 0 && self.random(7) < 3 {
            // Of the last ten seconds.
            let at = old - 1 - self.random(old.min(400));
            self.bench.simulator.send(&self.sent[at]);
            self.repeated += 1;
        }
        self.bench.sample().unwrap();
    }
}

#[test]
fn what_arrives_again_moves_neither_the_clock_nor_the_aircraft() {
    let mut network = Network::new();
    let (mut time_s, mut latitude_rad) = (0.0, 0.0);
    for tick in 0..4_800 {
        network.tick();
        let measured = &network.bench.measurements;
        let (plant, place) = (measured.plant.value, measured.position.value);
        assert_eq!(plant.state, PlantState::Running, "tick {tick}");
        assert!(plant.time_s >= time_s, "tick {tick}: the time went back");
        assert!(
            place.latitude_rad >= latitude_rad,
            "tick {tick}: the place went back"
        );
        (time_s, latitude_rad) = (plant.time_s, place.latitude_rad);
    }
    let counts = network.bench.status.counts();
    assert!(network.repeated > 1_900, "{}", network.repeated);
    assert_eq!((counts.late, counts.jumps), (network.repeated, 0));
}

/// In real time, since it is said by the clock: after five seconds with two or more in each.
#[test]
fn what_arrives_again_is_said_once_with_how_much_it_is() {
    let mut network = Network::new();
    let bench = &network.bench;
    let authority = XPlaneAuthority::of(bench.status.clone(), &bench.simulator.config());
    let mut said = Vec::new();
    let begun = Instant::now();
    let mut seconds_after = 0;
    while begun.elapsed() < Duration::from_secs(60) && seconds_after < 2 {
        std::thread::sleep(Duration::from_millis(25));
        network.tick();
        authority.report(&mut |text| {
            let text = text.to_string();
            said.extend(
                text.contains("are older than")
                    .then_some((begun.elapsed(), text)),
            );
        });
        let after = said
            .first()
            .map(|(at, _)| begun.elapsed().saturating_sub(*at));
        seconds_after = after.map_or(0, |after| after.as_secs());
    }
    let [(at, text)] = &said[..] else {
        panic!("once: {said:?}")
    };
    assert!(*at >= Duration::from_secs(5), "{at:?}");
    assert!(
        text.contains("datagrams a second from X-Plane at 127.0.0.1:"),
        "{text}"
    );
    assert!(
        text.contains("connect both machines by one cable"),
        "{text}"
    );
}

/// Two new datagrams, of two ticks: with 20 frames a second 100 ms, four ticks.
#[test]
fn a_flight_that_is_loaded_meanwhile_is_found_within_four_ticks() {
    for round in 0..20 {
        let mut network = Network::new();
        for _ in 0..400 + round {
            network.tick();
        }
        network.bench.simulator.set(FLIGHT_TIME, 0.5);
        network.bench.simulator.position = [8.0, 47.0, 500.0];
        let mut jumped = Vec::new();
        for tick in 1..=400 {
            network.tick();
            if network.bench.measurements.plant.value.state == PlantState::Jumped
                && network.bench.status.counts().jumps > jumped.len() as u64
            {
                jumped.push(tick);
            }
        }
        assert!(matches!(jumped[..], [1..=4]), "round {round}: {jumped:?}");
    }
}
