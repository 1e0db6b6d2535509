// Lights of the state: fields, places, and how a change is written.
//
// Where the state names no lights, the scene's own are changed field by field (`light-edits`), so that
// they keep what they follow; a change of kind or number writes all lights.

import type { App } from "./app.ts";
import { copy, isObject, type Json, type JsonObject } from "./json.ts";

export const KINDS = ["ambient", "directional", "point", "spot", "area"] as const;

/** Numbers with the seven digits that the engine computes with. */
const vector = (v: Json | undefined): number[] => (Array.isArray(v) ? v.map((n) => Number(Number(n).toPrecision(7))) : [0, 0, 0]);

const kindOf = (light: JsonObject): JsonObject => (isObject(light["kind"]) ? light["kind"] : {});

/** Homogeneous place: w = 0 is a direction to the light; `null` for light from everywhere. */
export function placeOf(light: JsonObject): [number, number, number, number] | null {
  const kind = kindOf(light);
  switch (kind["type"]) {
    case "directional": {
      const [x = 0, y = 0, z = 0] = vector(kind["direction"]);
      return [0 - x, 0 - y, 0 - z, 0];
    }
    case "point":
    case "spot": {
      const [x = 0, y = 0, z = 0] = vector(kind["position"]);
      return [x, y, z, 1];
    }
    case "area": {
      const shape = isObject(kind["shape"]) ? kind["shape"] : {};
      const corners = Array.isArray(shape["corners"]) ? shape["corners"].map(vector) : [vector(shape["center"])];
      const mean = (i: number) => corners.reduce((sum, c) => sum + (c[i] ?? 0), 0) / corners.length;
      return [mean(0), mean(1), mean(2), 1];
    }
    default:
      return null;
  }
}

/** The lights in force, to be changed. */
function whole(app: App): JsonObject[] {
  const own = app.get("lights");
  return copy(Array.isArray(own) && !hasEdits(app) ? (own as JsonObject[]) : (app.complete?.value.lights ?? []));
}

/** A light as the state has it now, which the engine may not have told yet. */
export function lightNow(app: App, number: number): JsonObject | undefined {
  const told = app.complete?.value.lights[number];
  const own = app.get("lights");
  const base = Array.isArray(own) && isObject(own[number]) ? { ...told, ...own[number] } : told;
  if (!base) return undefined;
  const edits = ((app.get("light-edits") as JsonObject[] | undefined) ?? []).filter((e) => e["light"] === String(number));
  return edits.reduce((light: JsonObject, edit) => {
    const field = String(edit["field"]);
    const value = String(edit["value"]).split(",").map(Number);
    if (value.length !== 3 || !value.every(Number.isFinite)) return light;
    if (["ambient", "diffuse", "specular"].includes(field)) return { ...light, [field]: value };
    if (["position", "direction"].includes(field)) return { ...light, kind: { ...kindOf(light), [field]: value } };
    return light;
  }, base);
}

const hasEdits = (app: App) => ((app.get("light-edits") as Json[] | undefined) ?? []).length > 0;

/** Writes all lights. */
function write(app: App, lights: JsonObject[]) {
  // Lights without a name get that of their number.
  const named = lights.map((light, i) => (light["name"] ? light : { ...light, name: `LIGHT${i}` }));
  app.set({ lights: named, "light-edits": [] });
}

/** Changes one field of a light. */
export function setField(app: App, number: number, field: string, value: Json, asText: string) {
  if (Array.isArray(app.get("lights"))) {
    const lights = whole(app);
    const light = lights[number];
    if (!light) return;
    lights[number] = { ...light, [field]: value };
    return write(app, lights);
  }
  const edits = ((app.get("light-edits") as JsonObject[] | undefined) ?? []).filter(
    (e) => !(e["light"] === String(number) && e["field"] === field),
  );
  app.set({ "light-edits": [...edits, { light: String(number), field, value: asText }] });
}

export function setColor(app: App, number: number, field: string, channel: number, value: number) {
  const color = [...vector(lightNow(app, number)?.[field])];
  color[channel] = value;
  setField(app, number, field, color, color.join(","));
}

