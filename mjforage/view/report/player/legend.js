// What everything drawn means: a mark and its words; of layers that are off there is none.
const onSvg = (shape, attributes) => {
  const drawing = document.querySelector(".player svg").namespaceURI;
  const mark = document.createElementNS(drawing, shape);
  Object.entries(attributes).forEach(([key, value]) => mark.setAttribute(key, value));
  return mark;
};

class Legend {
  constructor(list, stage) { Object.assign(this, { list, stage, colours: stage.colours }); }

  // Set the marks for a fleet: `top` most believed items, `maps` on the page, `linked` over a link.
  set(agents, top, maps, linked) {
    const scouts = agents.find((agent) => !agent.collects);
    const foragers = agents.find((agent) => agent.collects);
    this.entries = [
      ...agents.slice(0, 12).map((agent) => this.sea(agent.name, [this.hull(agent)])),
      ...this.items(),
      this.sea(`believed items per node, 1 to ${top}`, this.ramp(), "belief"),
      ...(scouts ? [this.sea("seen by a scout", [this.frame(this.colours.scout)], "view")] : []),
      ...(foragers ? [this.sea("seen by a forager", [this.frame(this.colours.forager)], "view")]
        : []),
      this.sea("unseen, the longer the darker", this.shades(), "idleness"),
      ...(agents.length ? [this.sea("wake of the last 90 s", [this.wake(agents[0])], "wakes"),
        this.sea("followed", [this.ring(agents[0].colour, "3 2")], "followed")] : []),
      ...(linked ? this.links(agents[agents.length - 1]) : []),
      this.sea("quay", [["rect", { x: 0, y: 0, width: 24, height: 16, fill: this.colours.land,
        stroke: this.colours.edge, "stroke-width": 2 }]]),
      { words: "discovered, PTA", below: "D", marks: [this.line("var(--found)", 2)] },
      { words: "collected, PTA", below: "C", marks: [this.line("var(--done)", 2)] },
      ...(maps > 1 ? [{ words: "second map", marks: [this.line("var(--ink)", 1.8, "5 3")] }] : []),
    ];
    this.list.replaceChildren(...this.entries.map((entry) => this.item(entry)));
  }

  // Show the entries of the layers that are on.
  show(on) {
    [...this.list.children].forEach((item, i) => {
      const { layer } = this.entries[i];
      item.hidden = Boolean(layer) && !on[layer];
    });
  }

  item({ words, below, marks, sea }) {
    const item = document.createElement("li");
    const picture = onSvg("svg", { viewBox: "0 0 24 16", "aria-hidden": "true" });
    if (sea) picture.append(onSvg("rect", { width: 24, height: 16, fill: this.colours.water }));
    picture.append(...marks.map(([shape, attributes]) => onSvg(shape, attributes)));
    const text = document.createElement("span");
    text.append(words);
    if (below) text.append(Object.assign(document.createElement("sub"), { textContent: below }));
    item.append(picture, text);
    return item;
  }

  // A mark of the map, which is drawn on water.
  sea(words, marks, layer) { return { words, marks, layer, sea: true }; }

  items() {
    const { item, rim } = this.colours;
    const dot = (size, opacity) => ["circle",
      { cx: 12, cy: 8, r: 4.5 * size, fill: item, stroke: rim, "stroke-width": 1.3, opacity }];
    return [
      this.sea("item, discovered", [dot(1, 1)]),
      this.sea("item, not yet", [dot(UNKNOWN.size, UNKNOWN.alpha)]),
      this.sea("item, just collected", [this.ring(rim)]),
    ];
  }

  links(agent) {
    const hull = this.hull(agent), [shape, { points }] = hull, { ink, lost } = this.colours;
    return [
      this.sea("in contact", [this.line(ink, 1)], "links"),
      this.sea("looks lost", [this.line(lost, 2, "6 5")], "links"),
      this.sea("last heard of, how long ago", [[shape, { ...hull[1], "fill-opacity": GHOST }]],
        "seer"),
      this.sea("where it is, not heard", [[shape,
        { points, fill: "none", stroke: agent.colour, "stroke-width": 1.2 }]], "seer"),
    ];
  }

  hull(agent) {
    const points = HULLS[role(agent)].map(([u, v]) => `${11 + 16 * u},${8 + 16 * v}`).join(" ");
    return ["polygon", { points, fill: agent.colour }];
  }

  ramp() {
    const { belief } = this.colours, parts = [0, 1, 2, 3];
    return parts.map((part) => ["rect", { x: 6 * part, y: 0, width: 6.1, height: 16,
      fill: belief[Math.round((part / 3) * (belief.length - 1))] }]);
  }

  shades() {
    return [1, 2, 3].map((part) => ["rect", { x: 6 * part, y: 0, width: 6, height: 16,
      fill: `rgb(${IDLE.join(" ")})`, "fill-opacity": ((IDLE_ALPHA / 255) * part) / 3 }]);
  }

  frame(colour) {
    return ["rect", { x: 3, y: 2.5, width: 18, height: 11, fill: "#fff", "fill-opacity": 0.5,
      stroke: colour, "stroke-width": 1.5 }];
  }

  wake({ colour }) {
    return ["polygon", { points: "1,7.6 23,5.4 23,10.6 1,8.4", fill: colour, "fill-opacity": 0.55 }];
  }

  ring(stroke, dash = "none") {
    return ["circle", { cx: 12, cy: 8, r: 6, fill: "none", stroke, "stroke-width": 1.5,
      "stroke-dasharray": dash }];
  }

  line(colour, width, dash = "none") {
    return ["path", { d: "M1 8H23", style: `stroke: ${colour}`, "stroke-width": width,
      "stroke-dasharray": dash }];
  }
}
