// The light of a pixel as rows that add up to its bytes.
//
// A pixel is the mean of its samples. Each sample shows layers, one behind the other, and an opaque
// point or the background. So a point counts with the share of the samples that show it, times what
// the layers in front let through, and each of its terms with its opacity and the weight of the
// corner where the formula was evaluated.

import { isObject, type Json, type JsonObject } from "./json.ts";

export type Rgb = [number, number, number];

export interface LightRow {
  kind: "light" | "scene" | "other" | "background" | "lines" | "mirrored" | "rest";
  /** Place in the list of the pixel's points; none for what belongs to no point. */
  point: number | null;
  /** The light's number among the scene's. */
  light: number | null;
  corner: number | null;
  /** What the light does there, as the engine tells it. */
  terms: JsonObject | null;
  /** How the pixel counts the point, with its opacity. */
  share: Rgb | null;
  /** The weight of the corner. */
  weight: number;
  /** What the row adds to the pixel. */
  ambient: Rgb | null;
  diffuse: Rgb | null;
  specular: Rgb | null;
  sum: Rgb;
  /** How many rows this one stands for. */
  count?: number;
}

export interface PixelSum {
  rows: LightRow[];
  /** The points that the pixel shows. */
  points: JsonObject[];
  /** All rows added up: the mean of the samples, with what mirrors and glass show. */
  sum: Rgb;
}

const objects = (v: Json | undefined): JsonObject[] => (Array.isArray(v) ? v.filter(isObject) : []);
const rgb = (v: Json | undefined): Rgb => [0, 1, 2].map((i) => (Array.isArray(v) ? Number(v[i] ?? 0) : 0)) as Rgb;
const each = (f: (i: number) => number): Rgb => [f(0), f(1), f(2)];
const times = (a: Rgb, b: Rgb | number): Rgb => each((i) => a[i]! * (typeof b === "number" ? b : b[i]!));
const plus = (a: Rgb, b: Rgb): Rgb => each((i) => a[i]! + b[i]!);
const minus = (a: Rgb, b: Rgb): Rgb => each((i) => a[i]! - b[i]!);

const ZERO: Rgb = [0, 0, 0];
const ONE: Rgb = [1, 1, 1];

/** Light below this changes no byte: the steepest part of the display's curve has 3295 bytes for 1. */
const NOTHING = 2e-6;

const isSomething = (color: Rgb) => color.some((c) => Math.abs(c) > NOTHING);

/** What part of the pixel shows each point, the background, and lines and dots. */
function shares(samples: JsonObject[], count: number): { points: Rgb[]; background: Rgb; lines: Rgb } {
  const points: Rgb[] = Array.from({ length: count }, () => ZERO);
  let [background, lines]: [Rgb, Rgb] = [ZERO, ZERO];
  const add = (point: Json | undefined, share: Rgb) => {
    if (typeof point === "number" && points[point]) points[point] = plus(points[point], share);
    return typeof point === "number";
  };
  for (const sample of samples) {
    let through = times(ONE, 1 / samples.length);
    for (const layer of objects(sample["layers"])) {
      if (!add(layer["point"], through)) lines = plus(lines, times(through, rgb(layer["color"])));
      through = times(through, rgb(layer["passes"]));
    }
    if (!add(sample["point"], through)) background = plus(background, times(through, rgb(sample["behind"])));
  }
  return { points, background, lines };
}

