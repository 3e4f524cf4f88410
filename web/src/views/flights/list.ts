/** All recordings: what was flown, and what can be done with it. */

import { getJson, message, part, request, writable, type Flight } from "../../core/api";
import { button, h, icon, replace, setText, svg } from "../../core/dom";
import { bytes, duration, unitSystem, utc, withUnit } from "../../core/units";
import type { View } from "../../shell";
import "../../design/flights.css";

const EVERY_MS = 10_000;
const THUMB_PX = 72;

export async function openFlights(): Promise<View> {
  const list = h("ul", { class: "flight-list" });
  const summary = h("p", { class: "note" });
  const notice = h("p", { class: "result", role: "status" });
  let flights: Flight[] = [];
  let first: string | null = null;
  let asked: string | null = null;

  const remove = async (flight: Flight) => {
    try {
      await request("DELETE", `/flights/${part(flight.file)}`);
      flights = flights.filter((one) => one !== flight);
      setText(notice, `${flight.file} is deleted.`);
    } catch (error) {
      setText(notice, `${flight.file} is not deleted: ${message(error)}`);
    }
    asked = null;
    draw();
  };
  const draw = () => {
    setText(summary, flights.length === 0 ? "" : `${flights.length} ${flights.length === 1 ? "flight" : "flights"}, ${bytes(flights.reduce((sum, one) => sum + one.bytes, 0))}`);
    replace(list, ...flights.map((flight) => card(flight, flights, {
      asked: asked === flight.file,
      first,
      ask: (on) => {
        asked = on ? flight.file : null;
        draw();
      },
      remove: () => void remove(flight),
      choose: () => {
        if (first === null) first = flight.file;
        else if (first === flight.file) first = null;
        else {
          location.hash = `#/flights/${part(first)}/${part(flight.file)}`;
          return;
        }
        draw();
      },
    })));
    if (flights.length === 0) list.append(h("li", { class: "note empty" }, "No flight is recorded yet. A recording begins with the daemon."));
  };
  const refresh = async () => {
    try {
      flights = await getJson<Flight[]>("/flights");
      draw();
    } catch (error) {
      setText(notice, `The flights cannot be listed: ${message(error)}`);
    }
  };
  await refresh();
  const timer = setInterval(() => {
    if (asked === null) void refresh();
  }, EVERY_MS);
  const stops = [unitSystem.watch(draw), writable.watch(draw)];
  const element = h("div", { class: "page flights" }, h("div", { class: "row end" }, h("h1", {}, "Flights"), summary), notice, list);
  return {
    element,
    close() {
      clearInterval(timer);
      for (const stop of stops) stop();
    },
  };
}

interface CardActions {
  asked: boolean;
  first: string | null;
  ask(on: boolean): void;
  remove(): void;
  choose(): void;
}

function card(flight: Flight, flights: Flight[], actions: CardActions): HTMLElement {
  const faults = flight.faults ? `${flight.faults} ${flight.faults === 1 ? "fault" : "faults"}` : "";
  const state = flight.being_written ? "being recorded" : flight.whole ? `no faults${flight.ending ? `; ${flight.ending}` : ""}` : "unfinished recording: fccd recover finishes it";
  const name = utc(flight.start_utc_s);
  const remove = button(`Delete the flight of ${name}`, () => actions.ask(true), { icon: "trash", bare: true, class: "button plain", disabled: !writable.get() || flight.being_written === true });
  const compare = button(actions.first === flight.file ? "Chosen" : actions.first === null ? "Compare" : "Compare with this", actions.choose, { disabled: flights.length < 2 });
  compare.setAttribute("aria-pressed", String(actions.first === flight.file));
  const link = (format: string) => h("a", { href: `/api/flights/${part(flight.file)}/download?format=${format}`, download: "", "aria-label": `Download ${name} as ${format.toUpperCase()}` }, format.toUpperCase());
  return h(
    "li",
    { class: "flight panel" },
    thumbnail(flight.thumbnail ?? []),
    h(
      "div",
      { class: "flight-what" },
      h("a", { class: "flight-open", href: `#/flights/${part(flight.file)}` }, name),
      h("span", { class: "note mono" }, flight.file),
      faults ? h("span", { class: "flight-faults" }, icon("warning"), faults) : h("span", { class: "note" }, state),
    ),
    h("dl", { class: "flight-figures" }, ...[["Aircraft", flight.instance], ["Duration", duration(flight.duration_s)], ["Distance", flight.distance_m === null || flight.distance_m === undefined ? "–" : withUnit("distance", flight.distance_m)], ["Size", bytes(flight.bytes)]].map(([label = "", value = ""]) => h("div", {}, h("dt", {}, label), h("dd", {}, value)))),
    actions.asked
      ? h("div", { class: "row flight-actions", role: "group", "aria-label": "Delete" }, h("span", {}, "Delete this recording for good?"), button("Delete", actions.remove, { class: "button danger", icon: "trash" }), button("Keep", () => actions.ask(false)))
      : h("div", { class: "row flight-actions" }, h("a", { class: "button primary", href: `#/flights/${part(flight.file)}`, "aria-label": `Replay the flight of ${name}` }, icon("play"), "Replay"), compare, h("a", { class: "button", href: `/api/flights/${part(flight.file)}/report`, target: "_blank", rel: "noopener", "aria-label": `Report of ${name}` }, "Report"), h("span", { class: "downloads" }, icon("download"), ...["mcap", "csv", "gpx", "kml"].map(link)), remove),
  );
}

/** Its points are in 0 to 1, y to the north. */
function thumbnail(points: readonly [number, number][]): HTMLElement {
  const inner = THUMB_PX - 12;
  const text = points.map(([x, y]) => `${(6 + x * inner).toFixed(1)},${(6 + (1 - y) * inner).toFixed(1)}`).join(" ");
  return h("div", { class: "thumbnail" }, svg("svg", { viewBox: `0 0 ${THUMB_PX} ${THUMB_PX}`, "aria-hidden": "true" }, svg("polyline", { points: text })) as unknown as HTMLElement);
}
