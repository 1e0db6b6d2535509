// Measures the budgets of the Lab in Chromium and prints them as a table in Markdown.
//
//     LAB=target/release/vitral npm run bench          (a vitral with the Lab inside)
//
// The page is served by that command, and exported by it as one file. CHROMIUM names another browser, QUICK=1 takes fewer samples.

import { spawn, execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, statSync } from "node:fs";
import { cpus, loadavg, tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { deflateRawSync } from "node:zlib";
import { chromium } from "playwright-core";

const program = process.env.LAB;
if (!program) throw new Error("LAB has to name a vitral with the Lab inside (cargo xtask lab builds it)");
const isQuick = process.env.QUICK === "1";

/** 100,172 triangles. */
const SPHERE = 'models=["builtin:sphere?slices=317&stacks=159"]';
const ONE_SAMPLE = "settings.width=640&settings.height=480&settings.samples=1&settings.shading=phong&settings.visibility=z-buffer";
const TEAPOT = "builtin:teapot";

const rows = [];
const row = (what, budget, measured, unit) => {
  rows.push({ what, budget, measured, unit });
  console.error(`${what}: ${measured} ${unit} (${budget} asked)`);
};
const median = (numbers) => [...numbers].sort((a, b) => a - b)[Math.floor(numbers.length / 2)];
const rounded = (number) => Number(number.toPrecision(3));

/** What every page notes of itself: when pictures were put on the canvas, and which blocks of its thread were long. */
function watch() {
  const seen = { pictures: [], blocks: [] };
  window.seen = seen;
  const put = CanvasRenderingContext2D.prototype.putImageData;
  CanvasRenderingContext2D.prototype.putImageData = function (...words) {
    put.apply(this, words);
    seen.pictures.push(performance.now());
  };
  new PerformanceObserver((list) => seen.blocks.push(...list.getEntries().map((e) => e.duration))).observe({ type: "longtask", buffered: true });
}

/** Waits until no picture is being drawn, and answers when that was, in milliseconds since the page was opened. */
const settled = (page) =>
  page.evaluate(
    () =>
      new Promise((resolve) => {
        const isBusy = () => {
          const all = [...document.querySelectorAll('[role="application"][aria-busy]')];
          return !all.length || all.some((e) => e.getAttribute("aria-busy") !== "false");
        };
        const look = () => (isBusy() ? undefined : (observer.disconnect(), resolve(performance.now())));
        const observer = new MutationObserver(look);
        observer.observe(document, { subtree: true, childList: true, attributes: true, attributeFilter: ["aria-busy"] });
        look();
      }),
  );

async function opened(context, address) {
  const page = await context.newPage();
  await page.addInitScript(watch);
  await page.goto(address);
  const time = await settled(page);
  return { page, time };
}

async function timeOfOpening(context, address) {
  const times = [];
  for (let i = 0; i < (isQuick ? 2 : 5); i++) {
    const { page, time } = await opened(context, address);
    times.push(time);
    await page.close();
  }
  return rounded(median(times));
}

/** Drags the camera for some seconds; the median time between pictures, and the longest block of the page's thread. */
async function drag(context, fragment) {
  const { page } = await opened(context, `${served}#${fragment}`);
  const box = await page.getByRole("application", { name: "Picture", exact: true }).boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 5, y);
  await page.waitForTimeout(500);
  await page.evaluate(() => {
    window.seen.pictures.length = 0;
    window.seen.blocks.length = 0;
  });

  // Move on every frame of the browser, from within, so that the driver's own time does not count.
  await page.evaluate(
    async ([x, y, seconds]) => {
      const stage = document.querySelector('[role="application"]');
      const end = performance.now() + 1000 * seconds;
      for (let i = 0; performance.now() < end; i++) {
        const place = { clientX: x + 60 * Math.sin(i / 20), clientY: y, pointerId: 1, bubbles: true, buttons: 1 };
        stage.dispatchEvent(new PointerEvent("pointermove", place));
        await new Promise((next) => setTimeout(next, 4));
      }
    },
    [x, y, isQuick ? 2 : 5],
  );
  const seen = await page.evaluate(() => window.seen);
  await page.mouse.up();
  await page.close();
  const between = seen.pictures.slice(1).map((time, i) => time - seen.pictures[i]);
  return { frame: rounded(median(between)), block: rounded(Math.max(0, ...seen.blocks)) };
}

