// node check.js PAGE.html...: opens pages in headless Chromium as a phone and a desk do, light and
// dark, and says what is wrong. CHROMIUM names the browser if it is not `chromium` on the PATH.
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { launched, opened, overflow, SCHEMES, small, violations, WIDTHS } from "./reading.js";
import { replay } from "./replay.js";

const MOST_STOPS = 2000; // of the tab key on a page

/* Stops of the tab key, in their order: whether each comes after the one before, and where it is. */
const stops = async (page) => {
  const found = [];
  await page.evaluate(() => { globalThis.before = null; document.activeElement.blur(); });
  while (found.length < MOST_STOPS) {
    await page.keyboard.press("Tab");
    const stop = await page.evaluate(() => {
      const here = document.activeElement;
      if (here === document.body || here === globalThis.first) return null;
      globalThis.first ??= here;
      const after = 4; // Node.DOCUMENT_POSITION_FOLLOWING
      const follows = !globalThis.before || globalThis.before.compareDocumentPosition(here) & after;
      globalThis.before = here;
      const places = ["nav", "#replay", "table", "a[download]", ".scroll", "details"];
      return {
        follows: Boolean(follows),
        html: here.outerHTML.slice(0, 100),
        inside: places.filter((place) => here.closest(place)),
      };
    });
    if (!stop) break;
    found.push(stop);
  }
  return found;
};

const tabs = async (page) => {
  const found = await stops(page);
  const wrong = found.filter((stop) => !stop.follows).map((stop) => `out of order: ${stop.html}`);
  for (const place of ["nav", "#replay", "table", "a[download]"]) {
    const there = await page.locator(place).count();
    if (there && !found.some((stop) => stop.inside.includes(place))) wrong.push(`never in ${place}`);
  }
  return wrong;
};

/* Every column, sorted by its head: in order, undefined last, the paper's rows below their own. */
const sorting = (page) => page.evaluate(() => {
  const wrong = [];
  const rows = (body) => [...body.rows].filter((row) => !row.matches(".group, .paper"));
  const falls = (cells, sign) => cells.some((cell, i) => {
    const [a, b] = [cells[i - 1], cell].map((one) => (one ? one.dataset.value : undefined));
    if (i === 0 || b === undefined) return false;
    return a === undefined ? cells[i - 1].textContent === "–" : sign * (a - b) > 0;
  });
  const order = (table) => [...table.rows].map((row) => row.textContent).join("\n");
  const pairs = (table) => [...table.querySelectorAll(".paper")].map((row) => (
    `${row.textContent} below ${row.previousElementSibling?.textContent}`)).sort().join("\n");
  for (const table of document.querySelectorAll(".table table")) {
    const [was, beside] = [order(table), pairs(table)];
    [...table.tHead.rows[0].cells].forEach((head, column) => {
      for (let press = 0; press < 3; press += 1) {
        head.querySelector("button").click();
        const way = head.getAttribute("aria-sort");
        const sign = { ascending: 1, descending: -1, none: 0 }[way];
        for (const body of column ? table.tBodies : []) {
          if (sign && falls(rows(body).map((row) => row.cells[column]), sign)) {
            wrong.push(`${table.closest("[id]").id}: column ${column + 1} is not ${way}`);
          }
        }
        if (pairs(table) !== beside) wrong.push(`${table.closest("[id]").id}: a paper row is lost`);
      }
      if (order(table) !== was) wrong.push(`${table.closest("[id]").id}: not as it was`);
    });
  }
  return wrong;
});

const CHECKS = { overflow, "small print": small, axe: violations, "tab order": tabs, sorting, replay };

const check = async (browser, file, width, scheme) => {
  const { page, wrong } = await opened(browser, width, scheme);
  await page.goto(pathToFileURL(resolve(file)).href);
  await page.evaluate(() => document.querySelectorAll("details").forEach((one) => { one.open = true; }));
  await page.waitForTimeout(500); // until what watches sizes has had its turn
  for (const [name, found] of Object.entries(CHECKS)) {
    wrong.push(...(await found(page)).map((words) => `${name}: ${words}`));
  }
  await page.context().close();
  return wrong;
};

const files = process.argv.slice(2);
const browser = await launched();
let failed = files.length === 0;
for (const file of files) {
  for (const width of WIDTHS) {
    for (const scheme of SCHEMES) {
      const wrong = await check(browser, file, width, scheme);
      failed ||= wrong.length > 0;
      console.log(`${file}, ${width} px, ${scheme}: ${wrong.length ? "" : "nothing wrong"}`);
      wrong.forEach((words) => console.log(`  ${words}`));
    }
  }
}
await browser.close();
process.exitCode = failed ? 1 : 0;
