//! The fence: the aircraft turns onto the last circle that stays inside of it.

use libm::{atan, tan};
use nalgebra::Vector2;

use super::super::Autopilot;
use super::{Contingency, ContingencyAction, Stage, notice};
use fcc_core::framework::PERMILLE;
use fcc_core::units::GRAVITY_MPS2;
use fcc_guidance::fence::{Bank, Escape, Fence};
use fcc_guidance::path::{LocalPlane, Path, length};
use fcc_guidance::route::{
    Destination, OverGround, PLANNED_SHARE, RETURNS_CLOCKWISE, ROLL_LAG_S, course_onto_circle,
};
use fcc_guidance::{Mode, ModeInput};

/// The aircraft is on a circle within this distance, m, and this angle: its cosine, of 20°.
const ON_CIRCLE_M: f64 = 60.0;
const ALONG_CIRCLE: f64 = 0.939_7;
/// It banks as its circle needs, or at most so much less, rad: 7°.
const BANKED_WITHIN_RAD: f64 = 0.122;
/// A target that is more than this above the present airspeed is not reached on the
/// circle, m/s.
pub(super) const FASTER_MPS: f64 = 3.0;
/// The bank that gusts and airspeed allow, and the airspeed, are followed with this time
/// constant, s: a third of a turn. A circle is planned with this share of the largest
/// bank's tangent at least: twice the radius.
const BANK_FOLLOWS_S: f64 = 8.0;
const LEAST_BANK_SHARE: f64 = 0.4;
/// The airspeed of a circle is so much above the one that its bank needs, m/s.
const OVER_NEEDED_MPS: f64 = 2.0;
/// Gusts up to this load, g, one standard deviation, are within the margin. Stronger ones
/// carry the aircraft farther off: in severe ones, 0.35 g, by some 120 m in a turn, two
/// standard deviations of 6 m/s over 10 s (MIL-F-8785C, 3.7).
const CALM_GUSTS_G: f64 = 0.15;
const GUSTS_M_PER_G: f64 = 600.0;
/// How far ahead it is looked at whether the fence is left behind, s.
const AHEAD_S: u8 = 5;
/// The aircraft returns from the circle when its course leads there within this angle:
/// its cosine, of 3°, more than it turns in a tick.
const POINTS_THERE: f64 = 0.998_6;

/// Of the margin: with a circle so far inside the fence is left behind; what one needs that
/// begins on the circle that was turned onto; what there is when that is left for home, and
/// at least on the way there.
const BEHIND_SHARE: f64 = 1.5;
const KEPT_SHARE: f64 = 0.75;
const LEFT_SHARE: f64 = 0.5;
const LEAST_SHARE: f64 = 0.25;

/// Turned away so often, the aircraft stays on its circle.
const MOST_TURNS: u8 = 3;

/// The amount of the notice that the aircraft is outside.
pub(super) const OUTSIDE: u16 = Contingency::Fence as u16 * PERMILLE + 1;

/// On which side of the fence the aircraft is known to be.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) enum Side {
    #[default]
    Inside,
    Outside,
}

/// A circle at the fence that the aircraft has turned onto.
#[derive(Clone, Copy, Debug)]
pub(super) struct KeptCircle {
    centre: LocalPlane,
    radius_m: f64,
    clockwise: bool,
}

impl KeptCircle {
    fn of(escape: &Escape, here: &OverGround) -> Self {
        Self {
            centre: here.plane_at(escape.centre_m),
            radius_m: escape.radius_m,
            clockwise: escape.clockwise,
        }
    }

    /// Whether the aircraft is on it, flies along it, and banks as it needs.
    fn is_flown(&self, here: &OverGround, bank_rad: f64) -> bool {
        let motion = here.motion_in(&self.centre);
        let path = Path::Circle {
            centre_m: Vector2::zeros(),
            radius_m: self.radius_m,
            clockwise: self.clockwise,
        };
        let nearest = path.nearest(motion.position_m);
        let velocity = motion.ground_velocity_mps;
        let needed_rad = atan(velocity.dot(&velocity) / (self.radius_m * GRAVITY_MPS2));
        let banked_rad = if self.clockwise { bank_rad } else { -bank_rad };
        banked_rad > needed_rad - BANKED_WITHIN_RAD
            && nearest.cross_track_m.abs() < ON_CIRCLE_M
            && nearest.course.dot(&velocity) >= ALONG_CIRCLE * length(velocity)
    }
}

