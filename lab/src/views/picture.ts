// `application "Picture"`: the canvas, what the step is about drawn over it, the cross, the handles of lights.

import { html, nothing, svg, type TemplateResult } from "lit-html";
import { ref } from "lit-html/directives/ref.js";
import { css } from "../parts/css.ts";
import type { Plane, Result } from "../answers.ts";
import { type App } from "../app.ts";
import { axes, edgePlace, project, unproject, type Eye, type Vector } from "../camera.ts";
import type { JsonObject } from "../json.ts";
import { placeOf, setPlace } from "../lights.ts";
import { combo } from "../parts/fields.ts";
import { drawing } from "../parts/markup.ts";
import { t } from "../words.ts";
import { turn, zoom } from "./camera.ts";
import { asked, channelLegend, highlightLegend, highlightMarks } from "./marks.ts";
import { chooseShapeAt, chosenOutline, markShapes } from "./chosen.ts";

/** The result that each canvas shows. */
const drawn = new WeakMap<HTMLCanvasElement, Result<Plane>>();

/** Puts a plane on a canvas, unless it is there. Until the first one comes, the canvas is empty and of a `size`. */
export function show(canvas: HTMLCanvasElement | undefined, result: Result<Plane> | undefined, size?: [number, number]) {
  if (canvas && size && !drawn.has(canvas)) [canvas.width, canvas.height] = size;
  if (!canvas || !result || drawn.get(canvas) === result) return;
  const { bytes, width, height } = result.value;
  if (bytes.length !== width * height * 4) return;
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
  const pixels = new ImageData(new Uint8ClampedArray(bytes.buffer as ArrayBuffer, bytes.byteOffset, bytes.length), width, height);
  canvas.getContext("2d")?.putImageData(pixels, 0, 0);
  drawn.set(canvas, result);
}

/** The camera in force, for what is drawn over the picture. */
export function eyeOf(app: App): Eye | null {
  const camera = app.complete?.value.camera;
  const [position, focal, up] = ["position", "focal-point", "view-up"].map((k) => camera?.[k] as Vector | undefined);
  if (!camera || !position || !focal || !up) return null;
  const angle = camera["view-angle"];
  const height = camera["parallel-height"];
  const parallelHeight = typeof height === "number" ? height : null;
  if (parallelHeight === null && typeof angle !== "number") return null;
  return {
    position,
    ...axes(position, focal, up),
    viewAngle: typeof angle === "number" ? angle : 30,
    parallelHeight,
    aspect: app.width / app.height,
  };
}

// ---- The picture in words ----

