/** The vehicle's plan beside the draft, and the upload. */

import { commandEnvelope, getJson, message, part, postJson, type VehiclePlan } from "../../core/api";
import { button, h, setClass, setText, tell } from "../../core/dom";
import { duration, utc } from "../../core/units";
import { daemon } from "../../live/session";
import type { DraftEditor } from "../../plan/draft";

const EVERY_MS = 3000;

export interface VehicleState {
  errors: number;
  checked_hash: string | null;
}

export class Vehicle {
  readonly element = h("section", { class: "panel vehicle", "aria-label": "Vehicle's plan" });
  plan: VehiclePlan | null = null;
  readonly #summary = h("p", { class: "vehicle-text" });
  readonly #differs = h("p", { class: "differs", role: "status" });
  readonly #result = h("p", { class: "result", role: "status" });
  readonly #upload = button("Upload to vehicle", () => void this.#send(), { icon: "upload", class: "button primary" });
  readonly #take = button("Copy into draft", () => this.take(), { icon: "download" });
  readonly #timer = setInterval(() => void this.refresh(), EVERY_MS);
  #draft: DraftEditor | null = null;
  #state: VehicleState = { errors: 0, checked_hash: null };
  #sending = false;

  constructor(
    private readonly changed: () => void,
    private readonly may: () => boolean,
  ) {
    this.element.append(h("div", { class: "row end" }, h("h2", {}, "Vehicle"), this.#differs), this.#summary, h("div", { class: "row" }, this.#upload, this.#take), this.#result);
    void this.refresh();
  }

  close(): void {
    clearInterval(this.#timer);
  }

  async refresh(): Promise<void> {
    const instance = daemon.get()?.instance;
    try {
      const found = instance ? await getJson<VehiclePlan | null>(`/live/${part(instance)}/plan`) : null;
      const other = found?.hash !== this.plan?.hash || found?.uploaded_utc_s !== this.plan?.uploaded_utc_s;
      this.plan = found;
      if (other) this.changed();
      this.#show();
    } catch (error) {
      setText(this.#summary, `The vehicle's plan is not known: ${message(error)}`);
    }
  }

  show(draft: DraftEditor | null, state: VehicleState): void {
    this.#draft = draft;
    this.#state = state;
    this.#show();
  }

  /** The vehicle's plan replaces the draft's content; it can be undone. */
  take(): void {
    if (this.plan?.plan) this.#draft?.edit(this.plan.plan, "copy the vehicle's plan");
  }

  #show(): void {
    const { plan } = this;
    const age = plan ? Date.now() / 1000 - plan.uploaded_utc_s : NaN;
    const ago = age < 100 ? `${Math.max(0, age).toFixed(0)} s ago` : age < 86_400 ? `${duration(age)} ago` : utc(plan?.uploaded_utc_s ?? 0);
    const items = plan?.plan ? `${plan.plan.items.length} items` : "content not known to the station";
    setText(this.#summary, plan ? `Plan ${plan.hash}, ${items}, loaded ${ago}` : daemon.get() ? "The vehicle has no plan." : "No vehicle is connected.");
    const hash = this.#state.checked_hash ?? this.#draft?.hash ?? null;
    const same = plan !== null && hash !== null && plan.hash === hash;
    setText(this.#differs, !this.#draft || !plan ? "" : same ? "Draft is the vehicle's plan" : "Draft differs from vehicle");
    this.#differs.dataset["tone"] = same ? "good" : "remark";
    const { errors } = this.#state;
    const saved = this.#draft?.state === "saved";
    this.#upload.disabled = !this.may() || !this.#draft || errors > 0 || !saved || this.#sending || !daemon.get();
    this.#upload.title = errors > 0 ? `Correct ${errors} ${errors === 1 ? "error" : "errors"} first` : !saved ? "The draft is not saved yet" : "Checked, sent and read back as one action";
    this.#take.disabled = !this.may() || !plan?.plan || same;
    setClass(this.#take, "hidden", !plan?.plan);
  }

  async #send(): Promise<void> {
    const draft = this.#draft;
    const instance = daemon.get()?.instance;
    if (!draft || !instance) return;
    this.#sending = true;
    tell(this.#result, "Uploading, and reading back …");
    this.#show();
    try {
      const answer = await postJson<{ hash: string }>(`/live/${part(instance)}/plan`, { draft: draft.name, revision: draft.revision, item: 1, ...commandEnvelope() });
      tell(this.#result, `Uploaded and read back: the vehicle has plan ${answer.hash}.`, "good");
    } catch (error) {
      tell(this.#result, `Not uploaded, the vehicle keeps its plan: ${message(error)}`, "bad");
    } finally {
      this.#sending = false;
      await this.refresh();
    }
  }
}
