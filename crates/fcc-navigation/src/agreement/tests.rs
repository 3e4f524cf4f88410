//! Motion by formulas: pitch, bank and airspeed as functions of time, with the
//! body rates and the forces that belong to them.

use super::*;
use fcc_core::blocks::{limit_abs, wrap_two_pi};
use fcc_core::flight::{Attitude, BodyRates, SpecificForce};
use fcc_core::framework::Reading;

const DT_S: f64 = 0.025;

/// What is flown for 10 s.
#[derive(Clone, Copy)]
struct Flown {
    pitch_deg: f64,
    bank_deg: f64,
    /// Of sines of 2 rad/s in pitch, 1.5 rad/s in bank.
    motion_deg: f64,
    acceleration_mps2: f64,
    /// Noise of all sensors, and gusts along the path, RMS in m/s.
    noise: bool,
    gusts_mps: f64,
}

const LEVEL: Flown = Flown {
    pitch_deg: 3.0,
    bank_deg: 0.0,
    motion_deg: 0.0,
    acceleration_mps2: 0.0,
    noise: false,
    gusts_mps: 0.0,
};

/// Uniform numbers of variance 1, always the same.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        ((self.0 >> 33) as f64 / f64::from(u32::MAX >> 1) - 0.5) * 12.0_f64.sqrt()
    }
}

/// The contradictions after 10 s, and how often there was one.
fn fly(flown: Flown, seed: u64, mut wrong: impl FnMut(&mut Measurements)) -> (Contradictions, u32) {
    let mut noise = Noise(seed);
    let (mut agreement, mut found) = (Agreement::new(), 0);
    let (mut gust, mut heading) = (0.0, 6.2);
    for n in 1..=400 {
        let t = DT_S * f64::from(n);
        let motion = flown.motion_deg.to_radians();
        let pitch = flown.pitch_deg.to_radians() + motion * sin(2.0 * t);
        let bank = flown.bank_deg.to_radians() + motion * sin(1.5 * t);
        let (pitch_rate, bank_rate) = (2.0 * motion * cos(2.0 * t), 1.5 * motion * cos(1.5 * t));
        let turn = GRAVITY_MPS2 * tan(bank) / 50.0;
        heading += turn * DT_S;
        // Dryden's gusts along the path over a length of 300 m.
        gust += -gust * DT_S / 6.0 + flown.gusts_mps * (2.0 * DT_S / 6.0_f64).sqrt() * noise.next();
        let mut of = |size: f64| {
            if flown.noise {
                size * noise.next()
            } else {
                0.0
            }
        };
        let now = Time::from_nanos(i64::from(n) * 25_000_000);
        let q = pitch_rate * cos(bank) + turn * cos(pitch) * sin(bank);
        let rates = BodyRates {
            roll_radps: bank_rate - turn * sin(pitch) + of(0.003),
            pitch_radps: q + of(0.003),
            yaw_radps: turn * cos(pitch) * cos(bank) - pitch_rate * sin(bank) + of(0.003),
        };
        let force = SpecificForce {
            x_mps2: flown.acceleration_mps2 + GRAVITY_MPS2 * sin(pitch) + of(0.1),
            y_mps2: of(0.1),
            z_mps2: -GRAVITY_MPS2 * cos(bank) * cos(pitch) - 50.0 * q + of(0.3),
        };
        let attitude = Attitude {
            pitch_rad: pitch + of(0.003),
            roll_rad: bank + of(0.003),
        };
        let mut sensed = Measurements {
            attitude: Reading::new(attitude, now),
            heading_rad: Reading::new(wrap_two_pi(heading + of(0.007)), now),
            body_rates: Reading::new(rates, now),
            specific_force: Reading::new(force, now),
            airspeed_mps: Reading::new(
                50.0 + flown.acceleration_mps2 * t + limit_abs(gust, 20.0) + of(0.25),
                now,
            ),
            ..Measurements::default()
        };
        wrong(&mut sensed);
        agreement.step(now, &sensed, sensed.airspeed_mps.value, DT_S);
        found += u32::from(agreement.contradictions() != Contradictions::default());
    }
    (agreement.contradictions(), found)
}

fn scaled(force: &mut SpecificForce, by: f64) {
    force.x_mps2 *= by;
    force.y_mps2 *= by;
    force.z_mps2 *= by;
}

#[test]
fn right_sensors_agree() {
    let moving = Flown {
        motion_deg: 6.0,
        noise: true,
        ..LEVEL
    };
    let flights = [
        LEVEL,
        Flown {
            pitch_deg: 12.0,
            noise: true,
            ..LEVEL
        },
        Flown {
            acceleration_mps2: 2.0,
            noise: true,
            ..LEVEL
        },
        Flown {
            acceleration_mps2: -1.5,
            ..moving
        },
        moving,
        Flown {
            bank_deg: 30.0,
            ..moving
        },
        Flown {
            motion_deg: 20.0,
            ..moving
        },
    ];
    for (n, flown) in flights.into_iter().enumerate() {
        for seed in 1..=5 {
            assert_eq!(fly(flown, seed, |_| {}).1, 0, "{n}, seed {seed}");
        }
    }
}

