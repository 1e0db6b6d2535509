// Steps of the recording besides the present one, and their fields.

import type { App } from "../app.ts";
import { isObject, type Json, type JsonObject } from "../json.ts";
import { t } from "../words.ts";

export const list = (v: Json | undefined): Json[] => (Array.isArray(v) ? v : []);
export const objects = (v: Json | undefined): JsonObject[] => list(v).filter(isObject);
export const numbers = (v: Json | undefined): number[] => list(v).filter((n): n is number => typeof n === "number");

/** Steps that are asked for at once. */
const PORTION = 20000;

/** Steps of an answer as their fields with their places. */
const flattened = new WeakMap<object, JsonObject[]>();

/** The number of the present step among all. */
export const presentStep = (app: App): number => app.step?.value.at ?? app.step?.value.number ?? Infinity;

/** The steps of several answers in one list, made once. */
const joined = new WeakMap<JsonObject[], { parts: JsonObject[][]; all: JsonObject[] }>();

const NONE: JsonObject[] = [];

/** The steps of a kind, brief, at least up to the present one; empty until they are here. */
export function stepsOf(app: App, kind: string): JsonObject[] {
  const wants = app.catalog?.wants ?? [];
  const group = app.recording?.value.groups.find((g) => g.name === kind);
  if (!group || !wants.includes("steps")) return NONE;
  const here = presentStep(app);
  const parts: JsonObject[][] = [];
  for (let from = 1; from <= group.count; from += PORTION) {
    const name = from === 1 ? `steps ${kind}` : `steps ${kind} ${from}`;
    const request: JsonObject = { want: "steps", state: app.state, show: kind, from, to: Math.min(group.count, from + PORTION - 1) };
    app.answer(name, request, true);
    const answer = app.answers.get(name);
    if (!answer || answer.key !== JSON.stringify(request)) break;
    let steps = flattened.get(answer);
    if (!steps) {
      steps = objects(answer.value.ok["steps"]).map((s): JsonObject => {
        const fields = isObject(s["fields"]) ? s["fields"] : {};
        return { ...fields, at: s["at"] ?? null, parent: s["parent"] ?? null };
      });
      flattened.set(answer, steps);
    }
    parts.push(steps);
    if (Number(steps[steps.length - 1]?.["at"] ?? 0) >= here) break;
  }
  const first = parts[0];
  if (!first || parts.length === 1) return first ?? NONE;
  let known = joined.get(first);
  if (known?.parts.length !== parts.length || !parts.every((p, i) => p === known?.parts[i])) joined.set(first, (known = { parts, all: parts.flat() }));
  return known.all;
}

/** How many steps of a list are done at the present one. */
export function doneCount(app: App, all: JsonObject[]): number {
  const here = presentStep(app);
  let [low, high] = [0, all.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (Number(all[middle]!["at"]) <= here) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** The done steps of each kind, made once for each step. */
const done = new Map<string, { all: JsonObject[]; count: number; steps: JsonObject[] }>();

/** The steps of a kind that are done at the present one. */
export function doneOf(app: App, kind: string): JsonObject[] {
  const all = stepsOf(app, kind);
  const count = doneCount(app, all);
  const known = done.get(kind);
  if (known?.all === all && known.count === count) return known.steps;
  const steps = count === all.length ? all : all.slice(0, count);
  done.set(kind, { all, count, steps });
  return steps;
}

/** A step by its number among all, with every member of its lists. */
export function wholeStep(app: App, number: Json | undefined, name: string): JsonObject | null {
  if (typeof number !== "number") return null;
  app.answer(`step ${name}`, { want: "step", state: app.state, number, show: "all" }, true);
  const ok = app.answers.get(`step ${name}`)?.value.ok;
  return ok && ok["number"] === number && isObject(ok["fields"]) ? ok["fields"] : null;
}

/** Facets as text, the first of many. */
export function facetsText(v: Json | undefined): string {
  const all = numbers(v);
  return all.length > 24 ? `${all.slice(0, 24).join(", ")}, … (${all.length})` : all.join(", ") || "–";
}

export const leftOut = (before: number, after: number) => (before + after > 0 ? t("left out: {0} before, {1} after", before, after) : "");
