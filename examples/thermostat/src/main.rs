//! The framework with no aircraft in it: a room, a heater and a PI controller
//! under the same 40 Hz loop that flies an aircraft, timed and reported in the
//! same way.
//!
//! `cargo run -p thermostat` heats the room for eight seconds, of which each
//! is 33 minutes to the room.

#![expect(clippy::print_stdout, reason = "all that it does is to print")]

#[cfg(test)]
mod conformance;
mod room;
mod thermostat;

use std::error::Error;
use std::thread;
use std::time::Duration;

use fcc_runtime::{Loop, LoopCommand, LoopConfig, LoopReport, Message, Parts};
use fcc_timer::{RealtimeRequest, Timer, TimerKind};

use room::{Heater, Thermometer};
use thermostat::Thermostat;

const PERIOD: Duration = Duration::from_millis(25);
const WANTED_C: f64 = 20.0;
const SECONDS: u64 = 8;

fn main() -> Result<(), Box<dyn Error>> {
    let report = heat(TimerKind::Timerfd.build(PERIOD)?, SECONDS)?;
    let timing = &report.timing;
    println!("\nEnded: {}", report.ending);
    println!("Runtime  {:8.3} s", timing.runtime_s);
    println!("Average  {:8.3} ms", timing.period_mean_ms);
    println!("Median   {:8.3} ms", timing.period_median_ms);
    println!("Min      {:8.3} ms", timing.period_min_ms);
    println!("Max      {:8.3} ms", timing.period_max_ms);
    println!("Range    {:8.3} ms", timing.period_range_ms);
    println!("Missed   {:8}", timing.missed);
    Ok(())
}

/// Puts the parts together.
fn parts(timer: Box<dyn Timer>, heater: &Heater) -> Parts<Thermostat> {
    let thermometer = Thermometer {
        room_c: 12.0,
        heater: heater.clone(),
    };
    Parts {
        timer,
        sensors: vec![Box::new(thermometer)],
        controller: Thermostat::new(WANTED_C),
        actuators: vec![Box::new(heater.clone())],
    }
}

/// Heats for a while and tells of it once a second.
fn heat(timer: Box<dyn Timer>, seconds: u64) -> Result<LoopReport, Box<dyn Error>> {
    let parts = parts(timer, &Heater::default());
    let config = LoopConfig {
        realtime: RealtimeRequest {
            priority: Some(50),
            ..RealtimeRequest::default()
        },
        ..LoopConfig::default()
    };
    let (this, mut link) = Loop::new(parts, &config)?;
    let handle = this.spawn()?;
    for denied in &handle.granted().denied {
        println!("goes on without: {denied}");
    }
    link.commands.send(LoopCommand::Engage)?;
    for second in 1..=seconds {
        thread::sleep(Duration::from_secs(1));
        let mut last = None;
        while let Some(message) = link.messages.receive() {
            match message {
                Message::Tick(record) => last = Some(record),
                Message::Event(event) => println!("{}", event.kind.description::<Thermostat>()),
            }
        }
        if let Some(record) = last {
            println!(
                "{second:2} s  {}  room {:5.2} °C  heater {:4.0} W",
                record.state,
                record.measurements.room_c.value,
                record.outputs.power * room::HEATER_W
            );
        }
    }
    link.commands.send(LoopCommand::Stop)?;
    Ok(handle.join())
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::{Actuator, State, Tick};
    use fcc_runtime::{Ending, Machine};
    use fcc_timer::ManualTimer;

    use super::*;
    use room::{HEATER_W, OUTSIDE_C, RESISTANCE_K_PER_W};
    use thermostat::Heating;

    /// After one time constant a first-order room has come 1 - 1/e of the way.
    #[test]
    fn the_room_is_the_textbooks() {
        let mut heater = Heater::default();
        Actuator::apply(&mut heater, &Tick::default(), &Heating { power: 0.5 }).unwrap();
        let mut thermometer = Thermometer {
            room_c: OUTSIDE_C,
            heater,
        };
        // 0.02 K/W times 360 kJ/K.
        for _ in 0..7_200 {
            thermometer.pass(1.0);
        }
        // 1 kW through 0.02 K/W is 20 K.
        assert!((thermometer.room_c - (OUTSIDE_C + 20.0 * 0.632_120_558_8)).abs() < 1e-6);
    }

    /// In the end the heater gives what the walls lose at the wanted
    /// temperature: (20 - 2)/0.02 = 900 W.
    #[test]
    fn the_room_gets_as_warm_as_it_was_told() {
        let heater = Heater::default();
        let timer = Box::new(ManualTimer::new(PERIOD).unwrap());
        let (mut machine, mut link) =
            Machine::new(parts(timer, &heater), &LoopConfig::default()).unwrap();
        machine.start().unwrap();
        link.commands.send(LoopCommand::Engage).unwrap();
        let mut warmest_c = 0.0_f64;
        for _ in 0..40 * SECONDS {
            assert_eq!(machine.step(), State::Engaged);
            warmest_c = warmest_c.max(machine.record().measurements.room_c.value);
        }
        let room_c = machine.record().measurements.room_c.value;
        assert!((room_c - WANTED_C).abs() < 0.01, "{room_c} °C");
        assert!(warmest_c < WANTED_C + 0.1, "overshoot to {warmest_c} °C");
        let lost_w = (WANTED_C - OUTSIDE_C) / RESISTANCE_K_PER_W;
        assert!((heater.power() * HEATER_W - lost_w).abs() < 1.0);
        machine.finish();
        assert!(heater.power() <= 0.0, "the heater is still on");
    }

    #[test]
    fn it_runs_on_a_real_clock() {
        let report = heat(TimerKind::Timerfd.build(PERIOD).unwrap(), 1).unwrap();
        assert!(matches!(report.ending, Ending::StopOrder));
        assert!(report.released);
        assert!(report.ticks > 1);
        assert!(report.timing.runtime_s >= 1.0);
    }
}
