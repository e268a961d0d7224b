// The player: one clock for all panels, what they show, and everything that a person can do.
const COLOURS = { found: "#0b6e99", done: "#14532d" };
const WHEEL_REST_MS = 350; // a wheel that scrolls the page does not zoom the map it comes across

class Player {
  constructor(root, stage) {
    Object.assign(this, { root, stage, time: 0, playing: false, endS: 0, shown: {}, asked: 0,
      seer: -1 });
    this.find = (id) => document.getElementById(`player-${id}`);
    this.harbour = new Harbour(stage);
    this.camera = new Camera(stage);
    this.cache = new Map();
    this.scrolled = -Infinity;
    this.panels = [...root.querySelectorAll(".player-panel")].map((box) => this.panel(box));
    root.querySelectorAll("[data-layer]").forEach((box) => {
      const read = () => { this.shown[box.dataset.layer] = box.checked; this.redraw(); };
      box.addEventListener("change", read);
      read();
    });
    this.listen();
    this.legend();
    const watch = new ResizeObserver(() => this.redraw());
    [...this.panels.map((panel) => panel.canvas), this.find("curves")]
      .forEach((canvas) => watch.observe(canvas));
    this.load();
  }

  panel(box) {
    const canvas = box.querySelector("canvas"), part = (name) => box.querySelector(`[data-${name}]`);
    const panel = {
      canvas, choice: part("world"), state: part("state"), found: part("found"), done: part("done"),
      world: canvas.dataset.first, picture: new Picture(canvas, this.harbour), episode: null,
      pointers: new Map(),
    };
    if (panel.choice) panel.choice.addEventListener("change", () => {
      panel.world = panel.choice.value;
      this.load();
    });
    canvas.addEventListener("wheel", (event) => this.wheel(event, panel), { passive: false });
    canvas.addEventListener("pointerdown", (event) => this.grab(event, panel));
    canvas.addEventListener("pointermove", (event) => this.drag(event, panel));
    ["pointerup", "pointercancel"].forEach((name) =>
      canvas.addEventListener(name, (event) => this.release(event, panel)));
    canvas.addEventListener("dblclick", () => this.reset());
    return panel;
  }

  listen() {
    const follow = this.find("follow"), seek = this.find("seek"), curves = this.find("curves");
    this.find("policy").addEventListener("change", () => this.load());
    const seen = this.find("seen");
    if (seen) seen.addEventListener("change", () => {
      this.seer = Number(seen.value);
      this.redraw();
    });
    follow.addEventListener("change", () => this.follow(Number(follow.value)));
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
    this.root.addEventListener("keydown", (event) => this.key(event));
    window.addEventListener("scroll", () => { this.scrolled = performance.now(); },
      { passive: true });
  }

  // Fetch the chosen policy's episodes of the chosen worlds; only the last request counts.
  async load() {
    const asked = ++this.asked, policy = this.find("policy").value;
    if (!canDecode()) {
      this.note("The replay cannot be shown: this browser has no DecompressionStream. Chrome 80, "
        + "Firefox 113 and Safari 16.4 and later have it.");
      return;
    }
    try {
      const episodes = await Promise.all(this.panels.map((panel) => this.fetch(panel.world, policy)));
      if (asked !== this.asked) return;
      this.panels.forEach((panel, i) => { this.place(panel, episodes[i], policy); });
      this.endS = Math.max(...episodes.map((episode) => (episode ? episode.endS : 0)));
      this.find("seek").max = this.endS;
      this.note("");
      this.seek(this.time);
    } catch (error) {
      if (asked === this.asked) this.note(`The replay cannot be shown: ${error.message}.`);
    }
  }

  fetch(world, policy) {
    const entry = this.stage.replays.find((e) => e.world === world && e.policy === policy);
    if (!entry) return Promise.resolve(null);
    if (!this.cache.has(entry)) this.cache.set(entry, decodeEpisode(entry, this.stage));
    return this.cache.get(entry);
  }

  place(panel, episode, policy) {
    panel.episode = episode;
    panel.canvas.setAttribute("aria-label", `Map of the ${panel.world} world, policy ${policy}: `
      + "quays, vessels, items and what the fleet knows, at the time of the slider");
    panel.curve = episode && this.curve(episode);
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
    const { picture } = this.panels[0];
    this.camera.follow(vessel, picture.resize());
    if (vessel < 0) this.camera.reset();
    this.find("follow").value = vessel;
    this.redraw();
  }

  reset() { this.follow(-1); }

