/** The primary flight display: horizon, tapes and heading on one canvas. */

import type { Daemon } from "../core/api";
import { h } from "../core/dom";
import { onNextFrame, notOnNextFrame } from "../core/frame";
import { shown, toShown, unitOf, unitSystem, withUnit } from "../core/units";
import { instrumentPalette, palette, FONT, type Palette } from "../design/theme";
import { freshness, type FlightState, type Freshness } from "../live/flight-state";
import { drawAttitude, type Box } from "./attitude";
import { drawHeading } from "./heading";
import { drawTape } from "./tape";

const TAPE_PX = 72;
const HEADING_PX = 50;
/** The text for screen readers changes slowly: it is no stream. */
const DESCRIBED_EVERY_MS = 2000;
const MOVING_MPS = 3;

export class FlightDisplay {
  readonly element: HTMLElement;
  readonly #canvas = h("canvas", { class: "pfd-canvas", role: "img", "aria-label": "Flight display: no data" });
  #state: FlightState | null = null;
  #aircraft: Daemon["aircraft"] = null;
  #colours: Palette = palette.get();
  #described = 0;
  #width = 0;
  #height = 0;
  readonly #draw = () => this.draw();
  readonly #observer = new ResizeObserver(() => {
    this.#width = this.#canvas.clientWidth;
    this.#height = this.#canvas.clientHeight;
    onNextFrame(this.#draw);
  });
  readonly #stops: (() => void)[];

  constructor() {
    this.element = h("div", { class: "pfd" }, this.#canvas);
    this.#observer.observe(this.#canvas);
    const again = () => onNextFrame(this.#draw);
    this.#stops = [
      palette.watch(() => {
        this.#colours = instrumentPalette();
        again();
      }),
      unitSystem.watch(again),
    ];
  }

  setLimits(aircraft: Daemon["aircraft"]): void {
    this.#aircraft = aircraft;
    onNextFrame(this.#draw);
  }

  show(state: FlightState | null): void {
    this.#state = state;
    onNextFrame(this.#draw);
  }

  close(): void {
    this.#observer.disconnect();
    notOnNextFrame(this.#draw);
    for (const stop of this.#stops) stop();
  }

  draw(): void {
    const width = this.#width;
    const height = this.#height;
    if (width === 0 || height === 0) return;
    const ratio = Math.min(2, devicePixelRatio || 1);
    if (this.#canvas.width !== Math.round(width * ratio) || this.#canvas.height !== Math.round(height * ratio)) {
      this.#canvas.width = Math.round(width * ratio);
      this.#canvas.height = Math.round(height * ratio);
    }
    const context = this.#canvas.getContext("2d");
    if (!context) return;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const colours = this.#colours;
    const state = this.#state;
    const body = height - HEADING_PX;
    const speed: Box = { x: 0, y: 0, width: TAPE_PX, height: body };
    const altitude: Box = { x: width - TAPE_PX, y: 0, width: TAPE_PX, height: body };
    const attitude: Box = { x: TAPE_PX, y: 0, width: width - 2 * TAPE_PX, height: body };
    const heading: Box = { x: 0, y: body, width, height: HEADING_PX };
    if (!state) {
      context.fillStyle = colours.instrument;
      context.fillRect(0, 0, width, height);
      for (const box of [speed, altitude, attitude, heading]) cross(context, box, "lost", colours.caution);
      return;
    }
    drawAttitude(
      context,
      attitude,
      { pitch_rad: state.pitch_rad, roll_rad: state.roll_rad, side_force_mps2: state.side_force_mps2, set_pitch_rad: state.set.pitch_rad, set_roll_rad: state.set.roll_rad },
      colours,
    );
    const limit = (mps: number | null | undefined) => (typeof mps === "number" ? toShown("speed", mps) : undefined);
    const aircraft = this.#aircraft;
    drawTape(context, speed, {
      value: toShown("speed", state.airspeed_mps), set: toShown("speed", state.set.airspeed_mps), step: unitSystem.get() === "aviation" ? 5 : 2,
      numbered: unitSystem.get() === "aviation" ? 10 : 4, span: unitSystem.get() === "aviation" ? 70 : 30, digits: unitSystem.get() === "aviation" ? 0 : 1,
      unit: unitOf("speed"), title: "IAS", side: "left",
      limits: { lowest: limit(aircraft?.stall_mps), low: limit(aircraft?.min_mps), high: limit(aircraft?.max_mps), highest: limit(aircraft?.never_exceed_mps ?? aircraft?.max_mps) },
    }, colours);
    drawTape(context, altitude, {
      value: toShown("altitude", state.altitude_m), set: toShown("altitude", state.set.altitude_m), step: unitSystem.get() === "aviation" ? 20 : 10,
      numbered: unitSystem.get() === "aviation" ? 100 : 50, span: unitSystem.get() === "aviation" ? 500 : 200, digits: 0,
      unit: unitOf("altitude"), title: "ALT", side: "right", limits: {},
    }, colours);
    climb(context, altitude, state.climb_mps, colours["instrument-text"], colours.accent);
    drawHeading(context, heading, {
      heading_rad: state.heading_rad, set_rad: state.set.heading_rad, course_rad: state.ground_speed_mps > MOVING_MPS ? state.course_rad : NaN,
      wind_from_rad: state.wind_from_rad, wind_mps: state.wind_mps,
    }, colours);
    context.strokeStyle = colours.line;
    context.lineWidth = 1;
    context.strokeRect(TAPE_PX - 0.5, 0, width - 2 * TAPE_PX + 1, body);
    for (const [box, age] of [[speed, state.ages.airspeed], [altitude, state.ages.altitude], [attitude, state.ages.attitude], [heading, state.ages.heading]] as const)
      cross(context, box, freshness(age), colours.caution);
    this.#describe(state);
  }

  #describe(state: FlightState): void {
    const now = performance.now();
    if (now - this.#described < DESCRIBED_EVERY_MS) return;
    this.#described = now;
    const text =
      `Flight display: airspeed ${withUnit("speed", state.airspeed_mps)}, altitude ${withUnit("altitude", state.altitude_m)}, ` +
      `heading ${shown("heading", state.heading_rad)}°, pitch ${withUnit("angle", state.pitch_rad)}, bank ${withUnit("angle", state.roll_rad)}`;
    this.#canvas.setAttribute("aria-label", text);
  }
}

/** A bar beside the altitude: 5 m/s over a third of the height. */
function climb(context: CanvasRenderingContext2D, box: Box, climb_mps: number, text: string, colour: string): void {
  if (!Number.isFinite(climb_mps)) return;
  const middle = box.y + box.height / 2;
  const end = middle - Math.max(-1, Math.min(1, climb_mps / 7.5)) * (box.height / 2 - 24);
  context.strokeStyle = colour;
  context.lineWidth = 3;
  context.beginPath();
  context.moveTo(box.x + box.width - 1.5, middle);
  context.lineTo(box.x + box.width - 1.5, end);
  context.stroke();
  context.fillStyle = "#05090d";
  context.fillRect(box.x, box.y + box.height - 18, box.width, 18);
  context.fillStyle = text;
  context.font = `600 11px ${FONT}`;
  context.textAlign = "center";
  context.fillText(`${climb_mps > 0.05 ? "+" : ""}${shown("climb", climb_mps)} ${unitOf("climb")}`, box.x + box.width / 2, box.y + box.height - 8.5);
}

/** Old values are greyed, lost ones crossed out. */
function cross(context: CanvasRenderingContext2D, box: Box, fresh: Freshness, colour: string): void {
  if (fresh === "fresh") return;
  context.fillStyle = fresh === "stale" ? "rgb(70 78 86 / 55%)" : "rgb(30 36 42 / 78%)";
  context.fillRect(box.x, box.y, box.width, box.height);
  if (fresh === "stale") return;
  context.strokeStyle = colour;
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(box.x + 4, box.y + 4);
  context.lineTo(box.x + box.width - 4, box.y + box.height - 4);
  context.moveTo(box.x + box.width - 4, box.y + 4);
  context.lineTo(box.x + 4, box.y + box.height - 4);
  context.stroke();
}
