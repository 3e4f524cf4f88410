/** Plots of a replay: one range of time for all, a line at the present. */

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { h } from "../../core/dom";
import { toShown, unitOf, unitSystem, type Quantity } from "../../core/units";
import { palette, FONT, type Palette } from "../../design/theme";
import { decimate } from "./decimate";
import type { Recording } from "./recording";

interface Line {
  column: string;
  label: string;
  colour: keyof Palette;
  /** Of what is not a quantity of the unit table: SI to shown. */
  factor?: number;
}

interface Plot {
  title: string;
  quantity?: Quantity;
  unit?: string;
  lines: Line[];
}

const PLOTS: readonly Plot[] = [
  { title: "Altitude", quantity: "altitude", lines: [{ column: "estimated_altitude_m", label: "actual", colour: "track" }, { column: "desired_altitude_m", label: "set", colour: "set" }] },
  { title: "Airspeed", quantity: "speed", lines: [{ column: "estimated_airspeed_mps", label: "actual", colour: "track" }, { column: "desired_airspeed_mps", label: "set", colour: "set" }] },
  { title: "Bank", quantity: "angle", lines: [{ column: "estimated_roll_rad", label: "actual", colour: "track" }, { column: "desired_roll_rad", label: "set", colour: "set" }] },
  { title: "Pitch", quantity: "angle", lines: [{ column: "estimated_pitch_rad", label: "actual", colour: "track" }, { column: "desired_pitch_rad", label: "set", colour: "set" }] },
  { title: "Off path", quantity: "length", lines: [{ column: "desired_cross_track_m", label: "to the right", colour: "track" }] },
  { title: "Time of a tick", unit: "µs", lines: [{ column: "total_time_ns", label: "whole tick", colour: "track", factor: 1e-3 }] },
];

const HEIGHT_PX = 132;

