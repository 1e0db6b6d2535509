// What an audit of the page found, by roles and names.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after } from "node:test";
import { SMALL, close, eventually, fragment, open, pictureOf, ready, test } from "./browser.mjs";

after(close);

const focused = (page) => page.evaluate(() => document.activeElement.getAttribute("aria-label") ?? document.activeElement.textContent.trim());
const alertOf = (page) => page.getByRole("alert").textContent();

/** Drops files, given as names and texts. */
const drop = (page, ...files) =>
  page.evaluate((files) => {
    const data = new DataTransfer();
    for (const [name, text] of files) data.items.add(new File([text], name));
    dispatchEvent(new DragEvent("drop", { dataTransfer: data, cancelable: true }));
  }, files);

test("arrow keys go from menu to menu, and Escape closes", async (page) => {
  await open(page, SMALL);
  const menu = (name) => page.getByRole("menu", { name });
  await page.getByRole("menuitem", { name: "File" }).focus();
  await page.keyboard.press("ArrowDown");
  assert.equal(await focused(page), "Open model…");
  await page.keyboard.press("ArrowRight");
  await menu("Exercises").waitFor();
  assert.match(await focused(page), /Cubs$/);
  await page.waitForTimeout(200);
  assert.equal(await menu("Exercises").locator(":focus").count(), 1);
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("ArrowLeft");
  assert.equal(await focused(page), "Keyboard");
  assert.equal(await page.getByRole("menu").count(), 1);
  await page.keyboard.press("Escape");
  assert.equal(await page.getByRole("menu").count(), 0);
  assert.equal(await focused(page), "Help");

  await page.getByRole("menuitem", { name: "View" }).click();
  await page.keyboard.press("Escape");
  assert.equal(await page.getByRole("menu").count(), 0);
  assert.equal(await focused(page), "View");

  // A click elsewhere closes, too.
  await page.getByRole("menuitem", { name: "View" }).click();
  await page.getByRole("heading", { name: "vitral Lab" }).click();
  await eventually(() => page.getByRole("menu").count(), 0);
});

test("Escape closes the topmost dialog wherever the focus is", async (page) => {
  await open(page, `${SMALL}&page=visibility&settings.visibility=warnock&step=3`);
  const dialog = (name) => page.getByRole("dialog", { name });
  const picture = page.getByRole("application", { name: "Picture" });
  await picture.focus();
  await page.keyboard.press("l");
  assert.equal(await dialog("Lights").locator(":focus").count(), 1);
  await page.keyboard.press("Escape");
  assert.equal(await dialog("Lights").count(), 0);
  assert.equal(await focused(page), "Picture");

  await page.keyboard.press("l");
  await picture.focus();
  await page.keyboard.press("?");
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press("Escape");
  assert.deepEqual([await dialog("Keyboard").count(), await dialog("Lights").count()], [0, 1]);

  // A menu and an explanation come before the dialog.
  await page.getByRole("menuitem", { name: "File" }).click();
  await page.keyboard.press("Escape");
  assert.deepEqual([await page.getByRole("menu").count(), await dialog("Lights").count()], [0, 1]);
  await page.getByRole("button", { name: "What is Kind?" }).click();
  await page.locator("#explanation").waitFor();
  await page.keyboard.press("Escape");
  await eventually(() => page.locator("#explanation").isVisible(), false);
  assert.equal(await dialog("Lights").count(), 1);

  // With no dialog left, Escape leaves the steps.
  await picture.focus();
  await page.keyboard.press("Escape");
  assert.equal(await dialog("Lights").count(), 0);
  assert.equal((await fragment(page)).get("step"), "3");
  await picture.focus();
  await page.keyboard.press("Escape");
  await eventually(async () => (await fragment(page)).get("step"), null);
});

test("the focus goes to Add light when the last light goes", async (page) => {
  await open(page, SMALL);
  await page.getByRole("application", { name: "Picture" }).focus();
  await page.keyboard.press("l");
  const remove = page.getByRole("dialog", { name: "Lights" }).getByRole("button", { name: "Remove light" });
  while (await remove.count()) {
    await remove.focus();
    await page.keyboard.press("Enter");
    await page.waitForTimeout(400);
  }
  assert.equal(await focused(page), "Add light");
});

