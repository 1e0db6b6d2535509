// `region "Structure"`: what the algorithm holds at the step, as tables, lists and trees.
//
// A step tells its own fields; what came before it (the tree so far, the list) is asked for as the
// steps of a kind, once for each recording.

import { html, nothing, type TemplateResult } from "lit-html";
import { ref } from "lit-html/directives/ref.js";
import type { Step } from "../answers.ts";
import type { App } from "../app.ts";
import { isObject, type Json, type JsonObject } from "../json.ts";
import { drawing } from "../parts/markup.ts";
import { valueText } from "../parts/numbers.ts";
import { table, type Cell } from "../parts/table.ts";
import { tree, type Node } from "../parts/tree.ts";
import { depthNote } from "../parts/what.ts";
import { stepWords } from "../stepwords.ts";
import { t, translated } from "../words.ts";
import { prediction } from "./steps.ts";

const list = (v: Json | undefined): Json[] => (Array.isArray(v) ? v : []);
const objects = (v: Json | undefined): JsonObject[] => list(v).filter(isObject);
const numbers = (v: Json | undefined): number[] => list(v).filter((n): n is number => typeof n === "number");

/** Facets as text, the first of many. */
function facets(v: Json | undefined): string {
  const all = numbers(v);
  return all.length > 24 ? `${all.slice(0, 24).join(", ")}, … (${all.length})` : all.join(", ") || "–";
}

/** All steps of some kinds, brief; empty until they are here. */
function stepsOf(app: App, kind: string): JsonObject[] {
  const wants = app.catalog?.wants ?? [];
  const group = app.recording?.value.groups.find((g) => g.name === kind);
  if (!group || !wants.includes("steps")) return [];
  app.answer(`steps ${kind}`, { want: "steps", state: app.state, show: kind, from: 1, to: Math.min(group.count, 20000) }, true);
  const answer = app.answers.get(`steps ${kind}`);
  if (!answer) return [];
  const known = flattened.get(answer);
  if (known) return known;
  const steps = objects(answer.value.ok["steps"]).map((s): JsonObject => {
    const fields = isObject(s["fields"]) ? s["fields"] : {};
    return { ...fields, at: s["at"] ?? null, parent: s["parent"] ?? null };
  });
  flattened.set(answer, steps);
  return steps;
}

/** Steps of an answer as their fields with their places. */
const flattened = new WeakMap<object, JsonObject[]>();

/** A step that the present one follows from. */
function parentOf(app: App, number: Json | undefined, name: string): JsonObject | null {
  if (typeof number !== "number") return null;
  app.answer(`step ${name}`, { want: "step", state: app.state, number, show: "all" }, true);
  const answer = app.answers.get(`step ${name}`);
  const ok = answer?.value.ok;
  return ok && ok["number"] === number ? ok : null;
}

/** Shows a step, counted among all. */
const goTo = (app: App, at: Json | undefined) => () => {
  if (typeof at !== "number") return;
  if (app.lab.steps !== "all") app.setLab({ steps: "all" });
  app.goToStep(at);
};

function warnock(app: App, f: JsonObject): unknown {
  const rows: Cell[][] = [
    [t("surrounding"), list(f["surrounding"]).length, facets(f["surrounding"])],
    [t("intersecting"), list(f["intersecting"]).length, facets(f["intersecting"])],
    [t("contained"), list(f["contained"]).length, facets(f["contained"])],
    [t("disjoint"), Number(f["disjoint"] ?? 0), "–"],
    [t("hidden"), list(f["hidden"]).length, facets(f["hidden"])],
  ];
  return html`${table({ name: t("Window"), columns: [t("class"), t("polygons"), t("facets")], rows, caption: true })} ${quadtree(app, f)}`;
}

