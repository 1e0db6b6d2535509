// What single pages show besides: Scene, Pipeline, Visible surfaces, Illumination, Shading.

import { html, nothing, type TemplateResult } from "lit-html";
import { ref } from "lit-html/directives/ref.js";
import type { Picture } from "../answers.ts";
import { type App } from "../app.ts";
import { isObject, put, type Json, type JsonObject } from "../json.ts";
import { attenuationOf } from "../lights.ts";
import { button, combo, radio, spin } from "../parts/fields.ts";
import { drawing } from "../parts/markup.ts";
import { valueText } from "../parts/numbers.ts";
import { table, type Cell } from "../parts/table.ts";
import { depthNote } from "../parts/what.ts";
import { messageWords } from "../why.ts";
import { stagePart, t, translated } from "../words.ts";
import { choiceOf } from "./chosen.ts";
import { depthCue } from "./depth-cue.ts";
import { evaluations } from "./evaluations.ts";
import { facing } from "./facing.ts";
import { lightArrays } from "./light-arrays.ts";
import { lostHighlight } from "./lost-highlight.ts";
import { phongAndBlinn } from "./phong-blinn.ts";
import { show } from "./picture.ts";
import { profile } from "./profile.ts";
import { explanationOf, increments, objects } from "./pixel.ts";
import { sceneValue } from "./scene-values.ts";

// ---- Scene ----

export function scene(app: App): TemplateResult {
  const answer = app.answerTo("info")?.ok;
  const rows = objects(answer?.["rows"]).map((r): Cell[] => [translated(String(r["name"])), sceneValue(r["value"])]);
  const warnings = [...new Set([...((answer?.["warnings"] as string[] | undefined) ?? []), ...(app.picture?.value.warnings ?? [])])];
  return html`<section class="region" aria-labelledby="scene-title">
    <h2 id="scene-title">${t("Scene")}</h2>
    ${table({ name: t("Scene"), columns: [t("name"), t("value")], rows })} ${lightArrays(app)}
    ${warnings.length ? html`<ul class="warnings">${warnings.map((w) => html`<li>${messageWords(w)}</li>`)}</ul>` : nothing}
  </section>`;
}

// ---- Pipeline ----

export function pipeline(app: App): TemplateResult {
  const answer = app.answerTo("stages")?.ok;
  const rows = objects(answer?.["stages"]).map((s): Cell[] => [translated(String(s["stage"])), stagePart(String(s["in"])), stagePart(String(s["out"]))]);
  return html`<section class="region" aria-labelledby="stages-title">
    <h2 id="stages-title">${t("Stages")}</h2>
    ${table({ name: t("Stages"), columns: [t("stage"), t("in"), t("out")], rows })} ${vertices(app, answer)} ${depthNote()} ${facing(app, answer)} ${projector(answer)}
  </section>`;
}

/** The corners of the facet at the pixel, in each space. */
function vertices(app: App, answer: JsonObject | undefined): unknown {
  if (!app.lab.pixel) return html`<p class="note">${t("Inspect a pixel to see the vertices of its facet in every space.")}</p>`;
  const spaces = isObject(answer?.["spaces"]) ? (answer["spaces"] as JsonObject) : null;
  if (!spaces || !Object.keys(spaces).length) return nothing;
  const rows: Cell[][] = [];
  for (const space of ["model", "world", "view", "clip", "ndc", "screen"]) {
    objects(spaces[space]).forEach((vertex, i) => {
      const value = (k: string) => (typeof vertex[k] === "number" ? Number((vertex[k] as number).toPrecision(5)) : null);
      rows.push([t(space as "world"), i, ...["x", "y", "z", "w"].map(value)]);
    });
  }
  return table({ name: t("Vertices"), columns: [t("space"), t("corner"), "x", "y", "z", "w"], rows, caption: true });
}

/** Two points of the pixel's projector: before the perspective transformation four divisions tell that, after it none. */
function projector(answer: JsonObject | undefined): unknown {
  const points = objects(answer?.["projector"]);
  if (points.length < 2) return nothing;
  const numbers = (v: Json | undefined, i: number) => (Array.isArray(v) ? Number(Number(v[i]).toPrecision(6)) : null);
  const rows = points.map((p, i): Cell[] => [
    `${i === 0 ? "P" : "Q"}${p["mesh"] ? ` (${String(p["mesh"])})` : ""}`,
    ...[0, 1, 2].map((k) => numbers(p["view"], k)),
    ...[0, 1].map((k) => numbers(p["quotients"], k)),
    ...[0, 1, 2].map((k) => numbers(p["after"], k)),
  ]);
  return html`${table({
      name: t("Two points of the projector"),
      columns: [t("point"), "x", "y", "z", "x / z", "y / z", "x′", "y′", "z′"],
      rows,
      caption: true,
    })}
    <p class="note">${t("Before the transformation, four divisions show that P and Q lie on one projector; two more are needed where depths are compared along it. After it x′ and y′ are equal, and the larger z′ is nearer.")}</p>`;
}

