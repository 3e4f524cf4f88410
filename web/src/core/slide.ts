/**
 * "Slide to confirm": a drag over the whole way, or Enter or Space held for a second.
 * A tap alone does nothing.
 */

import { h, setText } from "./dom";

const HOLD_MS = 1000;
const ENOUGH = 0.92;

export interface Slide {
  element: HTMLElement;
  set(label: string, enabled: boolean, tone: "go" | "stop"): void;
}

export function slide(confirmed: () => void): Slide {
  const thumb = h("span", { class: "slide-thumb", "aria-hidden": "true" }, "»");
  const fill = h("span", { class: "slide-fill", "aria-hidden": "true" });
  const text = h("span", { class: "slide-text" });
  const how = h("span", { class: "visually-hidden" }, "Slide to the right, or hold Enter for one second.");
  const element = h("button", { type: "button", class: "slide", title: "Slide to the right, or hold Enter for one second" }, fill, text, how, thumb);
  let from_x: number | null = null;
  let part = 0;
  let held: number | null = null;
  let enabled = false;

  const show = (now: number) => {
    part = now;
    element.style.setProperty("--part", String(now));
  };
  const way = () => Math.max(1, element.clientWidth - thumb.offsetWidth - 8);
  const end = (fire: boolean) => {
    from_x = null;
    held = null;
    element.classList.remove("held");
    show(0);
    if (fire) confirmed();
  };
  element.addEventListener("pointerdown", (event) => {
    if (!enabled) return;
    from_x = event.clientX;
    element.setPointerCapture(event.pointerId);
    element.classList.add("held");
  });
  element.addEventListener("pointermove", (event) => {
    if (from_x !== null) show(Math.max(0, Math.min(1, (event.clientX - from_x) / way())));
  });
  element.addEventListener("pointerup", () => {
    if (from_x !== null) end(part >= ENOUGH);
  });
  element.addEventListener("pointercancel", () => end(false));

  const progress = (now: number) => {
    if (held === null) return;
    show(Math.min(1, (now - held) / HOLD_MS));
    if (now - held >= HOLD_MS) end(true);
    else requestAnimationFrame(progress);
  };
  element.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    if (!enabled || event.repeat || held !== null) return;
    held = performance.now();
    element.classList.add("held");
    requestAnimationFrame(progress);
  });
  element.addEventListener("keyup", () => {
    if (held !== null) end(false);
  });
  element.addEventListener("blur", () => {
    if (held !== null) end(false);
  });
  return {
    element,
    set(label, on, tone) {
      setText(text, label);
      enabled = on;
      if (!on && (from_x ?? held) !== null) end(false);
      // It keeps the focus, which a disabled button loses.
      element.setAttribute("aria-disabled", String(!on));
      element.dataset["tone"] = tone;
    },
  };
}