function quadtree(app: App, f: JsonObject): unknown {
  const path = String(f["path"] ?? "");
  const quarters = [t("top left"), t("top right"), t("bottom left"), t("bottom right")];
  const known = stepsOf(app, "window");
  if (known.length) {
    const here = app.step?.value.at ?? Infinity;
    const nodes: Node[] = known
      .filter((s) => Number(s["at"]) <= here)
      .map((s) => ({
        id: Number(s["at"]),
        parent: typeof s["parent"] === "number" ? s["parent"] : null,
        text: `${numbers(s["pixels"]).slice(0, 2).join(",")} · ${numbers(s["pixels"]).slice(2).join(" x ")}: ${translated(String(s["verdict"]))}`,
        choose: goTo(app, s["at"]),
      }));
    return labelled(t("Quadtree"), tree({ name: t("Quadtree"), nodes, current: app.step?.value.at ?? null }, () => app.changed()));
  }
  // Without the other steps, the way down from the whole picture.
  const nodes: Node[] = [{ id: 0, parent: null, text: t("whole picture") }];
  let parent = 0;
  for (let depth = 0; depth < path.length; depth++) {
    const at = Number(path[depth]);
    for (let q = 0; q < 4; q++) nodes.push({ id: depth * 4 + q + 1, parent, text: quarters[q]! });
    parent = depth * 4 + at + 1;
  }
  return labelled(t("Quadtree"), tree({ name: t("Quadtree"), nodes, current: parent }, () => app.changed()));
}

const labelled = (label: string, content: unknown) => html`<div class="labelled"><p class="label">${label}</p>${content}</div>`;

function edgeTables(f: JsonObject): unknown {
  const polygons = objects(f["polygons"]);
  const buckets = objects(f["buckets"]);
  const edges = buckets.flatMap((b) => objects(b["edges"]).map((e): JsonObject => ({ ...e, row: b["row"] ?? null })));
  return html`${table({
    name: t("Polygon table"),
    columns: [t("polygon"), t("facet"), t("surface"), t("plane")],
    rows: polygons.map((p, i) => [i, Number(p["facet"]), Number(p["surface"]), numbers(p["plane"]).map((n) => Number(n.toPrecision(4))).join(", ")]),
    caption: true,
  })}
  ${table({
    name: t("Edge table"),
    columns: [t("row"), t("polygon"), t("edge"), "x", "dx", t("last row")],
    rows: edges.map((e) => [e["row"] as number, e["polygon"] as number, e["edge"] as number, e["x"] as number, e["dx"] as number, valueText(e["last"])]),
    caption: true,
  })}`;
}

function scanLine(app: App, step: Step): unknown {
  const f = step.fields;
  if (f["step"] === "edge-table") return edgeTables(f);
  const parent = parentOf(app, step.parent, "edge-table");
  const inside = new Set(objects(f["spans"]).flatMap((s) => numbers(s["inside"])));
  const fields = parent && isObject(parent["fields"]) ? parent["fields"] : null;
  const polygons = objects(fields?.["polygons"]);
  return html`${table({
    name: t("Active edge table"),
    columns: ["x", t("polygon"), t("facet"), t("edge")],
    rows: objects(f["active_edges"]).map((e) => [e["x"] as number, e["polygon"] as number, e["facet"] as number, e["edge"] as number]),
    caption: true,
  })}
  ${table({
    name: t("Spans"),
    columns: [t("pixels"), t("inside"), t("verdict"), t("facet")],
    rows: objects(f["spans"]).map((s) => [numbers(s["pixels"]).join("–"), facets(s["inside"]), translated(String(s["verdict"])), s["facet"] as number | null]),
    caption: true,
  })}
  ${fields
    ? table({
        name: t("Polygon table"),
        columns: [t("polygon"), t("facet"), t("surface"), t("in-out flag")],
        rows: polygons.map((p, i) => [i, Number(p["facet"]), Number(p["surface"]), inside.has(Number(p["facet"])) ? t("in") : t("out")]),
        caption: true,
      })
    : nothing}
  ${fields ? html`<details><summary>${t("Edge table")}</summary>${edgeTables({ ...fields, polygons: [] })}</details>` : nothing}`;
}

/** Painter's tests in their order; the third and the fourth may be asked with P and Q exchanged. */
const TESTS = ["depth-extent", "x-extent", "y-extent", "behind-plane", "in-front-of-plane", "projection", "exchanged-behind", "exchanged-in-front", "coplanar", "overlap"];

