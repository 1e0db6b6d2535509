// The page's state: the situation that the link tells, what the engine answered, and what follows from
// a change. Views read it and call its methods; it knows nothing of how the page looks.

import { Address } from "./address.ts";
import type { Agreement, Catalog, Complete, Picture, Plane, Recording, Result, Step } from "./answers.ts";
import { Engine, Refusal, Superseded, wordsOf, type Answer } from "./engine.ts";
import { at, equal, isObject, put, type Json, type JsonObject } from "./json.ts";
import { LAB, pack, stateOfB, write, type Lab, type Language, type Situation } from "./link.ts";
import { OpenDialogs } from "./open-dialogs.ts";
import { Opening } from "./opening.ts";
import { OwnFiles } from "./own-files.ts";
import { Playback } from "./playback.ts";
import { missingModels, overlay } from "./states.ts";
import { setLanguage } from "./words.ts";

export type History = "replace" | "push";

/** Milliseconds of rest before work that is not urgent begins. */
const REST = 150;

/** Milliseconds between two times that numbers are asked for while something is dragged. */
const DRAGGED_REST = 250;

/** Seconds of a picture above which it is drawn coarser while something is dragged: a display has 60 frames a second. */
const COARSE_ABOVE = 0.012;

const CHANNELS = ["depth", "surface", "object", "material", "normal", "steps", "attached-shadow", "cast-shadow"];

export class App {
  engine: Engine;
  readonly address = new Address(this);
  readonly opening = new Opening(this);
  readonly playback = new Playback(this);
  readonly dialogs = new OpenDialogs(this);
  readonly own = new OwnFiles(this);
  catalog: Catalog | undefined;
  situation: Situation = { state: {}, b: {}, lab: { ...LAB } };

  complete: Result<Complete> | undefined;
  picture: Result<Picture> | undefined;
  pictureB: Result<Picture> | undefined;
  plane: Result<Plane> | undefined;
  /** The last whole picture, whatever step is shown. */
  finished: Result<Plane> | undefined;
  planeB: Result<Plane> | undefined;
  finishedB: Result<Plane> | undefined;
  recordingB: Result<Recording> | undefined;
  /** The step of picture B that goes with that of picture A. */
  stepB: Result<Step> | undefined;
  planeDifference: Result<Plane> | undefined;
  agreement: Result<Agreement> | undefined;
  recording: Result<Recording> | undefined;
  step: Result<Step> | undefined;
  /** Answers of a page's own: `info`, `stages`, `explain`, curves, … */
  readonly answers = new Map<string, Result<Answer>>();

  /** The cross in the picture, which Enter inspects. */
  cross: [number, number] | null = null;
  /** The facet that was chosen in a table, list, tree or drawing. */
  chosen: { facet: number } | null = null;
  isDragging = false;
  isRecording = false;
  sameCamera = true;
  alert = "";
  message = "";
  /** The request that the message speaks of, which it leaves with. */
  private messageOf: string | null = null;
  /** What could not be drawn, lest the picture be waited for. */
  private refusedPlane: string | null = null;
  hasKeys = true;
  /** Models of the user that the link names and that are not here. */
  missing: string[] = [];
  exerciseResult: { id: string; passed: boolean; text: string; differs: string[] } | null = null;
  hasHint = false;
  /** A light's place as it was typed, while it is no place that a light can have. */
  draftPlace: { light: number; place: number[] } | null = null;
  lightNumber = 0;
  materialNumber = 0;

  private readonly listeners: (() => void)[] = [];
  private frame = 0;
  /** When a page's own answers were asked for last. */
  private restTime = 0;
  private timers = new Map<string, ReturnType<typeof setTimeout>>();
  private wanted = new Map<string, string>();

  constructor() {
    this.engine = new Engine((message) => this.fail(message));
  }

  // ---- Rendering and messages ----

  onRender(listener: () => void) {
    this.listeners.push(listener);
  }

  /** Renders before the next frame. */
  changed() {
    if (this.frame) return;
    this.frame = requestAnimationFrame(() => this.render());
    // A hidden page has no frames.
    if (document.hidden) setTimeout(() => this.frame && this.render(), 50);
  }

