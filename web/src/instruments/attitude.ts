/**
 * The horizon. Nose up moves it down, right wing down turns it counter-clockwise:
 * the display shows what a window would.
 */

import { FONT, type Palette } from "../design/theme";

export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

const DEGREES = 180 / Math.PI;
/** Of pitch over the height of the display. */
const SHOWN_DEG = 44;
const BANK_MARKS_DEG = [-60, -45, -30, -20, -10, 10, 20, 30, 45, 60];
/** Side force that moves the ball by its own width, m/s². */
const BALL_MPS2 = 1.2;

export function drawAttitude(
  context: CanvasRenderingContext2D,
  box: Box,
  state: { pitch_rad: number; roll_rad: number; side_force_mps2: number; set_pitch_rad: number; set_roll_rad: number },
  colours: Palette,
): void {
  const cx = box.x + box.width / 2;
  const cy = box.y + box.height / 2;
  const px_per_deg = box.height / SHOWN_DEG;
  const reach = Math.hypot(box.width, box.height);
  context.save();
  context.beginPath();
  context.rect(box.x, box.y, box.width, box.height);
  context.clip();
  const pitch_deg = Number.isFinite(state.pitch_rad) ? state.pitch_rad * DEGREES : 0;
  const roll_rad = Number.isFinite(state.roll_rad) ? state.roll_rad : 0;

  // Not turned: that takes a tenth of the time.
  context.fillStyle = colours.sky;
  context.fillRect(box.x, box.y, box.width, box.height);
  context.save();
  context.translate(cx, cy);
  context.rotate(-roll_rad);
  const horizon = pitch_deg * px_per_deg;
  context.fillStyle = colours.ground;
  context.fillRect(-reach, horizon, 2 * reach, 4 * reach);
  context.strokeStyle = colours.horizon;
  context.lineWidth = 2;
  line(context, -reach, horizon, reach, horizon);
  ladder(context, box, pitch_deg, px_per_deg, colours);
  context.restore();

  bankScale(context, cx, cy, box, roll_rad, colours);
  if (Number.isFinite(state.set_roll_rad) && Number.isFinite(state.set_pitch_rad))
    director(context, cx, cy, px_per_deg, pitch_deg, roll_rad, state, colours);
  symbol(context, cx, cy, box, colours);
  ball(context, cx, box, state.side_force_mps2, colours);
  context.restore();
}

function line(context: CanvasRenderingContext2D, x1: number, y1: number, x2: number, y2: number): void {
  context.beginPath();
  context.moveTo(x1, y1);
  context.lineTo(x2, y2);
  context.stroke();
}

function ladder(context: CanvasRenderingContext2D, box: Box, pitch_deg: number, px_per_deg: number, colours: Palette): void {
  context.strokeStyle = colours.horizon;
  context.fillStyle = colours.horizon;
  context.lineWidth = 1.4;
  context.font = `600 11px ${FONT}`;
  context.textBaseline = "middle";
  const limit = Math.min(box.height * 0.36, box.width * 0.38);
  const wide = Math.min(box.width * 0.16, 46);
  context.beginPath();
  for (let mark = -90; mark <= 90; mark += 2.5) {
    const y = (pitch_deg - mark) * px_per_deg;
    if (mark === 0 || Math.abs(y) > limit) continue;
    const half = mark % 10 === 0 ? wide : mark % 5 === 0 ? wide * 0.55 : wide * 0.25;
    context.moveTo(-half, y);
    context.lineTo(half, y);
    if (mark % 10 !== 0) continue;
    context.textAlign = "left";
    context.fillText(String(Math.abs(mark)), half + 6, y);
    context.textAlign = "right";
    context.fillText(String(Math.abs(mark)), -half - 6, y);
  }
  context.stroke();
}

function bankScale(context: CanvasRenderingContext2D, cx: number, cy: number, box: Box, roll_rad: number, colours: Palette): void {
  const radius = Math.min(box.height * 0.44, box.width * 0.46);
  context.save();
  context.translate(cx, cy);
  context.strokeStyle = colours.horizon;
  context.fillStyle = colours.horizon;
  context.lineWidth = 1.6;
  context.save();
  context.rotate(-roll_rad);
  context.beginPath();
  context.arc(0, 0, radius, (-150 * Math.PI) / 180, (-30 * Math.PI) / 180);
  for (const mark of BANK_MARKS_DEG) {
    const [x, y] = [Math.sin((mark * Math.PI) / 180), -Math.cos((mark * Math.PI) / 180)];
    const far = radius + (mark % 30 === 0 ? 11 : 6);
    context.moveTo(radius * x, radius * y);
    context.lineTo(far * x, far * y);
  }
  context.stroke();
  triangle(context, 0, -radius, -1);
  context.restore();
  triangle(context, 0, -radius, 1);
  context.restore();
}

/** With its point at the place, above (-1) or below (1) it. */
function triangle(context: CanvasRenderingContext2D, x: number, y: number, side: number): void {
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(x - 6, y + 10 * side);
  context.lineTo(x + 6, y + 10 * side);
  context.closePath();
  context.fill();
}

/** What is commanded, as two bars of a flight director. */
function director(
  context: CanvasRenderingContext2D, cx: number, cy: number, px_per_deg: number, pitch_deg: number, roll_rad: number,
  set: { set_pitch_rad: number; set_roll_rad: number }, colours: Palette,
): void {
  const clip = (value: number) => Math.max(-60, Math.min(60, value));
  const dy = clip((pitch_deg - set.set_pitch_rad * DEGREES) * px_per_deg);
  const dx = clip((set.set_roll_rad - roll_rad) * DEGREES * 2);
  context.strokeStyle = colours.set;
  context.lineWidth = 2.4;
  line(context, cx - 42, cy + dy, cx + 42, cy + dy);
  line(context, cx + dx, cy - 42, cx + dx, cy + 42);
}

function symbol(context: CanvasRenderingContext2D, cx: number, cy: number, box: Box, colours: Palette): void {
  const wide = Math.min(box.width * 0.3, 82);
  const wing = (side: number) => {
    context.beginPath();
    context.moveTo(cx + side * wide, cy);
    context.lineTo(cx + side * wide * 0.45, cy);
    context.lineTo(cx + side * wide * 0.45, cy + 9);
    context.stroke();
  };
  for (const [width, colour] of [[6, "#0b1016"], [3, "#ffd23f"]] as const) {
    context.lineWidth = width;
    context.strokeStyle = colour;
    wing(1);
    wing(-1);
    context.strokeRect(cx - 2, cy - 2, 4, 4);
  }
  context.lineWidth = 1;
  context.strokeStyle = colours.line;
}

function ball(context: CanvasRenderingContext2D, cx: number, box: Box, side_force_mps2: number, colours: Palette): void {
  const y = box.y + box.height - 14;
  const away = Number.isFinite(side_force_mps2) ? Math.max(-26, Math.min(26, (-side_force_mps2 / BALL_MPS2) * 13)) : 0;
  context.fillStyle = "rgb(8 14 20 / 55%)";
  context.beginPath();
  context.roundRect(cx - 40, y - 8, 80, 16, 8);
  context.fill();
  context.strokeStyle = colours.horizon;
  context.lineWidth = 1.2;
  line(context, cx - 9, y - 8, cx - 9, y + 8);
  line(context, cx + 9, y - 8, cx + 9, y + 8);
  context.fillStyle = colours.horizon;
  context.beginPath();
  context.arc(cx + away, y, 6, 0, 2 * Math.PI);
  context.fill();
}
