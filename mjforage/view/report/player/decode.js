// Reads the replays that web_entry.py wrote: whole numbers as byte planes, deflated, in base64.
const canDecode = () => typeof DecompressionStream === "function";

async function inflate(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

class Reader {
  constructor(bytes) {
    const n = bytes.length / 4, plane = (i, k) => bytes[k * n + i] * 256 ** k;
    this.numbers = Uint32Array.from({ length: n }, (_, i) =>
      plane(i, 0) + plane(i, 1) + plane(i, 2) + plane(i, 3));
    this.at = 0;
  }

  next() { return this.many(1)[0]; }

  many(count) {
    if (this.at + count > this.numbers.length) throw new Error("its data end too early");
    this.at += count;
    return this.numbers.slice(this.at - count, this.at);
  }

  // `lines` numbers over `times` frames, one line after another, in metres or radians.
  track(lines, times, unit) {
    const order = this.next(), coded = this.many(lines * times);
    const values = new Float32Array(lines * times);
    for (let line = 0, i = 0; line < lines; line++) {
      for (let time = 0, value = 0, rate = 0; time < times; time++, i++) {
        const folded = coded[i], change = folded % 2 ? -(folded + 1) / 2 : folded / 2;
        rate = order === 2 ? rate + change : change;
        value += rate;
        values[i] = value * unit;
      }
    }
    return values;
  }

  layer(steps, size) {
    const counts = this.many(steps), starts = new Uint32Array(steps + 1);
    counts.forEach((count, step) => { starts[step + 1] = starts[step] + count; });
    const cells = this.many(starts[steps]), values = this.many(starts[steps]);
    for (let step = 0; step < steps; step++)
      for (let i = starts[step] + 1; i < starts[step + 1]; i++) cells[i] += cells[i - 1];
    return new Layer(starts, cells, values, size);
  }
}

// A grid of numbers that changes from step to step; `at` gives it as it is at one.
class Layer {
  constructor(starts, cells, values, size) {
    Object.assign(this, { starts, cells, values, grid: new Uint16Array(size), step: -1 });
  }

  at(step) {
    if (step < this.step) { this.grid.fill(0); this.step = -1; }
    for (let i = this.starts[this.step + 1]; i < this.starts[step + 1]; i++)
      this.grid[this.cells[i]] = this.values[i];
    this.step = step;
    return this.grid;
  }
}

// A grid worked out from others: `fill` writes it as it is at a step.
class Derived {
  constructor(size, fill) { Object.assign(this, { fill, grid: new Uint16Array(size), step: -1 }); }

  at(step) {
    if (step !== this.step) this.fill(this.grid, step);
    this.step = step;
    return this.grid;
  }
}

const TURN_PART = 0.35; // of a step that a vessel takes to turn at graph level

// One episode of one world: where everything is at any time, in metres, seconds and radians.
class Episode {
  constructor(bytes, entry, stage) {
    const reader = new Reader(bytes), { frames, items, steps } = entry, { units } = stage;
    const { run } = stage, agents = run.agents.length;
    const size = stage.rows * stage.columns;
    this.poseFrames = Math.ceil((frames - 1) / entry.pose_stride) + 1;
    this.itemFrames = Math.ceil((frames - 1) / entry.item_stride) + 1;
    this.places = reader.track(2 * agents, this.poseFrames, units.position_m);
    this.yaws = reader.track(agents, this.poseFrames, units.yaw_rad);
    this.itemPlaces = reader.track(2 * items, this.itemFrames, units.position_m);
    this.winds = reader.track(2, this.itemFrames, units.wind_mps);
    const removed = reader.many(items), discovered = reader.many(items);
    this.removedS = Float64Array.from(removed, (f) => (f < frames ? f * entry.frame_s : Infinity));
    this.discoveredS = Float64Array.from(discovered, (step, i) =>
      Math.min(step <= steps ? step * run.period_s : Infinity, this.removedS[i]));
    this.belief = reader.layer(steps + 1, size);
    this.idleness = reader.layer(steps + 1, size);
    this.view = reader.layer(steps + 1, size);
    this.minds = entry.forgetting === null ? null
      : this.readMinds(reader, entry, agents, size, stage.idle_levels);
    if (reader.at !== reader.numbers.length) throw new Error("its data do not end where they should");
    this.agents = run.agents;
    this.horizon = run.horizon;
    this.frames = frames;
    this.frameS = entry.frame_s;
    this.poseStride = entry.pose_stride;
    this.itemStride = entry.item_stride;
    this.items = items;
    this.steps = steps;
    this.periodS = run.period_s;
    this.endS = steps * run.period_s;
    this.turnPart = entry.frame_s >= run.period_s ? TURN_PART : 1;
  }

  // What each vessel knows, over a link; steps are counted from 1 in the data, 0 is never.
  readMinds(reader, { forgetting, items, steps }, agents, size, levels) {
    const known = reader.many(agents * items);
    this.knownFrom = Float64Array.from(known, (step) => (step ? step - 1 : Infinity));
    this.heard = reader.layer(steps + 1, agents * agents);
    this.pairs = reader.layer(steps + 1, agents * agents);
    return Array.from({ length: agents }, () => {
      const belief = reader.layer(steps + 1, size), seen = reader.layer(steps + 1, size);
      const idle = (last, step) => (last ? Math.min(1, (step + 1 - last) * forgetting) : 1);
      const idleness = new Derived(size, (grid, step) => seen.at(step).forEach((last, cell) => {
        grid[cell] = Math.round(levels * idle(last, step));
      }));
      const view = new Derived(size, (grid, step) => {
        const now = this.view.at(step);
        seen.at(step).forEach((last, cell) => { grid[cell] = last === step + 1 ? now[cell] : 0; });
      });
      return { belief, idleness, view };
    });
  }

  // Belief, idleness and what is in view as a vessel knows them, or all of them together (-1).
  mind(vessel) { return vessel < 0 || !this.minds ? this : this.minds[vessel]; }

  // Step of the newest look of an agent that a vessel has heard by a step.
  heardAt(vessel, agent, step) {
    if (vessel < 0 || !this.minds) return step;
    return this.heard.at(step)[vessel * Math.sqrt(this.heard.grid.length) + agent];
  }

  knows(vessel, item, time) {
    if (vessel < 0 || !this.minds) return this.discoveredS[item] <= time + 1e-6;
    return this.knownFrom[vessel * this.items + item] <= this.step(time);
  }

  // Pairs in contact at a step, and how many looks were lost between them.
  links(step) {
    if (!this.minds) return [];
    const grid = this.pairs.at(step), agents = Math.sqrt(grid.length), found = [];
    for (let a = 0; a < agents; a++)
      for (let b = 0; b < a; b++) {
        const there = grid[a * agents + b], back = grid[b * agents + a];
        if (there && back) found.push({ a, b, lost: there + back - 2 });
      }
    return found;
  }

  // Kept frame before a time, and the part of the way to the next; the last one may be nearer.
  between(time, stride) {
    const last = this.frames - 1, frame = Math.min(Math.max(time / this.frameS, 0), last);
    const before = Math.min(Math.floor(frame / stride), Math.max(Math.ceil(last / stride) - 1, 0));
    const gap = Math.min(stride, last - before * stride);
    return [before, gap > 0 ? (frame - before * stride) / gap : 0];
  }

  static mix(values, start, part) {
    return part > 0 ? values[start] + (values[start + 1] - values[start]) * part : values[start];
  }

  pose(agent, time) {
    const [before, part] = this.between(time, this.poseStride), n = this.poseFrames;
    return {
      x: Episode.mix(this.places, 2 * agent * n + before, part),
      y: Episode.mix(this.places, (2 * agent + 1) * n + before, part),
      yaw: Episode.mix(this.yaws, agent * n + before, Math.min(1, part / this.turnPart)),
    };
  }

  item(index, time) {
    const [before, part] = this.between(time, this.itemStride), n = this.itemFrames;
    return {
      x: Episode.mix(this.itemPlaces, 2 * index * n + before, part),
      y: Episode.mix(this.itemPlaces, (2 * index + 1) * n + before, part),
    };
  }

  wind(time) {
    const [before, part] = this.between(time, this.itemStride), n = this.itemFrames;
    return { x: Episode.mix(this.winds, before, part), y: Episode.mix(this.winds, n + before, part) };
  }

  // The last decision step that is over; what the fleet knows changes only with it.
  step(time) {
    return Math.min(this.steps, Math.max(0, Math.floor(time / this.periodS + 1e-6)));
  }

  // Per cent of the items that were discovered, and collected, by then.
  shares(time) {
    const by = (times) => times.reduce((sum, when) => sum + (when <= time + 1e-6), 0);
    const share = 100 / Math.max(this.items, 1);
    return { discovered: share * by(this.discoveredS), collected: share * by(this.removedS) };
  }
}

async function decodeEpisode(entry, stage) {
  return new Episode(await inflate(entry.text), entry, stage);
}
