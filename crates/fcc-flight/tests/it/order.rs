//! The order in which a flight begins.

use std::io;
use std::sync::{Arc, Mutex};

use fcc_core::framework::ControlAuthority;
use fcc_fixed_wing::Autopilot;
use fcc_flight::config::Config;
use fcc_flight::flight::{Host, Length, Observer, Pace, Plan, Reports, assemble, fly};

type Order = Arc<Mutex<Vec<&'static str>>>;

struct Program(Order);

impl Host for Program {
    fn prepare(&mut self, _: Option<&Arc<dyn ControlAuthority>>) -> io::Result<()> {
        self.0.lock().unwrap().push("host");
        Ok(())
    }
}

struct Watching(Order);

impl Observer<Autopilot> for Watching {
    fn prepare(&mut self, _: &mut Reports) {
        self.0.lock().unwrap().push("observer");
    }
}

/// The host starts the release helper, which is to inherit no descriptor that
/// live telemetry or the recorder opens.
#[test]
fn the_host_prepares_before_an_observer_opens_anything() {
    let config = Config::parse_without_aircraft("", "test").unwrap();
    let assembly = assemble(&config).unwrap();
    let order = Order::default();
    let plan = Plan {
        pace: Pace::Lockstep,
        length: Length::Ticks(2),
    };
    let observers: Vec<Box<dyn Observer<Autopilot>>> = vec![Box::new(Watching(order.clone()))];
    let mut host = Program(order.clone());
    fly(assembly, &config.tick, plan, observers, &mut host).unwrap();
    assert_eq!(*order.lock().unwrap(), ["host", "observer"]);
}
