// Drawing of Warnock's windows so far.

import { nothing, svg, type TemplateResult } from "lit-html";
import type { App } from "../../app.ts";
import type { JsonObject } from "../../json.ts";
import { t } from "../../words.ts";
import { choiceOf } from "../chosen.ts";
import { doneOf, list, numbers } from "../recorded.ts";
import { pictureMap, sheet, short } from "./sheet.ts";

const VERDICTS = ["cut", "empty", "one", "surrounded", "pixel"] as const;

/** Members of a list that brief steps have. */
const MOST_MEMBERS = 64;

/** Polygons of a window that are left, in a word. */
function polygonsLeft(w: JsonObject): string {
  const lists = ["contained", "intersecting", "surrounding"].map((k) => list(w[k]).length);
  const sum = lists.reduce((a, b) => a + b, 0);
  return lists.includes(MOST_MEMBERS) ? `${sum}+` : String(sum);
}

/** Windows that are one shape a verdict: only the last such portion changes from step to step. */
const PORTION = 1000;

function path(w: JsonObject): string {
  const [x = 0, y = 0, width = 0, height = 0] = numbers(w["pixels"]);
  return `M${x} ${y}h${width}v${height}h${-width}z`;
}

/** The classes and paths of whole portions, by their first windows. */
const paths = new WeakMap<JsonObject, { scale: number; shapes: [string, string][] }>();

function pathsOf(portion: JsonObject[], scale: number): [string, string][] {
  const first = portion[0]!;
  const known = paths.get(first);
  if (portion.length === PORTION && known?.scale === scale) return known.shapes;
  // Small windows have no outline: it would hide them.
  const parts = new Map<string, string[]>(VERDICTS.flatMap((v) => [[`window ${v}`, []], [`window ${v} small`, []]]));
  for (const w of portion) {
    const isSmall = Number((w["pixels"] as number[] | undefined)?.[2]) * scale < 6;
    if (!isSmall || w["verdict"] !== "cut") parts.get(`window ${String(w["verdict"])}${isSmall ? " small" : ""}`)?.push(path(w));
  }
  const shapes = [...parts].map(([style, all]): [string, string] => [style, all.join("")]);
  if (portion.length === PORTION) paths.set(first, { scale, shapes });
  return shapes;
}

/** Windows with room for a number, each list read once. */
const large = new WeakMap<JsonObject[], JsonObject[]>();

function largeOf(windows: JsonObject[], scale: number): JsonObject[] {
  let found = large.get(windows);
  const hasRoom = (w: JsonObject) => {
    const [, , width = 0, height = 0] = (w["pixels"] as number[] | undefined) ?? [];
    return width * scale >= 17 && height * scale >= 13;
  };
  if (!found) large.set(windows, (found = windows.filter(hasRoom)));
  return found;
}

export function quadtreeDrawing(app: App, present: JsonObject): TemplateResult {
  const map = pictureMap(app);
  const known = doneOf(app, "window");
  const windows = known.length ? known : [present];
  const portions: JsonObject[][] = [];
  for (let i = 0; i < windows.length; i += PORTION) portions.push(windows.slice(i, i + PORTION));
  const shapes = portions.map((p) => pathsOf(p, map.scale).map(([style, path]) => (path ? svg`<path class=${style} d=${path} />` : nothing)));

  // Count the polygons in windows with room for a number: those that were not cut, and the present one.
  const counts = largeOf(windows, map.scale)
    .filter((w) => w["verdict"] !== "cut" || w === windows[windows.length - 1])
    .slice(-400)
    .map((w) => {
      const [x = 0, y = 0, width = 0, height = 0] = numbers(w["pixels"]);
      const [cx, cy] = map.at(x + width / 2, y + height / 2);
      return svg`<text class="count" x=${short(cx)} y=${short(cy + 4)} text-anchor="middle">${polygonsLeft(w)}</text>`;
    });

  // A click chooses the smallest window there.
  const click = (e: MouseEvent) => {
    const [px, py] = map.pixelOf(e);
    const holds = (w: JsonObject) => {
      const [x = 0, y = 0, width = 0, height = 0] = numbers(w["pixels"]);
      return px >= x && py >= y && px < x + width && py < y + height;
    };
    const found = [...windows].reverse().find(holds);
    if (found) choiceOf(app, found["facet"], found["at"])?.choose();
  };
  return sheet(app, {
    name: t("Drawing of the quadtree"),
    height: map.height,
    click,
    content: svg`${map.shapes(svg`${shapes}<path class="present-halo" d=${path(present)} /><path class="present" d=${path(present)} />`)}${counts}`,
    legend: [
      ["d-empty", t("empty window")],
      ["d-one", t("one polygon")],
      ["d-surrounded", t("surrounded")],
      ["d-one-pixel", t("one pixel")],
      ["d-cut", t("cut in four")],
      ["d-present", t("the present window")],
    ],
    note: t("Numbers: polygons left in the window"),
  });
}
