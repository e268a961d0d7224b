// node site.js FOLDER: opens every page of a made site as a file, in headless Chromium, as a phone
// and a desk do, light and dark; says what is loaded from elsewhere, what is wider than the window,
// what is small print, what axe finds, and whether the search finds.
import { readdirSync } from "node:fs";
import { join, relative, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { launched, opened, overflow, SCHEMES, small, violations, WIDTHS } from "./reading.js";

const THEMES_OWN = ["label-content-name-mismatch", "summary-name"]; // of its search button and menus
const SOUGHT = { words: "idleness", page: "concepts/metrics.html" };

const site = resolve(process.argv[2]);
const pages = readdirSync(site, { recursive: true })
  .filter((name) => name.endsWith(".html") && !name.startsWith("_"))
  .map((name) => join(site, name)).sort();

/* Whether the window of the search, opened by hand, leads to a page that has the word. */
const search = async (page) => {
  await page.goto(pathToFileURL(join(site, "index.html")).href);
  await page.locator("button.search-button__button:visible").first().click();
  await page.keyboard.type(SOUGHT.words);
  await page.keyboard.press("Enter");
  const hits = page.locator("#search-results a");
  await hits.first().waitFor({ timeout: 10000 }).catch(() => {});
  await page.waitForTimeout(2000); // hits come one by one
  const found = await hits.evaluateAll((all) => all.map((one) => one.href));
  return found.some((href) => href.includes(SOUGHT.page))
    ? [] : [`search: "${SOUGHT.words}" does not find ${SOUGHT.page}, but ${found.length} others`];
};

const browser = await launched();
let failed = pages.length === 0;
for (const width of WIDTHS) {
  for (const scheme of SCHEMES) {
    const { page, wrong } = await opened(browser, width, scheme);
    page.setDefaultNavigationTimeout(0); // a busy machine is no fault of a page
    page.on("request", (one) => {
      if (!/^(file|data|blob):/.test(one.url())) wrong.push(`network: ${one.url()}`);
    });
    for (const file of pages) {
      wrong.length = 0;
      await page.goto(pathToFileURL(file).href);
      for (const [name, found] of Object.entries({ overflow, "small print": small })) {
        wrong.push(...(await found(page)).map((words) => `${name}: ${words}`));
      }
      wrong.push(...(await violations(page)).filter((words) => (
        !words.includes("(minor)") && !THEMES_OWN.includes(words.split(" ")[0])))
        .map((words) => `axe: ${words}`));
      failed ||= wrong.length > 0;
      wrong.forEach((words) => console.log(`${relative(site, file)}, ${width} px, ${scheme}: ${words}`));
    }
    wrong.length = 0;
    wrong.push(...(await search(page)));
    failed ||= wrong.length > 0;
    console.log(`${pages.length} pages, ${width} px, ${scheme}`, ...wrong);
    await page.context().close();
  }
}
await browser.close();
process.exitCode = failed ? 1 : 0;
