//! The items of a flight plan as they were flown, and the landing, by what was recorded.

use comfy_table::Table;
use fcc_core::framework::{Notice, RecordOf, State};
use fcc_fixed_wing::{Autopilot, ITEM_REACHED};
use fcc_guidance::Mode;
use fcc_telemetry::units::{M_FT, MPS_KT};
use serde::Serialize;

use crate::table::table;

/// At most this many are listed.
const MOST: usize = 1_000;
/// As text only so many.
const MOST_AS_TEXT: usize = 16;

/// The items that were flown, in their order, by the estimate.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FlownPlan {
    /// One for each time that an item was flown.
    pub items: Vec<FlownItem>,
    /// The last touch-down.
    pub touch_down: Option<TouchDown>,
    #[serde(skip)]
    on_wheels: Option<bool>,
    /// The last item before the last record but one, and before the last.
    #[serde(skip)]
    before: [Option<FlownItem>; 2],
    /// The last item when its end was reached; a circle there may follow.
    #[serde(skip)]
    reached: Option<FlownItem>,
    /// Since when the mode was flown at the plan's end, s, which is circled at; none before.
    #[serde(skip)]
    ended_s: Option<f64>,
}

/// An item of a plan, from the end of the one before.
#[derive(Clone, Debug, Serialize)]
pub struct FlownItem {
    /// Its number, from 1.
    pub item: u32,
    /// When it began, s since the begin of the recording.
    pub begins_s: f64,
    /// How long it was flown, s.
    pub lasted_s: f64,
    /// Distance from the path, turns included, root mean square, m.
    pub cross_track_rms_m: f64,
    /// The largest either way, m.
    pub cross_track_max_m: f64,
    /// Root mean square of the altitude's difference from its set point, ft.
    pub altitude_rms_ft: f64,
    /// Largest difference of the airspeed from its set point, kt.
    pub airspeed_error_kt: f64,
    #[serde(skip)]
    squares: (f64, f64, f64),
}

/// A touch-down, as weight on wheels shows it.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TouchDown {
    /// When, s since the begin of the recording.
    pub time_s: f64,
    /// Estimated sink rate, ft/min.
    pub sink_fpm: f64,
    /// Distance from the centre line, positive to its right, m.
    pub centre_line_m: f64,
    /// Indicated airspeed, kt.
    pub airspeed_kt: f64,
    /// Bank, °.
    pub bank_deg: f64,
}

impl FlownPlan {
    /// Follows the ends of items and of the plan, after which the aircraft circles: that is
    /// no part of an item.
    pub fn notice(&mut self, notice: &Notice) {
        if notice.kind != ITEM_REACHED {
            return;
        }
        if notice.item > 0 {
            // It is told a tick late: what follows is flown already.
            let [before, _] = &mut self.before;
            let before = before.take();
            self.reached = before.filter(|before| before.item == u32::from(notice.item));
            return;
        }
        if let Some((last, reached)) = self.items.last_mut().zip(self.reached.take()) {
            *last = reached;
        }
        self.ended_s = Some(0.0);
    }

