// `region "Structure"`: what the algorithm holds at the step, as tables, lists and trees.
//
// A step tells its own fields; what came before it (the tree so far, the list) is asked for as the
// steps of a kind, once for each recording.

import { html, nothing, type TemplateResult } from "lit-html";
import { ref } from "lit-html/directives/ref.js";
import type { Step } from "../answers.ts";
import type { App } from "../app.ts";
import { isObject, type Json, type JsonObject } from "../json.ts";
import type { Choice } from "../parts/choice.ts";
import { drawing } from "../parts/markup.ts";
import { valueText } from "../parts/numbers.ts";
import { rowButton, table, type Cell } from "../parts/table.ts";
import { tree, type Node } from "../parts/tree.ts";
import { depthNote } from "../parts/what.ts";
import { fieldName, fieldValue } from "../step-fields.ts";
import { stepWords } from "../stepwords.ts";
import { t, translated } from "../words.ts";
import { choiceOf, chosenFinder, chosenWords, followsChoice, followStep, goTo } from "./chosen.ts";
import { bspDrawing } from "./drawings/bsp-tree.ts";
import { clipDrawing } from "./drawings/clip.ts";
import { blockDrawing, bruteForceDrawing, depthsDrawing } from "./drawings/depths.ts";
import { quadtreeDrawing } from "./drawings/quadtree.ts";
import { accelerationDrawing, partName, rayTreeDrawing } from "./drawings/rays.ts";
import { edgesDrawing } from "./drawings/scan-line.ts";
import { listDrawing, sortedList, type EntryState } from "./drawings/sorted-list.ts";
import { hasOwnRays, rayTree } from "./pixel.ts";
import { doneCount, doneOf, facetsText as facets, list, numbers, objects, presentStep, stepsOf, wholeStep } from "./recorded.ts";
import { prediction } from "./steps.ts";

/** Rows that stand for facets: what choosing them does, and the one that is brought into view. */
function rowsOf(app: App, facets: (Json | undefined)[], current?: number): { choices: (row: number) => Choice | null; shown: number | undefined } {
  const finder = chosenFinder(app);
  const chosen = finder ? facets.findIndex((f) => typeof f === "number" && finder(f)) : -1;
  return { choices: (row) => choiceOf(app, facets[row]), shown: chosen >= 0 ? chosen : current };
}

/** Stands below tables that the algorithm has not filled at the step. */
const untilThen = () => html`<p class="note">${t("Empty until the algorithm comes to it.")}</p>`;

function warnock(app: App, f: JsonObject): unknown {
  const isWindow = f["step"] === "window";
  const rows: Cell[][] = [
    [t("surrounding"), list(f["surrounding"]).length, facets(f["surrounding"])],
    [t("intersecting"), list(f["intersecting"]).length, facets(f["intersecting"])],
    [t("contained"), list(f["contained"]).length, facets(f["contained"])],
    [t("disjoint"), Number(f["disjoint"] ?? 0), "–"],
    [t("hidden"), list(f["hidden"]).length, facets(f["hidden"])],
  ];
  return html`${table({ name: t("Window"), columns: [t("class"), t("polygons"), t("facets")], rows: isWindow ? rows : [], caption: true })}
  ${isWindow ? html`${facetButtons(app, f)} ${quadtreeDrawing(app, f)}` : untilThen()} ${quadtree(app, f)}`;
}

