import assert from "node:assert/strict";
import { after } from "node:test";
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { SMALL, close, eventually, fragment, open, pictureOf, ready, test, url } from "./browser.mjs";

after(close);

const PAGES = {
  scene: "Scene",
  pipeline: "Pipeline",
  visibility: "Visible surfaces",
  illumination: "Illumination",
  shading: "Shading",
  exercises: "Exercises",
};

test("every page has its landmarks, controls and names", async (page) => {
  for (const [id, name] of Object.entries(PAGES)) {
    await open(page, `${SMALL}&page=${id}`);
    const role = (role, name) => page.getByRole(role, { name, exact: true });
    for (const [r, n] of [
      ["heading", "vitral Lab"],
      ["menubar", "Main menu"],
      ["navigation", "Topics"],
      ["complementary", "Settings"],
      ["application", "Picture"],
      ["toolbar", "Camera"],
      ["group", "Coherence"],
      ["group", "Culling"],
      ["group", "Channels shown"],
      ["spinbutton", "Pixel x"],
    ]) {
      assert.equal(await role(r, n).count(), 1, `${r} ${n} on ${id}`);
    }
    for (const n of ["Model", "Visibility", "Acceleration", "Illumination", "Shading", "Interpolation", "Shadows", "Volume counting",
      "Transparency", "Transparency order", "Global illumination", "Colour space", "Samples", "Size", "Compare", "Drag"]) {
      assert.equal(await role("combobox", n).count(), 1, `combobox ${n} on ${id}`);
    }
    assert.equal(await page.locator("h1").count(), 1);
    assert.equal(await page.getByRole("link", { name }).getAttribute("aria-current"), "page");
    const canvas = page.getByRole("application", { name: "Picture" }).locator("canvas");
    assert.deepEqual(await canvas.evaluate((c) => [c.width, c.height]), [160, 120]);
    assert.match(await canvas.getAttribute("aria-label"), /Cubs/);
  }
});

test("an empty fragment becomes the teapot of 640 x 480", async (page) => {
  await open(page);
  const form = await fragment(page);
  assert.deepEqual([...form], [["models", '["builtin:teapot"]'], ["settings.width", "640"], ["settings.height", "480"]]);
});

test("links come back, copied or packed", async (page) => {
  const text = `${SMALL}&settings.visibility=warnock&viewpoint.azimuth-angle=30&page=visibility&step=12&pixel=80,60&lang=fr&speed=10`;
  await open(page, text);
  const form = await fragment(page);
  const sorted = (form) => [...form].sort(([a], [b]) => (a < b ? -1 : 1));
  assert.deepEqual(sorted(form), sorted(new URLSearchParams(text)));

  const lights = Array.from({ length: 40 }, (_, i) => ({
    name: `LIGHT${i}`,
    kind: { type: "point", position: [i, 5, 5] },
    diffuse: [0.02, 0.02, 0.02],
  }));
  await open(page, `${SMALL}&lights=${encodeURIComponent(JSON.stringify(lights))}`);
  const packed = await fragment(page);
  assert.deepEqual([...packed.keys()], ["z"]);
  const before = await pictureOf(page);
  await open(page, packed.toString());
  assert.equal(await pictureOf(page), before);
});

test("what a link cannot mean is told, and the rest is used", async (page) => {
  for (const [wrong, key] of [
    ["settings.visiblity=warnock", "settings.visiblity"],
    ["settings.visibility=nonsense", "settings.visibility"],
    ["page=<img src=x onerror=alert(1)>", "page"],
    ["step=-3", "step"],
    ["viewpoint.zoom-factor=0", "viewpoint.zoom-factor"],
    ["z=!!", "z"],
    ["__proto__.x=1", "__proto__.x"],
  ]) {
    await open(page, `${wrong.startsWith("z=") ? "" : `${SMALL}&`}${wrong}&lang=en`);
    const told = await page.getByRole("alert").textContent();
    assert.ok(told.includes(key), `${wrong}: ${told}`);
    if (!wrong.startsWith("z=")) assert.match(await pictureOf(page), /^160x120/);
  }
});

test("pages and models make entries of the history", async (page) => {
  await open(page, SMALL);
  await page.getByRole("link", { name: "Shading" }).click();
  await page.waitForFunction(() => location.hash.includes("page=shading"));
  await page.goBack();
  await page.waitForFunction(() => document.querySelector('[aria-current="page"]')?.textContent === "Scene");
});

