/** Fly: where the aircraft is, what it does, what it is told. */

import L from "leaflet";
import { getJson, part, writable, type VehiclePlan } from "../../core/api";
import { button, h, replace, setClass, setText } from "../../core/dom";
import { notOnNextFrame, onNextFrame } from "../../core/frame";
import { duration, fixed, shown, unitSystem, withUnit } from "../../core/units";
import { FlightDisplay } from "../../instruments/display";
import { daemon, events, flown, linkAge, linkProblem, newest, onEvent, onRecord, run_started_utc_s } from "../../live/session";
import { flightState, freshness, modeText, type FlightState } from "../../live/flight-state";
import type { LiveRecord } from "../../live/record";
import { AircraftLayer } from "../../map/aircraft";
import { createChart } from "../../map/chart";
import { PlanLayer } from "../../map/plan-layer";
import { TrackLayer } from "../../map/track";
import type { View } from "../../shell";
import { EventList } from "../event-list";
import { adviceFor } from "./advice";
import { Commands } from "./commands";
import { SetPoints } from "./set-points";
import "../../design/fly.css";

/** Values age also when nothing arrives. */
const AGED_EVERY_MS = 250;
/** Faster changes of a text are not readable, and each one is laid out anew. */
const TEXTS_EVERY_MS = 200;
const PLAN_EVERY_MS = 5000;
const FIRST_ZOOM = 13;
const STANDS_MPS = 1;
/** What began and has not ended, also what is no fault: events alone tell it. */
const present = (names: readonly string[], told = events.filter((one) => /^(now|no longer): /.test(one.text))): string[] =>
  names.filter((name) => told.findLast((one) => one.text.includes(name))?.text.split("no longer: ")[0]?.includes(name));
/** As the daemon reports this command, whoever gave it. */
const GO_TO = /go to (-?[\d.]+)°, (-?[\d.]+)°/;

interface Readout {
  label: string;
  text: (record: LiveRecord, state: FlightState) => string;
  /** Of what is shown, s; the link's alone where it is not a reading. */
  age?: (state: FlightState) => number;
  tone?: (record: LiveRecord) => string;
}

const CHARGE_LOW = 0.25;

const READOUTS: readonly Readout[] = [
  { label: "State", text: (r) => r.named("state"), tone: (r) => ({ engaged: "good", failsafe: "bad" })[r.named("state")] ?? "" },
  { label: "Mode", text: (r) => modeText(r.named("desired_guidance_mode"), r.number("desired_guidance_item")) },
  { label: "To go", text: (r) => (r.number("state") === 1 && r.number("desired_to_go_m") > 0 ? withUnit("distance", r.number("desired_to_go_m")) : "–") },
  { label: "Off path", text: (r) => (r.number("state") === 1 ? withUnit("length", r.number("desired_cross_track_m")) : "–"), age: (s) => s.ages.position },
  { label: "Ground speed", text: (_, s) => withUnit("speed", s.ground_speed_mps), age: (s) => s.ages.position },
  { label: "Course (true)", text: (_, s) => (s.ground_speed_mps > 2 ? `${shown("heading", s.course_rad)}°` : "–"), age: (s) => s.ages.position },
  { label: "Position ±", text: (r) => withUnit("length", r.number("estimated_position_uncertainty_m")), age: (s) => s.ages.position },
  {
    label: "Battery",
    text: (r) => {
      const charge = r.number("battery_charge");
      const volts = `${fixed(r.number("battery_voltage_v"), 1)} V`;
      return r.number("battery_taken_ns") > 0 ? (Number.isFinite(charge) ? `${fixed(charge * 100, 0)} %, ${volts}` : volts) : "–";
    },
    tone: (r) => (r.number("battery_taken_ns") > 0 && r.number("battery_charge") < CHARGE_LOW ? "bad" : ""),
  },
  { label: "Load", text: (_, s) => `${fixed(s.load_factor, 2)} g`, age: (s) => s.ages.attitude },
  { label: "Failsafe", text: (r) => r.named("desired_contingency"), tone: (r) => (r.number("desired_contingency") > 0 ? "bad" : "") },
];

