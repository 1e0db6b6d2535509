// Opening a link: its fragment becomes a situation, without what the engine refuses.

import type { App } from "./app.ts";
import { browserLanguage } from "./app.ts";
import { at, isObject, put, type JsonObject } from "./json.ts";
import { LAB, read, unpack, write, type Problem, type Situation } from "./link.ts";
import { missingModels, overlay } from "./states.ts";
import { setLanguage, t } from "./words.ts";

export class Opening {
  /** What an empty link opens: models with their files, or a state. */
  start: { models?: string[]; files?: { name: string; url: string }[]; state?: JsonObject } = {};

  constructor(private readonly app: App) {}

  /** Reads a fragment and opens what it says. */
  async open(fragment: string) {
    const { app } = this;
    const { catalog } = app;
    if (!catalog) return;
    const { form, problems: packing } = await unpack(fragment);
    if ([...form.keys()].length === 0) this.startForm().forEach((value, key) => form.append(key, value));
    const exercise = form.has("models") ? undefined : catalog.exercises.find((e) => e.id === form.get("exercise"));
    if (!exercise && !form.has("models")) form.append("models", JSON.stringify(this.startModels));

    // A link that names an exercise and no model begins where the exercise does.
    const start = exercise && overlay(catalog.defaults, exercise.start);
    const { situation, problems } = read(form, catalog.defaults, start);
    const exercises = catalog.exercises.map((e) => e.id);
    if (situation.lab.exercise !== null && !exercises.includes(situation.lab.exercise)) {
      situation.lab.exercise = null;
      problems.push({ key: "exercise", what: "bad-value" });
    }
    const told = [...packing, ...problems].map((p) => tell(p));
    told.push(...(await this.dropRefused(situation, form, start ?? put(catalog.defaults, "models", this.startModels))));
    told.push(...(await this.dropOutside(situation)));
    app.alert = told.length ? `${t("In the link")}: ${told.join("; ")}` : "";
    setLanguage(situation.lab.lang ?? browserLanguage());

    app.playback.isPlaying = false;
    app.cross = null;
    app.sameCamera = !Object.keys(situation.b).some((p) => p.startsWith("viewpoint"));
    const { play } = situation.lab;
    app.go(situation, "replace");
    if (play) app.playback.play();
    if (app.alert) app.emit("error");
  }

  private get startModels() {
    return this.start.models?.length ? this.start.models : ["builtin:teapot"];
  }

  /** What an empty fragment stands for. */
  private startForm(): URLSearchParams {
    const defaults = this.app.catalog!.defaults;
    const state = overlay(defaults, { models: this.startModels, ...this.start.state });
    const size: JsonObject = this.start.state ? {} : { width: 640, height: 480 };
    const settings = { ...(state["settings"] as JsonObject), ...size };
    return write({ state: { ...state, settings }, b: {}, lab: LAB }, defaults);
  }

  /** Takes fields out of a situation until the engine accepts it; says which. `start` is the state without them. */
  private async dropRefused(situation: Situation, form: URLSearchParams, start: JsonObject): Promise<string[]> {
    this.app.missing = missingModels(situation.state, this.app.own.contents);
    if (this.app.missing.length) return [];
    const { state, b } = situation;
    const told: string[] = [];
    const isField = (key: string) => !Object.hasOwn(LAB, key) && !key.startsWith("b.") && at(state, key) !== undefined;
    const fields = [...new Set(form.keys())].filter(isField);
    const stateOfFields = (keys: string[]) => keys.reduce((sum, key) => put(sum, key, at(state, key) ?? null), start);
    const kept = await this.acceptedKeys(fields, stateOfFields, (key, why) => told.push(key ? `\`${key}\`: ${why}` : why));
    if (kept.length < fields.length) situation.state = stateOfFields(kept);

    const fieldsOfB = Object.keys(b);
    const stateOfB = (keys: string[]) => keys.reduce((sum, key) => put(sum, key, b[key] ?? null), situation.state);
    const keptOfB = await this.acceptedKeys(fieldsOfB, stateOfB, (key, why) => told.push(key ? `\`b.${key}\`: ${why}` : why));
    situation.b = Object.fromEntries(keptOfB.map((key) => [key, b[key] ?? null]));
    return told;
  }

