// `region "Exercise"` and the list of all exercises.

import { html, nothing, type TemplateResult } from "lit-html";
import type { Exercise } from "../answers.ts";
import { type App } from "../app.ts";
import { overlay } from "../states.ts";
import type { Page } from "../link.ts";
import { PAGES } from "../link.ts";
import { button } from "../parts/fields.ts";
import { t, translated } from "../words.ts";

const KEY = "vitral-lab-passed";

/** Exercises that were passed, remembered where the browser allows it. */
const passed = new Set<string>(remembered());

function remembered(): string[] {
  try {
    return JSON.parse(localStorage.getItem(KEY) ?? "[]") as string[];
  } catch {
    return [];
  }
}

function remember(id: string) {
  passed.add(id);
  try {
    localStorage.setItem(KEY, JSON.stringify([...passed]));
  } catch {
    // A page in a frame may have no storage.
  }
}

export function start(app: App, exercise: Exercise) {
  const page = (PAGES as readonly string[]).includes(exercise.page) ? (exercise.page as Page) : "exercises";
  app.openState(exercise.start, { exercise: exercise.id, page, compare: "none" });
  app.exerciseResult = null;
  app.hasHint = false;
  bringIntoView();
}

/** Scrolls so that picture and text are seen, and puts the focus to the text where it was lost. */
function bringIntoView() {
  setTimeout(() => {
    const region = document.querySelector<HTMLElement>(".region.exercise");
    const stage = document.querySelector<HTMLElement>(".pictures .stage");
    if (!region || !stage) return;
    const page = (e: Element, side: "top" | "bottom") => e.getBoundingClientRect()[side] + scrollY;
    const isAllInView = page(region, "bottom") < innerHeight;
    scrollTo({ top: isAllInView ? 0 : page(stage, "top") - 8, behavior: "instant" });
    if (document.activeElement === document.body) region.querySelector("h3")?.focus({ preventScroll: true });
  }, 80);
}

async function checkIt(app: App, exercise: Exercise) {
  try {
    const { ok } = await app.engine.ask("check", { want: "check", state: app.state, exercise: exercise.id, pixel: app.lab.pixel, lang: app.language });
    const isPassed = ok["passed"] === true;
    const differs = ((ok["differs"] as string[] | undefined) ?? []).map((d) => translated(d));
    const text = isPassed ? t("Passed") : `${t("Not yet")}: ${differs.join("; ")}`;
    if (isPassed) remember(exercise.id);
    app.exerciseResult = { id: exercise.id, passed: isPassed, text, differs };
    app.say(text);
  } catch (e) {
    app.fail(e instanceof Error ? e.message : String(e));
  }
}

export function exerciseRegion(app: App): unknown {
  const exercise = app.catalog?.exercises.find((e) => e.id === app.lab.exercise);
  if (!exercise) return nothing;
  const result = app.exerciseResult?.id === exercise.id ? app.exerciseResult : null;
  return html`<section class="region exercise" aria-labelledby="exercise-region-title">
    <h2 id="exercise-region-title" class="hidden">${t("Exercise")}</h2>
    <h3 tabindex="-1">${translated(exercise.title)}</h3>
    <p>${translated(exercise.text)}</p>
    ${app.hasHint ? html`<p class="hint">${translated(exercise.hint)}</p>` : nothing}
    <p class=${`result ${result ? (result.passed ? "right" : "wrong") : ""}`}>${result?.text ?? ""}</p>
    <div class="buttons">
      ${button(t("Check"), () => void checkIt(app, exercise), { style: "strong" })}
      ${button(t("Hint"), () => {
        app.hasHint = true;
        app.changed();
      })}
      ${button(t("Start again"), () => {
        app.openState(overlay(app.catalog!.defaults, exercise.start), { exercise: exercise.id });
        app.exerciseResult = null;
        bringIntoView();
      })}
      ${button(t("Leave"), () => app.setLab({ exercise: null }, "push"))}
    </div>
  </section>`;
}

/** All exercises, with what has been passed. */
export function exercises(app: App): TemplateResult {
  const all = app.catalog?.exercises ?? [];
  return html`<section class="region" aria-labelledby="exercises-title">
    <h2 id="exercises-title">${t("Exercises")}</h2>
    <p class="note">${t("{0} of {1} passed", all.filter((e) => passed.has(e.id)).length, all.length)}</p>
    <ul class="exercises">
      ${all.map(
        (e) => html`<li class=${passed.has(e.id) ? "passed" : ""}>
          <button type="button" class="card" aria-current=${e.id === app.lab.exercise ? "true" : nothing} @click=${() => start(app, e)}>
            <strong>${translated(e.title)}</strong>
            <span>${translated(e.text)}</span>
            ${passed.has(e.id) ? html`<em>✓ ${t("Passed")}</em>` : nothing}
          </button>
        </li>`,
      )}
    </ul>
  </section>`;
}
