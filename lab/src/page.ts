// The whole page: what stands where.

import { html, nothing, type TemplateResult } from "lit-html";
import type { App } from "./app.ts";
import type { DialogName } from "./open-dialogs.ts";
import { nameOf } from "./states.ts";
import { aboutDialog, cameraDialog, keyboardDialog, languageDialog } from "./dialogs/others.ts";
import { lightsDialog } from "./dialogs/lights.ts";
import { materialsDialog } from "./dialogs/materials.ts";
import { pickFiles } from "./files.ts";
import { formText, PAGES, write, type Page } from "./link.ts";
import { button } from "./parts/fields.ts";
import { explanationBox } from "./parts/what.ts";
import { isNarrow } from "./width.ts";
import { messageWords } from "./why.ts";
import { t, type Key } from "./words.ts";
import { cameraToolbar } from "./views/camera.ts";
import { compareChoice, comparison, comparisonControls, comparisonRegions } from "./views/compare.ts";
import { counters } from "./views/counters.ts";
import { exerciseRegion, exercises } from "./views/exercise.ts";
import { formulaRegion } from "./views/formula.ts";
import { hasLegend } from "./views/marks.ts";
import { menubar } from "./views/menus.ts";
import { compareAll, illumination, pipeline, scene, shading } from "./views/pages.ts";
import { dragChoice, legend, stage } from "./views/picture.ts";
import { pixelRegion } from "./views/pixel.ts";
import { secondView } from "./views/second.ts";
import { settings } from "./views/settings.ts";
import { stepsToolbar } from "./views/steps.ts";
import { structure } from "./views/structure.ts";

const PAGE_NAMES: Record<Page, Key> = {
  scene: "Scene",
  pipeline: "Pipeline",
  visibility: "Visible surfaces",
  illumination: "Illumination",
  shading: "Shading",
  exercises: "Exercises",
};

const DIALOGS: Record<DialogName, (app: App) => TemplateResult> = {
  lights: lightsDialog,
  materials: materialsDialog,
  camera: cameraDialog,
  keyboard: keyboardDialog,
  language: languageDialog,
  about: aboutDialog,
};

/** A link to the same situation with another part of the Lab's own choices. */
function linkTo(app: App, lab: Partial<App["lab"]>): string {
  const situation = { ...app.situation, lab: { ...app.lab, ...lab } };
  return `#${formText(write(situation, app.catalog!.defaults))}`;
}

function topics(app: App): TemplateResult {
  const link = (page: Page) => {
    const go = (e: MouseEvent) => {
      if (e.ctrlKey || e.metaKey || e.shiftKey) return;
      e.preventDefault();
      if (toPage(app, page).step === null) app.playback.pause();
      app.setLab(toPage(app, page), "push");
    };
    return html`<li><a href=${linkTo(app, toPage(app, page))} aria-current=${page === app.lab.page ? "page" : nothing} @click=${go}>${t(PAGE_NAMES[page])}</a></li>`;
  };
  return html`<nav aria-label=${t("Topics")}>
    <ul>
      ${PAGES.map(link)}
    </ul>
  </nav>`;
}

/** Pictures, the camera, the steps. */
function pictures(app: App): TemplateResult {
  const isAlone = app.lab.compare === "none";
  const isFull = app.lab.layout === "full";
  return html`<div class=${app.hasSteps ? "pictures with-steps" : "pictures"}>
    ${isAlone
      ? stage(app, { name: t("Picture"), picture: "a", plane: app.plane, isBusy: app.isBusy })
      : html`${comparison(app)} ${comparisonControls(app)}`}
    ${app.hasSteps ? stepsToolbar(app) : nothing}
    ${hasLegend(app) ? html`<div class="legend-line">${legend(app)}</div>` : nothing}
    <div class="bar">
      ${cameraToolbar(app)}
      ${isFull ? html`${dragChoice(app)} ${compareChoice(app)}` : nothing}
    </div>
    ${secondView(app)}
  </div>`;
}

/** The pages whose algorithms are shown step by step. */
const PAGES_WITH_STEPS: Page[] = ["visibility", "pipeline"];

/** Goes to a page; one without steps shows the finished picture. */
const toPage = (app: App, page: Page): Partial<App["lab"]> => ({ page, step: PAGES_WITH_STEPS.includes(page) ? app.lab.step : null });

