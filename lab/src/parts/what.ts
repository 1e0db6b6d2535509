// `button "What is …"` beside a label, and the popover that it opens with the term's explanation.

import { html, type TemplateResult } from "lit-html";
import { t, translated, type Key } from "../words.ts";

/** A term that the page explains: one of the table, or a text of the engine. */
export type Term = (Key extends infer K ? (K extends `about ${infer T}` ? T : never) : never) | { text: string };

const ID = "explanation";

/** Browsers of the first months of 2024 may lack popovers: there the box is hidden and shown by hand. */
const HAS_POPOVERS = "popover" in HTMLElement.prototype;

const isShown = (box: HTMLElement) => (HAS_POPOVERS ? box.matches(":popover-open") : !box.hidden);

/** Whether an explanation is open. */
export function isExplaining(): boolean {
  const box = document.getElementById(ID);
  return box !== null && isShown(box);
}

/** Closes the explanation that is open, where the browser does not do so itself. */
export function hideExplanation() {
  const box = document.getElementById(ID);
  if (box && !HAS_POPOVERS) box.hidden = true;
}

/** The explanation of a term in words. */
export const explanationText = (term: Term): string => (typeof term === "string" ? t(`about ${term}` as Key) : translated(term.text));

/** Puts the explanation beside its button: below it, or above it in the lower part of the window. */
function place(box: HTMLElement, button: Element) {
  const { left, top, bottom } = button.getBoundingClientRect();
  const width = Math.min(320, innerWidth - 16);
  const isLow = bottom > innerHeight * 0.62;
  Object.assign(box.style, {
    width: `${width}px`,
    left: `${Math.max(8, Math.min(left - 12, innerWidth - width - 8))}px`,
    top: isLow ? "auto" : `${bottom + 6}px`,
    bottom: isLow ? `${innerHeight - top + 6}px` : "auto",
  });
}

/** The button that opens the explanation of a term, which the page calls `label`. */
export function what(term: Term, label: string): TemplateResult {
  const fill = (e: Event) => {
    const box = document.getElementById(ID);
    if (!box) return;
    const [title, text] = box.children;
    // Another term's button changes the explanation that is open.
    const isOther = title!.textContent !== label;
    if (isShown(box) && isOther) e.preventDefault();
    title!.textContent = label;
    text!.textContent = explanationText(term);
    place(box, e.currentTarget as Element);
    if (HAS_POPOVERS) return;
    box.hidden = !box.hidden && !isOther;
    box.focus({ preventScroll: true });
  };
  return html`<button type="button" class="what" popovertarget=${ID} aria-label=${t("What is {0}?", label)} @click=${fill}>?</button>`;
}

/** Words with their buttons, below a table that uses them. */
export const words = (terms: [Term, string][]): TemplateResult =>
  html`<p class="words">${terms.map(([term, word]) => html`<span>${word} ${what(term, word)}</span>`)}</p>`;

/** Where explanations appear. */
export const explanationBox = (): TemplateResult => {
  // The focus goes along, so that the text is read aloud; Escape gives it back.
  const read = (e: Event) => {
    const box = e.currentTarget as HTMLElement;
    if (isShown(box)) box.focus({ preventScroll: true });
  };
  const hide = (e: Event) => {
    if (!HAS_POPOVERS) (e.currentTarget as HTMLElement).hidden = true;
  };
  return html`<div
    id=${ID}
    class="explanation"
    popover="auto"
    role="note"
    tabindex="-1"
    ?hidden=${!HAS_POPOVERS}
    aria-labelledby=${`${ID}-title`}
    @toggle=${read}
    @focusout=${hide}
  >
    <strong id=${`${ID}-title`}></strong>
    <p></p>
  </div>`;
};

/** Which way depths count, below a table that has some. */
export const depthNote = (): TemplateResult => html`<p class="note">${t("Depths: 1 is near, 0 is far.")}</p>`;