test("the menu bar is worked with arrow keys", async (page) => {
  await open(page, SMALL);
  await page.getByRole("menuitem", { name: "File" }).focus();
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowDown");
  const focused = () => page.evaluate(() => document.activeElement.textContent.trim());
  await eventually(focused, "OpenGL");
  await page.keyboard.press("l");
  await page.keyboard.press("Enter");
  const dialog = page.getByRole("dialog", { name: "Lights" });
  // The dialog takes the focus, and gives it back.
  await eventually(() => dialog.locator(":focus").count(), 1);
  await page.keyboard.press("Escape");
  await eventually(() => dialog.count(), 0);
  await eventually(focused, "Select");
});

test("Select, OpenGL sets what Lab3D's OpenGL did", async (page) => {
  await open(page, SMALL);
  await page.getByRole("menuitem", { name: "Select" }).click();
  await page.getByRole("menuitemradio", { name: "OpenGL" }).click();
  const set = async () => {
    const form = await fragment(page);
    return ["shading", "illumination", "color-space"].map((k) => form.get(`settings.${k}`)).join();
  };
  await eventually(set, "gouraud,blinn-phong,raw");
});

test("exercise 5.1 is passed by the dialog alone", async (page) => {
  await open(page, SMALL);
  await page.getByRole("menuitem", { name: "Exercises" }).click();
  await page.getByRole("menuitem", { name: "Exercise 5.1" }).click();
  await ready(page);
  const region = page.getByRole("region", { name: "Exercise", exact: true });
  await region.getByRole("button", { name: "Check" }).click();
  await region.getByText("Not yet").waitFor();

  await page.getByRole("menuitem", { name: "Select" }).click();
  await page.getByRole("menuitem", { name: "Lights…" }).click();
  const dialog = page.getByRole("dialog", { name: "Lights" });
  await dialog.getByRole("button", { name: "Add light" }).click();
  await page.waitForFunction(() => document.querySelector("dialog select")?.value === "LIGHT2");
  for (const [name, value] of [
    ["Position x", 1], ["Position y", 0], ["Position z", 0], ["Position w", 0],
    ["Ambient red", 0], ["Ambient green", 1], ["Ambient blue", 0],
    ["Diffuse red", 0], ["Diffuse green", 1], ["Diffuse blue", 0],
    ["Specular red", 0], ["Specular green", 1], ["Specular blue", 0],
  ]) {
    await dialog.getByRole("spinbutton", { name }).fill(String(value));
    await page.waitForTimeout(250);
  }
  await dialog.getByRole("button", { name: "Close" }).click();
  await region.getByRole("button", { name: "Check" }).click();
  await region.getByText("Passed").waitFor();
  assert.equal(await page.getByRole("status", { name: "Messages" }).textContent(), "Passed");
});

test("steps go forwards, backwards and anywhere, and show the same", async (page) => {
  for (const algorithm of ["warnock", "painter", "scan-line"]) {
    await open(page, `${SMALL}&page=visibility&settings.visibility=${algorithm}`);
    const finished = await pictureOf(page);
    const slider = page.getByRole("slider", { name: "Step" });
    await page.waitForFunction(() => Number(document.querySelector('input[type="range"]').max) > 1);
    const last = Number(await slider.getAttribute("max"));
    const arrive = async (step) => {
      await eventually(() => slider.getAttribute("aria-valuetext").then((text) => text.startsWith(`${step} of `) && text.includes(":")), true);
      await ready(page);
    };
    const go = async (name, step) => {
      await page.getByRole("button", { name, exact: true }).click();
      await arrive(step);
    };
    await go("First step", 1);
    await go("Next step", 2);
    assert.equal(await slider.inputValue(), "2");
    await go("Next step", 3);
    const third = await pictureOf(page);
    const words = await page.getByRole("region", { name: "Structure" }).locator("p.told").textContent();
    await go("Last step", last);
    assert.equal(await slider.inputValue(), String(last));
    await eventually(() => pictureOf(page), finished, `${algorithm}: the last step is the picture`);
    await slider.fill("3");
    await arrive(3);
    await eventually(() => pictureOf(page), third);
    assert.equal(await page.getByRole("region", { name: "Structure" }).locator("p.told").textContent(), words);
    assert.ok((await slider.getAttribute("aria-valuetext")).includes(words));

    // Other steps begin with the finished picture again.
    const groups = page.getByRole("combobox", { name: "Show steps" });
    await groups.selectOption({ index: 1 });
    await ready(page);
    await eventually(() => pictureOf(page), finished);
  }
});

