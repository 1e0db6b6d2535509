// Playing steps, and asking what the next one will be before it is shown.

import type { Step } from "./answers.ts";
import type { App } from "./app.ts";
import { stepWords } from "./stepwords.ts";
import { t } from "./words.ts";

/** A question about the next step: the answer, and the one that was chosen. */
interface Prediction {
  next: Step;
  options: string[];
  answer: string;
  chosen: string | null;
}

/** Milliseconds between two steps that are told while they play. */
const TELL_INTERVAL = 2000;

/** An answer that never comes must not stop the clock: milliseconds until the next step is tried. */
const PATIENCE = 3000;

export class Playback {
  isPlaying = false;
  askFirst = false;
  prediction: Prediction | null = null;

  private toldTime = 0;
  private stepDone: (() => void) | undefined;

  constructor(private readonly app: App) {}

  /** Tells a step that arrived while they play, not what the slider says itself, and goes on. */
  arrived(step: Step) {
    const now = performance.now();
    const isDue = now - this.toldTime >= TELL_INTERVAL && !document.activeElement?.matches("input[type=range]");
    if (this.isPlaying && isDue) {
      this.toldTime = now;
      this.app.message = stepWords(step);
    }
    this.stepDone?.();
  }

  /** Goes to the next step, or asks about it first. */
  async next() {
    const { app } = this;
    if (app.stepNumber >= app.stepCount) return;
    const next = app.stepNumber + 1;
    if (!this.askFirst) return app.goToStep(next);
    const { ok } = await app.engine.askLong("ahead", { ...app.stepRequest(next), lang: app.language });
    const step = ok as unknown as Step;
    const question = questionOf(step);
    if (!question) return app.goToStep(next);
    this.prediction = { next: step, ...question, chosen: null };
    app.changed();
  }

  predict(choice: string) {
    const { app, prediction } = this;
    if (!prediction) return;
    const isRight = choice === prediction.answer;
    const words = `${t(isRight ? "Right" : "Wrong")}: ${stepWords(prediction.next)}`;
    app.goToStep(app.stepNumber + 1);
    this.prediction = { ...prediction, chosen: choice };
    app.say(words);
  }

  play() {
    const { app } = this;
    if (!app.hasSteps || this.isPlaying) return;
    if (matchMedia("(prefers-reduced-motion: reduce)").matches && app.lab.play) {
      // Nothing plays by itself.
      app.setLab({ play: false });
      return;
    }
    this.isPlaying = true;
    if (!app.lab.play) app.setLab({ play: true });
    let last = performance.now();
    const tick = () => {
      if (!this.isPlaying) return;
      const now = performance.now();
      const passed = ((now - last) / 1000) * app.lab.speed;
      const isReady = app.stepCount > 0 && !app.isRecording;
      if (isReady && passed >= 1 && this.askFirst) {
        last = now;
        void this.next().then(() => {
          if (this.prediction) this.pause();
          else if (app.stepNumber >= app.stepCount) this.pause();
          else next();
        });
        return;
      }
      if (isReady && passed >= 1) {
        const from = app.lab.step ?? 0;
        const to = Math.min(from + Math.floor(passed), app.stepCount);
        last = now;
        this.stepDone = () => {
          this.stepDone = undefined;
          next();
        };
        app.goToStep(to);
        if (to >= app.stepCount) return this.pause();
        app.after("play", PATIENCE, next);
        return;
      }
      if (!isReady) last = now;
      app.after("play", 1000 / Math.min(app.lab.speed, 60) / 2, tick);
    };
    const next = () => app.after("play", Math.max(0, 1000 / app.lab.speed - (performance.now() - last)), tick);
    // At the end, play begins again; a link's step waits for the recording.
    const { step } = app.lab;
    if (step === null || (app.stepCount > 0 && step >= app.stepCount)) app.goToStep(1);
    tick();
    app.changed();
  }

  pause() {
    const { app } = this;
    app.cancel("play");
    this.isPlaying = false;
    if (app.lab.play) app.setLab({ play: false });
    app.changed();
  }
}

/** The question about a step, where its kind has one. */
function questionOf(step: Step): { options: string[]; answer: string } | null {
  const { fields } = step;
  const questions: Record<string, [string, string[]]> = {
    window: ["verdict", ["empty", "one", "surrounded", "pixel", "cut"]],
    compared: [
      "test",
      ["depth-extent", "x-extent", "y-extent", "behind-plane", "in-front-of-plane", "projection", "exchanged-behind", "exchanged-in-front", "coplanar", "overlap"],
    ],
    "tree-visit": ["viewer", ["front", "back"]],
  };
  const [field, options] = questions[String(fields["step"])] ?? [];
  const answer = field ? fields[field] : undefined;
  return options && typeof answer === "string" ? { options, answer } : null;
}
