// The player: one clock for all panels, what they show, and everything that a person can do.
const WHEEL_REST_MS = 350; // a wheel that scrolls the page does not zoom the map it comes across
const TEXT_FIELD = "input:not([type=range], [type=checkbox], [type=radio], [type=button]), textarea, "
  + "[contenteditable]";
const USES_SPACE = "button, select, summary, input:not([type=range])";

class Player {
  constructor(root, stage) {
    Object.assign(this, { root, stage, time: 0, playing: false, endS: 0, shown: {}, asked: 0,
      seer: "", touched: null });
    this.find = (id) => document.getElementById(`player-${id}`);
    this.harbour = new Harbour(stage);
    this.camera = new Camera(stage);
    this.legend = new Legend(this.find("legend"), stage);
    this.cache = new Map();
    this.scrolled = -Infinity;
    this.panels = [...root.querySelectorAll(".player-panel")].map((box) => this.panel(box));
    root.querySelectorAll("[data-layer]").forEach((box) => {
      const read = () => { this.shown[box.dataset.layer] = box.checked; this.redraw(); };
      box.addEventListener("change", read);
      read();
    });
    this.listen();
    this.listenToKeys();
    const watch = new ResizeObserver(() => this.redraw());
    [...this.panels.map((panel) => panel.canvas), this.find("curves")]
      .forEach((canvas) => watch.observe(canvas));
    this.load();
  }

  panel(box) {
    const canvas = box.querySelector("canvas"), part = (name) => box.querySelector(`[data-${name}]`);
    const { replays } = this.stage, first = replays[0], later = box.previousElementSibling;
    const panel = {
      box, canvas, state: part("state"), found: part("found"), done: part("done"),
      scale: part("scale"), wind: part("wind"), picture: new Picture(canvas, this.harbour),
      entry: later ? besides(replays, first) : first, episode: null, pointers: new Map(),
      choices: new Map([...box.querySelectorAll("[data-level]")]
        .map((choice) => [choice.dataset.level, choice])),
    };
    panel.choices.forEach((choice, level) => choice.addEventListener("change", () => {
      const value = valuesAt(replays, panel.entry, level)[choice.selectedIndex];
      panel.entry = chooseAt(replays, panel.entry, level, value);
      this.load();
    }));
    canvas.addEventListener("wheel", (event) => this.wheel(event, panel), { passive: false });
    canvas.addEventListener("pointerdown", (event) => this.grab(event, panel));
    canvas.addEventListener("pointermove", (event) => this.drag(event, panel));
    ["pointerup", "pointercancel"].forEach((name) =>
      canvas.addEventListener(name, (event) => this.release(event, panel)));
    canvas.addEventListener("dblclick", () => this.reset());
    return panel;
  }

  // Panels on the page now: one or two.
  get open() { return this.panels.filter((panel) => !panel.box.hidden); }

  listen() {
    const follow = this.find("follow"), seek = this.find("seek"), curves = this.find("curves");
    const seen = this.find("seen"), beside = this.find("beside");
    if (seen) seen.addEventListener("change", () => {
      this.seer = seen.value;
      this.redraw();
    });
    if (beside) beside.addEventListener("click", () => this.setBeside(this.open.length < 2));
    follow.addEventListener("change", () => this.follow(follow.value));
    this.find("reset").addEventListener("click", () => this.reset());
    this.find("play").addEventListener("click", () => this.toggle());
    seek.addEventListener("input", () => this.seek(Number(seek.value)));
    const point = (event) => {
      if (event.type === "pointerdown") curves.setPointerCapture(event.pointerId);
      else if (!event.buttons) return;
      const { left, width } = curves.getBoundingClientRect();
      this.seek(((event.clientX - left - 8) / (width - 16)) * this.endS);
    };
    curves.addEventListener("pointerdown", point);
    curves.addEventListener("pointermove", point);
    window.addEventListener("scroll", () => { this.scrolled = performance.now(); },
      { passive: true });
    window.matchMedia("(prefers-color-scheme: dark)")
      .addEventListener("change", () => this.redraw());
  }

