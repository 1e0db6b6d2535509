import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after } from "node:test";
import { SMALL, close, eventually, fragment, open, pictureOf, ready, test } from "./browser.mjs";

after(close);

const AXE = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

const overlap = (a, b) => a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;

async function openDialog(page, entry) {
  await page.getByRole("menuitem", { name: "Select", exact: true }).click();
  await page.getByRole("menuitem", { name: entry, exact: true }).click();
  const dialog = page.getByRole("dialog");
  await dialog.waitFor();
  return dialog;
}

for (const [width, height] of [[1280, 800], [1920, 1080]]) {
  test(`a dialog covers neither picture nor exercise at ${width} x ${height}`, async (page) => {
    await open(page, `${SMALL}&exercise=5.1`);
    const dialog = await openDialog(page, "Lights…");
    for (const part of [page.getByRole("application", { name: "Picture" }), page.getByRole("region", { name: "Exercise" })]) {
      assert.ok(!overlap(await dialog.boundingBox(), await part.boundingBox()));
    }
  }, { viewport: { width, height } });
}

test("a dialog is dragged by its header, and moves aside by a button", async (page) => {
  await open(page, SMALL);
  const dialog = await openDialog(page, "Camera…");
  const before = await dialog.boundingBox();
  await page.mouse.move(before.x + 60, before.y + 20);
  await page.mouse.down();
  await page.mouse.move(before.x - 140, before.y + 60, { steps: 4 });
  await page.mouse.up();
  await eventually(async () => Math.round((await dialog.boundingBox()).x), Math.round(before.x - 200));
  // What is changed in it leaves it where it is.
  await dialog.getByRole("checkbox", { name: "Parallel" }).check();
  await ready(page);
  assert.equal(Math.round((await dialog.boundingBox()).x), Math.round(before.x - 200));
  await dialog.getByRole("button", { name: "Move aside" }).click();
  await eventually(async () => (await dialog.boundingBox()).x !== before.x - 200, true);
});

test("on a phone a dialog leaves the picture in view, and the exercise follows the picture", async (page) => {
  await open(page, `${SMALL}&exercise=5.1`);
  const [picture, exercise, settings] = [
    page.getByRole("application", { name: "Picture" }),
    page.getByRole("region", { name: "Exercise" }),
    page.getByRole("complementary", { name: "Settings" }),
  ];
  const top = async (part) => (await part.boundingBox()).y;
  assert.ok((await top(picture)) < (await top(exercise)) && (await top(exercise)) < (await top(settings)));
  const follows = await exercise.evaluate((e) => {
    const settings = document.querySelector("aside");
    return Boolean(e.compareDocumentPosition(settings) & Node.DOCUMENT_POSITION_FOLLOWING);
  });
  assert.ok(follows, "reading order is visual order");

  const dialog = await openDialog(page, "Lights…");
  await eventually(async () => {
    const [over, under] = [await dialog.boundingBox(), await picture.boundingBox()];
    return under.y >= 0 && !overlap(over, under);
  }, true);
}, { viewport: { width: 390, height: 844 } });

test("an exercise that is started is in view", async (page) => {
  await open(page, `${SMALL}&page=exercises`);
  const card = page.getByRole("region", { name: "Exercises", exact: true }).getByRole("button").last();
  await card.scrollIntoViewIfNeeded();
  await card.click();
  await ready(page);
  const region = page.getByRole("region", { name: "Exercise" });
  await eventually(async () => {
    const box = await region.boundingBox();
    return box.y >= 0 && box.y + Math.min(box.height, 200) <= 844;
  }, true);
}, { viewport: { width: 390, height: 844 } });

test("steps are left by Escape, by a button, by the last step and by a page without steps", async (page) => {
  const step = async () => (await fragment(page)).get("step");
  await open(page, `${SMALL}&page=visibility&settings.visibility=warnock`);
  const finished = await pictureOf(page);
  const slider = page.getByRole("slider", { name: "Step" });
  const count = async () => Number(await slider.getAttribute("max"));
  await eventually(async () => (await count()) > 1, true);

  await page.getByRole("button", { name: "First step" }).click();
  assert.equal(await step(), "1");
  await page.getByRole("application", { name: "Picture" }).focus();
  await page.keyboard.press("Escape");
  assert.equal(await step(), null);
  await ready(page);
  assert.equal(await pictureOf(page), finished);

  await page.getByRole("button", { name: "First step" }).click();
  await page.getByRole("button", { name: "Finished picture" }).click();
  assert.equal(await step(), null);

  // At the last step it is the finished picture, and once more the button leaves the steps.
  await page.getByRole("button", { name: "Last step" }).click();
  assert.equal(await step(), String(await count()));
  await ready(page);
  assert.equal(await pictureOf(page), finished);
  await page.getByRole("button", { name: "Last step" }).click();
  assert.equal(await step(), null);

  await page.getByRole("button", { name: "First step" }).click();
  assert.match(await page.getByRole("link", { name: "Pipeline" }).getAttribute("href"), /step=1/);
  assert.doesNotMatch(await page.getByRole("link", { name: "Shading" }).getAttribute("href"), /step=/);
  await page.getByRole("link", { name: "Shading" }).click();
  assert.equal(await step(), null);
});

