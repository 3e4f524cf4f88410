/**
 * A draft on the board: saved at each edit, shared with other pages. An edit that the
 * board has not confirmed yet is kept in the browser, so that a reload, a crash or a
 * cut network loses none.
 */

import { getJson, message, part, Refused, request, socketUrl, type Draft } from "../core/api";
import { History } from "./history";
import { emptyPlan, same, type Plan } from "./model";
import { pauseBefore } from "../live/connection";

export type SaveState = "saved" | "saving" | "not saved" | "conflict" | "read only";

/** What of `sent` has arrived is not known. */
type Unconfirmed = { based_on: number; plan: Plan; sent?: Plan[] };

const MOST_SENT = 20;
const key = (name: string) => `fcc.draft.${name}`;

function unconfirmed(name: string): Unconfirmed | null {
  try {
    return JSON.parse(localStorage.getItem(key(name)) ?? "null") as Unconfirmed | null;
  } catch {
    return null;
  }
}

export class DraftEditor {
  history: History;
  state: SaveState = "saved";
  /** Why it is not saved. */
  reason = "";
  /** The board's newer draft, while there is a conflict. */
  theirs: Draft | null = null;
  hash = "";
  /** Since the board's last answer. */
  #sent: Plan[] = [];
  #saving = false;
  #retry: ReturnType<typeof setTimeout> | undefined;
  #attempt = 0;
  #closed = false;

  private constructor(
    readonly name: string,
    public revision: number,
    /** As the board has it. */
    private confirmed: Plan,
    private readonly changed: (editor: DraftEditor) => void,
  ) {
    this.history = new History(confirmed);
  }

  /** `listed`: the board has it; otherwise it is on the board from the first edit on. */
  static async open(name: string, listed: boolean, changed: (editor: DraftEditor) => void): Promise<DraftEditor> {
    let found: Draft | null = null;
    try {
      if (listed) found = await getJson<Draft>(`/drafts/${part(name)}`);
    } catch (error) {
      const gone = error instanceof Refused && error.status === 404;
      if (!gone && !(error instanceof Refused && error.status === 0 && unconfirmed(name))) throw error;
    }
    const pending = unconfirmed(name);
    const editor = new DraftEditor(name, found?.revision ?? pending?.based_on ?? 0, found?.plan ?? emptyPlan(), changed);
    editor.hash = found?.hash ?? "";
    if (pending && !same(pending.plan, editor.confirmed)) {
      editor.history.edit(pending.plan, "edits that were not saved");
      editor.#sent = pending.sent ?? [];
      if (found && found.revision !== pending.based_on && !editor.#isOwn(found.plan)) {
        editor.theirs = found;
        editor.state = "conflict";
      } else editor.#save();
    } else localStorage.removeItem(key(name));
    return editor;
  }

  get plan(): Plan {
    return this.history.current;
  }

  edit(plan: Plan, what: string): void {
    if (!this.history.edit(plan, what)) return;
    this.#keepAndSave();
  }