test("a wrong field of a link is told by its key, and only that is dropped", async (page) => {
  for (const [wrong, key, kept = ""] of [
    ["settings.width=0", "settings.width"],
    ["settings.width=99999999", "settings.width"],
    ["settings.depth-bits=99", "settings.depth-bits"],
    ["settings.samples=0", "settings.samples"],
    ["settings.samples=17", "settings.samples"],
    ["settings.shadows=map&settings.shadow-map-size=0", "settings.shadow-map-size", "settings.shadows=map"],
    ["settings.acceleration=octree", "settings.acceleration"],
    [
      "settings.visibility=ray-cast&settings.acceleration=octree&settings.samples=0",
      "settings.samples",
      "settings.acceleration=octree&settings.visibility=ray-cast",
    ],
    ["settings.transparency=kay&settings.transparency-order=back-to-front", "settings.transparency-order", "settings.transparency=kay"],
    ["settings.channels.cast-shadow=true", "settings.channels.cast-shadow"],
    ["b.settings.samples=17&compare=side", "b.settings.samples", "compare=side"],
    ["pixel=500,3", "pixel"],
    ['second={"foo":1}', "second.foo"],
    ['second={"zoom-factor":0}', "second"],
    ['models=["builtin:nothing"]&settings.shading=flat&settings.visibility=warnock', "models", "settings.shading=flat&settings.visibility=warnock"],
    ['settings.visibility=nonsense&models=["builtin:nothing"]', "settings.visibility,models"],
  ]) {
    // A key that comes twice has its last value.
    await open(page, `${SMALL}&${wrong}&lang=en`);
    const told = await alertOf(page);
    assert.match(told, /^In the link: /);
    assert.deepEqual([...told.matchAll(/(?:^In the link: |; )`([a-z]+[.\w-]*)`: /g)].map((m) => m[1]).sort(), key.split(",").sort(), told);
    const form = await fragment(page);
    const usual = ["models", "settings.width", "settings.height", "settings.samples", "lang"];
    const others = [...form].filter(([key]) => !usual.includes(key)).sort().map((pair) => pair.join("="));
    assert.equal(others.join("&"), kept, told);
  }
  await open(page, `${SMALL}&settings.visibility=${"x".repeat(900)}`);
  const told = await alertOf(page);
  assert.ok(told.length < 360 && told.endsWith("…"), told);
});

test("play begins at the link's step", async (page) => {
  await open(page, `${SMALL}&page=visibility&settings.visibility=warnock&step=30&play=1&speed=5`);
  const slider = page.getByRole("slider", { name: "Step" });
  const seen = [];
  await eventually(async () => {
    seen.push(Number(await slider.inputValue()));
    return seen.at(-1) >= 32;
  }, true);
  assert.ok(seen.every((step) => step === 1 || step >= 30), seen.join());
  assert.ok(!(seen.includes(2) || seen.includes(3)));
});

test("what the present algorithms cannot do is disabled, with the reason", async (page) => {
  await open(page, `${SMALL}&settings.transparency=kay`);
  const channels = page.getByRole("group", { name: "Channels shown" });
  const cast = channels.getByRole("radio", { name: "Cast shadow" });
  const reason = (field) => field.evaluate((e) => document.getElementById(e.getAttribute("aria-describedby"))?.textContent);
  assert.equal(await cast.isDisabled(), true);
  assert.match(await reason(cast), /shadow algorithm/);
  assert.equal(await channels.getByRole("radio", { name: "Attached shadow" }).isDisabled(), false);
  await page.getByRole("combobox", { name: "Shadows", exact: true }).selectOption("ray");
  await cast.check();
  await ready(page);
  assert.equal(await alertOf(page), "");
  await page.getByRole("combobox", { name: "Shadows", exact: true }).selectOption("none");
  await ready(page);
  assert.equal(await alertOf(page), "");
  assert.equal((await fragment(page)).get("settings.channels.cast-shadow"), null);

  const sorted = page.getByRole("combobox", { name: "Transparency order" }).locator('option[value="back-to-front"]');
  for (const [algorithm, isDisabled] of [["z-buffer", true], ["painter", false], ["bsp", false], ["warnock", true]]) {
    await page.getByRole("combobox", { name: "Visibility", exact: true }).selectOption(algorithm);
    await eventually(() => sorted.isDisabled(), isDisabled, algorithm);
    if (isDisabled) assert.match(await sorted.getAttribute("title"), /painter, bsp/);
  }
});

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

test("targets are large enough, or apart", async (page) => {
  for (const fragment of [
    "page=shading&pixel=80,60",
    "page=illumination&pixel=80,60&lang=ro",
    "page=scene&pixel=80,60&lang=ro",
    "page=visibility&pixel=80,60&lang=fr&settings.visibility=scan-line",
  ]) {
    await open(page, `${SMALL}&${fragment}`);
    await page.waitForTimeout(600);
    await page.evaluate(AXE);
    const { violations } = await page.evaluate(() => axe.run(document, { runOnly: { type: "rule", values: ["target-size"] } }));
    assert.deepEqual(violations.flatMap((v) => v.nodes.map((n) => `${n.html.slice(0, 120)}: ${n.failureSummary}`)), [], fragment);
  }
}, { bypassCSP: true });