  /** Renders at once, where the focus goes to what appears. */
  render() {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    for (const listener of this.listeners) listener();
  }

  fail(message: string) {
    this.alert = message;
    this.changed();
    this.emit("error");
  }

  /** Tells something; what is said of a request is taken back when its answer comes, or none will. */
  say(message: string, request: string | null = null) {
    this.message = message;
    this.messageOf = request;
    this.changed();
  }

  private silence(request: string) {
    if (this.messageOf === request) this.say("");
  }

  private emitters: ((event: "ready" | "step" | "error") => void)[] = [];

  onEvent(listener: (event: "ready" | "step" | "error") => void) {
    this.emitters.push(listener);
  }

  emit(event: "ready" | "step" | "error") {
    for (const emitter of this.emitters) emitter(event);
  }

  after(name: string, milliseconds: number, action: () => void) {
    this.cancel(name);
    this.timers.set(name, setTimeout(action, milliseconds));
  }

  cancel(name: string) {
    clearTimeout(this.timers.get(name));
  }

  // ---- Reading the situation ----

  get lab(): Lab {
    return this.situation.lab;
  }

  get state(): JsonObject {
    return this.situation.state;
  }

  get stateB(): JsonObject {
    return stateOfB(this.situation);
  }

  /** A field of the state of a picture. */
  get(path: string, picture: "a" | "b" = "a"): Json | undefined {
    if (picture === "b" && Object.hasOwn(this.situation.b, path)) return this.situation.b[path];
    return at(picture === "b" ? this.stateB : this.state, path);
  }

  get width() {
    return Number(this.get("settings.width") ?? 640);
  }

  get height() {
    return Number(this.get("settings.height") ?? 480);
  }

  /** The channel that the canvas shows: the first one chosen besides colour. */
  channel(state = this.state): string {
    const found = CHANNELS.find((c) => at(state, `settings.channels.${c}`) === true);
    return found === "surface" ? "id" : (found ?? "color");
  }

  /** Whether the page shows steps. */
  get hasSteps() {
    const { page, layout, step } = this.lab;
    return page === "visibility" || page === "pipeline" || layout !== "full" || step !== null;
  }

  get isBusy() {
    const key = this.planeKey();
    return (this.plane?.key !== key && this.refusedPlane !== key) || (this.lab.compare !== "none" && this.planeB?.key !== this.planeKeyB());
  }

  private key(state = this.state) {
    return JSON.stringify(state);
  }

  private keyB() {
    return this.key(this.stateB);
  }

  private planeKey() {
    const { step, steps } = this.lab;
    return step === null || !this.hasSteps ? this.key() : `${this.key()} ${step} ${steps}`;
  }

  /** Picture B shows the step at the same share of its steps. */
  private planeKeyB() {
    const { step, steps } = this.lab;
    return step === null || !this.hasSteps ? this.keyB() : `${this.keyB()} ${step} of ${this.stepCount} ${steps}`;
  }

  // ---- Changing the situation ----

  /** Sets fields of the state of a picture. */
  set(fields: Record<string, Json>, picture: "a" | "b" = "a", history: History = "replace") {
    this.alert = "";
    const situation = { ...this.situation, b: { ...this.situation.b } };
    for (const [path, value] of Object.entries(fields)) {
      if (picture === "a") situation.state = put(situation.state, path, value);
      else if (equal(at(situation.state, path), value)) delete situation.b[path];
      else situation.b[path] = value;
    }
    this.go(situation, history);
  }

  setLab(lab: Partial<Lab>, history: History = "replace") {
    this.go({ ...this.situation, lab: { ...this.situation.lab, ...lab } }, history);
  }

