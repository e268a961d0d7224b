// What does not change: land, quay edges, and the bitmaps that layers are painted into.

function rgb(hex) { return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)); }

function bitmap(width, height) {
  return Object.assign(document.createElement("canvas"), { width, height });
}

class Harbour {
  constructor(stage) {
    this.stage = stage;
    this.beyond = Math.max(stage.rows, stage.columns); // cells drawn on past the map's edge
    this.land = this.landBitmap();
    this.edges = this.outline((row, column) => this.isWater(row, column), this.beyond);
  }

  isWater(row, column) {
    const { rows, columns, water } = this.stage;
    const inside = (at, count) => Math.min(Math.max(at, 0), count - 1);
    return water[inside(row, rows) * columns + inside(column, columns)] === "1";
  }

  landBitmap() {
    const { rows, columns, colours } = this.stage, { beyond } = this, wide = columns + 2 * beyond;
    const canvas = bitmap(wide, rows + 2 * beyond), context = canvas.getContext("2d");
    const image = context.createImageData(canvas.width, canvas.height), land = rgb(colours.land);
    for (let row = 0; row < canvas.height; row++)
      for (let column = 0; column < wide; column++)
        if (!this.isWater(row - beyond, column - beyond))
          image.data.set([...land, 255], 4 * (row * wide + column));
    context.putImageData(image, 0, 0);
    return canvas;
  }

  // Lines around the cells of a kind, in metres, each as long as it is straight.
  outline(is, beyond) {
    const { rows, columns, pitch_m: pitch } = this.stage, path = new Path2D();
    const x = (column) => (column - 0.5) * pitch, y = (row) => (rows - row - 0.5) * pitch;
    const line = (outer, inner, differs, point) => {
      for (let o = -beyond; o <= outer + beyond; o++)
        for (let i = -beyond, start = null; i <= inner + beyond; i++) {
          const edge = i < inner + beyond && differs(o, i);
          if (edge && start === null) start = i;
          if (!edge && start !== null) {
            path.moveTo(...point(o, start));
            path.lineTo(...point(o, i));
            start = null;
          }
        }
    };
    line(rows, columns, (r, c) => is(r - 1, c) !== is(r, c), (r, c) => [x(c), y(r)]);
    line(columns, rows, (c, r) => is(r, c - 1) !== is(r, c), (c, r) => [x(c), y(r)]);
    return path;
  }
}
