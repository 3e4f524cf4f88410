/** Where an aircraft was, on the map. */

import { palette, type Palette } from "../design/theme";
import { CanvasLayer, type Projection } from "./canvas-layer";
import { CAPACITY, type TrackPoints } from "./track-points";

export class TrackLayer extends CanvasLayer {
  constructor(
    readonly points: TrackPoints,
    private readonly colour: keyof Palette = "track",
    private readonly dashed = false,
  ) {
    super({ pane: "overlayPane" });
  }

  override draw(context: CanvasRenderingContext2D, view: Projection): void {
    const { points } = this;
    const first = Math.max(0, points.count - CAPACITY);
    context.beginPath();
    let last_x = NaN, last_y = NaN;
    for (let n = first; n < points.count; n += 1) {
      const x = (points.x[n % CAPACITY] ?? 0) * view.scale - view.x0;
      const y = (points.y[n % CAPACITY] ?? 0) * view.scale - view.y0;
      if (n > first && n < points.count - 1 && Math.abs(x - last_x) < 1 && Math.abs(y - last_y) < 1) continue;
      if (n === first) context.moveTo(x, y);
      else context.lineTo(x, y);
      last_x = x;
      last_y = y;
    }
    const colours = palette.get();
    context.lineJoin = "round";
    context.lineCap = "round";
    if (this.dashed) context.setLineDash([8, 6]);
    context.strokeStyle = colours.panel;
    context.lineWidth = 4.5;
    context.stroke();
    context.strokeStyle = colours[this.colour];
    context.lineWidth = 2.2;
    context.stroke();
    context.setLineDash([]);
  }
}
