// The words of a step. In English they are the engine's own, as `--trace` and `--pixel` tell them;
// in other languages they are made from the step's fields.

import type { Step } from "./answers.ts";
import { isEnglish, t, translated } from "./words.ts";
import type { JsonObject } from "./json.ts";

const length = (f: JsonObject, ...keys: string[]) => keys.reduce((sum, k) => sum + (Array.isArray(f[k]) ? f[k].length : 0), 0);

export function stepWords(step: Step): string {
  return isEnglish() ? step.words : wordsOf(step.fields);
}

function wordsOf(f: JsonObject): string {
  const of = (key: string) => (f[key] === null || f[key] === undefined ? "–" : String(f[key]));
  const verdict = translated(of("verdict"));
  switch (f["step"]) {
    case "box":
      return t("box of items {0}: {1}", of("items"), verdict);
    case "clipped":
      return t("facet {0} is clipped: {1}", of("facet"), translated(of("plane")));
    case "drawn":
      return t("facet {0} is drawn: {1} runs stay, {2} are hidden", of("facet"), length(f, "stays"), length(f, "hidden"));
    case "depth-test":
      return t("facet {0}, depth {1}; there: {2}; stays: {3}", of("facet"), of("depth"), of("there"), of("stays"));
    case "window": {
      const [x, y, w, h] = (f["pixels"] as number[] | undefined) ?? [];
      const left = length(f, "contained", "intersecting", "surrounding");
      return t("window {0},{1} of {2} x {3}, polygons left: {4}; {5}", x ?? 0, y ?? 0, w ?? 0, h ?? 0, left, verdict);
    }
    case "edge-table":
      return t("edge table of rows {0}: polygons: {1}", of("rows"), length(f, "polygons"));
    case "line":
      return t("row {0}: active edges: {1}, spans: {2}", of("row"), length(f, "active_edges"), length(f, "spans"));
    case "first-order":
    case "nearest-first":
      return t("first order of {0} polygons", length(f, "polygons"));
    case "turn":
      return t("polygon {0} has its turn", of("polygon"));
    case "compared":
      return t("polygon {0} with {1}: {2}, {3}", of("polygon"), of("with"), translated(of("test")), verdict);
    case "moved":
      return t("polygon {0} is moved before {1}", of("polygon"), of("before_polygon"));
    case "circle":
      return t("polygons wait for each other: {0}", of("polygons"));
    case "split":
      return t("polygon {0} is split by {1}", of("polygon"), of("by"));
    case "painted":
      return t("polygon {0} is painted", of("polygon"));
    case "piece":
      return t("piece {0} of the list: facet {1}", of("order"), of("facet"));
    case "tree-node":
      return t("node {0}: divides along facet {1}", of("node"), of("splitter"));
    case "tree-visit":
      return t("the walk comes to node {0}", of("node"));
    case "clip":
      return t("clip with facet {0}: inside {1}, outside {2}", of("facet"), length(f, "inside"), of("outside_count"));
    case "visible":
      return t("facet {0} is visible", of("facet"));
    case "rays":
      return t("{0} rays: boxes {1}, facets {2}", of("rays"), of("boxes"), of("facets"));
    case "ray-meets":
      return t("a ray meets facet {0}", of("facet"));
    case "ray-goes-on":
      return t("the ray goes on: {0}", translated(of("way")));
    default:
      return translated(of("step"));
  }
}
