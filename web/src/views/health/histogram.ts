/** How late the loop's ticks are: bins of half a decade, the counts on a logarithm. */

import { Drawing } from "../../core/canvas";
import { h } from "../../core/dom";
import { FONT, type Palette } from "../../design/theme";

/** Upper ends of the bins (proto/layout.md); the last counts what is above. */
const LABELS = ["0.1", "0.3", "1", "3", "10", "32", "100", "316", "1 ms", "3", "10", "32", "100", ">"];
/** From here on a tick is late for a loop of 1 kHz. */
const LATE_BIN = 8;
/** Narrower bins have every second label. */
const NARROW_PX = 28;
const BOTTOM_PX = 30, TOP_PX = 16;

export class Histogram extends Drawing {
  #counts: number[] | null = null;
  #seen = "";

  constructor() {
    super(h("canvas", { class: "histogram", role: "img", "aria-label": "Lateness: no data" }));
  }

  show(counts: number[] | null): void {
    const seen = counts?.join() ?? "";
    if (seen === this.#seen) return;
    this.#seen = seen;
    this.#counts = counts ? [...counts] : null;
    const total = counts?.reduce((sum, one) => sum + one, 0) ?? 0;
    this.canvas.setAttribute("aria-label", `Lateness of ${total} ticks: ${(counts ?? []).map((one, at) => `${one} up to ${LABELS[at] ?? ""}`).filter((_, at) => (counts?.[at] ?? 0) > 0).join(", ")} µs`);
    this.again();
  }

  protected draw(context: CanvasRenderingContext2D, width: number, height: number, colours: Palette): void {
    const counts = this.#counts ?? [];
    const most = Math.max(10, ...counts);
    const step = width / LABELS.length;
    const tall = height - BOTTOM_PX - TOP_PX;
    const y = (count: number) => TOP_PX + tall * (1 - Math.log10(count + 1) / Math.log10(most + 1));
    context.font = `11px ${FONT}`;
    context.textAlign = "center";
    context.strokeStyle = colours.grid;
    for (let power = 1; 10 ** power <= most; power += 1) {
      context.beginPath();
      context.moveTo(0, y(10 ** power));
      context.lineTo(width, y(10 ** power));
      context.stroke();
    }
    LABELS.forEach((label, at) => {
      const count = counts[at] ?? 0;
      const x = at * step;
      context.fillStyle = at >= LATE_BIN ? colours.warning : at >= 6 ? colours.caution : colours.accent;
      if (count > 0) context.fillRect(x + 3, y(count), step - 6, height - BOTTOM_PX - y(count));
      context.fillStyle = colours.muted;
      if (step > NARROW_PX || at % 2 === 0) context.fillText(label, x + step / 2, height - BOTTOM_PX + 13);
      if (count > 0) {
        context.fillStyle = colours.text;
        context.fillText(count >= 10_000 ? `${(count / 1000).toFixed(0)}k` : String(count), x + step / 2, y(count) - 4);
      }
    });
    context.fillStyle = colours.muted;
    context.textAlign = "left";
    context.fillText(step > NARROW_PX ? "Late by at most, µs; from 1 ms in ms. Counts are on a logarithm." : "µs; from 1 ms in ms", 2, height - 3);
    context.strokeStyle = colours.line;
    context.beginPath();
    context.moveTo(0, height - BOTTOM_PX + 0.5);
    context.lineTo(width, height - BOTTOM_PX + 0.5);
    context.stroke();
  }
}
