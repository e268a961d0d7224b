// What the replay of a page must do for whoever uses it by keys, by pointer and by its choices.
const PANEL = ".player-panel:not([hidden])";

export const replay = async (page) => {
  const wrong = [];
  if (!await page.locator("#player").count()) return wrong;
  const claim = (words, holds) => holds || wrong.push(words);
  const playing = async () => {
    await page.waitForTimeout(60);
    return page.evaluate(() => document.getElementById("player").classList.contains("playing"));
  };
  const state = () => page.evaluate(() => JSON.stringify([window.scrollY,
    ...[...document.querySelectorAll("#player input[type=checkbox], #player select, #player [aria-pressed]")]
      .map((one) => [one.checked, one.value, one.getAttribute("aria-pressed")])]));
  const twice = async (words) => {
    const before = await state();
    await page.keyboard.press("Space");
    claim(`Space does not play ${words}`, await playing());
    await page.keyboard.press("Space");
    claim(`Space does not pause ${words}`, !await playing());
    claim(`Space does something else as well ${words}`, await state() === before);
  };
  await page.evaluate(() => document.activeElement.blur());
  await page.waitForFunction(() => { // until the page rests there
    const player = document.getElementById("player"), before = player.getBoundingClientRect().top;
    player.scrollIntoView({ behavior: "instant" });
    return player.getBoundingClientRect().top === before;
  }, null, { polling: 300 });
  await twice("with the focus nowhere");
  await page.evaluate(() => document.querySelector("nav a").focus({ preventScroll: true }));
  await twice("with the focus on a link");
  for (const control of ["#player-reset", "[data-layer=idleness]", "label:has([data-layer=wakes])"]) {
    await page.locator(control).click();
    await twice(`after a click on ${control}`);
  }
  await page.locator("#player-seek").focus();
  await twice("on the slider");
  await page.locator("[data-layer=belief]").focus();
  await page.keyboard.press("Tab");
  await page.keyboard.press("Shift+Tab");
  await page.keyboard.press("Space");
  claim("Space takes a box from the keyboard", !await playing()
    && !await page.locator("[data-layer=belief]").isChecked());
  claim("the legend shows a layer that is off",
    !await page.locator("#player-legend li:visible", { hasText: "believed" }).count());
  await page.keyboard.press("Space");
  if (await page.locator("#player-beside").count() && await page.locator(PANEL).count() < 2) {
    await page.locator("#player-beside").click();
  }
  for (const choice of await page.locator(`${PANEL} select:enabled`).all()) {
    if (!await choice.isVisible()) continue;
    for (let index = await choice.locator("option").count() - 1; index >= 0; index -= 1) {
      await choice.selectOption({ index });
      await page.waitForTimeout(100);
      const said = await page.locator("#player-note").textContent();
      claim(`a choice fails: ${said}`, !said);
    }
  }
  return wrong;
};
