// The dialogs that are open. They do not block the page; whatever opened one gets the focus back.

import type { App } from "./app.ts";
import { isPhone } from "./width.ts";

export type DialogName = "lights" | "materials" | "camera" | "keyboard" | "language" | "about";

export class OpenDialogs {
  /** The one that was opened last comes last. */
  all: DialogName[] = [];

  /** Where dialogs were dragged to, in pixels of the window. */
  readonly places = new Map<DialogName, { left: number; top: number }>();

  private readonly openers = new Map<DialogName, Element | null>();

  constructor(private readonly app: App) {}

  open(name: DialogName, opener: Element | null = document.activeElement) {
    this.openers.set(name, opener);
    this.all = [...this.all.filter((d) => d !== name), name];
    this.app.render();
    // A sheet at the bottom leaves the picture above it in view.
    if (isPhone()) document.querySelector(".pictures .stage")?.scrollIntoView({ block: "start", behavior: "instant" });
    const dialog = document.querySelector(`dialog[data-name="${name}"]`);
    dialog?.querySelector<HTMLElement>("select, input, button")?.focus({ preventScroll: true });
  }

  close(name: DialogName) {
    this.all = this.all.filter((d) => d !== name);
    this.places.delete(name);
    this.app.render();
    const opener = this.openers.get(name);
    const isThere = opener instanceof HTMLElement && opener.isConnected && opener.offsetParent !== null;
    const back = isThere ? opener : document.querySelector<HTMLElement>('[role="application"]');
    back?.focus();
  }
}
