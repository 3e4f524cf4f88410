//! Guidance in a tick, and the modes that fly over the ground.

use super::place_monitor::PlaceDoubt;
use super::{Autopilot, flags, runway};
use crate::Setpoints;
use crate::control::{Envelope, Lateral, Schedule};
use fcc_core::flight::{AltitudeReference, Position};
use fcc_core::framework::{Flags, Notice};
use fcc_guidance::path::LocalPlane;
use fcc_guidance::route::{
    Destination, Follower, OverGround, RETURNS_CLOCKWISE, Route, RunwayReason, Step, Until,
};
use fcc_guidance::{ActiveMode, Mode, ModeInput, OverGroundMode};
use fcc_navigation::Estimate;

/// The number of the notice that an item of the plan is reached, whose number is its
/// item; a landing is, when the aircraft stands. Item 0 is the end of a plan that does not
/// land.
pub const ITEM_REACHED: u8 = 30;

/// How far from its altitude an item may be reached without a word, m: the 100 ft that
/// the FAA's standards allow an instrument pilot (FAA-S-ACS-8C, IV.A).
const OFF_ALTITUDE_M: f64 = 30.5;
/// What the notice says of a distance, m, is thousandths of a kilometre.
const LARGEST_OFF_M: f64 = u16::MAX as f64;

impl Autopilot {
    /// Computes the targets.
    pub(super) fn set_targets(&mut self) {
        let marked = self.estimator.navigation.marked_altitude_m();
        let shift_m = match (&mut self.guidance.capture, marked) {
            (Some(capture), Some(altitude_m)) => capture.shift_m(altitude_m),
            _ => 0.0,
        };
        self.guidance.mode.shift_altitude(shift_m);
        if let Some(targets) = self.guidance.mode.targets() {
            self.guidance.targets = targets;
        }
        let is_limited = |mode: &OverGroundMode| mode.runway().is_none() && !mode.is_glide();
        if self.guidance.mode.over_ground().is_some_and(is_limited) {
            let demanded_mps = self.guidance.targets.airspeed_mps;
            self.guidance.targets.airspeed_mps =
                self.config.envelope.allowed_airspeed(demanded_mps);
        }
        self.keep_above_floor();
        let sea_level_m = self.guidance.sea_level_m();
        self.guidance.mode.advance(
            self.estimator.estimate(),
            self.estimator.ground.here(),
            sea_level_m,
            self.intake.clock.passed_s(),
        );
        let took_off = self.guidance.mode.over_ground();
        let took_off = took_off.and_then(OverGroundMode::took_off);
        self.supervisor.took_off = took_off.or(self.supervisor.took_off);
        let reached = self.guidance.mode.over_ground().and_then(|mode| {
            let off_m = mode.reached_off_m().abs();
            mode.reached().map(|item| (item, off_m))
        });
        let is_plan = self
            .guidance
            .mode
            .over_ground()
            .is_some_and(OverGroundMode::is_plan);
        if let Some((item, off_m)) = reached.filter(|_| is_plan) {
            self.journal.add(Notice {
                kind: ITEM_REACHED,
                item,
                amount_permille: if off_m > OFF_ALTITUDE_M {
                    off_m.min(LARGEST_OFF_M) as u16
                } else {
                    0
                },
                ..Notice::default()
            });
        }
        self.announce_end();
        self.watch_ground_contact();
    }

    /// Announces once that a plan is flown to its end.
    fn announce_end(&mut self) {
        let mode = self.guidance.mode.over_ground();
        let has_ended = mode.is_some_and(OverGroundMode::has_ended);
        if has_ended && !self.supervisor.told_once.end {
            self.journal.add(Notice {
                kind: ITEM_REACHED,
                ..Notice::default()
            });
            self.supervisor.told_once.end = true;
        }
        self.supervisor.told_once.end &= has_ended;
    }

    /// One step of the heading loop, towards a heading or with a bank.
    pub(super) fn step_lateral(
        &mut self,
        estimate: &Estimate,
        envelope: &Envelope,
        schedule: Schedule,
        dt_s: f64,
    ) -> Lateral {
        let heading_rad = self.guidance.targets.heading_rad;
        match self.guidance.mode.over_ground() {
            None => self
                .loops
                .heading
                .step(heading_rad, estimate, envelope, schedule, dt_s),
            Some(mode) => {
                let bank_rad = self.loops.bank.step(mode.acceleration_mps2(), dt_s);
                self.loops
                    .heading
                    .bank_to(bank_rad, estimate, envelope, schedule, dt_s)
            }
        }
    }

    /// The set points with how the path is flown.
    pub(super) fn with_track(&self, setpoints: Setpoints) -> Setpoints {
        let track = self.guidance.mode.over_ground().map(OverGroundMode::track);
        let track = track.unwrap_or_default();
        let plan = self.config.plan.unwrap_or_default();
        Setpoints {
            plan_hash: plan.hash,
            plan_uploaded_unix_s: plan.uploaded_unix_s,
            contingency: self.supervisor.contingencies.active(),
            took_off: self.supervisor.took_off.unwrap_or_default(),
            course_rad: track.course_rad,
            cross_track_m: track.cross_track_m,
            to_go_m: track.to_go_m,
            ..setpoints
        }
    }

