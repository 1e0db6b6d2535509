// The sheet that structures are drawn on: an image with its legend. Its units are pixels at the
// width that the column of regions has.

import { html, nothing, svg, type TemplateResult } from "lit-html";
import type { App } from "../../app.ts";
import { number } from "../../parts/numbers.ts";
import { chooseShape, chosenPath } from "../chosen.ts";

/** Units that a sheet is wide. */
export const WIDTH = 320;

export interface Sheet {
  name: string;
  height: number;
  content: unknown;
  /** A class of the style sheet and its word. */
  legend: [string, string][];
  note?: string;
  /** What a click chooses; otherwise what the shape under it says. */
  click?: (e: MouseEvent) => void;
}

export function sheet(app: App, s: Sheet): TemplateResult {
  const click = s.click ?? ((e: MouseEvent) => chooseShape(app, e));
  return html`<figure class="sheet">
    <svg role="img" aria-label=${s.name} viewBox="0 0 ${WIDTH} ${s.height}" @click=${click}>${s.content}</svg>
    <figcaption>
      ${s.legend.length
        ? html`<span class="legend">${s.legend.map(([style, word]) => html`<span><i class=${`swatch ${style}`} aria-hidden="true"></i>${word}</span>`)}</span>`
        : nothing}
      ${s.note ? html`<span class="note">${s.note}</span>` : nothing}
    </figcaption>
  </figure>`;
}

/** A number of a drawing, short. */
export const short = (v: number) => number(Number(v.toFixed(2)));

export interface Area {
  x: number;
  y: number;
  width: number;
  height: number;
}

/** A part of the picture on a sheet: shapes in it are in the picture's pixels. */
export interface Map {
  scale: number;
  height: number;
  shapes(content: unknown): TemplateResult;
  /** The place of a pixel on the sheet. */
  at(x: number, y: number): [number, number];
  /** The pixel of a click. */
  pixelOf(e: MouseEvent): [number, number];
}

/** The picture, or an area of it, as wide as the sheet; the chosen facet is outlined. */
export function pictureMap(app: App, area: Area = { x: 0, y: 0, width: app.width, height: app.height }, more = 0): Map {
  // A high picture leaves room at its sides.
  const scale = Math.min(WIDTH / area.width, 300 / area.height);
  const left = (WIDTH - area.width * scale) / 2;
  const at = (x: number, y: number): [number, number] => [left + (x - area.x) * scale, (y - area.y) * scale];
  const height = area.height * scale;
  return {
    scale,
    height: height + more,
    at,
    shapes: (content) => svg`<svg x=${short(left)} y="0" width=${short(area.width * scale)} height=${short(height)}
        viewBox=${[area.x, area.y, area.width, area.height].map(short).join(" ")} preserveAspectRatio="none">
      <rect class="ground" x=${area.x} y=${area.y} width=${area.width} height=${area.height} />
      ${content}
      ${chosenPath(app) ? svg`<path class="chosen" d=${chosenPath(app)} />` : nothing}
    </svg>`,
    pixelOf: (e) => {
      const box = (e.currentTarget as Element).getBoundingClientRect();
      const unit = box.width / WIDTH;
      return [area.x + ((e.clientX - box.left) / unit - left) / scale, area.y + (e.clientY - box.top) / unit / scale];
    },
  };
}

/** Entries round the present one, at most so many, and how many are left out on both sides. */
export function around<T>(all: T[], at: number, most: number): { shown: T[]; first: number; before: number; after: number } {
  const first = Math.max(0, Math.min(at - Math.floor(most / 2), all.length - most));
  const shown = all.slice(first, first + most);
  return { shown, first, before: first, after: all.length - first - shown.length };
}
