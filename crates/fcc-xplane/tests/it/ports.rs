//! The ports of both sides: where X-Plane answers from, and where it answers to.

use std::net::{SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use crate::support::bench::{Bench, close};
use crate::support::{
    Addressed, FakeXPlane, OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES, P, Ticks, Wire, free_port,
};
use fcc_core::flight::Measurements;
use fcc_core::framework::{Actuator, ActuatorFault, ControlAuthority, PlantId, Released, Sensor};
use fcc_xplane::{
    Control, DataRows, Input, RowsVersion, Simulator, Trouble, XPlane, XPlaneAuthority,
    XPlaneConfig,
};

const KNOT_MPS: f64 = 1.852 / 3.6;

fn airspeed_kt(bench: &Bench) -> f64 {
    bench.measurements.airspeed_mps.value / KNOT_MPS
}

#[test]
fn the_port_that_answers_is_learned_and_others_are_left_out() {
    let mut bench = Bench::new();
    bench.settle();
    let answers = bench.simulator.sender.local_addr().unwrap().port();
    assert_ne!(answers, bench.simulator.address().port());
    assert_eq!(bench.status.reply_port(), Some(answers));
    let other = UdpSocket::bind("127.0.0.1:0").unwrap();
    let client = bench.simulator.client.unwrap();
    assert_eq!(bench.status.local_port(), Some(client.port()));
    let speed = format!("{P}indicated_airspeed");
    for _ in 0..200 {
        bench.simulator.set(&speed, 400.0);
        other.send_to(&bench.simulator.frame(), client).unwrap();
        bench.simulator.set(&speed, 100.0);
        bench.watch().unwrap();
        close(airspeed_kt(&bench), 100.0);
    }
    assert_eq!(bench.status.counts().foreign, 200);
    assert_eq!(bench.status.reply_port(), Some(answers));
}

/// Two seconds are 80 ticks of 25 ms.
#[test]
fn an_x_plane_that_returns_with_another_port_is_accepted_after_two_seconds() {
    let mut bench = Bench::new();
    bench.settle();
    for _ in 0..40 {
        let _ = bench.sample();
    }
    bench.simulator.listen();
    bench.simulator.sender = UdpSocket::bind("127.0.0.1:0").unwrap();
    let answers = bench.simulator.sender.local_addr().unwrap().port();
    bench.simulator.set(&format!("{P}indicated_airspeed"), 50.0);
    for _ in 0..40 {
        let _ = bench.watch();
        close(airspeed_kt(&bench), 100.0);
    }
    bench.watch().unwrap();
    close(airspeed_kt(&bench), 50.0);
    assert_eq!(bench.status.reply_port(), Some(answers));
}

/// In flight, with X-Plane's replies from a port that is not the configured one.
fn flown() -> (Bench, XPlaneAuthority) {
    let mut bench = Bench::new();
    bench.settle();
    let authority = XPlaneAuthority::of(bench.status.clone(), &bench.simulator.config());
    for _ in 0..10 {
        assert_eq!(bench.fly(), Ok(()));
        authority.report(&mut |_| {});
    }
    bench.simulator.set(&format!("{P}indicated_airspeed"), 50.0);
    (bench, authority)
}

/// As many ticks as X-Plane may be silent for before another one answers, and
/// ten times as many, with X-Plane's own port open all the time.
#[test]
fn while_controls_are_held_another_port_never_takes_the_place_of_one_that_is_open() {
    let (mut bench, authority) = flown();
    let flown = bench.status.reply_port();
    let impostor = UdpSocket::bind("127.0.0.1:0").unwrap();
    let client = bench.simulator.client.unwrap();
    for tick in 0..800 {
        impostor.send_to(&bench.simulator.frame(), client).unwrap();
        let _ = bench.sample();
        authority.report(&mut |_| {});
        close(airspeed_kt(&bench), 100.0);
        // It hangs, and the loop gives back control after a while.
        if tick == 400 {
            bench.actuator.as_mut().unwrap().release().unwrap();
        }
    }
    assert_eq!(bench.status.reply_port(), flown);
    assert_eq!(bench.status.control(), Control::ReleaseMonitor);
    // The known one is used as soon as it answers.
    for _ in 0..20 {
        let _ = bench.watch();
    }
    close(airspeed_kt(&bench), 50.0);
    assert_eq!(bench.status.control(), Control::Free);
}

/// The kernel tells that the old port is closed, in this machine's own time.
#[test]
fn an_x_plane_that_was_started_again_in_flight_is_found_with_its_new_port() {
    let (mut bench, authority) = flown();
    bench.simulator.listen();
    bench.simulator.sender = UdpSocket::bind("127.0.0.1:0").unwrap();
    let answers = bench.simulator.sender.local_addr().unwrap().port();
    let began = Instant::now();
    while bench.status.reply_port() != Some(answers) {
        assert!(began.elapsed() < Duration::from_secs(10));
        let _ = bench.watch();
        authority.report(&mut |_| {});
        std::thread::sleep(Duration::from_millis(1));
    }
    // Its release counts.
    bench.actuator.as_mut().unwrap().release().unwrap();
    for _ in 0..40 {
        bench.watch().unwrap();
    }
    assert_eq!(bench.status.control(), Control::Free);
}

/// Another program on X-Plane's machine claims that the overrides are clear, to
/// the daemon, and to a release helper that was told the port.
#[test]
fn a_release_is_confirmed_only_by_the_port_that_answered() {
    let (bench, daemon) = flown();
    let mut simulator = bench.simulator;
    let plant = daemon.held().unwrap();
    let helper = XPlaneAuthority::without_connection(&simulator.config());
    helper.expect(&plant, daemon.answers_from().unwrap());
    simulator.listen();
    simulator.assert_shows(OVERRIDE_JOYSTICK, 1.0);
    for authority in [daemon, helper] {
        simulator.accepts_writes = false;
        let (authority, released) = released_among_lies(authority, plant, &mut simulator);
        assert_eq!(released, Ok(Released::Unconfirmed));
        simulator.accepts_writes = true;
        let (_, released) = released_among_lies(authority, plant, &mut simulator);
        assert_eq!(released, Ok(Released::Confirmed));
        simulator.assert_shows(OVERRIDE_JOYSTICK, 0.0);
        simulator.set(OVERRIDE_JOYSTICK, 1.0);
    }
}

/// What a release gives while another program says that the overrides are clear.
fn released_among_lies(
    authority: XPlaneAuthority,
    plant: PlantId,
    simulator: &mut FakeXPlane,
) -> (XPlaneAuthority, Result<Released, ActuatorFault>) {
    let overrides = [OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES];
    let impostor = UdpSocket::bind("127.0.0.1:0").unwrap();
    let releasing = std::thread::spawn(move || {
        let within = Duration::from_millis(1_500);
        let released = authority.release(&plant, within, &mut || false);
        (authority, released)
    });
    let mut lies = 0;
    while !releasing.is_finished() {
        simulator.live(0.0);
        if let Some(client) = simulator.client {
            let shown = overrides.map(|path| simulator.value(path));
            for path in overrides {
                simulator.set(path, 0.0);
            }
            impostor.send_to(&simulator.frame(), client).unwrap();
            for (path, shown) in overrides.into_iter().zip(shown) {
                simulator.set(path, shown);
            }
            lies += 1;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(lies > 0);
    releasing.join().unwrap()
}

/// Like a release helper that was not told the port.
#[test]
fn a_release_without_a_connection_learns_the_port() {
    let mut simulator = FakeXPlane::new();
    simulator.set(OVERRIDE_THROTTLES, 1.0);
    let authority = XPlaneAuthority::without_connection(&simulator.config());
    let plant = PlantId::new(format_args!("X-Plane at {}", simulator.address())).unwrap();
    let releasing = std::thread::spawn(move || {
        let within = Duration::from_secs(10);
        authority.release(&plant, within, &mut || false)
    });
    while !releasing.is_finished() {
        simulator.live(0.0);
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(releasing.join().unwrap(), Ok(Released::Confirmed));
    simulator.assert_shows(OVERRIDE_THROTTLES, 0.0);
}

/// The datagrams to other addresses than the simulator's, of a second and a half
/// of silence after a datagram from `answer`.
fn openings(simulator: SocketAddr, reply_port: u16, answer: Option<SocketAddr>) -> Vec<Addressed> {
    let config = XPlaneConfig {
        simulator: Simulator::At(simulator),
        reply_port,
        ..XPlaneConfig::default()
    };
    let wire = Wire::default();
    let Ok((mut sensor, _actuator)) = XPlane::over(&config, wire.clone(), None) else {
        return Vec::new();
    };
    let (mut ticks, mut measurements) = (Ticks::new(), Measurements::default());
    if let Some(from) = answer {
        // Index 0 is the flight's time.
        wire.arrives(b"RREF,\0\0\0\0\0\0\xc8\x42", from);
        let _ = sensor.sample(&ticks.next(), &mut measurements);
        wire.take_sent();
    }
    for _ in 0..60 {
        let _ = sensor.sample(&ticks.next(), &mut measurements);
    }
    let mut sent = wire.take_sent();
    sent.retain(|(_, to)| *to != simulator);
    sent
}

#[test]
fn a_datagram_without_effect_lets_answers_through_a_firewall_on_this_side() {
    let there = "192.0.2.1:49000".parse().unwrap();
    let here = "127.0.0.1:49000".parse().unwrap();
    let sent = openings(there, 49_001, None);
    // At once, and after a second.
    assert_eq!(sent.len(), 2);
    for (datagram, to) in sent {
        assert_eq!(to.to_string(), "192.0.2.1:49001");
        assert_eq!(datagram.len(), 413);
        assert_eq!(&datagram[..9], b"RREF\0\0\0\0\0", "frequency 0");
    }
    // To the port that answered, once one has.
    let answered = "192.0.2.1:50123".parse().unwrap();
    let sent = openings(there, 49_001, Some(answered));
    assert_eq!(
        sent.iter().map(|(_, to)| *to).collect::<Vec<_>>(),
        [answered]
    );
    // None where it is of no use, or not wished.
    assert_eq!(openings(here, 49_001, None), []);
    assert_eq!(openings(there, 0, None), []);
    assert_eq!(openings(there, 49_000, None), []);
}

#[test]
fn the_way_through_an_address_translation_is_kept_open() {
    let simulator = "192.0.2.1:49000".parse().unwrap();
    let config = XPlaneConfig {
        simulator: Simulator::At(simulator),
        ..XPlaneConfig::default()
    };
    let wire = Wire::default();
    let (mut sensor, _actuator) = XPlane::over(&config, wire.clone(), None).unwrap();
    let (mut ticks, mut measurements) = (Ticks::new(), Measurements::default());
    let answers = "192.0.2.1:49001".parse().unwrap();
    for number in 0..1_700_u16 {
        let mut datagram = b"RREF,\0\0\0\0".to_vec();
        datagram.extend((f32::from(number) * 0.025).to_le_bytes());
        wire.arrives(&datagram, answers);
        let _ = sensor.sample(&ticks.next(), &mut measurements);
    }
    let sent = wire.take_sent();
    // At once, after 20 s and after 40 s of 42.5.
    assert_eq!(sent.iter().filter(|(_, to)| *to == answers).count(), 3);
}

/// Rows arrive, and every request is lost.
#[test]
fn rows_without_an_answer_show_that_x_plane_does_not_hear() {
    let free = free_port();
    let mut bench = Bench::with(|config| {
        config.local_port = free;
        config.input = Input::Data(DataRows::of(RowsVersion::XPlane12));
    });
    for _ in 0..300 {
        bench.simulator.send_rows(free);
        let _ = bench.sample();
    }
    let at = bench.simulator.address();
    assert_eq!(bench.status.trouble(), Some(Trouble::Unanswered(at)));
    let message = Trouble::Unanswered(at).to_string();
    assert!(message.contains("does not hear this program"), "{message}");
    // It accepts incoming connections again.
    for _ in 0..240 {
        bench.simulator.live(0.025);
        bench.simulator.send_rows(free);
        let _ = bench.sample();
    }
    assert_eq!(bench.status.trouble(), None);
}