  // Space plays wherever the focus is, also on a control that a pointer was last used on; one that
  // the keyboard came to keeps its own use of Space. Out of sight the page scrolls as any page.
  listenToKeys() {
    this.root.addEventListener("keydown", (event) => this.key(event));
    document.addEventListener("pointerdown", (event) => {
      this.touched = event.target.closest(`${USES_SPACE}, label`);
    });
    document.addEventListener("keydown", (event) => {
      if (event.key === "Tab") this.touched = null;
      if (event.key !== " " || event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.target.closest(TEXT_FIELD) || !this.inSight()) return;
      const own = event.target.closest(USES_SPACE), { touched } = this;
      if (own && own !== touched && !(touched && touched.contains(own))) return;
      event.preventDefault();
      if (!event.repeat) this.toggle();
    });
    document.addEventListener("keyup", (event) => { // a button is pressed as Space comes up
      if (event.key === " " && this.touched && this.touched.contains(event.target))
        event.preventDefault();
    });
  }

  inSight() {
    const { top, bottom } = this.root.getBoundingClientRect();
    return bottom > 0 && top < window.innerHeight;
  }

  setBeside(on) {
    this.panels[1].box.hidden = !on;
    this.find("beside").setAttribute("aria-pressed", on);
    this.load();
  }

  // Fetch the chosen episodes; only the last request counts.
  async load() {
    const asked = ++this.asked, { open } = this;
    this.panels.forEach((panel) => this.offer(panel));
    if (!canDecode()) {
      this.note("The replay cannot be shown: this browser has no DecompressionStream. Chrome 80, "
        + "Firefox 113 and Safari 16.4 and later have it.");
      return;
    }
    try {
      const episodes = await Promise.all(open.map((panel) => this.fetch(panel.entry)));
      if (asked !== this.asked) return;
      open.forEach((panel, i) => { this.place(panel, episodes[i]); });
      this.endS = Math.max(...episodes.map((episode) => episode.endS));
      this.find("seek").max = this.endS;
      this.note("");
      this.setLegend();
      this.seek(this.time);
    } catch (error) {
      if (asked === this.asked) this.note(`The replay cannot be shown: ${error.message}.`);
    }
    this.find("differ").textContent = this.differing();
  }

  // Fill a panel's choices with what there is beside its replay; what is no choice is only read.
  offer({ choices, entry }) {
    const { replays } = this.stage;
    choices.forEach((choice, level) => {
      const values = valuesAt(replays, entry, level);
      choice.replaceChildren(...values.map((value) =>
        new Option(wordsOf(replays, entry, level, value))));
      choice.selectedIndex = values.indexOf(entry[level]);
      choice.disabled = values.length < 2;
    });
  }

  // Words where the maps do not show the same items.
  differing() {
    const [one, two] = this.open.map(({ entry }) => entry);
    if (!two || one.episode === two.episode) return "";
    return `Different episodes, ${one.episode} and ${two.episode}: their items, weather and starts `
      + "are not the same.";
  }

  fetch(entry) {
    if (!this.cache.has(entry)) this.cache.set(entry, decodeEpisode(entry, this.stage));
    return this.cache.get(entry);
  }

  // What a panel shows, in words.
  words({ entry }) {
    const { replays } = this.stage;
    return LEVELS.map((level) => wordsOf(replays, entry, level, entry[level])).join(", ");
  }

  place(panel, episode) {
    panel.episode = episode;
    panel.canvas.setAttribute("aria-label", `Map of ${this.words(panel)}: quays, vessels, items and `
      + "what the fleet knows, at the time of the slider");
    panel.curve = this.curve(episode);
  }

  // Both shares at every decision step: (step) of [discovered, collected].
  curve(episode) {
    return Array.from({ length: episode.steps + 1 }, (_, step) => {
      const { discovered, collected } = episode.shares(step * episode.periodS);
      return [discovered, collected];
    });
  }

  note(text) { this.find("note").textContent = text; }

