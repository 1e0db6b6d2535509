// Marks over the picture and the words below it: the channel shown, highlights, the window in question.

import { html, nothing, svg } from "lit-html";
import type { App } from "../app.ts";
import type { Json } from "../json.ts";
import { explanationText } from "../parts/what.ts";
import { t, translated } from "../words.ts";
import { CHANNELS, TERMS } from "./settings.ts";

// ---- The channel ----

/** Whether the picture shows something else than colour, which the line below it explains. */
const hasChannelLegend = (app: App) => channelTerm(app) !== "Colour";

/** Whether something in the picture is explained below it, or may be at another step. */
export const hasLegend = (app: App) => app.hasSteps || hasChannelLegend(app) || HIGHLIGHT_EXERCISES.includes(app.lab.exercise ?? "");

/** What the picture shows: a channel, or a term of the lights. */
function channelTerm(app: App): (typeof CHANNELS)[number][1] | (typeof TERMS)[number][1] {
  const channel = app.channel() === "id" ? "surface" : app.channel();
  const term = channel === "color" ? app.get("light-term") : null;
  return TERMS.find(([field]) => field === term)?.[1] ?? CHANNELS.find(([field]) => field === channel)?.[1] ?? "Id";
}

/** What the colours of the channel mean, in a line. */
export function channelLegend(app: App): unknown {
  if (!hasChannelLegend(app)) return nothing;
  const term = channelTerm(app);
  const found = app.catalog?.algorithms["visibility"]?.find((a) => a.name === app.get("settings.visibility"));
  const steps = typeof found?.["steps"] === "string" ? translated(found["steps"]) : "";
  return html`<p class="note"><strong>${t(term)}:</strong> ${term === "Steps" && steps ? steps : explanationText(term)}</p>`;
}

// ---- Highlights ----

/** The exercises about where a highlight falls. */
const HIGHLIGHT_EXERCISES = ["4.1", "4.2", "4.3", "L20"];

/** Where the highlight of the chosen light falls: its centroid, and the point that mirrors the light to the eye. */
function highlightPoints(app: App): { centroid: [number, number] | null; mirror: [number, number] | null } | null {
  if (!HIGHLIGHT_EXERCISES.includes(app.lab.exercise ?? "") || !app.catalog?.wants?.includes("highlight")) return null;
  if (!app.complete?.value.lights[app.lightNumber] || app.isDragging) return null;
  app.answerQuietly("highlight points", { want: "highlight", state: app.state, light: app.lightNumber });
  const ok = app.answerTo("highlight points")?.ok;
  const point = (v: Json | undefined): [number, number] | null => (Array.isArray(v) ? [Number(v[0]), Number(v[1])] : null);
  return ok ? { centroid: point(ok["centroid"]), mirror: point(ok["mirror"]) } : null;
}

/** Marks of the highlight: a disc round its centroid, a slanted cross at the mirror point. */
export function highlightMarks(app: App): unknown {
  const found = highlightPoints(app);
  if (!found) return nothing;
  const r = Math.max(app.width, app.height) / 60;
  const { centroid, mirror } = found;
  const disc = centroid ? svg`<circle vector-effect="non-scaling-stroke" cx=${centroid[0]} cy=${centroid[1]} r=${r} />` : nothing;
  const cross = mirror
    ? svg`<path vector-effect="non-scaling-stroke" d="M${mirror[0] - r} ${mirror[1] - r}l${2 * r} ${2 * r}M${mirror[0] + r} ${mirror[1] - r}l${-2 * r} ${2 * r}" />`
    : nothing;
  return html`<svg class="cross" aria-hidden="true" viewBox="0 0 ${app.width} ${app.height}">
    <g class="halo">${disc}${cross}</g>
    <g>${disc}${cross}</g>
  </svg>`;
}

/** The marks of the highlight in words. */
export function highlightLegend(app: App): unknown {
  const found = highlightPoints(app);
  if (!found) return nothing;
  const name = `LIGHT${app.lightNumber}`;
  return html`<p class="legend">
    ${found.centroid ? html`<span><i class="sign" aria-hidden="true">○</i>${t("centroid of the highlight of {0}", name)}</span>` : nothing}
    ${found.mirror ? html`<span><i class="sign" aria-hidden="true">✕</i>${t("mirror point of {0}", name)}</span>` : nothing}
  </p>`;
}

// ---- Questions ----

/** The window that a question is about. */
export function asked(app: App): unknown {
  const { prediction } = app.playback;
  const pixels = prediction?.next.fields["pixels"];
  if (!prediction || prediction.chosen !== null || !Array.isArray(pixels) || pixels.length !== 4) return nothing;
  const [x, y, w, h] = pixels.map(Number);
  const outline = svg`<rect vector-effect="non-scaling-stroke" x=${x} y=${y} width=${w} height=${h} />`;
  return html`<svg class="cross asked" aria-hidden="true" viewBox="0 0 ${app.width} ${app.height}"><g class="halo">${outline}</g><g>${outline}</g></svg>`;
}
