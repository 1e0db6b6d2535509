// `toolbar "Camera"`, and how the view is turned.

import { html, type TemplateResult } from "lit-html";
import type { App } from "../app.ts";
import type { Json } from "../json.ts";
import { button } from "../parts/fields.ts";
import { icon } from "../parts/icons.ts";
import { t } from "../words.ts";

/** Degrees that a button turns. */
const TURN = 15;

/** A default viewpoint may stand for the scene's own camera: name it, or the view would jump. */
function ownCamera(app: App, picture: "a" | "b"): Record<string, Json> {
  const own = app.complete?.value.camera["camera-index"];
  const viewpoint = JSON.stringify(app.get("viewpoint", picture));
  const isDefault = viewpoint === JSON.stringify(app.catalog?.defaults["viewpoint"]);
  return typeof own === "number" && isDefault ? { "viewpoint.camera-index": own } : {};
}

/** Picture B turns alone only where it has a camera of its own. */
const turned = (app: App, picture: "a" | "b"): "a" | "b" => (app.sameCamera ? "a" : picture);

export function turn(app: App, to: { azimuth: number; elevation: number }, picture: "a" | "b" = "a") {
  const which = turned(app, picture);
  const full = (v: number) => ((((v + 180) % 360) + 360) % 360) - 180;
  app.set(
    {
      ...ownCamera(app, which),
      "viewpoint.azimuth-angle": full(to.azimuth),
      "viewpoint.elevation-angle": Math.max(-89, Math.min(89, to.elevation)),
    },
    which,
  );
}

export function zoom(app: App, factor: number, picture: "a" | "b" = "a") {
  const which = turned(app, picture);
  const now = Number(app.get("viewpoint.zoom-factor", which) ?? 1);
  const to = Math.max(0.05, Math.min(50, now * factor));
  app.set({ ...ownCamera(app, which), "viewpoint.zoom-factor": Number(to.toPrecision(4)) }, which);
}

export function resetView(app: App) {
  app.set({ viewpoint: app.catalog!.defaults["viewpoint"] ?? {} });
}

export function cameraToolbar(app: App): TemplateResult {
  const number = (path: string) => Number(app.get(path) ?? 0);
  const by = (azimuth: number, elevation: number) => () =>
    turn(app, { azimuth: number("viewpoint.azimuth-angle") + azimuth, elevation: number("viewpoint.elevation-angle") + elevation });
  return html`<div role="toolbar" class="toolbar" aria-label=${t("Camera")}>
    ${button(t("Turn left"), by(-TURN, 0), { icon: icon("left") })} ${button(t("Turn right"), by(TURN, 0), { icon: icon("right") })}
    ${button(t("Turn up"), by(0, TURN), { icon: icon("up") })} ${button(t("Turn down"), by(0, -TURN), { icon: icon("down") })}
    ${button(t("Zoom in"), () => zoom(app, 1.2), { icon: icon("in") })} ${button(t("Zoom out"), () => zoom(app, 1 / 1.2), { icon: icon("out") })}
    ${button(t("Reset view"), () => resetView(app), { icon: icon("reset") })}
  </div>`;
}