export function setSwitch(app: App, number: number, field: "enabled" | "shadow", on: boolean) {
  setField(app, number, field, on, on ? "on" : "off");
}

/** Changes fields of a light's kind. */
export function setKindField(app: App, number: number, fields: JsonObject) {
  const lights = whole(app);
  const light = lights[number];
  if (!light) return;
  lights[number] = { ...light, kind: { ...kindOf(light), ...fields } };
  write(app, lights);
}

/** Puts a light elsewhere: w = 0 makes a direction of it. */
export function setPlace(app: App, number: number, place: number[]) {
  const [x = 0, y = 0, z = 0, w = 1] = place;
  const light = lightNow(app, number);
  if (!light || !place.every(Number.isFinite)) return;
  const kind = kindOf(light);
  if (w === 0) {
    // A direction without length cannot be: keep what was typed until it can.
    if (x === 0 && y === 0 && z === 0) {
      app.draftPlace = { light: number, place };
      return app.changed();
    }
    app.draftPlace = null;
    const direction = [0 - x, 0 - y, 0 - z];
    if (kind["type"] === "directional") return editKind(app, number, "direction", direction);
    return replaceKind(app, number, { type: "directional", direction });
  }
  app.draftPlace = null;
  const position = [x / w, y / w, z / w];
  if (kind["type"] === "point" || kind["type"] === "spot") return editKind(app, number, "position", position);
  if (kind["type"] === "area") {
    const shape = isObject(kind["shape"]) ? kind["shape"] : {};
    const from = placeOf(light)!;
    const moved = (c: number[]) => c.map((v, i) => v + position[i]! - from[i]!);
    const corners: JsonObject = Array.isArray(shape["corners"]) ? { corners: shape["corners"].map((c) => moved(vector(c))) } : { center: position };
    return setKindField(app, number, { shape: { ...shape, ...corners } });
  }
  replaceKind(app, number, { type: "point", position });
}

/** Changes a vector of a light's kind: as an edit where lights are the scene's own. */
function editKind(app: App, number: number, field: string, value: number[]) {
  if (Array.isArray(app.get("lights"))) setKindField(app, number, { [field]: value });
  else setField(app, number, field, value, value.join(","));
}

function replaceKind(app: App, number: number, kind: JsonObject) {
  const lights = whole(app);
  const light = lights[number];
  if (!light) return;
  lights[number] = { ...light, kind };
  write(app, lights);
}

/** Makes another kind of light that stays where it is as far as that can be. */
export function setKind(app: App, number: number, type: string) {
  const light = lightNow(app, number);
  if (!light || kindOf(light)["type"] === type) return;
  const place = placeOf(light) ?? [0, 5, 5, 1];
  const [x, y, z, w] = place;
  // A direction becomes a place some way off, and the other way round.
  const length = Math.hypot(x, y, z) || 1;
  const position = w === 0 ? [x, y, z].map((v) => (v / length) * 8) : [x, y, z];
  const old = kindOf(light)["direction"];
  const towards = old ? vector(old) : position.map((v) => 0 - v);
  const direction = towards.some((v) => v !== 0) ? towards : [0, 0, -1];
  const kinds: Record<string, JsonObject> = {
    ambient: { type },
    directional: { type, direction },
    point: { type, position },
    spot: { type, position, direction, cutoff: Math.PI / 6, inner: Math.PI / 6, exponent: 0 },
    area: { type, shape: { shape: "disc", center: position, normal: direction, radius: 1 } },
  };
  const kind = kinds[type];
  if (kind) replaceKind(app, number, kind);
}

const cross = (a: number[], b: number[]) => [0, 1, 2].map((i) => a[(i + 1) % 3]! * b[(i + 2) % 3]! - a[(i + 2) % 3]! * b[(i + 1) % 3]!);
const unit = (v: number[]) => v.map((c) => c / (Math.hypot(...v) || 1));

/** Whether corners span a surface. */
export const spans = (corners: number[][]) => Math.hypot(...newell(corners)) > 1e-9;