/** The rows of a point that the pixel counts with `share`. */
function rowsOfPoint(point: JsonObject, index: number, share: Rgb): LightRow[] {
  const alpha = Number(point["alpha"] ?? 1);
  const cue = isObject(point["depth-cue"]) ? Number(point["depth-cue"]["kept"] ?? 1) : 1;
  const evaluations = objects(point["evaluations"]);
  const whole = times(share, alpha * cue);
  // Gouraud's corners know nothing of the texture, which varies between them.
  const matte = evaluations.length > 1 ? times(whole, rgb(point["texture"])) : whole;
  const shiny = times(share, cue * (point["keeps-specular"] === true ? Number(point["coverage"] ?? 1) : alpha));

  const rows: LightRow[] = [];
  let scene: Rgb = ZERO;
  for (const evaluation of evaluations) {
    const weight = Number(evaluation["weight"] ?? 1);
    scene = plus(scene, times(matte, times(rgb(evaluation["ambient"]), weight)));
    for (const terms of objects(evaluation["lights"])) {
      const part = (name: string, factor: Rgb) => times(factor, times(rgb(terms[name]), weight));
      const [ambient, diffuse, specular] = [part("ambient", matte), part("diffuse", matte), part("specular", shiny)];
      const corner = typeof evaluation["corner"] === "number" ? evaluation["corner"] : null;
      const sum = plus(plus(ambient, diffuse), specular);
      rows.push({ kind: "light", point: index, light: Number(terms["light"]), corner, terms, share: whole, weight, ambient, diffuse, specular, sum });
    }
  }
  const own = { point: index, light: null, corner: null, terms: null, share: whole, weight: 1, diffuse: null, specular: null };
  if (evaluations.length) rows.push({ kind: "scene", ...own, ambient: scene, sum: scene });

  // What the point shows besides: its own colour, emission, surroundings, other surfaces.
  const other = rows.reduce((left, row) => minus(left, row.sum), times(share, rgb(point["color"])));
  if (isSomething(other) || !evaluations.length) rows.push({ kind: "other", ...own, ambient: null, sum: other });
  return rows;
}

/** What of the light the display's bytes stand for. */
const linear = (byte: number, isRaw: boolean) => {
  const v = byte / 255;
  return isRaw ? v : v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
};

/** The rows of a pixel. */
export function pixelSum(explanation: JsonObject, isRaw: boolean): PixelSum | null {
  const light = isObject(explanation["light"]) ? explanation["light"] : null;
  const samples = objects(light?.["samples"]);
  if (!light || !samples.length) return null;
  const points = objects(light["points"]);
  const found = shares(samples, points.length);
  const rows = points.flatMap((point, i) => (found.points[i]!.some((s) => s > 0) ? rowsOfPoint(point, i, found.points[i]!) : []));

  const alone = { point: null, light: null, corner: null, terms: null, share: null, weight: 1, ambient: null, diffuse: null, specular: null };
  const add = (kind: LightRow["kind"], sum: Rgb) => {
    if (isSomething(sum)) rows.push({ kind, ...alone, sum });
  };
  add("lines", found.lines);
  add("background", found.background);

  // Layers in an order that is not theirs show something else than layers one behind the other.
  const total = () => rows.reduce((sum, row) => plus(sum, row.sum), ZERO);
  add("other", minus(rgb(light["average"]), total()));

  // Rays that mirrors and glass send on are no part of the samples.
  const [shown, own] = [rgb(explanation["bytes"]), rgb(light["bytes"])];
  if (shown.some((byte, i) => byte !== own[i])) {
    const opacity = Number((explanation["bytes"] as number[])[3] ?? 255) / 255;
    const clamped = each((i) => Math.min(1, Math.max(0, total()[i]!)));
    const of = (i: number) => (shown[i] === own[i] ? 0 : opacity * linear(shown[i]!, isRaw) - clamped[i]!);
    add("mirrored", each(of));
  }
  return { rows, points, sum: total() };
}

/** The first rows, and one that stands for the others. */
export function firstRows(rows: LightRow[], most: number): LightRow[] {
  if (rows.length <= most) return rows;
  const rest = rows.slice(most - 1);
  const sum = rest.reduce((total, row) => plus(total, row.sum), ZERO);
  const own = { point: null, light: null, corner: null, terms: null, share: null, weight: 1, ambient: null, diffuse: null, specular: null };
  return [...rows.slice(0, most - 1), { kind: "rest", ...own, sum, count: rest.length }];
}
