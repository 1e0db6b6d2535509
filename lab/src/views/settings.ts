// `complementary "Settings"`: the choices of section 5. Names of algorithms come from the engine's registry.

import { html, nothing, type TemplateResult } from "lit-html";
import { type App } from "../app.ts";
import { nameOf } from "../states.ts";
import { pickFiles } from "../files.ts";
import type { Json } from "../json.ts";
import { button, check, combo, group, radio, spin, type Option } from "../parts/fields.ts";
import type { Term } from "../parts/what.ts";
import { t, tooltip, type Key } from "../words.ts";

type Picture = "a" | "b";

/** The entries of a registry as options. */
export function options(app: App, registry: string): Option[] {
  const list = app.catalog?.algorithms[registry] ?? [];
  return list.map(({ name, description }) => ({ value: name, text: name, title: tooltip(description) }));
}

const named = (values: (string | number)[]): Option[] => values.map((v) => ({ value: String(v), text: String(v) }));

/** Adds the present value where it is not among the options. */
const including = (list: Option[], value: string): Option[] =>
  list.some((o) => o.value === value) ? list : [...list, { value, text: value }];

const text = (app: App, path: string, picture: Picture) => String(app.get(path, picture) ?? "");

/** Why the present algorithms do not use a setting; `null` if they do. */
function reasonAgainst(app: App, setting: string, picture: Picture): string | null {
  const of = (path: string) => text(app, `settings.${path}`, picture);
  switch (setting) {
    case "acceleration":
      return of("visibility") === "ray-cast" || of("shadows") === "ray" || of("global") === "ray-trace"
        ? null
        : t("Only rays use it: ray-cast, ray shadows, ray-trace");
    case "volume-counting":
      return of("shadows") === "volume" ? null : t("Only shadow volumes use it");
    case "transparency-order":
      if (of("transparency") === "none") return t("Every surface is opaque");
      return of("global") === "ray-trace" ? t("Rays pass the surfaces in their order") : null;
    case "shading":
    case "illumination":
      return app.get("settings.lighting", picture) === false ? t("Lighting is off") : null;
    case "depth-bits":
      return of("visibility") === "z-buffer" ? null : t("Only the z-buffer uses it");
    case "shadow-map-size":
      return of("shadows") === "map" ? null : t("Only shadow maps use it");
    default:
      return null;
  }
}

/** Algorithms that sort polygons back to front. */
const SORTING = ["painter", "bsp"];

/** Why an option of a setting does not go with the present algorithms; `null` if it does. */
function reasonAgainstOption(app: App, setting: string, value: string, picture: Picture): string | null {
  const isUnsorted = setting === "transparency-order" && value === "back-to-front" && !SORTING.includes(text(app, "settings.visibility", picture));
  return isUnsorted ? t("Only {0} sort polygons back to front", SORTING.join(", ")) : null;
}

/** Changes a choice, and takes back others that would not go with it. */
export function choose(app: App, setting: string, value: string, picture: Picture) {
  const fields: Record<string, Json> = { [`settings.${setting}`]: value };
  if (setting === "visibility") {
    const found = app.catalog?.algorithms["visibility"]?.find((a) => a.name === value);
    const usable = (found?.["coherence"] as string[] | undefined) ?? [];
    const coherence = app.get("settings.coherence", picture);
    if (Array.isArray(coherence) && !coherence.every((c) => usable.includes(String(c)))) fields["settings.coherence"] = null;
    if (value !== "z-buffer" && app.get("settings.depth-bits", picture) !== null) fields["settings.depth-bits"] = null;
    if (!SORTING.includes(value) && app.get("settings.transparency-order", picture) === "back-to-front") {
      fields["settings.transparency-order"] = app.catalog?.defaults ? "a-buffer" : "sorted";
    }
  }
  const settings = { ...Object.fromEntries([[setting, value]]) };
  const after = (path: string) => String(settings[path] ?? app.get(`settings.${path}`, picture) ?? "");
  const usesRays = after("visibility") === "ray-cast" || after("shadows") === "ray" || after("global") === "ray-trace";
  if (!usesRays && app.get("settings.acceleration", picture) !== null) fields["settings.acceleration"] = null;
  if (after("shadows") !== "volume" && app.get("settings.volume-counting", picture) !== null) fields["settings.volume-counting"] = null;
  const hidesShadows = setting === "shadows" && value === "none";
  if (hidesShadows && app.get("settings.channels.cast-shadow", picture) === true) fields["settings.channels.cast-shadow"] = false;
  if (picture === "a") {
    // Another algorithm has other steps.
    if (setting === "visibility" || setting === "global") app.setLab({ step: null, steps: "all" });
  }
  app.set(fields, picture);
}

