// The fields of a step in words: names and values of the engine's JSON, in every language.

import { isObject, type Json } from "./json.ts";
import { number } from "./parts/numbers.ts";
import { t, translated } from "./words.ts";

/** The name of a field. One that the table lacks is shown as words. */
export function fieldName(key: string): string {
  const name = translated(`field ${key}`);
  return name === `field ${key}` ? key.replace(/[_-]/g, " ") : name;
}

/** A value as text: numbers, words of the engine, lists, and fields with their names. */
export function fieldValue(value: Json | undefined): string {
  if (value === null || value === undefined) return "–";
  if (typeof value === "number") return number(Number(value.toPrecision(6)));
  if (typeof value === "boolean") return value ? t("yes") : t("no");
  if (typeof value === "string") return value === "" ? "–" : word(value);
  if (Array.isArray(value)) return listText(value);
  // A set of polygons: how many, and the first of them.
  if (typeof value["count"] === "number" && Array.isArray(value["facets"])) {
    return value["facets"].length ? `${value["count"]} (${listText(value["facets"])})` : String(value["count"]);
  }
  return Object.entries(value)
    .map(([key, v]) => (typeof v === "boolean" ? (v ? fieldName(key) : "") : `${fieldName(key)} ${fieldValue(v)}`))
    .filter(Boolean)
    .join(", ");
}

/** A word of the engine. */
function word(value: string): string {
  const text = translated(value);
  return text === value ? value.replace(/-/g, " ") : text;
}

/** A list: members that are lists or have fields stand apart from each other. */
function listText(values: Json[]): string {
  if (!values.length) return "–";
  const isApart = values.some((v) => Array.isArray(v) || isObject(v));
  return values.map((v) => (Array.isArray(v) ? `(${listText(v)})` : fieldValue(v))).join(isApart ? "; " : ", ");
}
