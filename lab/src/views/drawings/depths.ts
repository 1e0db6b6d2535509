// Drawings of depths: the square of samples of the z-buffer, the depths that brute force compares.

import { svg, type TemplateResult } from "lit-html";
import type { Step } from "../../answers.ts";
import type { App } from "../../app.ts";
import type { Json, JsonObject } from "../../json.ts";
import { t } from "../../words.ts";
import { isChosen } from "../chosen.ts";
import { leftOut, list, numbers, objects } from "../recorded.ts";
import { pictureMap, sheet, short, WIDTH } from "./sheet.ts";

const CELL = 15;

/** The samples round the pixel before and after a facet came; without a pixel, where it stays. */
export function depthsDrawing(app: App, step: Step): TemplateResult {
  const { depths: d, fields: f } = step;
  if (!d || !Array.isArray(d["before"])) return runsDrawing(app, f);
  const size = Number(d["size"]);
  const [before, after] = [numbers(d["before"]), numbers(d["after"])];
  const there = [...before, ...after].filter((v) => v > 0);
  const [low, high] = [Math.min(...there), Math.max(...there)];

  // The nearer a sample, the lighter its square.
  const grey = (v: number) => {
    const level = Math.round(60 + 185 * (high > low ? (v - low) / (high - low) : 1));
    return `rgb(${level},${level},${level})`;
  };
  const square = (values: number[], left: number) =>
    values.map((v, i) => {
      const [x, y] = [i % size, Math.floor(i / size)];
      const isChanged = before[i] !== after[i];
      const title = `${Number(d["x"]) + x}, ${Number(d["y"]) + y}: ${v > 0 ? v.toFixed(5) : "–"}`;
      return svg`<rect class=${`${v > 0 ? "" : "nothing"}${isChanged ? " changed" : ""}`} x=${left + x * CELL + (isChanged ? 1 : 0)} y=${22 + y * CELL + (isChanged ? 1 : 0)}
        width=${CELL - (isChanged ? 2 : 0)} height=${CELL - (isChanged ? 2 : 0)} fill=${v > 0 ? grey(v) : "#000"} data-facet=${isChanged ? String(f["facet"]) : ""}><title>${title}</title></rect>`;
    });
  const side = size * CELL;
  const right = WIDTH - side - 6;
  const middle = 22 + side / 2;
  const mark = (left: number) => svg`<circle class="pixel-mark" cx=${left + side / 2} cy=${middle} r="3.5" />`;
  return sheet(app, {
    name: t("Drawing of the depths"),
    height: side + 28,
    content: svg`<text x="6" y="15">${t("before")}</text><text x=${right} y="15">${t("after")}</text>
      ${square(before, 6)} ${square(after, right)} ${mark(6)} ${mark(right)}
      <path class="arrow" d="M${6 + side + 6} ${middle}H${right - 8}m-5 -4l5 4l-5 4" />`,
    legend: [
      ["d-near", t("near: light")],
      ["d-far", t("far: dark")],
      ["d-nothing", t("nothing there")],
      ["d-changed", t("changed")],
      ["d-pixel", t("the pixel")],
    ],
  });
}

/** Where in the picture a facet is nearer than what was there, and where it is hidden. */
function runsDrawing(app: App, f: JsonObject): TemplateResult {
  const map = pictureMap(app);
  const path = (runs: Json | undefined) =>
    list(runs)
      .map((r) => numbers(r))
      .map(([row = 0, from = 0, to = 0]) => `M${from} ${row}h${to - from}v1H${from}z`)
      .join("");
  return sheet(app, {
    name: t("Drawing of the depths"),
    height: map.height,
    content: map.shapes(svg`<path class="hidden-runs" data-facet=${String(f["facet"])} d=${path(f["hidden"])} />
      <path class="stays-runs" data-facet=${String(f["facet"])} d=${path(f["stays"])} />`),
    legend: [
      ["stays", t("stays")],
      ["hidden", t("hidden")],
    ],
  });
}

/** Facets that are drawn on the axis of depth. */
const MOST = 16;
const ROW = 17;

/** Every facet over the sample on an axis of depth; without a pixel, the block of rays. */
export function bruteForceDrawing(app: App, step: Step): TemplateResult {
  const all = objects(step.depths?.["facets"]).sort((a, b) => Number(b["depth"]) - Number(a["depth"]));
  if (!step.depths) return blockDrawing(app, step, t("Drawing of the depths"));
  const shown = all.slice(0, MOST);
  const [left, right] = [78, WIDTH - 16];
  const X = (depth: number) => left + depth * (right - left);
  const height = 24 + Math.max(1, shown.length) * ROW + 16;
  const row = (f: JsonObject, i: number) => {
    const [y, depth] = [24 + i * ROW + ROW / 2, Number(f["depth"])];
    const style = `${i === 0 ? "nearest" : "behind"}${isChosen(app, f["facet"]) ? " chosen" : ""}`;
    return svg`<g class=${style} data-facet=${String(f["facet"])}><rect class="hit" x="0" y=${y - ROW / 2} width=${WIDTH} height=${ROW} />
      <text x="4" y=${y + 4}>${t("facet {0}", Number(f["facet"]))}</text><path d="M${left} ${y}H${short(X(depth))}" /><circle cx=${short(X(depth))} cy=${y} r="4.5" /></g>`;
  };
  return sheet(app, {
    name: t("Drawing of the depths"),
    height,
    content: svg`<g class="axis-of-depth"><text x=${left - 6} y="13">0 ${t("far")}</text><text x=${right + 8} y="13" text-anchor="end">1 ${t("near")}</text>
      <path class="axis" d="M${left} 20V${height - 12}M${right} 20V${height - 12}M${left} 20H${right}" />${shown.map(row)}</g>`,
    legend: all.length
      ? [
          ["d-nearest", t("nearest")],
          ["d-behind", t("hidden")],
        ]
      : [],
    note: all.length ? leftOut(0, all.length - shown.length) : t("No facet lies over the pixel."),
  });
}

/** The block of pixels whose rays were followed. */
export function blockDrawing(app: App, step: Step, name: string): TemplateResult {
  const map = pictureMap(app);
  const [x = 0, y = 0, width = 0, height = 0] = numbers(step.fields["pixels"]);
  return sheet(app, {
    name,
    height: map.height,
    content: map.shapes(svg`<rect class="block" x=${x} y=${y} width=${width} height=${height} />`),
    legend: [["rays", t("rays")]],
  });
}
