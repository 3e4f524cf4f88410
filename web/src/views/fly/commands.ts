/** Commands to the daemon, each with its result or the reason of its refusal. */

import L from "leaflet";
import { message, sendCommand, writable, type Command } from "../../core/api";
import { button, h, setClass, setText, tell } from "../../core/dom";
import { slide } from "../../core/slide";
import { inUnits, toShown, toSi, unitOf } from "../../core/units";
import { toPlace } from "../../map/plan-layer";
import { daemon } from "../../live/session";

export interface FlightPhase {
  engaged: boolean;
  mode: string;
  inhibits: string[];
  fresh: boolean;
  landed: boolean;
  altitude_m: number;
}

export class Commands {
  readonly element = h("section", { class: "panel commands", "aria-label": "Commands" });
  readonly #result = h("p", { class: "result", role: "status" });
  readonly #slide = slide(() => void this.send(this.#phase.engaged ? "disengage" : "engage"));
  readonly #pause: HTMLButtonElement;
  readonly #resume: HTMLButtonElement;
  readonly #goTo: HTMLButtonElement;
  readonly #others: HTMLButtonElement[];
  readonly #target = h("form", { class: "target hidden" });
  readonly #altitude = h("input", { type: "number", class: "number", step: "any", "aria-label": "Altitude of go-to" });
  readonly #altitude_unit = h("span", { class: "unit" });
  readonly #where = h("span", { class: "where" });
  #marker: L.CircleMarker | null = null;
  #picking = false;
  #phase: FlightPhase = { engaged: false, mode: "", inhibits: [], fresh: false, landed: false, altitude_m: NaN };

  constructor(private readonly map: L.Map) {
    this.#pause = button("Pause", () => void this.send("pause"), { icon: "pause" });
    this.#resume = button("Resume", () => void this.send("resume"), { icon: "play" });
    this.#goTo = button("Go to…", () => this.#pick(!this.#picking), { icon: "centre" });
    this.#goTo.setAttribute("aria-pressed", "false");
    this.#others = [button("Return", () => void this.send("return"), { icon: "undo" }), button("Land", () => void this.send("land"), { icon: "down" })];
    this.#target.append(
      this.#where,
      h("label", {}, "at ", this.#altitude, " ", this.#altitude_unit),
      h("div", { class: "row" }, h("button", { type: "submit", class: "button primary" }, "Fly there"), button("Cancel", () => this.#pick(false))),
    );
    this.#target.addEventListener("submit", (event) => {
      event.preventDefault();
      this.#flyThere();
    });
    this.element.append(
      this.#slide.element,
      h("div", { class: "buttons" }, this.#pause, this.#resume, this.#goTo, ...this.#others),
      this.#target,
      this.#result,
    );
    this.map.on("click", (event: L.LeafletMouseEvent) => {
      if (this.#picking) this.#place(event.latlng);
    });
    this.map.getContainer().addEventListener("keydown", (event) => {
      if (!this.#picking || !["Enter", "Escape"].includes(event.key)) return;
      // The field that gets the focus would take the key, and send the form.
      event.preventDefault();
      if (event.key === "Enter") this.#place(this.map.getCenter());
      else this.#pick(false);
    });
  }

  async send(command: Command): Promise<void> {
    const instance = daemon.get()?.instance;
    if (!instance) return;
    const name = typeof command === "string" ? command : "set" in command ? "set points" : "go to";
    tell(this.#result, `${name}: sent`);
    try {
      const tick = await sendCommand(instance, command);
      tell(this.#result, `${name}: carried out at tick ${tick}`, "good");
    } catch (error) {
      tell(this.#result, `${name} refused: ${inUnits(message(error)).replace(/^refused: /, "")}`, "bad");
    }
  }

  #pick(on: boolean): void {
    this.#picking = on;
    this.#goTo.setAttribute("aria-pressed", String(on));
    setClass(this.map.getContainer(), "picking", on);
    if (this.#target.contains(document.activeElement)) this.#goTo.focus();
    setClass(this.#target, "hidden", true);
    this.#marker?.remove();
    this.#marker = null;
    tell(this.#result, on ? "Tap the map where to fly, or press Enter on it for its centre." : "");
  }

  #place(at: L.LatLng): void {
    this.#marker?.remove();
    this.#marker = L.circleMarker(at, { radius: 9, color: "#d94fe6", weight: 3, fillOpacity: 0.2, interactive: false }).addTo(this.map);
    const place = toPlace(at);
    setText(this.#where, `${place.latitude_deg.toFixed(5)}°, ${place.longitude_deg.toFixed(5)}°`);
    setText(this.#altitude_unit, `${unitOf("altitude")} above sea level`);
    if (this.#altitude.value === "") this.#altitude.value = toShown("altitude", this.#phase.altitude_m).toFixed(0);
    setClass(this.#target, "hidden", false);
    this.#altitude.focus();
  }

  #flyThere(): void {
    if (!this.#marker || this.#altitude.value === "") return;
    const place = toPlace(this.#marker.getLatLng());
    const altitude_m = toSi("altitude", Number(this.#altitude.value));
    this.#pick(false);
    this.#altitude.value = "";
    void this.send({ go_to: { ...place, altitude_m } });
  }

  show(phase: FlightPhase): void {
    this.#phase = phase;
    const may = writable.get() && phase.fresh;
    const { engaged, mode } = phase;
    const label = phase.landed ? "Landed: slide to disengage" : engaged ? "Slide to disengage" : phase.inhibits.length > 0 ? "Engaging is inhibited" : "Slide to engage";
    this.#slide.set(writable.get() ? label : "View only: open the printed link", may && (engaged || phase.inhibits.length === 0), engaged ? "stop" : "go");
    this.#pause.disabled = !(may && engaged && mode !== "loiter");
    this.#resume.disabled = !(may && engaged && ["loiter", "go to", "return", "hold"].includes(mode));
    for (const one of [this.#goTo, ...this.#others]) one.disabled = !(may && engaged);
    if (this.#picking && !engaged) this.#pick(false);
    // A disabled button would lose the focus.
    const at = document.activeElement;
    if (at instanceof HTMLButtonElement && at.disabled && this.element.contains(at)) ([this.#pause, this.#resume].find((one) => !one.disabled) ?? this.#slide.element).focus();
  }
}
