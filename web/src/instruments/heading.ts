/** The heading tape, with the set heading, the course over the ground and the wind. */

import { DEGREES, shown, unitOf } from "../core/units";
import { FONT, type Palette } from "../design/theme";
import type { Box } from "./attitude";

const SHOWN_DEG = 90;
const POINTS: Record<number, string> = { 0: "N", 90: "E", 180: "S", 270: "W" };

const wrapped = (degrees: number): number => ((((degrees + 180) % 360) + 360) % 360) - 180;

export interface HeadingState {
  heading_rad: number;
  set_rad: number;
  /** Over the ground; NaN while it stands. */
  course_rad: number;
  wind_from_rad: number;
  wind_mps: number;
}

export function drawHeading(context: CanvasRenderingContext2D, box: Box, state: HeadingState, colours: Palette): void {
  const { x, y, width, height } = box;
  const heading = Number.isFinite(state.heading_rad) ? state.heading_rad * DEGREES : 0;
  const wind_width = 86;
  const tape_width = width - wind_width;
  const cx = x + tape_width / 2;
  const px = tape_width / SHOWN_DEG;
  context.save();
  context.beginPath();
  context.rect(x, y, width, height);
  context.clip();
  context.fillStyle = colours.instrument;
  context.fillRect(x, y, width, height);
  context.save();
  context.beginPath();
  context.rect(x, y, tape_width, height);
  context.clip();
  context.strokeStyle = colours["instrument-text"];
  context.lineWidth = 1.2;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.beginPath();
  for (let mark = Math.ceil((heading - SHOWN_DEG / 2 - 5) / 5) * 5; mark <= heading + SHOWN_DEG / 2 + 5; mark += 5) {
    const mx = cx + (mark - heading) * px;
    const name = ((mark % 360) + 360) % 360;
    context.moveTo(mx, y);
    context.lineTo(mx, y + (name % 10 === 0 ? 9 : 5));
    const point = POINTS[name];
    if (point === undefined && name % 10 !== 0) continue;
    context.fillStyle = point ? "#ffffff" : colours["instrument-text"];
    context.font = `${point ? 700 : 500} 12px ${FONT}`;
    context.fillText(point ?? String(name).padStart(3, "0"), mx, y + 18);
  }
  context.stroke();
  marker(context, cx, px, tape_width, state.set_rad * DEGREES - heading, y, colours.set, "bug");
  marker(context, cx, px, tape_width, state.course_rad * DEGREES - heading, y, colours.good, "diamond");
  context.fillStyle = "#05090d";
  context.strokeStyle = colours["instrument-text"];
  context.beginPath();
  context.roundRect(cx - 24, y + height - 21, 48, 20, 2);
  context.fill();
  context.stroke();
  context.fillStyle = "#ffffff";
  context.font = `700 15px ${FONT}`;
  context.fillText(`${shown("heading", state.heading_rad)}°`, cx + 1, y + height - 10.5);
  context.restore();
  wind(context, x + tape_width, y, height, state, colours);
  context.restore();
}

function marker(
  context: CanvasRenderingContext2D, cx: number, px: number, width: number, away_deg: number, y: number, colour: string, shape: "bug" | "diamond",
): void {
  if (!Number.isFinite(away_deg)) return;
  const limit = width / 2 - 8;
  const mx = cx + Math.max(-limit, Math.min(limit, wrapped(away_deg) * px));
  context.fillStyle = colour;
  context.beginPath();
  if (shape === "bug") {
    context.moveTo(mx, y + 9);
    context.lineTo(mx - 6, y + 1);
    context.lineTo(mx - 9, y + 1);
    context.lineTo(mx - 9, y + 9);
    context.lineTo(mx + 9, y + 9);
    context.lineTo(mx + 9, y + 1);
    context.lineTo(mx + 6, y + 1);
  } else {
    context.moveTo(mx, y);
    context.lineTo(mx - 5, y + 5);
    context.lineTo(mx, y + 10);
    context.lineTo(mx + 5, y + 5);
  }
  context.closePath();
  context.fill();
}

/** The arrow shows where the wind blows to, seen by the aircraft: up is ahead. */
function wind(
  context: CanvasRenderingContext2D, x: number, y: number, height: number, state: HeadingState, colours: Palette,
): void {
  context.strokeStyle = colours.line;
  context.beginPath();
  context.moveTo(x + 0.5, y);
  context.lineTo(x + 0.5, y + height);
  context.stroke();
  context.fillStyle = colours["instrument-text"];
  context.textAlign = "left";
  context.textBaseline = "middle";
  context.font = `500 11px ${FONT}`;
  const known = state.wind_mps > 0.2;
  context.fillText("Wind", x + 32, y + 9);
  context.fillText(known ? `${shown("heading", state.wind_from_rad)}°` : "calm", x + 32, y + height / 2 + 1);
  if (!known) return;
  context.fillText(`${shown("wind", state.wind_mps)} ${unitOf("wind")}`, x + 32, y + height - 7);
  context.save();
  context.translate(x + 16, y + height / 2);
  context.rotate(state.wind_from_rad + Math.PI - (Number.isFinite(state.heading_rad) ? state.heading_rad : 0));
  context.fillStyle = colours.accent;
  context.beginPath();
  context.moveTo(0, -12);
  context.lineTo(6, 0);
  context.lineTo(1.8, -1);
  context.lineTo(1.8, 12);
  context.lineTo(-1.8, 12);
  context.lineTo(-1.8, -1);
  context.lineTo(-6, 0);
  context.closePath();
  context.fill();
  context.restore();
}
