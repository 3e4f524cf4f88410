/** The time line: play, pause, scrub; modes as bands, events as marks. */

import { Drawing } from "../../core/canvas";
import { button, h, icon, replace, setText } from "../../core/dom";
import { onNextFrame } from "../../core/frame";
import { duration } from "../../core/units";
import { FONT, type Palette } from "../../design/theme";
import { modeText } from "../../live/flight-state";
import { eventTone } from "../event-list";
import type { Recording, Run } from "./recording";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 25, 50, 100];
const SKIP_S = 10;
/** As often as live data come. */
const DRAWN_EVERY_MS = 25;

/** Bands of modes, by their number in the record, which is beside the colour. */
const MODE_HUES = [0, 45, 90, 290, 200, 170, 20, 140, 110, 60, 0];
const colourOf = (mode: number, none: string): string => (mode === 0 ? none : `hsl(${MODE_HUES[mode] ?? 0} 45% 60%)`);
/** Narrower bands have no number. */
const NUMBERED_PX = 12;
const BAND_PX = 14;

export class Timeline extends Drawing {
  readonly element = h("section", { class: "timeline", "aria-label": "Time line" });
  readonly #slider: HTMLInputElement;
  readonly #time = h("output", { class: "timeline-time" });
  readonly #play = button("Play", () => this.toggle(), { icon: "play", bare: true, class: "button primary" });
  #time_s: number;
  #speed = 1;
  #playing = false;
  #last = 0;
  readonly #step = (now: number) => this.#advance(now);
  readonly #modes: Run[];

  constructor(
    private readonly recording: Recording,
    private readonly moved: (time_s: number, playing: boolean) => void,
  ) {
    super(h("canvas", { class: "timeline-canvas", "aria-hidden": "true" }));
    this.#time_s = recording.begin_s;
    this.#modes = recording.runs("desired_guidance_mode");
    const modes = new Map(this.#modes.map(({ value, name }) => [value, name]));
    const legend = [...modes].sort(([a], [b]) => a - b).map(([mode, name]) => {
      const key = h("span", { class: "mode-key" }, mode || "");
      key.style.background = colourOf(mode, "var(--line)");
      return h("li", {}, key, mode === 0 ? "no mode" : modeText(name, 0));
    });
    this.#slider = h("input", { type: "range", min: recording.begin_s, max: recording.end_s, step: Math.max(0.05, (recording.end_s - recording.begin_s) / 2000), value: recording.begin_s, "aria-label": "Time of the flight" });
    this.#slider.addEventListener("input", () => this.seek(Number(this.#slider.value)));
    const speed = h("select", { "aria-label": "Speed of the replay" }, ...SPEEDS.map((one) => h("option", { value: one }, `${one}×`)));
    speed.value = "1";
    speed.addEventListener("change", () => (this.#speed = Number(speed.value)));
    this.element.append(
      h("div", { class: "row transport" }, button(`Back ${SKIP_S} s`, () => this.seek(this.#time_s - SKIP_S), { icon: "undo", bare: true }), this.#play, button(`Forward ${SKIP_S} s`, () => this.seek(this.#time_s + SKIP_S), { icon: "redo", bare: true }), speed, this.#time),
      h("div", { class: "timeline-bar" }, this.canvas, this.#slider),
      h("ul", { class: "timeline-legend", "aria-label": "Modes on the time line" }, ...legend),
    );
    this.#show();
  }

  override close(): void {
    super.close();
    this.#playing = false;
  }

  toggle(): void {
    this.#playing = !this.#playing;
    if (this.#playing && this.#time_s >= this.recording.end_s) this.#time_s = this.recording.begin_s;
    replace(this.#play, icon(this.#playing ? "pause" : "play"));
    this.#play.setAttribute("aria-label", this.#playing ? "Pause" : "Play");
    this.#last = performance.now();
    if (this.#playing) onNextFrame(this.#step);
    else this.#show();
  }

  seek(time_s: number): void {
    this.#time_s = Math.min(this.recording.end_s, Math.max(this.recording.begin_s, time_s));
    this.#show();
  }

  #advance(now: number): void {
    if (!this.#playing) return;
    const due = Math.floor(now / DRAWN_EVERY_MS) > Math.floor(this.#last / DRAWN_EVERY_MS);
    this.#time_s += (Math.min(250, Math.max(0, now - this.#last)) / 1000) * this.#speed;
    this.#last = now;
    if (this.#time_s >= this.recording.end_s) {
      this.#time_s = this.recording.end_s;
      this.toggle();
      return;
    }
    if (due) this.#show();
    onNextFrame(this.#step);
  }

  #show(): void {
    this.#slider.value = String(this.#time_s);
    const since = this.#time_s - this.recording.begin_s;
    const text = `${duration(since)} of ${duration(this.recording.end_s - this.recording.begin_s)}`;
    if (this.#time.textContent !== text) this.#slider.setAttribute("aria-valuetext", text);
    setText(this.#time, text);
    this.moved(this.#time_s, this.#playing);
  }

  protected draw(context: CanvasRenderingContext2D, width: number, height: number, colours: Palette): void {
    const span = this.recording.end_s - this.recording.begin_s || 1;
    const x = (time_s: number) => ((time_s - this.recording.begin_s) / span) * width;
    context.font = `600 11px ${FONT}`;
    context.textAlign = "center";
    for (const { value, from_s, to_s } of this.#modes) {
      const begin = x(from_s), wide = Math.max(1, x(to_s) - begin - 0.5);
      context.fillStyle = colourOf(value, colours.line);
      context.fillRect(begin, height - BAND_PX - 2, wide, BAND_PX);
      context.fillStyle = "#000";
      if (value > 0 && wide > NUMBERED_PX) context.fillText(String(value), begin + wide / 2, height - 5);
    }
    for (const event of this.recording.events) {
      const tone = eventTone(event.code);
      context.fillStyle = tone === "bad" ? colours.warning : tone === "remark" ? colours.caution : colours.muted;
      context.fillRect(x(event.time_s) - 0.75, 0, 1.5, tone === "plain" ? 7 : 11);
    }
  }
}
