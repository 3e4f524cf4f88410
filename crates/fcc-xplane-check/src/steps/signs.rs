//! Steps 5 to 7: whether axes, signs and units are as `fccd` takes them.

use std::time::{Duration, Instant};

use crate::bench::{Bench, Done};
use crate::figure::Limit;
use crate::link::Sample;
use crate::step::Step;
use crate::watched::Watched;

/// Standard gravity, m/s².
const G_MPS2: f64 = 9.80665;
/// A deflection of the joystick that is meant.
const DEFLECTED: f64 = 0.15;
/// How long the aircraft is watched after a deflection: its response begins
/// within a fraction of this.
const RESPONDS_WITHIN: Duration = Duration::from_millis(1_500);

pub(super) const PARKED: Step = Step {
    number: 5,
    title: "parked and level: the specific force is gravity",
    action: "Park on a level runway, engine idle, brakes set.",
    passes: "The accelerations give 9.81 m/s² upwards in the aircraft's axes, and g_nrml and \
             g_side agree.",
    source: "at rest an accelerometer measures gravity alone",
    advice: "This X-Plane's local accelerations are not as fccd takes them (axes, or gravity in \
             them): send this report, and do not engage.",
    run: parked,
    restore: |bench| {
        // Before the next steps a person takes off; a stand-in is in the air.
        let _ = bench.have_done("take-off", TAKE_OFF, "the aircraft flies", |b| {
            b.number(Watched::OnGround) < 0.5
        });
    },
};

const TAKE_OFF: &str = "Take off, and climb to at least 2,000 ft above the ground.";

fn parked(bench: &mut Bench<'_>) -> Done {
    bench.disengage()?;
    bench.have_done(
        "park",
        "Park on a level runway, engine idle, brakes set.",
        "the aircraft stands still on the ground",
        |b| {
            b.number(Watched::OnGround) >= 0.5
                && b.number(Watched::Airspeed) < 25.0
                && b.number(Watched::PitchRate).abs() < 0.02
                && b.number(Watched::RollRate).abs() < 0.02
        },
    )?;
    let force = average(bench, bench.waits.average)?;
    bench.measure(
        "specific force",
        force.size(),
        "m/s²",
        Limit::Between(9.5, 10.1),
    );
    bench.measure(
        "forward, less gravity's part",
        (force.x - G_MPS2 * force.pitch.sin()).abs(),
        "m/s²",
        Limit::AtMost(0.3),
    );
    bench.measure(
        "to the right, less gravity's part",
        (force.y + G_MPS2 * force.roll.sin() * force.pitch.cos()).abs(),
        "m/s²",
        Limit::AtMost(0.3),
    );
    bench.measure("g_nrml", force.normal_g, "g", Limit::Between(0.95, 1.05));
    bench.measure("g_side", force.side_g.abs(), "g", Limit::AtMost(0.05));
    Ok(())
}

pub(super) const TURN: Step = Step {
    number: 6,
    title: "a hand-flown turn with 30° of bank: the side force is near 0",
    action: "Fly a level, coordinated turn with 30° of bank, to either side, the ball centred.",
    passes: "The side force computed from the accelerations is near 0, as is g_side, and the nose \
             turns to the side of the bank.",
    source: "the ball is centred where the side force is 0; with a wrong sign of the bank it would \
             be 0.5 g",
    advice: "Fly the turn again, the ball centred. If the two side forces still differ, send this \
             report, and do not engage.",
    run: turn,
    restore: |bench| {
        let _ = bench.have_confirmed("level", "Fly level again, then press Enter.");
    },
};

fn turn(bench: &mut Bench<'_>) -> Done {
    bench.disengage()?;
    let since = std::cell::Cell::new(Instant::now());
    let steady = bench.waits.average;
    bench.have_done(
        "turn",
        "Fly a level, coordinated turn with 30° of bank, and keep it.",
        "25 to 35° of bank",
        |b| {
            if !(25.0..=35.0).contains(&b.number(Watched::Roll).abs()) {
                since.set(Instant::now());
            }
            since.get().elapsed() >= steady
        },
    )?;
    let force = mean(bench.link.since(since.get()));
    bench.measure("bank", force.roll.to_degrees(), "°", Limit::Noted);
    bench.measure(
        "side force",
        force.y.abs() / G_MPS2,
        "g",
        Limit::AtMost(0.1),
    );
    bench.measure("g_side", force.side_g.abs(), "g", Limit::AtMost(0.1));
    bench.measure(
        "difference of the two",
        (force.y / G_MPS2 - force.side_g).abs(),
        "g",
        Limit::AtMost(0.05),
    );
    bench.measure(
        "yaw rate to the side of the bank",
        force.yaw_radps.to_degrees() * force.roll.signum(),
        "°/s",
        Limit::AtLeast(1.0),
    );
    Ok(())
}

pub(super) const DIRECTIONS: Step = Step {
    number: 7,
    title: "pull, roll right, right pedal: all positive",
    action: "One after another, for a second each: pull; roll right; push the right pedal.",
    passes: "Each deflection is read as positive, and its rate is positive.",
    source: "X-Plane's DataRefs.txt: yoke ratios and rates are positive for nose up, right wing \
             down, nose right",
    advice: "A reversed axis of the joystick is set right in X-Plane's joystick settings. \
             Otherwise send this report, and do not engage.",
    run: directions,
    restore: |bench| {
        let _ = bench.have_confirmed("level", "Fly level again, then press Enter.");
    },
};

