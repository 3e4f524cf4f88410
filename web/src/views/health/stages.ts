/** How long the stages of a tick take, and what is left of the period. */

import { h, setText } from "../../core/dom";
import { fixed, microseconds } from "../../core/units";
import type { LiveRecord } from "../../live/record";

const STAGES = ["sensors", "estimate", "guide", "control", "actuators", "total"] as const;
/** The largest of the last seconds decays, so that a peak is seen and passes. */
const DECAY = 0.995;

export class StageBars {
  readonly element = h("table", { class: "stages" });
  readonly #rows = STAGES.map((stage) => ({ stage, bar: h("div", { class: "bar" }), now: h("td", { class: "number" }), most: h("td", { class: "number" }), largest: 0 }));
  readonly #budget = h("caption", {});

  constructor() {
    this.element.append(
      this.#budget,
      h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Stage"), h("th", { scope: "col" }, h("span", { class: "visually-hidden" }, "Bar")), h("th", { scope: "col", class: "number" }, "Now"), h("th", { scope: "col", class: "number" }, "Recent most"))),
      h("tbody", {}, ...this.#rows.map((row) => h("tr", {}, h("th", { scope: "row" }, row.stage), h("td", { class: "bar-cell" }, row.bar), row.now, row.most))),
    );
  }

  show(record: LiveRecord | null, rate_hz: number): void {
    const total = this.#rows.at(-1);
    for (const row of this.#rows) {
      const us = (record?.number(`${row.stage}_time_ns`) ?? NaN) / 1000;
      row.largest = Number.isFinite(us) ? Math.max(us, row.largest * DECAY) : row.largest;
      setText(row.now, microseconds(us, 1));
      setText(row.most, microseconds(row.largest, 1));
    }
    for (const row of this.#rows) {
      const us = (record?.number(`${row.stage}_time_ns`) ?? NaN) / 1000;
      const part = total && total.largest > 0 && Number.isFinite(us) ? us / total.largest : 0;
      row.bar.style.transform = `scaleX(${Math.min(1, part).toFixed(3)})`;
    }
    const period_us = rate_hz > 0 ? 1e6 / rate_hz : NaN;
    const used = total ? (total.largest / period_us) * 100 : NaN;
    setText(this.#budget, Number.isFinite(used) ? `A period is ${microseconds(period_us, 0)}; a tick uses ${fixed(used, 2)} % of it at most.` : "");
  }
}