test("an open dialog keeps the step when Escape is pressed in the picture", async (page) => {
  await open(page, `${SMALL}&page=visibility&step=3`);
  await openDialog(page, "Camera…");
  await page.getByRole("application", { name: "Picture" }).focus();
  await page.keyboard.press("Escape");
  assert.equal((await fragment(page)).get("step"), "3");
});

test("the key c leaves the focus in a picture", async (page) => {
  await open(page, SMALL);
  const focused = () => page.evaluate(() => document.activeElement.getAttribute("aria-label"));
  await page.getByRole("application", { name: "Picture" }).focus();
  await page.keyboard.press("c");
  await eventually(focused, "Picture A");
  await page.keyboard.press("c");
  await eventually(focused, "Picture");
});

test("captions of a comparison name what differs", async (page) => {
  for (const compare of ["side", "swipe", "blink"]) {
    await open(page, `${SMALL}&compare=${compare}&b.settings.visibility=painter`);
    await page.getByText("A: z-buffer", { exact: true }).first().waitFor();
    await page.getByText("B: painter", { exact: true }).first().waitFor();
  }
});

test("the channel shown is explained below the picture", async (page) => {
  await open(page, SMALL);
  const group = page.getByRole("group", { name: "Channels shown" });
  for (const [name, words] of [
    ["Depth", /Depth: Light: near/],
    ["Id", /One colour for each surface/],
    ["Normal", /red x, green y, blue z/],
    ["Attached shadow", /faces away from/],
    ["Steps", /cost from blue to red/],
    ["Diffuse term", /Only diffuse reflection/],
  ]) {
    await group.getByRole("radio", { name, exact: true }).check();
    await page.getByRole("paragraph").filter({ hasText: words }).first().waitFor();
    await ready(page);
  }
});

test("every label of Settings and of the dialogs is explained in place", async (page) => {
  await open(page, `${SMALL}&settings.shadows=map`);
  const settings = page.getByRole("complementary", { name: "Settings" });
  for (const name of ["Model", "Visibility", "Acceleration", "Illumination", "Shading", "Interpolation", "Shadows", "Volume counting",
    "Transparency", "Transparency order", "Global illumination", "Colour space", "Samples", "Size", "Depth bits", "Shadow map size",
    "Coherence", "Culling", "View volume", "Back faces", "Channels shown", "Colour", "Depth", "Id", "Normal", "Attached shadow", "Cast shadow", "Steps",
    "Ambient term", "Diffuse term", "Specular term", "depth", "implied-edge"]) {
    assert.equal(await settings.getByRole("button", { name: `What is ${name}?`, exact: true }).count(), 1, name);
  }

  // It opens by keyboard, takes the focus, and gives it back.
  const button = settings.getByRole("button", { name: "What is Visibility?" });
  await button.focus();
  await page.keyboard.press("Enter");
  const note = page.getByRole("note", { name: "Visibility" });
  await note.waitFor();
  assert.match(await note.textContent(), /which surface is seen/);
  await page.keyboard.press("Escape");
  await eventually(() => note.count(), 0);
  await eventually(() => button.evaluate((e) => e === document.activeElement), true);

  // Another button changes what is shown.
  await button.click();
  await settings.getByRole("button", { name: "What is Shading?" }).click();
  await page.getByRole("note", { name: "Shading" }).waitFor();
  await page.keyboard.press("Escape");

  for (const [entry, names] of [
    ["Lights…", ["Light Number", "Enabled", "Kind", "Ambient", "Diffuse", "Specular", "Position", "Cutoff", "Exponent", "Attenuation", "Casts shadow"]],
    ["Materials…", ["Material", "ka", "kd", "ks", "Shininess", "Opacity", "kt min", "Index of refraction", "Mirror", "Transmission"]],
    ["Camera…", ["eyeU", "eyeT", "allU", "allT", "View angle", "Parallel"]],
  ]) {
    const dialog = await openDialog(page, entry);
    for (const name of names) {
      assert.equal(await dialog.getByRole("button", { name: `What is ${name}?`, exact: true }).count(), 1, name);
    }
    await dialog.getByRole("button", { name: "Close" }).click();
  }
});

