// The dialogs that are open. They do not block the page; whatever opened one gets the focus back.

import type { App } from "./app.ts";

export type DialogName = "lights" | "materials" | "camera" | "keyboard" | "language" | "about";

export class OpenDialogs {
  /** The one that was opened last comes last. */
  all: DialogName[] = [];

  private readonly openers = new Map<DialogName, Element | null>();

  constructor(private readonly app: App) {}

  open(name: DialogName, opener: Element | null = document.activeElement) {
    this.openers.set(name, opener);
    this.all = [...this.all.filter((d) => d !== name), name];
    this.app.changed();
    setTimeout(() => {
      const dialog = document.querySelector(`dialog[data-name="${name}"]`);
      dialog?.querySelector<HTMLElement>("select, input, button")?.focus();
    }, 60);
  }

  close(name: DialogName) {
    this.all = this.all.filter((d) => d !== name);
    this.app.changed();
    const opener = this.openers.get(name);
    const isThere = opener instanceof HTMLElement && opener.isConnected && opener.offsetParent !== null;
    const back = isThere ? opener : document.querySelector<HTMLElement>('[role="application"]');
    setTimeout(() => back?.focus(), 30);
  }
}