function painter(app: App, step: Step): unknown {
  const f = step.fields;
  const decided = TESTS.indexOf(String(f["test"]));
  const tests =
    f["step"] === "compared"
      ? table({
          name: t("Tests"),
          columns: [t("test"), t("for polygons {0} and {1}", String(f["polygon"]), String(f["with"]))],
          rows: TESTS.slice(0, decided + 1).map((test, i) => [
            `${i === 0 ? "" : i <= 5 ? `${i}. ` : ""}${translated(test)}`,
            i === decided ? t("decides: {0}", translated(String(f["verdict"]))) : t("no"),
          ]),
          current: decided,
          caption: true,
        })
      : nothing;

  // The list: what is left of the first order, and what was painted.
  const here = step.at ?? step.number;
  const first = stepsOf(app, "first-order")[0] ?? (f["step"] === "first-order" ? f : null);
  const painted = stepsOf(app, "painted").filter((s) => Number(s["at"]) <= here);
  const done = new Map(painted.map((s) => [Number(s["polygon"]), s]));
  const splits = stepsOf(app, "split").filter((s) => Number(s["at"]) <= here);
  const moved = new Set(stepsOf(app, "moved").filter((s) => Number(s["at"]) <= here).map((s) => Number(s["polygon"])));
  const gone = new Set(splits.map((s) => Number(s["polygon"])));
  const parts = splits.flatMap((s) => objects(s["parts"]));
  const waiting = [...objects(first?.["polygons"]), ...parts].filter((p) => !gone.has(Number(p["polygon"])) && !done.has(Number(p["polygon"])));
  const item = (p: JsonObject, state: string) => ({ polygon: Number(p["polygon"]), facet: p["facet"], state });
  const items = [
    ...painted.map((p) => item(p, t("painted"))),
    ...waiting.map((p) => item(p, moved.has(Number(p["polygon"])) ? t("moved, waits") : t("waits"))),
  ];
  const current = Number(f["polygon"] ?? -1);
  return html`${tests} ${items.length ? entries(t("Depth-sort list"), items.map((i) => ({
    text: t("polygon {0}, facet {1}: {2}", i.polygon, String(i.facet), i.state),
    isCurrent: i.polygon === current,
  }))) : nothing}
  ${f["step"] === "piece" ? fieldsTable(f) : nothing}`;
}

/** A list; of a long one the part round the present entry. */
function entries(name: string, items: { text: string; isCurrent?: boolean; choose?: () => void }[]): unknown {
  const MOST = 200;
  const at = Math.max(0, items.findIndex((i) => i.isCurrent));
  const first = items.length > MOST ? Math.max(0, Math.min(at - 50, items.length - MOST)) : 0;
  const shown = items.slice(first, first + MOST);
  return labelled(
    name,
    html`<div class="scroll" tabindex="0" role="group" aria-label=${name}>
      <ol role="list" aria-label=${name} start=${first + 1}>
        ${shown.map(
          (i, n) =>
            html`<li
              class=${i.isCurrent ? "current" : ""}
              aria-current=${i.isCurrent ? "true" : nothing}
              aria-setsize=${items.length}
              aria-posinset=${first + n + 1}
            >
              ${i.choose ? html`<button type="button" class="row" @click=${i.choose}>${i.text}</button>` : i.text}
            </li>`,
        )}
      </ol>
    </div>`,
  );
}

function bsp(app: App, step: Step): unknown {
  const f = step.fields;
  const here = step.at ?? step.number;
  const all = stepsOf(app, "tree-node");
  const there = all.length ? all.filter((s) => Number(s["at"]) <= here) : f["step"] === "tree-node" ? [f] : [];
  const side = (s: JsonObject) => (s["side"] === "front" ? t("front") : s["side"] === "back" ? t("back") : t("root"));
  const count = (v: Json | undefined) => (isObject(v) ? Number(v["count"]) : 0);
  const nodes: Node[] = there.map((s) => ({
    id: Number(s["node"]),
    parent: typeof s["above"] === "number" ? s["above"] : null,
    text: t("{0}: splitter facet {1}, front {2}, back {3}", side(s), valueText(s["splitter"]), count(s["front"]), count(s["back"])),
    choose: goTo(app, s["at"]),
  }));
  const visits = stepsOf(app, "tree-visit");
  const seen = visits.length ? visits.filter((s) => Number(s["at"]) <= here) : f["step"] === "tree-visit" ? [f] : [];
  const order = seen.map((s) => ({
    text: t("node {0}: facets {1}", Number(s["node"]), facets(s["polygons"])),
    isCurrent: s["node"] === f["node"] && f["step"] === "tree-visit",
    choose: goTo(app, s["at"]),
  }));
  const current = typeof f["node"] === "number" ? f["node"] : null;
  return html`${nodes.length ? labelled(t("BSP tree"), tree({ name: t("BSP tree"), nodes, current }, () => app.changed())) : nothing}
  ${order.length ? entries(t("Back to front"), order) : nothing}
  ${f["step"] === "piece" || f["step"] === "overruled" ? fieldsTable(f) : nothing}`;
}

