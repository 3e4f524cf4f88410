//! Nothing in a tick allocates: 10,000 of them under a counting allocator.
//!
//! A process of its own: what another test initialises first would not allocate here.

#[path = "it/support/mod.rs"]
mod support;

use fcc_conformance::allocator_calls;
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, Sensor};
use fcc_xplane::{Output, XPlane};
use support::{FakeXPlane, Ticks, position_reply};

#[test]
fn ten_thousand_ticks_allocate_nothing() {
    for output in [Output::Dref, Output::Data] {
        let mut simulator = FakeXPlane::new();
        let mut config = simulator.config();
        config.output = output;
        config.engines = 4;
        let (mut sensor, mut actuator) = XPlane::open(&config).unwrap();
        let mut ticks = Ticks::new();
        let mut measurements = Measurements::default();
        let mut counted = 0;
        let mut faults = 0;
        let mut old = Vec::new();
        for number in 0..10_000_u32 {
            let surfaces = Surfaces {
                elevator: (f64::from(number) * 0.01).sin(),
                ..Surfaces::default()
            };
            // Flying, released, silent for a while, corrupted: all situations
            // of a tick.
            let silent = (3_000..3_400).contains(&number);
            if !silent {
                simulator.live(0.025);
                // Two that arrive again.
                if number == 100 {
                    simulator.position[0] += 0.1;
                    old = vec![simulator.frame(), position_reply(simulator.position)];
                }
                for datagram in &old {
                    simulator.send(datagram);
                }
                if number % 100 == 0 {
                    simulator.send(b"RREF,cut");
                    simulator.send(b"what is this");
                }
            }
            let tick = ticks.next();
            let ((), calls) = allocator_calls(|| {
                sensor.warm_up(&tick);
                actuator.warm_up(&tick, &surfaces);
                faults += u32::from(sensor.sample(&tick, &mut measurements).is_err());
                if number % 1_000 < 900 {
                    faults += u32::from(actuator.apply(&tick, &surfaces).is_err());
                } else {
                    faults += u32::from(actuator.release().is_err());
                }
            });
            counted += calls;
        }
        assert_eq!(counted, 0, "{output:?}");
        assert!(faults > 0, "ticks with faults are counted too");
        assert!(!measurements.position.is_never());
    }
}
