// Dialogs that do not block the page. They stand over the settings, beside picture and exercise, and
// are dragged by their header; on phones they are sheets at the bottom.

import { html, nothing, type TemplateResult } from "lit-html";
import { ref } from "lit-html/directives/ref.js";
import type { App } from "../app.ts";
import type { DialogName } from "../open-dialogs.ts";
import { button } from "../parts/fields.ts";
import { css } from "../parts/css.ts";
import { icon } from "../parts/icons.ts";
import { isPhone } from "../width.ts";
import { t } from "../words.ts";

/** Opens without modality once it is there. */
const opened = (e: Element | undefined) => {
  const dialog = e as HTMLDialogElement | undefined;
  if (dialog && !dialog.open) dialog.show();
};

/** Pixels between a dialog and the window's edges. */
const MARGIN = 6;

/** Puts a dialog elsewhere, within the window. */
function move(app: App, name: DialogName, dialog: HTMLElement, left: number, top: number) {
  const within = (v: number, most: number) => Math.max(MARGIN, Math.min(v, most - MARGIN));
  app.dialogs.places.set(name, {
    left: within(left, innerWidth - dialog.offsetWidth),
    top: within(top, innerHeight - 60),
  });
  app.changed();
}

/** Follows the pointer while a header is dragged. */
function drag(app: App, name: DialogName, e: PointerEvent) {
  if (isPhone() || e.button !== 0 || (e.target as Element).closest("button")) return;
  const header = e.currentTarget as HTMLElement;
  const dialog = header.parentElement!;
  const from = dialog.getBoundingClientRect();
  header.setPointerCapture(e.pointerId);
  header.onpointermove = (to) => move(app, name, dialog, from.left + to.clientX - e.clientX, from.top + to.clientY - e.clientY);
  header.onpointerup = header.onpointercancel = () => {
    header.onpointermove = header.onpointerup = header.onpointercancel = null;
  };
}

/** Puts a dialog at the window's other side. */
function moveAside(app: App, name: DialogName, e: Event) {
  const dialog = (e.currentTarget as Element).closest("dialog")!;
  const { left, width, top } = dialog.getBoundingClientRect();
  const isLeft = left + width / 2 < innerWidth / 2;
  move(app, name, dialog, isLeft ? innerWidth - width : 0, top);
}

export function dialog(app: App, name: DialogName, title: string, content: unknown): TemplateResult {
  const close = () => app.dialogs.close(name);
  const place = isPhone() ? undefined : app.dialogs.places.get(name);
  const number = app.dialogs.all.indexOf(name);
  const style = { "--n": String(number), ...(place ? { left: `${place.left}px`, right: "auto", top: `${place.top}px` } : {}) };
  return html`<dialog data-name=${name} aria-labelledby=${`dialog-${name}`} .style=${css(style)} ${ref(opened)}>
    <header @pointerdown=${(e: PointerEvent) => drag(app, name, e)}>
      <h2 id=${`dialog-${name}`}>${title}</h2>
      <div class="buttons">
        ${isPhone() ? nothing : button(t("Move aside"), (e) => moveAside(app, name, e), { icon: icon("aside") })}
        <button type="button" @click=${close}>${t("Close")}</button>
      </div>
    </header>
    <div class="content">${content}</div>
  </dialog>`;
}
