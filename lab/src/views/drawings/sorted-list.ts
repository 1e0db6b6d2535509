// The painter's list: replayed from the first order, and drawn beside it.

import { nothing, svg, type TemplateResult } from "lit-html";
import type { App } from "../../app.ts";
import type { Json, JsonObject } from "../../json.ts";
import { t } from "../../words.ts";
import { chosenFinder, isChosen } from "../chosen.ts";
import { doneOf, leftOut, numbers, objects, stepsOf, wholeStep } from "../recorded.ts";
import { around, sheet } from "./sheet.ts";

export type EntryState = "painted" | "moved" | "part" | "waits" | "split";

export interface Entry {
  polygon: number;
  facet: number | null;
  state: EntryState;
  /** The step in which it was painted. */
  at: Json;
}

export interface SortedList {
  first: Entry[];
  /** What is painted, then what waits, the farthest first. */
  list: Entry[];
}

/** What the list is without what is painted. */
interface Replayed {
  order: JsonObject[];
  moves: JsonObject[];
  splits: JsonObject[];
  waiting: number[];
  moved: Set<number>;
  parts: Set<number>;
  gone: Set<number>;
  facets: Map<number, number>;
}

/** The list that was replayed last. */
let replayed: Replayed | undefined;

/** Takes the changes of the list in the order of their steps. */
function replay(order: JsonObject[], moves: JsonObject[], splits: JsonObject[]): Replayed {
  if (replayed?.order === order && replayed.moves === moves && replayed.splits === splits) return replayed;
  const far = new Map(order.map((p) => [Number(p["polygon"]), Number(p["far"])]));
  const facets = new Map(order.map((p) => [Number(p["polygon"]), Number(p["facet"])]));
  const [moved, parts, gone] = [new Set<number>(), new Set<number>(), new Set<number>()];
  const waiting = order.map((p) => Number(p["polygon"]));
  const changes = [...moves, ...splits].sort((a, b) => Number(a["at"]) - Number(b["at"]));
  for (const change of changes) {
    const polygon = Number(change["polygon"]);
    const from = waiting.indexOf(polygon);
    if (from >= 0) waiting.splice(from, 1);
    if (change["step"] === "moved") {
      moved.add(polygon);
      waiting.splice(Math.max(0, waiting.indexOf(Number(change["before_polygon"]))), 0, polygon);
      continue;
    }
    // Parts wait by their own depths.
    gone.add(polygon);
    for (const p of numbers(change["unmarked"])) moved.delete(p);
    for (const part of objects(change["parts"])) {
      const [number, depth] = [Number(part["polygon"]), Number(part["far"])];
      parts.add(number);
      far.set(number, depth);
      facets.set(number, Number(part["facet"]));
      const place = waiting.findIndex((p) => !moved.has(p) && (far.get(p) ?? 0) > depth);
      waiting.splice(place < 0 ? waiting.length : place, 0, number);
    }
  }
  replayed = { order, moves, splits, waiting, moved, parts, gone, facets };
  return replayed;
}

const NONE: JsonObject[] = [];

/** Replays moves, splits and turns up to the present step. */
export function sortedList(app: App, present: JsonObject): SortedList {
  const brief = stepsOf(app, "first-order")[0];
  const whole = brief ? wholeStep(app, brief["at"], "first-order") : null;
  const list = (whole ?? brief ?? (present["step"] === "first-order" ? present : null))?.["polygons"];
  const order = Array.isArray(list) ? (list as JsonObject[]) : NONE;
  const done = new Map(doneOf(app, "painted").map((s) => [Number(s["polygon"]), s["at"] ?? null]));
  const { waiting, moved, parts, gone, facets } = replay(order, doneOf(app, "moved"), doneOf(app, "split"));
  const entry = (polygon: number): Entry => {
    const state = done.has(polygon) ? "painted" : gone.has(polygon) ? "split" : moved.has(polygon) ? "moved" : parts.has(polygon) ? "part" : "waits";
    return { polygon, facet: facets.get(polygon) ?? null, state, at: done.get(polygon) ?? null };
  };
  return {
    first: order.map((p) => entry(Number(p["polygon"]))),
    list: [...done.keys(), ...waiting.filter((p) => !done.has(p))].map(entry),
  };
}

const MOST = 13;
const ROW = 18;

export function listDrawing(app: App, present: JsonObject, { first, list }: SortedList): TemplateResult | typeof nothing {
  if (!list.length) return nothing;
  const current = Number(present["polygon"] ?? list[0]!.polygon);
  // Show the entries round the chosen one, or round the present one.
  const finder = chosenFinder(app);
  const chosen = finder ? list.find((e) => e.facet !== null && finder(e.facet)) : undefined;
  const find = (all: Entry[]) => Math.max(0, all.findIndex((e) => e.polygon === (chosen?.polygon ?? current)));
  const left = around(first, find(first), MOST);
  const right = around(list, find(list), MOST);
  const height = 24 + MOST * ROW + 4;
  const [from, to, box] = [118, 202, 112];
  const y = (i: number) => 24 + i * ROW + ROW / 2;
  const other = Number(present["with"] ?? present["by"] ?? present["before_polygon"] ?? -1);
  const one = (e: Entry, i: number, x: number) => {
    const role = e.polygon === current ? " present" : e.polygon === other ? " other" : "";
    return svg`<g class=${`entry ${e.state}${role}${isChosen(app, e.facet) ? " chosen" : ""}`} data-facet=${String(e.facet ?? "")} data-step=${String(e.at ?? "")}>
      <rect x=${x} y=${y(i) - ROW / 2 + 1} width=${box} height=${ROW - 2} rx="3" />
      <text x=${x + 6} y=${y(i) + 4}>${t("{0}: facet {1}", e.polygon, String(e.facet ?? "–"))}</text></g>`;
  };

  // An arrow leads from each place in the first order to that in the list, as far as both are shown.
  const places = new Map(list.map((e, i) => [e.polygon, i]));
  const arrows = left.shown.map((e, i) => {
    const place = places.get(e.polygon);
    if (place === undefined) return nothing;
    const end = place - right.first;
    const style = `link ${e.state}${e.polygon === current ? " present" : ""}`;
    const isShown = end >= 0 && end < right.shown.length;
    const edge = end < 0 ? 22 : height - 4;
    return svg`<path class=${style} d=${isShown ? `M${from} ${y(i)}L${to - 2} ${y(end)}m-6 -3l6 3l-6 3` : `M${from} ${y(i)}L${to - 42} ${edge}`} />`;
  });
  const notes = [
    leftOut(left.before, left.after) ? `${t("first order")}: ${leftOut(left.before, left.after)}` : "",
    leftOut(right.before, right.after) ? `${t("list")}: ${leftOut(right.before, right.after)}` : "",
  ];
  return sheet(app, {
    name: t("Drawing of the depth-sort list"),
    height,
    content: svg`<text x="6" y="14">${t("first order")}</text><text x=${to} y="14">${t("list so far")}</text>
      ${arrows}${left.shown.map((e, i) => one(e, i, 6))}${right.shown.map((e, i) => one(e, i, to))}`,
    legend: [
      ["d-painted", t("painted")],
      ["d-waits", t("waits")],
      ["d-moved", t("moved, waits")],
      ["d-part", t("part of a split one")],
      ["d-split", t("split")],
      ["d-present", t("P, the present one")],
      ["d-other", t("Q, the other one")],
    ],
    note: notes.filter(Boolean).join("; "),
  });
}