function quadtree(app: App, f: JsonObject): unknown {
  const path = String(f["path"] ?? "");
  const quarters = [t("top left"), t("top right"), t("bottom left"), t("bottom right")];
  const known = stepsOf(app, "window");
  if (known.length && doneCount(app, known)) {
    const nodes = nodesOf(known, (s) => ({
      id: Number(s["at"]),
      parent: typeof s["parent"] === "number" ? s["parent"] : null,
      text: () => `${numbers(s["pixels"]).slice(0, 2).join(",")} · ${numbers(s["pixels"]).slice(2).join(" x ")}: ${translated(String(s["verdict"]))}`,
      choice: () => choiceOf(app, s["facet"], s["at"]),
      facet: typeof s["facet"] === "number" ? s["facet"] : null,
    }));
    return labelledTree(app, t("Quadtree"), nodes, app.step?.value.at ?? null, doneCount(app, known));
  }
  // Without the other steps, the way down from the whole picture.
  const nodes: Node[] = [{ id: 0, parent: null, text: () => t("whole picture") }];
  let parent = 0;
  for (let depth = 0; depth < path.length; depth++) {
    const at = Number(path[depth]);
    for (let q = 0; q < 4; q++) nodes.push({ id: depth * 4 + q + 1, parent, text: () => quarters[q]! });
    parent = depth * 4 + at + 1;
  }
  return labelledTree(app, t("Quadtree"), nodes, parent);
}

const labelledTree = (app: App, name: string, nodes: Node[], current: number | null, count = nodes.length) =>
  labelled(name, tree({ name, nodes, count, current, isChosen: chosenFinder(app) }, () => app.changed()));

/** The nodes of the steps of a recording, made once. */
const knownNodes = new WeakMap<JsonObject[], Node[]>();

function nodesOf(steps: JsonObject[], nodeOf: (s: JsonObject) => Node): Node[] {
  let nodes = knownNodes.get(steps);
  if (!nodes) knownNodes.set(steps, (nodes = steps.map(nodeOf)));
  return nodes;
}

/** Facets that have a button of their own. */
const MOST_BUTTONS = 12;

/** The first polygons of the window, to be chosen. */
function facetButtons(app: App, f: JsonObject): unknown {
  const all = ["surrounding", "intersecting", "contained", "hidden"].flatMap((k) => numbers(f[k]));
  if (!all.length) return nothing;
  return html`<div class="chips" role="group" aria-label=${t("Polygons of the window")}>
    ${all.slice(0, MOST_BUTTONS).map((facet) => rowButton(choiceOf(app, facet)!, t("facet {0}", facet)))}
    ${all.length > MOST_BUTTONS ? html`<span class="note">… (${all.length})</span>` : nothing}
  </div>`;
}

const labelled = (label: string, content: unknown) => html`<div class="labelled"><p class="label">${label}</p>${content}</div>`;

function polygonTable(app: App, polygons: JsonObject[], inside: Set<number> | null): unknown {
  const last = (p: JsonObject) =>
    inside ? (inside.has(Number(p["facet"])) ? t("in") : t("out")) : numbers(p["plane"]).map((n) => Number(n.toPrecision(4))).join(", ");
  return table(
    {
      name: t("Polygon table"),
      columns: [t("polygon"), t("facet"), t("surface"), inside ? t("in-out flag") : t("plane")],
      rows: polygons.map((p, i) => [i, Number(p["facet"]), Number(p["surface"]), last(p)]),
      ...rowsOf(app, polygons.map((p) => p["facet"])),
      caption: true,
    },
    () => app.changed(),
  );
}

/** The edge table before it is made. */
const NO_EDGES: JsonObject = { buckets: [] };

/** The rows of each edge table and the facets of their edges, made once. */
const edgeRows = new WeakMap<JsonObject, { rows: Cell[][]; facets: (Json | undefined)[] }>();

function edgeTable(app: App, f: JsonObject): unknown {
  let known = edgeRows.get(f);
  if (!known) {
    const edges = objects(f["buckets"]).flatMap((b) => objects(b["edges"]).map((e): JsonObject => ({ ...e, row: b["row"] ?? null })));
    const rows = edges.map((e): Cell[] => [...["row", "polygon", "edge", "x", "dx"].map((k) => e[k] as number), valueText(e["last"])]);
    edgeRows.set(f, (known = { rows, facets: edges.map((e) => e["facet"]) }));
  }
  const columns = [t("row"), t("polygon"), t("edge"), "x", "dx", t("last row")];
  return table({ name: t("Edge table"), columns, rows: known.rows, ...rowsOf(app, known.facets), caption: true }, () => app.changed());
}

