/** The time line: play, pause, scrub; modes as bands, events as marks. */

import { button, h, icon, replace, setText } from "../../core/dom";
import { onNextFrame } from "../../core/frame";
import { duration } from "../../core/units";
import { palette } from "../../design/theme";
import { eventTone } from "../event-list";
import type { Recording } from "./recording";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 25, 50, 100];
const SKIP_S = 10;
/** As often as live data come. */
const DRAWN_EVERY_MS = 25;

/** Bands of modes, by their number in the record, so that each has a colour of its own. */
const MODE_HUES = [0, 45, 90, 290, 200, 170, 20, 140, 110, 60, 0];

export class Timeline {
  readonly element = h("section", { class: "timeline", "aria-label": "Time line" });
  readonly #slider: HTMLInputElement;
  readonly #canvas = h("canvas", { class: "timeline-canvas", "aria-hidden": "true" });
  readonly #time = h("output", { class: "timeline-time" });
  readonly #play = button("Play", () => this.toggle(), { icon: "play", bare: true, class: "button primary" });
  #time_s: number;
  #speed = 1;
  #playing = false;
  #last = 0;
  #closed = false;
  readonly #step = (now: number) => this.#advance(now);
  readonly #observer = new ResizeObserver(() => this.#draw());
  readonly #stop: () => void;

  constructor(
    private readonly recording: Recording,
    private readonly moved: (time_s: number, playing: boolean) => void,
  ) {
    this.#time_s = recording.begin_s;
    this.#slider = h("input", { type: "range", min: recording.begin_s, max: recording.end_s, step: Math.max(0.05, (recording.end_s - recording.begin_s) / 2000), value: recording.begin_s, "aria-label": "Time of the flight" });
    this.#slider.addEventListener("input", () => this.seek(Number(this.#slider.value)));
    const speed = h("select", { "aria-label": "Speed of the replay" }, ...SPEEDS.map((one) => h("option", { value: one }, `${one}×`)));
    speed.value = "1";
    speed.addEventListener("change", () => (this.#speed = Number(speed.value)));
    this.element.append(
      h("div", { class: "row transport" }, button(`Back ${SKIP_S} s`, () => this.seek(this.#time_s - SKIP_S), { icon: "undo", bare: true }), this.#play, button(`Forward ${SKIP_S} s`, () => this.seek(this.#time_s + SKIP_S), { icon: "redo", bare: true }), speed, this.#time),
      h("div", { class: "timeline-bar" }, this.#canvas, this.#slider),
    );
    this.#observer.observe(this.#canvas);
    this.#stop = palette.watch(() => this.#draw());
    this.#show();
  }

  close(): void {
    this.#closed = true;
    this.#playing = false;
    this.#observer.disconnect();
    this.#stop();
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
    if (!this.#playing || this.#closed) return;
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

  #draw(): void {
    const width = this.#canvas.clientWidth, height = this.#canvas.clientHeight;
    if (width === 0) return;
    const ratio = Math.min(2, devicePixelRatio || 1);
    this.#canvas.width = width * ratio;
    this.#canvas.height = height * ratio;
    const context = this.#canvas.getContext("2d");
    if (!context) return;
    context.scale(ratio, ratio);
    const colours = palette.get();
    const span = this.recording.end_s - this.recording.begin_s || 1;
    const x = (time_s: number) => ((time_s - this.recording.begin_s) / span) * width;
    const modes = this.recording.column("desired_guidance_mode");
    const { time } = this.recording;
    let from = 0;
    for (let at = 1; at <= modes.length; at += 1) {
      if (at < modes.length && modes[at] === modes[from]) continue;
      const mode = modes[from] ?? 0;
      context.fillStyle = mode === 0 ? colours.line : `hsl(${MODE_HUES[mode] ?? 0} 45% 50%)`;
      const begin = x(time[from] ?? 0);
      const end = x(time[Math.min(at, modes.length - 1)] ?? 0);
      context.fillRect(begin, height - 12, Math.max(1, end - begin - 0.5), 8);
      from = at;
    }
    for (const event of this.recording.events) {
      const tone = eventTone(event.code);
      context.fillStyle = tone === "bad" ? colours.warning : tone === "remark" ? colours.caution : colours.muted;
      context.fillRect(x(event.time_s) - 0.75, 0, 1.5, tone === "plain" ? 7 : 11);
    }
  }
}
