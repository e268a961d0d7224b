// node check.js PAGE.html...: opens pages in headless Chromium as a phone and a desk do, light and
// dark, and says what is wrong. CHROMIUM names the browser if it is not `chromium` on the PATH.
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const WIDTHS = [1280, 390];
const SCHEMES = ["light", "dark"];
const SMALLEST_PX = 12;
const MOST_STOPS = 2000; // of the tab key on a page
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

const overflow = (page) => page.evaluate(() => {
  const more = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  const heads = [...document.querySelectorAll("thead th")];
  const out = heads.filter((head) => head.checkVisibility() && head.scrollWidth > head.clientWidth + 1);
  return [
    ...(more > 0 ? [`${more} px wider than the window`] : []),
    ...out.map((head) => `words out of a head: ${head.textContent}`),
  ];
});

const small = (page) => page.evaluate((least) => {
  const own = (node) => [...node.childNodes].some((one) => one.nodeType === 3 && one.data.trim());
  const found = [...document.querySelectorAll("body *")].filter((node) => (
    node.checkVisibility() && own(node) && parseFloat(getComputedStyle(node).fontSize) < least));
  return [...new Set(found.map((node) => (
    `<${node.localName} class="${node.className}"> at ${getComputedStyle(node).fontSize}`)))];
}, SMALLEST_PX);

const violations = async (page) => {
  await page.evaluate(axe);
  return page.evaluate(async () => (await globalThis.axe.run()).violations.map((one) => (
    `${one.id} (${one.impact}), ${one.nodes.length} times: ${one.nodes[0].html.slice(0, 160)}`)));
};

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

const CHECKS = { overflow, "small print": small, axe: violations, "tab order": tabs, sorting };

const check = async (browser, file, width, scheme) => {
  const viewport = { width, height: width < 600 ? 844 : 800 };
  const context = await browser.newContext({ viewport, colorScheme: scheme });
  const page = await context.newPage();
  const wrong = [];
  page.on("console", (said) => said.type() === "error" && wrong.push(`console: ${said.text()}`));
  page.on("pageerror", (error) => wrong.push(`script: ${error}`));
  await page.goto(pathToFileURL(resolve(file)).href);
  await page.evaluate(() => document.querySelectorAll("details").forEach((one) => { one.open = true; }));
  await page.waitForTimeout(500); // until what watches sizes has had its turn
  for (const [name, found] of Object.entries(CHECKS)) {
    wrong.push(...(await found(page)).map((words) => `${name}: ${words}`));
  }
  await context.close();
  return wrong;
};

const files = process.argv.slice(2);
const executablePath = process.env.CHROMIUM
  || execFileSync("which", ["chromium"], { encoding: "utf8" }).trim();
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
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