  undo = (): void => void (this.history.undo() !== null && this.#keepAndSave());
  redo = (): void => void (this.history.redo() !== null && this.#keepAndSave());

  /** It was sent from here, and only the answer was lost: not another page's edit. */
  #isOwn = (found: Plan): boolean => this.#sent.some((sent) => same(found, sent));

  #keepAndSave(): void {
    this.#keep();
    if (this.state !== "conflict") this.#save();
    this.changed(this);
  }

  #keep(): void {
    try {
      const pending: Unconfirmed = { based_on: this.revision, plan: this.plan, sent: this.#sent };
      localStorage.setItem(key(this.name), JSON.stringify(pending));
    } catch {
      // A browser without storage relies on the board alone.
    }
  }

  #save(): void {
    if (this.#saving || this.#closed) return;
    clearTimeout(this.#retry);
    void this.#send();
  }

  async #send(): Promise<void> {
    this.#saving = true;
    this.state = "saving";
    this.changed(this);
    const plan = this.plan;
    this.#sent = [...this.#sent.slice(-MOST_SENT), plan];
    this.#keep();
    try {
      const answer = await request("PUT", `/drafts/${part(this.name)}`, { based_on: this.revision, plan });
      const saved = (await answer.json()) as Draft;
      this.revision = saved.revision;
      this.hash = saved.hash;
      this.confirmed = plan;
      this.#sent = [];
      this.#attempt = 0;
      this.state = "saved";
      this.reason = "";
      if (this.plan === plan) localStorage.removeItem(key(this.name));
      else this.#keep();
    } catch (error) {
      await this.#failed(error);
    } finally {
      this.#saving = false;
    }
    if (this.state === "saved" && this.plan !== plan) this.#save();
    this.changed(this);
  }

  async #failed(error: unknown): Promise<void> {
    this.reason = message(error);
    if (error instanceof Refused && error.status === 409) {
      try {
        const theirs = await getJson<Draft>(`/drafts/${part(this.name)}`);
        if (this.#isOwn(theirs.plan)) {
          this.#adopt(theirs);
          this.state = same(theirs.plan, this.plan) ? "saved" : "not saved";
          if (this.state !== "saved") this.#retry = setTimeout(() => this.#save(), 0);
          return;
        }
        this.theirs = theirs;
        this.state = "conflict";
        return;
      } catch (again) {
        this.reason = message(again);
      }
    }
    if (error instanceof Refused && error.status === 401) {
      this.state = "read only";
      return;
    }
    this.state = "not saved";
    this.#retry = setTimeout(() => this.#save(), pauseBefore(this.#attempt, Math.random()));
    this.#attempt += 1;
  }

  #adopt(draft: Draft): void {
    this.revision = draft.revision;
    this.hash = draft.hash;
    this.confirmed = draft.plan;
    this.#sent = [];
  }

  /** The board has this revision now, by another page or by this one. */
  async follow(revision: number): Promise<void> {
    if (revision <= this.revision || this.#saving || this.state === "conflict") return;
    const theirs = await getJson<Draft>(`/drafts/${part(this.name)}`);
    if (theirs.revision <= this.revision) return;
    if (same(this.plan, this.confirmed)) {
      this.#adopt(theirs);
      this.history.edit(theirs.plan, "a change by another page");
      this.state = "saved";
    } else {
      this.theirs = theirs;
      this.state = "conflict";
    }
    this.changed(this);
  }

  /** Ends a conflict: this page's plan replaces the board's, or the other way round. */
  resolve(keep: "mine" | "theirs"): void {
    const theirs = this.theirs;
    if (!theirs) return;
    this.#adopt(theirs);
    this.theirs = null;
    this.state = "saved";
    if (keep === "theirs") {
      this.history.edit(theirs.plan, "the board's draft");
      localStorage.removeItem(key(this.name));
    } else {
      this.#keep();
      this.#save();
    }
    this.changed(this);
  }

  close(): void {
    this.#closed = true;
    clearTimeout(this.#retry);
  }
}

/** Follows the changes of all drafts; returns what ends it. */
export function watchDrafts(changed: (name: string, revision: number | null) => void, reconnected: () => void): () => void {
  let socket: WebSocket | null = null;
  let timer: ReturnType<typeof setTimeout> | undefined;
  let attempt = 0;
  let closed = false;
  const open = () => {
    socket = new WebSocket(socketUrl("/drafts"));
    socket.onopen = () => {
      if (attempt > 0) reconnected();
      attempt = 0;
    };
    socket.onmessage = (event) => {
      try {
        const change = JSON.parse(String(event.data)) as { name: string; revision: number | null };
        changed(change.name, change.revision);
      } catch {
        // Not a change: ignored.
      }
    };
    socket.onclose = () => {
      if (closed) return;
      timer = setTimeout(open, pauseBefore(attempt, Math.random()));
      attempt += 1;
    };
  };
  open();
  return () => {
    closed = true;
    clearTimeout(timer);
    socket?.close();
  };
}