  /** Opens another scene: what belongs to the old one is left behind. */
  openModels(models: string[]) {
    const defaults = this.catalog!.defaults;
    const fields: JsonObject = { models };
    for (const path of ["viewpoint", "lights", "light-edits", "light-intensity", "light-term", "materials", "objects", "ambient"]) {
      fields[path] = defaults[path] ?? null;
    }
    const b = Object.fromEntries(Object.entries(this.situation.b).filter(([path]) => path.startsWith("settings.")));
    const lab = { ...this.lab, step: null, pixel: null };
    this.alert = "";
    this.cross = null;
    this.go({ state: { ...this.state, ...fields }, b, lab }, "push");
  }

  /** Replaces the state of picture A by a state file. */
  openState(state: JsonObject, lab: Partial<Lab> = {}, history: History = "push") {
    const whole = overlay(this.catalog!.defaults, state);
    this.alert = "";
    this.cross = null;
    this.go({ state: whole, b: {}, lab: { ...this.lab, step: null, pixel: null, ...lab } }, history);
  }

  go(situation: Situation, history: History) {
    const before = this.situation;
    this.situation = situation;
    if (!equal(before.state["models"], situation.state["models"])) this.chosen = null;
    if (!equal(before.state, situation.state)) {
      this.playback.prediction = null;
      this.exerciseResult = null;
      this.message = "";
      if (this.lab.step !== null && before.lab.step === situation.lab.step) this.playback.pause();
    }
    if (before.lab.exercise !== situation.lab.exercise) {
      this.exerciseResult = null;
      this.message = "";
      this.hasHint = false;
    }
    this.effects();
    if (this.catalog) this.address.follow(history === "push");
    this.changed();
  }

  // ---- The address bar ----

  async fragment(situation = this.situation): Promise<string> {
    return pack(write(situation, this.catalog!.defaults));
  }

  /** Why the engine refuses a state, or a picture of it. */
  async refusalOf(state: JsonObject): Promise<Refusal | null> {
    try {
      const { ok } = await this.engine.ask(`try ${Math.random()}`, { want: "complete", state, lang: this.language });
      const { refusal } = ok as unknown as Complete;
      return refusal ? new Refusal(refusal.message, refusal.hint) : null;
    } catch (e) {
      return e instanceof Refusal ? e : null;
    }
  }

  get language(): Language {
    return this.lab.lang ?? browserLanguage();
  }

  // ---- What follows from the situation ----

  /** Asks the engine for what the page has to show and does not have yet. */
  effects() {
    if (!this.catalog) return;
    setLanguage(this.language);
    document.documentElement.lang = this.language;
    this.missing = missingModels(this.state, this.own.contents);
    if (this.missing.length) return;
    const state = this.state;
    const key = this.key();
    const { lab } = this;
    const isStep = lab.step !== null && this.hasSteps;

    if (!isStep || !this.isDragging) this.wantPicture();
    if (lab.compare !== "none") this.wantPictureB();
    this.want("complete", key, { want: "complete", state }, ({ ok }) => {
      this.complete = { key, value: ok as unknown as Complete };
    });

    // Long work waits until nothing moves.
    if (this.hasSteps) this.wantRecording();
    if (lab.compare !== "none") this.wantAgreement();
    // While something is dragged, its numbers follow now and then.
    if (!this.isDragging) this.after("rest", REST, () => this.wantRest());
    else if (performance.now() - this.restTime > DRAGGED_REST) this.wantRest();
  }

  /** The picture of the whole state; while a step is shown, for its numbers alone. */
  private wantPicture() {
    const key = this.key();
    const isStep = () => this.lab.step !== null && this.hasSteps;
    if (this.finished?.key === key) {
      if (!isStep()) this.plane = this.finished;
      return;
    }
    const seconds = this.picture?.value.seconds ?? 0;
    const coarse = this.isDragging && seconds > COARSE_ABOVE;
    const wanted = coarse ? `coarse ${key}` : key;
    const { state } = this;
    this.want("picture", wanted, { want: "picture", state, channel: this.channel(), ...(coarse ? { coarse } : {}) }, ({ ok, planes }) => {
      const picture = ok as unknown as Picture;
      if (coarse) picture.seconds = seconds;
      this.picture = { key: wanted, value: picture };
      const plane = { key: wanted, value: planeOf(picture, planes[0]) };
      if (!coarse) this.finished = plane;
      if (isStep()) return;
      this.plane = plane;
      this.emit("ready");
    });
  }

