// Drawings of rays: the boxes that the pixel's ray opened, along the ray; the tree of traced rays.

import { nothing, svg, type TemplateResult } from "lit-html";
import type { App } from "../../app.ts";
import { isObject, type Json, type JsonObject } from "../../json.ts";
import { t } from "../../words.ts";
import { isChosen } from "../chosen.ts";
import { rayNodes } from "../pixel.ts";
import { leftOut, numbers, objects } from "../recorded.ts";
import { leftOutOf, links } from "./links.ts";
import { around, sheet, short, WIDTH } from "./sheet.ts";

interface Ray {
  origin: number[];
  direction: number[];
}

/** Where a ray goes into a box and where it leaves it, by the slabs of the three axes. */
function interval({ origin, direction }: Ray, min: number[], max: number[]): [number, number] | null {
  let [from, to] = [0, Infinity];
  for (let i = 0; i < 3; i++) {
    const [o, d] = [origin[i]!, direction[i]!];
    if (Math.abs(d) < 1e-12) continue;
    const [a, b] = [(min[i]! - o) / d, (max[i]! - o) / d];
    from = Math.max(from, Math.min(a, b));
    to = Math.min(to, Math.max(a, b));
  }
  return to >= from && Number.isFinite(to) ? [from, to] : null;
}

/** A node or cell by its number, the root of an octree by its word. */
export const partName = (p: JsonObject) => (p["name"] === "" ? t("root") : t("part {0}", String(p["name"])));

const MOST = 18;
const ROW = 15;

/** A bar for each part that the ray opened, from where the ray goes in to where it leaves. */
export function accelerationDrawing(app: App, answer: JsonObject): TemplateResult | typeof nothing {
  const { hit, ray: told, distance } = answer;
  const parts = objects(answer["parts"]);
  if (!isObject(told) || !parts.length) return nothing;
  const ray = { origin: numbers(told["origin"]), direction: numbers(told["direction"]) };
  const isHit = (p: JsonObject) => typeof hit === "number" && numbers(p["facets"]).includes(hit);
  const levels = new Map<Json, number>();
  for (const p of parts) levels.set(p["id"] ?? null, p["parent"] === null ? 0 : (levels.get(p["parent"] ?? null) ?? -1) + 1);
  const spans = parts.map((p) => interval(ray, numbers(p["min"]), numbers(p["max"])));
  const ends = spans.flatMap((s) => s ?? []);
  const [near, far] = [Math.min(...ends), Math.max(...ends)];
  const [left, right] = [84, WIDTH - 8];
  const X = (depth: number) => left + ((depth - near) / Math.max(1e-9, far - near)) * (right - left);

  // Show the parts round the one with the hit, or the first ones.
  const shown = around(parts, Math.max(0, parts.findIndex(isHit)), MOST);
  const height = 24 + shown.shown.length * ROW + 6;
  const row = (p: JsonObject, i: number) => {
    const span = spans[shown.first + i];
    const facets = numbers(p["facets"]);
    const y = 24 + i * ROW;
    const level = levels.get(p["id"] ?? null) ?? 0;
    const facet = isHit(p) ? Number(hit) : facets[0];
    const style = `${isHit(p) ? "hit" : facets.length ? "tested" : "opened"}${facets.some((f) => isChosen(app, f)) ? " chosen" : ""}`;
    return svg`<g class=${style} data-facet=${String(facet ?? "")}><title>${`${partName(p)}: ${facets.join(", ") || "–"}`}</title>
      <text x=${3 + Math.min(level, 8) * 3} y=${y + 11}>${partName(p).slice(0, 14)}</text>
      ${span ? svg`<rect x=${short(X(span[0]))} y=${y + 2} width=${short(Math.max(2, X(span[1]) - X(span[0])))} height=${ROW - 4} rx="2" />` : nothing}</g>`;
  };
  const depth = typeof distance === "number" ? distance : null;
  // A hit on the side of a box may lie a rounding error before it.
  const slack = (far - near) * 1e-3;
  const line = depth === null || depth < near - slack || depth > far + slack ? nothing : svg`<path class="hit-line" d=${`M${short(X(depth))} 18V${height - 4}`} />`;
  return sheet(app, {
    name: t("Drawing of the acceleration structure"),
    height,
    content: svg`<g class="bars"><text x=${left} y="14">${t("near")}</text><text x=${right} y="14" text-anchor="end">${t("far")}</text>
      <path class="axis" d=${`M${left} 19H${right}`} />${shown.shown.map(row)}${line}</g>`,
    legend: [
      ["d-opened", t("opened by the ray")],
      ["d-tested", t("with facets tested")],
      ["d-hit", t("with the facet that is hit")],
      ...(line === nothing ? [] : [["d-hit-line", t("the hit")] as [string, string]]),
    ],
    note: leftOut(shown.before, shown.after),
  });
}

/** The rays of the pixel, each below the one that sent it. */
export function rayTreeDrawing(app: App): TemplateResult | typeof nothing {
  const nodes = rayNodes(app);
  if (!nodes.length) return nothing;
  const drawn = links(
    nodes.map((n) => ({
      id: n.id,
      parent: n.parent,
      look: () => ({
        text: n.facet === null ? "–" : String(n.facet),
        title: n.text(),
        facet: n.facet,
        style: `${n.facet === null ? "background" : "visited"}${isChosen(app, n.facet) ? " chosen" : ""}`,
        below: n.way ?? "",
      }),
    })),
    null,
  );
  return sheet(app, {
    name: t("Drawing of the ray tree"),
    height: drawn.height,
    content: drawn.content,
    legend: [
      ["d-visited", t("facet that the ray meets; below: how it came")],
      ["d-node", t("background")],
    ],
    note: leftOutOf(drawn),
  });
}