    /// Takes the next tick, at a time since the first, s.
    pub fn take(&mut self, record: &RecordOf<Autopilot>, time_s: f64) {
        if record.state.state() != State::Engaged {
            return;
        }
        let (setpoints, estimate) = (&record.setpoints, &record.estimate);
        let guidance = &setpoints.guidance;
        let wheels = &record.measurements.weight_on_wheels;
        let on_wheels = (!wheels.is_never()).then_some(wheels.value > 0.5);
        let before = std::mem::replace(&mut self.on_wheels, on_wheels);
        if guidance.mode == Mode::Land && (before, on_wheels) == (Some(false), Some(true)) {
            self.touch_down = Some(TouchDown {
                time_s,
                sink_fpm: -60.0 * M_FT * estimate.climb_rate_mps,
                centre_line_m: setpoints.cross_track_m,
                airspeed_kt: estimate.airspeed_mps * MPS_KT,
                bank_deg: estimate.roll_rad.to_degrees(),
            });
        }
        if guidance.mode != Mode::Plan {
            return;
        }
        // A plan that is flown again after its end begins its time anew.
        let is_again = self.ended_s.is_some_and(|s| guidance.elapsed_s < s);
        let is_next = is_again
            || self
                .items
                .last()
                .is_none_or(|last| last.item != guidance.item);
        if is_next {
            (self.reached, self.ended_s, self.before) = (None, None, [None, None]);
            if self.items.len() == MOST {
                return;
            }
            self.items.push(FlownItem::new(guidance.item, time_s));
        }
        if let Some(ended_s) = &mut self.ended_s {
            *ended_s = guidance.elapsed_s;
            return;
        }
        let off = [
            setpoints.cross_track_m,
            (estimate.altitude_m - setpoints.altitude_m) * M_FT,
            (estimate.airspeed_mps - setpoints.airspeed_mps) * MPS_KT,
        ];
        if let Some(item) = self.items.last_mut() {
            self.before.swap(0, 1);
            let [_, before] = &mut self.before;
            *before = Some(item.clone());
            item.take(time_s, off);
        }
    }

    /// Whether nothing of a plan was flown.
    pub const fn is_empty(&self) -> bool {
        self.items.is_empty() && self.touch_down.is_none()
    }

    /// The table as text; of a long flight the items that were flown last.
    pub fn text(&self) -> String {
        let rest = self.items.len().saturating_sub(MOST_AS_TEXT);
        match self.items.get(rest..) {
            None | Some([]) => String::new(),
            Some(items) if rest == 0 => format!("Items of the flight plan:\n{}", table_of(items)),
            Some(items) => format!(
                "The last {MOST_AS_TEXT} of {} items of the flight plan that were flown, see the \
                 page (--html) for each:\n{}",
                self.items.len(),
                table_of(items)
            ),
        }
    }

    /// For a page.
    pub(super) fn tables(&self) -> Option<(&'static str, &'static str, Table)> {
        const CAPTION: &str = "Each item from the end of the one before, by the estimate: \
            distance from the path, turns included; altitude and airspeed against their set \
            points, of the airspeed the largest difference.";
        let is_flown = !self.items.is_empty();
        is_flown.then(|| ("Items of the flight plan", CAPTION, table_of(&self.items)))
    }

    /// The touch-down in words.
    pub fn finding(&self) -> Option<String> {
        self.touch_down.map(|touch| {
            let side = if touch.centre_line_m < 0.0 {
                "left"
            } else {
                "right"
            };
            format!(
                "Touched down at {:.1} s: {:.0} ft/min, {:.1} m {side} of the centre line,\n\
                 {:.0} kt, {:.1}° of bank, by the estimate.",
                touch.time_s,
                touch.sink_fpm,
                touch.centre_line_m.abs(),
                touch.airspeed_kt,
                touch.bank_deg
            )
        })
    }
}

impl FlownItem {
    const fn new(item: u32, begins_s: f64) -> Self {
        Self {
            item,
            begins_s,
            lasted_s: 0.0,
            cross_track_rms_m: 0.0,
            cross_track_max_m: 0.0,
            altitude_rms_ft: 0.0,
            airspeed_error_kt: 0.0,
            squares: (0.0, 0.0, 0.0),
        }
    }

    fn take(&mut self, time_s: f64, [cross_m, altitude_ft, airspeed_kt]: [f64; 3]) {
        let (count, cross, altitude) = &mut self.squares;
        *count += 1.0;
        *cross += cross_m * cross_m;
        *altitude += altitude_ft * altitude_ft;
        self.cross_track_rms_m = (*cross / *count).sqrt();
        self.altitude_rms_ft = (*altitude / *count).sqrt();
        self.cross_track_max_m = self.cross_track_max_m.max(cross_m.abs());
        self.airspeed_error_kt = self.airspeed_error_kt.max(airspeed_kt.abs());
        self.lasted_s = time_s - self.begins_s;
    }
}

