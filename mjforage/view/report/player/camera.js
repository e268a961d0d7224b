// Where the panels look: one place and zoom for all of them, or a vessel each in its own world.
const MOST_ZOOM_PX_PER_M = 48;
const FOLLOW_SPAN_M = 72; // shown across the shorter side when a vessel is first followed

class Camera {
  constructor(stage) {
    const { top, bottom, left, right } = stage.extent, pitch = stage.pitch_m;
    this.width = (right - left + 1) * pitch;
    this.height = (bottom - top + 1) * pitch;
    this.left = (left - 0.5) * pitch;
    this.bottom = (stage.rows - bottom - 1.5) * pitch;
    this.reset();
  }

  reset() {
    this.x = this.left + this.width / 2;
    this.y = this.bottom + this.height / 2;
    this.zoom = 1;
    this.vessel = "";
  }

  // Pixels per metre with all of the water in view.
  fit(size) { return Math.min(size.width / this.width, size.height / this.height); }

  follow(vessel, size) {
    this.vessel = vessel;
    const close = Math.min(size.width, size.height) / FOLLOW_SPAN_M / this.fit(size);
    if (vessel) this.zoom = Math.max(this.zoom, close);
  }

  // Transform of a panel: scale in pixels per metre, and the place in its middle.
  lens(size, pose) {
    const scale = this.fit(size) * this.zoom;
    const centre = pose || {
      x: Camera.held(this.x, this.left, this.width, size.width / scale),
      y: Camera.held(this.y, this.bottom, this.height, size.height / scale),
    };
    return { scale, x: centre.x, y: centre.y, ...size };
  }

  // A middle that keeps the map in the panel: no further out than the map's edge.
  static held(middle, low, span, seen) {
    if (seen >= span) return low + span / 2;
    return Math.min(Math.max(middle, low + seen / 2), low + span - seen / 2);
  }

  // Zoom by a factor with the point under the pointer staying where it is; true if it changed.
  zoomAt(factor, point, lens) {
    const fit = this.fit(lens), most = Math.max(1, MOST_ZOOM_PX_PER_M / fit);
    const zoom = Math.min(most, Math.max(1, this.zoom * factor));
    if (Math.abs(zoom - this.zoom) < 1e-9) return false;
    const dx = point.x - lens.width / 2, dy = point.y - lens.height / 2;
    this.x = lens.x + dx / lens.scale - dx / (fit * zoom);
    this.y = lens.y - dy / lens.scale + dy / (fit * zoom);
    this.zoom = zoom;
    return true;
  }

  pan(dx, dy, lens) {
    this.vessel = "";
    this.x = lens.x - dx / lens.scale;
    this.y = lens.y + dy / lens.scale;
  }
}
