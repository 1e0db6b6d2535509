// Phong's exponent beside Blinn's: with four times the exponent their highlights look alike (P41).

import { html, nothing } from "lit-html";
import type { App } from "../app.ts";
import { propertyOf } from "../materials.ts";
import { button } from "../parts/fields.ts";
import { t } from "../words.ts";

/** By how much Blinn's exponent is larger. */
const FACTOR = 4;

export function phongAndBlinn(app: App): unknown {
  const materials = (app.complete?.value.materials ?? []).flatMap((m) => {
    const shininess = propertyOf(m, "shininess");
    return typeof shininess === "number" ? [{ name: String(m["name"] || "default"), shininess }] : [];
  });
  if (!materials.length) return nothing;
  const compare = () => {
    const own = (app.get("materials") as { material: string; property: string; value: string }[] | undefined) ?? [];
    const others = own.filter((o) => o.property !== "shininess");
    const larger = materials.map(({ name, shininess }) => ({ material: name, property: "shininess", value: String(shininess * FACTOR) }));
    app.set({ "settings.illumination": "phong" });
    app.set({ "settings.illumination": "blinn-phong", materials: [...others, ...larger] }, "b");
    app.setLab({ compare: "side" });
  };
  return html`<section class="region" aria-labelledby="blinn-title">
    <h2 id="blinn-title">${t("Phong and Blinn")}</h2>
    <p class="note">${t("The angle between N and H is about half of that between R and V: Blinn's exponent is about four times Phong's for the same highlight.")}</p>
    ${button(t("Compare n with 4 n"), compare)}
  </section>`;
}