/** Twice the area of a polygon along its normal (Newell). */
const newell = (corners: number[][]) =>
  corners.reduce((sum, c, i) => cross(c, corners[(i + 1) % corners.length]!).map((v, k) => v + sum[k]!), [0, 0, 0]);

/** Gives an area light another outline of about the same place, side and size. */
export function setShape(app: App, number: number, to: "disc" | "polygon") {
  const light = lightNow(app, number);
  const shape = light && kindOf(light)["shape"];
  if (!light || !isObject(shape)) return;
  const center = placeOf(light)!.slice(0, 3);
  const corners = Array.isArray(shape["corners"]) ? shape["corners"].map(vector) : [];
  const round = (v: number[]) => v.map((c) => Number(c.toPrecision(6)));
  if (to === "disc" && corners.length) {
    const normal = newell(corners);
    const radius = Math.sqrt(Math.hypot(...normal) / 2 / Math.PI);
    setKindField(app, number, { shape: { shape: "disc", center: round(center), normal: round(unit(normal)), radius: Number(radius.toPrecision(6)) } });
  } else if (to === "polygon" && shape["shape"] === "disc") {
    // A square of the disc's area, its corners counter-clockwise round the normal.
    const normal = unit(vector(shape["normal"]));
    const across = unit(cross(Math.abs(normal[1]!) < 0.9 ? [0, 1, 0] : [1, 0, 0], normal));
    const along = cross(normal, across);
    const half = (Number(shape["radius"] ?? 1) * Math.sqrt(Math.PI)) / 2;
    const corner = (u: number, v: number) => round(center.map((c, i) => c + half * (u * across[i]! + v * along[i]!)));
    setKindField(app, number, { shape: { shape: "polygon", corners: [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)] } });
  }
}

/** The numbers c1, c2, c3 of a light's attenuation. */
export function attenuationOf(light: JsonObject): [number, number, number] {
  const a = isObject(light["attenuation"]) ? light["attenuation"] : {};
  const number = (v: Json | undefined) => (typeof v === "number" ? v : 0);
  switch (a["form"]) {
    case "clamped":
      return [number(a["c1"]), number(a["c2"]), number(a["c3"])];
    case "gl":
      return [number(a["constant"]), number(a["linear"]), number(a["quadratic"])];
    case "inverse-square":
      return [0, 0, 1];
    default:
      return [1, 0, 0];
  }
}

export function setAttenuation(app: App, number: number, index: number, value: number) {
  const light = lightNow(app, number);
  if (!light) return;
  const c = attenuationOf(light);
  c[index] = value;
  if (c.every((v) => v === 0)) return;
  const isGl = isObject(light["attenuation"]) && light["attenuation"]["form"] === "gl";
  const form: JsonObject = isGl
    ? { form: "gl", constant: c[0], linear: c[1], quadratic: c[2] }
    : { form: "clamped", c1: c[0], c2: c[1], c3: c[2] };
  setField(app, number, "attenuation", form, isGl ? `gl,${c.join(",")}` : c.join(","));
}

/** Adds a light in front, white, with the next free name. */
export function addLight(app: App) {
  const lights = whole(app);
  const names = lights.map((l, i) => String(l["name"] || `LIGHT${i}`));
  let number = lights.length;
  while (names.includes(`LIGHT${number}`)) number += 1;
  lights.push({
    name: `LIGHT${number}`,
    kind: { type: "directional", direction: [0, 0, -1] },
    ambient: [0, 0, 0],
    diffuse: [1, 1, 1],
    specular: [1, 1, 1],
    attenuation: { form: "none" },
    enabled: true,
    shadow: true,
    photometric: false,
  });
  app.lightNumber = lights.length - 1;
  write(app, lights);
}

export function removeLight(app: App, number: number) {
  const lights = whole(app);
  lights.splice(number, 1);
  app.lightNumber = Math.max(0, Math.min(number, lights.length - 1));
  write(app, lights);
}

export function resetLights(app: App) {
  const { lights = null } = app.catalog!.defaults;
  app.lightNumber = 0;
  app.draftPlace = null;
  app.set({ lights, "light-edits": [], "light-intensity": null });
}
