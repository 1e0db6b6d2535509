// Drawing of the scan-line algorithm: the edges of a band, those that are active, the spans of the line.

import { nothing, svg, type TemplateResult } from "lit-html";
import type { App } from "../../app.ts";
import type { Json, JsonObject } from "../../json.ts";
import { t } from "../../words.ts";
import { isChosen } from "../chosen.ts";
import { numbers, objects } from "../recorded.ts";
import { sheet, short, WIDTH } from "./sheet.ts";

const HEIGHT = 190;

/** More edges than this are one shape. */
const MOST_SINGLE = 600;

interface Edge {
  key: string;
  facet: Json;
  path: string;
}

/** The edges of each table, made once. */
const known = new WeakMap<JsonObject, Edge[]>();

/** Each edge runs from the line of its bucket to its last line. */
function edgesOf(table: JsonObject, X: (x: number) => number, Y: (row: number) => number): Edge[] {
  let edges = known.get(table);
  if (edges) return edges;
  edges = objects(table["buckets"]).flatMap((bucket) =>
    objects(bucket["edges"]).map((e) => {
      const row = Number(bucket["row"]);
      const last = numbers(e["last"])[0] ?? row;
      const [x, end] = [Number(e["x"]), Number(e["x"]) + Number(e["dx"]) * (last - row)];
      const path = `M${short(X(x))} ${short(Y(row))}L${short(X(end))} ${short(Y(last + 1))}`;
      return { key: `${String(e["polygon"])} ${String(e["edge"])}`, facet: e["facet"] ?? null, path };
    }),
  );
  known.set(table, edges);
  return edges;
}

/** `table` is the edge table of the band, `line` the line that is swept, if one is. */
export function edgesDrawing(app: App, table: JsonObject, line: JsonObject | null): TemplateResult {
  const [top = 0, bottom = 1] = numbers(table["rows"]);
  const X = (x: number) => (x / app.width) * WIDTH;
  const Y = (row: number) => 8 + ((row - top) / Math.max(1, bottom - top)) * (HEIGHT - 16);

  const edges = edgesOf(table, X, Y);
  const active = new Set(objects(line?.["active_edges"]).map((e) => `${String(e["polygon"])} ${String(e["edge"])}`));
  const resting = edges.filter((e) => !active.has(e.key));
  const one = (style: string) => (e: Edge) =>
    svg`<path class=${`${style}${isChosen(app, e.facet) ? " chosen" : ""}`} data-facet=${String(e.facet)} d=${e.path} />`;
  const rest = resting.length > MOST_SINGLE ? svg`<path class="edge" d=${resting.map((e) => e.path).join("")} />` : resting.map(one("edge"));

  // The spans lie on the line, higher than a row so that they are seen.
  const row = Number(line?.["row"] ?? top);
  const y = Y(row + 0.5);
  const spans = objects(line?.["spans"]).map((s) => {
    const [from = 0, to = 0] = numbers(s["pixels"]);
    const style = `span-${String(s["verdict"])}${isChosen(app, s["facet"]) ? " chosen" : ""}`;
    return svg`<rect class=${style} data-facet=${String(s["facet"] ?? "")} x=${short(X(from))} y=${short(y - 4)} width=${short(Math.max(0.7, X(to) - X(from)))} height="8" />`;
  });
  const isSwept = line !== null;
  return sheet(app, {
    name: t("Drawing of the edges"),
    height: HEIGHT,
    content: svg`<g class=${active.size > 60 ? "edges many" : "edges"}>${rest}${isSwept ? svg`<path class="scan" d="M0 ${short(y)}H${WIDTH}" />` : nothing}
      ${edges.filter((e) => active.has(e.key)).map(one("active"))}${spans}</g>`,
    legend: isSwept
      ? [
          ["d-edge", t("edge")],
          ["d-active", t("active edge")],
          ["d-scan", t("scan line")],
          ["d-only", t("one polygon is in")],
          ["d-hides", t("one hides the others")],
          ["d-implied-edge", t("up to an implied edge")],
          ["d-samples", t("sample by sample")],
        ]
      : [["d-edge", t("edge")]],
    note: t("rows {0} to {1}", top, bottom - 1),
  });
}
