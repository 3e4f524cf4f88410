//! The requirements of who has control, for servos, and their release by another
//! process.

use std::sync::Mutex;
use std::time::Duration;

use fcc_conformance::{ActuatorBench, AuthorityBench, authority_conformance};
use fcc_core::flight::Surfaces;
use fcc_core::framework::{
    Actuator, ActuatorFault, ControlAuthority, PlantId, Released, TakeoverNotice, Tick,
};
use fcc_linux::servo::{
    PulseOutputs, ReleasePulses, ServoActuator, ServoAuthority, ServoSettings, SysfsPwm,
};

use super::{PwmBench, PwmFolder, surfaces};

fn plant() -> PlantId {
    PlantId::new(format_args!("servos at /sys/class/pwm/pwmchip0")).unwrap()
}

/// Releases by files of its own, as another process does.
pub(crate) fn of(
    actuator: &ServoActuator,
    folder: &PwmFolder,
    settings: &ServoSettings,
) -> ServoAuthority {
    ServoAuthority::new(
        plant(),
        vec![actuator.control()],
        vec![release(folder, settings)],
    )
}

fn release(folder: &PwmFolder, settings: &ServoSettings) -> ReleasePulses {
    let (outputs, pulses) = (folder.outputs(4), settings.released_pulses());
    Box::new(move || SysfsPwm::of_another_process(&outputs).write(&pulses))
}

impl<const OFF: bool> AuthorityBench for PwmBench<OFF> {
    fn authority(&self) -> &dyn ControlAuthority {
        &self.authority
    }

    fn release_from_outside(&mut self, plant: &PlantId) -> Released {
        self.settle();
        let within = Duration::from_secs(1);
        self.authority
            .release(plant, within, &mut || false)
            .unwrap()
    }
}

authority_conformance!(servos_that_hold_failsafe: PwmBench<false>);
authority_conformance!(servos_that_are_switched_off: PwmBench<true>);

/// A release that could not be written is tried again by who asked for it.
#[test]
fn servos_that_are_away_are_not_released() {
    let bench = PwmBench::<false>::new();
    let away = bench.folder.0.path().join("away");
    std::fs::rename(bench.folder.chip(), away).unwrap();
    let released = bench
        .authority
        .release(&plant(), Duration::ZERO, &mut || false);
    let missing = nix::errno::Errno::ENOENT as i32;
    assert_eq!(released, Err(ActuatorFault::Io { errno: missing }));
}

#[derive(Debug, Default)]
struct Told(Mutex<Vec<String>>);

impl TakeoverNotice for Told {
    fn taking(&self, plant: &PlantId) {
        self.0.lock().unwrap().push(plant.as_str().to_owned());
    }
}

/// Once for each takeover, before anything is written.
#[test]
fn what_outlives_the_program_is_told_of_each_takeover() {
    let mut bench = PwmBench::<false>::new();
    let told: &'static Told = Box::leak(Box::default());
    bench.authority.notify(told);
    for takeovers in 1..=2 {
        for _ in 0..3 {
            let outputs: Surfaces = surfaces(3);
            bench.actuator.apply(&Tick::default(), &outputs).unwrap();
        }
        assert_eq!(
            *told.0.lock().unwrap(),
            vec![plant().as_str().to_owned(); takeovers]
        );
        bench.actuator.release().unwrap();
        bench.settle();
        assert_eq!(bench.authority.held(), None);
    }
}
