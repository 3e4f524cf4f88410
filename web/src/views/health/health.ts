/** Health: how the loop keeps time, what the sensors give, what the board has left. */

import { getJson, message, type Finding } from "../../core/api";
import { button, h, icon, replace, setText } from "../../core/dom";
import { notOnNextFrame, onNextFrame } from "../../core/frame";
import { bytes, fixed, microseconds } from "../../core/units";
import { freshness } from "../../live/flight-state";
import { daemon, linkAge, newest, onEvent, onRecord, run } from "../../live/session";
import type { RunStatus } from "../../live/connection";
import type { LiveRecord } from "../../live/record";
import type { View } from "../../shell";
import { EventList } from "../event-list";
import { CalibrationPanel } from "./calibration";
import { Histogram } from "./histogram";
import { SensorTable } from "./sensors";
import { StageBars } from "./stages";
import "../../design/health.css";

const AGED_EVERY_MS = 500;

interface Figure {
  label: string;
  text: (run: RunStatus | null, record: LiveRecord | null) => string;
  tone?: (run: RunStatus | null, record: LiveRecord | null) => string;
}

const given = (value: number | null | undefined, digits: number, unit: string): string =>
  value === null || value === undefined ? "–" : `${fixed(value, digits)}\u202f${unit}`;
const late = (us: number | null | undefined, digits: number): string => (us === null || us === undefined ? "–" : microseconds(us, digits));
const bad = (on: boolean) => (on ? "bad" : "");
const HOT_C = 80;

const TIMING: readonly Figure[] = [
  { label: "p50", text: (r) => late(r?.lateness_p50_us, 2) },
  { label: "p99", text: (r) => late(r?.lateness_p99_us, 2) },
  { label: "p99.9", text: (r) => late(r?.lateness_p99_9_us, 2) },
  { label: "Largest", text: (r) => late(r?.lateness_max_us, 1) },
  { label: "Missed periods", text: (r) => String(r?.missed ?? "–"), tone: (r) => bad((r?.missed ?? 0) > 0) },
  { label: "Overruns", text: (_, one) => (one ? String(one.number("overruns")) : "–"), tone: (_, one) => bad((one?.number("overruns") ?? 0) > 0) },
  { label: "Ticks", text: (r) => (r?.ticks ?? 0).toLocaleString("en") },
  { label: "Early wake", text: (_, one) => (one ? microseconds(one.number("early_wake_ns") / 1000, 0) : "–") },
];

const BOARD: readonly Figure[] = [
  { label: "Load, 1 min", text: (r) => (r?.load ? `${fixed(r.load[0] ?? NaN, 2)} of ${r.processors ?? "?"}` : "–"), tone: (r) => bad((r?.load?.[0] ?? 0) > (r?.processors ?? Infinity)) },
  { label: "Temperature", text: (r) => given(r?.temperature_c, 1, "°C"), tone: (r) => bad((r?.temperature_c ?? 0) > HOT_C) },
  { label: "Memory free", text: (r) => bytes(r?.memory_available_bytes ?? NaN) },
  { label: "Disk free", text: (r) => bytes(r?.disk_available_bytes ?? NaN) },
  { label: "Watchers", text: (r) => String(r?.watchers ?? "–") },
  { label: "Viewers of the station", text: (r) => String(r?.station?.clients ?? "–") },
  { label: "Station's CPU", text: (r) => given(r?.station?.cpu_percent, 1, "%") },
  { label: "Station's memory", text: (r) => bytes(r?.station?.memory_bytes ?? NaN) },
];

const RECORDER: readonly Figure[] = [
  { label: "State", text: (r) => r?.recorder ?? "–", tone: (r) => (r?.recorder === "recording" ? "good" : bad(r?.recorder === "cannot write")) },
  { label: "Records", text: (r) => (r?.recorded ?? 0).toLocaleString("en") },
  { label: "Not recorded", text: (r) => String(r?.not_recorded ?? "–"), tone: (r) => bad((r?.not_recorded ?? 0) > 0) },
  { label: "Size", text: (r) => bytes(r?.recording_bytes ?? NaN) },
];

