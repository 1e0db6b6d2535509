// What the tests of the page share: a browser, the page's address, and how to wait for it.
//
// LAB_URL is the address of a server (`vitral lab`) or of the single file; CHROMIUM the browser.

import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { test as nodeTest } from "node:test";
import { chromium } from "playwright-core";

const browserPath = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(
  (path) => path && existsSync(path),
);

export const url = process.env.LAB_URL;

const lacking = !browserPath ? "no Chromium: set CHROMIUM" : !url ? "no page: set LAB_URL" : null;
if (lacking) console.log(`The page of the Lab is not tested: ${lacking}.`);

/** Milliseconds that a page may take on a slow machine. */
const PATIENCE = 120_000;

let browser;

/** A test that gets a fresh page; skipped where there is no browser. */
export function test(name, action, options = {}) {
  nodeTest(name, { skip: lacking ?? false, timeout: 400_000 }, async () => {
    browser ??= await chromium.launch({ executablePath: browserPath, args: ["--no-sandbox"] });
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, locale: "en-GB", ...options });
    context.setDefaultTimeout(PATIENCE);
    const page = await context.newPage();
    const errors = [];
    page.on("console", (m) => m.type() === "error" && errors.push(m.text()));
    page.on("pageerror", (e) => errors.push(String(e)));
    try {
      await action(page);
      if (errors.length) throw new Error(`the console has errors: ${errors.join("; ")}`);
    } finally {
      await context.close();
    }
  });
}

export async function close() {
  await browser?.close();
}

/** Opens a fragment and waits until the canvas shows it. */
export async function open(page, fragment = "") {
  await page.goto("about:blank");
  await page.goto(url + (fragment ? `#${fragment}` : ""));
  await ready(page);
}

export async function ready(page) {
  await page.waitForFunction(
    () => {
      const all = [...document.querySelectorAll('[role="application"][aria-busy]')];
      return all.length > 0 && all.every((e) => e.getAttribute("aria-busy") === "false");
    },
    null,
  );
}

/** Waits until a question has the answer. */
export async function eventually(ask, expected, message = "") {
  const end = Date.now() + PATIENCE;
  let answer;
  do {
    answer = await ask();
    if (answer === expected) return;
    await new Promise((resolve) => setTimeout(resolve, 50));
  } while (Date.now() < end);
  assert.equal(answer, expected, message);
}

/** A short name of what a canvas shows. */
export const pictureOf = (page, name = "Picture") =>
  page
    .getByRole("application", { name, exact: true })
    .locator("canvas")
    .evaluate(async (canvas) => {
      const { width, height } = canvas;
      const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
      // FNV-1a; digests need a secure context.
      let hash = 0x811c9dc5;
      for (const byte of data) hash = Math.imul(hash ^ byte, 0x01000193);
      return `${width}x${height} ${(hash >>> 0).toString(16)}`;
    });

/** The fragment once the address bar has come to rest. */
export async function fragment(page) {
  await page.waitForTimeout(700);
  return new URLSearchParams(await page.evaluate(() => location.hash.slice(1)));
}

/** A small scene, quick to draw. */
export const SMALL = 'models=["builtin:cubs"]&settings.width=160&settings.height=120&settings.samples=1';
