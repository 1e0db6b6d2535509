// The user's own files: kept under their names, told to the engine, shown.

import type { App } from "./app.ts";
import { wordsOf, type UserFile } from "./engine.ts";
import type { JsonObject } from "./json.ts";
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
    this.hashes = new Map(all.map((f) => [String(f["name"]), String(f["hash"])]));
    for (const f of all) if (f["model"] === true) this.models.add(String(f["name"]));
    return all.filter((f) => list.some(({ name }) => name === f["name"]));
  }

  /** Opens files that were chosen or dropped. */
  async open(list: UserFile[]) {
    const { app } = this;
    // A state file replaces the state.
    if (list.length === 1 && list[0]!.name.endsWith(".json")) {
      const state = stateIn(list[0]!.bytes);
      if (state) {
        const refusal = await app.refusalOf(overlay(app.catalog!.defaults, state));
        if (refusal) return app.fail(`${list[0]!.name}: ${refusal.message}`);
        return app.openState(state);
      }
    }
    try {
      const told = await this.give(list);
      app.forgetAnswers();
      const names = told.filter((f) => f["model"] === true).map((f) => `file:${f["name"]}#${f["hash"]}`);
      const lacking = told.flatMap((f) => (f["missing"] as string[] | undefined) ?? []);
      const strange = told.filter((f) => f["model"] !== true && !GOES_WITH_MODELS.test(String(f["name"])));
      app.alert = "";
      this.show(names, list);
      if (lacking.length) app.fail(t("Files that the model names are missing: {0}. Choose them together with the model.", [...new Set(lacking)].join(", ")));
      else if (strange.length) app.fail(t("No model that can be read: {0}", strange.map((f) => String(f["name"])).join(", ")));
    } catch (e) {
      app.fail(wordsOf(e));
    }
  }

  /** Shows models that came, or gives a link what it waited for. */
  private show(names: string[], list: UserFile[]) {
    const { app } = this;
    const waiting = missingModels(app.state, new Map());
    const known = (model: string) => names.includes(model) || this.hashes.get(nameOf(model)) === hashOf(model);
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
      app.effects();
      app.changed();
      return;
    }
    if (names.length) app.openModels(names);
    else app.showAnew();
  }
}