/** A label that is explained. */
type Explained = Key & Term;

function registryCombo(app: App, label: Explained, setting: string, registry: string, picture: Picture, usual = "") {
  const value = text(app, `settings.${setting}`, picture) || usual;
  const list = options(app, registry).map((o) => ({ ...o, reason: reasonAgainstOption(app, setting, o.value, picture) }));
  return combo(t(label), value, including(list, value), (v) => choose(app, setting, v, picture), {
    reason: reasonAgainst(app, setting, picture),
    key: `${picture} ${setting}`,
    term: label,
  });
}

function fixedCombo(app: App, label: Explained, setting: string, values: string[], picture: Picture) {
  const value = text(app, `settings.${setting}`, picture) || values[0]!;
  return combo(t(label), value, including(named(values), value), (v) => choose(app, setting, v, picture), {
    reason: reasonAgainst(app, setting, picture),
    key: `${picture} ${setting}`,
    term: label,
  });
}

function model(app: App, picture: Picture): TemplateResult {
  const models = (app.get("models", picture) as Json[] | undefined) ?? [];
  const value = JSON.stringify(models);
  const builtin = (app.catalog?.models ?? []).map(({ name, about }) => ({
    value: JSON.stringify([name]),
    text: name.replace("builtin:", ""),
    title: tooltip(about),
  }));
  const own = [...app.own.hashes].map(([name, hash]) => ({ value: JSON.stringify([`file:${name}#${hash}`]), text: name }));
  const all = [...builtin, ...own.filter((o) => app.own.models.has(o.text))];
  const joined = models.map((m) => nameOf(String(m)).replace("builtin:", "")).join(" + ");
  const list = all.some((o) => o.value === value) ? all : [...all, { value, text: joined }];
  const change = (v: string) => {
    if (picture === "b") app.set({ models: JSON.parse(v) as Json }, "b");
    else app.openModels(JSON.parse(v) as string[]);
  };
  return html`<div class="model">${combo(t("Model"), value, list, change, { term: "Model" })}</div>`;
}

const SIZES = ["320 x 240", "640 x 480", "800 x 600", "1024 x 768", "1280 x 960", "1920 x 1080"];

/** The combo boxes; picture B has the same. */
export function combos(app: App, picture: Picture): TemplateResult[] {
  const samples = text(app, "settings.samples", picture);
  const size = `${text(app, "settings.width", picture)} x ${text(app, "settings.height", picture)}`;
  const setSize = (value: string) => {
    const [width, height] = value.split(" x ").map(Number);
    app.setLab({ pixel: null });
    app.set({ "settings.width": width!, "settings.height": height! }, picture);
  };
  return [
    model(app, picture),
    registryCombo(app, "Visibility", "visibility", "visibility", picture),
    registryCombo(app, "Acceleration", "acceleration", "acceleration", picture, "bvh"),
    registryCombo(app, "Illumination", "illumination", "illumination", picture),
    registryCombo(app, "Shading", "shading", "shading", picture),
    fixedCombo(app, "Interpolation", "interpolation", ["perspective", "linear"], picture),
    registryCombo(app, "Shadows", "shadows", "shadows", picture),
    fixedCombo(app, "Volume counting", "volume-counting", ["z-fail", "z-pass"], picture),
    registryCombo(app, "Transparency", "transparency", "transparency", picture),
    registryCombo(app, "Transparency order", "transparency-order", "transparency-order", picture),
    registryCombo(app, "Global illumination", "global", "global", picture),
    fixedCombo(app, "Colour space", "color-space", ["srgb", "raw"], picture),
    combo(
      t("Samples"),
      samples,
      including(named([1, 2, 4, 8, 16, 32]), samples),
      (v) => app.set({ "settings.samples": Number(v) }, picture),
      { term: "Samples" },
    ),
    combo(t("Size"), size, including(named(SIZES), size), setSize, { term: "Size" }),
  ];
}

