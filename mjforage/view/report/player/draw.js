// Draws one world at one time onto a canvas. Bow towards +x in hull lengths, as in the figures.
const HULLS = {
  scout: [[0.55, 0], [0.1, 0.23], [-0.45, 0.3], [-0.3, 0], [-0.45, -0.3], [0.1, -0.23]],
  forager: [
    [0.1, 0.15], [0.52, 0.2], [0.42, 0.4], [-0.36, 0.4], [-0.48, 0.26],
    [-0.48, -0.26], [-0.36, -0.4], [0.42, -0.4], [0.52, -0.2], [0.1, -0.15],
  ],
};
const LEAST_HULL_PX = { scout: 17, forager: 18 };
const WAKE_S = 90, WAKE_PIECES = 36;
const FLASH_S = 14;
const LOST_PX = 18; // from a link to the count of what it lost
const UNKNOWN = { size: 0.72, alpha: 0.75 }; // items that nobody has discovered, as in films
const IDLE = [70, 96, 122], IDLE_ALPHA = 165; // of the longest unseen
const GHOST = 0.5; // opacity of a vessel where it was last heard of
const FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';

const role = (agent) => (agent.collects ? "forager" : "scout");
const hullPath = (points) => new Path2D(`M${points.map((point) => point.join(" ")).join("L")}Z`);
const HULL_PATHS = { scout: hullPath(HULLS.scout), forager: hullPath(HULLS.forager) };

class Picture {
  constructor(canvas, harbour) {
    Object.assign(this, { canvas, harbour, stage: harbour.stage });
    this.top = Math.max(4, ...this.stage.replays.map((entry) => entry.most_believed));
    this.context = canvas.getContext("2d");
    this.layers = {};
  }

  // Outline of a vessel's hull.
  hull(agent) { return HULL_PATHS[role(this.agents[agent])]; }