    /// Follows where the aircraft is.
    pub(super) fn follow_ground(&mut self, now: fcc_core::framework::Time, dt_s: f64) {
        let sea_level_m = self.guidance.sea_level_m();
        self.estimator
            .ground
            .doubt_altimeter(self.estimator.navigation.altitude_doubt().is_some());
        self.estimator.ground.step(
            now,
            &self.intake.accepted,
            self.estimator.navigation.estimate(),
            self.estimator.navigation.wind(),
            sea_level_m,
            dt_s,
        );
        if let Some(raw) = &self.estimator.raw {
            self.estimator.ground.take(raw.solution(), dt_s);
        }
        let on_wheels_m = self.config.route.runway.height_on_wheels_m;
        self.supervisor.told_once.touch.pass(dt_s);
        self.supervisor.told_once.range.pass(dt_s);
        let is_wrong =
            self.estimator.ground.check_range(on_wheels_m) && self.supervisor.pilot.is_engaged();
        if is_wrong && self.supervisor.told_once.range.is_due() {
            self.journal.add(runway::notice(RunwayReason::RangeFinder));
        }
    }

    /// What an engagement lacks of what its mode needs.
    pub(super) fn route_inhibits(&self) -> Flags {
        let needs = self.config.guidance.mode() == Mode::Plan;
        // A configuration that flies a plan has one.
        let lacks = !self.estimator.ground.is_measured() || self.config.plan.is_none();
        Flags::NONE.with(flags::POSITION, needs && lacks)
    }

    /// What is reported of the position while it is flown by.
    pub(super) fn route_conditions(&self) -> Flags {
        let is_flown = self.guidance.mode.over_ground().is_some();
        let doubt = self.estimator.ground.place_doubt().filter(|_| is_flown);
        let repeats = doubt == Some(PlaceDoubt::Repeats);
        Flags::NONE
            .with(
                flags::DEAD_RECKONING,
                is_flown && !self.estimator.ground.is_measured(),
            )
            .with(flags::REPEATED_FIX, repeats)
            .with(flags::IMPOSSIBLE_FIX, doubt.is_some() && !repeats)
    }

    /// Flies the plan from an item on, counted from 1; 0: where it was left, or from
    /// its begin.
    pub(super) fn fly_plan(&mut self, item: u16) {
        let Some(plan) = self.config.plan else {
            return;
        };
        let left = self.supervisor.left_plan.filter(|_| item == 0);
        let index = usize::from(item.saturating_sub(1));
        if plan.step(index).is_none()
            || self.guidance.after(&self.config, ModeInput::Plan).is_none()
        {
            return;
        }
        if let Some(left) = left {
            self.enter(&left.again(self.guidance.targets));
        } else {
            self.begin_plan(&plan, index);
        }
    }

    /// Flies to the plan's landing that is nearest, by its landing sequence, or without one
    /// to where it took off; one that is flown already goes on. Whether there is one.
    pub(super) fn fly_landing(&mut self) -> bool {
        let plan = self.config.plan;
        let found = plan.zip(self.estimator.ground.here());
        let Some((begin, land)) = found.and_then(|(plan, here)| plan.nearest_landing(here)) else {
            return self.land_back();
        };
        let flown = self
            .guidance
            .mode
            .over_ground()
            .filter(|mode| mode.is_plan());
        if flown.is_some_and(|mode| (begin..=land).contains(&mode.index())) {
            return true;
        }
        self.fly_plan(u16::try_from(begin + 1).unwrap_or(u16::MAX));
        self.guidance.mode.mode() == Mode::Plan
    }

    /// Whether there is somewhere to land.
    pub(super) fn has_landing(&self) -> bool {
        let found = self.config.plan.zip(self.estimator.ground.here());
        let planned = found.and_then(|(plan, here)| plan.nearest_landing(here));
        planned.is_some() || self.supervisor.took_off.is_some()
    }

    /// Lands where it took off, if that is known; whether it does.
    fn land_back(&mut self) -> bool {
        let lands = self.guidance.mode.over_ground();
        if lands.is_some_and(OverGroundMode::lands_back) {
            return true;
        }
        let height_m = self.config.route.return_height_m;
        self.supervisor.took_off.is_some()
            && self
                .guidance
                .after(&self.config, ModeInput::Return)
                .is_some()
            && self.fly_step(Mode::Land, Step::LandBack { height_m })
    }