  private wantPictureB() {
    const key = this.keyB();
    const state = this.stateB;
    if (this.finishedB?.key === key) {
      if (this.lab.step === null || !this.hasSteps) this.planeB = this.finishedB;
      return;
    }
    this.want("pictureB", key, { want: "picture", state, channel: this.channel(state) }, ({ ok, planes }) => {
      const picture = ok as unknown as Picture;
      this.pictureB = { key, value: picture };
      this.finishedB = { key, value: planeOf(picture, planes[0]) };
      if (this.lab.step === null || !this.hasSteps) this.planeB = this.finishedB;
    });
  }

  private wantAgreement() {
    const key = `${this.key()} ${this.keyB()}`;
    const sizes = ["settings.width", "settings.height"].every((p) => equal(this.get(p), this.get(p, "b")));
    if (!sizes || this.agreement?.key === key) return;
    const request = { want: "compare", state: this.state, b: this.stateB };
    this.after("agreement", REST, () =>
      this.want("compare", key, request, ({ ok, planes }) => {
        this.agreement = { key, value: ok["agreement"] as unknown as Agreement };
        const size = { width: this.width, height: this.height };
        if (planes[2]) this.planeDifference = { key, value: { bytes: planes[2], ...size } };
      }, true),
    );
  }

  private recordKey() {
    const pixel = this.lab.steps === "pixel" ? ` ${this.lab.pixel?.join(",")}` : "";
    return this.key() + pixel;
  }

  private wantRecording() {
    const key = this.recordKey();
    if (this.recording?.key === key) return this.wantStep();
    if (this.wanted.get("record") === key) return;
    this.engine.stopLong();
    this.isRecording = true;
    const request: JsonObject = { want: "record", state: this.state };
    if (this.lab.steps === "pixel" && this.lab.pixel) request["pixel"] = this.lab.pixel;
    this.after("record", this.isDragging ? 500 : REST, () => {
      if (this.recordKey() !== key || !this.hasSteps) return;
      this.want("record", key, request, ({ ok }) => {
        // The steps of another state say nothing about this one.
        if (this.recordKey() !== key) return;
        this.recording = { key, value: ok as unknown as Recording };
        this.isRecording = false;
        const groups = this.recording.value.groups.map((g) => g.name);
        const { steps, step } = this.lab;
        if (steps !== "all" && steps !== "pixel" && !groups.includes(steps)) this.setLab({ steps: "all" });
        else if (step !== null && step > this.stepCount) this.setLab({ step: this.stepCount || null });
        else this.wantStep();
      }, true);
    });
  }

  /** How many steps there are to show. */
  get stepCount(): number {
    const recording = this.recording?.key === this.recordKey() ? this.recording.value : undefined;
    if (!recording) return 0;
    const { steps } = this.lab;
    if (steps === "all") return recording.steps;
    if (steps === "pixel") return recording["at-pixel"] ?? 0;
    const group = recording.groups.find((g) => g.name === steps);
    if (group) return group.count;
    return recording.steps;
  }

  /** The request for a step by its number. */
  stepRequest(number: number): JsonObject {
    const { steps, pixel } = this.lab;
    return { want: "step", state: this.state, number, show: steps, ...(pixel ? { pixel } : {}) };
  }

  /** How many of picture B's steps there are to show; 0 where it has none of the kind. */
  private get stepCountB(): number {
    const recording = this.recordingB?.key === this.keyB() ? this.recordingB.value : undefined;
    if (!recording) return 0;
    const { steps } = this.lab;
    return steps === "all" || steps === "pixel" ? recording.steps : (recording.groups.find((g) => g.name === steps)?.count ?? 0);
  }

