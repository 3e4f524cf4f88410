/** The guided calibration of a sensor, which `fccd calibrate` leads on the board. */

import { getJson, message, postJson, request, writable, type Status } from "../../core/api";
import { button, h, replace, setText } from "../../core/dom";

type Course = { kind: string; percent: number; now: string; lines: string[]; found: string; exit_code: number | null };

const KINDS = ["accelerometer", "gyroscope", "mounting", "magnetometer", "airspeed"];
const ASKED_EVERY_MS = 500;

export class CalibrationPanel {
  readonly #whose = h("select", { "aria-label": "Daemon" });
  readonly #kind = h("select", { "aria-label": "Kind" }, ...KINDS.map((kind) => h("option", {}, kind)));
  readonly #begin = button("Begin", () => void this.#change(() => postJson("/calibration", { instance: this.#whose.value, kind: this.#kind.value })), { class: "button small" });
  readonly #end = button("End", () => void this.#change(() => request("DELETE", "/calibration")), { class: "button small" });
  readonly #bar = h("progress", { max: 100, "aria-label": "Progress of the calibration" });
  readonly #now = h("p", { class: "calibrate-now", role: "status" });
  readonly #said = h("pre", { class: "note mono" });
  readonly element = h("div", { class: "calibrate" }, h("div", { class: "row" }, this.#whose, this.#kind, this.#begin, this.#end), this.#bar, this.#now, this.#said);
  #timer: ReturnType<typeof setInterval> | undefined;

  constructor() {
    void this.#ask();
    void getJson<Status>("/status").then(({ configured }) => replace(this.#whose, ...configured.map((name) => h("option", {}, name))), () => undefined);
  }

  async #change(change: () => Promise<unknown>): Promise<void> {
    try {
      await change();
      await this.#ask();
    } catch (error) {
      setText(this.#now, message(error));
    }
  }

  async #ask(): Promise<void> {
    // What does not answer is asked again.
    await getJson<Course>("/calibration").then((course) => this.#show(course), () => undefined);
  }

  #show({ kind, percent, now, lines, found, exit_code }: Course): void {
    const runs = kind !== "" && exit_code === null;
    this.#begin.disabled = runs || !writable.get();
    this.#end.disabled = !runs || !writable.get();
    this.#bar.value = exit_code === 0 ? 100 : percent;
    setText(this.#now, runs ? now || (lines.at(-1) ?? "It begins.") : exit_code === null ? "Stop the daemon, and begin: what to do is said here." : exit_code === 0 ? `The ${kind} is calibrated.` : (lines.at(-1) ?? "It has ended."));
    setText(this.#said, exit_code === 0 ? found : "");
    clearInterval(this.#timer);
    if (runs) this.#timer = setInterval(() => void this.#ask(), ASKED_EVERY_MS);
  }

  close = (): void => clearInterval(this.#timer);
}
