/** A recorded flight on the instruments and the map of the live view; a second one over it. */

import L from "leaflet";
import { getJson, message, part, type Difference, type Flight } from "../../core/api";
import { append, button, h, replace, setText } from "../../core/dom";
import { fixed, shown, unitSystem, utc, withUnit } from "../../core/units";
import { FlightDisplay } from "../../instruments/display";
import { flightState, modeText, type FlightState } from "../../live/flight-state";
import { AircraftLayer } from "../../map/aircraft";
import { createChart } from "../../map/chart";
import { PlanLayer } from "../../map/plan-layer";
import { TrackLayer } from "../../map/track";
import { TrackPoints } from "../../map/track-points";
import type { View } from "../../shell";
import { eventItem } from "../event-list";
import { Plots } from "./plots";
import { Recording } from "./recording";
import { Timeline } from "./timeline";
import "../../design/flights.css";
import "../../design/fly.css";

/** Faster changes of a text are not readable, and each one is laid out anew. */
const TEXTS_EVERY_MS = 100;

export async function openReplay(file: string, other_file: string | undefined): Promise<View> {
  const recording = await Recording.open(file);
  const chart = createChart("Map of the flight");
  const { map } = chart;
  const plan = new PlanLayer(map);
  plan.show(recording.plan?.plan ?? null, null);
  new TrackLayer(pointsOf(recording)).addTo(map);
  const aircraft = new AircraftLayer().addTo(map);
  const ghost = new AircraftLayer(true, false).addTo(map);
  const display = new FlightDisplay();
  display.setLimits(recording.aircraft);
  const values = h("dl", { class: "readouts", "aria-label": "Flight values" });
  const cells = ["State", "Mode", "To go", "Off path", "Ground speed", "Wind", "UTC"].map((label) => {
    const value = h("dd", {});
    values.append(h("div", { class: "readout", "data-tone": "", "data-fresh": "fresh" }, h("dt", {}, label), value));
    return value;
  });
  const events = h("ol", { class: "events", "aria-label": "Events of the flight", tabindex: 0 });
  const items = recording.events.map((event) => {
    const item = eventItem(event);
    item.append(button(`Go to ${fixed(event.time_s, 1)} s`, () => timeline.seek(event.time_s), { class: "event-seek", bare: true }));
    events.append(item);
    return item;
  });
  const differences = h("div", { class: "differences" });
  const notice = h("p", { class: "result", role: "status" });

  let other: Recording | null = null;
  let shift_s = 0;
  let other_track: TrackLayer | null = null;
  let state: FlightState | null = null;
  let written_ms = -Infinity;

  const moved = (time_s: number, playing = false) => {
    const row = recording.row(time_s);
    state = flightState(row, 0);
    display.show(state);
    aircraft.show(state.position_known ? state : null);
    const second = other ? flightState(other.row(time_s - shift_s), 0) : null;
    ghost.show(second?.position_known ? second : null);
    plots.show(time_s);
    const now = performance.now();
    if (playing && now - written_ms < TEXTS_EVERY_MS) return;
    written_ms = now;
    const engaged = row.number("state") === 1;
    const mode = recording.named("desired_guidance_mode", time_s);
    const item = row.number("desired_guidance_item");
    plan.mark(engaged && ["plan", "takeoff", "land"].includes(mode) ? item : 0);
    const texts = [
      recording.named("state", time_s),
      modeText(mode, item),
      engaged && row.number("desired_to_go_m") > 0 ? withUnit("distance", row.number("desired_to_go_m")) : "–",
      engaged ? withUnit("length", row.number("desired_cross_track_m")) : "–",
      withUnit("speed", state.ground_speed_mps),
      state.wind_mps <= 0.2 ? "calm" : `${shown("heading", state.wind_from_rad)}° ${withUnit("wind", state.wind_mps)}`,
      utc(recording.start_utc_s + time_s).slice(11, 19),
    ];
    cells.forEach((cell, at) => setText(cell, texts[at] ?? ""));
    const last = recording.events.findLastIndex((event) => event.time_s <= time_s);
    items.forEach((one, at) => one.toggleAttribute("data-now", at === last));
  };

  const plots = new Plots(recording, (time_s) => timeline.seek(time_s));
  const timeline: Timeline = new Timeline(recording, moved);

  const compare = async (with_file: string) => {
    other_track?.remove();
    other_track = null;
    other = null;
    replace(differences);
    if (with_file === "") {
      plots.compare(null, 0);
      moved(recording.begin_s);
      return;
    }
    try {
      const [second, found] = await Promise.all([Recording.open(with_file), getJson<Difference[]>(`/flights/${part(file)}/compare/${part(with_file)}`)]);
      other = second;
      // Both begin when control was taken.
      shift_s = recording.engaged_s() - second.engaged_s();
      other_track = new TrackLayer(pointsOf(second), "second", true).addTo(map);
      plots.compare(second, shift_s);
      replace(differences, table(found));
      setText(notice, "");
    } catch (error) {
      setText(notice, `The flights cannot be compared: ${message(error)}`);
    }
  };
  const picker = h("select", { "aria-label": "Second flight", change: () => void compare(picker.value) }, h("option", { value: "" }, "no second flight"));
  if (other_file) void compare(other_file);
  // A list that reads new recordings may come late.
  void getJson<Flight[]>("/flights").then((flights) => {
    const others = flights.filter((one) => one.file !== file);
    append(picker, others.map((one) => h("option", { value: one.file }, `${utc(one.start_utc_s)} ${one.instance}`)));
    picker.value = other?.file ?? other_file ?? "";
  }, () => undefined);

  const fit = () => {
    const bounds = L.latLngBounds([]);
    for (let at = 0; at < recording.time.length; at += Math.max(1, Math.floor(recording.time.length / 300))) {
      const [lat, lon] = recording.place(at);
      if (Number.isFinite(lat)) bounds.extend([lat, lon]);
    }
    if (bounds.isValid()) map.fitBounds(bounds, { animate: false, paddingTopLeft: [30, 74], paddingBottomRight: [60, 40] });
  };
  chart.controls.append(button("Show the whole flight", fit, { icon: "fit", bare: true, class: "map-button" }));
  const fit_once = new ResizeObserver(() => {
    if (map.getSize().x === 0) return;
    fit_once.disconnect();
    fit();
  });
  fit_once.observe(chart.element);

  const keys = (event: KeyboardEvent) => {
    if (event.key !== " " || event.target instanceof HTMLButtonElement || event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement) return;
    event.preventDefault();
    timeline.toggle();
  };
  document.addEventListener("keydown", keys);
  const stop = unitSystem.watch(() => state && moved(recording.begin_s));

  const link = (format: string) => h("a", { class: "button", href: `/api/flights/${part(file)}/download?format=${format}`, download: "" }, format.toUpperCase());
  const element = h(
    "div",
    { class: "replay" },
    h("div", { class: "replay-head row" }, h("a", { class: "button", href: "#/flights" }, "All flights"), h("h1", {}, utc(recording.start_utc_s)), h("span", { class: "note mono" }, file), h("div", { class: "spacer" }), h("label", { class: "labelled" }, "Compare with ", picker), h("a", { class: "button", href: `/api/flights/${part(file)}/report`, target: "_blank", rel: "noopener" }, "Report"), ...["mcap", "csv", "gpx", "kml"].map(link)),
    h("div", { class: "replay-map" }, chart.element, values),
    h("div", { class: "replay-side" }, display.element, h("section", { class: "panel event-panel", "aria-label": "Events" }, h("h2", {}, "Events"), events)),
    timeline.element,
    notice,
    differences,
    plots.element,
  );
  return {
    element,
    close() {
      document.removeEventListener("keydown", keys);
      fit_once.disconnect();
      stop();
      timeline.close();
      plots.close();
      display.close();
      plan.close();
      chart.close();
    },
  };
}

function pointsOf(recording: Recording): TrackPoints {
  const points = new TrackPoints();
  for (let at = 0; at < recording.time.length; at += 1) {
    const [lat, lon] = recording.place(at);
    if (Number.isFinite(lat) && Number.isFinite(lon)) points.add(lat, lon);
  }
  return points;
}

function table(found: Difference[]): HTMLElement {
  const text = (value: number | string | null) => (typeof value === "number" ? String(Number(value.toPrecision(4))) : (value ?? "–"));
  return h(
    "section",
    { class: "panel", "aria-label": "Differences" },
    h("h2", {}, "Differences"),
    h("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Table of differences" }, h("table", {}, h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Figure"), h("th", { scope: "col", class: "number" }, "This"), h("th", { scope: "col", class: "number" }, "Second"), h("th", { scope: "col" }, "Unit"), h("th", { scope: "col" }, "What differs"))), h("tbody", {}, ...found.map((one) => h("tr", {}, h("th", { scope: "row" }, one.what), h("td", { class: "number" }, text(one.a)), h("td", { class: "number" }, text(one.b)), h("td", { class: "unit" }, one.unit), h("td", { class: "sentence" }, one.sentence)))))),
  );
}
