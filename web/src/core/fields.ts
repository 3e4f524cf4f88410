/** Fields of tables. Each keeps a key, so that the focus survives a new table. */

import { h } from "./dom";
import { digitsOf, toShown, toSi, unitOf, type Quantity } from "./units";

export interface NumberField {
  key: string;
  label: string;
  value: number | null;
  digits: number;
  /** Zeros at the end are shown. */
  fixed?: boolean;
  /** Without it an empty field is set back. */
  empty?: string;
  lowest?: number;
  highest?: number;
  step?: number;
  changed: (value: number | null) => void;
  disabled?: boolean;
  class?: string;
}

const text = (value: number | null, digits: number): string => (value === null ? "" : String(Number(value.toFixed(digits))));

export function numberField(field: NumberField): HTMLInputElement {
  const before = field.fixed && field.value !== null ? field.value.toFixed(field.digits) : text(field.value, field.digits);
  const input = h("input", {
    type: "number", class: `number ${field.class ?? ""}`, "data-key": field.key, "aria-label": field.label, step: field.step ?? "any",
    min: field.lowest ?? null, max: field.highest ?? null, placeholder: field.empty ?? null, value: before, disabled: field.disabled ?? false, inputmode: "decimal",
  });
  input.addEventListener("change", () => {
    if (input.value === before) return;
    if (input.value.trim() === "") {
      if (field.empty === undefined) input.value = before;
      else field.changed(null);
      return;
    }
    const value = Number(input.value);
    if (!Number.isFinite(value) || !input.checkValidity()) {
      input.reportValidity();
      input.value = before;
      return;
    }
    field.changed(value);
  });
  return input;
}

/** In the chosen units, with the unit beside it. */
export function quantityField(quantity: Quantity, field: Omit<NumberField, "digits">): HTMLElement {
  const digits = digitsOf(quantity);
  const { lowest, highest, ...rest } = field;
  const input = numberField({
    ...rest,
    label: `${field.label}, ${unitOf(quantity)}`,
    value: field.value === null ? null : toShown(quantity, field.value),
    digits,
    ...(lowest === undefined ? {} : { lowest: toShown(quantity, lowest) }),
    ...(highest === undefined ? {} : { highest: toShown(quantity, highest) }),
    changed: (value) => field.changed(value === null ? null : toSi(quantity, value)),
  });
  return h("span", { class: "field" }, input, h("span", { class: "unit" }, unitOf(quantity)));
}

export function selectField<T extends string>(
  key: string, label: string, value: T, options: readonly (readonly [T, string])[], changed: (value: T) => void, disabled = false,
): HTMLSelectElement {
  const select = h("select", { "data-key": key, "aria-label": label, disabled }, ...options.map(([one, name]) => h("option", { value: one }, name)));
  select.value = value;
  select.addEventListener("change", () => changed(select.value as T));
  return select;
}

/** Replaces children, and gives the focus back to the field of the same key. */
export function keepingFocus(root: HTMLElement, rebuild: () => void): void {
  const active = document.activeElement;
  const key = active instanceof HTMLElement && root.contains(active) ? active.dataset["key"] : undefined;
  const scroll = root.scrollTop;
  rebuild();
  root.scrollTop = scroll;
  if (key === undefined) return;
  const again = root.querySelector<HTMLElement>(`[data-key="${CSS.escape(key)}"]`);
  again?.focus({ preventScroll: true });
  if (again instanceof HTMLInputElement) again.select();
}
