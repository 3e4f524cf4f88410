/** Elements from data: every text becomes a text node, never markup. */

type Child = Node | string | number | null | undefined | false;
type Handler = (event: never) => void;
export type Props = Record<string, string | number | boolean | null | undefined | Handler>;

function apply(element: Element, props: Props): void {
  for (const [name, value] of Object.entries(props)) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === "function") element.addEventListener(name, value as EventListener);
    else element.setAttribute(name, value === true ? "" : String(value));
  }
}

export function h<K extends keyof HTMLElementTagNameMap>(tag: K, props: Props = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  apply(element, props);
  append(element, children);
  return element;
}

export function append(element: Element, children: readonly Child[]): void {
  for (const child of children) {
    if (child === null || child === undefined || child === false) continue;
    element.append(typeof child === "number" ? String(child) : child);
  }
}

export function replace(element: Element, ...children: Child[]): void {
  element.replaceChildren();
  append(element, children);
}

/** Sets a text only when it differs, so that nothing is laid out again for nothing. */
export function setText(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

/** A result, good or bad. */
export function tell(element: HTMLElement, text: string, tone = ""): void {
  setText(element, text);
  element.dataset["tone"] = tone;
}

export function setClass(element: Element, name: string, on: boolean): void {
  if (element.classList.contains(name) !== on) element.classList.toggle(name, on);
}

const SVG = "http://www.w3.org/2000/svg";

export function svg(tag: string, props: Props, ...children: Element[]): SVGElement {
  const element = document.createElementNS(SVG, tag);
  apply(element, props);
  element.append(...children);
  return element;
}

/** Outlines of icons, each in a box of 24 by 24. */
const ICONS = {
  fly: "M12 2.500l1.400 6.800L21 13v1.700l-7.300-1.300-.6 4.300 2.300 1.900v1.400L12 20l-3.400 1v-1.400l2.300-1.900-.6-4.300L3 14.700V13l7.600-3.700z",
  plan: "M5 18a2 2 0 104 0 2 2 0 10-4 0M15 6a2 2 0 104 0 2 2 0 10-4 0M9 18h6a3.500 3.500 0 000-7H9a3 3 0 010-5h6",
  flights: "M4 5h16M4 12h16M4 19h10",
  health: "M3 12h4l2.500-7 5 14 2.500-7h4",
  undo: "M9 6L4 10.500 9 15M4.500 10.500H14a5.500 5.500 0 010 9h-3",
  redo: "M15 6l5 4.500L15 15M19.500 10.500H10a5.500 5.500 0 000 9h3",
  play: "M7 4.500v15l12-7.500z",
  pause: "M8 5v14M16 5v14",
  trash: "M5 7h14M10 7V4.500h4V7M7 7l1 13h8l1-13",
  up: "M12 19V6M6 11l6-6 6 6",
  down: "M12 5v13M6 13l6 6 6-6",
  add: "M12 5v14M5 12h14",
  centre: "M12 3v4M12 17v4M3 12h4M17 12h4M8 12a4 4 0 108 0 4 4 0 10-8 0",
  sun: "M8 12a4 4 0 108 0 4 4 0 10-8 0M12 3v2M12 19v2M3 12h2M19 12h2M5.600 5.600L7 7M17 17l1.400 1.400M5.600 18.400L7 17M17 7l1.400-1.400",
  moon: "M19.500 14A8 8 0 0110 4.500 8 8 0 1019.500 14z",
  contrast: "M4 12a8 8 0 1016 0 8 8 0 10-16 0M12 4v16",
  warning: "M12 4L2.500 20h19zM12 10v5M12 17.200v.6",
  download: "M12 4v11M7 11l5 5 5-5M4.500 20h15",
  upload: "M12 16V5M7 9l5-5 5 5M4.500 20h15",
  minus: "M5 12h14",
  fit: "M4 9V4h5M20 9V4h-5M4 15v5h5M20 15v5h-5",
} as const;
export type IconName = keyof typeof ICONS;

export function icon(name: IconName): SVGElement {
  return svg(
    "svg",
    { viewBox: "0 0 24 24", class: `icon icon-${name}`, "aria-hidden": "true", focusable: "false" },
    svg("path", { d: ICONS[name] }),
  );
}

/** A button with an icon; the label is read aloud, and shown unless `bare`. */
export function button(
  label: string,
  action: (event: MouseEvent) => void,
  options: { icon?: IconName; bare?: boolean; class?: string; title?: string; disabled?: boolean; key?: string } = {},
): HTMLButtonElement {
  const element = h("button", {
    type: "button",
    class: options.class ?? "button",
    title: options.title ?? (options.bare ? label : null),
    "aria-label": options.bare ? label : null,
    disabled: options.disabled ?? false,
    "data-key": options.key,
    click: action,
  });
  if (options.icon) element.append(icon(options.icon));
  if (!options.bare) element.append(h("span", {}, label));
  return element;
}

/** One of a few choices, shown side by side. */
export function choice<T extends string>(label: string, options: readonly (readonly [T, string])[], current: () => T, choose: (value: T) => void): HTMLElement {
  const group = h("div", { class: "segmented", role: "group", "aria-label": label });
  const mark = () => {
    for (const item of group.children) item.setAttribute("aria-pressed", String(item.getAttribute("data-value") === current()));
  };
  for (const [value, text] of options)
    group.append(h("button", { type: "button", "data-value": value, click: () => (choose(value), mark()) }, text));
  mark();
  return group;
}
