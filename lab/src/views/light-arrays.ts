// `table "Lights of the scene"`: the four arrays of each light (L15).

import { html, nothing } from "lit-html";
import type { App } from "../app.ts";
import type { Json } from "../json.ts";
import { placeOf } from "../lights.ts";
import { table, type Cell } from "../parts/table.ts";
import { t } from "../words.ts";

export function lightArrays(app: App): unknown {
  const lights = app.complete?.value.lights ?? [];
  if (!lights.length) return nothing;
  const numbers = (v: Json | undefined) => (Array.isArray(v) ? v.map((n) => Number(Number(n).toPrecision(4))).join(" ") : "–");
  const rows = lights.map((light, i): Cell[] => [
    `LIGHT${i}`,
    numbers(light["ambient"]),
    numbers(light["diffuse"]),
    numbers(light["specular"]),
    numbers(placeOf(light) as number[] | undefined),
  ]);
  const columns = [t("light"), t("ambient"), t("diffuse"), t("specular"), t("position x y z w")];
  return html`${table({ name: t("Lights of the scene"), columns, rows, caption: true })}`;
}
