// `application "Second view"`: the scene from outside, which is turned and enlarged by itself.

import { html, nothing, type TemplateResult } from "lit-html";
import { ref } from "lit-html/directives/ref.js";
import type { App } from "../app.ts";
import { frameFrom, type Vector } from "../camera.ts";
import { isObject, type JsonObject } from "../json.ts";
import { drawing } from "../parts/markup.ts";
import { t } from "../words.ts";
import { eyeOf, show } from "./picture.ts";
import { numbers } from "./recorded.ts";

/** Degrees that an arrow key turns. */
const TURN = 5;

/** How much of the picture the scene and the view volume fill: as in the engine. */
const FILL = 0.8;

/** The viewpoint in force: the link's, or the one beside the camera from which the engine looks. */
function viewpoint(app: App): JsonObject | null {
  const { second } = app.lab;
  if (isObject(second)) return second;
  const eye = eyeOf(app);
  const info = app.answerTo("info")?.ok["info"];
  const bounds = isObject(info) && isObject(info["bounds"]) ? info["bounds"] : null;
  if (!eye || !bounds) return null;
  const [min, max] = [numbers(bounds["min"]), numbers(bounds["max"])] as [Vector, Vector];
  const place = frameFrom(eye, min, max, FILL);
  const round = (v: Vector) => v.map((c) => Number(c.toPrecision(5)));
  const angle = app.get("viewpoint.view-angle");
  return {
    position: round(place.position),
    "focal-point": round(place.focalPoint),
    "view-up": round(place.viewUp),
    ...(typeof angle === "number" ? { "view-angle": angle } : {}),
  };
}

function change(app: App, fields: (v: JsonObject) => JsonObject) {
  const before = viewpoint(app);
  if (!before) return;
  app.setLab({ second: { ...before, ...fields(before) } });
  app.wantOverview();
}

const number = (v: JsonObject, key: string, otherwise: number) => (typeof v[key] === "number" ? v[key] : otherwise);

function turnTo(app: App, azimuth: number, elevation: number) {
  const full = (v: number) => ((((v + 180) % 360) + 360) % 360) - 180;
  const round = (v: number) => Math.round(v * 10) / 10;
  change(app, () => ({ "azimuth-angle": round(full(azimuth)), "elevation-angle": round(Math.max(-89, Math.min(89, elevation))) }));
}

const turnBy = (app: App, azimuth: number, elevation: number) => {
  const v = viewpoint(app);
  if (v) turnTo(app, number(v, "azimuth-angle", 0) + azimuth, number(v, "elevation-angle", 0) + elevation);
};

const zoomBy = (app: App, factor: number) =>
  change(app, (v) => ({ "zoom-factor": Number(Math.max(0.05, Math.min(50, number(v, "zoom-factor", 1) * factor)).toPrecision(4)) }));

function pointerDown(app: App, e: PointerEvent) {
  const v = viewpoint(app);
  if (e.button !== 0 || !v) return;
  const box = e.currentTarget as HTMLElement;
  box.focus({ preventScroll: true });
  box.setPointerCapture(e.pointerId);
  const [azimuth, elevation] = [number(v, "azimuth-angle", 0), number(v, "elevation-angle", 0)];
  const scale = 180 / box.getBoundingClientRect().width;
  box.onpointermove = (to) => turnTo(app, azimuth - (to.clientX - e.clientX) * scale, elevation + (to.clientY - e.clientY) * scale);
  box.onpointerup = box.onpointercancel = () => {
    box.onpointermove = box.onpointerup = null;
  };
}

function keyDown(app: App, e: KeyboardEvent) {
  if (e.ctrlKey || e.metaKey || e.altKey) return;
  const actions: Record<string, () => void> = {
    ArrowLeft: () => turnBy(app, -TURN, 0),
    ArrowRight: () => turnBy(app, TURN, 0),
    ArrowUp: () => turnBy(app, 0, TURN),
    ArrowDown: () => turnBy(app, 0, -TURN),
    "+": () => zoomBy(app, 1.2),
    "-": () => zoomBy(app, 1 / 1.2),
    r: () => {
      app.setLab({ second: "on" });
      app.wantOverview();
    },
  };
  const action = actions[e.key];
  if (!action) return;
  e.preventDefault();
  action();
}

function wheel(app: App, e: WheelEvent) {
  if (!(e.currentTarget as Element).matches(":focus-within")) return;
  e.preventDefault();
  zoomBy(app, Math.exp(-e.deltaY / 600));
}

/** Words for what the drawing has. */
function legend(text: string): TemplateResult {
  const all: [RegExp, string, string][] = [
    [/class="eye/, "s-eye", t("the eye")],
    [/class="volume/, "s-volume", t("view volume")],
    [/class="box kept/, "s-kept", t("box in view")],
    [/class="box culled/, "s-culled", t("box culled")],
    [/class="light"/, "s-light", t("light")],
    [/class="cone/, "s-cone", t("cone of a spot light")],
    [/class="lamp/, "s-lamp", t("area light")],
    [/class="ray/, "s-ray", t("ray of the pixel")],
    [/class="light-ray/, "s-light-ray", t("ray to a light")],
    [/class="part/, "s-part", t("box that the ray opened")],
    [/class="plane/, "s-plane", t("plane that divides space")],
    [/class="chosen/, "chosen", t("chosen")],
  ];
  const there = all.filter(([pattern]) => pattern.test(text));
  return html`<p class="legend">${there.map(([, style, word]) => html`<span><i class=${`swatch ${style}`} aria-hidden="true"></i>${word}</span>`)}</p>`;
}

export function secondView(app: App): unknown {
  const answer = app.answers.get("overview");
  if (app.lab.second === "off" || !answer) return nothing;
  const { ok, planes } = answer.value;
  const [width, height] = [Number(ok["width"]), Number(ok["height"])];
  const text = String(ok["drawing"] ?? "");
  const plane = { key: answer.key, value: { bytes: planes[0] ?? new Uint8Array(), width, height } };
  return html`<div
      class="second"
      role="application"
      aria-label=${t("Second view")}
      tabindex="0"
      @pointerdown=${(e: PointerEvent) => pointerDown(app, e)}
      @wheel=${(e: WheelEvent) => wheel(app, e)}
      @keydown=${(e: KeyboardEvent) => keyDown(app, e)}
    >
      <canvas role="img" aria-label=${t("The scene from outside")} ${ref((e) => show(e as HTMLCanvasElement | undefined, plane))}></canvas>
      ${drawing(text, "overview")}
    </div>
    ${legend(text)}`;
}
