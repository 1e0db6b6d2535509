// `region "Formula"`: the formula in force, the same with the pixel's numbers, and its values.

import { html, nothing, type TemplateResult } from "lit-html";
import type { App } from "../app.ts";
import { at, isObject, type JsonObject } from "../json.ts";
import { colorSpins, wholeColor } from "../parts/color-spins.ts";
import { spin } from "../parts/fields.ts";
import { formula } from "../parts/markup.ts";
import { valueText } from "../parts/numbers.ts";
import { table, type Cell } from "../parts/table.ts";
import { words } from "../parts/what.ts";
import { t, translated } from "../words.ts";
import { attenuationOf, lightNow, setAttenuation, setColor } from "../lights.ts";
import { propertyOf, setMaterial } from "../materials.ts";
import { explanationOf, objects } from "./pixel.ts";

/** A colour of the formula as numbers that can be set. */
const colorOf = (symbol: string, values: readonly number[], set: (i: number, value: number) => void) =>
  html`<div class="in-row">${colorSpins(values, (_, label) => t("Value of {0}", `${symbol} ${t(label).toLowerCase()}`), set)}</div>`;

/** Colours of a light by their symbols in the formula. */
const LIGHT_COLORS = { Ia: "ambient", Id: "diffuse", Is: "specular" } as const;

/** Numbers of a light that can be set: a colour, or the coefficients of its attenuation. */
function lightValue(app: App, symbol: string, number: number): Cell {
  const light = lightNow(app, number);
  const [letter = "", name = ""] = symbol.split(" ");
  const field = Object.hasOwn(LIGHT_COLORS, letter) ? LIGHT_COLORS[letter as keyof typeof LIGHT_COLORS] : null;
  if (light && field) {
    const values = (light[field] as number[] | undefined) ?? [0, 0, 0];
    return colorOf(`${letter} ${name}`, values, (i, v) => setColor(app, number, field, i, v));
  }
  if (light && letter === "f_att") {
    return html`<div class="in-row">
      ${attenuationOf(light).map((c, i) =>
        spin(`c${i + 1}`, c, (v) => setAttenuation(app, number, i, v), { name: t("Value of {0}", `c${i + 1} ${name}`), min: 0, step: 0.05 }),
      )}
    </div>`;
  }
  const open = () => {
    app.lightNumber = number;
    app.dialogs.open("lights");
  };
  return letter === "L" || letter === "ambient" ? html`<button type="button" class="link" @click=${open}>${t("Lights…")}</button>` : "";
}

/** Where a value can be changed: a field of the state, a light, the material. */
function place(app: App, row: JsonObject): Cell {
  const setting = row["setting"];
  if (typeof setting !== "string") return "";
  const symbol = String(row["symbol"]);
  if (setting.startsWith("lights.")) return lightValue(app, symbol, Number(setting.slice(7)));
  if (setting.startsWith("materials.")) {
    const property = setting.slice(10);
    const name = materialOfPixel(app);
    const material = app.complete?.value.materials.find((m) => String(m["name"] ?? "") === name);
    const value = material && propertyOf(material, property);
    if (name !== null && Array.isArray(value)) {
      const values = value.map(Number);
      return colorOf(symbol, values, wholeColor(values, (to) => setMaterial(app, name, property, to.join(","))));
    }
    if (name !== null && typeof value === "number") {
      return spin(symbol, value, (v) => setMaterial(app, name, property, String(v)), { name: t("Value of {0}", symbol), min: 0, max: 1000 });
    }
    return html`<button type="button" class="link" @click=${() => app.dialogs.open("materials")}>${t("Materials…")}</button>`;
  }
  const value = at(app.state, setting);
  if (typeof value === "number") return spin(symbol, value, (v) => app.set({ [setting]: v }), { name: t("Value of {0}", symbol) });
  if (Array.isArray(value) && value.length === 3) {
    const values = value.map(Number);
    return colorOf(symbol, values, wholeColor(values, (to) => app.set({ [setting]: to })));
  }
  return "";
}

function materialOfPixel(app: App): string | null {
  const seen = objects(explanationOf(app)?.["candidates"]).find((c) => c["stage"] === "visible");
  return seen && typeof seen["material"] === "string" ? seen["material"] : null;
}

/** Symbols of a light that are explained below the table. */
const FORMULA_TERMS = ["N·L", "R·V", "N·H", "f_att", "S"] as const;

export function formulaRegion(app: App): TemplateResult {
  const found = explanationOf(app) ? app.answerTo("explain")?.ok["formula"] : null;
  const f = isObject(found ?? undefined) ? (found as JsonObject) : null;
  const [mathml, numbers] = [f?.["mathml"], f?.["numbers"]];
  const rows = objects(f?.["values"]).map((row): Cell[] => [
    String(row["symbol"]),
    valueText(row["value"]),
    translated(String(row["meaning"])),
    place(app, row),
  ]);
  return html`<section class="region formula" aria-labelledby="formula-title">
    <h2 id="formula-title">${t("Formula")}</h2>
    ${f
      ? html`<div class="math scroll" tabindex="0" role="group" aria-label=${t("Formula")}>
            ${typeof mathml === "string" ? formula(mathml, "letters") : nothing} ${typeof numbers === "string" ? formula(numbers, "numbers") : nothing}
          </div>
          ${table({ name: t("Values"), columns: [t("symbol"), t("value"), t("meaning"), t("set in")], rows, caption: true })}
          ${words(FORMULA_TERMS.filter((term) => rows.some(([symbol]) => String(symbol).startsWith(`${term} (`))).map((term) => [term, term]))}`
      : html`<p class="note">${t("Inspect a pixel to see its formula with numbers.")}</p>`}
    ${f ? printed(app) : nothing}
  </section>`;
}

/** Formulas that the notes print wrongly, beside the right ones. */
function printed(app: App): unknown {
  const rows = objects(app.answerTo("explain")?.ok["printed"]).map((row): Cell[] => [
    partsTranslated(String(row["what"])),
    html`${formula(String(row["right"]), `right ${String(row["what"])}`)}`,
    valueText(row["right-value"]),
    html`${formula(String(row["printed"]), `printed ${String(row["what"])}`)}`,
    valueText(row["printed-value"]),
  ]);
  if (!rows.length) return nothing;
  const columns = [t("what"), t("right form"), t("result"), t("as printed"), t("result as printed")];
  return html`<details>
    <summary>${t("Where the notes err")}</summary>
    ${table({ name: t("Where the notes err"), columns, rows })}
  </details>`;
}

/** A text with the name of a light at its end. */
function partsTranslated(text: string): string {
  const found = /^(.*) of (.+)$/.exec(text);
  return found ? `${translated(`${found[1]!} of`)} ${found[2]!}` : translated(text);
}
