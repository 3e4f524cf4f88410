/** Plan: a draft drawn on the map and edited in tables, beside the vehicle's plan. */

import L from "leaflet";
import { getJson, message, part, postJson, Refused, request, writable, type Check, type DraftEntry, type Problem } from "../../core/api";
import { button, choice, h, icon, replace, setClass, setText, tell } from "../../core/dom";
import { refusal } from "../../core/fields";
import { notOnNextFrame, onNextFrame } from "../../core/frame";
import { duration, unitSystem, withUnit } from "../../core/units";
import { daemon, linkAge, newest } from "../../live/session";
import { flightState, LOST_S } from "../../live/flight-state";
import { AircraftLayer } from "../../map/aircraft";
import { createChart } from "../../map/chart";
import { latLng, PlanLayer, toPlace, type Part } from "../../map/plan-layer";
import { DraftEditor, watchDrafts, type SaveState } from "../../plan/draft";
import { altitudeOf, emptyPlan, inserted, newItem, placeOf, removed, swapped, type Item, type Kind, type Place, type Plan } from "../../plan/model";
import type { View } from "../../shell";
import { ItemTable } from "./item-table";
import { Profile } from "./profile";
import { Vehicle } from "./vehicle";
import { Zones } from "./zones";
import "../../design/plan.css";

const CHECK_WAIT_MS = 200;
const SAVED: Record<SaveState, string> = { saved: "Saved on the board", saving: "Saving …", "not saved": "Not saved yet", conflict: "Conflict", "read only": "View only" };

type Tool = "select" | "waypoint" | "takeoff" | "loiter" | "land" | "fence" | "rally" | "obstacle" | "home";
const TOOLS: readonly (readonly [Tool, string])[] = [
  ["select", "Select"], ["waypoint", "Waypoint"], ["takeoff", "Take-off"], ["loiter", "Loiter"], ["land", "Land"],
  ["home", "Home"], ["fence", "Fence"], ["rally", "Rally"], ["obstacle", "Obstacle"],
];
const LAST_DRAFT = "fcc.plan.last";
/** A home so close to another one is on the same field. */
const SAME_FIELD_M = 2000;
const NOT_CHECKED = "The plan cannot be checked";