// ---- Visible surfaces ----

export function compareAll(app: App): TemplateResult {
  const key = JSON.stringify({ want: "compare-all", state: app.state });
  const answer = app.answers.get("compare-all");
  const order = (app.catalog?.algorithms["visibility"] ?? []).map((a) => a.name);
  const place = (r: JsonObject) => order.indexOf(String(r["algorithm"]).split(" ")[0]!);
  const rows = answer?.key === key ? objects(answer.value.ok["rows"]).sort((a, b) => place(a) - place(b)) : [];
  const precision = (r: JsonObject) => {
    const found = app.catalog?.algorithms["visibility"]?.[place(r)]?.["precision"];
    return typeof found === "string" ? translated(found) : "–";
  };
  const triangles = app.picture?.value.facts["triangles"];
  const ask = () => {
    app.answer("compare-all", { want: "compare-all", state: app.state }, true);
    app.say(t("Comparing all algorithms…"), "compare-all");
  };
  const counters = (v: Json | undefined) =>
    isObject(v)
      ? Object.entries(v)
          .filter(([, n]) => typeof n === "number")
          .map(([k, n]) => `${k} ${valueText(n)}`)
          .join(", ")
      : "–";
  return html`<section class="region" aria-labelledby="all-title">
    <h2 id="all-title">${t("All algorithms")}</h2>
    ${rows.length
      ? html`${table({
          name: t("All algorithms"),
          columns: [t("algorithm"), t("precision"), t("milliseconds"), t("memory, kB"), t("pixels that differ"), t("counters")],
          rows: rows.map((r): Cell[] => [
            String(r["algorithm"]),
            precision(r),
            typeof r["seconds"] === "number" ? Math.round(r["seconds"] * 10000) / 10 : null,
            typeof r["memory"] === "number" && r["memory"] > 0 ? Math.max(1, Math.round(r["memory"] / 1024)) : null,
            (r["differ"] as number | undefined) ?? null,
            html`<span class="counted">${r["limit"] ? String(r["limit"]) : counters(r["counters"])}</span>`,
          ]),
        })}
        <p class="note">${t("n = {0} triangles, p = {1} pixels", String(triangles ?? "–"), app.width * app.height)}</p>
        <ul class="notes">
          <li><strong>${t("precision")}</strong>: ${t("image: decided for each pixel, with its aliasing; object: for whole polygons, whatever the resolution")}</li>
          <li><strong>${t("milliseconds")}</strong>: ${t("of a picture after the first, which also builds what an algorithm keeps, such as trees")}</li>
          <li><strong>${t("memory, kB")}</strong>: ${t("what it keeps besides the picture; –: nothing")}</li>
          <li><strong>${t("pixels that differ")}</strong>: ${t("from the first algorithm's picture; 0: all agree")}</li>
          <li><strong>${t("counters")}</strong>: ${t("what the algorithm counted; those that are 0 are left out")}</li>
        </ul>`
      : html`<p class="note">${t("Draws this scene with every algorithm and compares time, memory and pictures.")}</p>`}
    ${button(t("Compare all"), ask)}
  </section>`;
}

// ---- Illumination ----

/** The exponent whose curve is shown, and the light whose attenuation. */
let ns = 20;

/** Lines of a curve's drawing: points and a class of the style sheet. */
interface Graph {
  points: number[][];
  style: string;
}

/** The plane of a curve: the range of x, and the largest y that is shown. */
interface Frame {
  first: number;
  last: number;
  most: number;
}

const plotX = (f: Frame, x: number) => 24 + ((x - f.first) / (f.last - f.first)) * 250;
const plotY = (f: Frame, y: number) => 130 - (y / f.most) * 115;