/// How far inside of the fence the aircraft is, m; negative outside.
fn inside_m(fence: &Fence<'_>, here: &OverGround) -> f64 {
    fence.clearance_m(here.latitude_rad, here.longitude_rad, Vector2::zeros())
}

impl Autopilot {
    /// Turns away from the fence in time.
    pub(super) fn keep_inside_fence(&mut self) {
        let action = self.config.contingency.fence;
        let fence = self.fence();
        if action == ContingencyAction::Continue {
            return self.tell_fence_crossed(&fence);
        }
        // Take-off and landing lead where a runway is.
        let is_watched = !fence.zones.is_empty()
            && self.guidance.runway().is_none()
            && !self.is_on_runway()
            && self.guidance.mode.mode() != Mode::Glide;
        let Some(here) = self.estimator.ground.here().copied().filter(|_| is_watched) else {
            return;
        };
        let stage = self.supervisor.contingencies.stage;
        let is_met = self.supervisor.contingencies.active == Contingency::Fence;
        if is_met && stage == Stage::Staying {
            return;
        }
        let bank = self.fastest_bank();
        // Compared with one another, circles are those of the same airspeed.
        let here = self.at_its_speed(&here);
        let Some(escape) = Escape::best(&fence, &here, &bank) else {
            return;
        };
        let margin_m = self.fence_margin_m();
        if is_met && stage == Stage::TurningAway {
            if action != ContingencyAction::Return || !self.points_home(&here) {
                return;
            }
            let ahead_m = self.room_ahead_m(&fence, &here);
            // The circle of this moment may need more room than the one that was turned
            // onto: in strong wind, or a faster one.
            let kept = self.supervisor.contingencies.kept;
            let is_on_it = kept.is_some_and(|kept| kept.is_flown(&here, bank.now_rad));
            let has_room = is_on_it && ahead_m >= margin_m
                || escape.clearance_m >= LEFT_SHARE * margin_m && ahead_m > escape.clearance_m;
            if has_room {
                self.supervisor.contingencies.stage = Stage::Leaving;
                self.return_from_fence(&here);
            }
            return;
        }
        if escape.clearance_m > self.fence_left_m() {
            self.supervisor.contingencies.kept = None;
        }
        // What leaves the circle begins on it, as near as the margin.
        let kept = self.supervisor.contingencies.kept;
        let needed_m = if kept.is_some() {
            KEPT_SHARE * margin_m
        } else {
            margin_m
        };
        let depth_m = inside_m(&fence, &here);
        let enters = self
            .supervisor
            .contingencies
            .enters_fence
            .unwrap_or(depth_m < 0.0);
        if escape.clearance_m >= needed_m {
            self.supervisor.contingencies.enters_fence = Some(false);
            if stage == Stage::Leaving {
                self.supervisor.contingencies.stage = Stage::Acting;
            }
            return;
        }
        // Engaged outside, it flies in on the way home, until there is room for a circle.
        let enters =
            enters && (depth_m < 0.0 || depth_m < inside_m(&fence, &here.straight_on(1.0)));
        self.supervisor.contingencies.enters_fence = Some(enters);
        // The fence is left behind. Until there is room for a turn at once for the first time,
        // one that begins later stays nearer to it, or inside.
        let waits = escape.clearance_m >= LEAST_SHARE * margin_m || stage == Stage::Leaving;
        if is_met && waits && self.room_ahead_m(&fence, &here) > escape.clearance_m {
            return;
        }
        // A command does not make the circle another one while the aircraft is on it.
        let circle = kept.filter(|kept| kept.is_flown(&here, bank.now_rad));
        if enters || circle.is_none() && depth_m < -escape.radius_m {
            // Nearer to a fence that was crossed, the circle leads back sooner.
            self.meet_as(Contingency::Fence, ContingencyAction::Return, OUTSIDE);
            return;
        }
        let circle = circle.unwrap_or_else(|| KeptCircle::of(&escape, &here));
        self.supervisor.contingencies.active = Contingency::Fence;
        let turns = if is_met {
            self.supervisor.contingencies.turns.saturating_add(1)
        } else {
            1
        };
        self.supervisor.contingencies.turns = turns;
        self.supervisor.contingencies.stage =
            if turns > MOST_TURNS || action == ContingencyAction::Loiter {
                Stage::Staying
            } else {
                Stage::TurningAway
            };
        self.supervisor.contingencies.kept = Some(circle);
        // Faster, it would not hold it.
        self.guidance.targets.airspeed_mps = self.circle_airspeed_mps();
        self.circle(
            ModeInput::Pause,
            Some(circle.centre),
            circle.radius_m,
            circle.clockwise,
        );
        self.journal.add(notice(Contingency::Fence, action));
    }