function scanLine(app: App, step: Step): unknown {
  const f = step.fields;
  // The tables of the band: a line's step follows from theirs.
  const isLine = f["step"] === "line";
  const fields = f["step"] === "edge-table" ? f : isLine ? wholeStep(app, step.parent, "edge-table") : null;
  const active = objects(isLine ? f["active_edges"] : []);
  const spans = objects(isLine ? f["spans"] : []);
  const inside = isLine ? new Set(spans.flatMap((s) => numbers(s["inside"]))) : null;
  const changed = () => app.changed();
  const ofLine = html`${table(
    {
      name: t("Active edge table"),
      columns: ["x", t("polygon"), t("facet"), t("edge")],
      rows: active.map((e) => [e["x"] as number, e["polygon"] as number, e["facet"] as number, e["edge"] as number]),
      ...rowsOf(app, active.map((e) => e["facet"])),
      caption: true,
    },
    changed,
  )}
  ${table(
    {
      name: t("Spans"),
      columns: [t("pixels"), t("inside"), t("verdict"), t("facet")],
      rows: spans.map((s) => [numbers(s["pixels"]).join("–"), facets(s["inside"]), translated(String(s["verdict"])), s["facet"] as number | null]),
      ...rowsOf(app, spans.map((s) => s["facet"] ?? numbers(s["inside"])[0])),
      caption: true,
    },
    changed,
  )}
  ${isLine ? nothing : untilThen()}`;
  const ofBand = html`${polygonTable(app, objects(fields?.["polygons"]), inside)} ${edgeTable(app, fields ?? NO_EDGES)}`;
  return html`${fields ? edgesDrawing(app, fields, isLine ? f : null) : nothing} ${isLine ? html`${ofLine} ${ofBand}` : html`${ofBand} ${ofLine}`}`;
}

/** The last comparison of all, once the picture is finished. */
function lastCompared(app: App): JsonObject | null {
  const { recording } = app;
  const count = recording?.value.groups.find((g) => g.name === "compared")?.count ?? 0;
  if (!count || presentStep(app) < (recording?.value.steps ?? 0)) return null;
  const request: JsonObject = { want: "steps", state: app.state, show: "compared", from: count, to: count };
  app.answer("last compared", request, true);
  const answer = app.answers.get("last compared");
  const fields = answer?.key === JSON.stringify(request) ? objects(answer.value.ok["steps"])[0]?.["fields"] : null;
  return isObject(fields) ? fields : null;
}

/** Painter's tests in their order; the third and the fourth may be asked with P and Q exchanged. */
const TESTS = ["depth-extent", "x-extent", "y-extent", "behind-plane", "in-front-of-plane", "projection", "exchanged-behind", "exchanged-in-front", "coplanar", "overlap"];

function painter(app: App, step: Step): unknown {
  const f = step.fields;
  const compared = f["step"] === "compared" ? f : lastCompared(app);
  const decided = TESTS.indexOf(String(compared?.["test"]));
  const tests = html`${table({
    name: t("Tests"),
    columns: [t("test"), compared ? t("for polygons {0} and {1}", String(compared["polygon"]), String(compared["with"])) : t("verdict")],
    rows: TESTS.slice(0, decided + 1).map((test, i) => [
      `${i === 0 ? "" : i <= 5 ? `${i}. ` : ""}${translated(test)}`,
      i === decided ? t("decides: {0}", translated(String(compared?.["verdict"]))) : t("no"),
    ]),
    current: decided,
    caption: true,
  })}
  ${compared ? nothing : html`<p class="note">${t("No polygons are compared in this step.")}</p>`}`;

  const sorted = sortedList(app, f);
  const words: Record<EntryState, string> = { painted: t("painted"), waits: t("waits"), moved: t("moved, waits"), part: t("part, waits"), split: t("split") };
  const current = Number(f["polygon"] ?? -1);
  const items = sorted.list.map((e) => ({
    text: () => t("polygon {0}, facet {1}: {2}", e.polygon, String(e.facet), words[e.state]),
    isCurrent: e.polygon === current,
    facet: e.facet,
    choice: () => choiceOf(app, e.facet, e.at),
  }));
  return html`${tests} ${pairButtons(app, f)} ${items.length ? listDrawing(app, f, sorted) : nothing} ${entries(app, t("Depth-sort list"), items)}
  ${items.length ? nothing : untilThen()}`;
}