export class Plots {
  readonly element = h("div", { class: "plots" });
  #plots: { plot: Plot; chart: uPlot; now: HTMLElement }[] = [];
  #range: [number, number];
  #other: { recording: Recording; shift_s: number } | null = null;
  #now = 0;
  readonly #stops: (() => void)[];
  readonly #observer = new ResizeObserver(() => {
    for (const { chart } of this.#plots) {
      const width = this.#width();
      if (Math.abs(chart.width - width) > 1) chart.setSize({ width, height: HEIGHT_PX });
    }
    this.#mark();
  });

  constructor(
    private readonly recording: Recording,
    private readonly seek: (time_s: number) => void,
  ) {
    this.#range = [recording.begin_s, recording.end_s];
    this.#observer.observe(this.element);
    this.#stops = [palette.watch(() => this.#build()), unitSystem.watch(() => this.#build())];
  }

  close(): void {
    this.#observer.disconnect();
    for (const stop of this.#stops) stop();
    for (const { chart } of this.#plots) chart.destroy();
  }

  /** Its times plus the shift are those of the first. */
  compare(recording: Recording | null, shift_s: number): void {
    this.#other = recording ? { recording, shift_s } : null;
    this.#build();
  }

  show(time_s: number): void {
    this.#now = time_s;
    this.#mark();
  }

  #width(): number {
    const columns = getComputedStyle(this.element).gridTemplateColumns.split(" ").length || 1;
    return Math.max(200, Math.floor((this.element.clientWidth - (columns - 1) * 12) / columns));
  }

  #mark(): void {
    for (const { chart, now } of this.#plots) {
      const x = Math.round(chart.valToPos(this.#now, "x"));
      const inside = x >= 0 && x <= chart.bbox.width / devicePixelRatio;
      now.style.transform = `translateX(${inside ? x : -10}px)`;
    }
  }

  #build(): void {
    for (const { chart } of this.#plots) chart.destroy();
    this.element.replaceChildren();
    const sync = uPlot.sync("replay");
    this.#plots = PLOTS.filter((plot) => plot.lines.some((line) => this.recording.column(line.column).length > 0)).map((plot) => {
      const holder = h("figure", { class: "plot" });
      const unit = plot.quantity ? unitOf(plot.quantity) : (plot.unit ?? "");
      holder.append(h("figcaption", {}, h("strong", {}, plot.title), " ", h("span", { class: "unit" }, unit), ...this.#legend(plot)));
      this.element.append(holder);
      const chart = new uPlot(this.#options(plot, sync.key), this.#data(plot), holder);
      const now = h("div", { class: "plot-now" });
      chart.over.append(now);
      return { plot, chart, now };
    });
    this.#mark();
  }

  #legend(plot: Plot): HTMLElement[] {
    const names = plot.lines.length > 1 || this.#other ? plot.lines.map((line) => h("span", { class: `key key-${line.colour}` }, line.label)) : [];
    return this.#other ? [...names, h("span", { class: "key key-second" }, "second flight")] : names;
  }

  #data(plot: Plot): uPlot.AlignedData {
    const parts = Math.max(200, Math.min(1200, this.#width()));
    const convert = (line: Line) => (plot.quantity ? toShown(plot.quantity, 1) : (line.factor ?? 1));
    const scaled = (values: number[], factor: number) => values.map((one) => (Number.isFinite(one) ? one * factor : null));
    const state = this.recording.column("state");
    // What nothing holds has no set point.
    const column = (line: Line) => {
      const values = this.recording.column(line.column);
      return line.colour === "set" ? Float64Array.from(values, (one, at) => (state[at] === 1 ? one : NaN)) : values;
    };
    const [time, ...series] = decimate(this.recording.time, plot.lines.map(column), this.#range[0], this.#range[1], parts);
    const own = series.map((values, at) => scaled(values, convert(plot.lines[at] as Line)));
    const first = plot.lines[0];
    if (!this.#other || !first) return [time, ...own];
    const { recording, shift_s } = this.#other;
    const [other_time, values = []] = decimate(recording.time, [recording.column(first.column)], this.#range[0] - shift_s, this.#range[1] - shift_s, parts);
    const other: uPlot.AlignedData = [other_time.map((one) => one + shift_s), scaled(values, convert(first))];
    return uPlot.join([[time, ...own], other]);
  }

  #options(plot: Plot, sync: string): uPlot.Options {
    const colours = palette.get();
    const axis = { stroke: colours.muted, grid: { stroke: colours.grid, width: 1 }, ticks: { stroke: colours.grid, width: 1, size: 4 }, font: `11px ${FONT}` };
    const line = (colour: string, dash: number[] = []): uPlot.Series => ({ stroke: colour, width: 1.4, dash, points: { show: false }, spanGaps: true });
    const minutes = (seconds: number) => `${Math.floor(seconds / 60)}:${String(Math.floor(seconds % 60)).padStart(2, "0")}`;
    return {
      width: this.#width(),
      height: HEIGHT_PX,
      legend: { show: false },
      cursor: { sync: { key: sync }, drag: { x: true, y: false, setScale: false }, points: { show: false } },
      scales: { x: { time: false, range: () => this.#range } },
      axes: [
        { ...axis, size: 22, incrs: [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200], values: (_, ticks) => ticks.map(minutes) },
        { ...axis, size: 46 },
      ],
      series: [{}, ...plot.lines.map((one) => line(colours[one.colour], one.colour === "set" ? [6, 4] : [])), ...(this.#other ? [line(colours.second, [3, 3])] : [])],
      hooks: {
        setSelect: [
          (chart) => {
            if (chart.select.width < 8) return;
            const from = chart.posToVal(chart.select.left, "x");
            const to = chart.posToVal(chart.select.left + chart.select.width, "x");
            chart.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
            this.zoom(from, to);
          },
        ],
        ready: [
          (chart) => {
            chart.over.addEventListener("click", () => {
              const left = chart.cursor.left ?? -1;
              if (left >= 0) this.seek(chart.posToVal(left, "x"));
            });
            chart.over.addEventListener("dblclick", () => this.zoom(this.recording.begin_s, this.recording.end_s));
          },
        ],
      },
    };
  }

  zoom(from_s: number, to_s: number): void {
    this.#range = [Math.max(this.recording.begin_s, from_s), Math.min(this.recording.end_s, to_s)];
    for (const { plot, chart } of this.#plots) chart.setData(this.#data(plot));
    this.#mark();
  }
}
