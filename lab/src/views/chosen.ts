// The facet that is chosen in a row, a list, a tree, a drawing or the picture. All others mark it,
// and the picture outlines it.

import { html, nothing, svg } from "lit-html";
import type { App } from "../app.ts";
import type { Json, JsonObject } from "../json.ts";
import type { Choice } from "../parts/choice.ts";
import { isExplaining } from "../parts/what.ts";
import { t } from "../words.ts";
import { explanationOf, objects } from "./pixel.ts";

/** Facets before and after the chosen one that may be of the same face of the file. */
const SAME_FACE = 6;

/** What a rendered part brings into view: the present step, or what was chosen after it. */
let follows: "step" | "choice" = "step";

export const followsChoice = () => follows === "choice";

/** Brings the present step into view from here on. */
export function followStep() {
  follows = "step";
}

/** The chosen facet with the others of its face, and what they were found for. */
let known: { chosen: unknown; state: unknown; answer: unknown; isDragging: boolean; own: JsonObject | null; all: JsonObject[]; ids: Set<Json> } | undefined;

/** What the engine tells of the chosen facet and the others of its face: a polygon is named by the first of them. */
function chosenFacets(app: App): NonNullable<typeof known> {
  const { chosen, state, answers, isDragging } = app;
  const isSame = known?.chosen === chosen && known?.state === state && known?.answer === answers.get("facets") && known?.isDragging === isDragging;
  if (known && isSame) return known;
  let all: JsonObject[] = [];
  if (chosen && app.catalog?.wants?.includes("facets")) {
    const count = Number(app.picture?.value.facts["triangles"] ?? 0);
    const first = Math.max(0, chosen.facet - SAME_FACE);
    const last = Math.max(chosen.facet, Math.min(count - 1, chosen.facet + SAME_FACE));
    const facets = Array.from({ length: last - first + 1 }, (_, i) => first + i);
    const request: JsonObject = { want: "facets", state, facets };
    if (!isDragging) app.answer("facets", request);
    const answer = answers.get("facets");
    if (answer?.key === JSON.stringify(request)) all = objects(answer.value.ok["facets"]);
  }
  const own = all.find((f) => f["facet"] === chosen?.facet) ?? null;
  const same = own ? all.filter((f) => f["surface"] === own["surface"] && f["mesh"] === own["mesh"]) : [];
  const ids = new Set<Json>(same.map((f) => f["facet"] ?? null));
  if (chosen) ids.add(chosen.facet);
  known = { chosen, state, answer: answers.get("facets"), isDragging, own, all: same, ids };
  return known;
}

/** Whether a facet is the chosen one, or its polygon is. */
export const isChosen = (app: App, facet: Json | undefined): boolean => app.chosen !== null && typeof facet === "number" && chosenFacets(app).ids.has(facet);

/** Finds the chosen facet in a tree, while that is what is brought into view. */
export const chosenFinder = (app: App) => (followsChoice() && app.chosen ? (facet: number) => isChosen(app, facet) : null);

/** Chooses a facet, or none. */
export function chooseFacet(app: App, facet: number | null) {
  app.chosen = facet === null ? null : { facet };
  follows = "choice";
  app.changed();
}

/** Shows a step, counted among all. */
export function goTo(app: App, at: Json | undefined) {
  if (typeof at !== "number") return;
  if (app.lab.steps !== "all") app.setLab({ steps: "all" });
  app.playback.pause();
  app.goToStep(at);
}

/** What choosing a row does that stands for a facet, a step, or both. */
export function choiceOf(app: App, facet: Json | undefined, at?: Json): Choice | null {
  const hasFacet = typeof facet === "number";
  const hasStep = typeof at === "number";
  if (!hasFacet && !hasStep) return null;
  const chosen = isChosen(app, facet);
  const isHere = !hasStep || app.step?.value.at === at;
  const choose = () => {
    // Choosing once more what is shown and marked takes the mark away.
    if (hasFacet) chooseFacet(app, chosen && isHere ? null : facet);
    if (hasStep && !isHere) goTo(app, at);
  };
  return { choose, ...(hasFacet ? { isChosen: chosen } : {}) };
}

/** Chooses what a clicked shape of a drawing stands for. */
export function chooseShape(app: App, e: Event) {
  const shape = (e.target as Element).closest<SVGElement>("[data-facet], [data-step]");
  const number = (name: "facet" | "step") => {
    const value = shape?.dataset[name];
    return value === undefined || value === "" ? null : Number(value);
  };
  choiceOf(app, number("facet"), number("step") ?? undefined)?.choose();
}