/** The two polygons of a comparison, to be chosen. */
function pairButtons(app: App, f: JsonObject): unknown {
  if (f["step"] !== "compared") return nothing;
  const one = (letter: string, polygon: Json | undefined, facet: Json | undefined) => {
    const choice = choiceOf(app, facet);
    return choice ? rowButton(choice, t("{0}: polygon {1}, facet {2}", letter, String(polygon), String(facet))) : nothing;
  };
  return html`<div class="chips" role="group" aria-label=${t("Polygons P and Q")}>${one("P", f["polygon"], f["facet"])} ${one("Q", f["with"], f["with_facet"])}</div>`;
}

interface Item {
  text: () => string;
  isCurrent: boolean;
  facet: number | null;
  choice: () => Choice | null;
}

/** A list; of a long one the part round the present or chosen entry. */
function entries(app: App, name: string, items: Item[]): unknown {
  const MOST = 200;
  const finder = chosenFinder(app);
  const chosen = finder ? items.findIndex((i) => i.facet !== null && finder(i.facet)) : -1;
  const at = Math.max(0, chosen >= 0 ? chosen : items.findIndex((i) => i.isCurrent));
  const first = items.length > MOST ? Math.max(0, Math.min(at - 50, items.length - MOST)) : 0;
  const shown = items.slice(first, first + MOST).map((i) => ({ ...i, choice: i.choice() }));
  return labelled(
    name,
    html`<div class="scroll" tabindex="0" role="group" aria-label=${name}>
      <ol role="list" aria-label=${name} start=${first + 1}>
        ${shown.map(
          (i, n) =>
            html`<li
              class=${`${i.isCurrent ? "current" : ""}${i.choice?.isChosen ? " chosen" : ""}`}
              aria-current=${i.isCurrent ? "true" : nothing}
              aria-setsize=${items.length}
              aria-posinset=${first + n + 1}
            >
              ${i.choice ? rowButton(i.choice, i.text()) : i.text()}
            </li>`,
        )}
      </ol>
    </div>`,
  );
}

function bsp(app: App, step: Step): unknown {
  const f = step.fields;
  const all = stepsOf(app, "tree-node");
  const there = all.length ? all : f["step"] === "tree-node" ? [f] : [];
  const side = (s: JsonObject) => (s["side"] === "front" ? t("front") : s["side"] === "back" ? t("back") : t("root"));
  const count = (v: Json | undefined) => (isObject(v) ? Number(v["count"]) : 0);
  const nodes = nodesOf(there, (s) => ({
    id: Number(s["node"]),
    parent: typeof s["above"] === "number" ? s["above"] : null,
    facet: typeof s["splitter"] === "number" ? s["splitter"] : null,
    text: () => t("{0}: splitter facet {1}, front {2}, back {3}", side(s), valueText(s["splitter"]), count(s["front"]), count(s["back"])),
    choice: () => choiceOf(app, s["splitter"], s["at"]),
  }));
  const visits = doneOf(app, "tree-visit");
  const seen = visits.length ? visits : f["step"] === "tree-visit" ? [f] : [];
  const order = seen.map((s) => ({
    text: () => t("node {0}: facets {1}", Number(s["node"]), facets(s["polygons"])),
    isCurrent: s["node"] === f["node"] && f["step"] !== "tree-node",
    facet: numbers(s["polygons"])[0] ?? null,
    choice: () => choiceOf(app, numbers(s["polygons"])[0], s["at"]),
  }));
  const current = typeof f["node"] === "number" ? f["node"] : null;
  return html`${bspDrawing(app, f)} ${labelledTree(app, t("BSP tree"), nodes, current, all.length ? doneCount(app, all) : nodes.length)}
  ${entries(app, t("Back to front"), order)} ${order.length ? nothing : untilThen()}`;
}