  key(event) {
    const { target, key } = event, step = this.stage.period_s * (event.shiftKey ? 10 : 1);
    if (event.ctrlKey || event.metaKey || event.altKey || target.matches("select")) return;
    if (key === " " && target.matches("button, [type=checkbox]")) return;
    const whole = Math.round(this.time / this.stage.period_s) * this.stage.period_s;
    const size = this.panels[0].picture.lens;
    const middle = size && { x: size.width / 2, y: size.height / 2 };
    const actions = {
      " ": () => this.toggle(),
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
      this.find("follow").value = -1;
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
    this.panels.forEach((panel) => this.drawPanel(panel));
    this.drawClock();
  }

  drawPanel(panel) {
    const { camera } = this, { picture, episode, canvas } = panel;
    const time = episode ? Math.min(this.time, episode.endS) : 0;
    const followed = episode && camera.vessel >= 0 ? episode.pose(camera.vessel, time) : null;
    const size = picture.resize();
    if (!size.width) return;
    picture.draw(episode, time, camera.lens(size, followed), this.shown, camera.vessel,
      this.seer);
    canvas.classList.toggle("near", camera.zoom > 1);
    const shares = episode && episode.shares(time);
    const write = (place, text) => { if (place.textContent !== text) place.textContent = text; };
    write(panel.found, shares ? `${shares.discovered.toFixed(1)} %` : "–");
    write(panel.done, shares ? `${shares.collected.toFixed(1)} %` : "–");
    const over = episode && this.time >= episode.endS && this.time > 0;
    write(panel.state, !episode ? this.endS ? "no replay" : ""
      : over ? `ended at ${episode.endS.toFixed(0)} s` : "");
  }

  drawClock() {
    const { period_s: period, horizon } = this.stage, seek = this.find("seek");
    const step = Math.floor(this.time / period + 1e-6);
    seek.value = this.time;
    seek.setAttribute("aria-valuetext", `${this.time.toFixed(0)} seconds, step ${step}`);
    this.find("time").textContent = `${this.time.toFixed(period < 10 ? 1 : 0)} s`;
    this.find("step").textContent = `step ${step} of ${horizon}`;
    this.drawCurves();
  }

  // What was discovered and collected over time; further worlds are dashed.
  drawCurves() {
    const canvas = this.find("curves"), context = canvas.getContext("2d");
    const density = window.devicePixelRatio || 1, [w, h] = [canvas.clientWidth, canvas.clientHeight];
    Object.assign(canvas, { width: Math.round(w * density), height: Math.round(h * density) });
    context.setTransform(density, 0, 0, density, 0, 0);
    const end = this.endS || 1, wide = w - 16;
    const x = (time) => 8 + (wide * time) / end, y = (share) => h - 3 - ((h - 8) * share) / 100;
    context.strokeStyle = "#dfe4e9";
    context.lineWidth = 1;
    [0, 100].forEach((share) => {
      context.beginPath();
      context.moveTo(8, y(share));
      context.lineTo(8 + wide, y(share));
      context.stroke();
    });
    this.panels.forEach(({ curve, episode }, i) => curve && [COLOURS.found, COLOURS.done]
      .forEach((colour, which) => {
        context.beginPath();
        curve.forEach((shares, step) => context.lineTo(x(step * episode.periodS), y(shares[which])));
        context.strokeStyle = colour;
        context.lineWidth = 1.7;
        context.setLineDash(i ? [5, 3] : []);
        context.stroke();
        context.setLineDash([]);
      }));
    context.beginPath();
    context.moveTo(x(this.time), 0);
    context.lineTo(x(this.time), h);
    context.strokeStyle = "#1f2933";
    context.lineWidth = 1.2;
    context.stroke();
  }

  legend() {
    const { colours, agents } = this.stage;
    const drawing = this.root.querySelector("svg").namespaceURI;
    const hull = (agent) => ["polygon", {
      points: HULLS[role(agent)].map(([u, v]) => `${11 + 16 * u},${8 + 16 * v}`).join(" "),
      fill: agent.colour,
    }];
    const dot = (size, opacity) => ["circle", {
      cx: 12, cy: 8, r: 4.5 * size, fill: colours.item, stroke: colours.item_rim,
      "stroke-width": 1.3, opacity,
    }];
    const cell = (fill) => ["rect", { x: 3, y: 1, width: 18, height: 14, fill }];
    const seen = (colour) => ["rect", {
      x: 3, y: 2, width: 18, height: 12, fill: "#f3f9fc", stroke: colour, "stroke-width": 1.4,
    }];
    const line = (stroke, width, dash) => ["path", {
      d: "M1 8H23", stroke, "stroke-width": width, "stroke-dasharray": dash,
    }];
    const ghost = () => {
      const [shape, attributes] = hull(agents[agents.length - 1]);
      return [shape, { ...attributes, "fill-opacity": GHOST }];
    };
    const entries = [
      ...agents.slice(0, 12).map((agent) => [agent.name, hull(agent)]),
      ["item, discovered", dot(1, 1)],
      ["item, not yet", dot(UNKNOWN.size, UNKNOWN.alpha)],
      ["believed items: 1", cell(colours.belief[0])],
      [String(this.panels[0].picture.top), cell(colours.belief[colours.belief.length - 1])],
      ...(agents.some((a) => !a.collects) ? [["seen by a scout", seen(colours.scout)]] : []),
      ...(agents.some((a) => a.collects) ? [["by a forager", seen(colours.forager)]] : []),
      ...(this.panels.length > 1 ? [["PTA, left", line(colours.ink, 1.8, "none")],
        ["PTA, right", line(colours.ink, 1.8, "5 3")]] : []),
      ...(this.find("seen") ? [["in contact", line(colours.ink, 1, "none")],
        ["looks lost", line(colours.lost, 2, "6 5")], ["last heard of, how long ago", ghost()]] : []),
    ];
    this.find("legend").append(...entries.map(([words, [shape, attributes]]) => {
      const make = (name) => document.createElementNS(drawing, name);
      const entry = document.createElement("li"), picture = make("svg"), mark = make(shape);
      Object.entries(attributes).forEach(([key, value]) => mark.setAttribute(key, value));
      picture.setAttribute("viewBox", "0 0 24 16");
      picture.setAttribute("aria-hidden", "true");
      picture.append(mark);
      entry.append(picture, words);
      return entry;
    }));
  }
}

new Player(document.getElementById("player"),
  JSON.parse(document.getElementById("player-data").textContent));