#[test]
fn gusts_are_no_contradiction() {
    let flown = Flown {
        motion_deg: 5.0,
        noise: true,
        gusts_mps: 3.0,
        ..LEVEL
    };
    let refused: u32 = (1..=50).map(|seed| fly(flown, seed, |_| {}).1).sum();
    assert_eq!(refused, 0);
}

/// To 1°, at 10 Hz, 0.2 s late, of a biased gyroscope (0.5 °/s).
#[test]
fn coarse_slow_late_and_biased_sensors_agree() {
    for which in 0..4 {
        for motion_deg in [0.0, 0.5, 3.0, 8.0] {
            let flown = Flown {
                motion_deg,
                bank_deg: 10.0,
                noise: true,
                ..LEVEL
            };
            let mut held = Measurements::default();
            let mut late = [Measurements::default(); 8];
            let mut n = 0;
            let wrong = |sensed: &mut Measurements| {
                n += 1;
                match which {
                    0 => {
                        let attitude = &mut sensed.attitude.value;
                        let whole = |angle: f64| (angle * 57.296).round() / 57.296;
                        attitude.pitch_rad = whole(attitude.pitch_rad);
                        attitude.roll_rad = whole(attitude.roll_rad);
                        sensed.heading_rad.value = whole(sensed.heading_rad.value);
                    }
                    1 => {
                        if n % 4 == 1 {
                            held = *sensed;
                        }
                        sensed.attitude.value = held.attitude.value;
                        sensed.heading_rad.value = held.heading_rad.value;
                    }
                    2 => {
                        let now = *sensed;
                        if n > 8 {
                            sensed.attitude.value = late[n % 8].attitude.value;
                        }
                        late[n % 8] = now;
                    }
                    _ => sensed.body_rates.value.pitch_radps += 0.008_7,
                }
            };
            let (_, found) = fly(flown, 1, wrong);
            assert_eq!(found, 0, "{which}, {motion_deg}");
        }
    }
}

#[test]
fn units_and_signs_of_the_acceleration_contradict_gravity() {
    for by in [1.0 / 9.806_65, 1.0 / 0.304_8, -1.0, 0.0] {
        for noise in [false, true] {
            let flown = Flown { noise, ..LEVEL };
            let wrong = |sensed: &mut Measurements| scaled(&mut sensed.specific_force.value, by);
            assert!(fly(flown, 1, wrong).0.load, "{by}");
        }
    }
}

#[test]
fn an_offset_or_sign_of_the_pitch_contradicts_the_acceleration() {
    for deg in [5.0_f64, -5.0, 8.0] {
        for noise in [false, true] {
            for acceleration_mps2 in [0.0, 1.0] {
                let flown = Flown {
                    acceleration_mps2,
                    noise,
                    ..LEVEL
                };
                let wrong = |sensed: &mut Measurements| {
                    sensed.attitude.value.pitch_rad += deg.to_radians();
                };
                assert!(fly(flown, 1, wrong).0.pitch_and_force, "{deg} {noise}");
            }
        }
    }
    let negated = |sensed: &mut Measurements| sensed.attitude.value.pitch_rad *= -1.0;
    assert!(fly(LEVEL, 1, negated).0.pitch_and_force);
    let small = |sensed: &mut Measurements| sensed.attitude.value.pitch_rad += 0.026;
    assert_eq!(fly(LEVEL, 1, small).1, 0);
}

#[test]
fn with_motion_signs_and_units_of_rates_and_attitude_are_told() {
    let wrongs: [fn(&mut Measurements); 8] = [
        |sensed| sensed.attitude.value.roll_rad *= -1.0,
        |sensed| sensed.attitude.value.pitch_rad *= -1.0,
        |sensed| sensed.heading_rad.value = wrap_two_pi(-sensed.heading_rad.value),
        |sensed| sensed.body_rates.value.roll_radps *= -1.0,
        |sensed| sensed.body_rates.value.pitch_radps *= -1.0,
        |sensed| sensed.body_rates.value.yaw_radps *= -1.0,
        |sensed| {
            sensed.body_rates.value.roll_radps *= 57.3;
            sensed.body_rates.value.pitch_radps *= 57.3;
        },
        |sensed| {
            sensed.body_rates.value.roll_radps /= 57.3;
            sensed.body_rates.value.pitch_radps /= 57.3;
        },
    ];
    for (n, wrong) in wrongs.into_iter().enumerate() {
        let told = [(4.0, 0.0), (1.0, 15.0)].map(|(motion_deg, bank_deg)| {
            let flown = Flown {
                motion_deg,
                bank_deg,
                noise: true,
                ..LEVEL
            };
            fly(flown, 1, wrong).0.attitude_and_rates
        });
        assert!(told.contains(&true), "{n}");
    }
}