function weilerAtherton(app: App, step: Step): unknown {
  const f = step.fields;
  const here = presentStep(app);
  const visible = doneOf(app, "visible");
  // A visible polygon follows from the clip in whose inside list it was left.
  const found = f["step"] === "clip" ? f : f["step"] === "visible" ? wholeStep(app, step.parent, "clip") : null;
  const last = found?.["step"] === "clip" ? found : null;
  const clip = html`${table({
    name: t("Clip polygon"),
    columns: [t("list"), t("polygons"), t("facets")],
    rows: last
      ? [
          [t("clip polygon"), 1, String(last["facet"])],
          [t("inside"), list(last["inside"]).length, facets(last["inside"])],
          [t("outside"), Number(last["outside_count"] ?? 0), facets(last["outside"])],
          [t("hidden, removed"), list(last["hidden"]).length, facets(last["hidden"])],
        ]
      : [],
    choices: (row) => choiceOf(app, row === 0 ? last?.["facet"] : numbers(last?.[["inside", "outside", "hidden"][row - 1]!])[0]),
    caption: true,
  })}
  ${last || f["step"] === "visible" ? nothing : untilThen()}`;
  const items = visible.map((s) => ({
    text: () => t("facet {0}: {1} square pixels", Number(s["facet"]), valueText(s["area"])),
    isCurrent: s["at"] === here,
    facet: Number(s["facet"]),
    choice: () => choiceOf(app, s["facet"], s["at"]),
  }));
  return html`${clipDrawing(app, f)} ${clip} ${entries(app, t("Visible polygons"), items)}
  ${items.length || !last ? nothing : untilThen()}`;
}

function zBuffer(app: App, step: Step): unknown {
  const f = step.fields;
  const depths = step.depths ?? null;
  const choice = choiceOf(app, f["facet"]);
  const isDrawn = f["step"] === "drawn" || f["step"] === "depth-test";
  return html`${isDrawn ? depthsDrawing(app, step) : nothing}
  ${choice ? html`<div class="chips">${rowButton(choice, t("facet {0}", Number(f["facet"])))}</div>` : nothing}
  ${depths ? html`${depthTable(depths)}${depthNote()} ${slopeNote(depths)}` : html`<p class="note">${t("Inspect a pixel to see the depths round it.")}</p>`} ${f["step"] === "drawn" ? runsOf(f) : nothing}`;
}

/** How depth changes in the plane of the step's facet (P17). */
function slopeNote(depths: JsonObject): unknown {
  const [along, down] = numbers(depths["slope"]);
  if (along === undefined || down === undefined) return nothing;
  const signed = (v: number) => `${v < 0 ? "−" : "+"} ${valueText(Math.abs(Number(v.toPrecision(4))))}`;
  return html`<p class="note">${t("In the facet's plane A x + B y + C z + D = 0:")} z(x + 1, y) = z − A/C = z ${signed(along)}, z(x, y + 1) = z − B/C = z ${signed(down)}</p>`;
}