/** A curve with its axes and a mark. */
function curve(name: string, frame: Frame, graphs: Graph[], mark: [number, number] | null, labels: [string, string], more = ""): TemplateResult {
  const [X, Y] = [(x: number) => plotX(frame, x).toFixed(1), (y: number) => plotY(frame, y).toFixed(1)];
  const path = ({ points, style }: Graph) =>
    points.length ? `<path class="${style}" d="${points.map(([x = 0, y = 0], i) => `${i ? "L" : "M"}${X(x)} ${Y(y)}`).join("")}"/>` : "";
  const marked = mark
    ? `<circle class="mark" cx="${X(mark[0])}" cy="${Y(mark[1])}" r="4"/><path class="guide" d="M${X(mark[0])} 130V${Y(mark[1])}H24"/>`
    : "";
  const text =
    `<svg viewBox="0 0 290 152"><path class="axes" d="M24 10V130H280"/><text x="4" y="${Number(Y(1)) + 4}">1</text><text x="4" y="134">0</text>` +
    `<text x="24" y="147">${labels[0]}</text><text x="274" y="147" text-anchor="end">${labels[1]}</text>` +
    `${graphs.map(path).join("")}${more}${marked}</svg>`;
  return html`<div class="curve" role="img" aria-label=${name}>${drawing(text, name)}</div>`;
}

/** Half of 1 on the curve of cosⁿ: as wide as the highlight is where it is half as bright. */
function halfWidth(frame: Frame, half: number): string {
  const [left, right] = [plotX(frame, -half), plotX(frame, half)].map((x) => x.toFixed(1));
  const y = plotY(frame, 0.5).toFixed(1);
  const mark = (x: string) => `<circle class="half" cx="${x}" cy="${y}" r="3"/>`;
  return `<path class="half" d="M${left} ${y}H${right}"/>${mark(left!)}${mark(right!)}<text class="words" x="${Math.min(Number(right) + 6, 210)}" y="${Number(y) + 4}">±${half.toFixed(1)}°</text>`;
}

/** Largest distance of the attenuation curve, and the largest factor that is shown. */
const FARTHEST = 10;
const ATTENUATION: Frame = { first: 0, last: FARTHEST, most: 1.6 };

/** A law of attenuation: what is above 1 is clamped, and shown dotted. */
function attenuationGraphs(law: (d: number) => number, style: string): Graph[] {
  const all = Array.from({ length: 401 }, (_, i) => (i / 400) * FARTHEST).map((d) => [d, law(d)]);
  const beyond = all.filter(([, y = 0]) => y > 1 && y <= ATTENUATION.most);
  return [
    { points: beyond, style: `${style} beyond` },
    { points: all.map(([d = 0, y = 0]) => [d, Math.min(1, y)]), style },
  ];
}

const pointsOf = (app: App, name: string) => ((app.answerTo(name)?.ok["points"] as number[][] | undefined) ?? []).map((p) => [...p]);

export function illumination(app: App): TemplateResult {
  app.answer("cos-n", { want: "curve", what: "cos-n", ns });
  const explanation = explanationOf(app);
  const whole = isObject(explanation?.["light"]) ? (explanation["light"] as JsonObject) : {};
  const evaluation = objects(objects(whole["points"])[0]?.["evaluations"])[0];
  const lit = objects(evaluation?.["lights"]).filter((l) => typeof l["light"] === "number");
  const own = lit.find((l) => isObject(l["highlight"])) ?? lit[0];
  const highlight = isObject(own?.["highlight"]) ? (own["highlight"] as JsonObject) : null;
  const angle = highlight ? (Math.acos(Math.min(1, Math.max(-1, Number(highlight["cosine"])))) * 180) / Math.PI : null;
  const half = (Math.acos(2 ** (-1 / ns)) * 180) / Math.PI;

  const light = app.complete?.value.lights[app.lightNumber];
  const c = light ? attenuationOf(light) : [1, 0, 0];
  const distance = Number(lit.find((l) => l["light"] === app.lightNumber)?.["distance"] ?? NaN);
  const attenuated = Number.isFinite(distance) && distance <= FARTHEST ? Math.min(1, 1 / (c[0]! + c[1]! * distance + c[2]! * distance ** 2)) : null;
  const law = (d: number) => 1 / Math.max(1e-9, c[0]! + c[1]! * d + c[2]! * d * d);
  const square = (d: number) => 1 / Math.max(1e-9, d * d);
  const cosine: Frame = { first: -90, last: 90, most: 1 };
  const set = (value: number) => {
    ns = value;
    app.changed();
  };
  return html`${terms(app)}
    <section class="region" aria-labelledby="curves-title">
      <h2 id="curves-title">${t("Curves")}</h2>
      <div class="curves">
        <div>
          ${curve(
            t("cos^n curve"),
            cosine,
            [{ points: pointsOf(app, "cos-n"), style: "graph" }],
            angle !== null ? [angle, Math.max(0, Math.cos((angle * Math.PI) / 180)) ** ns] : null,
            ["−90°", "90°"],
            halfWidth(cosine, half),
          )}
          <p class="caption">cosⁿ Ω, ${t("half width {0} degrees", half.toFixed(2))} = acos 2<sup>−1/n</sup></p>
          ${spin("n", ns, set, { name: t("Exponent n"), min: 1, max: 200, step: 1 })}
        </div>
        <div>
          ${curve(
            t("Attenuation curve"),
            ATTENUATION,
            [...attenuationGraphs(square, "square"), ...attenuationGraphs(law, "graph")],
            attenuated !== null ? [distance, attenuated] : null,
            ["d = 0", String(FARTHEST)],
          )}
          <p class="legend">
            <span><i class="swatch graph" aria-hidden="true"></i>${t("solid")}: min(1, 1 / (${c[0]} + ${c[1]} d + ${c[2]} d²))</span>
            <span><i class="swatch square" aria-hidden="true"></i>${t("dashed")}: min(1, 1 / d²)</span>
            <span>${t("dotted: above 1, where it is clamped")}</span>
          </p>
          <button type="button" @click=${() => app.dialogs.open("lights")}>${t("Lights…")}</button>
        </div>
      </div>
    </section>
    ${phongAndBlinn(app)} ${depthCue(app)}`;
}

