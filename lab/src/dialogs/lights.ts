// `dialog "Lights"`, Lab3D's IDD_LIGHT.

import { html, nothing, type TemplateResult } from "lit-html";
import type { App } from "../app.ts";
import { isObject, type Json, type JsonObject } from "../json.ts";
import {
  addLight,
  attenuationOf,
  KINDS,
  lightNow,
  placeOf,
  removeLight,
  resetLights,
  setAttenuation,
  setColor,
  setField,
  setKind,
  setKindField,
  setPlace,
  setShape,
  setSwitch,
  spans,
} from "../lights.ts";
import { button, check, combo, group, spin } from "../parts/fields.ts";
import { colorSpins } from "../parts/color-spins.ts";
import { t, type Key } from "../words.ts";
import { dialog } from "./dialog.ts";

const KIND_NAMES: Record<(typeof KINDS)[number], Key> = {
  ambient: "Ambient",
  directional: "Directional",
  point: "Point",
  spot: "Spot",
  area: "Area",
};

const lightsLeft = (app: App) => (app.get("lights") as Json[]).length;

export function lightsDialog(app: App): TemplateResult {
  return dialog(app, "lights", t("Lights"), content(app));
}

function content(app: App): unknown {
  const lights = app.complete?.value.lights ?? [];
  const number = Math.min(app.lightNumber, Math.max(0, lights.length - 1));
  const light = lights[number] && lightNow(app, number);
  const options = lights.map((l, i) => {
    const name = String(l["name"] ?? "");
    return { value: `LIGHT${i}`, text: name && name !== `LIGHT${i}` ? `LIGHT${i} (${name})` : `LIGHT${i}` };
  });
  const choice = combo(t("Light Number"), `LIGHT${number}`, options, (v) => {
    app.lightNumber = Number(v.slice(5));
    app.draftPlace = null;
    app.changed();
  }, { term: "Light Number" });
  // The button goes with the last light: the focus goes to the one beside it.
  const remove = (e: Event) => {
    const add = (e.currentTarget as Element).previousElementSibling as HTMLElement;
    removeLight(app, number);
    if (lightsLeft(app) === 0) add.focus();
  };
  const buttons = html`<div class="buttons">
    ${button(t("Add light"), () => addLight(app))} ${light ? button(t("Remove light"), remove) : nothing}
    ${button(t("Reset"), () => resetLights(app))}
  </div>`;
  const kind = light && isObject(light["kind"]) ? String(light["kind"]["type"]) : "";
  const kinds = KINDS.map((k) => ({ value: k, text: t(KIND_NAMES[k]) }));
  return html`<div class="rows">
      ${choice} ${light ? combo(t("Kind"), kind, kinds, (v) => setKind(app, number, v), { term: "Kind" }) : nothing}
    </div>
    ${light ? fields(app, light, number) : html`<p class="note">${t("No light shines.")}</p>`} ${buttons}`;
}