test("lights outside of the picture have handles on its edge", async (page) => {
  const lights = [[0, 30, 0], [-30, 0, 0], [2, 0, 40]].map((position, i) => ({ name: `LIGHT${i}`, kind: { type: "point", position }, diffuse: [0.3, 0.3, 0.3] }));
  await open(page, `models=["builtin:cubs"]&settings.width=320&settings.height=240&settings.samples=1&viewpoint.view="front"&lights=${encodeURIComponent(JSON.stringify(lights))}`);
  const picture = await page.getByRole("application", { name: "Picture" }).boundingBox();
  const handle = (number) => page.getByRole("button", { name: `LIGHT${number} handle` });
  const centre = async (number) => {
    const { x, y, width, height } = await handle(number).boundingBox();
    return [x + width / 2 - picture.x, y + height / 2 - picture.y];
  };
  for (const number of [0, 1, 2]) {
    const [x, y] = await centre(number);
    assert.ok(x > 12 && y > 12 && x < picture.width - 12 && y < picture.height - 12, `LIGHT${number}: ${x}, ${y}`);
    assert.match(await handle(number).getAttribute("title"), /outside of the picture/);
  }
  assert.ok((await centre(0))[1] < 40 && (await centre(1))[0] < 40);

  // A drag brings each into the picture.
  for (const number of [0, 2]) {
    const [x, y] = await centre(number);
    await page.mouse.move(picture.x + x, picture.y + y);
    await page.mouse.down();
    await page.mouse.move(picture.x + 200, picture.y + 150, { steps: 4 });
    await page.mouse.up();
    await eventually(async () => (await handle(number).getAttribute("title")).includes("outside"), false);
    const isThere = async () => {
      const at = await centre(number);
      return Math.hypot(at[0] - 200, at[1] - 150) < 6;
    };
    await eventually(isThere, true);
  }
});

const SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
const modelsOf = async (page) => (await fragment(page)).get("models");

test("a file with fields of a state is read as a state", async (page) => {
  await open(page, SMALL);
  await drop(page, ["a.json", '{"settings": {"visibility": "nonsense"}}']);
  await page.getByRole("alert").getByText("a.json: ").waitFor();
  assert.match(await alertOf(page), /settings\.visibility: there is no visibility algorithm/);
  await drop(page, ["b.json", '{"models": ["builtin:sphere"], "settings": {"width": 80, "height": 60}}']);
  await page.waitForFunction(() => document.querySelector("canvas").width === 80);

  // A model by its plain name is the file that is here, or it is asked for.
  await drop(page, ["c.json", '{"models": ["folder/m.obj"], "settings": {"width": 90, "height": 60}}']);
  await page.getByText("This link needs your file m.obj").waitFor();
  await drop(page, ["m.obj", SQUARE]);
  await ready(page);
  assert.match(await modelsOf(page), /^\["file:m\.obj#[0-9a-f]{12}"\]$/);
  assert.match(await pictureOf(page), /^90x60/);
  await drop(page, ["b.json", '{"vitral": 1, "models": ["builtin:sphere"]}']);
  await eventually(() => modelsOf(page), '["builtin:sphere"]');
  await drop(page, ["d.json", '{"models": ["m.obj"]}']);
  await eventually(async () => /^\["file:m\.obj#[0-9a-f]{12}"\]$/.test(await modelsOf(page)), true);
  await drop(page, ["e.json", '{"models": ["n.obj"]}'], ["n.obj", `${SQUARE}f 1 3 2\n`]);
  await eventually(async () => /^\["file:n\.obj#[0-9a-f]{12}"\]$/.test(await modelsOf(page)), true);
  await ready(page);
  assert.equal(await alertOf(page), "");
});

test("each file that cannot be read brings its own message", async (page) => {
  await open(page, SMALL);
  const before = await pictureOf(page);
  for (const [name, text, words] of [
    ["broken.obj", "v 0 0 0\nf 1 2 9\n", /broken\.obj/],
    ["other.obj", "v 0 zero 0\n", /other\.obj/],
    ["empty.obj", "", /empty\.obj: empty file/],
    ["words.txt", "words", /words\.txt/],
  ]) {
    await drop(page, [name, text]);
    await eventually(async () => words.test(await alertOf(page)), true, name);
    await page.waitForTimeout(400);
    assert.match(await alertOf(page), words);
  }
  assert.equal(await pictureOf(page), before);
  assert.equal(await page.getByRole("combobox", { name: "Model", exact: true }).locator("option", { hasText: "broken" }).count(), 0);
  await drop(page, ["m.obj", SQUARE]);
  await eventually(async () => (await modelsOf(page)).includes("m.obj"), true);
  await ready(page);
  assert.equal(await alertOf(page), "");
  // A broken file does not replace the good one of its name.
  await drop(page, ["m.obj", "f 1 2 9\n"]);
  await page.getByRole("alert").getByText("m.obj").waitFor();
  await page.getByRole("link", { name: "Shading" }).click();
  await page.getByRole("button", { name: "Turn left" }).click();
  await ready(page);
  assert.equal(await page.getByText("This link needs your file").count(), 0);
});

test("the first canvas has the state's size", async (page) => {
  const wrong = [];
  await page.exposeFunction("saw", (size) => wrong.push(size));
  await page.addInitScript(() => {
    new MutationObserver(() => {
      const canvas = document.querySelector('[role="application"] canvas');
      if (canvas && `${canvas.width}x${canvas.height}` !== "160x120") saw(`${canvas.width}x${canvas.height}`);
    }).observe(document, { subtree: true, childList: true, attributes: true });
  });
  await open(page, SMALL);
  assert.deepEqual(wrong.filter((size) => size === "300x150"), []);
});
