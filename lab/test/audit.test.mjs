// What an audit of the page found, by roles and names.

import assert from "node:assert/strict";
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