function figures(list: readonly Figure[]): { element: HTMLElement; show: (run: RunStatus | null, record: LiveRecord | null) => void } {
  const cells = list.map((one) => ({ one, value: h("dd", {}), box: h("div", { class: "figure" }) }));
  for (const { one, value, box } of cells) box.append(h("dt", {}, one.label), value);
  return {
    element: h("dl", { class: "figures" }, ...cells.map((cell) => cell.box)),
    show: (status, record) => {
      for (const { one, value, box } of cells) {
        setText(value, one.text(status, record));
        box.dataset["tone"] = one.tone?.(status, record) ?? "";
      }
    },
  };
}

export function openHealth(): View {
  const histogram = new Histogram();
  const stages = new StageBars();
  const sensors = new SensorTable();
  const timing = figures(TIMING);
  const board = figures(BOARD);
  const recorder = figures(RECORDER);
  const file = h("p", { class: "note mono" });
  const list = new EventList();
  const findings = h("ul", { class: "findings", tabindex: 0, "aria-label": "Findings of the doctor" });
  const doctor_note = h("p", { class: "note", role: "status" });
  const calibration = new CalibrationPanel();

  const draw = () => {
    const record = newest();
    const status = run.get();
    timing.show(status, record);
    board.show(status, record);
    recorder.show(status, record);
    setText(file, status?.recording ?? "");
    histogram.show(status?.lateness_counts ?? null);
    stages.show(record, daemon.get()?.rate_hz ?? 0);
    sensors.show(record, linkAge());
    element.dataset["fresh"] = freshness(linkAge()) === "lost" ? "stale" : "fresh";
  };

  const examine = async () => {
    setText(doctor_note, "Examining the board …");
    try {
      const found = await getJson<Finding[]>("/doctor");
      replace(findings, ...found.map(finding));
      const good = found.filter((one) => one.grade === "ok").length;
      setText(doctor_note, `${good} of ${found.length} are good.`);
    } catch (error) {
      setText(doctor_note, `The doctor does not answer: ${message(error)}`);
    }
  };

  const stops = [onRecord(() => onNextFrame(draw)), onEvent((event) => list.add(event)), run.watch(() => onNextFrame(draw))];
  const timer = setInterval(() => onNextFrame(draw), AGED_EVERY_MS);

  const panel = (title: string, name: string, ...content: HTMLElement[]) => h("section", { class: `panel ${name}`, "aria-label": title }, h("h2", {}, title), ...content);
  const element = h(
    "div",
    { class: "page health" },
    h("h1", { class: "visually-hidden" }, "Health"),
    panel("Lateness of the loop", "lateness", histogram.canvas, timing.element),
    panel("Stages of a tick", "stage-panel", stages.element),
    panel("Board", "board", board.element),
    panel("Recorder", "recorder", recorder.element, file),
    panel("Sensors", "sensor-panel", sensors.element),
    panel("Calibration", "calibration-panel", calibration.element),
    h("section", { class: "panel doctor", "aria-label": "Doctor" }, h("div", { class: "row end" }, h("h2", {}, "Doctor"), button("Examine again", () => void examine(), { class: "button small" })), doctor_note, findings),
    panel("Events", "event-panel", list.element),
  );
  void examine();
  onNextFrame(draw);
  return {
    element,
    close() {
      for (const stop of stops) stop();
      clearInterval(timer);
      notOnNextFrame(draw);
      histogram.close();
      calibration.close();
    },
  };
}

function finding(one: Finding): HTMLElement {
  const good = one.grade === "ok";
  const known = !/not.known/.test(one.grade);
  return h(
    "li",
    { class: good ? "good" : known ? "wrong" : "unknown" },
    h("span", { class: "finding-state" }, good || !known ? null : icon("warning"), one.grade.replaceAll("_", " ")),
    h("div", {}, h("strong", {}, one.name), h("span", { class: "note" }, ` ${one.found}`), one.why ? h("code", { class: "mends" }, one.why) : null, ...one.remedies.map((remedy) => h("code", { class: "mends", title: remedy.place }, `${remedy.place}: ${remedy.line}`))),
  );
}
