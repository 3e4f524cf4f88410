/** Light or dark, and the colours of the tokens for what is drawn on a canvas. */

import { kept, watched } from "../core/state";

export type Theme = "auto" | "light" | "dark";
export const theme = kept<Theme>("fcc.theme", ["auto", "light", "dark"], "auto");

const NAMES = [
  "text", "muted", "panel", "line", "accent", "set", "good", "caution", "warning", "sky", "ground",
  "horizon", "instrument", "instrument-text", "sea", "land", "coast", "grid", "grid-text", "track", "path", "second", "terrain",
] as const;
export type Palette = Record<(typeof NAMES)[number], string>;

function read(): Palette {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()])) as Palette;
}

/** The names of which an instrument has colours of its own, the same by day and by night. */
const ON_INSTRUMENTS = ["set", "accent", "good", "caution", "warning", "line"] as const;

/** The colours on an instrument. */
export function instrumentPalette(): Palette {
  const style = getComputedStyle(document.documentElement);
  const own = Object.fromEntries(ON_INSTRUMENTS.map((name) => [name, style.getPropertyValue(`--instrument-${name}`).trim()]));
  return { ...palette.get(), ...own };
}

export const palette = watched<Palette>({} as Palette);

const system = matchMedia("(prefers-color-scheme: dark)");

function apply(): void {
  const wanted = theme.get();
  const dark = wanted === "dark" || (wanted === "auto" && system.matches);
  document.documentElement.dataset["theme"] = dark ? "dark" : "light";
  palette.set(read());
}

export function startTheme(): void {
  theme.watch(apply);
  system.addEventListener("change", apply);
}

export const FONT = 'ui-sans-serif, system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", sans-serif';
