/** Events, newest first. Their texts are data. */

import type { FlightEvent } from "../core/api";
import { h, setText } from "../core/dom";
import { duration, inUnits, unitSystem } from "../core/units";

const SHOWN = 200;

/** What kinds of events ask for attention, by their codes (proto/layout.md). */
const BAD = new Set([4, 6, 8, 9, 10, 12, 13, 14, 16, 24, 26]);
const REMARK = new Set([3, 17, 19, 21, 22, 23]);

export const eventTone = (code: number): "bad" | "remark" | "plain" =>
  BAD.has(code) ? "bad" : REMARK.has(code) ? "remark" : "plain";

export function eventItem(event: FlightEvent): HTMLElement {
  return h(
    "li",
    { "data-tone": eventTone(event.code) },
    h("span", { class: "event-time" }, duration(event.time_s)),
    h("span", { class: "event-text", "data-text": event.text }, inUnits(event.text)),
  );
}

unitSystem.watch(() => {
  for (const one of document.querySelectorAll<HTMLElement>(".event-text")) setText(one, inUnits(one.dataset["text"] ?? ""));
});

export class EventList {
  readonly #list = h("ol", {});
  readonly element = h("div", { class: "events", role: "log", "aria-live": "polite", "aria-label": "Events", tabindex: 0 }, this.#list);

  add(event: FlightEvent | null): void {
    if (event === null) {
      this.#list.replaceChildren();
      return;
    }
    this.#list.prepend(eventItem(event));
    while (this.#list.childElementCount > SHOWN) this.#list.lastElementChild?.remove();
  }
}