  /** The keys with which the engine accepts a state; tells why each of the others is left out. */
  private async acceptedKeys(
    keys: string[],
    stateOf: (keys: string[]) => JsonObject,
    tellRefused: (key: string | null, why: string) => void,
  ): Promise<string[]> {
    const reason = await this.reasonAgainst(stateOf(keys));
    if (reason === null) return keys;
    const guilty = await this.guiltyKey(keys, stateOf, reason);
    tellRefused(guilty ?? null, reason);
    if (guilty === undefined) return keys;
    return this.acceptedKeys(keys.filter((key) => key !== guilty), stateOf, tellRefused);
  }

  /** The key that a refusal is about: without it the state is accepted, or refused for another reason. */
  private async guiltyKey(keys: string[], stateOf: (keys: string[]) => JsonObject, reason: string): Promise<string | undefined> {
    const which = async (list: string[], test: (key: string) => Promise<boolean>) => {
      const results: boolean[] = [];
      for (const key of list) results.push(await test(key));
      return list.filter((_, i) => results[i]);
    };
    const suspects = await which(keys, async (key) => (await this.reasonAgainst(stateOf(keys.filter((k) => k !== key)))) !== reason);
    if (suspects.length === 1) return suspects[0];

    // Of fields that only together are refused, one is wrong by itself, or the reason speaks of it.
    const isAlone = (key: string) => (k: string) => k === key || k === "models";
    const alone = await which(suspects.length ? suspects : keys, async (key) => (await this.reasonAgainst(stateOf(keys.filter(isAlone(key))))) !== null);
    const words = (key: string) => key.slice(key.lastIndexOf(".") + 1).replaceAll("-", " ");
    return alone[0] ?? suspects.find((key) => reason.replaceAll("-", " ").includes(words(key))) ?? suspects.at(-1);
  }

  /** The Lab's own keys that do not go with the state: taken out, and told. */
  private async dropOutside({ state, lab }: Situation): Promise<string[]> {
    const told: string[] = [];
    const { defaults } = this.app.catalog!;
    const size = ["settings.width", "settings.height"].map((path) => Number(at(state, path)));
    if (lab.pixel?.some((v, i) => v >= size[i]!)) {
      told.push(tell({ key: "pixel", what: "outside" }));
      lab.pixel = null;
    }
    const { second } = lab;
    const viewpoint = defaults["viewpoint"];
    if (!isObject(second) || !isObject(viewpoint)) return told;
    const unknown = Object.keys(second).filter((field) => !Object.hasOwn(viewpoint, field));
    told.push(...unknown.map((field) => tell({ key: `second.${field}`, what: "unknown-field" })));
    const seen = put(put(defaults, "models", this.startModels), "viewpoint", overlay(viewpoint, second));
    const reason = unknown.length ? null : await this.reasonAgainst(seen);
    if (reason !== null) told.push(`\`second\`: ${reason}`);
    if (unknown.length || reason !== null) lab.second = "off";
    return told;
  }

  /** Why the engine refuses the state of a link, which has no lines; `null` if it does not. */
  private async reasonAgainst(state: JsonObject): Promise<string | null> {
    const refusal = await this.app.refusalOf(state);
    return refusal && refusal.message.replace(/^state: (line \d+, column \d+: )?/, "");
  }
}

function tell({ key, what }: Problem): string {
  const words = { "unknown-field": "unknown field", "bad-value": "no value that can be", unreadable: "cannot be read", outside: "outside of the picture" } as const;
  const short = key.length > 60 ? `${key.slice(0, 60)}…` : key;
  return `\`${short}\`: ${t(words[what])}`;
}