test("explanations have no violation, and targets of 24 pixels", async (page) => {
  await open(page, SMALL);
  await page.getByRole("button", { name: "What is Shadows?" }).click();
  await page.getByRole("note", { name: "Shadows" }).waitFor();
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => axe.run(document, { runOnly: { type: "tag", values: ["wcag2a", "wcag2aa", "wcag21aa", "wcag22aa"] } }));
  assert.deepEqual(violations.map((v) => v.id), []);
  const box = await page.getByRole("button", { name: "What is Shadows?" }).boundingBox();
  assert.ok(box.width >= 24 && box.height >= 24);
}, { bypassCSP: true });

test("an area light has its shape's fields, and moves as a whole", async (page) => {
  await open(page, `${SMALL}&settings.lighting=true`);
  const dialog = await openDialog(page, "Lights…");
  await dialog.getByRole("combobox", { name: "Kind" }).selectOption("area");
  const number = (name) => dialog.getByRole("spinbutton", { name, exact: true });
  await number("Radius").fill("2");
  await dialog.getByRole("combobox", { name: "Shape" }).selectOption("polygon");
  await number("Corner 4 z").waitFor();
  const before = Number(await number("Corner 1 x").inputValue());
  const place = Number(await number("Position x").inputValue());
  await number("Position x").fill(String(place + 3));
  await eventually(async () => Math.abs(Number(await number("Corner 1 x").inputValue()) - before - 3) < 0.01, true);
  await ready(page);
  const lights = JSON.parse((await fragment(page)).get("lights"));
  assert.equal(lights[0].kind.shape.corners.length, 4);
  assert.equal(await page.getByRole("alert").textContent(), "");
});

test("no text of a combo box is cut, in any language", async (page) => {
  for (const lang of ["en", "ro", "fr", "pt"]) {
    await open(page, `${SMALL}&page=visibility&compare=swipe&settings.visibility=warnock&lang=${lang}`);
    await page.waitForTimeout(500);
    const cut = await page.getByRole("combobox").evaluateAll((all) => {
      const pen = document.createElement("canvas").getContext("2d");
      return all.flatMap((select) => {
        const style = getComputedStyle(select);
        pen.font = `${style.fontSize} ${style.fontFamily}`;
        // The arrow takes 16 pixels.
        const room = select.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight) - 16;
        return [...select.options].map((o) => o.textContent.trim()).filter((text) => pen.measureText(text).width > room);
      });
    });
    assert.deepEqual(cut, [], lang);
  }
});

test("the window in question is outlined, and explained", async (page) => {
  await open(page, `${SMALL}&page=visibility&settings.visibility=warnock&step=3`);
  await page.getByRole("paragraph").filter({ hasText: "never through a pixel" }).waitFor();
  await page.getByRole("checkbox", { name: "Ask me first" }).check();
  const outlines = () => page.getByRole("application", { name: "Picture" }).locator("svg rect").count();
  const before = await outlines();
  await page.getByRole("button", { name: "Next step" }).click();
  await page.getByRole("radiogroup", { name: "Prediction" }).waitFor();
  assert.ok((await outlines()) > before);
});

test("comparing all algorithms explains its columns and keeps the registry's order", async (page) => {
  await open(page, `${SMALL}&page=visibility`);
  await page.getByRole("button", { name: "Compare all" }).click();
  const table = page.getByRole("table", { name: "All algorithms" });
  await table.waitFor();
  const first = (await table.getByRole("row").evaluateAll((rows) => rows.slice(1).map((r) => r.cells[0].textContent.trim().split(" ")[0])));
  const order = await page.getByRole("combobox", { name: "Visibility" }).evaluate((s) => [...s.options].map((o) => o.value));
  const places = first.map((name) => order.indexOf(name));
  assert.deepEqual(places, [...places].sort((a, b) => a - b));
  await page.getByRole("listitem").filter({ hasText: "a picture after the first" }).waitFor();
});
