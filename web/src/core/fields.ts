/** Fields of tables. Each keeps a key, so that the focus survives a new table. */

import { h, setText } from "./dom";
import { watched } from "./state";
import { digitsOf, toShown, toSi, unitOf, type Quantity } from "./units";

export interface NumberField {
  key: string;
  label: string;
  unit?: string;
  value: number | null;
  digits: number;
  /** Zeros at the end are shown. */
  fixed?: boolean;
  /** Without it an empty field is refused. */
  empty?: string;
  lowest?: number;
  highest?: number;
  step?: number;
  changed: (value: number | null) => void;
  disabled?: boolean;
  class?: string;
}

const text = (value: number | null, digits: number): string => (value === null ? "" : String(Number(value.toFixed(digits))));

/** What was typed and refused, by the keys of the fields: a new table shows it again. */
const typed = new Map<string, { text: string; before: string; why: string }>();
/** The newest, for who does not see the field. */
export const refusal = watched("");

/** Why it is refused and what to do, or null. */
function refused(field: NumberField, given: string): string | null {
  const { lowest = -Infinity, highest = Infinity, digits } = field;
  if (given === "") return field.empty === undefined ? "a number is needed" : null;
  const value = Number(given.replace(",", "."));
  if (!Number.isFinite(value)) return "type digits, as in 12.5";
  if (field.step === 1 && !Number.isInteger(value)) return "type a whole number";
  if (value >= lowest && value <= highest) return null;
  const limit = (one: number) => `${text(one, digits)}${field.unit ? ` ${field.unit}` : ""}`;
  return highest === Infinity ? `type ${limit(lowest)} or more` : `type ${limit(lowest)} to ${limit(highest)}`;
}

export function numberField(field: NumberField): HTMLElement {
  const before = field.fixed && field.value !== null ? field.value.toFixed(field.digits) : text(field.value, field.digits);
  const id = `why-${field.key}`;
  const input = h("input", {
    type: "text", class: `number ${field.class ?? ""}`, "data-key": field.key, "aria-label": field.label, "aria-describedby": id,
    placeholder: field.empty ?? null, disabled: field.disabled ?? false, inputmode: "decimal", autocomplete: "off",
  });
  const why = h("span", { class: "refused", id });
  const show = () => {
    let one = typed.get(field.key);
    if (one && one.before !== before) one = void typed.delete(field.key);
    input.defaultValue = input.value = one?.text ?? before;
    input.setAttribute("aria-invalid", String(one !== undefined));
    setText(why, one ? `${one.text || "Nothing"} is refused: ${one.why}. The plan keeps ${before || field.empty}; Esc brings it back.` : "");
  };
  const commit = () => {
    if (input.value === input.defaultValue) return;
    const given = input.value.trim();
    const reason = refused(field, given);
    typed.delete(field.key);
    if (reason !== null) typed.set(field.key, { text: given, before, why: reason });
    show();
    refusal.set(why.textContent && `${field.label}: ${why.textContent}`);
    if (reason !== null || given === before) return;
    // Until it is drawn anew.
    input.defaultValue = input.value = given;
    field.changed(given === "" ? null : Number(given.replace(",", ".")));
  };
  for (const end of ["change", "blur"]) input.addEventListener(end, commit);
  input.addEventListener("keydown", (event) => {
    if (event.key === "Enter") commit();
    if (event.key !== "Escape") return;
    typed.delete(field.key);
    show();
    refusal.set("");
  });
  show();
  return h("span", { class: "field" }, input, field.unit ? h("span", { class: "unit" }, field.unit) : null, why);
}

/** In the chosen units, with the unit beside it. */
export function quantityField(quantity: Quantity, field: Omit<NumberField, "digits">): HTMLElement {
  const unit = unitOf(quantity);
  const { lowest, highest, ...rest } = field;
  return numberField({
    ...rest,
    label: `${field.label}, ${unit}`,
    unit,
    value: field.value === null ? null : toShown(quantity, field.value),
    digits: digitsOf(quantity),
    ...(lowest === undefined ? {} : { lowest: toShown(quantity, lowest) }),
    ...(highest === undefined ? {} : { highest: toShown(quantity, highest) }),
    changed: (value) => field.changed(value === null ? null : toSi(quantity, value)),
  });
}

export function selectField<T extends string>(
  key: string, label: string, value: T, options: readonly (readonly [T, string])[], changed: (value: T) => void, disabled = false,
): HTMLSelectElement {
  const select = h("select", { "data-key": key, "aria-label": label, disabled }, ...options.map(([one, name]) => h("option", { value: one }, name)));
  select.value = value;
  select.addEventListener("change", () => changed(select.value as T));
  return select;
}

/** Replaces children, and gives the focus and what is typed back to the field of the same key. */
export function keepingFocus(root: HTMLElement, rebuild: () => void): void {
  const active = document.activeElement;
  const key = active instanceof HTMLElement && root.contains(active) ? active.dataset["key"] : undefined;
  const scroll = root.scrollTop;
  const typing = key !== undefined && active instanceof HTMLInputElement && active.value !== active.defaultValue ? { text: active.value, at: active.selectionStart, before: active.defaultValue } : null;
  // A field that is removed reports a change: what is typed is not given yet.
  if (typing) (active as HTMLInputElement).value = typing.before;
  rebuild();
  root.scrollTop = scroll;
  if (key === undefined) return;
  const again = root.querySelector<HTMLElement>(`[data-key="${CSS.escape(key)}"]`);
  again?.focus({ preventScroll: true });
  if (!(again instanceof HTMLInputElement)) return;
  again.select();
  if (typing?.before !== again.defaultValue) return;
  again.value = typing.text;
  again.setSelectionRange(typing.at, typing.at);
}
