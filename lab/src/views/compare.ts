// The comparison of two pictures: side by side, swiped, blinking, or their difference.

import { html, nothing, type TemplateResult } from "lit-html";
import { ref } from "lit-html/directives/ref.js";
import type { App } from "../app.ts";
import { equal, type Json } from "../json.ts";
import { COMPARISONS, type Comparison } from "../link.ts";
import { button, check, combo, group } from "../parts/fields.ts";
import { number } from "../parts/numbers.ts";
import { table } from "../parts/table.ts";
import { stepWords } from "../stepwords.ts";
import { nameOf } from "../states.ts";
import { t, translated } from "../words.ts";
import { show, stage } from "./picture.ts";
import { combos } from "./settings.ts";

/** Percent of the picture where the divider stands. */
let divider = 50;

/** Which picture blinks on top. */
let showsB = false;
let blinker: ReturnType<typeof setInterval> | undefined;

const NAMES: Record<Comparison, Parameters<typeof t>[0]> = {
  none: "None",
  side: "Side by side",
  swipe: "Swipe",
  blink: "Blink",
  difference: "Difference",
};

export function compareChoice(app: App): TemplateResult {
  return combo(
    t("Compare"),
    app.lab.compare,
    COMPARISONS.map((value) => ({ value, text: t(NAMES[value]) })),
    (value) => setComparison(app, value as Comparison),
  );
}

export function setComparison(app: App, compare: Comparison) {
  app.playback.pause();
  app.setLab({ compare, step: null });
}

/** Blinks while that is wanted; people who want no motion press the button. */
function blink(app: App) {
  const isWanted = app.lab.compare === "blink" && !matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (isWanted === (blinker !== undefined)) return;
  clearInterval(blinker);
  blinker = undefined;
  if (isWanted) {
    blinker = setInterval(() => {
      showsB = !showsB;
      app.changed();
    }, 800);
  }
}

/** At most this many settings are named in a caption. */
const MOST_NAMED = 3;

/** A value of the state as a word of a caption. */
function valueWord(path: string, value: Json | undefined): string {
  const field = path.slice(path.lastIndexOf(".") + 1);
  const name = translated(field);
  if (Array.isArray(value) && field === "models") return value.map((m) => nameOf(String(m)).replace("builtin:", "")).join(" + ");
  if (typeof value === "string" && path.startsWith("settings.")) return value;
  if (typeof value === "number") return `${name} ${number(value)}`;
  if (typeof value === "string") return `${name} ${value}`;
  if (typeof value === "boolean") return `${name} ${value ? t("on") : t("off")}`;
  return value === null || value === undefined ? `${name} ${t("usual")}` : name;
}

/** A picture's caption: its letter and the settings in which the pictures differ. */
function captionOf(app: App, picture: "a" | "b"): string {
  const paths = Object.keys(app.situation.b).filter((path) => !path.startsWith("viewpoint.") || path.endsWith("-angle"));
  const words = paths.slice(0, MOST_NAMED).map((path) => valueWord(path, app.get(path, picture)));
  const more = paths.length > MOST_NAMED ? ", …" : "";
  const letter = picture.toUpperCase();
  return words.length ? `${letter}: ${words.join(", ")}${more}` : letter;
}

export function comparison(app: App): TemplateResult {
  blink(app);
  const { compare } = app.lab;
  const isStacked = compare === "swipe" || compare === "blink";
  const isBusy = app.isBusy;
  const a = stage(app, { name: t("Picture A"), picture: "a", plane: app.plane, isBusy });
  const b = stage(app, {
    name: t("Picture B"),
    picture: "b",
    plane: app.planeB,
    isBusy,
    ...(compare === "swipe" ? { clip: divider } : {}),
    ...(compare === "blink" && !showsB ? { clip: 100 } : {}),
  });
  const stepB = app.lab.step !== null && app.hasSteps && app.stepB ? ` · ${t("{0} of {1}: {2}", app.stepB.value.number, app.stepB.value.total, stepWords(app.stepB.value))}` : "";
  const caption = (name: string, content: unknown) => html`<div class="captioned"><p class="caption">${name}</p>${content}</div>`;
  const [captionA, captionB] = [captionOf(app, "a"), `${captionOf(app, "b")}${stepB}`];
  const shows = (isB: boolean) => (compare === "blink" && isB === showsB ? "caption shown" : "caption");
  const stacked = html`<div class="captions"><p class=${shows(false)}>${captionA}</p><p class=${shows(true)}>${captionB}</p></div>
    <div class="stack">${a}${b}</div>`;
  return html`<div class=${`pair ${compare}`}>
    ${isStacked ? stacked : html`${caption(captionA, a)}${caption(captionB, b)}`}
    ${compare === "difference"
      ? caption(
          t("Difference"),
          html`<canvas class="difference" role="img" aria-label=${t("Difference")} ${ref((e) => show(e as HTMLCanvasElement | undefined, app.planeDifference))}></canvas>`,
        )
      : nothing}
  </div>`;
}

/** What goes with the comparison, below the pictures. */
export function comparisonControls(app: App): unknown {
  const { compare } = app.lab;
  const slide = (e: Event) => {
    divider = Number((e.target as HTMLInputElement).value);
    app.changed();
  };
  return html`${compare === "swipe"
    ? html`<label class="field wide"
        ><span class="label">${t("Divider")}</span><input type="range" min="0" max="100" .value=${String(divider)} @input=${slide}
      /></label>`
    : nothing}
  ${compare === "blink"
    ? html`<p class="caption">${captionOf(app, showsB ? "b" : "a")} ${button(t("Show the other picture"), () => {
        showsB = !showsB;
        app.changed();
      })}</p>`
    : nothing}`;
}

export function comparisonRegions(app: App): TemplateResult {
  const sameSize = ["settings.width", "settings.height"].every((p) => equal(app.get(p), app.get(p, "b")));
  const agreement = app.agreement?.value;
  const same = (on: boolean) => {
    app.sameCamera = on;
    const b = { ...app.situation.b };
    for (const path of Object.keys(b)) if (on && path.startsWith("viewpoint")) delete b[path];
    app.go({ ...app.situation, b }, "replace");
  };
  return html`<section class="region" aria-labelledby="compare-title">
    <h2 id="compare-title">${t("Comparison")}</h2>
    ${check(t("Same camera"), app.sameCamera, same)}
    ${sameSize && agreement
      ? html`${table({
            name: t("Agreement"),
            columns: [t("A and B"), t("value")],
            rows: [
              [t("pixels that differ"), agreement.differ],
              [t("largest difference"), agreement.largest],
              [t("surfaces that differ"), agreement.surfaces],
            ],
            caption: true,
          })}
          ${agreement.first.length
            ? html`<p class="label">${t("First pixels that differ")}</p>
                <div class="chips">${agreement.first.map(([x, y]) => button(`${x}, ${y}`, () => app.inspect([x, y])))}</div>`
            : nothing}`
      : sameSize
        ? html`<p class="note">${t("Comparing…")}</p>`
        : html`<p class="note">${t("Pictures of different sizes cannot be compared.")}</p>`}
    ${group(t("Settings of B"), combos(app, "b"), "fields-of-b")}
  </section>`;
}