  toggle() {
    if (!this.playing && this.time >= this.endS) this.time = 0;
    this.playing = !this.playing && this.endS > 0;
    this.root.classList.toggle("playing", this.playing);
    this.find("play").setAttribute("aria-label", this.playing ? "Pause" : "Play");
    this.last = null;
    this.redraw();
  }

  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.endS);
    this.redraw();
  }

  follow(vessel) {
    this.camera.follow(vessel, this.panels[0].picture.resize());
    if (!vessel) this.camera.reset();
    this.find("follow").value = vessel;
    this.redraw();
  }

  reset() { this.follow(""); }

  key(event) {
    const { target, key } = event, period = this.periodS, step = period * (event.shiftKey ? 10 : 1);
    if (event.ctrlKey || event.metaKey || event.altKey || target.matches("select")) return;
    const whole = Math.round(this.time / period) * period;
    const size = this.panels[0].picture.lens;
    const middle = size && { x: size.width / 2, y: size.height / 2 };
    const actions = {
      ArrowLeft: () => this.seek(whole - step),
      ArrowRight: () => this.seek(whole + step),
      Home: () => this.seek(0),
      End: () => this.seek(this.endS),
      "+": () => this.zoom(1.3, middle, this.panels[0]),
      "-": () => this.zoom(1 / 1.3, middle, this.panels[0]),
      0: () => this.reset(),
    };
    if (!actions[key]) return;
    event.preventDefault();
    actions[key]();
  }

  get periodS() { return this.stage.run.period_s; }

  zoom(factor, point, panel) {
    if (!panel.picture.lens || !this.camera.zoomAt(factor, point, panel.picture.lens)) return false;
    this.redraw();
    return true;
  }

  static local(event) {
    const { left, top } = event.currentTarget.getBoundingClientRect();
    return { x: event.clientX - left, y: event.clientY - top };
  }

  wheel(event, panel) {
    const resting = performance.now() - this.scrolled > WHEEL_REST_MS;
    const delta = event.deltaY * (event.deltaMode === 1 ? 16 : 1);
    const factor = Math.exp(-Math.max(-200, Math.min(200, delta)) * 0.0016);
    if ((resting || event.ctrlKey) && this.zoom(factor, Player.local(event), panel))
      event.preventDefault();
  }

  grab(event, panel) {
    panel.canvas.setPointerCapture(event.pointerId);
    panel.pointers.set(event.pointerId, Player.local(event));
    panel.canvas.classList.add("held");
  }

  // One pointer pans, two zoom and pan.
  drag(event, panel) {
    const before = panel.pointers.get(event.pointerId), now = Player.local(event);
    if (!before || !panel.picture.lens) return;
    const other = [...panel.pointers].find(([id]) => id !== event.pointerId);
    panel.pointers.set(event.pointerId, now);
    if (other) {
      const far = (point) => Math.hypot(point.x - other[1].x, point.y - other[1].y) || 1;
      const middle = { x: (now.x + other[1].x) / 2, y: (now.y + other[1].y) / 2 };
      this.zoom(far(now) / far(before), middle, panel);
    } else if (this.camera.zoom > 1) {
      this.camera.pan(now.x - before.x, now.y - before.y, panel.picture.lens);
      this.find("follow").value = "";
      this.redraw();
    }
  }

  release(event, panel) {
    panel.pointers.delete(event.pointerId);
    if (!panel.pointers.size) panel.canvas.classList.remove("held");
  }

  redraw() {
    if (!this.pending) this.pending = requestAnimationFrame((now) => this.frame(now));
  }

  frame(now) {
    this.pending = null;
    if (this.playing) {
      const passed = this.last ? Math.min(0.25, (now - this.last) / 1000) : 0;
      this.time = Math.min(this.endS, this.time + passed * Number(this.find("speed").value));
      this.last = now;
      if (this.time >= this.endS) this.toggle();
      else this.redraw();
    }
    this.open.forEach((panel) => this.drawPanel(panel));
    this.drawClock();
    this.legend.show({ ...this.shown, followed: this.camera.vessel, seer: this.seer });
  }

  drawPanel(panel) {
    const { camera } = this, { picture, episode, canvas } = panel;
    const time = episode ? Math.min(this.time, episode.endS) : 0;
    const size = picture.resize();
    if (!size.width) return;
    const named = (name) => (episode ? episode.agents.findIndex((a) => a.name === name) : -1);
    const vessel = named(camera.vessel);
    const lens = camera.lens(size, vessel >= 0 ? episode.pose(vessel, time) : null);
    picture.draw(episode, time, lens, this.shown, vessel, named(this.seer));
    canvas.classList.toggle("near", camera.zoom > 1);
    if (episode) this.describe(panel, time);
  }

  // What stands around a map: shares, wind and scale.
  describe({ episode, picture, found, done, state, wind, scale }, time) {
    const write = (place, text) => { if (place.textContent !== text) place.textContent = text; };
    const { discovered, collected } = episode.shares(time), { x, y } = episode.wind(time);
    write(found, `${discovered.toFixed(1)} %`);
    write(done, `${collected.toFixed(1)} %`);
    const over = this.time >= episode.endS && this.time > 0;
    write(state, over ? `ended at ${episode.endS.toFixed(0)} s` : "");
    const speed = Math.hypot(x, y), [arrow, words] = wind.children;
    write(words, speed > 0.005 ? `wind ${speed.toFixed(1)} m/s` : "no wind");
    arrow.style.visibility = speed > 0.005 ? "visible" : "hidden";
    arrow.style.transform = `rotate(${-Math.atan2(y, x)}rad)`;
    const bar = picture.scaleBar();
    write(scale, `${bar.metres} m`);
    scale.style.width = `${bar.px}px`;
  }

  drawClock() {
    const { periodS: period } = this, seek = this.find("seek"), { horizon } = this.stage.run;
    const step = Math.floor(this.time / period + 1e-6);
    seek.value = this.time;
    seek.setAttribute("aria-valuetext", `${this.time.toFixed(0)} seconds, step ${step}`);
    this.find("time").textContent = `${this.time.toFixed(period < 10 ? 1 : 0)} s`;
    this.find("step").textContent = `step ${step} of ${horizon}`;
    this.drawCurves();
  }

  // What was discovered and collected over time; those of the second map are dashed.
  drawCurves() {
    const canvas = this.find("curves"), context = canvas.getContext("2d");
    const colours = getComputedStyle(this.root), colour = (name) => colours.getPropertyValue(name);
    const density = window.devicePixelRatio || 1, [w, h] = [canvas.clientWidth, canvas.clientHeight];
    Object.assign(canvas, { width: Math.round(w * density), height: Math.round(h * density) });
    context.setTransform(density, 0, 0, density, 0, 0);
    const end = this.endS || 1, wide = w - 16;
    const x = (time) => 8 + (wide * time) / end, y = (share) => h - 3 - ((h - 8) * share) / 100;
    context.strokeStyle = colour("--line");
    context.lineWidth = 1;
    [0, 100].forEach((share) => {
      context.beginPath();
      context.moveTo(8, y(share));
      context.lineTo(8 + wide, y(share));
      context.stroke();
    });
    this.open.forEach(({ curve, episode }, i) => curve && ["--found", "--done"]
      .forEach((name, which) => {
        context.beginPath();
        curve.forEach((shares, step) => context.lineTo(x(step * episode.periodS), y(shares[which])));
        context.strokeStyle = colour(name);
        context.lineWidth = 1.7;
        context.setLineDash(i ? [5, 3] : []);
        context.stroke();
        context.setLineDash([]);
      }));
    context.beginPath();
    context.moveTo(x(this.time), 0);
    context.lineTo(x(this.time), h);
    context.strokeStyle = colour("--ink");
    context.lineWidth = 1.2;
    context.stroke();
  }

  // The fleets of all maps, each vessel once.
  setLegend() {
    const { open } = this, all = open.flatMap((panel) => panel.episode.agents);
    const agents = [...new Map(all.reverse().map((agent) => [agent.name, agent])).values()];
    this.legend.set(agents.reverse(), this.panels[0].picture.top, open.length,
      Boolean(this.find("seen")));
  }
}

new Player(document.getElementById("player"),
  JSON.parse(document.getElementById("player-data").textContent));
