// Icons of buttons, drawn on a grid of 24.

import { html, svg, type TemplateResult } from "lit-html";

const PATHS = {
  left: "M20 12H5m6-6-6 6 6 6",
  right: "M4 12h15m-6-6 6 6-6 6",
  up: "M12 20V5m-6 6 6-6 6 6",
  down: "M12 4v15m-6-6 6 6 6-6",
  in: "M11 7v8m-4-4h8m1 5 5 5M11 4a7 7 0 1 0 0 14 7 7 0 0 0 0-14",
  out: "M7 11h8m1 5 5 5M11 4a7 7 0 1 0 0 14 7 7 0 0 0 0-14",
  reset: "M4 12a8 8 0 1 0 3-6.2M4 4v4h4",
  first: "M6 5v14M19 5l-9 7 9 7z",
  previous: "M17 5l-9 7 9 7z",
  play: "M8 5l11 7-11 7z",
  pause: "M8 5v14M16 5v14",
  next: "M7 5l9 7-9 7z",
  finished: "M3 5h18v14H3zM3 16l5-5 4 4 3-3 6 5",
  aside: "M4 12h16M8 8l-4 4 4 4M16 8l4 4-4 4",
  last: "M18 5v14M5 5l9 7-9 7z",
} as const;

export function icon(name: keyof typeof PATHS): TemplateResult {
  return html`<svg class="glyph" viewBox="0 0 24 24" aria-hidden="true">${svg`<path d=${PATHS[name]} />`}</svg>`;
}