/** Brute force: what the pixel's sample is compared with. */
function bruteForce(app: App, step: Step): unknown {
  const facets = objects(step.depths?.["facets"]);
  if (!step.depths) return html`${bruteForceDrawing(app, step)}<p class="note">${t("Inspect a pixel to see the depths of all facets over it.")}</p>`;
  const nearest = Math.max(...facets.map((f) => Number(f["depth"] ?? -1)));
  const verdict = (depth: Json | undefined) => (typeof depth !== "number" ? t("not over the pixel") : depth === nearest ? t("nearest") : t("hidden"));
  const rows = facets.map((f) => [f["facet"] as number, valueText(f["depth"]), verdict(f["depth"])]);
  const columns = [t("facet"), t("Depth"), t("verdict")];
  return html`${bruteForceDrawing(app, step)}
  ${table({ name: t("Depths"), columns, rows, ...rowsOf(app, facets.map((f) => f["facet"])), caption: true }, () => app.changed())}${depthNote()}`;
}

/** Ray casting: what the ray of the pixel opened in the structure, and the facets that were tested there. */
function rayCast(app: App, step: Step): unknown {
  const { pixel } = app.lab;
  const name = t("Acceleration structure");
  if (!pixel) {
    return html`${blockDrawing(app, step, t("Drawing of the acceleration structure"))}
      <p class="note">${t("Inspect a pixel to see what its ray opens in the acceleration structure.")}</p>`;
  }
  if (app.catalog?.wants?.includes("acceleration")) app.answer("acceleration", { want: "acceleration", state: app.state, pixel });
  const answer = app.answerTo("acceleration")?.ok;
  const parts = objects(answer?.["parts"]);
  if (!answer) return blockDrawing(app, step, t("Drawing of the acceleration structure"));
  const { hit } = answer;
  const facetWords = (facet: number) => (facet === hit ? t("facet {0}: tested, the hit", facet) : t("facet {0}: tested", facet));
  const counts = html`<p class="note">${t("Opened: {0} of {1} parts; tests of boxes: {2}, of facets: {3}", parts.length, String(answer["count"] ?? "–"), String(answer["boxes"] ?? "–"), String(answer["tests"] ?? "–"))}</p>`;
  const hitWords = typeof hit === "number" ? t("The ray hits facet {0}.", hit) : t("The ray hits nothing.");
  let content: unknown = nothing;
  if (parts.some((p) => p["parent"] !== null)) {
    // Facets hang below the part in which they were tested.
    let last = 0;
    const nodes: Node[] = parts.flatMap((p): Node[] => {
      const id = Number(p["id"]);
      const own: Node = { id, parent: typeof p["parent"] === "number" ? p["parent"] : null, text: () => partName(p) };
      return [own, ...numbers(p["facets"]).map((facet): Node => ({ id: (last -= 1), parent: id, text: () => facetWords(facet), facet, choice: () => choiceOf(app, facet) }))];
    });
    content = labelledTree(app, name, nodes, nodes.find((n) => n.facet !== undefined && n.facet === hit)?.id ?? null);
  } else if (parts.length) {
    const corner = (v: Json | undefined) => numbers(v).map((n) => Number(n.toPrecision(4))).join(" ");
    const holdsHit = (p: JsonObject) => typeof hit === "number" && numbers(p["facets"]).includes(hit);
    content = table({
      name,
      columns: [t("part"), t("facets"), t("from"), t("to"), t("hit")],
      rows: parts.map((p) => [partName(p), facets(p["facets"]), corner(p["min"]), corner(p["max"]), holdsHit(p) ? t("facet {0}", Number(hit)) : "–"]),
      ...rowsOf(app, parts.map((p) => (holdsHit(p) ? hit : numbers(p["facets"])[0]))),
      current: parts.findIndex(holdsHit),
      caption: true,
    });
  }
  return html`${accelerationDrawing(app, answer)} ${counts} ${content} <p>${hitWords}</p>`;
}