/** The terms of the formula, apart and together. */
function terms(app: App): TemplateResult {
  const only = (term: string | null) => small(put(app.state, "light-term", term));
  const views: [string, string | null][] = [
    [t("Ambient term"), "ambient"],
    [t("Diffuse term"), "diffuse"],
    [t("Specular term"), "specular"],
    [t("Together"), null],
  ];
  return html`<section class="region" aria-labelledby="terms-title">
    <h2 id="terms-title">${t("Terms")}</h2>
    <div class="thumbnails">
      ${views.map(([name, term], i) => thumbnail(app, `term ${i}`, name, only(term), () => app.set({ "light-term": term })))}
    </div>
  </section>`;
}

const small = (state: JsonObject) => put(put(state, "settings.width", 240), "settings.height", 180);

/** A small picture of a state. */
function thumbnail(app: App, key: string, name: string, state: JsonObject, choose?: () => void): TemplateResult {
  if (!app.isDragging && !app.isBusy) app.answer(key, { want: "picture", state });
  const answer = app.answers.get(key);
  const picture = answer?.value.ok as unknown as Picture | undefined;
  let plane = planes.get(key);
  if (answer && picture && plane?.key !== answer.key) {
    plane = { key: answer.key, value: { bytes: answer.value.planes[0] ?? new Uint8Array(), width: picture.width, height: picture.height } };
    planes.set(key, plane);
  }
  const canvas = html`<canvas width="240" height="180" role="img" aria-label=${name} ${ref((e) => show(e as HTMLCanvasElement | undefined, plane))}></canvas>`;
  return html`<figure>${canvas}<figcaption>${choose ? html`<button type="button" class="link" @click=${choose}>${name}</button>` : name}</figcaption></figure>`;
}

const planes = new Map<string, { key: string; value: { bytes: Uint8Array; width: number; height: number } }>();

// ---- Shading ----

/** The classical defects: the figure, what shows it, what cures it. */
const DEFECTS: { model: string; name: Parameters<typeof t>[0]; cure: Parameters<typeof t>[0]; defect: JsonObject; cured: JsonObject }[] = [
  { model: "defect-silhouette", name: "Polygonal silhouette", cure: "finer polygons (right)", defect: {}, cured: {} },
  { model: "defect-perspective", name: "Perspective distortion", cure: "interpolation in perspective", defect: { interpolation: "linear" }, cured: { interpolation: "perspective" } },
  { model: "defect-orientation", name: "Dependence on orientation", cure: "smaller quads (right), or Phong shading", defect: { shading: "gouraud" }, cured: { shading: "phong" } },
  { model: "defect-shared-vertices", name: "Vertices not shared", cure: "vertices on both sides (right), or Phong shading", defect: { shading: "gouraud" }, cured: { shading: "phong" } },
  { model: "defect-normals", name: "Unrepresentative normals", cure: "the faces' own normals", defect: { shading: "gouraud" }, cured: { shading: "flat" } },
];

