// State files as values: laid over each other, found in bytes, asked for the user's models.

import { at, copy, isObject, type Json, type JsonObject } from "./json.ts";

/** A state with every field: `over` laid on the defaults. */
export function overlay(defaults: JsonObject, over: JsonObject): JsonObject {
  const merged = copy(defaults);
  for (const [key, value] of Object.entries(over)) {
    const base = merged[key];
    const isVariant = isObject(value) && ["type", "form", "mode", "shape"].some((k) => Object.hasOwn(value, k));
    merged[key] = isObject(base) && isObject(value) && !isVariant ? overlay(base, value) : copy(value);
  }
  return merged;
}

/** The file's name in the name of a user's model. */
export const nameOf = (model: string) => model.replace(/^file:/, "").replace(/#[0-9a-f]+$/, "");
/** The hash in the name of a user's model. */
export const hashOf = (model: string) => /#([0-9a-f]+)$/.exec(model)?.[1] ?? "";

/** Models of the user that a state names and that are not here. */
export function missingModels(state: JsonObject, files: Map<string, Uint8Array>): string[] {
  const models = (at(state, "models") as Json[] | undefined) ?? [];
  if (!Array.isArray(models)) return [];
  return models.filter((m): m is string => typeof m === "string" && m.startsWith("file:") && !files.has(nameOf(m)));
}

/** The state in a file, if it has fields of a state and is no scene. */
export function stateIn(bytes: Uint8Array, defaults: JsonObject): JsonObject | null {
  try {
    const value = JSON.parse(new TextDecoder().decode(bytes)) as Json;
    if (!isObject(value) || Object.hasOwn(value, "vitral-scene")) return null;
    return Object.keys(value).some((key) => Object.hasOwn(defaults, key)) ? value : null;
  } catch {
    return null;
  }
}