function fields(app: App, light: JsonObject, number: number): unknown {
  const kind = isObject(light["kind"]) ? light["kind"] : {};
  const type = String(kind["type"]);
  const color = (name: "Ambient" | "Diffuse" | "Specular", field: "ambient" | "diffuse" | "specular") => {
    const values = (light[field] as number[] | undefined) ?? [0, 0, 0];
    return group(
      t(name),
      colorSpins(values, (channel) => t(`${name} ${channel}` as Key), (i, v) => setColor(app, number, field, i, v)),
      "in-row",
      name,
    );
  };
  const draft = app.draftPlace?.light === number ? app.draftPlace.place : null;
  const place = draft ?? placeOf(light);
  const axis = (i: number) => (v: number) => {
    const to = [...(place ?? [0, 0, 0, 1])];
    to[i] = v;
    setPlace(app, number, to);
  };
  const c = attenuationOf(light);
  const degrees = (v: unknown) => (typeof v === "number" ? (v * 180) / Math.PI : null);
  const only = (isThere: boolean) => (isThere ? null : t("Only spot lights have it"));
  const setCutoff = (v: number) => {
    const cutoff = (v * Math.PI) / 180;
    setKindField(app, number, { cutoff, inner: Math.min(cutoff, Number(kind["inner"] ?? cutoff)) });
  };
  const isSpot = type === "spot";
  const direction = isSpot ? ((kind["direction"] as number[] | undefined) ?? [0, 0, -1]) : null;
  return html`<div class="checks">
      ${check(t("Enabled"), light["enabled"] !== false, (on) => setSwitch(app, number, "enabled", on), { term: "Enabled" })}
      ${check(t("Casts shadow"), light["shadow"] !== false, (on) => setSwitch(app, number, "shadow", on), { term: "Casts shadow" })}
    </div>
    ${color("Ambient", "ambient")} ${color("Diffuse", "diffuse")} ${color("Specular", "specular")}
    ${place
      ? group(
          t("Position"),
          ["x", "y", "z", "w"].map((name, i) => spin(name, place[i] ?? 0, axis(i), { name: t(`Position ${name}` as Key), step: 0.5 })),
          "pairs",
          "Position",
        )
      : nothing}
    ${draft ? html`<p class="note">${t("A direction needs a length: x, y or z other than 0.")}</p>` : nothing}
    ${direction
      ? group(
          t("Direction"),
          ["x", "y", "z"].map((name, i) =>
            spin(
              name,
              direction[i] ?? 0,
              (v) => {
                const to = [...direction];
                to[i] = v;
                if (to.some((d) => d !== 0)) setKindField(app, number, { direction: to });
              },
              { name: t(`Direction ${name}` as Key), step: 0.1 },
            ),
          ),
          "in-row",
          "Direction",
        )
      : nothing}
    ${type === "area" ? shapeFields(app, kind, number) : nothing}
    <div class="in-row">
      ${spin(t("Cutoff"), degrees(kind["cutoff"]), setCutoff, { min: 0.1, max: 90, step: 1, reason: only(isSpot), term: "Cutoff" })}
      ${spin(t("Exponent"), typeof kind["exponent"] === "number" ? kind["exponent"] : null, (v) => setKindField(app, number, { exponent: v }), {
        min: 0,
        step: 1,
        reason: only(isSpot),
        term: "Exponent",
      })}
    </div>
    ${group(
      t("Attenuation"),
      ["c1", "c2", "c3"].map((name, i) =>
        spin(name, c[i] ?? 0, (v) => setAttenuation(app, number, i, v), { name: t(`Attenuation ${name}` as Key), min: 0, step: 0.05 }),
      ),
      "in-row",
      "Attenuation",
    )}
    ${(isObject(light["attenuation"]) ? light["attenuation"]["form"] : "none") !== "none"
      ? button(t("No attenuation"), () => setField(app, number, "attenuation", { form: "none" }, "none"))
      : nothing}`;
}

const vector = (v: Json | undefined): number[] => (Array.isArray(v) ? v.map(Number) : [0, 0, 0]);

/** The outline of an area light: a disc's centre, normal and radius, or a polygon's corners. */
function shapeFields(app: App, kind: JsonObject, number: number): unknown {
  const shape = isObject(kind["shape"]) ? kind["shape"] : {};
  const isDisc = shape["shape"] === "disc";
  const set = (fields: JsonObject) => setKindField(app, number, { shape: { ...shape, ...fields } });
  const three = (label: string, name: (axis: string) => string, values: number[], change: (to: number[]) => void, step: number) =>
    group(
      label,
      ["x", "y", "z"].map((axis, i) => spin(axis, values[i] ?? 0, (v) => change(values.map((old, k) => (k === i ? v : old))), { name: name(axis), step })),
      "in-row",
    );
  const options = [
    { value: "disc", text: t("Disc") },
    { value: "polygon", text: t("Rectangle") },
  ];
  const corners = Array.isArray(shape["corners"]) ? shape["corners"].map(vector) : [];
  const setCorner = (at: number) => (to: number[]) => {
    const all = corners.map((c, i) => (i === at ? to : c));
    // Corners on one line span no surface.
    if (spans(all)) set({ corners: all });
  };
  return html`<div class="in-row">
      ${combo(t("Shape"), isDisc ? "disc" : "polygon", options, (v) => setShape(app, number, v as "disc" | "polygon"), { term: "Shape" })}
      ${isDisc ? spin(t("Radius"), Number(shape["radius"] ?? 1), (v) => set({ radius: v }), { min: 0.001, step: 0.1 }) : nothing}
    </div>
    ${isDisc
      ? html`${three(t("Centre"), (axis) => t("Centre {0}", axis), vector(shape["center"]), (to) => set({ center: to }), 0.5)}
        ${three(t("Normal"), (axis) => t("Normal {0}", axis), vector(shape["normal"]), (to) => to.some((v) => v !== 0) && set({ normal: to }), 0.1)}`
      : corners.map((c, i) => three(t("Corner {0}", i + 1), (axis) => t("Corner {0} {1}", i + 1, axis), c, setCorner(i), 0.5))}`;
}
