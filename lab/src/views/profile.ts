// `img "Profile along the line"`: the brightness of the pixel's row, in which steps of flat shading and
// Mach bands at Gouraud's edges can be seen (L7, L10).

import { html, type TemplateResult } from "lit-html";
import type { App } from "../app.ts";
import { drawing } from "../parts/markup.ts";
import { t } from "../words.ts";

/** Height of the drawing in its units; its width is that of the picture. */
const HEIGHT = 120;

export function profile(app: App): TemplateResult {
  const { pixel } = app.lab;
  const plane = app.plane?.value;
  const content = pixel && plane && pixel[1] < plane.height ? curve(plane.bytes, plane.width, pixel) : null;
  return html`<section class="region" aria-labelledby="profile-title">
    <h2 id="profile-title">${t("Profile along the line")}</h2>
    ${content
      ? html`<div class="profile" role="img" aria-label=${t("Profile along the line")}>${drawing(content, "profile")}</div>
          <p class="caption">${t("brightness of row {0}, 0 to 255; the mark is the inspected pixel", pixel![1])}</p>`
      : html`<p class="note">${t("Inspect a pixel to see how bright its row is.")}</p>`}
  </section>`;
}

/** The mean of red, green and blue along the row of a pixel. */
function curve(bytes: Uint8Array, width: number, [x, y]: [number, number]): string {
  const brightness = (column: number) => {
    const at = (y * width + column) * 4;
    return (bytes[at]! + bytes[at + 1]! + bytes[at + 2]!) / 3;
  };
  const Y = (value: number) => (HEIGHT - (value / 255) * HEIGHT).toFixed(1);
  let path = "";
  for (let column = 0; column < width; column++) path += `${column ? "L" : "M"}${column + 0.5} ${Y(brightness(column))}`;
  return (
    `<svg viewBox="0 -4 ${width} ${HEIGHT + 8}" preserveAspectRatio="none"><path class="axes" d="M0 0V${HEIGHT}H${width}"/>` +
    `<path class="guide" d="M${x + 0.5} 0V${HEIGHT}"/><path class="graph" d="${path}"/></svg>`
  );
}