/** Where the normals at the corners come from. */
function normals(app: App): TemplateResult {
  const chosen = String(app.get("load.normals") ?? "file");
  const crease = app.get("load.crease-angle");
  const options = [
    { value: "file", text: t("as the file has them") },
    { value: "made", text: t("made from the faces") },
    { value: "none", text: t("none") },
  ];
  const degrees = typeof crease === "number" ? (crease * 180) / Math.PI : 40;
  return html`<section class="region" aria-labelledby="normals-title">
    <h2 id="normals-title">${t("Normals at the corners")}</h2>
    <div class="fields">
      ${combo(t("Normals at the corners"), chosen, options, (v) => app.set({ "load.normals": v }))}
      ${spin(t("Crease angle"), degrees, (v) => app.set({ "load.crease-angle": (v * Math.PI) / 180 }), {
        min: 0,
        max: 180,
        step: 1,
        reason: chosen === "made" ? null : t("for normals that are made"),
      })}
    </div>
    ${cornerNormals(app)}
    <p class="note">${t("Faces that differ by less than the crease angle share the mean of their normals; between others there is an edge.")}</p>
  </section>`;
}

/** The corner whose normals are shown. */
let cornerNumber = 0;

/** The normals that meet at a corner of the pixel's facet: those of the faces, their mean, and what is used. */
function cornerNormals(app: App): unknown {
  const corners = objects(app.answerTo("explain")?.ok["normals"]);
  if (!explanationOf(app) || !corners.length) return nothing;
  const corner = corners[cornerNumber] ?? corners[0]!;
  const words = (c: JsonObject, i: number) => t("corner {0}, vertex {1}", i, String(c["vertex"]));
  const coordinates = (v: Json | undefined): Cell[] => [0, 1, 2].map((i) => (Array.isArray(v) ? Number(Number(v[i]).toFixed(4)) : null));
  const faces = objects(corner["faces"]);
  const rows: Cell[][] = [
    ...faces.map((f): Cell[] => [t("facet {0}", Number(f["facet"])), ...coordinates(f["normal"])]),
    [t("mean of the faces"), ...coordinates(corner["mean"])],
    [t("mean of the triangles, each once"), ...coordinates(corner["mean-of-triangles"])],
    [t("result"), ...coordinates(corner["result"])],
  ];
  const choose = (value: string) => {
    cornerNumber = Number(value);
    app.changed();
  };
  return html`${combo(t("Corner"), String(corners.indexOf(corner)), corners.map((c, i) => ({ value: String(i), text: words(c, i) })), choose)}
    ${table({
      name: t("Normals at the corners"),
      columns: [t("normal"), "x", "y", "z"],
      rows,
      choices: (row) => choiceOf(app, faces[row]?.["facet"]),
      current: rows.length - 1,
      caption: true,
    })}`;
}

export function shading(app: App): TemplateResult {
  const { state } = app;
  const one = (name: string) =>
    thumbnail(app, `shading ${name}`, name, small(put(state, "settings.shading", name)), () => app.set({ "settings.shading": name }));
  const model = String((app.get("models") as string[] | undefined)?.[0] ?? "");
  const open = (d: (typeof DEFECTS)[number]) => {
    app.openModels([`builtin:${d.model}`]);
    app.set(Object.fromEntries(Object.entries({ shading: "phong", interpolation: "perspective", ...d.defect }).map(([k, v]) => [`settings.${k}`, v])));
  };
  const shown = DEFECTS.find((d) => model === `builtin:${d.model}`);
  const compareCure = (d: (typeof DEFECTS)[number]) => {
    for (const [k, v] of Object.entries(d.cured)) app.set({ [`settings.${k}`]: v }, "b");
    app.setLab({ compare: "side" });
  };
  return html`<section class="region" aria-labelledby="shading-title">
      <h2 id="shading-title">${t("Flat, Gouraud, Phong")}</h2>
      <div class="thumbnails three">${["flat", "gouraud", "phong"].map(one)}</div>
      ${lostHighlight(app)}
    </section>
    ${evaluations(app)} ${profile(app)} ${normals(app)}
    <section class="region" aria-labelledby="defects-title">
      <h2 id="defects-title">${t("Defects of interpolated shading")}</h2>
      <div class="list">${DEFECTS.map((d) => radio(t(d.name), "defect", d === shown, () => open(d)))}</div>
      ${shown
        ? html`<p class="note">${t("Cure")}: ${t(shown.cure)}.</p>
            ${Object.keys(shown.cured).length ? button(t("Compare with the cure"), () => compareCure(shown)) : nothing}`
        : nothing}
    </section>
    <section class="region" aria-labelledby="increments-title">
      <h2 id="increments-title">${t("Increments")}</h2>
      ${app.get("settings.shading") === "gouraud" && app.lab.pixel
        ? increments(app, explanationOf(app))
        : html`<p class="note">${t("Choose Gouraud shading and inspect a pixel to see its line, increment by increment.")}</p>`}
    </section>`;
}