    /// Flies a plan from the step with an index on.
    pub(super) fn begin_plan(&mut self, plan: &Route<'static>, index: usize) {
        // One that stands has none to keep.
        let airspeed_mps = if self.waits_for_takeoff() {
            self.config.reference_airspeed_mps
        } else {
            self.guidance.targets.airspeed_mps
        };
        let follower = Follower::along(*plan, index, self.config.route, airspeed_mps);
        let follower = follower.after(self.supervisor.took_off);
        self.enter(&OverGroundMode::new(
            Mode::Plan,
            follower,
            self.guidance.targets,
        ));
    }

    /// Circles beside where the aircraft is.
    pub(super) fn pause(&mut self) {
        self.circle(
            ModeInput::Pause,
            None,
            self.config.route.loiter_radius_m,
            true,
        );
    }

    /// Circles around a place, or beside where the aircraft is, at the present altitude.
    pub(super) fn circle(
        &mut self,
        input: ModeInput,
        at: Option<LocalPlane>,
        radius_m: f64,
        clockwise: bool,
    ) {
        let altitude_m = self.guidance.targets.altitude_m - self.guidance.sea_level_m();
        self.change_to(input, loiter(at, altitude_m, radius_m, clockwise));
    }

    /// Flies to a place, at its altitude or the present higher one, and circles there.
    pub(super) fn circle_at(&mut self, input: ModeInput, place: &Destination, here: &OverGround) {
        let altitude_m = place.altitude_m.max(here.altitude_m);
        let radius_m = self.config.route.loiter_radius_m;
        let step = loiter(Some(place.at), altitude_m, radius_m, RETURNS_CLOCKWISE);
        self.change_to(input, step);
    }

    /// Flies to a place, and circles around it.
    pub(super) fn go_to(&mut self, place: &Position) {
        if !(place.is_on_earth() && place.altitude_m.is_finite()) {
            return;
        }
        let at = Some(LocalPlane::at(place.latitude_rad, place.longitude_rad));
        let radius_m = self.config.route.loiter_radius_m;
        self.change_to(
            ModeInput::GoTo,
            loiter(at, place.altitude_m, radius_m, true),
        );
    }

    /// Returns to the nearest place to return to; without one it circles.
    pub(super) fn return_home(&mut self) {
        self.change_to(ModeInput::Return, Step::Return);
    }

    /// Flies one step in the mode that follows an input, if there is one.
    fn change_to(&mut self, input: ModeInput, step: Step) {
        if let Some(mode) = self.guidance.after(&self.config, input) {
            self.fly_step(mode, step);
        }
    }

    /// Flies one step; whether it can be flown now.
    fn fly_step(&mut self, mode: Mode, step: Step) -> bool {
        if self.estimator.ground.here().is_none() {
            return false;
        }
        let returns = self.config.plan.map_or(&[][..], |plan| plan.returns);
        let airspeed_mps = self.guidance.targets.airspeed_mps;
        let follower = Follower::to(step, returns, self.config.route, airspeed_mps);
        let follower = follower.after(self.supervisor.took_off);
        self.enter(&OverGroundMode::new(mode, follower, self.guidance.targets));
        true
    }

    /// Continues a mode over the ground after a restart; whether it is one.
    pub(super) fn resume_over_ground(&mut self, mode: Mode, item: u32) -> bool {
        match mode {
            Mode::Land | Mode::GoAround if item == 0 => {
                if !self.land_back() {
                    self.return_home();
                }
            }
            Mode::Plan | Mode::Takeoff | Mode::Land | Mode::GoAround => {
                self.fly_plan(u16::try_from(item).unwrap_or(0));
            }
            Mode::Loiter | Mode::GoTo => self.pause(),
            Mode::Return => self.return_home(),
            Mode::Glide => self.resume_glide(),
            Mode::None | Mode::Hold | Mode::TimedPattern => return false,
        }
        true
    }

    /// Enters a mode over the ground.
    pub(super) fn enter(&mut self, mode: &OverGroundMode) {
        self.leave();
        if self.guidance.mode.over_ground().is_none() {
            // The others command a bank at once: the aircraft has not reached it yet.
            self.loops.bank.reset(self.estimator.estimate().roll_rad);
        }
        self.guidance.reference = AltitudeReference::SeaLevel;
        self.guidance.capture = None;
        self.guidance.mode = ActiveMode::OverGround(*mode);
    }

    /// Remembers a plan that is left for another mode, and leads from the bank of a
    /// mode over the ground to that of another.
    pub(super) fn leave(&mut self) {
        let Some(mode) = self.guidance.mode.over_ground().copied() else {
            return;
        };
        if mode.is_plan() {
            self.supervisor.left_plan = Some(mode);
        }
        self.loops
            .heading
            .lead_from(self.guidance.setpoints.roll_rad);
    }
}

/// A circle without an end.
const fn loiter(at: Option<LocalPlane>, altitude_m: f64, radius_m: f64, clockwise: bool) -> Step {
    Step::Loiter {
        at,
        altitude_m,
        radius_m,
        clockwise,
        until: Until::Never,
        leave_towards_next: false,
    }
}
