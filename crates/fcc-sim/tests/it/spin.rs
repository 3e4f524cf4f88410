//! The stall and the spin, against what is published of them.

use fcc_core::flight::Surfaces;
use fcc_sim::units::{DEGREE_RAD, FOOT_M};
use fcc_sim::{Aircraft, SimConfig};

const DT_S: f64 = 0.025;

/// Rotation about the vertical so far.
#[derive(Default)]
struct Turns(f64);

impl Turns {
    fn step(&mut self, aircraft: &mut Aircraft, controls: &Surfaces) {
        let before = aircraft.truth().heading_rad;
        aircraft.step(controls, DT_S);
        let turned = aircraft.truth().heading_rad - before;
        self.0 += libm::remainder(turned, std::f64::consts::TAU) / std::f64::consts::TAU;
    }
}

/// In a stall with idle power, at 10,000 ft.
fn stalled() -> Aircraft {
    let mut aircraft = Aircraft::new(&SimConfig {
        altitude_m: 10_000.0 * FOOT_M,
        indicated_airspeed_mps: 35.0,
        ..SimConfig::default()
    })
    .unwrap();
    for step in 0..2_000_u32 {
        let now = aircraft.truth();
        if now.angle_of_attack_rad > 17.0 * DEGREE_RAD {
            return aircraft;
        }
        let controls = Surfaces {
            elevator: (f64::from(step) * DT_S * 0.06).min(1.0),
            aileron: (-0.8 * now.roll_rad - 0.4 * now.rates.roll_radps).clamp(-1.0, 1.0),
            ..Surfaces::default()
        };
        aircraft.step(&controls, DT_S);
    }
    panic!("it does not stall");
}

const PRO_SPIN: Surfaces = Surfaces {
    throttle: 0.0,
    elevator: 1.0,
    aileron: 0.0,
    rudder: 1.0,
    ..Surfaces::IDLE
};

/// After six turns with full rudder and full up elevator.
fn spinning() -> Aircraft {
    let mut aircraft = stalled();
    let mut turns = Turns::default();
    for _ in 0..2_000 {
        turns.step(&mut aircraft, &PRO_SPIN);
        if turns.0 >= 6.0 {
            return aircraft;
        }
    }
    panic!("it does not spin: {:.1} turns", turns.0);
}

/// FAA-H-8083-3C, chapter 5: in a spin a light aircraft loses about 500 ft in
/// each turn of 3 s. Cessna (*Spin Characteristics of Cessna Models 150 ... 172
/// ...*, 1980): a spin of six turns takes less than 3,000 ft; the wing is stalled.
#[test]
fn with_pro_spin_controls_it_spins() {
    let mut aircraft = stalled();
    let begin_m = aircraft.truth().altitude_m;
    let mut turns = Turns::default();
    let mut seconds = 0.0;
    while turns.0 < 6.0 && seconds < 30.0 {
        turns.step(&mut aircraft, &PRO_SPIN);
        seconds += DT_S;
    }
    let now = aircraft.truth();
    let lost_ft = (begin_m - now.altitude_m) / FOOT_M;
    assert!((9.0..24.0).contains(&seconds), "six turns in {seconds} s");
    assert!((1_000.0..3_000.0).contains(&lost_ft), "{lost_ft} ft");
    assert!(now.angle_of_attack_rad > 20.0 * DEGREE_RAD);
    assert!(now.rates.roll_radps > 1.0 && now.rates.yaw_radps > 0.5);
    let sink_fpm = now.velocity.down_mps / FOOT_M * 60.0;
    assert!((6_000.0..12_000.0).contains(&sink_fpm), "{sink_fpm} ft/min");
}

/// How many turns it takes until the wing is not stalled and yaw is below 20 °/s.
fn recovered_after(controls: &Surfaces) -> Option<f64> {
    let mut aircraft = spinning();
    let mut turns = Turns::default();
    for _ in 0..400 {
        turns.step(&mut aircraft, controls);
        let now = aircraft.truth();
        if now.angle_of_attack_rad < 15.0 * DEGREE_RAD
            && now.rates.yaw_radps.abs() < 20.0 * DEGREE_RAD
        {
            return Some(turns.0);
        }
    }
    None
}

/// 14 CFR 23.221(a) (before 2017): with the controls of the handbook's recovery
/// the spin of a normal category aircraft ends within a turn; with the stick held
/// back it goes on, whatever the rudder.
#[test]
fn the_handbooks_controls_end_the_spin() {
    let against = Surfaces {
        elevator: -0.7,
        rudder: -1.0,
        ..Surfaces::default()
    };
    let turns = recovered_after(&against).unwrap();
    assert!(turns < 1.0, "{turns}");
    let held = recovered_after(&PRO_SPIN);
    assert_eq!(held, None);
    let stick_back = Surfaces {
        rudder: 0.0,
        ..PRO_SPIN
    };
    assert_eq!(recovered_after(&stick_back), None);
}

/// Knight (NACA TR 273, 1928): stability of rotation turns into instability as the
/// angle of maximum lift is exceeded. A roll rate dies out below the stall, and
/// grows beyond it.
#[test]
fn a_roll_is_damped_below_the_stall_and_grows_beyond_it() {
    let after = |mut aircraft: Aircraft, elevator: f64| {
        let mut state = *aircraft.state();
        state.rates_radps.x += 0.05;
        aircraft.set_state(state);
        let controls = Surfaces {
            elevator,
            ..Surfaces::default()
        };
        aircraft.step(&controls, 0.5);
        aircraft.truth().rates.roll_radps
    };
    // From 19 to 21°: at 25° and more the outer strips have all stalled, and the
    // roll is damped again.
    let mut deeper = stalled();
    let stick_back = Surfaces {
        elevator: 0.4,
        ..Surfaces::default()
    };
    deeper.step(&stick_back, 0.4);
    let flying = Aircraft::new(&SimConfig::default()).unwrap();
    assert!(after(flying, 0.0).abs() < 0.01);
    let grown = after(deeper, 0.4);
    assert!(grown > 0.05, "{grown}");
}