export async function openPlan(wanted: string | undefined): Promise<View> {
  const chart = createChart("Map of the plan");
  const { map } = chart;
  let editor: DraftEditor | null = null;
  let check: Check | null = null;
  let selected: Part | null = null;
  let tool: Tool = "select";
  let entries: DraftEntry[] = [];
  let corners: Place[] = [];
  let tab: "items" | "zones" = "items";
  let show_vehicle = false;
  let closed = false;
  let fitted = "";
  let deleting = "";
  let centred = false;

  const vehicle_layer = new PlanLayer(map);
  const pending = L.polyline([], { color: "#3fd58d", dashArray: "4 4", interactive: false }).addTo(map);
  const layer = new PlanLayer(map, { moved: (one, place) => edit(moved(plan(), one, place), `move ${describe(one)}`), selected: (one) => select(one) });
  const aircraft = new AircraftLayer(false, false).addTo(map);
  const table = new ItemTable();
  const zones = new Zones();
  const profile = new Profile((index) => select({ of: "item", index }));
  const vehicle = new Vehicle(() => refresh(), () => writable.get());

  const plan = (): Plan => editor?.plan ?? emptyPlan();
  const may = (): boolean => writable.get() && editor !== null;
  const edit = (next: Plan, what: string) => {
    if (may()) editor?.edit(withHome(next), what);
  };
  const select = (one: Part | null) => {
    if (JSON.stringify(one) === JSON.stringify(selected)) return;
    selected = one;
    onNextFrame(draw);
  };
  const centre = (): Place => toPlace(map.getCenter());
  const chosenIndex = (): number | null => (selected?.of === "item" ? selected.index : null);

  /** The first point needs a home: where the aircraft is, or the point itself. */
  const withHome = (next: Plan): Plan => {
    if (next.home || next.items.length === 0) return next;
    const record = newest();
    const state = record ? flightState(record, 0) : null;
    const first = next.items.map(placeOf).find((one) => one !== null);
    // The vehicle's own home has the runway's elevation; the altimeter has an error.
    const known = vehicle.plan?.plan?.home;
    if (state?.position_known) {
      const here = { latitude_deg: state.latitude_deg, longitude_deg: state.longitude_deg };
      const near = known && map.distance(latLng(known.place), latLng(here)) < SAME_FIELD_M;
      return { ...next, home: { place: here, altitude_m: near ? known.altitude_m : Math.round(state.altitude_m) || 0 } };
    }
    return first ? { ...next, home: { place: first, altitude_m: 0 } } : next;
  };

  // --- tools -------------------------------------------------------------
  const addItem = (kind: Kind, place: Place | null) => {
    const { items } = plan();
    const at = chosenIndex() ?? items.length - 1;
    const before_land = items[at]?.kind === "land" && kind !== "land" ? at : at + 1;
    edit({ ...plan(), items: inserted(items, before_land, newItem(kind, place, items.slice(0, before_land))) }, `add item ${before_land + 1}`);
    select({ of: "item", index: before_land });
  };
  const tapped = (place: Place) => {
    const now = plan();
    if (tool === "select") select(null);
    else if (tool === "fence") {
      corners = [...corners, place];
      onNextFrame(draw);
    } else if (tool === "rally") edit({ ...now, rally: [...now.rally, { place, altitude_m: 100 }] }, "add a rally point");
    else if (tool === "obstacle") edit({ ...now, obstacles: [...now.obstacles, { centre: place, radius_m: 30, top_m: (now.home?.altitude_m ?? 0) + 60 }] }, "add an obstacle");
    else if (tool === "home") edit({ ...now, home: { place, altitude_m: now.home?.altitude_m ?? 0 } }, "home");
    else addItem(tool, place);
  };
  map.on("click", (event: L.LeafletMouseEvent) => { if (may()) tapped(toPlace(event.latlng)); });
  const finishFence = () => {
    const now = plan();
    if (corners.length >= 3) edit({ ...now, fence: { ...now.fence, polygons: [...now.fence.polygons, { corners, inclusion: true, group: 0 }] } }, "add a fence polygon");
    corners = [];
    onNextFrame(draw);
  };
  const tool_choice = choice("What a tap on the map adds", TOOLS, () => tool, (now) => {
    tool = now;
    corners = [];
    setClass(map.getContainer(), "picking", now !== "select");
    if (now !== "select" && !["waypoint", "takeoff", "loiter", "land"].includes(now)) setTab("zones");
    else setTab("items");
    onNextFrame(draw);
  });
  const fence_done = button("Finish fence", finishFence, { class: "button primary hidden" });
  const add_here = button("Add at centre", () => tapped(centre()), { icon: "add" });

  // --- drafts ------------------------------------------------------------
  const picker = h("select", { "aria-label": "Draft", change: () => void open(picker.value) });
  const save_state = h("span", { class: "save-state", role: "status" });
  const undo = button("Undo", () => editor?.undo(), { icon: "undo", bare: true });
  const redo = button("Redo", () => editor?.redo(), { icon: "redo", bare: true });
  const changing = [button("New draft", () => newDraft(null), { icon: "add", bare: true }), button("Delete draft", () => removeDraft(), { icon: "trash", bare: true }), button("Import", () => file.click(), { icon: "upload" }), button("Copy draft", () => newDraft(plan()))] as const;
  const name_input = h("input", { type: "text", "aria-label": "Name of the new draft", maxlength: 40, pattern: "[A-Za-z0-9][A-Za-z0-9_.\\-]*", placeholder: "name", required: true });
  const asking = h("div", { class: "notice hidden" });
  const conflict = h("div", { class: "notice bad hidden", role: "alert" });
  const notice = h("p", { class: "result", role: "status" });
  const say = (text: string, tone = "") => tell(notice, text, tone);
  const ask = (...content: Node[]) => {
    replace(asking, ...content, button("Cancel", () => setClass(asking, "hidden", true)));
    setClass(asking, "hidden", false);
  };
  const listDrafts = async () => {
    try {
      entries = await getJson<DraftEntry[]>("/drafts");
    } catch (error) {
      say(`The drafts cannot be listed: ${message(error)}`, "bad");
    }
    const names = new Set([...entries.map((one) => one.name), ...(editor ? [editor.name] : [])]);
    replace(picker, ...[...names].sort().map((name) => h("option", { value: name }, name)));
    picker.value = editor?.name ?? "";
  };
  const open = async (name: string) => {
    try {
      const next = await DraftEditor.open(name, entries.some((one) => one.name === name), (changed) => {
        if (changed !== editor) return;
        recheck();
        onNextFrame(draw);
      });
      if (closed) return;
      editor?.close();
      editor = next;
      selected = null;
      check = null;
      pose();
      localStorage.setItem(LAST_DRAFT, name);
      await listDrafts();
      recheck();
      onNextFrame(draw);
    } catch (error) {
      say(`The draft ${name} cannot be opened: ${message(error)}`, "bad");
    }
  };
  /** A name that no draft has, nor one that is in this browser alone. */
  const freeName = (name: string): string => {
    const isFree = (one: string) => one !== editor?.name && !entries.some((known) => known.name === one) && localStorage.getItem(`fcc.draft.${one}`) === null;
    return [name, ...entries.map((_, n) => `${name}-${n + 2}`), `${name}-${Date.now()}`].find(isFree) ?? name;
  };
  const newDraft = (source: Plan | null) => {
    const form = h("form", { class: "row", submit: (event: Event) => {
      event.preventDefault();
      const name = name_input.value;
      if (entries.some((one) => one.name === name)) {
        say(`There is a draft ${name} already: choose another name.`, "bad");
        return;
      }
      setClass(asking, "hidden", true);
      void open(name).then(() => {
        if (source) editor?.edit(source, "copy");
      });
    } }, h("label", { class: "labelled" }, "Name ", name_input), h("button", { type: "submit", class: "button primary" }, "Create"));
    name_input.value = freeName(source ? `${editor?.name ?? "plan"}-copy` : `plan-${entries.length + 1}`);
    ask(form);
    name_input.select();
  };
  const removeDraft = () => {
    const name = editor?.name;
    if (!name) return;
    ask(h("span", {}, `Delete the draft ${name}? This cannot be undone. `), button(`Delete ${name}`, () => {
      setClass(asking, "hidden", true);
      deleting = name;
      void request("DELETE", `/drafts/${part(name)}`).then(async () => {
        editor?.close();
        editor = null;
        localStorage.removeItem(`fcc.draft.${name}`);
        await listDrafts();
        const first = entries[0];
        if (first) await open(first.name);
        onNextFrame(draw);
      }, (error: unknown) => say(message(error), "bad"));
    }, { class: "button danger", icon: "trash" }));
  };

  // --- files -------------------------------------------------------------
  const file = h("input", { type: "file", accept: ".plan,.waypoints,.wpl,.txt,.json", class: "visually-hidden", tabindex: -1, "aria-label": "Plan file", change: () => void importFile() });
  const importFile = async () => {
    const chosen = file.files?.[0];
    file.value = "";
    if (!chosen) return;
    try {
      const { plan: found } = await postJson<{ plan: Plan }>("/plan/import", { text: await chosen.text(), name: chosen.name });
      const name = freeName(chosen.name.replace(/\.\w+$/, "").replace(/[^\w.-]+/g, "-").replace(/^[^A-Za-z0-9]+/, "").slice(0, 40) || "import");
      await open(name);
      if (editor?.name !== name) return;
      editor.edit(found, `import ${chosen.name}`);
      fitted = "";
      say(`${chosen.name} is imported as a new draft, ${name}; the others stay as they are.`, "good");
    } catch (error) {
      const body = error instanceof Refused ? (error.body as { problems?: Problem[] } | null) : null;
      say(`${chosen.name} is not imported: ${body?.problems?.map((one) => [one.item && `item ${one.item}`, one.field, one.message].filter(Boolean).join(": ")).join("; ") ?? message(error)}`, "bad");
    }
  };
  const exportFile = async (format: "plan" | "waypoints") => {
    try {
      const text = await (await request("POST", "/plan/export", { plan: plan(), format })).blob();
      const url = URL.createObjectURL(text);
      h("a", { href: url, download: `${editor?.name ?? "plan"}.${format}` }).click();
      setTimeout(() => URL.revokeObjectURL(url), 1000);
    } catch (error) {
      say(`Not exported: ${message(error)}`, "bad");
    }
  };

  // --- check -------------------------------------------------------------
  let check_timer: ReturnType<typeof setTimeout> | undefined;
  let checking: AbortController | null = null;
  let checked: Plan | null = null;
  const recheck = () => {
    if (checked === plan()) return;
    clearTimeout(check_timer);
    check_timer = setTimeout(() => void runCheck(), CHECK_WAIT_MS);
  };
  const runCheck = async () => {
    checking?.abort();
    checking = new AbortController();
    const mine = plan();
    try {
      check = await postJson<Check>("/plan/check", { plan: mine, instance: daemon.get()?.instance ?? null }, checking.signal);
      checked = mine;
      if (notice.textContent.startsWith(NOT_CHECKED)) say("");
    } catch (error) {
      if (checking.signal.aborted && checked !== mine) return;
      check = null;
      say(`${NOT_CHECKED}: ${message(error)}`, "bad");
    }
    onNextFrame(draw);
  };

  // --- drawing -----------------------------------------------------------
  const totals = h("dl", { class: "totals", "aria-label": "Totals" });
  const plan_problems = h("ul", { class: "plan-problems" });
  const tab_choice = choice("Table", [["items", "Items"], ["zones", "Home, fence, rally, obstacles"]], () => tab, (now) => setTab(now));
  const setTab = (now: typeof tab) => {
    tab = now;
    for (const one of tab_choice.children) one.setAttribute("aria-pressed", String(one.getAttribute("data-value") === now));
    setClass(table.element, "hidden", now !== "items");
    setClass(zones.element, "hidden", now !== "zones");
  };
  const item_actions = {
    change: (index: number, item: Item, what: string) => edit({ ...plan(), items: plan().items.map((one, at) => (at === index ? item : one)) }, what),
    remove: (index: number) => {
      edit({ ...plan(), items: removed(plan().items, index) }, `delete item ${index + 1}`);
      select(null);
    },
    swap: (index: number, to: number) => {
      edit({ ...plan(), items: swapped(plan().items, index, to) }, `move item ${index + 1}`);
      select({ of: "item", index: to });
    },
    select: (index: number) => select({ of: "item", index }),
    get writable() { return may(); },
  };
  const zone_actions = { edit, centre, get writable() { return may(); } };

  const draw = () => {
    const now = plan();
    const current = checked === now ? check : null;
    const problems = current?.problems ?? [];
    const errors = problems.filter((one) => one.level === "error");
    const active = vehicle.plan !== null && current?.hash === vehicle.plan.hash ? (newest()?.number("desired_guidance_item") ?? 0) : 0;
    layer.show(now, current?.path ?? null);
    layer.mark(active, selected, new Set(errors.map((one) => one.item ?? 0)));
    vehicle_layer.show(show_vehicle ? (vehicle.plan?.plan ?? null) : null, null);
    pending.setLatLngs(corners.map(latLng));
    table.show(now.items, problems, chosenIndex(), active, item_actions);
    zones.show(now, zone_actions);
    profile.show(current ?? check, now.items.map((one) => placeOf(one) !== null && altitudeOf(one) !== null), chosenIndex());
    vehicle.show(editor, { errors: errors.length, checked_hash: current?.hash ?? null });
    const total = current ?? check;
    replace(
      totals,
      ...[
        ["Items", String(now.items.length)],
        ["Distance", total?.distance_m ? withUnit("distance", total.distance_m) : "–"],
        ["Time", total?.duration_s ? duration(total.duration_s) : "–"],
        ["Problems", now.items.length === 0 ? "–" : current ? (errors.length > 0 ? `${errors.length} ${errors.length === 1 ? "error" : "errors"}` : problems.length > 0 ? `${problems.length} ${problems.length === 1 ? "remark" : "remarks"}` : "none") : "checking"],
      ].map(([name = "", value = ""]) => h("div", { "data-tone": name === "Problems" && value.includes("error") ? "bad" : "" }, h("dt", {}, name), h("dd", {}, value))),
    );
    replace(plan_problems, ...problems.filter((one) => now.items.length > 0 && (one.item === null || one.item > now.items.length)).map((one) => h("li", { class: `notice ${one.level === "error" ? "bad" : "remark"}` }, icon("warning"), " ", one.field ? `${one.field}: ` : null, one.message)));
    drawState();
    fitOnce();
  };
  const fit = () => {
    const bounds = layer.bounds();
    if (bounds) map.fitBounds(bounds, { animate: false, paddingTopLeft: [20, tool_choice.offsetHeight + 20], paddingBottomRight: [64, 20] });
  };
  // As it was opened: what is drawn into it moves no map.
  const fitOnce = () => {
    if (!editor || fitted === editor.name || map.getSize().x === 0) return;
    fitted = editor.name;
    fit();
  };
  map.on("resize", fitOnce);
  const drawState = () => {
    const state = writable.get() ? (editor?.state ?? "saved") : "read only";
    for (const one of [...changing, ...tool_choice.querySelectorAll("button")]) one.disabled = !writable.get();
    setText(save_state, editor ? (state === "saved" ? (editor.revision > 0 ? SAVED[state] : "Empty: saved with the first edit") : SAVED[state]) : "No draft");
    save_state.title = editor?.reason || `Revision ${editor?.revision ?? 0}`;
    save_state.dataset["tone"] = state === "saved" ? "good" : state === "saving" || state === "read only" ? "" : "bad";
    undo.disabled = !may() || editor?.history.undoes === null;
    redo.disabled = !may() || editor?.history.redoes === null;
    undo.title = `Undo: ${editor?.history.undoes ?? "nothing"}`;
    redo.title = `Redo: ${editor?.history.redoes ?? "nothing"}`;
    add_here.disabled = !may() || tool === "select";
    setClass(fence_done, "hidden", tool !== "fence" || corners.length < 3);
    setClass(conflict, "hidden", state !== "conflict");
    if (state === "conflict" && editor?.theirs)
      replace(
        conflict,
        h("span", {}, `Another page changed this draft (revision ${editor.theirs.revision}, ${editor.theirs.plan.items.length} items); yours has ${editor.plan.items.length} items. Either can be undone. `),
        button("Keep mine", () => editor?.resolve("mine")),
        button("Take the board's", () => editor?.resolve("theirs")),
      );
  };
  const refresh = () => onNextFrame(draw);
  const pose = () => {
    const record = newest();
    const state = record ? flightState(record, linkAge()) : null;
    // Before anything can be drawn far away from it.
    if (state?.position_known && editor && !centred && editor.plan.items.length === 0 && layer.bounds() === null) {
      centred = true;
      map.setView([state.latitude_deg, state.longitude_deg], 13, { animate: false });
    }
    return state;
  };

  // --- keys, lists, end --------------------------------------------------
  const keys = (event: KeyboardEvent) => {
    if (event.target === name_input || !(event.ctrlKey || event.metaKey)) return;
    const key = event.key.toLowerCase();
    if (key === "z" && !event.shiftKey) editor?.undo();
    else if ((key === "z" && event.shiftKey) || key === "y") editor?.redo();
    else return;
    event.preventDefault();
  };
  const deleteKey = (event: KeyboardEvent) => {
    const index = chosenIndex();
    if ((event.key === "Delete" || event.key === "Backspace") && index !== null && may()) item_actions.remove(index);
    else if (event.key === "Enter" && event.target === map.getContainer() && tool !== "select" && may()) tapped(centre());
  };
  document.addEventListener("keydown", keys);
  map.getContainer().addEventListener("keydown", deleteKey);
  const position = setInterval(() => {
    const state = pose();
    aircraft.show(state?.position_known ? { ...state } : null, (state?.ages.position ?? Infinity) > LOST_S);
  }, 500);
  const stops = [
    unitSystem.watch(refresh),
    refusal.watch((text) => say(text, "bad")),
    writable.watch(refresh),
    daemon.watch(() => void vehicle.refresh()),
    watchDrafts(
      (name, revision) => {
        if (editor?.name === name && revision === null && deleting !== name) say(`${name} was deleted by another page: the next edit saves it again.`, "bad");
        else if (editor?.name === name) void editor.follow(revision ?? 0).catch(() => undefined);
        if (!entries.some((one) => one.name === name)) void listDrafts();
      },
      () => {
        if (editor) void editor.follow(Infinity).catch(() => undefined);
        void listDrafts();
      },
    ),
  ];

  chart.controls.append(button("Show the whole plan", fit, { icon: "fit", bare: true, class: "map-button" }));
  const overlay = button("Show vehicle's plan", () => {
    show_vehicle = !show_vehicle;
    overlay.setAttribute("aria-pressed", String(show_vehicle));
    refresh();
  });
  overlay.setAttribute("aria-pressed", "false");

  const side = h(
    "div",
    { class: "plan-side" },
    h("div", { class: "row plan-head" }, picker, changing[0], changing[1], undo, redo, save_state),
    asking,
    conflict,
    totals,
    plan_problems,
    h("div", { class: "row end" }, tab_choice, h("div", { class: "row" }, add_here, fence_done)),
    h("div", { class: "tables panel" }, table.element, zones.element),
    vehicle.element,
    h("div", { class: "row files" }, changing[2], file, button("Export .plan", () => void exportFile("plan"), { icon: "download" }), button(".waypoints", () => void exportFile("waypoints"), { icon: "download", title: "Export .waypoints" }), changing[3], overlay),
    notice,
  );
  const element = h("div", { class: "plan" }, h("h1", { class: "visually-hidden" }, "Plan"), h("div", { class: "plan-map" }, h("div", { class: "plan-chart" }, chart.element, h("div", { class: "plan-tools" }, tool_choice)), profile.element), side);
  setTab("items");
  await listDrafts();
  const last = wanted ?? localStorage.getItem(LAST_DRAFT);
  const first = entries.find((one) => one.name === last)?.name ?? entries[0]?.name ?? (last && localStorage.getItem(`fcc.draft.${last}`) ? last : undefined);
  // Without any, one is begun; it is on the board from the first edit on.
  void open(first ?? "plan-1");

  return {
    element,
    close() {
      closed = true;
      document.removeEventListener("keydown", keys);
      clearInterval(position);
      clearTimeout(check_timer);
      notOnNextFrame(draw);
      for (const stop of stops) stop();
      editor?.close();
      vehicle.close();
      profile.close();
      layer.close();
      vehicle_layer.close();
      chart.close();
    },
  };
}

