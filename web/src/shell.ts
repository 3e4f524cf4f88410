/** The frame around the views: navigation, link, clock, units, theme. */

import { writable } from "./core/api";
import { button, choice, h, icon, replace, setClass, setText, type IconName } from "./core/dom";
import { unitSystem } from "./core/units";
import { theme, type Theme } from "./design/theme";
import { freshness } from "./live/flight-state";
import { choose, daemon, daemons, linkAge, linkProblem, onRecord } from "./live/session";

export interface View {
  element: HTMLElement;
  close(): void;
}

interface Tab {
  route: string;
  label: string;
  icon: IconName;
  open: (rest: string[]) => Promise<View>;
}

const TABS: Tab[] = [
  { route: "fly", label: "Fly", icon: "fly", open: async () => (await import("./views/fly/fly")).openFly() },
  { route: "plan", label: "Plan", icon: "plan", open: async (rest) => (await import("./views/plan/plan")).openPlan(rest[0]) },
  {
    route: "flights",
    label: "Flights",
    icon: "flights",
    open: async (rest) => (rest[0] ? (await import("./views/flights/replay")).openReplay(rest[0], rest[1]) : (await import("./views/flights/list")).openFlights()),
  },
  { route: "health", label: "Health", icon: "health", open: async () => (await import("./views/health/health")).openHealth() },
];

const CLOCK_EVERY_MS = 250;

function linkBadge(): HTMLElement {
  const dot = h("span", { class: "dot", "aria-hidden": "true" });
  const text = h("span", { class: "link-text" });
  const badge = h("div", { class: "link", role: "status", title: "Age of the newest record" }, dot, text);
  const update = () => {
    const age = linkAge();
    const problem = linkProblem.get();
    const fresh = freshness(problem && age > 1 ? Infinity : age);
    badge.dataset["state"] = fresh;
    setText(text, fresh === "fresh" ? "Live" : age < 100 ? `Link ${age.toFixed(0)} s old` : "No link");
    badge.title = problem || "Newest record less than 1 s old";
  };
  setInterval(update, CLOCK_EVERY_MS);
  linkProblem.watch(update);
  onRecord(() => {
    if (badge.dataset["state"] !== "fresh") update();
  });
  return badge;
}

function clock(): HTMLElement {
  const text = h("time", { class: "clock", title: "This device's clock, UTC" });
  const tick = () => setText(text, `${new Date().toISOString().slice(11, 19)} UTC`);
  tick();
  setInterval(tick, CLOCK_EVERY_MS);
  return text;
}

function instancePicker(): HTMLElement {
  const select = h("select", { "aria-label": "Aircraft", change: () => choose(select.value) });
  const holder = h("div", { class: "instance" }, select);
  const show = () => {
    const found = daemons.get();
    const current = daemon.get()?.instance ?? "";
    const gone = current !== "" && !found.some((one) => one.instance === current);
    replace(select, ...found.map((one) => h("option", { value: one.instance }, one.instance)), gone ? h("option", { value: current }, `${current} (not running)`) : null);
    select.value = current;
    setClass(holder, "hidden", select.options.length === 0);
    select.disabled = select.options.length < 2;
  };
  daemons.watch(show);
  daemon.watch(show);
  return holder;
}

const NEXT_THEME: Record<Theme, Theme> = { auto: "light", light: "dark", dark: "auto" };
const THEME_ICONS: Record<Theme, IconName> = { auto: "contrast", light: "sun", dark: "moon" };

function themeButton(): HTMLElement {
  const element = button("Colours", () => theme.set(NEXT_THEME[theme.get()]), { icon: "contrast", bare: true, class: "button plain" });
  theme.watch((now) => {
    replace(element, icon(THEME_ICONS[now]));
    element.title = `Colours: ${now === "auto" ? "as the system" : now}`;
    element.setAttribute("aria-label", element.title);
  });
  return element;
}

export function startShell(root: HTMLElement): void {
  const main = h("main", { id: "main", tabindex: -1 });
  const links = TABS.map((tab) => h("a", { href: `#/${tab.route}`, class: "tab" }, icon(tab.icon), h("span", {}, tab.label)));
  const nav = h("nav", { class: "tabs", "aria-label": "Views" }, ...links);
  const viewer = h("span", { class: "viewer", title: "Open the link that the station prints, with its token, to send commands and to edit plans." }, "View only");
  writable.watch((on) => setClass(viewer, "hidden", on));
  const header = h(
    "header",
    { class: "top" },
    h("div", { class: "brand" }, icon("fly"), h("strong", {}, "fcc"), h("span", { class: "brand-rest" }, "ground station")),
    nav,
    h("div", { class: "spacer" }),
    viewer,
    instancePicker(),
    linkBadge(),
    clock(),
    choice("Units", [["metric", "m"], ["aviation", "ft"]], unitSystem.get, unitSystem.set),
    themeButton(),
  );
  root.append(header, main);

  let view: View | null = null;
  let opening = 0;
  const route = async () => {
    const [name, ...rest] = location.hash.replace(/^#\/?/, "").split("/").map(decodeURIComponent);
    const index = Math.max(0, TABS.findIndex((tab) => tab.route === name));
    const tab = TABS[index];
    if (!tab) return;
    links.forEach((link, at) => (at === index ? link.setAttribute("aria-current", "page") : link.removeAttribute("aria-current")));
    document.title = `${tab.label} – fcc ground station`;
    const mine = (opening += 1);
    let next: View;
    try {
      next = await tab.open(rest);
    } catch (error) {
      next = { element: h("p", { class: "notice bad", role: "alert" }, `This view cannot be opened: ${String(error)}`), close: () => undefined };
    }
    if (mine !== opening) {
      next.close();
      return;
    }
    view?.close();
    view = next;
    main.replaceChildren(next.element);
    main.dataset["view"] = tab.route;
    document.body.dataset["ready"] = tab.route;
  };
  addEventListener("hashchange", () => void route());
  void route();
}