/** Milliseconds from a change by keyboard to the picture in full quality. */
async function fullQuality(context) {
  const { page } = await opened(context, `${served}#${SPHERE}&settings.width=640&settings.height=480&settings.samples=4`);
  const stage = page.getByRole("application", { name: "Picture", exact: true });
  const times = [];
  for (let i = 0; i < (isQuick ? 3 : 9); i++) {
    await page.evaluate(() => (window.seen.pictures.length = 0));
    await stage.focus();
    const start = await page.evaluate(() => performance.now());
    await page.keyboard.press("Shift+ArrowLeft");
    await page.waitForFunction(() => window.seen.pictures.length > 0);
    times.push((await settled(page)) - start);
  }
  await page.close();
  return rounded(median(times));
}

/** Recording an algorithm's steps of the teapot from the change of the algorithm on, then one step. */
async function steps(context, algorithm) {
  const { page } = await opened(context, `${served}#models=["${TEAPOT}"]&settings.width=640&settings.height=480&page=visibility`);
  const bar = page.getByRole("toolbar", { name: "Steps" });
  const next = bar.getByRole("button", { name: "Next step" });
  const isRecorded = () => page.waitForFunction(() => document.querySelector('.steps[aria-busy="false"]'));
  await isRecorded();
  const start = Date.now();
  await page.getByRole("combobox", { name: "Visibility", exact: true }).selectOption(algorithm);
  await page.waitForTimeout(20);
  await settled(page);
  await isRecorded();
  const recording = Date.now() - start;

  // Go to the middle, then from step to step: until the canvas has another picture, or the text another number.
  const slider = bar.getByRole("slider", { name: "Step" });
  const middle = await slider.evaluate((range) => Math.ceil(Number(range.max) / 2));
  const stepped = [];
  for (let i = 0; i < (isQuick ? 4 : 12); i++) {
    const time = await slider.evaluate(
      (range, to) =>
        new Promise((resolve) => {
          const begin = performance.now();
          const done = () => range.getAttribute("aria-valuetext").startsWith(`${to} `);
          const look = () => (done() ? (observer.disconnect(), resolve(performance.now() - begin)) : undefined);
          const observer = new MutationObserver(look);
          observer.observe(range, { attributes: true });
          range.value = String(to);
          range.dispatchEvent(new Event("input", { bubbles: true }));
        }),
      Math.max(1, middle - 6 + i),
    );
    stepped.push(time);
  }
  await next.click();
  await page.close();
  return { recording, step: rounded(median(stepped)) };
}

/** From a double click to what the engine explains of the pixel; the pixels show different surfaces or none. */
async function inspecting(context) {
  const { page } = await opened(context, `${served}#models=["${TEAPOT}"]&settings.width=640&settings.height=480`);
  const times = [];
  for (const [x, y] of [[0.5, 0.5], [0.05, 0.05], [0.45, 0.4], [0.95, 0.05], [0.6, 0.6], [0.05, 0.95], [0.5, 0.45]]) {
    const time = await page.evaluate(
      ([x, y]) =>
        new Promise((resolve) => {
          const canvas = document.querySelector('[role="application"] canvas');
          const region = document.querySelector("section.pixel");
          const before = region.querySelector(".why") ? region.textContent : "";
          const begin = performance.now();
          const look = () => {
            if (!region.querySelector(".why") || region.textContent === before) return;
            observer.disconnect();
            resolve(performance.now() - begin);
          };
          const observer = new MutationObserver(look);
          observer.observe(region, { subtree: true, childList: true, characterData: true });
          const { left, top, width, height } = canvas.getBoundingClientRect();
          const place = { clientX: left + x * width, clientY: top + y * height, bubbles: true };
          canvas.dispatchEvent(new MouseEvent("dblclick", place));
        }),
      [x, y],
    );
    times.push(time);
  }
  await page.close();
  return rounded(median(times));
}

