// Messages between a page inside an `iframe` and the page around it.

import type { App } from "./app.ts";

export function talkToParent(app: App) {
  if (parent === window) return;
  app.onEvent((event) => {
    void app.fragment().then((hash) => {
      const { stepNumber: step, stepCount: steps } = app;
      parent.postMessage({ type: "vitral-lab", event, step, steps, hash: `#${hash}` }, "*");
    });
  });
  addEventListener("message", ({ data, source }: MessageEvent<unknown>) => {
    if (source !== parent || typeof data !== "object" || data === null) return;
    const { type, hash } = data as { type?: unknown; hash?: unknown };
    if (type === "vitral-lab" && typeof hash === "string") void app.opening.open(hash.replace(/^#/, ""));
  });
}
