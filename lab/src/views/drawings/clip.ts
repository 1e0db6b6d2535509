// Drawing of Weiler and Atherton's clip: the polygons of the list in three parts, the visible ones so far.

import { nothing, svg, type TemplateResult } from "lit-html";
import type { App } from "../../app.ts";
import type { Json, JsonObject } from "../../json.ts";
import { t } from "../../words.ts";
import { isChosen, outlinePath } from "../chosen.ts";
import { doneOf, list, objects } from "../recorded.ts";
import { pictureMap, sheet, type Area } from "./sheet.ts";

const contourPath = (contours: Json | undefined) =>
  objects(contours)
    .map((c) => outlinePath(c["corners"]))
    .join("");

/** Visible polygons that are shapes of their own; earlier ones are one shape. */
const MOST_SINGLE = 300;

/** Paths of the visible polygons, each made once. */
const paths = new WeakMap<JsonObject, string>();

function pathOf(s: JsonObject): string {
  let path = paths.get(s);
  if (path === undefined) paths.set(s, (path = contourPath(s["contours"])));
  return path;
}

/** The surroundings of a polygon: at least an eighth of the picture, in its proportions. */
function areaAround(app: App, outline: Json | undefined): Area {
  const corners = list(outline).filter((c): c is Json[] => Array.isArray(c));
  if (!corners.length) return { x: 0, y: 0, width: app.width, height: app.height };
  const [xs, ys] = [corners.map((c) => Number(c[0])), corners.map((c) => Number(c[1]))];
  const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const share = Math.min(1, Math.max(1 / 8, (2.2 * (right - left)) / app.width, (2.2 * (bottom - top)) / app.height));
  const [width, height] = [share * app.width, share * app.height];
  const within = (v: number, most: number) => Math.max(0, Math.min(most, v));
  return { x: within((left + right - width) / 2, app.width - width), y: within((top + bottom - height) / 2, app.height - height), width, height };
}

export function clipDrawing(app: App, present: JsonObject): TemplateResult {
  const isClip = present["step"] === "clip";
  const outline = isClip ? present["outline"] : objects(present["contours"])[0]?.["corners"];
  const area = areaAround(app, outline);
  const map = pictureMap(app, area);
  const visible = doneOf(app, "visible");
  const early = visible.slice(0, -MOST_SINGLE);
  const single = visible.slice(-MOST_SINGLE).map(
    (s) =>
      svg`<path class=${`visible-part${isChosen(app, s["facet"]) ? " chosen" : ""}`} data-facet=${String(s["facet"])} data-step=${String(s["at"] ?? "")} fill-rule="evenodd" d=${pathOf(s)} />`,
  );
  const cut = objects(present["cut"]);
  const part = (key: "inside" | "outside" | "hidden", style: string) =>
    cut.map((c) => svg`<path class=${style} data-facet=${String(c["facet"])} fill-rule="evenodd" d=${contourPath(c[key])} />`);

  // The first order is shown by the outlines of its polygons.
  const first = objects((present["step"] === "nearest-first" ? present : null)?.["polygons"]).map(
    (p) => svg`<path class="outside-part" data-facet=${String(p["facet"])} d=${contourPath(p["contours"])} />`,
  );
  return sheet(app, {
    name: t("Drawing of the clip"),
    height: map.height,
    content: map.shapes(svg`${early.length ? svg`<path class="visible-part" fill-rule="evenodd" d=${early.map(pathOf).join("")} />` : nothing}${single}
      ${first}${part("outside", "outside-part")}${part("inside", "inside-part")}${part("hidden", "removed-part")}
      ${outline ? svg`<path class="present-halo" d=${outlinePath(outline)} /><path class="present" d=${outlinePath(outline)} />` : nothing}`),
    legend: [
      ["d-present", isClip ? t("clip polygon") : t("visible polygon")],
      ...(isClip
        ? ([
            ["d-inside", t("inside")],
            ["d-outside", t("outside")],
            ["d-removed", t("hidden, removed")],
          ] as [string, string][])
        : []),
      ["d-visible", t("visible so far")],
    ],
    note: area.width < app.width ? t("enlarged {0} times", (app.width / area.width).toFixed(1)) : "",
  });
}

