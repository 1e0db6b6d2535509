// Materials: a change is an override of one property, as `--material NAME.PROPERTY=VALUE`.

import type { App } from "./app.ts";
import { isObject, type Json, type JsonObject } from "./json.ts";

export function setMaterial(app: App, material: string, property: string, value: string) {
  const name = material || "default";
  const others = ((app.get("materials") as JsonObject[] | undefined) ?? []).filter((o) => !(o["material"] === name && o["property"] === property));
  app.set({ materials: [...others, { material: name, property, value }] });
}

/** A property of a material in the scene file's form. */
export function propertyOf(material: JsonObject, property: string): Json | undefined {
  const reflectance = isObject(material["reflectance"]) ? material["reflectance"] : {};
  for (const from of [material, reflectance]) {
    if (Object.hasOwn(from, property)) return from[property];
    const nested = Object.values(from).find((v) => isObject(v) && Object.hasOwn(v, property));
    if (isObject(nested)) return nested[property];
  }
  return undefined;
}
