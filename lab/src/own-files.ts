// The user's own files: kept under their names, told to the engine, shown.

import type { App } from "./app.ts";
import { wordsOf, type UserFile } from "./engine.ts";
import { put, type JsonObject } from "./json.ts";
import { hashOf, missingModels, nameOf, overlay, stateIn } from "./states.ts";
import { t } from "./words.ts";

/** Names of files that models name: material libraries, textures, buffers. */
const GOES_WITH_MODELS = /\.(mtl|bin|png|jpe?g|webp|gif|bmp|tga|tiff?|ktx2?|hdr)$/i;

export class OwnFiles {
  /** The names of those that are models. */
  models = new Set<string>();
  contents = new Map<string, Uint8Array>();
  /** The first digits of the hash of each. */
  hashes = new Map<string, string>();

  constructor(private readonly app: App) {}

  /** Hands files to the engine, beside those that are there; gives what it tells of each. */
  async give(list: UserFile[]): Promise<JsonObject[]> {
    for (const { name, bytes } of list) this.contents.set(name, bytes);
    const { ok } = await this.app.engine.give([...this.contents].map(([name, bytes]) => ({ name, bytes })));
    const all = ok["files"] as JsonObject[];
    const kept = all.filter((f) => this.contents.has(String(f["name"])));
    this.hashes = new Map(kept.map((f) => [String(f["name"]), String(f["hash"])]));
    this.models = new Set(kept.filter((f) => f["model"] === true).map((f) => String(f["name"])));
    return all.filter((f) => list.some(({ name }) => name === f["name"]));
  }

  /** Opens files that were chosen or dropped. */
  async open(list: UserFile[]) {
    try {
      const { app } = this;
      const { defaults } = app.catalog!;
      const state = list.find((f) => f.name.endsWith(".json") && stateIn(f.bytes, defaults));
      if (!state) return await this.openModels(list);
      // A state file replaces the state; files beside it are kept for it.
      const others = list.filter((f) => f !== state);
      if (others.length) {
        await this.give(others);
        app.forgetAnswers();
      }
      await this.openState(state.name, stateIn(state.bytes, defaults)!);
    } catch (e) {
      this.app.fail(wordsOf(e));
    }
  }

  private async openState(file: string, state: JsonObject) {
    const { app } = this;
    const named = this.withOwnNames(state);
    const whole = overlay(app.catalog!.defaults, named);
    const refusal = missingModels(whole, this.contents).length ? null : await app.refusalOf(whole);
    if (refusal) app.fail(`${file}: ${refusal.message}`);
    else app.openState(named);
  }

  /** A state whose models are called by their content where they are here, as files of the user where they are not. */
  private withOwnNames(state: JsonObject): JsonObject {
    const { models } = state;
    if (!Array.isArray(models)) return state;
    const named = models.map((model) => {
      if (typeof model !== "string" || /^builtin:|^file:.*#[0-9a-f]+$/.test(model)) return model;
      const path = nameOf(model);
      const name = this.contents.has(path) ? path : (path.split(/[\\/]/).at(-1) ?? path);
      const hash = this.hashes.get(name);
      return hash === undefined ? `file:${name}` : `file:${name}#${hash}`;
    });
    return { ...state, models: named };
  }

  private async openModels(list: UserFile[]) {
    const { app } = this;
    const refused = await this.refusedOf(list);
    const reasons = [...refused.values()].map(({ reason }) => reason).join("; ");
    if (refused.size === list.length) return app.fail(reasons);
    // What is beside a model may be named by it, whatever it is.
    const good = list.filter((f) => !refused.get(f.name)?.isModel && f.bytes.length > 0);
    const told = await this.give(good);
    app.forgetAnswers();
    const names = told.filter((f) => f["model"] === true).map((f) => `file:${f["name"]}#${f["hash"]}`);
    const lacking = told.flatMap((f) => (f["missing"] as string[] | undefined) ?? []);
    app.alert = "";
    this.show(names, good);
    if (lacking.length) app.fail(t("Files that the model names are missing: {0}. Choose them together with the model.", [...new Set(lacking)].join(", ")));
    else if (refused.size) app.fail(reasons);
  }

  /** Why files cannot be read, by their names. They are shown to the engine that draws and then taken back. */
  private async refusedOf(list: UserFile[]): Promise<Map<string, { reason: string; isModel: boolean }>> {
    const { app } = this;
    const hand = (files: UserFile[]) =>
      app.engine.ask(`files ${Math.random()}`, { want: "files", files: files.map(({ name }) => ({ name })) }, files.map((f) => f.bytes));
    const { ok } = await hand(list);
    const refused = new Map<string, { reason: string; isModel: boolean }>();
    for (const f of ok["files"] as JsonObject[]) {
      const name = String(f["name"]);
      const isModel = f["model"] === true;
      if (!list.some((l) => l.name === name) || (!isModel && GOES_WITH_MODELS.test(name))) continue;
      const refusal = await app.refusalOf(put(app.catalog!.defaults, "models", [`file:${name}#${f["hash"]}`]));
      // Buffers that are missing may come later.
      const mayCome = /\.gl(tf|b)$/i.test(name) && (f["missing"] as string[]).length > 0;
      if (mayCome || (isModel && !refusal)) continue;
      refused.set(name, { reason: refusal ? wordsOf(refusal) : t("No model that can be read: {0}", name), isModel });
    }
    const before = [...refused.keys()].flatMap((name) => {
      const bytes = this.contents.get(name);
      return bytes ? [{ name, bytes }] : [];
    });
    if (before.length) await hand(before);
    return refused;
  }

  /** Shows models that came, or gives a link what it waited for. */
  private show(names: string[], list: UserFile[]) {
    const { app } = this;
    const waiting = missingModels(app.state, new Map());
    const known = (model: string) => {
      const hash = hashOf(model);
      return hash === "" ? this.hashes.has(nameOf(model)) : names.includes(model) || this.hashes.get(nameOf(model)) === hash;
    };
    const other = waiting.filter((model) => list.some((f) => f.name === nameOf(model)) && !known(model));
    const wasMissing = app.missing.length > 0;
    if (wasMissing && other.length) {
      app.fail(t("{0} is another file than the one that the link means", nameOf(other[0]!)));
      for (const model of other) this.contents.delete(nameOf(model));
      app.effects();
      return;
    }
    if (wasMissing && waiting.every(known)) {
      app.alert = "";
      app.go({ ...app.situation, state: this.withOwnNames(app.state) }, "replace");
      return;
    }
    if (names.length) app.openModels(names);
    else app.showAnew();
  }
}
