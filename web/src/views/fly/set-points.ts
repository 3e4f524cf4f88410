/** Set points beside actual values; edited in hold mode. */

import type { Daemon, SetPoint } from "../../core/api";
import { h, replace, setClass, setText } from "../../core/dom";
import { digitsOf, shown, toShown, toSi, unitOf, type Quantity } from "../../core/units";
import { freshness, type FlightState } from "../../live/flight-state";

interface Line {
  label: string;
  /** The command's names of the set point, the first that the daemon has; none: it cannot be set. */
  names: readonly string[];
  quantity: Quantity;
  actual: (state: FlightState) => number;
  set: (state: FlightState) => number;
  age: (state: FlightState) => number;
}

const LINES: readonly Line[] = [
  { label: "Airspeed", names: ["airspeed_mps"], quantity: "speed", actual: (s) => s.airspeed_mps, set: (s) => s.set.airspeed_mps, age: (s) => s.ages.airspeed },
  { label: "Heading (mag)", names: ["heading_rad"], quantity: "heading", actual: (s) => s.heading_rad, set: (s) => s.set.heading_rad, age: (s) => s.ages.heading },
  { label: "Altitude (pressure)", names: ["pressure_altitude_m", "altitude_m"], quantity: "altitude", actual: (s) => s.altitude_m, set: (s) => s.set.altitude_m, age: (s) => s.ages.altitude },
  { label: "Climb rate", names: [], quantity: "climb", actual: (s) => s.climb_mps, set: (s) => s.set.climb_mps, age: (s) => s.ages.altitude },
  { label: "Bank", names: [], quantity: "angle", actual: (s) => s.roll_rad, set: (s) => s.set.roll_rad, age: (s) => s.ages.attitude },
  { label: "Pitch", names: [], quantity: "angle", actual: (s) => s.pitch_rad, set: (s) => s.set.pitch_rad, age: (s) => s.ages.attitude },
];

interface Cells {
  line: Line;
  actual: HTMLElement;
  set: HTMLElement;
  unit: HTMLElement;
  input: HTMLInputElement | null;
  limits: SetPoint | undefined;
}

export class SetPoints {
  readonly element = h("section", { class: "panel set-points", "aria-label": "Set points" });
  readonly #note = h("p", { class: "note" });
  readonly #send: HTMLButtonElement;
  #rows: Cells[] = [];
  #editable = false;

  constructor(private readonly apply: (values: Record<string, number>) => void) {
    this.#send = h("button", { type: "submit", class: "button primary" }, "Set");
    this.build(null);
  }

  build(daemon: Daemon | null): void {
    const body = h("tbody", {});
    this.#rows = LINES.map((line) => {
      const limits = line.names.map((name) => daemon?.setpoints.find((one) => one.name === name)).find((one) => one);
      const cells: Cells = {
        line, limits, actual: h("td", { class: "number" }), set: h("td", { class: "number set" }), unit: h("td", { class: "unit" }), input: null,
      };
      if (limits) {
        cells.input = h("input", { type: "number", class: "number", "aria-label": `New ${line.label.toLowerCase()}`, step: "any", inputmode: "decimal" });
      }
      body.append(h("tr", {}, h("th", { scope: "row" }, line.label), cells.actual, cells.set, cells.unit, h("td", { class: "edit" }, cells.input)));
      return cells;
    });
    const table = h(
      "table",
      { class: "values" },
      h("thead", {}, h("tr", {}, ...["", "Actual", "Set", "Unit", "New"].map((text) => h("th", { scope: "col" }, text || h("span", { class: "visually-hidden" }, "Quantity"))))),
      body,
    );
    const form = h("form", { submit: (event: Event) => { event.preventDefault(); this.#submit(); } }, table, h("div", { class: "row end" }, this.#note, this.#send));
    replace(this.element, h("h2", {}, "Set points"), form);
    this.setEditable(this.#editable, "");
  }

  /** The reason is why they are not, or what a change ends. */
  setEditable(editable: boolean, reason: string): void {
    this.#editable = editable;
    setClass(this.element, "editable", editable);
    setText(this.#note, reason);
    this.#send.disabled = !editable;
    for (const { input } of this.#rows) if (input) input.disabled = !editable;
  }

  show(state: FlightState | null): void {
    for (const { line, actual, set, unit, input } of this.#rows) {
      setText(unit, unitOf(line.quantity));
      setText(actual, state ? shown(line.quantity, line.actual(state)) : "–");
      const wanted = state ? line.set(state) : NaN;
      setText(set, shown(line.quantity, wanted));
      const fresh = freshness(state ? line.age(state) : Infinity);
      for (const cell of [actual, set]) cell.dataset["fresh"] = fresh;
      if (input && input.placeholder !== shown(line.quantity, wanted)) input.placeholder = shown(line.quantity, wanted);
    }
  }

  #submit(): void {
    const values: Record<string, number> = {};
    for (const { line, input, limits } of this.#rows) {
      if (!input || input.value === "" || !limits) continue;
      const si = toSi(line.quantity, Number(input.value));
      const value = line.quantity === "heading" ? ((si % (2 * Math.PI)) + 2 * Math.PI) % (2 * Math.PI) : si;
      if (value < limits.lowest - 1e-6 || value > limits.highest + 1e-6) {
        const text = (one: number) => toShown(line.quantity, one).toFixed(digitsOf(line.quantity));
        input.setCustomValidity(`Choose ${text(limits.lowest)} to ${text(limits.highest)} ${unitOf(line.quantity)}.`);
        input.reportValidity();
        input.setCustomValidity("");
        return;
      }
      values[limits.name] = value;
    }
    if (Object.keys(values).length === 0) return;
    this.apply(values);
    for (const { input } of this.#rows) if (input) input.value = "";
  }
}