    /// Whether a command may end the turn away from the fence. Each one that the aircraft
    /// turns for before there is room for another turn would take some of what is left.
    pub(super) fn may_leave_fence(&self) -> bool {
        let turns = self.supervisor.contingencies.active == Contingency::Fence
            && self.supervisor.contingencies.stage.is_on_circle();
        let Some(here) = self.estimator.ground.here().filter(|_| turns) else {
            return true;
        };
        let escape = Escape::best(
            &self.fence(),
            &self.at_its_speed(here),
            &self.fastest_bank(),
        );
        escape.is_none_or(|escape| escape.clearance_m >= self.fence_left_m())
    }

    /// With a circle that is so far inside, the fence is left behind, m.
    fn fence_left_m(&self) -> f64 {
        BEHIND_SHARE * self.fence_margin_m()
    }

    /// How far inside circles stay, m: farther in gusts, which carry the aircraft off them.
    fn fence_margin_m(&self) -> f64 {
        let gusts_g = self.estimator.estimate().gust_load - CALM_GUSTS_G;
        self.config.contingency.fence_margin_m + GUSTS_M_PER_G * gusts_g.max(0.0)
    }

    /// Follows what bank is allowed, and the airspeed, `dt_s` seconds after the last time.
    pub(super) fn follow_bank(&mut self, dt_s: f64) {
        let envelope = &self.config.envelope;
        let estimate = self.estimator.estimate();
        let most_rad = self.config.route.bank_rad.min(envelope.max_bank_rad);
        let allowed = tan(envelope.bank_limit_at_rad(estimate)) / tan(most_rad);
        let off = 1.0 - allowed.min(1.0) - self.supervisor.contingencies.bank_missing;
        let share = (dt_s / BANK_FOLLOWS_S).min(1.0);
        self.supervisor.contingencies.bank_missing += off * share;
        let lasting_mps = self.lasting_airspeed_mps();
        let off_mps = estimate.airspeed_mps - lasting_mps;
        self.supervisor.contingencies.airspeed_mps = Some(lasting_mps + off_mps * share);
    }

    /// The indicated airspeed with which a circle is flown, m/s: of the target no more than
    /// is soon reached, but what the circle's bank needs in these gusts.
    fn circle_airspeed_mps(&self) -> f64 {
        let (route, envelope) = (&self.config.route, &self.config.envelope);
        let most_rad = route.bank_rad.min(envelope.max_bank_rad);
        let gust_load = self.estimator.estimate().gust_load;
        let needed_mps = envelope.floor_in_turn_mps(most_rad, gust_load) + OVER_NEEDED_MPS;
        let soon_mps = (self.lasting_airspeed_mps() + FASTER_MPS).max(needed_mps);
        self.guidance.targets.airspeed_mps.min(soon_mps)
    }

    /// Tells that the fence is crossed, once until the aircraft is inside of it again.
    fn tell_fence_crossed(&mut self, fence: &Fence<'_>) {
        let Some(here) = self
            .estimator
            .ground
            .here()
            .filter(|_| !fence.zones.is_empty())
        else {
            return;
        };
        let is_out = inside_m(fence, here) < 0.0;
        let side = if is_out { Side::Outside } else { Side::Inside };
        if (self.supervisor.contingencies.side, side) == (Side::Inside, Side::Outside) {
            let crossed = notice(Contingency::Fence, ContingencyAction::Continue);
            self.journal.add(crossed);
        }
        self.supervisor.contingencies.side = side;
    }

