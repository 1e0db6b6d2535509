// `toolbar "Steps"`: play and step through a recording.

import { html, nothing, type TemplateResult } from "lit-html";
import { live } from "lit-html/directives/live.js";
import { ref } from "lit-html/directives/ref.js";
import type { App } from "../app.ts";
import { button, check, combo } from "../parts/fields.ts";
import { icon } from "../parts/icons.ts";
import { stepWords } from "../stepwords.ts";
import { t, translated, type Key } from "../words.ts";

const SPEEDS = [0.5, 1, 2, 5, 10, 25, 100, 1000];

export function stepsToolbar(app: App): TemplateResult {
  const count = app.stepCount;
  const number = app.stepNumber;
  const step = app.step?.value;
  const words = step && (app.lab.step !== null || number === count) ? stepWords(step) : "";
  const recording = app.recording?.value;
  const told = count ? t("{0} of {1}: {2}", number, count, words) : t("Recording…");
  const cut = recording?.more && count ? t("first {0} steps of more", recording.steps.toLocaleString("en")) : "";
  const text = cut ? `${told} (${cut})` : told;
  const isReady = count > 0;
  const go = (to: number) => () => {
    app.playback.pause();
    app.goToStep(to);
  };
  const slide = (e: Event) => {
    app.playback.pause();
    app.goToStep(Number((e.target as HTMLInputElement).value));
  };
  // The range has to know its end before its value.
  const show = (e: Element | undefined) => {
    const range = e as HTMLInputElement | undefined;
    if (!range) return;
    range.max = String(Math.max(1, count));
    if (range.value !== String(Math.max(1, number))) range.value = String(Math.max(1, number));
  };
  const groups = app.recording?.value.groups ?? [];
  const shown = [
    { value: "all", text: t("All") },
    ...(app.lab.pixel ? [{ value: "pixel", text: t("At the pixel") }] : []),
    ...groups.map((g) => ({ value: g.name, text: `${translated(g.name)} (${g.count})` })),
  ];
  if (!shown.some((s) => s.value === app.lab.steps)) shown.push({ value: app.lab.steps, text: app.lab.steps });
  const speeds = SPEEDS.includes(app.lab.speed) ? SPEEDS : [...SPEEDS, app.lab.speed].sort((a, b) => a - b);
  return html`<div role="toolbar" class="toolbar steps" aria-label=${t("Steps")} aria-busy=${String(app.isRecording)}>
      <div class="buttons">
        ${button(t("First step"), go(1), { icon: icon("first"), disabled: !isReady })}
        ${button(t("Previous step"), go(number - 1), { icon: icon("previous"), disabled: !isReady })}
        ${app.playback.isPlaying
          ? button(t("Pause"), () => app.playback.pause(), { icon: icon("pause"), style: "icon strong" })
          : button(t("Play"), () => app.playback.play(), { icon: icon("play"), disabled: !isReady, style: "icon strong" })}
        ${button(
          t("Next step"),
          () => {
            app.playback.pause();
            void app.playback.next();
          },
          { icon: icon("next"), disabled: !isReady },
        )}
        ${button(t("Last step"), () => (app.lab.step === count ? app.showFinished() : go(count)()), { icon: icon("last"), disabled: !isReady })}
        ${button(t("Finished picture"), () => app.showFinished(), { icon: icon("finished"), disabled: app.lab.step === null })}
      </div>
      <input
        class="slider"
        type="range"
        min="1"
        step="1"
        aria-label=${t("Step")}
        aria-valuetext=${text}
        ?disabled=${!isReady}
        @input=${slide}
        ${ref(show)}
      />
      <span class="count">${isReady ? html`${number} / ${count}${cut ? html` <span class="note">${cut}</span>` : nothing}` : nothing}</span>
      ${combo(t("Speed"), String(app.lab.speed), speeds.map((s) => ({ value: String(s), text: t("{0} a second", s) })), (v) =>
        app.setLab({ speed: Number(v) }),
      )}
      ${combo(t("Show steps"), app.lab.steps, shown, (v) => {
        app.playback.pause();
        app.setLab({ steps: v, step: null });
      })}
      ${check(t("Ask me first"), app.playback.askFirst, (on) => {
        app.playback.askFirst = on;
        app.changed();
      })}
    </div>
    ${app.lab.layout === "full" ? nothing : html`<p class="told">${text}</p>`}`;
}

/** Answers in words, where the engine's name of a verdict is short. */
const WINDOWS: Record<string, Key> = {
  empty: "empty window",
  one: "one polygon",
  surrounded: "surrounded",
  pixel: "one pixel",
  cut: "cut in four",
};

const option = (app: App, name: string) => {
  const key = app.playback.prediction?.next.group === "window" ? WINDOWS[name] : undefined;
  return key ? t(key) : translated(name);
};

/** `radiogroup "Prediction"`: what comes next? */
export function prediction(app: App): unknown {
  const { prediction } = app.playback;
  if (!prediction) return nothing;
  const { chosen, answer, options, next } = prediction;
  const isRight = chosen === answer;
  const choice = (o: string) =>
    html`<label class="check">
      <input type="radio" name="prediction" .checked=${live(o === chosen)} ?disabled=${chosen !== null && o !== chosen} @change=${() => app.playback.predict(o)} />
      <span>${option(app, o)}</span>
    </label>`;
  return html`<div class=${`prediction ${chosen === null ? "" : isRight ? "right" : "wrong"}`}>
    <div role="radiogroup" aria-label=${t("Prediction")}>
      <p>${t("What comes next?")}</p>
      ${options.map(choice)}
    </div>
    ${chosen === null ? nothing : html`<p><strong>${t(isRight ? "Right" : "Wrong")}.</strong> ${option(app, answer)}: ${stepWords(next)}</p>`}
  </div>`;
}