/// A row for each item.
fn table_of(items: &[FlownItem]) -> Table {
    let mut table = table(&[
        "Item",
        "from s",
        "for s",
        "path RMS m",
        "max m",
        "altitude RMS ft",
        "airspeed kt",
    ]);
    for item in items {
        table.add_row(vec![
            item.item.to_string(),
            format!("{:.1}", item.begins_s),
            format!("{:.1}", item.lasted_s),
            format!("{:.1}", item.cross_track_rms_m),
            format!("{:.1}", item.cross_track_max_m),
            format!("{:.1}", item.altitude_rms_ft),
            format!("{:.1}", item.airspeed_error_kt),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::{Reading, StateCode, Time};

    use super::*;

    fn record(item: u32, cross_track_m: f64) -> RecordOf<Autopilot> {
        let mut record = RecordOf::<Autopilot> {
            state: StateCode::from(State::Engaged),
            ..RecordOf::<Autopilot>::default()
        };
        record.setpoints.guidance.mode = Mode::Plan;
        record.setpoints.guidance.item = item;
        record.setpoints.cross_track_m = cross_track_m;
        record
    }

    /// The circle after the end is no part of the last item, and one that is flown again is
    /// another one.
    #[test]
    fn a_circle_at_the_end_is_not_counted() {
        let mut flown = FlownPlan::default();
        let reached = |item| Notice {
            kind: ITEM_REACHED,
            item,
            ..Notice::default()
        };
        let at = |flown: &mut FlownPlan, cross_m, elapsed_s| {
            let mut record = record(2, cross_m);
            record.setpoints.guidance.elapsed_s = elapsed_s;
            flown.take(&record, elapsed_s);
        };
        at(&mut flown, 3.0, 0.0);
        at(&mut flown, 3.0, 1.0);
        at(&mut flown, 800.0, 2.0);
        at(&mut flown, 700.0, 3.0);
        flown.notice(&reached(2));
        at(&mut flown, 600.0, 4.0);
        flown.notice(&reached(0));
        at(&mut flown, 400.0, 5.0);
        assert_eq!(flown.items.len(), 1);
        let last = &flown.items[0];
        assert_eq!((last.cross_track_max_m, last.lasted_s), (3.0, 1.0));
        at(&mut flown, 5.0, 0.0);
        assert_eq!(flown.items.len(), 2);
        assert_eq!(flown.items[1].cross_track_max_m, 5.0);
    }

    /// The root mean square of 3 and 4 is that of 12.5; 1 m/s is 196.85 ft/min.
    #[test]
    fn items_and_the_touch_down_are_measured() {
        let mut flown = FlownPlan::default();
        for (n, (item, cross_m)) in [(1, 3.0), (1, -4.0), (2, 1.0)].into_iter().enumerate() {
            flown.take(&record(item, cross_m), n as f64);
        }
        assert_eq!(flown.items.len(), 2);
        assert!((flown.items[0].cross_track_rms_m - 12.5_f64.sqrt()).abs() < 1e-12);
        assert_eq!(flown.items[0].cross_track_max_m, 4.0);
        assert_eq!(flown.finding(), None);
        for (n, weight) in [0.0, 1.0, 1.0].into_iter().enumerate() {
            let mut landing = record(3, -2.0);
            landing.setpoints.guidance.mode = Mode::Land;
            landing.estimate.climb_rate_mps = -1.0;
            let wheels = &mut landing.measurements.weight_on_wheels;
            *wheels = Reading::new(weight, Time::from_nanos(1));
            flown.take(&landing, 10.0 + n as f64);
        }
        let words = flown.finding().unwrap();
        let expected = "Touched down at 11.0 s: 197 ft/min, 2.0 m left of the centre line";
        assert!(words.starts_with(expected), "{words}");
    }
}