export function description(app: App, picture: "a" | "b" = "a"): string {
  const of = (path: string) => app.get(path, picture);
  const models = (of("models") as string[] | undefined) ?? [];
  const names = models.map((m) => m.replace(/^(builtin|file):/, "").replace(/#.*$/, "")).map((m) => m.charAt(0).toUpperCase() + m.slice(1));
  const view = of("viewpoint.view");
  const from = typeof view === "string" && !["three-quarter", "iso"].includes(view) ? t(`seen from the ${view}` as Parameters<typeof t>[0]) : "";
  const lights = app.complete?.value.lights.filter((l) => l["enabled"] !== false && (l["kind"] as JsonObject)["type"] !== "ambient").length;
  const light = of("settings.lighting") === false ? t("unlit") : lights === undefined ? "" : lights === 1 ? t("1 light") : t("{0} lights", lights);
  const shading = of("settings.lighting") === false ? "" : t("{0} shading", String(of("settings.shading")));
  const channel = app.channel();
  const step = app.lab.step !== null && app.hasSteps ? t("after step {0}", app.lab.step) : "";
  const parts = [names.join(" + "), from, String(of("settings.visibility")), shading, light, channel === "color" ? "" : channel, step];
  return parts.filter(Boolean).join(", ");
}

// ---- The mouse ----

interface Drag {
  x: number;
  y: number;
  azimuth: number;
  elevation: number;
  hasMoved: boolean;
}

let drag: Drag | null = null;

/** What dragging in the picture moves. */
let dragMode: "camera" | "pixel" | "highlight" = "camera";

function pixelAt(app: App, e: MouseEvent, element: Element): [number, number] {
  const box = element.getBoundingClientRect();
  const at = (from: number, size: number, count: number) => Math.max(0, Math.min(count - 1, Math.floor((from / size) * count)));
  return [at(e.clientX - box.left, box.width, app.width), at(e.clientY - box.top, box.height, app.height)];
}

const canvasOf = (e: Event) => (e.currentTarget as Element).querySelector("canvas")!;

function pointerDown(app: App, e: PointerEvent, picture: "a" | "b") {
  if (e.button !== 0 || (e.target as Element).closest("button")) return;
  const box = e.currentTarget as HTMLElement;
  box.focus({ preventScroll: true });
  box.setPointerCapture(e.pointerId);
  if (dragMode === "pixel") app.inspect(pixelAt(app, e, canvasOf(e)));
  if (dragMode === "highlight") void moveHighlight(app, pixelAt(app, e, canvasOf(e)));
  const number = (path: string) => Number(app.get(path, picture) ?? 0);
  drag = {
    x: e.clientX,
    y: e.clientY,
    azimuth: number("viewpoint.azimuth-angle"),
    elevation: number("viewpoint.elevation-angle"),
    hasMoved: false,
  };
  app.beginDrag();
}

function pointerMove(app: App, e: PointerEvent, picture: "a" | "b") {
  if (!drag) return;
  if (dragMode === "pixel") return app.inspect(pixelAt(app, e, canvasOf(e)));
  if (dragMode === "highlight") return void moveHighlight(app, pixelAt(app, e, canvasOf(e)));
  const [dx, dy] = [e.clientX - drag.x, e.clientY - drag.y];
  if (!drag.hasMoved && Math.hypot(dx, dy) < 4) return;
  drag.hasMoved = true;
  // Half a turn over the width of the picture.
  const scale = 180 / canvasOf(e).getBoundingClientRect().width;
  const round = (v: number) => Math.round(v * 10) / 10;
  turn(app, { azimuth: round(drag.azimuth - dx * scale), elevation: round(drag.elevation + dy * scale) }, picture);
}

/** Puts the chosen light where its highlight falls on the point of a pixel: L = 2N(N·V) - V. */
async function moveHighlight(app: App, pixel: [number, number]) {
  const light = app.complete?.value.lights[app.lightNumber];
  const eye = eyeOf(app);
  const place = light && placeOf(light);
  if (!place || !eye) return;
  const answer = await app.engine.ask("highlight", { want: "explain", state: app.state, pixel }).catch(() => null);
  const whole = answer?.ok["explanation"] as { light?: { points?: { world: Vector; evaluations: { normal: Vector; viewer: Vector }[] }[] } } | undefined;
  const point = whole?.light?.points?.[0];
  const evaluation = point?.evaluations[0];
  if (!point || !evaluation) return;
  const { normal: n, viewer: v } = evaluation;
  const cosine = n[0] * v[0] + n[1] * v[1] + n[2] * v[2];
  const l = n.map((c, i) => 2 * c * cosine - v[i]!) as Vector;

  // From the eye's space to the world's.
  const along = (i: 0 | 1 | 2) => l[0] * eye.right[i] + l[1] * eye.up[i] + l[2] * eye.back[i];
  const towards: Vector = [along(0), along(1), along(2)];
  const round = (c: number) => Number(c.toPrecision(5));
  if (place[3] === 0) return setPlace(app, app.lightNumber, [...towards.map(round), 0]);
  const distance = Math.hypot(...point.world.map((c, i) => c - place[i]!));
  setPlace(app, app.lightNumber, [...point.world.map((c, i) => round(c + towards[i]! * distance)), 1]);
}

function pointerUp(app: App, e?: PointerEvent) {
  if (!drag) return;
  if (e && !drag.hasMoved && dragMode === "camera") {
    const [x, y] = pixelAt(app, e, canvasOf(e));
    chooseShapeAt(app, e.currentTarget as Element, x + 0.5, y + 0.5);
  }
  drag = null;
  app.endDrag();
}

function wheel(app: App, e: WheelEvent, picture: "a" | "b") {
  if (!(e.currentTarget as Element).matches(":focus-within")) return;
  e.preventDefault();
  app.beginDrag();
  zoom(app, Math.exp(-e.deltaY / 600), picture);
  app.after("wheel", 200, () => app.endDrag());
}

// ---- The keyboard ----

function keyDown(app: App, e: KeyboardEvent, picture: "a" | "b") {
  if (e.target !== e.currentTarget || e.ctrlKey || e.metaKey || e.altKey) return;
  const steps: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  const step = steps[e.key];
  if (step) {
    e.preventDefault();
    const [dx, dy] = step;
    if (e.shiftKey) {
      const number = (path: string) => Number(app.get(path, picture) ?? 0);
      turn(app, { azimuth: number("viewpoint.azimuth-angle") + dx * 5, elevation: number("viewpoint.elevation-angle") - dy * 5 }, picture);
      return;
    }
    const [x, y] = app.cross ?? app.lab.pixel ?? [Math.floor(app.width / 2), Math.floor(app.height / 2)];
    const within = (v: number, size: number) => Math.max(0, Math.min(size - 1, v));
    app.cross = [within(x + dx, app.width), within(y + dy, app.height)];
    app.say(t("Pixel {0}, {1}", ...app.cross));
  } else if (e.key === "Enter") {
    e.preventDefault();
    app.inspect(app.cross ?? app.lab.pixel ?? [Math.floor(app.width / 2), Math.floor(app.height / 2)]);
  } else if (e.key === "+" || e.key === "-") {
    zoom(app, e.key === "+" ? 1.2 : 1 / 1.2, picture);
  }
}

// ---- Over the canvas ----

/** The cross at the inspected pixel. */
function cross(app: App): unknown {
  const at = app.cross ?? app.lab.pixel;
  if (!at) return nothing;
  const [x, y] = [at[0] + 0.5, at[1] + 0.5];
  const size = Math.max(app.width, app.height) / 40;
  const arms = svg`<path vector-effect="non-scaling-stroke" d="M${x - size} ${y}H${x - 1.5}M${x + 1.5} ${y}H${x + size}M${x} ${y - size}V${y - 1.5}M${x} ${y + 1.5}V${y + size}M${x - 1} ${y - 1}h2v2h-2z"/>`;
  return html`<svg class="cross" aria-hidden="true" viewBox="0 0 ${app.width} ${app.height}">
    <g class="halo">${arms}</g>
    <g>${arms}</g>
  </svg>`;
}

/** Pixels that the pointer moves before a light outside of the picture comes into it. */
const PULL = 4;

/** Where the handle of a light stands, and the depth at which it is moved. */
function handlePlace(eye: Eye, point: Vector): { x: number; y: number; depth: number; angle: number | null; edge: { x: number; y: number } } {
  const at = project(eye, point);
  const isInside = at && at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1;
  if (isInside) return { ...at, angle: null, edge: at };
  const edge = edgePlace(eye, point);
  // A light behind the eye comes in front of it when it is moved.
  const distance = Math.hypot(...point.map((c, i) => c - eye.position[i]!));
  return { ...(at ?? { x: edge.x, y: edge.y, depth: distance || 1 }), angle: edge.angle, edge };
}

/** A button for each light with a place: at its place, or on the edge that is nearest to it. */
function handles(app: App): unknown {
  const eye = eyeOf(app);
  const lights = app.complete?.value.lights;
  if (!eye || !lights) return nothing;
  const one = (light: JsonObject, number: number) => {
    const place = placeOf(light);
    if (!place || place[3] === 0) return nothing;
    const at = handlePlace(eye, [place[0], place[1], place[2]]);
    const isOutside = at.angle !== null;
    const name = `LIGHT${number}`;
    const move = (x: number, y: number, depth: number) => {
      const point = unproject(eye, x, y, depth).map((v) => Number(v.toPrecision(5)));
      setPlace(app, number, [point[0]!, point[1]!, point[2]!, 1]);
    };
    const down = (e: PointerEvent) => {
      const target = e.currentTarget as HTMLElement;
      const box = target.closest('[role="application"]')!.querySelector("canvas")!;
      target.setPointerCapture(e.pointerId);
      app.beginDrag();
      let isPulled = !isOutside;
      target.onpointermove = (to) => {
        isPulled ||= Math.hypot(to.clientX - e.clientX, to.clientY - e.clientY) >= PULL;
        if (!isPulled) return;
        const { left, top, width, height } = box.getBoundingClientRect();
        move((to.clientX - left) / width, (to.clientY - top) / height, at.depth);
      };
      target.onpointerup = target.onpointercancel = () => {
        target.onpointermove = target.onpointerup = null;
        app.endDrag();
      };
    };
    const keys = (e: KeyboardEvent) => {
      const arrows: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
      const arrow = arrows[e.key];
      if (!arrow) return;
      e.preventDefault();
      e.stopPropagation();
      const [dx, dy] = arrow;
      if (e.shiftKey) move(at.x, at.y, at.depth * (1 - 0.02 * dy + 0.02 * dx));
      else move(at.x + dx * 0.01, at.y + dy * 0.01, at.depth);
    };
    return html`<button
      type="button"
      class=${isOutside ? "handle outside" : "handle"}
      data-number=${number}
      aria-label=${t("{0} handle", name)}
      title=${`${name} ${String(light["name"] ?? "")}${isOutside ? ` (${t("outside of the picture")})` : ""}`}
      .style=${css({ "--x": `${at.edge.x * 100}%`, "--y": `${at.edge.y * 100}%`, "--angle": `${at.angle ?? 0}deg` })}
      @pointerdown=${down}
      @keydown=${keys}
      @click=${() => {
        app.lightNumber = number;
      }}
      @dblclick=${(e: Event) => {
        e.stopPropagation();
        app.lightNumber = number;
        app.dialogs.open("lights");
      }}
    ></button>`;
  };
  return lights.map(one);
}

/** What the step is about, over the picture so far. */
function overlay(app: App): unknown {
  const step = app.step?.value;
  if (app.lab.step === null || !app.hasSteps || !step?.drawing) return nothing;
  return html`<div class="overlay" aria-hidden="true" ${ref((e) => markShapes(app, e))}>${drawing(step.drawing, "overlay")}</div>`;
}

export interface Stage {
  name: string;
  picture: "a" | "b";
  plane: Result<Plane> | undefined;
  isBusy: boolean;
  style?: string;
  clip?: number;
}

/** A picture with all that lies over it. */
export function stage(app: App, s: Stage): TemplateResult {
  const { picture } = s;
  const size = { "--w": String(app.width), "--h": String(app.height) };
  const own = ["settings.width", "settings.height"].map((path) => Number(app.get(path, picture))) as [number, number];
  const clip: Record<string, string> = s.clip === undefined ? {} : { "clip-path": `inset(0 0 0 ${s.clip}%)` };
  return html`<div
    class=${`stage ${s.style ?? ""}`}
    role="application"
    aria-label=${s.name}
    aria-busy=${String(s.isBusy)}
    tabindex="0"
    .style=${css({ ...size, ...clip })}
    @pointerdown=${(e: PointerEvent) => pointerDown(app, e, picture)}
    @pointermove=${(e: PointerEvent) => pointerMove(app, e, picture)}
    @pointerup=${(e: PointerEvent) => pointerUp(app, picture === "a" ? e : undefined)}
    @pointercancel=${() => pointerUp(app)}
    @wheel=${(e: WheelEvent) => wheel(app, e, picture)}
    @dblclick=${(e: MouseEvent) => app.inspect(pixelAt(app, e, canvasOf(e)))}
    @keydown=${(e: KeyboardEvent) => keyDown(app, e, picture)}
  >
    <canvas role="img" aria-label=${description(app, picture)} ${ref((e) => show(e as HTMLCanvasElement | undefined, s.plane, own))}></canvas>
    ${picture === "a" ? html`${overlay(app)} ${chosenOutline(app)}` : nothing} ${cross(app)} ${picture === "a" ? html`${asked(app)} ${highlightMarks(app)} ${handles(app)}` : nothing}
  </div>`;
}

export function dragChoice(app: App): TemplateResult {
  const options = [
    { value: "camera", text: t("Camera") },
    { value: "pixel", text: t("Pixel") },
    { value: "highlight", text: t("Highlight") },
  ];
  return combo(t("Drag"), dragMode, options, (value) => {
    dragMode = value as typeof dragMode;
    app.changed();
  });
}

/** What the line below the picture says: the colours of its channel, of the step, of marks. */
export function legend(app: App): unknown {
  return html`${channelLegend(app)} ${stepLegend(app)} ${highlightLegend(app)}`;
}

/** The colours in the drawing over the picture, each with a word. */
function stepLegend(app: App): unknown {
  const step = app.step?.value;
  if (app.lab.step === null || !app.hasSteps || !step) return nothing;
  // Algorithms that overwrite show what will not last in pale colours; the others begin with paper.
  const undecided: [string, string] = ["drawn", "piece"].includes(step.group) ? ["pale", t("pale: will be drawn over")] : ["paper", t("not decided yet")];
  const windows: [string, string][] = [
    ["empty", t("empty window")],
    ["one", t("one polygon")],
    ["surrounded", t("surrounded")],
    ["pixel", t("one pixel")],
    ["cut", t("cut in four")],
  ];
  const others: [string, string][] = [
    ["stays", t("nearer, is kept")],
    ["hidden", t("farther, is hidden")],
    ["line", t("scan line")],
    ["span", t("span")],
    ["rays", t("rays")],
    ["p", t("P, the present one")],
    ["q", t("Q, the other one")],
    ["extent", t("extents in x and y")],
    ["split-line", t("line of the split")],
    ["splitter", t("splitter")],
    ["piece", t("piece")],
    ["clip", t("clip polygon")],
    ["inside", t("inside")],
    ["outside", t("outside")],
    ["removed", t("hidden, removed")],
    ["visible", t("visible polygon")],
  ];

  // Windows have all words, other steps those of what is drawn.
  const drawn = new Set([...(step.drawing ?? "").matchAll(/class="([^"]*)"/g)].flatMap((m) => m[1]!.split(" ")));
  const list = step.group === "window" ? windows : others.filter(([key]) => drawn.has(key));
  const isDrawing = ["window", "drawn", "line", "rays", "piece", "clip", "visible"].includes(step.group);
  if (!list.length) return nothing;
  return html`<p class="legend">${[...list, ...(isDrawing ? [undecided] : [])].map(([key, text]) => html`<span><i class=${`swatch ${key}`} aria-hidden="true"></i>${text}</span>`)}</p>
    ${step.group === "window" ? html`<p class="note">${t("Windows are cut between tiles of 64 pixels, then at powers of two, never through a pixel.")}</p>` : nothing}`;
}