function weilerAtherton(app: App, step: Step): unknown {
  const f = step.fields;
  const here = step.at ?? step.number;
  const visible = stepsOf(app, "visible").filter((s) => Number(s["at"]) <= here);
  const clip =
    f["step"] === "clip"
      ? table({
          name: t("Clip polygon"),
          columns: [t("list"), t("polygons"), t("facets")],
          rows: [
            [t("clip polygon"), 1, String(f["facet"])],
            [t("inside"), list(f["inside"]).length, facets(f["inside"])],
            [t("outside"), Number(f["outside_count"] ?? 0), facets(f["outside"])],
            [t("hidden, removed"), list(f["hidden"]).length, facets(f["hidden"])],
          ],
          caption: true,
        })
      : nothing;
  const items = visible.map((s) => ({
    text: t("facet {0}: {1} square pixels", Number(s["facet"]), valueText(s["area"])),
    isCurrent: s["at"] === here,
    choose: goTo(app, s["at"]),
  }));
  return html`${clip} ${items.length ? entries(t("Visible polygons"), items) : nothing} ${f["step"] === "visible" ? fieldsTable(f) : nothing}`;
}

function zBuffer(step: Step): unknown {
  const f = step.fields;
  const depths = step.depths ?? null;
  return html`${depths ? html`${depthTable(depths)}${depthNote()}` : html`<p class="note">${t("Inspect a pixel to see the depths round it.")}</p>`} ${f["step"] === "drawn" ? runsOf(f) : fieldsTable(f)}`;
}

/** Brute force: what the pixel's sample is compared with. */
function bruteForce(step: Step): unknown {
  const facets = objects(step.depths?.["facets"]);
  if (!step.depths) return html`<p class="note">${t("Inspect a pixel to see the depths of all facets over it.")}</p>`;
  const nearest = Math.max(...facets.map((f) => Number(f["depth"])));
  return html`${table({
    name: t("Depths"),
    columns: [t("facet"), t("Depth"), t("verdict")],
    rows: facets.map((f) => [f["facet"] as number, valueText(f["depth"]), Number(f["depth"]) === nearest ? t("nearest") : t("hidden")]),
    caption: true,
  })}${depthNote()}`;
}

/** Runs of pixels in which a facet stays, and those in which it is hidden. */
function runsOf(f: JsonObject): unknown {
  const runs = (key: string, word: string): Cell[][] =>
    list(f[key]).map((r) => {
      const [row = 0, first = 0, end = 0] = numbers(r);
      return [row, `${first}–${end - 1}`, end - first, word];
    });
  const rows = [...runs("stays", t("nearer, is kept")), ...runs("hidden", t("farther, is hidden"))].sort((a, b) => Number(a[0]) - Number(b[0]));
  return table({ name: t("Runs of pixels"), columns: [t("row"), t("pixels"), t("count"), t("verdict")], rows, caption: true });
}

/** The samples round the pixel, before and after a facet came. */
function depthTable(d: JsonObject): unknown {
  const size = Number(d["size"]);
  const [before, after] = [numbers(d["before"]), numbers(d["after"])];
  const rows: Cell[][] = Array.from({ length: size }, (_, y) => [
    Number(d["y"]) + y,
    ...Array.from({ length: size }, (_, x) => {
      const [b, a] = [before[y * size + x] ?? 0, after[y * size + x] ?? 0];
      // Depths lie between 0 and 1.
      const text = a.toFixed(3).replace(/^0/, "");
      return a === b ? text : html`<ins title=${b.toFixed(5)}>${text}</ins>`;
    }),
  ]);
  return table({ name: t("Depths"), columns: [t("row"), ...Array.from({ length: size }, (_, x) => String(Number(d["x"]) + x))], rows, caption: true });
}

