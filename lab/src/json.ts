// JSON values: types, paths and comparison.

export type Json = null | boolean | number | string | Json[] | JsonObject;
export interface JsonObject {
  [key: string]: Json;
}

export const isObject = (v: Json | undefined): v is JsonObject =>
  typeof v === "object" && v !== null && !Array.isArray(v);

export const copy = <T>(value: T): T => structuredClone(value);

/** Whether two values are equal; the order of keys does not count. */
export function equal(a: Json | undefined, b: Json | undefined): boolean {
  if (a === b) return true;
  if (Array.isArray(a) && Array.isArray(b)) {
    return a.length === b.length && a.every((v, i) => equal(v, b[i]));
  }
  if (!isObject(a) || !isObject(b)) return false;
  const keys = Object.keys(a);
  return keys.length === Object.keys(b).length && keys.every((k) => Object.hasOwn(b, k) && equal(a[k], b[k]));
}

/** The value at a dotted path; `undefined` where there is none. */
export function at(value: Json | undefined, path: string): Json | undefined {
  let here = value;
  for (const key of path.split(".")) {
    if (Array.isArray(here)) here = here[Number(key)];
    else if (isObject(here) && Object.hasOwn(here, key)) here = here[key];
    else return undefined;
  }
  return here;
}

/** A copy with another value at a dotted path; objects are made on the way. */
export function put<T extends Json>(value: T, path: string, to: Json): T {
  const [key = "", ...rest] = path.split(".");
  if (Array.isArray(value)) {
    const list: Json[] = [...value];
    const index = Number(key);
    list[index] = rest.length ? put(list[index] ?? {}, rest.join("."), to) : to;
    return list as T;
  }
  const object: JsonObject = isObject(value) ? { ...value } : {};
  object[key] = rest.length ? put(object[key] ?? {}, rest.join("."), to) : to;
  return object as T;
}

/** Keys that name a variant: objects with one of them are replaced as wholes. */
const KINDS = ["type", "form", "mode", "shape"];

const isVariant = (v: JsonObject) => KINDS.some((k) => Object.hasOwn(v, k));

/** Dotted paths and values of all that differs from `base`. */
export function differences(value: JsonObject, base: JsonObject, prefix = ""): [string, Json][] {
  return Object.entries(value).flatMap(([key, v]): [string, Json][] => {
    const path = prefix + key;
    const b = base[key];
    if (equal(v, b)) return [];
    if (isObject(v) && isObject(b) && !isVariant(v) && !isVariant(b)) return differences(v, b, path + ".");
    return [[path, v]];
  });
}