/** The pixel whose visible facet was chosen. */
let followed = "";

/** Chooses the visible facet of a pixel when it is first inspected. */
export function followPixel(app: App) {
  const { pixel } = app.lab;
  if (!pixel) followed = "";
  const explanation = explanationOf(app);
  if (!pixel || !explanation || followed === pixel.join()) return;
  followed = pixel.join();
  const visible = objects(explanation["candidates"]).find((c) => c["stage"] === "visible");
  const facet = visible?.["facet"];
  if (typeof facet === "number") app.chosen = { facet };
}

/** Lets Escape take the choice away, where no menu or dialog uses it. */
export function listenToEscape(app: App) {
  addEventListener("keydown", (e) => {
    const element = e.target instanceof Element ? e.target : document.body;
    if (e.key !== "Escape" || e.defaultPrevented || !app.chosen || isExplaining() || element.closest('dialog, [role="menubar"]')) return;
    chooseFacet(app, null);
  });
}

/** The chosen facet in words. */
export function chosenWords(app: App): unknown {
  if (!app.chosen) return nothing;
  const { own } = chosenFacets(app);
  const candidate = objects(explanationOf(app)?.["candidates"]).find((c) => c["facet"] === app.chosen?.facet);
  const about = own ?? candidate;
  const { facet } = app.chosen;
  const words = about
    ? t("Facet {0}: surface {1} of {2}, material {3}", facet, String(about["surface"]), String(about["mesh"] || "–"), String(about["material"] || "–"))
    : t("Facet {0}", facet);
  const isHidden = Array.isArray(own?.["outline"]) && own["outline"].length === 0;
  return html`<p class="chosen-words">
    <i class="swatch chosen" aria-hidden="true"></i><span>${words}${isHidden ? ` (${t("out of view")})` : ""}</span>
    <button type="button" class="link" @click=${() => chooseFacet(app, null)}>${t("Clear the choice")}</button>
  </p>`;
}

/** The outline of the chosen facets in pixels, as a path; empty where there is none. */
export function chosenPath(app: App): string {
  if (!app.chosen) return "";
  // Leave out edges between two facets of the face.
  const edges = new Map<string, string | null>();
  for (const facet of chosenFacets(app).all) {
    const corners = (Array.isArray(facet["outline"]) ? facet["outline"] : []).map((c) => (c as number[]).map((v) => v.toFixed(2)).join(" "));
    corners.forEach((from, i) => {
      const to = corners[(i + 1) % corners.length]!;
      const key = from < to ? `${from} ${to}` : `${to} ${from}`;
      edges.set(key, edges.has(key) ? null : `M${from}L${to}`);
    });
  }
  return [...edges.values()].filter(Boolean).join("");
}

/** A closed path along corners. */
export function outlinePath(corners: Json | undefined): string {
  if (!Array.isArray(corners) || corners.length < 2) return "";
  const points = corners.map((c) => (Array.isArray(c) ? `${Number(c[0])} ${Number(c[1])}` : ""));
  return `M${points.join("L")}Z`;
}

/** The outline of the chosen facet over the picture: light with a dark line in it. */
export function chosenOutline(app: App): unknown {
  const path = chosenPath(app);
  if (!path) return nothing;
  return html`<svg class="cross chosen-outline" aria-hidden="true" viewBox="0 0 ${app.width} ${app.height}">
    ${svg`<path class="halo" d=${path} /><path d=${path} />`}
  </svg>`;
}

/** Marks the shapes of the chosen facet in the drawing over the picture, which the engine made. */
export function markShapes(app: App, root: Element | undefined) {
  // The drawing is put in after its frame.
  queueMicrotask(() => {
    for (const shape of root?.querySelectorAll<SVGElement>("[data-facet]") ?? []) {
      shape.classList.toggle("chosen", isChosen(app, Number(shape.dataset["facet"])));
    }
  });
}

/** Chooses the facet of the shape at a pixel of the drawing over the picture. */
export function chooseShapeAt(app: App, root: Element, x: number, y: number) {
  const shapes = [...root.querySelectorAll<SVGGeometryElement>(".overlay [data-facet]")].reverse();
  const found = shapes.find((shape) => shape.isPointInFill?.(new DOMPoint(x, y)));
  const facet = found?.dataset["facet"];
  if (facet) choiceOf(app, Number(facet))?.choose();
}