/** All fields of a step that are not shown otherwise. */
function fieldsTable(f: JsonObject): unknown {
  const rows = Object.entries(f)
    .filter(([key]) => !["step", "number", "parent", "frame", "at"].includes(key))
    .map(([key, value]): Cell[] => {
      const text = valueText(value);
      return [translated(key), text.length > 160 ? `${text.slice(0, 160)}…` : text];
    });
  return table({ name: t("Step in numbers"), columns: [t("field"), t("value")], rows, caption: true });
}

function content(app: App, step: Step): unknown {
  const f = step.fields;
  switch (f["step"]) {
    case "window":
      return warnock(app, f);
    case "edge-table":
    case "line":
      return scanLine(app, step);
    case "drawn":
    case "depth-test":
      return zBuffer(step);
    case "rays":
      return app.get("settings.visibility") === "brute-force" ? html`${bruteForce(step)} ${fieldsTable(f)}` : fieldsTable(f);
    case "first-order":
    case "turn":
    case "compared":
    case "moved":
    case "circle":
    case "split":
    case "painted":
      return html`${painter(app, step)} ${f["step"] === "compared" || f["step"] === "first-order" ? nothing : fieldsTable(f)}`;
    case "piece":
    case "overruled":
      return app.get("settings.visibility") === "bsp" ? bsp(app, step) : painter(app, step);
    case "tree-node":
    case "tree-visit":
      return html`${bsp(app, step)} ${fieldsTable(f)}`;
    case "nearest-first":
    case "clip":
    case "visible":
      return weilerAtherton(app, step);
    default:
      return fieldsTable(f);
  }
}

/** The drawing of the whole structure: quadtree, tree, list. */
function wholeDrawing(app: App): unknown {
  const visibility = String(app.get("settings.visibility"));
  if (!["warnock", "painter", "bsp"].includes(visibility) || app.get("settings.global") === "ray-trace") return nothing;
  app.answer("structure", { want: "structure", state: app.state }, true);
  const text = app.answerTo("structure")?.ok["drawing"];
  if (typeof text !== "string" || text.length > 1_500_000) return nothing;
  return html`<details>
    <summary>${t("Drawing of the structure")}</summary>
    <div class="drawing" role="img" aria-label=${t("Drawing of the structure")}>${drawing(text, "structure")}</div>
  </details>`;
}

/** The step whose rows and nodes were brought into view last. */
let revealed = "";

/** Scrolls lists, tables and trees to what a new step is about. */
function reveal(app: App, e: Element | undefined) {
  const key = `${app.step?.key} ${app.answers.size}`;
  if (!e || key === revealed) return;
  revealed = key;
  setTimeout(() => {
    for (const box of e.querySelectorAll<HTMLElement>(".scroll")) {
      const row = box.querySelector('.current, [aria-selected="true"]');
      if (!row) continue;
      const [of, within] = [row.getBoundingClientRect(), box.getBoundingClientRect()];
      if (of.top < within.top + 26 || of.bottom > within.bottom - 26) box.scrollTop += of.top - within.top - box.clientHeight / 3;
    }
  }, 30);
}

export function structure(app: App): TemplateResult {
  const step = app.stepCount ? app.step?.value : undefined;
  const { parent } = step ?? {};
  return html`<section class="region structure" aria-labelledby="structure-title" ${ref((e) => reveal(app, e))}>
    <h2 id="structure-title">${t("Structure")}</h2>
    ${prediction(app)}
    <p class="told">${step ? stepWords(step) : t("Recording…")}</p>
    ${typeof parent === "number"
      ? html`<p class="note"><button type="button" class="link" @click=${goTo(app, parent)}>${t("follows from step {0}", parent)}</button></p>`
      : nothing}
    ${step ? content(app, step) : nothing} ${step ? wholeDrawing(app) : nothing}
  </section>`;
}
