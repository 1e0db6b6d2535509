// `region "Pixel"`: what lies over a pixel, what became of it, and how its light adds up.

import { html, nothing, type TemplateResult } from "lit-html";
import type { App } from "../app.ts";
import { isObject, type Json, type JsonObject } from "../json.ts";
import { firstRows, pixelSum, type LightRow } from "../light-rows.ts";
import { button, spin } from "../parts/fields.ts";
import { number } from "../parts/numbers.ts";
import { table, type Cell } from "../parts/table.ts";
import { tree, type Node } from "../parts/tree.ts";
import { depthNote } from "../parts/what.ts";
import { isEnglish, t, translated } from "../words.ts";
import { whyWords } from "../why.ts";
import { choiceOf, chosenFinder, chosenWords } from "./chosen.ts";

export const objects = (v: Json | undefined): JsonObject[] => (Array.isArray(v) ? v.filter(isObject) : []);
const numbers = (v: Json | undefined): number[] => (Array.isArray(v) ? v.map(Number) : []);

export const explanationOf = (app: App): JsonObject | null => {
  const { pixel } = app.lab;
  const found = app.answerTo("explain")?.ok["explanation"];
  if (!pixel || !isObject(found)) return null;
  return String(found["pixel"]) === pixel.join(",") ? found : null;
};

/** What became of a surface over the pixel. */
function fate(c: JsonObject, all: JsonObject[]): string {
  const surfaceOf = (facet: number) => all.find((o) => o["facet"] === facet)?.["surface"] ?? facet;
  switch (c["stage"]) {
    case "visible":
      return t("visible");
    case "hidden": {
      const by = [...new Set(numbers(c["by"]).map(surfaceOf))];
      return by.length ? t("hidden by {0}", by.join(", ")) : t("hidden");
    }
    case "layer":
      return t("layer");
    case "back-face":
      return t("culled: back face");
    case "alpha-test":
      return t("alpha test");
    // Facets without an area on the grid, or with a corner that is no number, are dropped at clipping.
    case "clipped-away":
    case "degenerate":
    case "not-finite":
      return t("clipped away");
    default:
      return t("culled: outside");
  }
}

function surfaces(app: App, explanation: JsonObject): TemplateResult {
  // A surface between the samples is not over the pixel.
  const all = objects(explanation["candidates"]).filter((c) => c["stage"] !== "between-samples");
  const depth = (c: JsonObject) => (typeof c["depth"] === "number" ? c["depth"] : -1);
  const sorted = [...all].sort((a, b) => depth(b) - depth(a));
  const rows = sorted.map((c): Cell[] => [
    c["surface"] as number,
    String(c["mesh"] ?? "–"),
    String(c["material"] || "–"),
    typeof c["depth"] === "number" ? Number(c["depth"].toPrecision(6)) : null,
    fate(c, all),
  ]);
  return table({
    name: t("Surfaces at the pixel"),
    columns: [t("Surface"), t("Mesh"), t("Material"), t("Depth"), t("Fate")],
    rows,
    choices: (row) => choiceOf(app, sorted[row]?.["facet"]),
    caption: true,
  });
}

function decisions(app: App, explanation: JsonObject): TemplateResult {
  const { pixel } = app.lab;
  const asked = app.answers.get("ask-all");
  const isCurrent = asked?.key === askKey(app);
  const all = isCurrent ? objects(asked.value.ok["decisions"]) : objects(explanation["decisions"]);
  const rows = all.map((d): Cell[] => [
    String(d["algorithm"]),
    typeof d["facet"] === "number" ? d["facet"] : t("background"),
    html`${decisionWords(d).map((s) => html`<span class="line">${s}</span>`)}`,
  ]);
  const ask = () => {
    app.answer("ask-all", { want: "ask-all", state: app.state, pixel }, true);
    app.say(t("Asking all algorithms…"), "ask-all");
  };
  return html`${table({ name: t("Decisions"), columns: [t("algorithm"), t("facet"), t("why")], rows, choices: (row) => choiceOf(app, all[row]?.["facet"]), caption: true })}
  ${isCurrent ? nothing : button(t("Ask all algorithms"), ask)}`;
}

/** Why an algorithm decided as it did. Its own words are English. */
function decisionWords(decision: JsonObject): string[] {
  const steps = (Array.isArray(decision["steps"]) ? decision["steps"] : []).map(String);
  if (isEnglish()) return steps.slice(0, 30);
  const known = steps.map((s) => /^facet (\d+) comes with depth ([\d.e-]+), .*: facet (\d+) stays$/.exec(s));
  if (steps.length && known.every((k) => k)) return known.map((k) => t("facet {0}, depth {1}: {2} stays", k![1]!, k![2]!, k![3]!));
  return [t("{0} steps", steps.length)];
}

const askKey = (app: App) => JSON.stringify({ want: "ask-all", state: app.state, pixel: app.lab.pixel });

/** Light below this is no light in any picture. */
const TINY = 1e-7;

