/** The height profile: altitude of the plan over the terrain along its path. */

import type { Check } from "../../core/api";
import { Drawing } from "../../core/canvas";
import { h } from "../../core/dom";
import { fixed, shown, toShown, unitOf } from "../../core/units";
import { FONT, type Palette } from "../../design/theme";

const LEFT_PX = 46, RIGHT_PX = 12, TOP_PX = 20, BOTTOM_PX = 20;

export class Profile extends Drawing {
  readonly element = h("div", { class: "profile" }, this.canvas);
  #check: Check | null = null;
  #places: boolean[] = [];
  #selected: number | null = null;

  constructor(select: (index: number) => void) {
    super(h("canvas", { class: "profile-canvas", role: "img", "aria-label": "Height profile: empty" }));
    this.canvas.addEventListener("click", (event) => {
      const index = this.#nearest(event.offsetX);
      if (index !== null) select(index);
    });
  }

  /** `places` says which items have one, and so a point of the profile. */
  show(check: Check | null, places: boolean[], selected: number | null): void {
    this.#check = check;
    this.#places = places;
    this.#selected = selected;
    const distance = check?.distance_m;
    this.canvas.setAttribute("aria-label", distance ? `Height profile over ${shown("distance", distance)} ${unitOf("distance")}; altitudes are in the table` : "Height profile: empty");
    this.again();
  }

  #points(): { index: number; distance_m: number; altitude_m: number }[] {
    return (this.#check?.items ?? []).flatMap((one, index) => (one && this.#places[index] ? [{ index, ...one }] : []));
  }

  #nearest(x: number): number | null {
    const length = Math.max(1, this.#check?.distance_m ?? 1);
    const wide = this.canvas.clientWidth - LEFT_PX - RIGHT_PX;
    const distance = ((x - LEFT_PX) / wide) * length;
    const points = this.#points();
    return points.reduce<(typeof points)[number] | null>((best, one) => (best === null || Math.abs(one.distance_m - distance) < Math.abs(best.distance_m - distance) ? one : best), null)?.index ?? null;
  }

  protected draw(context: CanvasRenderingContext2D, width: number, height: number, colours: Palette): void {
    const points = this.#points();
    context.font = `11px ${FONT}`;
    context.fillStyle = colours.muted;
    if (points.length < 2) {
      context.fillText("The height profile appears with two points.", LEFT_PX, height / 2);
      return;
    }
    const terrain = this.#check?.terrain ?? [];
    const heights = [...points.map((one) => one.altitude_m), ...terrain.map(([, metres]) => metres)];
    const low = Math.min(...heights), high = Math.max(...heights);
    const span = Math.max(60, high - low) * 1.12;
    const length = Math.max(1, this.#check?.distance_m ?? points.at(-1)?.distance_m ?? 1);
    const x = (metres: number) => LEFT_PX + (metres / length) * (width - LEFT_PX - RIGHT_PX);
    const y = (metres: number) => height - BOTTOM_PX - ((metres - low) / span) * (height - TOP_PX - BOTTOM_PX);

    context.strokeStyle = colours.grid;
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const part of [0, 0.5, 1]) {
      const metres = low + (span / 1.12) * part;
      context.beginPath();
      context.moveTo(LEFT_PX, y(metres));
      context.lineTo(width - RIGHT_PX, y(metres));
      context.stroke();
      context.fillText(shown("altitude", metres), LEFT_PX - 6, y(metres));
    }
    context.textAlign = "left";
    context.fillText(`${unitOf("altitude")} above sea level`, 6, 8);
    context.textAlign = "center";
    for (const part of [0.25, 0.5, 0.75]) context.fillText(`${fixed(toShown("distance", length * part), 1)} ${unitOf("distance")}`, x(length * part), height - 9);

    if (terrain.length > 1) {
      context.beginPath();
      context.moveTo(x(terrain[0]?.[0] ?? 0), height - BOTTOM_PX);
      for (const [distance, metres] of terrain) context.lineTo(x(distance), y(metres));
      context.lineTo(x(terrain.at(-1)?.[0] ?? 0), height - BOTTOM_PX);
      context.closePath();
      context.fillStyle = colours.terrain;
      context.fill();
    }
    context.beginPath();
    for (const one of points) context.lineTo(x(one.distance_m), y(one.altitude_m));
    context.strokeStyle = colours.path;
    context.lineWidth = 2;
    context.stroke();
    context.lineWidth = 1;
    for (const one of points) {
      const chosen = one.index === this.#selected;
      context.beginPath();
      context.arc(x(one.distance_m), y(one.altitude_m), chosen ? 6 : 4, 0, 2 * Math.PI);
      context.fillStyle = chosen ? colours.accent : colours.panel;
      context.fill();
      context.strokeStyle = colours.path;
      context.lineWidth = 2;
      context.stroke();
      context.fillStyle = colours.text;
      context.fillText(String(one.index + 1), x(one.distance_m), y(one.altitude_m) - 11);
    }
  }
}