/** Bytes that the page's heap and the engine's memory gained between the 100th change and the last. */
async function growth(context, changes) {
  const { page } = await opened(context, `${served}#models=["builtin:cubs"]&settings.width=160&settings.height=120&settings.samples=1`);
  const session = await context.newCDPSession(page);
  const used = async () => {
    await session.send("HeapProfiler.collectGarbage");
    const { usedSize, embedderHeapUsedSize = 0, backingStorageSize = 0 } = await session.send("Runtime.getHeapUsage");
    return usedSize + embedderHeapUsedSize + backingStorageSize;
  };
  const stage = page.getByRole("application", { name: "Picture", exact: true });
  let first = 0;
  for (let i = 1; i <= changes; i++) {
    await stage.focus();
    await page.keyboard.press(i % 2 ? "Shift+ArrowLeft" : "Shift+ArrowRight");
    await settled(page);
    if (i === 100) first = await used();
  }
  const last = await used();
  await page.close();
  return Math.round((last - first) / 1024);
}

const folder = mkdtempSync(join(tmpdir(), "lab-bench-"));
const single = join(folder, "lab.html");
execFileSync(program, ["lab", "--export", single], { stdio: "inherit" });
execFileSync(program, ["lab", "--export", join(folder, "site")], { stdio: "inherit" });
const server = spawn(program, ["lab", "--no-open"], { stdio: ["ignore", "pipe", "inherit"] });
const served = await new Promise((resolve) => createInterface(server.stdout).once("line", resolve));
const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
try {
  const size = (name) => statSync(join(folder, "site", name)).size;
  const module = readFileSync(join(folder, "site", "vitral_lab.wasm"));
  row("WebAssembly module", "7", rounded(module.length / 1e6), "MB");
  row("the same deflated", "2.3", rounded(deflateRawSync(module, { level: 9 }).length / 1e6), "MB");
  row("script and style", "250", rounded((size("lab.js") + size("worker.js") + size("lab.css")) / 1e3), "kB");
  row("the single file", "4", rounded(statSync(single).size / 1e6), "MB");

  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, locale: "en-GB" });
  context.setDefaultTimeout(120_000);
  row("opening, teapot, served", "1500", await timeOfOpening(context, served), "ms");
  row("opening, teapot, `file://`", "2000", await timeOfOpening(context, `file://${single}`), "ms");
  const teapot = await drag(context, `models=["${TEAPOT}"]&${ONE_SAMPLE}`);
  row("a frame while dragging, teapot", "16", teapot.frame, "ms");
  const sphere = await drag(context, `${SPHERE}&${ONE_SAMPLE}`);
  row("a frame while dragging, 100,000 triangles", "33", sphere.frame, "ms");
  row("longest block of the page's thread while dragging", "50", Math.max(teapot.block, sphere.block), "ms");
  row("full quality, 100,000 triangles, 4 samples", "300", await fullQuality(context), "ms");
  for (const algorithm of ["z-buffer", "scan-line", "warnock", "painter", "bsp", "weiler-atherton", "ray-cast"]) {
    const { recording, step } = await steps(context, algorithm);
    row(`recording the steps, teapot, ${algorithm}`, "1000", recording, "ms");
    row(`a jump to a step, ${algorithm}`, "50", step, "ms");
  }
  row("inspecting a pixel, teapot", "200", await inspecting(context), "ms");
  const changes = isQuick ? 200 : 1000;
  row(`growth of memory from the 100th to the ${changes}th change`, "0", await growth(context, changes), "KiB");
} finally {
  await browser.close();
  server.kill();
  rmSync(folder, { recursive: true });
}

console.log(`${cpus().length} cores of ${cpus()[0].model}, Chromium ${browser.version()}, load ${loadavg()[0].toFixed(1)}.\n`);
console.log("| what | at most | measured | |\n|---|---|---|---|");
for (const { what, budget, measured, unit } of rows) console.log(`| ${what} | ${budget} ${unit} | ${measured} ${unit} | ${measured <= Number(budget) ? "" : "falls short"} |`);
