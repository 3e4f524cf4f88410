/** Readings: how old, from which sensor, and how far from the estimate. */

import { h, replace, setText } from "../../core/dom";
import { DEGREES, fixed } from "../../core/units";
import { freshness } from "../../live/flight-state";
import type { LiveRecord } from "../../live/record";

const EARTH_M = 6_371_008.8;

const difference = (record: LiveRecord, measured: string, estimated: string): number => record.number(measured) - record.number(estimated);
const turned = (radians: number): number => Math.atan2(Math.sin(radians), Math.cos(radians)) * DEGREES;

/** Measured minus estimated. */
const RESIDUALS: Record<string, (record: LiveRecord) => string> = {
  attitude: (r) => `${fixed(difference(r, "roll_rad", "estimated_roll_rad") * DEGREES, 2)}° roll, ${fixed(difference(r, "pitch_rad", "estimated_pitch_rad") * DEGREES, 2)}° pitch`,
  heading: (r) => `${fixed(turned(difference(r, "heading_rad", "estimated_heading_rad")), 2)}°`,
  airspeed: (r) => `${fixed(difference(r, "airspeed_mps", "estimated_airspeed_mps"), 2)} m/s`,
  altitude: (r) => `${fixed(difference(r, "altitude_m", "estimated_altitude_m"), 2)} m`,
  position: (r) => metres(r, "latitude_rad", "longitude_rad"),
  gnss: (r) => metres(r, "gnss_latitude_rad", "gnss_longitude_rad"),
};

function metres(record: LiveRecord, latitude: string, longitude: string): string {
  const north = difference(record, latitude, "estimated_latitude_rad") * EARTH_M;
  const east = difference(record, longitude, "estimated_longitude_rad") * EARTH_M * Math.cos(record.number("estimated_latitude_rad"));
  return `${fixed(Math.hypot(north, east), 1)} m`;
}

const TAKEN = "_taken_ns";

export class SensorTable {
  readonly element = h("div", { class: "scroll sensors", tabindex: 0, role: "region", "aria-label": "Readings of the sensors" });
  #columns: unknown = null;
  #rows: { name: string; row: HTMLElement; age: HTMLElement; source: HTMLElement; residual: HTMLElement }[] = [];

  show(record: LiveRecord | null, link_age_s: number): void {
    if (!record) {
      if (this.#columns !== null || this.element.childElementCount === 0) replace(this.element, h("p", { class: "note" }, "No record has arrived."));
      this.#columns = null;
      return;
    }
    if (record.layout !== this.#columns) this.#build(record);
    for (const { name, row, age, source, residual } of this.#rows) {
      const taken = record.number(`${name}${TAKEN}`);
      const known = Number.isFinite(taken);
      row.classList.toggle("never", !known);
      const age_s = known ? (record.number("woke_ns") - taken) / 1e9 + link_age_s : NaN;
      setText(age, known ? `${fixed(Math.max(0, age_s) * 1000, 0)}` : "never");
      row.dataset["fresh"] = known ? freshness(age_s) : "fresh";
      setText(source, known && record.layout.indexOf(`${name}_source`) >= 0 ? String(record.number(`${name}_source`) + 1) : "–");
      setText(residual, known ? (RESIDUALS[name]?.(record) ?? "") : "");
    }
  }

  #build(record: LiveRecord): void {
    this.#columns = record.layout;
    const names = record.layout.columns.map((one) => one.name).filter((name) => name.endsWith(TAKEN)).map((name) => name.slice(0, -TAKEN.length));
    // What never gave a reading is listed last.
    const known = (name: string) => (Number.isFinite(record.number(`${name}${TAKEN}`)) ? 0 : 1);
    names.sort((a, b) => known(a) - known(b));
    this.#rows = names.map((name) => {
      const cells = { age: h("td", { class: "number" }), source: h("td", { class: "number" }), residual: h("td", { class: "number" }) };
      return { name, ...cells, row: h("tr", {}, h("th", { scope: "row" }, name.replaceAll("_", " ")), cells.age, cells.source, cells.residual) };
    });
    replace(
      this.element,
      h("table", {}, h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Reading"), h("th", { scope: "col", class: "number" }, "Age ms"), h("th", { scope: "col", class: "number" }, "Sensor"), h("th", { scope: "col", class: "number" }, "Measured − estimated"))), h("tbody", {}, ...this.#rows.map((one) => one.row))),
    );
  }
}