test("single keys act in the picture, and can be switched off", async (page) => {
  await open(page, `${SMALL}&page=visibility&settings.visibility=warnock`);
  await page.waitForFunction(() => Number(document.querySelector('input[type="range"]').max) > 1);
  await page.getByRole("application", { name: "Picture" }).focus();
  await page.keyboard.press("Home");
  await page.keyboard.press(".");
  const step = () => page.getByRole("slider", { name: "Step" }).inputValue();
  await eventually(step, "2");
  await page.keyboard.press("?");
  const dialog = page.getByRole("dialog", { name: "Keyboard" });
  await dialog.getByRole("checkbox").uncheck();
  await dialog.getByRole("button", { name: "Close" }).click();
  await page.getByRole("application", { name: "Picture" }).focus();
  await page.keyboard.press(".");
  await page.waitForTimeout(500);
  assert.equal(await step(), "2");
});

test("a pixel is inspected by mouse, keys and numbers", async (page) => {
  await open(page, SMALL);
  const picture = page.getByRole("application", { name: "Picture" });
  await picture.dblclick();
  await page.getByRole("table", { name: "Surfaces at the pixel" }).waitFor();
  await page.getByRole("table", { name: "Light at the pixel" }).waitFor();
  await page.getByRole("table", { name: "Values" }).waitFor();
  const form = await fragment(page);
  const [x] = form.get("pixel").split(",").map(Number);
  await picture.focus();
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Enter");
  const column = async () => (await fragment(page)).get("pixel").split(",")[0];
  await eventually(column, String(x + 1));
  await page.getByRole("spinbutton", { name: "Pixel x" }).fill("7");
  await eventually(column, "7");
});

test("two pictures are compared", async (page) => {
  await open(page, `${SMALL}&compare=side&b.settings.shading=flat`);
  await page.getByRole("application", { name: "Picture B" }).waitFor();
  const table = page.getByRole("table", { name: "Agreement" });
  await table.waitFor();
  await page.getByRole("group", { name: "Settings of B" }).getByRole("combobox", { name: "Visibility" }).selectOption("painter");
  await eventually(async () => (await fragment(page)).get("b.settings.visibility"), "painter");
  for (const way of ["Swipe", "Blink", "Difference"]) {
    await page.getByRole("combobox", { name: "Compare" }).selectOption({ label: way });
    await ready(page);
    await page.getByRole("application", { name: "Picture A" }).waitFor();
  }
  await page.getByRole("img", { name: "Difference" }).waitFor();
});

test("a comparison steps through both pictures", async (page) => {
  await open(page, `${SMALL}&page=visibility&settings.visibility=warnock&b.settings.visibility=painter&compare=side`);
  const [a, b] = [await pictureOf(page, "Picture A"), await pictureOf(page, "Picture B")];
  await page.waitForFunction(() => Number(document.querySelector('input[type="range"]').max) > 1);
  await page.getByRole("button", { name: "First step" }).click();
  await ready(page);
  await eventually(async () => (await pictureOf(page, "Picture B")) !== b, true);
  assert.notEqual(await pictureOf(page, "Picture A"), a);
  await page.getByRole("button", { name: "Last step" }).click();
  await eventually(() => pictureOf(page, "Picture A"), a);
  await eventually(() => pictureOf(page, "Picture B"), b);
});

test("terms of the lights are shown one by one", async (page) => {
  await open(page, `${SMALL}&page=illumination`);
  const whole = await pictureOf(page);
  const seen = new Set([whole]);
  for (const name of ["Ambient term", "Diffuse term", "Specular term"]) {
    await page.getByRole("group", { name: "Channels shown" }).getByRole("radio", { name }).check();
    await eventually(async () => (await pictureOf(page)) !== whole, true);
    await ready(page);
    seen.add(await pictureOf(page));
  }
  assert.equal(seen.size, 4);
  await page.getByRole("group", { name: "Channels shown" }).getByRole("radio", { name: "Colour", exact: true }).check();
  await eventually(() => pictureOf(page), whole);
});

test("a pixel of the z-buffer has depths, projector and misprints", async (page) => {
  await open(page, `${SMALL}&page=pipeline&pixel=85,50`);
  const projector = page.getByRole("table", { name: "Two points of the projector" });
  await projector.waitFor();
  assert.equal(await projector.locator("tbody tr").count(), 2);
  const depths = page.getByRole("table", { name: "Depths" });
  await depths.waitFor();
  assert.equal(await depths.locator("tbody tr").count(), 9);
  await page.getByRole("link", { name: "Illumination" }).click();
  await page.getByText("Where the notes err").click();
  await page.getByRole("table", { name: "Where the notes err" }).waitFor();
  await open(page, `${SMALL}&page=pipeline&second=on`);
  await page.locator('[aria-label="Second view"] svg g.kept').first().waitFor();
});

test("exercises speak the language of the page", async (page) => {
  const texts = async (lang) => {
    await open(page, `${SMALL}&page=exercises&lang=${lang}`);
    return page.locator(".exercises strong, .exercises span").allTextContents();
  };
  const english = await texts("en");
  assert.ok(english.length >= 38);
  for (const lang of ["ro", "fr", "pt"]) {
    const same = (await texts(lang)).filter((text) => english.includes(text));
    assert.deepEqual(same, [], lang);
  }
});

