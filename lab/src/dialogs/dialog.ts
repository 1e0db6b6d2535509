// Dialogs that do not block the page.

import { html, type TemplateResult } from "lit-html";
import { ref } from "lit-html/directives/ref.js";
import type { App } from "../app.ts";
import type { DialogName } from "../open-dialogs.ts";
import { t } from "../words.ts";

/** Opens without modality once it is there. */
const opened = (e: Element | undefined) => {
  const dialog = e as HTMLDialogElement | undefined;
  if (dialog && !dialog.open) dialog.show();
};

export function dialog(app: App, name: DialogName, title: string, content: unknown): TemplateResult {
  const close = () => app.dialogs.close(name);
  const keys = (e: KeyboardEvent) => {
    if (e.key !== "Escape") return;
    e.preventDefault();
    e.stopPropagation();
    close();
  };
  return html`<dialog data-name=${name} aria-labelledby=${`dialog-${name}`} @keydown=${keys} ${ref(opened)}>
    <header>
      <h2 id=${`dialog-${name}`}>${title}</h2>
      <button type="button" @click=${close}>${t("Close")}</button>
    </header>
    <div class="content">${content}</div>
  </dialog>`;
}