  /** Asks for the step of picture B at the same share of its own steps. */
  private wantStepB() {
    const { step, steps, compare } = this.lab;
    if (compare === "none" || step === null || this.stepCount === 0) return;
    const key = this.keyB();
    const state = this.stateB;
    if (this.recordingB?.key !== key) {
      this.want("recordB", key, { want: "record", state }, ({ ok }) => {
        this.recordingB = { key, value: ok as unknown as Recording };
        this.wantStepB();
      }, true);
      return;
    }
    // Steps of a kind that B's algorithm has not are shown among all.
    const ownKind = this.stepCountB > 0 && steps !== "pixel";
    const count = ownKind ? this.stepCountB : this.recordingB.value.steps;
    const number = Math.max(1, Math.round((step / this.stepCount) * count));
    const planeKey = this.planeKeyB();
    this.want("stepB", planeKey, { want: "step", state, number, show: ownKind ? steps : "all" }, ({ ok, planes }) => {
      this.stepB = { key: planeKey, value: ok as unknown as Step };
      const [width, height] = [Number(ok["width"]), Number(ok["height"])];
      if (planes[0]) this.planeB = { key: planeKey, value: { bytes: planes[0], width, height } };
    }, true);
  }

  private wantStep() {
    this.wantStepB();
    const { step, steps } = this.lab;
    // The finished picture has the last step's structure.
    const number = step ?? this.stepCount;
    if (!number || this.stepCount === 0) return;
    const key = `${this.recordKey()} ${step ?? "last"} ${steps}`;
    if (this.step?.key === key) return;
    const planeKey = this.planeKey();
    this.want("step", key, this.stepRequest(number), ({ ok, planes }) => {
      this.step = { key, value: ok as unknown as Step };
      if (step !== null && planes[0]) {
        const { width, height } = this;
        this.plane = { key: planeKey, value: { bytes: planes[0], width, height } };
      }
      if (step !== null) this.emit("step");
      this.wantOverview();
      this.playback.arrived(this.step.value);
    }, true);
  }

  /** Asks for what single pages show. */
  private wantRest() {
    const { state } = this;
    this.restTime = performance.now();
    const { page, pixel, second, layout, compare } = this.lab;
    // Sharpen what was drawn coarsely.
    if (this.lab.step === null && this.plane?.key !== this.key() && !this.isDragging) this.wantPicture();
    if (layout === "full" && page === "scene") this.answer("info", { want: "info", state });
    if (layout === "full" && (page === "scene" || page === "shading") && !this.isDragging) this.answer("tally", { want: "tally", state });
    if (layout === "full" && page === "pipeline") {
      this.answer("stages", { want: "stages", state, ...(pixel ? { pixel } : {}) });
    }
    if (pixel && layout === "full") this.answer("explain", { want: "explain", state, pixel });
    if (pixel && layout === "full" && compare !== "none") {
      this.answer("explainB", { want: "explain", state: this.stateB, pixel });
    }
    if (second !== "off") {
      this.answer("info", { want: "info", state });
      this.wantOverview();
    }
    if (page === "shading" && layout === "full") {
      for (const shading of ["flat", "gouraud", "phong"]) {
        const own = put(put(put(state, "settings.shading", shading), "settings.width", 240), "settings.height", 180);
        this.answer(`shading ${shading}`, { want: "picture", state: own });
      }
    }
  }

  /** Asks for the scene from outside, with the rays of the pixel and the plane of a step. */
  wantOverview() {
    const { second, pixel } = this.lab;
    if (second === "off") return;
    const step = this.hasSteps && this.stepCount ? this.step?.value : undefined;
    const number = step?.fields["step"] === "tree-node" ? (step.at ?? null) : null;
    const request: JsonObject = { want: "overview", state: this.state, second: isObject(second) ? second : null };
    if (pixel) request["pixel"] = pixel;
    if (number !== null) request["number"] = number;
    // The steps are kept where they were recorded.
    this.answer("overview", request, number !== null);
  }

  /** The answer to a request about the present state, if it is here. */
  answerTo(name: string): Answer | undefined {
    return this.answers.get(name)?.value;
  }