test("exercise P8 wants a pixel with two cubes", async (page) => {
  await open(page, "exercise=P8&page=pipeline");
  const region = page.getByRole("region", { name: "Exercise", exact: true });
  const check = async (text) => {
    await region.getByRole("button", { name: "Check" }).click();
    await region.getByText(text).waitFor();
  };
  await check("no pixel is inspected");
  await page.getByRole("spinbutton", { name: "Pixel x" }).fill("5");
  await page.getByRole("spinbutton", { name: "Pixel y" }).fill("5");
  await check("fewer than two faces");
  await page.getByRole("spinbutton", { name: "Pixel x" }).fill("340");
  await page.getByRole("spinbutton", { name: "Pixel y" }).fill("200");
  await check("Passed");
});

test("figure and slide have no menus, and lead to the Lab", async (page) => {
  for (const layout of ["figure", "slide"]) {
    await open(page, `${SMALL}&settings.visibility=warnock&layout=${layout}`);
    for (const role of ["menubar", "navigation", "complementary"]) assert.equal(await page.getByRole(role).count(), 0);
    await page.getByRole("toolbar", { name: "Steps" }).waitFor();
    await page.getByRole("link", { name: "Open in the Lab" }).click();
    await page.getByRole("menubar").waitFor();
    await eventually(async () => (await fragment(page)).get("layout"), null);
  }
});

test("a page in a frame tells its parent and is moved by it", async (page) => {
  const frame = `<!doctype html><title>parent</title>
    <script>window.told = []; addEventListener("message", (e) => told.push(e.data));</script>
    <iframe width="800" height="600" title="frame" src="${url}#${SMALL.replaceAll('"', "&quot;")}&layout=slide"></iframe>`;
  const server = createServer((_, answer) => answer.setHeader("Content-Type", "text/html").end(frame));
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  try {
    await page.goto(`http://localhost:${server.address().port}/`);
    await page.waitForFunction(() => window.told.some((m) => m.type === "vitral-lab" && m.event === "ready"));
    const hash = `#${SMALL}&settings.visibility=warnock&layout=slide&step=2`;
    await page.evaluate((hash) => document.querySelector("iframe").contentWindow.postMessage({ type: "vitral-lab", hash }, "*"), hash);
    await page.waitForFunction(() => window.told.some((m) => m.event === "step" && m.step === 2));
  } finally {
    server.close();
  }
});

test("a state file that is dropped is opened; other files are told", async (page) => {
  await open(page, SMALL);
  const drop = (name, text) =>
    page.evaluate(
      ([name, text]) => {
        const data = new DataTransfer();
        data.items.add(new File([text], name));
        dispatchEvent(new DragEvent("drop", { dataTransfer: data, cancelable: true }));
      },
      [name, text],
    );
  await drop("a.json", JSON.stringify({ vitral: 1, models: ["builtin:sphere"], settings: { width: 80, height: 60 } }));
  await page.waitForFunction(() => document.querySelector("canvas").width === 80);
  await ready(page);
  await drop("square.obj", "mtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  await page.getByRole("alert").getByText("square.mtl").waitFor();
  const isNamed = async () => /^\["file:square\.obj#[0-9a-f]{12}"\]$/.test((await fragment(page)).get("models"));
  await eventually(isNamed, true);
});

test("picture, drawing and state are saved under the model's name", async (page) => {
  await open(page, SMALL);
  for (const [entry, name] of [["Save picture…", "cubs.png"], ["Save drawing…", "cubs.svg"], ["Save state…", "cubs.json"]]) {
    await page.getByRole("menuitem", { name: "File" }).click();
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("menuitem", { name: entry }).click()]);
    assert.equal(download.suggestedFilename(), name);
    if (name.endsWith(".json")) assert.equal(JSON.parse(readFileSync(await download.path(), "utf8")).vitral, 1);
  }
});

test("320 pixels are wide enough", async (page) => {
  for (const id of Object.keys(PAGES)) {
    await open(page, `${SMALL}&page=${id}`);
    const over = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert.ok(over <= 0, `${id}: ${over} pixels too wide`);
  }
}, { viewport: { width: 320, height: 640 } });

test("nothing plays by itself where motion is not wanted", async (page) => {
  await open(page, `${SMALL}&page=visibility&settings.visibility=warnock&play=1&step=1`);
  await page.waitForTimeout(2000);
  assert.equal((await fragment(page)).get("step"), "1");
}, { reducedMotion: "reduce" });