export function openFly(): View {
  const chart = createChart("Map of the flight");
  const { map } = chart;
  const track = new TrackLayer(flown).addTo(map);
  const aircraft = new AircraftLayer().addTo(map);
  const plan = new PlanLayer(map);
  const goal = L.marker([0, 0], { interactive: false, keyboard: false, zIndexOffset: 200, alt: "Go to", icon: L.divIcon({ className: "point-box", html: h("span", { class: "point active" }, "Go to"), iconSize: [54, 24] }) });
  const display = new FlightDisplay();
  const commands = new Commands(map);
  const set_points = new SetPoints((values) => void commands.send({ set: values }));
  const list = new EventList();
  const conditions_title = h("h2", {}, "Conditions");
  const conditions_list = h("ul", { class: "scroll", tabindex: 0, "aria-label": "Conditions, the newest first" });
  const conditions = h("section", { class: "panel conditions", "aria-label": "Conditions", role: "status" }, conditions_title, conditions_list);
  const cells = READOUTS.map((one) => ({ one, value: h("dd", {}), box: h("div", { class: "readout" }) }));
  for (const { one, value, box } of cells) box.append(h("dt", {}, one.label), value);
  const strip = h("dl", { class: "readouts", "aria-label": "Flight values" }, ...cells.map((cell) => cell.box));
  const no_data = h("p", { class: "no-data", role: "status" });
  const hash = h("span", { class: "mono" });
  const clock = h("span", { class: "mono" });

  let following = true;
  const follow = button("Keep the aircraft in the centre", () => setFollowing(!following), { icon: "centre", bare: true, class: "map-button" });
  const setFollowing = (on: boolean) => {
    following = on;
    follow.setAttribute("aria-pressed", String(on));
    if (on) centred = false;
  };
  chart.controls.append(
    follow,
    button("Show the whole plan", () => {
      const bounds = plan.bounds();
      if (!bounds) return;
      setFollowing(false);
      map.fitBounds(bounds, { animate: false, paddingTopLeft: [20, 110], paddingBottomRight: [64, 20] });
    }, { icon: "fit", bare: true, class: "map-button" }),
  );
  map.on("dragstart", () => setFollowing(false));
  let centred = false;
  setFollowing(true);

  let shown_conditions = "";
  let found: string[] = [];
  const showConditions = (record: LiveRecord, engaged: boolean) => {
    const now = new Set(engaged ? [...record.flags("faults"), ...present(record.layout.at(record.layout.indexOf("faults"))?.names ?? [])] : record.flags("engage_inhibits"));
    // What is new comes first.
    found = [...[...now].filter((one) => !found.includes(one)), ...found.filter((one) => now.has(one))];
    const key = `${engaged}${found.join("|")}`;
    if (key === shown_conditions) return;
    shown_conditions = key;
    setClass(conditions, "some", found.length > 0);
    const title = engaged ? "Conditions in flight" : found.length > 0 ? "Engaging is inhibited" : "Engaging is not inhibited";
    setText(conditions_title, found.length > 0 ? `${title}: ${found.length}` : engaged ? "No condition in flight" : title);
    replace(conditions_list, ...found.map((one) => h("li", {}, h("strong", {}, one), " ", h("span", { class: "advice" }, engaged ? null : adviceFor(one)))));
  };

  let texts_ms = -Infinity;
  const draw = () => {
    const record = newest();
    const age = linkAge();
    setClass(no_data, "hidden", record !== null && linkProblem.get() === "");
    setText(no_data, linkProblem.get() || "Waiting for the first record.");
    if (!record) {
      display.show(null);
      set_points.show(null);
      commands.show({ engaged: false, mode: "", inhibits: [], fresh: false, landed: false, altitude_m: NaN });
      return;
    }
    const state = flightState(record, age);
    display.show(state);
    if (state.position_known) {
      const lost = freshness(state.ages.position) === "lost";
      aircraft.show(state, lost);
      track.grow();
      keepInView(state);
    }
    const now = performance.now();
    if (now - texts_ms < TEXTS_EVERY_MS) return;
    texts_ms = now;
    set_points.show(state);
    const mode = record.named("desired_guidance_mode");
    const fresh = freshness(age) !== "lost";
    set_points.setEditable(state.engaged && fresh && writable.get(), !state.engaged ? "Nothing is held: not engaged." : mode === "hold" || !writable.get() ? "" : `A set point ends mode ${modeText(mode, 0)}, and is held.`);
    commands.show({ engaged: state.engaged, mode, inhibits: record.flags("engage_inhibits"), fresh, landed: state.engaged && mode === "land" && state.ground_speed_mps < STANDS_MPS && !(state.airspeed_mps > (daemon.get()?.aircraft?.stall_mps ?? Infinity)), altitude_m: state.altitude_m });
    showConditions(record, state.engaged);
    for (const { one, value, box } of cells) {
      setText(value, one.text(record, state));
      box.dataset["fresh"] = freshness(one.age ? one.age(state) : age);
      box.dataset["tone"] = one.tone?.(record) ?? "";
    }
    const engaged_mode = state.engaged && ["plan", "takeoff", "land"].includes(mode);
    plan.mark(engaged_mode ? record.number("desired_guidance_item") : 0);
    const place = state.engaged && mode === "go to" ? GO_TO.exec(events.findLast((one) => GO_TO.test(one.text))?.text ?? "") : null;
    if (place) goal.setLatLng([Number(place[1]), Number(place[2])]).addTo(map);
    else goal.remove();
    const flown = record.bits("desired_plan_hash");
    setText(hash, flown === 0n ? "no plan" : flown.toString(16).padStart(16, "0"));
    setText(clock, duration(record.number("tick") / (daemon.get()?.rate_hz || 1)));
  };

  /** The map follows in steps, so that it is not drawn anew for each record. */
  const keepInView = (state: FlightState) => {
    if (!following || map.getSize().x === 0) return;
    const here: [number, number] = [state.latitude_deg, state.longitude_deg];
    if (!centred) {
      centred = true;
      map.setView(here, Math.max(map.getZoom(), FIRST_ZOOM), { animate: false });
      return;
    }
    const away = map.latLngToContainerPoint(here).distanceTo(map.getSize().divideBy(2));
    if (away > Math.min(map.getSize().x, map.getSize().y) * 0.22) map.panTo(here, { animate: false });
  };

  let vehicle_hash = "";
  const fetchPlan = async () => {
    const instance = daemon.get()?.instance;
    if (!instance) return;
    try {
      const found = await getJson<VehiclePlan | null>(`/live/${part(instance)}/plan`);
      if ((found?.hash ?? "") === vehicle_hash) return;
      vehicle_hash = found?.hash ?? "";
      plan.show(found?.plan ?? null, null);
    } catch {
      // Shown again with the next attempt; the link's state is in the header.
    }
  };

  const stops = [
    onRecord(() => onNextFrame(draw)),
    onEvent((event) => list.add(event)),
    unitSystem.watch(() => onNextFrame(draw)),
    linkProblem.watch(() => onNextFrame(draw)),
    daemon.watch((one) => {
      display.setLimits(one?.aircraft ?? null);
      set_points.build(one);
      vehicle_hash = "";
      void fetchPlan();
    }),
    run_started_utc_s.watch(() => track.grow()),
  ];
  const timers = [
    setInterval(() => {
      if (linkAge() > AGED_EVERY_MS / 1000) onNextFrame(draw);
    }, AGED_EVERY_MS),
    setInterval(() => void fetchPlan(), PLAN_EVERY_MS),
  ];
  onNextFrame(draw);

  const side = h(
    "div",
    { class: "fly-side" },
    display.element,
    conditions,
    commands.element,
    set_points.element,
    h("section", { class: "panel event-panel", "aria-label": "Events of this run" }, h("h2", {}, "Events"), list.element),
  );
  const caption = h("div", { class: "flown" }, h("span", {}, "Run "), clock, h("span", {}, "Plan "), hash);
  const element = h("div", { class: "fly" }, h("h1", { class: "visually-hidden" }, "Fly"), h("div", { class: "fly-map" }, chart.element, strip, no_data, caption), side);
  return {
    element,
    close() {
      notOnNextFrame(draw);
      for (const stop of stops) stop();
      timers.forEach(clearInterval);
      plan.close();
      display.close();
      chart.close();
    },
  };
}