fn directions(bench: &mut Bench<'_>) -> Done {
    bench.disengage()?;
    for (cue, instruction, yoke, rate, name) in [
        (
            "pull",
            "Pull, for a second.",
            Watched::YokePitch,
            Watched::PitchRate,
            "pitch",
        ),
        (
            "roll-right",
            "Roll right, for a second.",
            Watched::YokeRoll,
            Watched::RollRate,
            "roll",
        ),
        (
            "right-pedal",
            "Push the right pedal, for a second.",
            Watched::YokeHeading,
            Watched::YawRate,
            "yaw",
        ),
    ] {
        let rest = (bench.number(yoke), bench.number(rate));
        bench.have_done(cue, instruction, "a deflection", |b| {
            (b.number(yoke) - rest.0).abs() >= DEFLECTED
        })?;
        let since = Instant::now();
        bench.wait("the aircraft responds", RESPONDS_WITHIN)?;
        let deflection = largest(bench, since, yoke, rest.0);
        let response = largest(bench, since, rate, rest.1);
        bench.measure(
            &format!("{name}: deflection"),
            deflection,
            "",
            Limit::AtLeast(DEFLECTED),
        );
        bench.measure(
            &format!("{name}: rate"),
            response.to_degrees(),
            "°/s",
            Limit::AtLeast(0.5),
        );
        bench.until("the joystick is centred", Duration::from_secs(5), |b| {
            (b.number(yoke) - rest.0).abs() < DEFLECTED / 2.0
        })?;
    }
    Ok(())
}

/// The first large change of a value since a time, with its sign: the response,
/// before the aircraft swings back.
fn largest(bench: &Bench<'_>, since: Instant, what: Watched, from: f64) -> f64 {
    let mut found: f64 = 0.0;
    for sample in bench.link.since(since) {
        let change = sample.number(what) - from;
        // A swing back ends the first movement.
        if change * found < 0.0 && found.abs() > 0.02 {
            break;
        }
        if change.abs() > found.abs() {
            found = change;
        }
    }
    found
}

/// Means over a stretch of time.
#[derive(Clone, Copy, Debug, Default)]
struct Means {
    /// Specific force, forward, right, down, m/s².
    x: f64,
    y: f64,
    z: f64,
    pitch: f64,
    roll: f64,
    yaw_radps: f64,
    normal_g: f64,
    side_g: f64,
}

impl Means {
    fn size(&self) -> f64 {
        (self.x * self.x + self.y * self.y + self.z * self.z).sqrt()
    }
}

fn average(bench: &mut Bench<'_>, duration: Duration) -> Result<Means, crate::bench::Stop> {
    let since = Instant::now();
    bench.wait("averaging", duration)?;
    Ok(mean(bench.link.since(since)))
}

fn mean<'a>(samples: impl Iterator<Item = &'a Sample>) -> Means {
    let mut sum = Means::default();
    let mut count = 0.0;
    for sample in samples {
        let [x, y, z] = specific_force(sample);
        sum.x += x;
        sum.y += y;
        sum.z += z;
        sum.pitch += sample.number(Watched::Pitch).to_radians();
        sum.roll += sample.number(Watched::Roll).to_radians();
        sum.yaw_radps += sample.number(Watched::YawRate);
        sum.normal_g += sample.number(Watched::LoadNormal);
        sum.side_g += sample.number(Watched::LoadSide);
        count += 1.0;
    }
    // Of no samples NaN, which is within no limit.
    Means {
        x: sum.x / count,
        y: sum.y / count,
        z: sum.z / count,
        pitch: sum.pitch / count,
        roll: sum.roll / count,
        yaw_radps: sum.yaw_radps / count,
        normal_g: sum.normal_g / count,
        side_g: sum.side_g / count,
    }
}

/// Specific force in the aircraft's axes: acceleration less gravity, turned by
/// heading, pitch and roll (Stevens, Lewis and Johnson, Aircraft Control and
/// Simulation, 3rd ed. 2016, section 1.3). X-Plane's axes are east, up, south.
fn specific_force(sample: &Sample) -> [f64; 3] {
    let north = -sample.number(Watched::AccelerationSouth);
    let east = sample.number(Watched::AccelerationEast);
    let down = -sample.number(Watched::AccelerationUp) - G_MPS2;
    let angle = |what| sample.number(what).to_radians().sin_cos();
    let (sin_heading, cos_heading) = angle(Watched::TrueHeading);
    let (sin_pitch, cos_pitch) = angle(Watched::Pitch);
    let (sin_roll, cos_roll) = angle(Watched::Roll);
    let ahead = cos_heading * north + sin_heading * east;
    let across = cos_heading * east - sin_heading * north;
    let below = sin_pitch * ahead + cos_pitch * down;
    [
        cos_pitch * ahead - sin_pitch * down,
        cos_roll * across + sin_roll * below,
        cos_roll * below - sin_roll * across,
    ]
}
