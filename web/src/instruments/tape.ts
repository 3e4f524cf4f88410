/** Tapes: a scale that moves behind a pointer, with a set point and limits. */

import { fixed } from "../core/units";
import { FONT, type Palette } from "../design/theme";
import type { Box } from "./attitude";

export interface TapeLimits {
  /** Below: warning. */
  lowest?: number | undefined;
  /** From the lowest to this: caution. */
  low?: number | undefined;
  /** From this to the highest: caution. */
  high?: number | undefined;
  /** Above: warning. */
  highest?: number | undefined;
}

export interface Tape {
  value: number;
  set: number;
  /** From one mark to the next, and to the next with a number. */
  step: number;
  numbered: number;
  /** Of the scale, over the height of the tape. */
  span: number;
  digits: number;
  unit: string;
  title: string;
  limits: TapeLimits;
  side: "left" | "right";
}

export function drawTape(context: CanvasRenderingContext2D, box: Box, tape: Tape, colours: Palette): void {
  const { x, y, width, height } = box;
  const left = tape.side === "left";
  const edge = left ? x + width : x;
  const inward = left ? -1 : 1;
  const middle = y + height / 2;
  const value = Number.isFinite(tape.value) ? tape.value : 0;
  const px = height / tape.span;
  const at = (one: number) => middle - (one - value) * px;
  context.save();
  context.beginPath();
  context.rect(x, y, width, height);
  context.clip();
  context.fillStyle = colours.instrument;
  context.fillRect(x, y, width, height);
  bands(context, edge, inward, at, tape.limits, box, colours);
  context.strokeStyle = colours["instrument-text"];
  context.fillStyle = colours["instrument-text"];
  context.lineWidth = 1.2;
  context.font = `500 12px ${FONT}`;
  context.textBaseline = "middle";
  context.textAlign = left ? "right" : "left";
  const first = Math.ceil((value - tape.span / 2) / tape.step);
  context.beginPath();
  for (let n = first; n * tape.step <= value + tape.span / 2; n += 1) {
    const mark = n * tape.step;
    const numbered = Math.abs(mark / tape.numbered - Math.round(mark / tape.numbered)) < 1e-6;
    context.moveTo(edge + inward * 6, at(mark));
    context.lineTo(edge + inward * (numbered ? 16 : 11), at(mark));
    if (numbered) context.fillText(fixed(mark, 0), edge + inward * 20, at(mark));
  }
  context.stroke();
  bug(context, edge, inward, at(tape.set), box, tape.set, colours);
  pointer(context, box, edge, inward, middle, tape, colours);
  header(context, box, tape, colours);
  context.restore();
}

function bands(
  context: CanvasRenderingContext2D, edge: number, inward: number, at: (value: number) => number,
  limits: TapeLimits, box: Box, colours: Palette,
): void {
  const low = box.y - 1;
  const high = box.y + box.height + 1;
  const band = (from: number | undefined, to: number | undefined, colour: string) => {
    const top = to === undefined ? low : Math.max(low, at(to));
    const bottom = from === undefined ? high : Math.min(high, at(from));
    if (bottom <= top) return;
    context.fillStyle = colour;
    context.fillRect(edge + (inward < 0 ? -5 : 0), top, 5, bottom - top);
  };
  const { lowest, low: caution_low, high: caution_high, highest } = limits;
  if (lowest !== undefined) band(undefined, lowest, colours.warning);
  if (lowest !== undefined && caution_low !== undefined) band(lowest, caution_low, colours.caution);
  if (caution_low !== undefined && caution_high !== undefined) band(caution_low, caution_high, colours.good);
  if (caution_high !== undefined) band(caution_high, highest, colours.caution);
  if (highest !== undefined) band(highest, undefined, colours.warning);
}

/** The set point; at the end of the tape while it is beyond. */
function bug(
  context: CanvasRenderingContext2D, edge: number, inward: number, wanted: number, box: Box, set: number, colours: Palette,
): void {
  if (!Number.isFinite(set)) return;
  const y = Math.max(box.y + 22, Math.min(box.y + box.height - 6, wanted));
  context.fillStyle = colours.set;
  context.beginPath();
  context.moveTo(edge + inward * 1, y);
  context.lineTo(edge + inward * 9, y - 6);
  context.lineTo(edge + inward * 9, y - 10);
  context.lineTo(edge + inward * 1, y - 10);
  context.lineTo(edge + inward * 1, y + 10);
  context.lineTo(edge + inward * 9, y + 10);
  context.lineTo(edge + inward * 9, y + 6);
  context.closePath();
  context.fill();
}

function pointer(
  context: CanvasRenderingContext2D, box: Box, edge: number, inward: number, middle: number, tape: Tape, colours: Palette,
): void {
  const far = edge + inward * (box.width - 3);
  const near = edge + inward * 12;
  context.beginPath();
  context.moveTo(edge + inward * 3, middle);
  context.lineTo(near, middle - 8);
  context.lineTo(near, middle - 14);
  context.lineTo(far, middle - 14);
  context.lineTo(far, middle + 14);
  context.lineTo(near, middle + 14);
  context.lineTo(near, middle + 8);
  context.closePath();
  context.fillStyle = "#05090d";
  context.fill();
  context.strokeStyle = colours["instrument-text"];
  context.lineWidth = 1.3;
  context.stroke();
  context.fillStyle = "#ffffff";
  context.font = `700 17px ${FONT}`;
  context.textAlign = "center";
  context.fillText(fixed(tape.value, tape.digits), (near + far) / 2, middle + 1);
}

function header(context: CanvasRenderingContext2D, box: Box, tape: Tape, colours: Palette): void {
  context.fillStyle = "#05090d";
  context.fillRect(box.x, box.y, box.width, 20);
  context.fillStyle = Number.isFinite(tape.set) ? colours.set : colours["instrument-text"];
  context.font = `600 11px ${FONT}`;
  context.textAlign = "center";
  context.fillText(`${Number.isFinite(tape.set) ? fixed(tape.set, tape.digits) : tape.title} ${tape.unit}`, box.x + box.width / 2, box.y + 10.5);
}
