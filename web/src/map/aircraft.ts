/** The aircraft on the map, turned to its heading, with a line to where it is in a minute. */

import { palette, type Palette } from "../design/theme";
import { CanvasLayer, type Projection } from "./canvas-layer";

const OUTLINE: readonly (readonly [number, number])[] = [
  [0, -17], [2.6, -11], [2.8, -5], [17, 1], [17, 4.2], [2.8, 2.6], [1.9, 11], [6.500, 14], [6.500, 16.500], [0, 15],
];
const AHEAD_S = 60;

export interface Pose {
  latitude_deg: number;
  longitude_deg: number;
  heading_rad: number;
  north_mps: number;
  east_mps: number;
}

export class AircraftLayer extends CanvasLayer {
  pose: Pose | null = null;
  stale = false;

  constructor(
    private readonly colour: keyof Palette = "accent",
    private readonly ahead = true,
  ) {
    super({ pane: "markerPane" });
  }

  show(pose: Pose | null, stale = false): void {
    this.pose = pose;
    this.stale = stale;
    this.invalidate();
  }

  override draw(context: CanvasRenderingContext2D, view: Projection): void {
    const pose = this.pose;
    if (!pose) return;
    const colours = palette.get();
    const x = view.x(pose.longitude_deg);
    const y = view.y(pose.latitude_deg);
    const cosine = Math.max(0.05, Math.cos((pose.latitude_deg * Math.PI) / 180));
    const px_per_m = (view.scale * 256) / 40_075_017 / cosine;
    if (this.ahead && Math.hypot(pose.north_mps, pose.east_mps) > 3) {
      context.strokeStyle = colours[this.colour];
      context.lineWidth = 1.5;
      context.setLineDash([3, 5]);
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x + pose.east_mps * AHEAD_S * px_per_m, y - pose.north_mps * AHEAD_S * px_per_m);
      context.stroke();
      context.setLineDash([]);
    }
    context.save();
    context.translate(x, y);
    context.rotate(pose.heading_rad);
    context.beginPath();
    for (const [px, py] of OUTLINE) context.lineTo(px, py);
    for (const [px, py] of [...OUTLINE].reverse()) context.lineTo(-px, py);
    context.closePath();
    context.fillStyle = this.stale ? colours.muted : colours[this.colour];
    context.strokeStyle = colours.panel;
    context.lineWidth = 2.5;
    context.lineJoin = "round";
    context.stroke();
    context.fill();
    if (this.stale) {
      context.rotate(-pose.heading_rad);
      context.strokeStyle = colours.warning;
      context.beginPath();
      context.moveTo(-15, -15);
      context.lineTo(15, 15);
      context.stroke();
    }
    context.restore();
  }
}
