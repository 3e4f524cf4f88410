/** Undo and redo of every edit: plans as they were. */

import { same, type Plan } from "./model";

const DEPTH = 500;
type Step = { plan: Plan; what: string };

export class History {
  #past: Step[] = [];
  #future: Step[] = [];

  constructor(private plan: Plan) {}

  get current(): Plan {
    return this.plan;
  }
  get undoes(): string | null {
    return this.#past.at(-1)?.what ?? null;
  }
  get redoes(): string | null {
    return this.#future.at(-1)?.what ?? null;
  }

  /** `what` names the edit, as in "Undo: move item 3". Says whether anything changed. */
  edit(plan: Plan, what: string): boolean {
    if (same(plan, this.plan)) return false;
    this.#past.push({ plan: this.plan, what });
    if (this.#past.length > DEPTH) this.#past.shift();
    this.#future = [];
    this.plan = plan;
    return true;
  }

  undo = (): string | null => this.#step(this.#past, this.#future);
  redo = (): string | null => this.#step(this.#future, this.#past);

  #step(from: Step[], to: Step[]): string | null {
    const step = from.pop();
    if (!step) return null;
    to.push({ plan: this.plan, what: step.what });
    this.plan = step.plan;
    return step.what;
  }
}
