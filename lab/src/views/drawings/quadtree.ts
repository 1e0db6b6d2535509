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

export function quadtreeDrawing(app: App, present: JsonObject): TemplateResult {
  const map = pictureMap(app);
  const known = doneOf(app, "window");
  const windows = known.length ? known : [present];
  const path = (w: JsonObject) => {
    const [x = 0, y = 0, width = 0, height = 0] = numbers(w["pixels"]);
    return `M${x} ${y}h${width}v${height}h${-width}z`;
  };
  // Small windows have no outline: it would hide them.
  const isSmall = (w: JsonObject) => Number(numbers(w["pixels"])[2]) * map.scale < 6;
  const groups = VERDICTS.flatMap((verdict) =>
    [false, true].map((small) => {
      const all = windows.filter((w) => w["verdict"] === verdict && isSmall(w) === small);
      const style = `window ${verdict}${small ? " small" : ""}`;
      return all.length && !(small && verdict === "cut") ? svg`<path class=${style} d=${all.map(path).join("")} />` : nothing;
    }),
  );

  // Count the polygons in windows with room for a number: those that were not cut, and the present one.
  const counts = windows
    .filter((w) => w["verdict"] !== "cut" || w === windows[windows.length - 1])
    .filter((w) => Number(numbers(w["pixels"])[2]) * map.scale >= 17 && Number(numbers(w["pixels"])[3]) * map.scale >= 13)
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
    content: svg`${map.shapes(svg`${groups}<path class="present-halo" d=${path(present)} /><path class="present" d=${path(present)} />`)}${counts}`,
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
