// Form fields with a visible label: combo boxes, numbers, check boxes, groups.

import { html, nothing, type TemplateResult } from "lit-html";
import { live } from "lit-html/directives/live.js";
import { ref } from "lit-html/directives/ref.js";
import { what, type Term } from "./what.ts";

export interface Option {
  value: string;
  text: string;
  title?: string;
  /** Why it cannot be chosen now. */
  reason?: string | null;
}

let count = 0;
const ids = new Map<string, string>();

/** A stable id for an element that another one names. */
export function idOf(name: string): string {
  let id = ids.get(name);
  if (!id) ids.set(name, (id = `f${(count += 1)}`));
  return id;
}

/** The reason why a field is disabled, as its description. */
function reasonOf(key: string, reason: string | null | undefined) {
  if (!reason) return { id: nothing, template: nothing } as const;
  const id = idOf(`reason ${key}`);
  return { id, template: html`<span class="hidden" id=${id}>${reason}</span>` } as const;
}

/** A field with the button that explains its label. */
const explained = (field: TemplateResult, label: string, term: Term | undefined): TemplateResult =>
  term ? html`<div class="explained">${field}${what(term, label)}</div>` : field;

export function combo(
  label: string,
  value: string,
  options: Option[],
  change: (value: string) => void,
  more: { reason?: string | null; key?: string; term?: Term } = {},
): TemplateResult {
  const reason = reasonOf(more.key ?? label, more.reason);
  const title = more.reason ?? options.find((o) => o.value === value)?.title ?? "";
  const field = html`<label class="field" title=${title}>
    <span class="label">${label}</span>
    <select
      ?disabled=${Boolean(more.reason)}
      aria-describedby=${reason.id}
      @change=${(e: Event) => change((e.target as HTMLSelectElement).value)}
    >
      ${options.map(
        (o) =>
          html`<option value=${o.value} .selected=${live(o.value === value)} ?disabled=${Boolean(o.reason)} title=${o.reason ?? o.title ?? ""}>
            ${o.text}
          </option>`,
      )}
    </select></label
    >${reason.template}`;
  return explained(field, label, more.term);
}

/** A number as it is typed: short, with a decimal point. */
export const typed = (value: number) => String(Number(value.toPrecision(7)));

export interface NumberRange {
  min?: number;
  max?: number;
  step?: number;
  /** The accessible name, where it says more than the label. */
  name?: string;
  reason?: string | null;
  key?: string;
  term?: Term;
}

export function spin(label: string, value: number | null, change: (value: number) => void, range: NumberRange = {}): TemplateResult {
  const text = value === null || !Number.isFinite(value) ? "" : typed(value);
  const reason = reasonOf(range.key ?? range.name ?? label, range.reason);
  const { min = -Infinity, max = Infinity } = range;
  const take = (e: Event) => {
    const { value, valueAsNumber } = e.target as HTMLInputElement;
    if (value !== "" && valueAsNumber >= min && valueAsNumber <= max) change(valueAsNumber);
  };
  // What is being typed is not overwritten.
  const show = (e: Element | undefined) => {
    const input = e as HTMLInputElement | undefined;
    if (input && document.activeElement !== input && input.value !== text) input.value = text;
  };
  const restore = (e: Event) => {
    const input = e.target as HTMLInputElement;
    if (input.value === "" || !input.validity.valid) input.value = text;
  };
  const field = html`<label class="field number">
    <span class="label">${label}</span>
    <input
      type="number"
      aria-label=${range.name ?? nothing}
      min=${range.min ?? nothing}
      max=${range.max ?? nothing}
      step=${range.step ?? "any"}
      title=${Number.isFinite(min) && Number.isFinite(max) ? `${typed(min)} … ${typed(max)}` : nothing}
      ?disabled=${Boolean(range.reason)}
      aria-describedby=${reason.id}
      @input=${take}
      @blur=${restore}
      ${ref(show)}
    /></label
    >${reason.template}`;
  return explained(field, range.name ?? label, range.term);
}

export function check(
  label: string,
  isChecked: boolean,
  change: (value: boolean) => void,
  more: { reason?: string | null; key?: string; title?: string; term?: Term } = {},
): TemplateResult {
  const reason = reasonOf(more.key ?? label, more.reason);
  const field = html`<label class="check" title=${more.reason ?? more.title ?? ""}>
    <input
      type="checkbox"
      .checked=${live(isChecked)}
      ?disabled=${Boolean(more.reason)}
      aria-describedby=${reason.id}
      @change=${(e: Event) => change((e.target as HTMLInputElement).checked)}
    />
    <span>${label}</span></label
    >${reason.template}`;
  return explained(field, label, more.term);
}

export function radio(label: string, name: string, isChecked: boolean, choose: () => void, term?: Term, against: string | null = null): TemplateResult {
  const reason = reasonOf(`${name} ${label}`, against);
  const field = html`<label class="check" title=${against ?? nothing}>
      <input type="radio" name=${name} .checked=${live(isChecked)} ?disabled=${against !== null} aria-describedby=${reason.id} @change=${choose} />
      <span>${label}</span></label
    >${reason.template}`;
  return explained(field, label, term);
}

export function group(legend: string, content: unknown, style = "", term?: Term, word = legend): TemplateResult {
  return html`<fieldset class=${style}>
    <legend>${legend}</legend>
    ${term ? what(term, word) : nothing}
    <div class="inside">${content}</div>
  </fieldset>`;
}

export function button(label: string, action: (e: Event) => void, more: { icon?: unknown; disabled?: boolean; pressed?: boolean; style?: string } = {}) {
  const isIcon = more.icon !== undefined;
  return html`<button
    type="button"
    class=${more.style ?? (isIcon ? "icon" : "")}
    aria-label=${isIcon ? label : nothing}
    title=${isIcon ? label : nothing}
    aria-pressed=${more.pressed === undefined ? nothing : String(more.pressed)}
    ?disabled=${more.disabled ?? false}
    @click=${action}
  >
    ${isIcon ? more.icon : label}
  </button>`;
}