  /** Asks once for each different request. */
  answer(name: string, request: JsonObject, isLong = false) {
    const key = JSON.stringify(request);
    if (this.answers.get(name)?.key === key) return;
    this.want(name, key, request, (value) => void this.answers.set(name, { key, value }), isLong);
  }

  /** Asks for what the page does without where the engine refuses it. */
  answerQuietly(name: string, request: JsonObject) {
    const key = JSON.stringify(request);
    if (this.answers.get(name)?.key === key || this.wanted.get(name) === key) return;
    this.wanted.set(name, key);
    const isNewest = () => this.wanted.get(name) === key;
    this.engine.ask(name, { ...request, lang: this.language }).then(
      (value) => {
        if (!isNewest()) return;
        this.answers.set(name, { key, value });
        this.changed();
      },
      (error: unknown) => {
        if (isNewest() && error instanceof Superseded) this.wanted.delete(name);
        else if (isNewest()) this.answers.delete(name);
      },
    );
  }

  /** Sends a request unless the same was sent last; the newest of a name wins. */
  private want(name: string, key: string, request: JsonObject, take: (answer: Answer) => void, isLong = false) {
    if (this.wanted.get(name) === key) return;
    this.wanted.set(name, key);
    const asked = { ...request, lang: this.language };
    const sent = isLong ? this.engine.askLong(name, asked) : this.engine.ask(name, asked);
    sent.then(
      (answer) => {
        // An older answer is shown on the way, as while something is dragged.
        const isNewest = this.wanted.get(name) === key;
        if (!isNewest && !["picture", "pictureB", "overview", "explain"].includes(name)) return;
        take(answer);
        this.silence(name);
        this.changed();
      },
      (error: unknown) => {
        if (this.wanted.get(name) === key) this.wanted.delete(name);
        this.silence(name);
        if (error instanceof Superseded) return;
        if (name === "record" || name === "step") this.isRecording = false;
        this.refuse(name, key, error);
      },
    );
  }

  /** Tells why a request was refused. It counts as sent, lest it be sent again and again. */
  private refuse(name: string, key: string, error: unknown) {
    this.wanted.set(name, key);
    if (name === "picture") this.refusedPlane = this.planeKey();
    if (name === "pictureB" && this.planeB) this.planeB = { ...this.planeB, key };
    this.answers.delete(name);
    this.fail(wordsOf(error));
  }

  // ---- Dragging ----

  beginDrag() {
    this.isDragging = true;
  }

  endDrag() {
    this.isDragging = false;
    this.wanted.delete("picture");
    this.effects();
    this.changed();
  }

  // ---- Steps ----

  goToStep(number: number | null) {
    const count = this.stepCount;
    const step = number === null ? null : Math.min(Math.max(1, number), Math.max(1, count));
    this.playback.prediction = null;
    this.setLab({ step });
  }

  /** Leaves the steps for the finished picture. */
  showFinished() {
    this.playback.pause();
    this.goToStep(null);
  }

  get stepNumber() {
    return this.lab.step ?? this.stepCount;
  }

  // ---- Pixels ----

  inspect(pixel: [number, number] | null) {
    const inside = pixel && pixel.every((v, i) => Number.isInteger(v) && v >= 0 && v < (i === 0 ? this.width : this.height));
    if (pixel && !inside) return;
    this.cross = pixel;
    this.setLab({ pixel });
  }

  /** Files came: what was asked for may have other answers. */
  forgetAnswers() {
    this.recording = this.step = undefined;
    this.finished = this.finishedB = undefined;
    this.answers.clear();
    this.wanted.clear();
  }

  /** Shows what is there once more, with other files. */
  showAnew() {
    this.plane = this.finished = undefined;
    this.effects();
    this.changed();
  }
}

function planeOf(picture: Picture, bytes: Uint8Array | undefined): Plane {
  return { bytes: bytes ?? new Uint8Array(), width: picture.width, height: picture.height };
}

export function browserLanguage(): Language {
  const found = navigator.languages.map((l) => l.slice(0, 2)).find((l) => ["en", "ro", "fr", "pt"].includes(l));
  return (found as Language | undefined) ?? "en";
}