    /// The indicated airspeed without gusts, m/s.
    fn lasting_airspeed_mps(&self) -> f64 {
        let now_mps = self.estimator.estimate().airspeed_mps;
        self.supervisor
            .contingencies
            .airspeed_mps
            .unwrap_or(now_mps)
    }

    /// The aircraft with the airspeed that it has without gusts or, if it is soon reached,
    /// with that of its target.
    pub(super) fn at_its_speed(&self, here: &OverGround) -> OverGround {
        let true_of_indicated = here.true_airspeed_mps / here.airspeed_mps.max(1.0);
        let lasting_mps = self.lasting_airspeed_mps();
        let airspeed_mps = self.circle_airspeed_mps().max(lasting_mps);
        OverGround {
            true_airspeed_mps: airspeed_mps * true_of_indicated,
            ..*here
        }
    }

    /// The fence of the plan.
    pub(in super::super) fn fence(&self) -> Fence<'static> {
        self.config.plan.map(|plan| plan.fence).unwrap_or_default()
    }

    /// How the aircraft banks at once.
    pub(super) fn fastest_bank(&self) -> Bank {
        let (route, envelope) = (&self.config.route, &self.config.envelope);
        let most_rad = route.bank_rad.min(envelope.max_bank_rad);
        let estimate = self.estimator.estimate();
        let commanded_rad = match self.guidance.mode.over_ground() {
            Some(_) => self.guidance.setpoints.roll_rad,
            None => estimate.roll_rad,
        };
        let allowed = 1.0 - self.supervisor.contingencies.bank_missing;
        let share = allowed.clamp(LEAST_BANK_SHARE, PLANNED_SHARE);
        Bank {
            // It rolls on for the lag.
            now_rad: estimate.roll_rad + 2.0 * ROLL_LAG_S * estimate.body_rates.roll_radps,
            commanded_rad,
            turn_rad: atan(share * tan(most_rad)),
            rate_radps: route.bank_rate_radps,
            lag_s: ROLL_LAG_S,
        }
    }

    /// Where the aircraft returns to from the fence.
    fn fence_return(&self, here: &OverGround) -> Option<Destination> {
        let plan = self.config.plan?;
        plan.fence_return.or_else(|| plan.nearest_return(here))
    }

    /// How far inside the best circle stays, m, that begins within the next seconds of
    /// flying straight on, as far as that is inside.
    fn room_ahead_m(&self, fence: &Fence<'_>, here: &OverGround) -> f64 {
        let bank = Bank {
            now_rad: 0.0,
            commanded_rad: 0.0,
            ..self.fastest_bank()
        };
        let least_m = LEAST_SHARE * self.fence_margin_m();
        (1..=AHEAD_S)
            .map(|s| here.straight_on(f64::from(s)))
            .take_while(|here| inside_m(fence, here) >= least_m)
            .filter_map(|here| Escape::best(fence, &here, &bank))
            .fold(f64::NEG_INFINITY, |most_m, escape| {
                most_m.max(escape.clearance_m)
            })
    }

    /// Whether the course is the one to the circle on which the aircraft returns.
    pub(super) fn points_home(&self, here: &OverGround) -> bool {
        let radius_m = self.config.route.loiter_radius_m;
        self.fence_return(here).is_some_and(|home| {
            let motion = here.motion_in(&home.at);
            let velocity = motion.ground_velocity_mps;
            course_onto_circle(motion.position_m, radius_m, RETURNS_CLOCKWISE)
                .is_none_or(|course| course.dot(&velocity) >= POINTS_THERE * length(velocity))
        })
    }

    fn return_from_fence(&mut self, here: &OverGround) {
        match self.config.plan.and_then(|plan| plan.fence_return) {
            Some(place) => self.circle_at(ModeInput::Return, &place, here),
            None => self.return_home(),
        }
        self.supervisor.contingencies.mode = self.guidance.mode.mode();
    }
}