  // CSS size of the canvas; its bitmap follows it and the screen's density.
  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const density = Math.min(window.devicePixelRatio || 1, 3);
    const [w, h] = [Math.round(width * density), Math.round(height * density)];
    if (this.canvas.width !== w || this.canvas.height !== h)
      Object.assign(this.canvas, { width: w, height: h });
    this.density = density;
    return { width, height };
  }

  // `seer`: the vessel by whose knowledge, -1 for all of them together.
  draw(episode, time, lens, shown, vessel, seer) {
    const { context, stage } = this;
    this.lens = lens;
    context.setTransform(this.density, 0, 0, this.density, 0, 0);
    context.fillStyle = stage.colours.water;
    context.fillRect(0, 0, lens.width, lens.height);
    const step = episode && episode.step(time), mind = episode && episode.mind(seer);
    if (episode) this.drawKnowledge(mind, step, shown);
    this.drawQuays();
    if (!episode) return;
    if (shown.belief) this.drawCounts(mind.belief.at(step));
    this.agents = episode.agents;
    const agents = this.agents.map((_, agent) => agent);
    const heard = agents.map((agent) => episode.heardAt(seer, agent, step));
    const present = (agent) => heard[agent] === step, away = (agent) => !present(agent);
    if (shown.wakes) agents.filter(present).forEach((agent) => this.drawWake(episode, agent, time));
    this.drawItems(episode, time, seer);
    if (shown.links) this.drawLinks(episode, time);
    agents.filter(away).forEach((agent) => this.drawAway(episode, agent, time));
    agents.filter(away).forEach((agent) => this.drawGhost(episode, agent, heard[agent], time));
    agents.filter(present)
      .forEach((agent) => this.drawHull(episode, agent, time, agent === vessel));
    if (vessel >= 0) this.drawName(episode, vessel, time);
  }

  px(x, y) {
    const { lens } = this;
    return [lens.width / 2 + (x - lens.x) * lens.scale, lens.height / 2 - (y - lens.y) * lens.scale];
  }

  // Sets pixels so that what follows is in metres, y upwards.
  metres() {
    const { lens, density: d, context } = this, k = lens.scale;
    context.setTransform(d * k, 0, 0, -d * k, d * (lens.width / 2 - lens.x * k),
      d * (lens.height / 2 + lens.y * k));
  }

  pixels() { this.context.setTransform(this.density, 0, 0, this.density, 0, 0); }

  // A bitmap of cells that starts `beyond` cells outside the map.
  drawCells(cells, beyond) {
    const { stage, context, lens } = this, k = lens.scale * stage.pitch_m;
    const [left, top] = this.px(-(beyond + 0.5) * stage.pitch_m,
      (stage.rows + beyond - 0.5) * stage.pitch_m);
    context.imageSmoothingEnabled = false;
    context.drawImage(cells, left, top, cells.width * k, cells.height * k);
  }

  // Cells by value, painted once a step: `paint` gives [red, green, blue, alpha 0..255] or nothing.
  drawLayer(name, mind, step, paint) {
    const { columns, rows } = this.stage;
    const layer = this.layers[name] ||= { cells: bitmap(columns, rows), mind: null, step: -1 };
    if (layer.mind !== mind || layer.step !== step) {
      const context = layer.cells.getContext("2d"), image = context.createImageData(columns, rows);
      mind[name].at(step).forEach((value, cell) => {
        const colour = paint(value, cell);
        if (colour) image.data.set(colour, 4 * cell);
      });
      context.putImageData(image, 0, 0);
      Object.assign(layer, { mind, step });
    }
    this.drawCells(layer.cells, 0);
  }

  drawKnowledge(mind, step, shown) {
    const { colours, idle_levels: levels, water } = this.stage;
    if (shown.idleness)
      this.drawLayer("idleness", mind, step, (level, cell) =>
        (water[cell] === "1" ? [...IDLE, (IDLE_ALPHA * level) / levels] : null));
    if (shown.view) this.drawLayer("view", mind, step, (bits) => bits && [255, 255, 255, 125]);
    if (shown.belief) {
      const ramp = colours.belief.map((hex) => [...rgb(hex), 225]);
      this.drawLayer("belief", mind, step, (count) => count > 0 && ramp[this.shade(count)]);
    }
    if (shown.view) this.drawViews(mind, step);
  }

  // Place of a believed count in the ramp of beliefs.
  shade(count) {
    const last = this.stage.colours.belief.length - 1;
    return Math.round((Math.log(count) / Math.log(this.top)) * last);
  }

  // Frames around the nodes in view now, in the colour of the role that sees them.
  drawViews(mind, step) {
    const { context, lens, stage } = this, grid = mind.view.at(step);
    const { rows, columns, colours } = stage;
    if (this.viewed !== mind || this.viewStep !== step) {
      this.viewPaths = [1, 2].map((bit) => this.harbour.outline((row, column) =>
        row >= 0 && row < rows && column >= 0 && column < columns
          && (grid[row * columns + column] & bit) > 0, 0));
      Object.assign(this, { viewed: mind, viewStep: step });
    }
    [colours.scout, colours.forager].forEach((hex, role) => {
      this.metres();
      context.lineCap = "square";
      context.strokeStyle = hex;
      context.lineWidth = 1.5 / lens.scale;
      context.stroke(this.viewPaths[role]);
      this.pixels();
    });
  }

  // Believed counts in figures, once their cells are large enough to hold them.
  drawCounts(belief) {
    const { stage, context, lens } = this, cell = lens.scale * stage.pitch_m;
    if (cell < 15) return;
    context.font = `600 ${Math.min(13, 0.5 * cell)}px ${FONT}`;
    context.textAlign = "right";
    context.textBaseline = "top";
    belief.forEach((count, at) => {
      if (!count) return;
      const row = Math.floor(at / stage.columns), column = at % stage.columns;
      const [x, y] = this.px((column + 0.5) * stage.pitch_m, (stage.rows - row - 0.5) * stage.pitch_m);
      context.fillStyle = this.shade(count) > 3 ? "#fff" : stage.colours.ink;
      context.fillText(count, x - 0.1 * cell, y + 0.08 * cell);
    });
  }

  drawQuays() {
    const { context, stage, lens } = this, cell = stage.pitch_m;
    const stroke = (style, width) => {
      context.strokeStyle = style;
      context.lineWidth = width;
      context.stroke(this.harbour.edges);
    };
    context.lineJoin = context.lineCap = "round";
    this.metres();
    stroke("rgba(38,84,110,.10)", 0.55 * cell);
    stroke("rgba(38,84,110,.14)", 0.25 * cell);
    this.pixels();
    this.drawCells(this.harbour.land, this.harbour.beyond);
    this.metres();
    stroke(stage.colours.edge, Math.max(1.5 / lens.scale, 0.03 * cell));
    this.pixels();
  }

  drawWake(episode, agent, time) {
    const { context } = this, { colour } = this.agents[agent];
    const start = Math.max(0, time - WAKE_S), pieces = WAKE_PIECES;
    if (time <= start) return;
    const length = this.hullLength(agent);
    context.lineCap = "butt"; // round ends would show through each other
    context.strokeStyle = colour;
    let [x, y] = [null, null];
    for (let i = 0; i <= pieces; i++) {
      const at = start + ((time - start) * i) / pieces, pose = episode.pose(agent, at);
      const [u, v] = this.px(pose.x, pose.y), age = 1 - (time - at) / WAKE_S;
      if (x !== null && (u !== x || v !== y)) {
        context.globalAlpha = 0.75 * age ** 1.4;
        context.lineWidth = length * (0.05 + 0.1 * age);
        context.beginPath();
        context.moveTo(x, y);
        context.lineTo(u, v);
        context.stroke();
      }
      [x, y] = [u, v];
    }
    context.globalAlpha = 1;
  }

  drawItems(episode, time, seer) {
    const { context, stage, lens } = this;
    const radius = Math.min(5.5, Math.max(2.3, 0.14 * stage.pitch_m * lens.scale));
    for (let i = 0; i < episode.items; i++) {
      const age = (time - episode.removedS[i]) / FLASH_S;
      if (age >= 1) continue;
      const place = episode.item(i, time), [x, y] = this.px(place.x, place.y);
      context.beginPath();
      if (age >= 0) {
        context.arc(x, y, radius * (1 + 4 * age), 0, 7);
        context.globalAlpha = 0.9 * (1 - age);
        context.strokeStyle = stage.colours.rim;
        context.lineWidth = 2.2 * (1 - age) + 0.3;
        context.stroke();
        context.globalAlpha = 1;
        continue;
      }
      const known = episode.knows(seer, i, time);
      context.arc(x, y, known ? radius : UNKNOWN.size * radius, 0, 7);
      context.globalAlpha = known ? 1 : UNKNOWN.alpha;
      context.fillStyle = stage.colours.item;
      context.strokeStyle = stage.colours.rim;
      context.lineWidth = Math.max(1.1, 0.3 * radius);
      context.fill();
      context.stroke();
      context.globalAlpha = 1;
    }
  }

  // On the screen: its true length once that is large enough to be seen.
  hullLength(agent) {
    const { lens } = this, vessel = this.agents[agent];
    return Math.max(LEAST_HULL_PX[role(vessel)], vessel.length_m * lens.scale);
  }

  // Sets the context so that what follows is in hull lengths, the bow towards +x; saves it before.
  onHull(agent, pose) {
    const { context } = this, length = this.hullLength(agent);
    context.save();
    context.translate(...this.px(pose.x, pose.y));
    context.rotate(-pose.yaw);
    context.scale(length, length);
    context.lineJoin = "round";
  }

  // A vessel that is not heard now: its outline where it truly is.
  drawAway(episode, agent, time) {
    const { context } = this;
    this.onHull(agent, episode.pose(agent, time));
    context.strokeStyle = this.agents[agent].colour;
    context.lineWidth = 1.2 / this.hullLength(agent);
    context.globalAlpha = 0.8;
    context.stroke(this.hull(agent));
    context.restore();
  }

  // And faded where it was last heard of, with how long ago.
  drawGhost(episode, agent, heard, time) {
    const { context } = this, pose = episode.pose(agent, heard * episode.periodS);
    const length = this.hullLength(agent), age = Math.floor(time + 1e-6) - heard * episode.periodS;
    this.onHull(agent, pose);
    context.globalAlpha = GHOST;
    context.strokeStyle = "#fff";
    context.lineWidth = 3 / length;
    context.stroke(this.hull(agent));
    context.fillStyle = this.agents[agent].colour;
    context.fill(this.hull(agent));
    context.restore();
    const [x, y] = this.px(pose.x, pose.y);
    this.label(`${age.toFixed(0)} s ago`, x, y + 0.6 * length, "center", "top");
  }

  // Who is in contact; broken and red where looks were lost in this step, with how many.
  drawLinks(episode, time) {
    const { context, stage } = this, { ink, lost: red } = stage.colours;
    for (const { a, b, lost } of episode.links(episode.step(time))) {
      const [from, to] = [a, b].map((agent) => {
        const pose = episode.pose(agent, time);
        return this.px(pose.x, pose.y);
      });
      context.beginPath();
      context.moveTo(...from);
      context.lineTo(...to);
      context.lineCap = "butt";
      context.strokeStyle = lost ? red : ink;
      context.globalAlpha = lost ? 0.95 : 0.6;
      context.lineWidth = lost ? 2 : 1;
      context.setLineDash(lost ? [6, 5] : []);
      context.stroke();
      context.setLineDash([]);
      context.globalAlpha = 1;
      if (lost) this.drawLost(from, to, lost, red);
    }
  }

  // The count stands beside the middle of the link, where short links leave it room.
  drawLost([x, y], [u, v], lost, colour) {
    const away = (v < y ? -LOST_PX : LOST_PX) / (Math.hypot(u - x, v - y) || 1);
    this.label(`−${lost}`, (x + u) / 2 + away * (v - y), (y + v) / 2 - away * (u - x), "center",
      "middle", colour);
  }

  drawHull(episode, agent, time, followed) {
    const { context } = this, vessel = this.agents[agent], pose = episode.pose(agent, time);
    const [x, y] = this.px(pose.x, pose.y), length = this.hullLength(agent);
    if (followed) {
      context.beginPath();
      context.arc(x, y, 0.85 * length, 0, 7);
      context.strokeStyle = vessel.colour;
      context.lineWidth = 1.5;
      context.setLineDash([5, 4]);
      context.stroke();
      context.setLineDash([]);
    }
    this.onHull(agent, pose);
    for (const [style, width] of [["rgba(24,52,72,.55)", 4.6], ["#fff", 3]]) {
      context.strokeStyle = style;
      context.lineWidth = width / length;
      context.stroke(this.hull(agent));
    }
    context.fillStyle = vessel.colour;
    context.fill(this.hull(agent));
    context.beginPath();
    context.arc(vessel.collects ? -0.18 : -0.05, 0, 0.075, 0, 7);
    context.fillStyle = "#fff";
    context.fill();
    context.restore();
  }

  drawName(episode, agent, time) {
    const pose = episode.pose(agent, time), [x, y] = this.px(pose.x, pose.y);
    const above = 0.85 * this.hullLength(agent) + 5;
    this.label(this.agents[agent].name, x, y - above, "center", "bottom");
  }

  label(text, x, y, align, baseline, colour = this.stage.colours.ink) {
    const { context } = this;
    context.font = `600 12px ${FONT}`;
    context.textAlign = align;
    context.textBaseline = baseline;
    context.lineJoin = "round";
    context.strokeStyle = "rgba(255,255,255,.85)";
    context.lineWidth = 3.5;
    context.strokeText(text, x, y);
    context.fillStyle = colour;
    context.fillText(text, x, y);
  }

  // A bar of a round number of metres: how many, and its length on the screen.
  scaleBar() {
    const { scale } = this.lens, most = 110 / scale, power = 10 ** Math.floor(Math.log10(most));
    const metres = Math.max(...[1, 2, 5].map((f) => f * power).filter((m) => m <= most));
    return { metres, px: metres * scale };
  }
}