/** Ray tracing: the rays of the pixel. */
function rayTrace(app: App): unknown {
  if (!app.lab.pixel) return html`<p class="note">${t("Inspect a pixel to see its rays.")}</p>`;
  return html`${rayTreeDrawing(app)} ${rayTree(app)}`;
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
      const text = fieldValue(value);
      return [fieldName(key), text.length > 160 ? `${text.slice(0, 160)}…` : text];
    });
  return table({ name: t("Step in numbers"), columns: [t("field"), t("value")], rows, caption: true });
}

/** What each algorithm holds, at every one of its steps. */
const STRUCTURES: Record<string, (app: App, step: Step) => unknown> = {
  "z-buffer": zBuffer,
  "brute-force": bruteForce,
  "scan-line": scanLine,
  warnock: (app, step) => warnock(app, step.fields),
  painter,
  bsp,
  "weiler-atherton": weilerAtherton,
  "ray-cast": rayCast,
};

/** Steps of which the structure shows all fields. */
const SHOWN_WHOLE = ["window", "edge-table", "line", "drawn", "compared", "first-order", "nearest-first", "clip"];

function content(app: App, step: Step): unknown {
  const f = step.fields;
  const kind = String(f["step"]);
  // Rays that go on from surface to surface are shown as a tree of their own.
  const own = kind.startsWith("ray-") ? undefined : STRUCTURES[String(app.get("settings.visibility"))];
  const isCommon = ["box", "clipped"].includes(kind) || !own;
  const choice = isCommon ? choiceOf(app, f["facet"]) : null;
  return html`${choice ? html`<div class="chips">${rowButton(choice, t("facet {0}", Number(f["facet"])))}</div>` : nothing}
  ${own?.(app, step)} ${own && SHOWN_WHOLE.includes(kind) ? nothing : fieldsTable(f)}`;
}

/** Summaries of the details that are open. */
const open = new Set<string>();

/** Content that is made only while it is seen. */
function details(app: App, summary: string, content: () => unknown): TemplateResult {
  const toggle = (e: Event) => {
    if ((e.currentTarget as HTMLDetailsElement).open) open.add(summary);
    else open.delete(summary);
    app.changed();
  };
  return html`<details ?open=${open.has(summary)} @toggle=${toggle}><summary>${summary}</summary>${open.has(summary) ? content() : nothing}</details>`;
}

/** The drawing of the whole structure: quadtree, tree, list. */
function wholeDrawing(app: App): unknown {
  const visibility = String(app.get("settings.visibility"));
  if (!["warnock", "painter", "bsp"].includes(visibility) || app.get("settings.global") === "ray-trace") return nothing;
  return details(app, t("Drawing of the structure"), () => wholeContent(app));
}

function wholeContent(app: App): unknown {
  app.answer("structure", { want: "structure", state: app.state }, true);
  const text = app.answerTo("structure")?.ok["drawing"];
  if (typeof text !== "string" || text.length > 1_500_000) return nothing;
  return html`<div class="drawing" role="img" aria-label=${t("Drawing of the structure")}>${drawing(text, "structure")}</div>`;
}

/** The step whose rows and nodes were brought into view last. */
let revealed = "";

/** Scrolls lists, tables and trees to what a new step is about. */
function reveal(app: App, e: Element | undefined) {
  const shown = `${app.step?.key} ${app.answers.size}`;
  if (!revealed.startsWith(`${app.step?.key} `)) followStep();
  const key = `${shown} ${app.chosen?.facet}`;
  if (!e || key === revealed) return;
  revealed = key;
  setTimeout(() => {
    for (const box of e.querySelectorAll<HTMLElement>(".scroll")) {
      const row = (followsChoice() ? box.querySelector(".chosen") : null) ?? box.querySelector(".current");
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
      ? html`<p class="note"><button type="button" class="link" @click=${() => goTo(app, parent)}>${t("follows from step {0}", parent)}</button></p>`
      : nothing}
    ${chosenWords(app)} ${step && hasOwnRays(app) ? rayTrace(app) : nothing} ${step ? content(app, step) : nothing} ${step ? wholeDrawing(app) : nothing}
  </section>`;
}