/** A colour or a vector with 4 digits: the rows' sum comes out to less than half a byte. */
const three = (v: Json | undefined) => numbers(v).slice(0, 3).map((n) => number(Math.abs(n) < TINY ? 0 : Number(n.toPrecision(4)))).join(" ");

/** Rows of light that are shown at first. */
const MOST_ROWS = 24;

/** Whether all rows of light are shown. */
let showsAllLight = false;

const isOne = (color: readonly number[]) => color.every((c) => Math.abs(c - 1) < 1e-6);

/** Three numbers, or one where they are the same. */
const oneOrThree = (v: number[]) => (v.every((c) => Math.abs(c - v[0]!) < 1e-6) ? number(Number(v[0]!.toPrecision(4))) : three(v));

function light(app: App, explanation: JsonObject): unknown {
  const found = pixelSum(explanation, app.get("settings.color-space") === "raw");
  if (!found) return nothing;
  const { points, sum } = found;
  const shown = showsAllLight ? found.rows : firstRows(found.rows, MOST_ROWS);
  const names = (app.answerTo("explain")?.ok["lights"] as string[] | undefined) ?? [];
  const candidates = objects(explanation["candidates"]);
  const several = new Set(found.rows.map((r) => r.point).filter((p) => p !== null)).size > 1;
  const hasShare = found.rows.some((r) => r.share && !isOne(r.share));
  const hasWeight = found.rows.some((r) => r.corner !== null);
  let head = "R·V";

  /** What a row is about: the light, and where there are more than one, surface and corner. */
  const nameOf = (r: LightRow): string => {
    const kinds: Record<Exclude<LightRow["kind"], "light">, string> = {
      scene: t("scene"),
      other: t("other light"),
      background: t("background"),
      lines: t("lines and dots"),
      mirrored: t("mirrors and glass"),
      rest: t("{0} more rows", r.count ?? 0),
    };
    const name = r.kind === "light" ? (names[r.light!] ?? `LIGHT${r.light}`) : kinds[r.kind];
    const facet = r.point === null ? null : points[r.point]!["facet"];
    const surface = candidates.find((c) => c["facet"] === facet)?.["surface"];
    const where = [
      several && r.point !== null ? (surface === undefined ? t("facet {0}", String(facet)) : t("surface {0}", String(surface))) : "",
      r.corner === null ? "" : t("corner {0}", r.corner),
    ].filter(Boolean);
    return where.length ? `${name} (${where.join(", ")})` : name;
  };
  const rows = shown.map((r): Cell[] => {
    const highlight = isObject(r.terms?.["highlight"]) ? r.terms["highlight"] : null;
    if (highlight?.["h"]) head = "N·H";
    const S = numbers(r.terms?.["visibility"]);
    const shadow = r.point === null ? undefined : objects(points[r.point]!["shadows"]).find((s) => s["light"] === r.light);
    const blocked = shadow && typeof shadow["blocker"] === "number" && S.some((v) => v < 1);
    const short = (v: Json | undefined) => (typeof v === "number" ? Number(v.toPrecision(4)) : null);
    return [
      nameOf(r),
      short(r.terms?.["n-l"]),
      short(highlight?.["cosine"]),
      short(r.terms?.["attenuation"]),
      r.terms ? `${three(S)}${blocked ? ` (${t("facet {0}", String(shadow["blocker"]))})` : ""}` : null,
      ...(hasShare ? [r.share && oneOrThree(r.share)] : []),
      ...(hasWeight ? [r.corner === null ? null : short(r.weight)] : []),
      r.ambient && three(r.ambient),
      r.diffuse && three(r.diffuse),
      r.specular && three(r.specular),
      three(r.sum),
    ];
  });
  const factors = [...(hasShare ? [t("share")] : []), ...(hasWeight ? [t("× weight")] : [])];
  rows.push([t("sum"), null, null, null, null, ...factors.map(() => null), null, null, null, three(sum)]);

  const whole = isObject(explanation["light"]) ? explanation["light"] : {};
  const toggle = () => {
    showsAllLight = !showsAllLight;
    app.changed();
  };
  const more =
    found.rows.length > MOST_ROWS ? button(showsAllLight ? t("Show the first {0} rows", MOST_ROWS) : t("Show all {0} rows", found.rows.length), toggle) : nothing;
  return html`${table({
    name: t("Light at the pixel"),
    columns: [t("light"), "L·N", head, "f_att", "S", ...factors, t("ambient"), t("diffuse"), t("specular"), t("sum")],
    rows,
    current: rows.length - 1,
    caption: true,
  })}
  ${more}
  ${hasShare ? html`<p class="note">${t("share: the part of the samples that show the surface, times what layers in front let through, times its opacity")}</p>` : nothing}
  ${hasWeight ? html`<p class="note">${t("× weight: how the pixel weighs the corner; the rows are multiplied with share and weight")}</p>` : nothing}
  <p class="note">${t("Sum of the samples: {0}; bytes: {1}", three(whole["straight"]), numbers(explanation["bytes"]).slice(0, 3).join(" "))}</p>`;
}

interface RayNode extends Node {
  facet: number | null;
  /** How it goes on from the one that sent it. */
  way: string | null;
}

