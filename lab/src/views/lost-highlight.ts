// A highlight in the middle of a face: Phong's shading shows it, Gouraud's misses it (L10).

import { html } from "lit-html";
import type { App } from "../app.ts";
import type { JsonObject } from "../json.ts";
import { button } from "../parts/fields.ts";
import { t } from "../words.ts";

/** The light that one face of the cubes mirrors to the viewer at its middle. */
const LIGHT: JsonObject = {
  name: "LIGHT0",
  kind: { type: "directional", direction: [-0.7, -0.7, -4.976] },
  ambient: [0.1, 0.1, 0.1],
  diffuse: [0.2, 0.2, 0.2],
  specular: [1, 1, 1],
};

/** Cubes seen from the front; one of them is polished. */
const START: JsonObject = {
  models: ["builtin:cubs"],
  viewpoint: { view: "front" },
  settings: { width: 640, height: 480, shading: "gouraud" },
  lights: [LIGHT],
  materials: [
    { material: "cube 7", property: "ks", value: "1,1,1" },
    { material: "cube 7", property: "shininess", value: "300" },
  ],
};

export function lostHighlight(app: App): unknown {
  const open = () => {
    app.openState(START);
    app.set({ "settings.shading": "phong" }, "b");
    app.setLab({ compare: "side" });
  };
  return html`<p class="note">${t("A highlight inside a face: Gouraud interpolates from the corners, where there is none, and loses it.")}</p>
    ${button(t("Show the lost highlight"), open)}`;
}