function describe(one: Part): string {
  return one.of === "item" ? `item ${one.index + 1}` : one.of === "home" ? "home" : one.of === "corner" ? `corner ${one.corner + 1}` : `${one.of} ${one.index + 1}`;
}

/** The plan with one part at another place. */
function moved(plan: Plan, one: Part, place: Place): Plan {
  const at = <T>(list: readonly T[], index: number, change: (value: T) => T): T[] => list.map((value, n) => (n === index ? change(value) : value));
  switch (one.of) {
    case "item":
      return { ...plan, items: at(plan.items, one.index, (item) => ({ ...item, place }) as Item) };
    case "home":
      return { ...plan, home: { place, altitude_m: plan.home?.altitude_m ?? 0 } };
    case "rally":
      return { ...plan, rally: at(plan.rally, one.index, (value) => ({ ...value, place })) };
    case "obstacle":
      return { ...plan, obstacles: at(plan.obstacles, one.index, (value) => ({ ...value, centre: place })) };
    case "circle":
      return { ...plan, fence: { ...plan.fence, circles: at(plan.fence.circles, one.index, (value) => ({ ...value, centre: place })) } };
    case "corner":
      return { ...plan, fence: { ...plan.fence, polygons: at(plan.fence.polygons, one.index, (value) => ({ ...value, corners: at(value.corners, one.corner, () => place) })) } };
  }
}
