/** A canvas that is drawn anew when its size, the colours or the units change. */

import { notOnNextFrame, onNextFrame } from "./frame";
import { unitSystem } from "./units";
import { palette, type Palette } from "../design/theme";

export abstract class Drawing {
  readonly #draw = () => this.#redraw();
  readonly #observer = new ResizeObserver(() => this.again());
  readonly #stops: (() => void)[];

  constructor(readonly canvas: HTMLCanvasElement) {
    this.#observer.observe(canvas);
    this.#stops = [palette.watch(() => this.again()), unitSystem.watch(() => this.again())];
  }

  protected abstract draw(context: CanvasRenderingContext2D, width: number, height: number, colours: Palette): void;

  again(): void {
    onNextFrame(this.#draw);
  }

  close(): void {
    this.#observer.disconnect();
    notOnNextFrame(this.#draw);
    for (const stop of this.#stops) stop();
  }

  #redraw(): void {
    const { canvas } = this;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    const context = canvas.getContext("2d");
    if (width === 0 || !context) return;
    const ratio = Math.min(2, devicePixelRatio || 1);
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    context.scale(ratio, ratio);
    this.draw(context, width, height, palette.get());
  }
}