function coherence(app: App): TemplateResult {
  const kinds = app.catalog?.algorithms["coherence"] ?? [];
  const found = app.catalog?.algorithms["visibility"]?.find((a) => a.name === app.get("settings.visibility"));
  const usable = (found?.["coherence"] as string[] | undefined) ?? [];
  const chosen = app.get("settings.coherence");
  const isOn = (name: string) => (Array.isArray(chosen) ? chosen.includes(name) : usable.includes(name));
  const set = (name: string, on: boolean) => {
    const list = usable.filter((k) => (k === name ? on : isOn(k)));
    app.set({ "settings.coherence": list.length === usable.length ? null : list });
  };
  return group(
    t("Coherence"),
    kinds.map(({ name, description }) =>
      check(name, isOn(name), (on) => set(name, on), {
        reason: usable.includes(name) ? null : t("{0} does not use it", String(found?.name ?? "")),
        key: `coherence ${name}`,
        title: tooltip(description),
        term: { text: description },
      }),
    ),
    "two",
    "Coherence",
  );
}

function culling(app: App): TemplateResult {
  const one = (label: Explained, field: string) =>
    check(t(label), app.get(`settings.cull.${field}`) === true, (on) => app.set({ [`settings.cull.${field}`]: on }), { term: label });
  return group(t("Culling"), [one("View volume", "frustum"), one("Back faces", "back-face")], "two", "Culling");
}

/** Names of channels as labels, where the state file has a switch for them. */
export const CHANNELS = [
  ["color", "Colour"],
  ["depth", "Depth"],
  ["surface", "Id"],
  ["normal", "Normal"],
  ["attached-shadow", "Attached shadow"],
  ["cast-shadow", "Cast shadow"],
  ["steps", "Steps"],
] as const;

/** Terms of the lights, shown like channels. */
export const TERMS = [
  ["ambient", "Ambient term"],
  ["diffuse", "Diffuse term"],
  ["specular", "Specular term"],
] as const;

/** Why a channel does not go with the present algorithms; `null` if it does. */
const reasonAgainstChannel = (app: App, field: string): string | null =>
  field === "cast-shadow" && app.get("settings.shadows") === "none" ? t("Only a shadow algorithm finds cast shadows") : null;

function channels(app: App): TemplateResult {
  const switches = app.get("settings.channels") as Record<string, Json> | undefined;
  const there = CHANNELS.filter(([field]) => switches && Object.hasOwn(switches, field));
  const term = app.get("light-term");
  const channel = app.channel() === "id" ? "surface" : app.channel();
  const shown = channel === "color" && typeof term === "string" ? term : channel;
  const set = (field: string, term: string | null) => {
    const fields: Record<string, Json> = { "light-term": term };
    for (const [other] of there) if (other !== "color") fields[`settings.channels.${other}`] = other === field;
    app.set(fields);
  };
  return group(
    t("Channels shown"),
    [
      ...there.map(([field, label]) => radio(t(label), "channel", field === shown, () => set(field, null), label, reasonAgainstChannel(app, field))),
      ...TERMS.map(([field, label]) => radio(t(label), "channel", field === shown, () => set("color", field), label)),
    ],
    "two",
    "Channels shown",
  );
}

export function settings(app: App): TemplateResult {
  const bits = app.get("settings.depth-bits");
  const mapSize = app.get("settings.shadow-map-size");
  return html`<aside class="settings" aria-labelledby="settings-title">
    <div class="title">
      <h2 id="settings-title">${t("Settings")}</h2>
      ${button(t("Open model"), () => pickFiles(app))}
    </div>
    <div class="fields">
      ${combos(app, "a")}
      ${spin(t("Depth bits"), typeof bits === "number" ? bits : null, (v) => app.set({ "settings.depth-bits": v }), {
        min: 8,
        max: 32,
        step: 1,
        reason: reasonAgainst(app, "depth-bits", "a"),
        term: "Depth bits",
      })}
      ${app.get("settings.shadows") === "map"
        ? spin(t("Shadow map size"), typeof mapSize === "number" ? mapSize : null, (v) => app.set({ "settings.shadow-map-size": v }), {
            min: 16,
            max: 8192,
            step: 1,
            term: "Shadow map size",
          })
        : nothing}
    </div>
    ${coherence(app)} ${culling(app)} ${channels(app)}
  </aside>`;
}