/** What stands below the picture: wide tables where there is room, on narrow pages what the page is for. */
function belowPictures(app: App): unknown {
  if (app.lab.page === "illumination") return formulaRegion(app);
  if (app.lab.page === "exercises" && isNarrow()) return exercises(app);
  return app.lab.page === "visibility" && !isNarrow() ? compareAll(app) : nothing;
}

/** What the present page shows beside picture and settings. */
function regions(app: App): unknown {
  const { page } = app.lab;
  const isAlone = app.lab.compare === "none";
  const pages: Record<Page, () => unknown> = {
    scene: () => html`${pixelRegion(app)} ${app.lab.pixel ? formulaRegion(app) : nothing} ${scene(app)} ${counters(app)}`,
    pipeline: () => html`${pipeline(app)} ${pixelRegion(app)} ${counters(app)}`,
    visibility: () => html`${pixelRegion(app)} ${isNarrow() ? compareAll(app) : nothing} ${counters(app)}`,
    illumination: () => html`${pixelRegion(app)} ${illumination(app)}`,
    shading: () => html`${shading(app)} ${pixelRegion(app)} ${counters(app)}`,
    exercises: () => html`${isNarrow() ? nothing : exercises(app)} ${pixelRegion(app)}`,
  };
  return html`${isNarrow() ? nothing : exerciseRegion(app)} ${isAlone ? nothing : comparisonRegions(app)} ${app.hasSteps ? structure(app) : nothing} ${pages[page]()}`;
}

function messages(app: App): TemplateResult {
  const needed = app.missing.map(nameOf).join(", ");
  const dismiss = () => {
    app.alert = "";
    app.changed();
  };
  return html`<div class="messages">
      <div role="alert" class=${app.alert ? "alert" : ""}>${messageWords(app.alert)}</div>
      ${app.alert ? html`<button type="button" class="dismiss" @click=${dismiss}>${t("Dismiss")}</button>` : nothing}
    </div>
    ${app.missing.length
      ? html`<p class="needed">
          ${t("This link needs your file {0}: drop it here, or open it.", needed)} ${button(t("Open model"), () => pickFiles(app))}
        </p>`
      : nothing}`;
}

const status = (app: App) => html`<div role="status" aria-label=${t("Messages")} class="status">${app.message}</div>`;

export function page(app: App): TemplateResult {
  if (!app.catalog) {
    return html`<main class="waiting">
      <h1>vitral Lab</h1>
      <p>${app.alert ? nothing : t("The engine is starting…")}</p>
      <div role="alert" class=${app.alert ? "alert" : ""}>${app.alert}</div>
    </main>`;
  }
  const { layout } = app.lab;
  if (layout !== "full") {
    const open = (e: MouseEvent) => {
      if (e.ctrlKey || e.metaKey || e.shiftKey || parent !== window) return;
      e.preventDefault();
      app.setLab({ layout: "full" }, "push");
    };
    return html`<div class=${`lab ${layout}`}>
      <header class="small">
        <h1>vitral Lab</h1>
        <a href=${linkTo(app, { layout: "full" })} target=${parent !== window ? "_blank" : nothing} @click=${open}>${t("Open in the Lab")}</a>
      </header>
      ${messages(app)}
      <main>${pictures(app)}</main>
      ${layout === "figure" && app.hasSteps ? html`<div class="regions">${structure(app)}</div>` : nothing} ${status(app)}
      ${app.dialogs.all.map((d) => DIALOGS[d](app))} ${explanationBox()}
    </div>`;
  }
  return html`<div class="lab full">
    <header>
      <h1>vitral Lab</h1>
      ${menubar(app)}
    </header>
    ${topics(app)} ${messages(app)}
    <div class=${app.lab.compare === "side" || app.lab.compare === "difference" ? "columns wide-pictures" : "columns"}>
      <main>${pictures(app)} ${isNarrow() ? exerciseRegion(app) : nothing} ${belowPictures(app)}</main>
      ${settings(app)}
      <div class="regions">${regions(app)}</div>
    </div>
    ${status(app)} ${app.dialogs.all.map((d) => DIALOGS[d](app))} ${explanationBox()}
  </div>`;
}