/** The rays of the pixel: a ray hangs below the one that sent it. */
export function rayNodes(app: App): RayNode[] {
  const senders = new Map<string, { id: number; way: string; angles: number[] }>();
  return objects(explanationOf(app)?.["rays"]).map((ray, id) => {
    const sender = senders.get(JSON.stringify(ray["direction"]));
    for (const on of objects(ray["goes-on"])) {
      senders.set(JSON.stringify(on["direction"]), { id, way: String(on["way"]), angles: numbers(on["angles"]) });
    }
    const met = isObject(ray["meets"]) ? ray["meets"] : null;
    const what = met ? t("surface {0} of {1}, distance {2}", String(met["surface"]), String(met["mesh"] || "–"), number(Number(met["distance"]))) : t("background");
    const how = sender ? `${translated(sender.way)} (${sender.angles.map((a) => `${a.toFixed(1)}°`).join(" → ")}): ` : "";
    const facet = typeof met?.["facet"] === "number" ? met["facet"] : null;
    return { id, parent: sender?.id ?? null, text: () => how + what, choice: () => choiceOf(app, facet), facet, way: sender ? translated(sender.way) : null };
  });
}

/** `tree "Ray tree"` of the pixel. */
export function rayTree(app: App): unknown {
  const nodes = rayNodes(app);
  if (!nodes.length) return nothing;
  return html`<div class="labelled"><p class="label">${t("Ray tree")}</p>${tree({ name: t("Ray tree"), nodes, isChosen: chosenFinder(app) }, () => app.changed())}</div>`;
}

/** `table "Increments"`: Gouraud's intensities on all lines of the facet, that of the pixel marked. */
export function increments(app: App, explanation: JsonObject | null): unknown {
  const g = explanation?.["gouraud"];
  const pixel = numbers(explanation?.["pixel"]);
  if (!isObject(g)) return nothing;
  const edges = objects(g["edges"]);
  const columns = [t("line"), "I1", "I2", "py", "px", t("additions"), t("incremental"), t("direct")];
  const own: Cell[] = [
    pixel[1] ?? null,
    ...[0, 1].map((i) => three(edges[i]?.["intensity"])),
    edges.map((e) => three(e["py"])).join("; "),
    three(g["px"]),
    (g["additions"] as number | undefined) ?? null,
    three(g["intensity"]),
    three(g["direct"]),
  ];
  const lines = objects(g["lines"]);
  if (!lines.length) return table({ name: t("Increments"), columns, rows: [own], caption: true });

  // Other lines tell of their last pixel, the pixel's line of the pixel.
  const current = lines.findIndex((l) => l["row"] === pixel[1]);
  const row = (l: JsonObject): Cell[] => [
    l["row"] as number,
    ...["i1", "i2", "py", "px"].map((k) => three(l[k])),
    l["additions"] as number,
    three(l["incremental"]),
    three(l["direct"]),
  ];
  const rows = lines.map((l, i) => (i === current ? own : row(l)));
  const name = t("Increments");
  return html`${table({ name, columns, rows, current: current < 0 ? undefined : current, caption: true }, () => app.changed())}
    <p class="note">${t("The marked line is added up to the pixel, the others to their last pixel.")}</p>`;
}

/** Whether region Structure shows the ray tree. */
export const hasOwnRays = (app: App) => app.hasSteps && app.get("settings.global") === "ray-trace";

export function pixelRegion(app: App): TemplateResult {
  const { pixel } = app.lab;
  const explanation = explanationOf(app);
  const [x, y] = pixel ?? [null, null];
  const middle: [number, number] = [Math.floor(app.width / 2), Math.floor(app.height / 2)];
  const set = (at: 0 | 1) => (value: number) => {
    const to: [number, number] = [...(pixel ?? middle)];
    to[at] = value;
    app.inspect(to);
  };
  const why = (app.answerTo("explain")?.ok["why"] as string[] | undefined) ?? [];
  return html`<section class="region pixel" aria-labelledby="pixel-title">
    <h2 id="pixel-title">${t("Pixel")}</h2>
    <div class="row-of-fields">
      ${spin("x", x, set(0), { name: t("Pixel x"), min: 0, max: app.width - 1, step: 1 })}
      ${spin("y", y, set(1), { name: t("Pixel y"), min: 0, max: app.height - 1, step: 1 })}
      ${pixel ? button(t("Clear"), () => app.inspect(null)) : nothing}
    </div>
    ${pixel ? nothing : html`<p class="note">${t("Double-click in the picture, or press Enter there.")}</p>`}
    ${explanation
      ? html`${app.hasSteps ? nothing : chosenWords(app)}
          <p class="why">${why.map((s) => whyWords(s)).join(" ")}</p>
          ${surfaces(app, explanation)} ${depthNote()} ${decisions(app, explanation)} ${light(app, explanation)} ${hasOwnRays(app) ? nothing : rayTree(app)}
          ${app.lab.page === "shading" ? nothing : increments(app, explanation)}`
      : nothing}
  </section>`;
}
