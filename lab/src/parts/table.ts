// Tables. Long ones show a window of rows and tell how many there are.

import { html, nothing, type TemplateResult } from "lit-html";
import { ref } from "lit-html/directives/ref.js";
import type { Choice } from "./choice.ts";
import { css } from "./css.ts";
import { number } from "./numbers.ts";

export type Cell = string | number | boolean | null | undefined | TemplateResult;

export interface Table {
  name: string;
  columns: string[];
  rows: Cell[][];
  /** The row that is in force. */
  current?: number | undefined;
  /** What choosing each row does: its head is a button. */
  choices?: (row: number) => Choice | null;
  /** The row that is brought into view when it becomes another one. */
  shown?: number | undefined;
  /** Whether the first cell of a row is its head. */
  hasHeads?: boolean;
  caption?: boolean;
}

/** Tables of more rows show a window. */
const MOST_ROWS = 200;

/** Pixels a row of a windowed table is high: set in the style sheet, too. */
const ROW = 26;

const VISIBLE_ROWS = 24;

/** Where long tables are scrolled to. */
const offsets = new Map<string, number>();

/** The row of each long table that was brought into view last. */
const revealed = new Map<string, number>();

const cell = (value: Cell) => {
  if (value === null || value === undefined) return "–";
  if (typeof value === "number") return number(value);
  if (typeof value === "boolean") return value ? "✓" : "–";
  return value;
};

/** The button of a row or an entry. */
export const rowButton = ({ choose, isChosen }: Choice, content: unknown) =>
  html`<button type="button" class="row" aria-pressed=${isChosen === undefined ? nothing : String(isChosen)} @click=${choose}>${content}</button>`;

export function table(t: Table, changed: () => void = () => {}): TemplateResult {
  const isLong = t.rows.length > MOST_ROWS;
  const shown = t.shown ?? t.current ?? -1;
  const isElsewhere = isLong && shown >= 0 && revealed.get(t.name) !== shown;
  if (isElsewhere) offsets.set(t.name, Math.max(0, shown - 4));
  revealed.set(t.name, shown);
  const first = isLong ? Math.max(0, Math.min((offsets.get(t.name) ?? 0) - 20, t.rows.length - 80)) : 0;
  const rows = isLong ? t.rows.slice(first, first + 80) : t.rows;
  const row = (cells: Cell[], i: number) => {
    const index = first + i;
    const isCurrent = index === t.current;
    const [head, ...rest] = cells;
    const isNumber = (v: Cell) => (typeof v === "number" ? "n" : "");
    const choice = t.choices?.(index);
    const headCell = choice ? rowButton(choice, cell(head)) : cell(head);
    return html`<tr class=${`${isCurrent ? "current" : ""}${choice?.isChosen ? " chosen" : ""}`} aria-rowindex=${isLong ? index + 2 : nothing} aria-current=${isCurrent ? "true" : nothing}>
      ${t.hasHeads === false ? html`<td class=${isNumber(head)}>${headCell}</td>` : html`<th scope="row" class=${isNumber(head)}>${headCell}</th>`}
      ${rest.map((c) => html`<td class=${isNumber(c)}>${cell(c)}</td>`)}
    </tr>`;
  };
  const content = html`<table
    class=${isLong ? "long" : ""}
    aria-label=${t.caption ? nothing : t.name}
    aria-rowcount=${isLong ? t.rows.length + 1 : nothing}
    .style=${css(isLong ? { transform: `translateY(${first * ROW}px)` } : {})}
  >
    ${t.caption ? html`<caption>${t.name}</caption>` : nothing}
    <thead>
      <tr aria-rowindex=${isLong ? 1 : nothing}>
        ${t.columns.map((c, i) => html`<th scope="col" class=${typeof t.rows[0]?.[i] === "number" ? "n" : ""}>${c}</th>`)}
      </tr>
    </thead>
    <tbody>
      ${rows.map(row)}
    </tbody>
  </table>`;
  if (!isLong) {
    return html`<div class="scroll" tabindex="0" role="group" aria-label=${t.name}>${content}</div>`;
  }
  const scrolled = (e: Event) => {
    const at = Math.floor((e.target as HTMLElement).scrollTop / ROW);
    const before = offsets.get(t.name) ?? 0;
    offsets.set(t.name, at);
    if (Math.abs(at - before) > 10 || at - 20 < first || at + VISIBLE_ROWS > first + 80) changed();
  };
  const reveal = (e: Element | undefined) => {
    if (e && isElsewhere) setTimeout(() => (e.scrollTop = (offsets.get(t.name) ?? 0) * ROW));
  };
  return html`<div class="scroll windowed" tabindex="0" role="group" aria-label=${t.name} @scroll=${scrolled} ${ref(reveal)}>
    <div .style=${css({ height: `${(t.rows.length + 1) * ROW}px` })}>${content}</div>
  </div>`;
}
