// What every page of ours must be for its reader: no wider than the window, no small print, nothing
// that axe knows to shut somebody out.
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { chromium } from "playwright-core";

export const WIDTHS = [1280, 390];
export const SCHEMES = ["light", "dark"];
const SMALLEST_PX = 12;
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

export const overflow = (page) => page.evaluate(() => {
  const more = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  const heads = [...document.querySelectorAll("thead th")];
  const out = heads.filter((head) => head.checkVisibility() && head.scrollWidth > head.clientWidth + 1);
  return [
    ...(more > 0 ? [`${more} px wider than the window`] : []),
    ...out.map((head) => `words out of a head: ${head.textContent}`),
  ];
});

export const small = (page) => page.evaluate((least) => {
  const own = (node) => [...node.childNodes].some((one) => one.nodeType === 3 && one.data.trim());
  const found = [...document.querySelectorAll("body *")].filter((node) => (
    node.checkVisibility() && own(node) && !node.closest("math") // whose indices are small
    && parseFloat(getComputedStyle(node).fontSize) < least));
  return [...new Set(found.map((node) => (
    `<${node.localName} class="${node.className}"> at ${getComputedStyle(node).fontSize}`)))];
}, SMALLEST_PX);

export const violations = async (page) => {
  await page.evaluate(axe);
  return page.evaluate(async () => (await globalThis.axe.run({ preload: false })).violations.map((one) => (
    `${one.id} (${one.impact}), ${one.nodes.length} times: ${one.nodes[0].html.slice(0, 160)}`)));
};

export const launched = () => chromium.launch({
  executablePath: process.env.CHROMIUM
    || execFileSync("which", ["chromium"], { encoding: "utf8" }).trim(),
  args: ["--no-sandbox"],
});

/* A page of a window of this width, and the list to which what goes wrong on it is added. */
export const opened = async (browser, width, scheme) => {
  const viewport = { width, height: width < 600 ? 844 : 800 };
  const context = await browser.newContext({ viewport, colorScheme: scheme });
  const page = await context.newPage();
  const wrong = [];
  page.on("console", (said) => said.type() === "error" && wrong.push(`console: ${said.text()}`));
  page.on("pageerror", (error) => wrong.push(`script: ${error}`));
  return { page, wrong };
};
