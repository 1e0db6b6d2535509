// Single keys. They act while the picture, the steps or the structure has the focus.

import type { App } from "./app.ts";
import { hideExplanation, isExplaining } from "./parts/what.ts";
import { setComparison } from "./views/compare.ts";
import { closeMenu } from "./views/menus.ts";
import { resetView } from "./views/camera.ts";

const PLACES = '[role="application"], .steps, .structure';

/** Fields and buttons keep the keys that they use themselves. */
const uses = (element: Element, key: string) =>
  element.matches("select, textarea, input:not([type=range]):not([type=checkbox])") ||
  (element.matches("button, summary, input[type=checkbox], [role=treeitem]") && (key === " " || key === "Enter")) ||
  (element.matches("input[type=range], [role=treeitem]") && (key === "Home" || key === "End"));

export function listenToKeys(app: App) {
  addEventListener("keydown", (e) => {
    const element = e.target instanceof Element ? e.target : document.body;
    if (e.defaultPrevented || e.ctrlKey || e.metaKey || e.altKey) return;
    if (e.key === "Escape") return escape(app, e, element);
    if (!element.closest(PLACES)) return;
    if (!app.hasKeys || uses(element, e.key)) return;
    const act = actions(app)[e.key];
    if (!act) return;
    e.preventDefault();
    act();
  });
}

/**
 * Closes what is open: a menu, an explanation, the topmost dialog. Then, in picture, steps and structure,
 * leaves the steps, unless a facet is chosen, which is taken away first.
 */
function escape(app: App, e: KeyboardEvent, element: Element) {
  const dialog = app.dialogs.all.at(-1);
  if (closeMenu(app)) e.preventDefault();
  else if (isExplaining()) hideExplanation();
  else if (dialog) {
    e.preventDefault();
    app.dialogs.close(dialog);
  } else if (app.lab.step !== null && !app.chosen && element.closest(PLACES)) app.showFinished();
}

/** Turns the comparison on or off; the focus stays in a picture. */
function toggleComparison(app: App) {
  setComparison(app, app.lab.compare === "none" ? "side" : "none");
  setTimeout(() => document.querySelector<HTMLElement>('.pictures [role="application"]')?.focus(), 60);
}

function actions(app: App): Record<string, () => void> {
  const isFull = app.lab.layout === "full";
  const steps: Record<string, () => void> = {
    " ": () => (app.playback.isPlaying ? app.playback.pause() : app.playback.play()),
    ",": () => app.goToStep(app.stepNumber - 1),
    ".": () => void app.playback.next(),
    Home: () => app.goToStep(1),
    End: () => app.goToStep(app.stepCount),
  };
  const others: Record<string, () => void> = {
    c: () => toggleComparison(app),
    p: () => app.inspect(app.cross ?? app.lab.pixel ?? [Math.floor(app.width / 2), Math.floor(app.height / 2)]),
    l: () => app.dialogs.open("lights"),
    "?": () => app.dialogs.open("keyboard"),
  };
  const stepping = app.hasSteps && app.stepCount > 0 ? steps : {};
  return { ...stepping, ...(isFull ? others : {}), r: () => resetView(app) };
}
