// `dialog "Materials"`: each change overrides one property.

import { html, nothing, type TemplateResult } from "lit-html";
import type { App } from "../app.ts";
import type { JsonObject } from "../json.ts";
import { propertyOf, setMaterial } from "../materials.ts";
import { button, check, combo, group, spin } from "../parts/fields.ts";
import type { Term } from "../parts/what.ts";
import { colorSpins, wholeColor } from "../parts/color-spins.ts";
import { t, type Key } from "../words.ts";
import { dialog } from "./dialog.ts";

export function materialsDialog(app: App): TemplateResult {
  return dialog(app, "materials", t("Materials"), content(app));
}

function content(app: App): unknown {
  const materials = app.complete?.value.materials ?? [];
  if (!materials.length) return html`<p class="note">${t("The scene has no materials of its own.")}</p>`;
  const number = Math.min(app.materialNumber, materials.length - 1);
  const material = materials[number]!;
  const options = materials.map((m, i) => ({ value: String(i), text: String(m["name"] || "default") }));
  return html`<div class="rows">
      ${combo(t("Material"), String(number), options, (v) => {
        app.materialNumber = Number(v);
        app.changed();
      }, { term: "Material" })}
    </div>
    ${fields(app, material)}
    <div class="buttons">${button(t("Reset"), () => app.set({ materials: [] }))}</div>`;
}

function fields(app: App, material: JsonObject): unknown {
  const name = String(material["name"] ?? "");
  const set = (property: string) => (value: number | boolean | string) => setMaterial(app, name, property, String(value));
  const color = (property: "ka" | "kd" | "ks", legend: Key) => {
    const values = propertyOf(material, property) as number[] | undefined;
    if (!Array.isArray(values)) return nothing;
    return group(
      t(legend),
      colorSpins(values, (channel) => t(`${property} ${channel}` as Key), wholeColor(values, (to) => set(property)(to.join(",")))),
      "in-row",
      property,
      property,
    );
  };
  const number = (label: Key & Term, property: string, range: { min?: number; max?: number; step?: number }) => {
    const value = propertyOf(material, property);
    return typeof value === "number" ? spin(t(label), value, set(property), { ...range, term: label }) : nothing;
  };
  const transmission = propertyOf(material, "transmission");
  const mirror = propertyOf(material, "mirror");
  return html`${color("ka", "Ambient coefficient ka")} ${color("kd", "Diffuse coefficient kd")} ${color("ks", "Specular coefficient ks")}
    <div class="row-of-fields">
      ${number("Shininess", "shininess", { min: 0, max: 1000, step: 1 })} ${number("Metallic", "metallic", { min: 0, max: 1, step: 0.05 })}
      ${number("Roughness", "roughness", { min: 0, max: 1, step: 0.05 })} ${number("Opacity", "opacity", { min: 0, max: 1, step: 0.05 })}
      ${number("kt min", "kt-min", { min: 0, max: 1, step: 0.05 })} ${number("Index of refraction", "ior", { min: 0.1, step: 0.05 })}
    </div>
    <div class="column">
      ${typeof mirror === "boolean" ? check(t("Mirror"), mirror, set("mirror"), { term: "Mirror" }) : nothing}
      ${typeof transmission === "string"
        ? combo(
            t("Transmission"),
            transmission,
            [
              { value: "transparent", text: t("transparent") },
              { value: "translucent", text: t("translucent") },
            ],
            set("transmission"),
            { term: "Transmission" },
          )
        : nothing}
    </div>`;
}
