// Depth cueing: what is far away fades to the background (P41).

import { html, type TemplateResult } from "lit-html";
import type { App } from "../app.ts";
import { isObject, type JsonObject } from "../json.ts";
import { check, spin } from "../parts/fields.ts";
import { t } from "../words.ts";

/** Full brightness in front, a fifth of it behind; planes where the scene begins and ends. */
const USUAL: JsonObject = { color: null, front: null, back: null, "front-scale": 1, "back-scale": 0.2 };

export function depthCue(app: App): TemplateResult {
  const cue = app.get("settings.depth-cue");
  const isOn = isObject(cue ?? undefined);
  const fields = isOn ? (cue as JsonObject) : USUAL;
  const scale = (label: string, field: "front-scale" | "back-scale") =>
    spin(label, Number(fields[field] ?? USUAL[field]), (v) => app.set({ "settings.depth-cue": { ...fields, [field]: v } }), {
      min: 0,
      max: 1,
      step: 0.05,
      reason: isOn ? null : t("Depth cueing is off"),
    });
  return html`<section class="region" aria-labelledby="depth-cue-title">
    <h2 id="depth-cue-title">${t("Depth cueing")}</h2>
    ${check(t("Depth cue"), isOn, (on) => app.set({ "settings.depth-cue": on ? USUAL : null }))}
    <div class="row-of-fields">${scale(t("Scale in front"), "front-scale")} ${scale(t("Scale behind"), "back-scale")}</div>
    <p class="note">I′ = s·I + (1 − s)·I_dc: ${t("s falls from the front plane to the back plane; I_dc is the background.")}</p>
  </section>`;
}
