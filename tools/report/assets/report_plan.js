"use strict";

// The sweeps laid over each other in the room, from above, the front and the side: walls are single lines where the LiDARs agree.

const measureRoom_m = 0.15; // below the floor, for the measure
const planViews = [
  { name: "From above", across: 0, up: 1, along: 2 },
  { name: "From the front", across: 0, up: 2, along: 1 },
  { name: "From the side", across: 1, up: 2, along: 0 },
];

/** Index lists of a sweep's points that a view shows: walls on edge only, surfaces that face the viewer would cover all. */
function onEdge(sweep, along) {
  const flat = sweep.normals.map((normal) => Math.abs(normal[along]) > 0.9);
  return sweep.face.map((face, i) => (face >= 0 ? !flat[face] : sweep.normals.length === 0) && i).filter((i) => i !== false);
}

function planBounds() {
  const points = room
    ? [...room.markers.map((marker) => marker.p), ...room.planes.flatMap((plane) => plane.outline)]
    : sweeps.flatMap((sensor) => {
        const at = sensor.sweep.points_mm;
        return [...Array(Math.floor(at.length / 90)).keys()].map((i) => [0, 1, 2].map((k) => at[90 * i + k] / 1000));
      });
  return {
    low: [0, 1, 2].map((k) => Math.min(...points.map((q) => q[k])) - 0.2),
    high: [0, 1, 2].map((k) => Math.max(...points.map((q) => q[k])) + 0.2),
  };
}

class PlanView {
  constructor(view, bounds) {
    const low = bounds.low.map((v, k) => (k === view.up ? v - measureRoom_m : v));
    Object.assign(this, { ...view, bounds: { low, high: bounds.high } });
    this.canvas = element("canvas", { role: "img", "aria-label": `sweeps in the room, ${view.name.toLowerCase()}` });
    this.lists = sweeps.map((sensor) => onEdge(sensor.sweep, view.along));
    const size = (k) => bounds.high[k] - low[k];
    this.aspect = size(view.across) / size(view.up);
    this.node = element(
      "figure",
      { style: `--aspect:${this.aspect.toFixed(4)}` },
      element(
        "figcaption",
        {},
        element("b", {}, view.name),
        element("span", {}, `${"xyz"[view.across]} to the right, ${"xyz"[view.up]} up`),
      ),
      element("div", { class: "frame", style: `aspect-ratio:${this.aspect}` }, this.canvas),
    );
    keepDrawn(this.canvas, () => this.draw());
  }

  draw() {
    const { g, width, height } = freshCanvas(this.canvas),
      { low, high } = this.bounds,
      { across, up } = this;
    const scale = Math.min(width / (high[across] - low[across]), height / (high[up] - low[up]));
    this.place = (q) => [(q[across] - low[across]) * scale, height - (q[up] - low[up]) * scale];
    this.drawRoom(g);
    for (let turn = 0; turn < 8; ++turn)
      sweeps.forEach((sensor, i) =>
        this.drawSweep(
          g,
          sensor,
          this.lists[i].filter((_, j) => j % 8 === turn),
        ),
      ); // none lies on all others
    this.drawSensors(g);
    this.drawMeasure(g, scale, width, height);
  }

  drawRoom(g) {
    if (!room) return;
    g.strokeStyle = themeColour("--rule");
    g.lineWidth = 1;
    for (const { from, to } of room.lines) {
      g.beginPath();
      g.moveTo(...this.place(from));
      g.lineTo(...this.place(to));
      g.stroke();
    }
  }

  drawSweep(g, sensor, list) {
    const at = sensor.sweep.points_mm;
    g.fillStyle = themeColour(colourName(sensor));
    g.globalAlpha = 0.55;
    for (const i of list) {
      const [x, y] = this.place([at[3 * i] / 1000, at[3 * i + 1] / 1000, at[3 * i + 2] / 1000]);
      g.fillRect(x - 0.7, y - 0.7, 1.4, 1.4);
    }
    g.globalAlpha = 1;
  }

  drawSensors(g) {
    for (const sensor of sensors.filter((one) => one.located)) {
      const [x, y] = this.place(matrix.translation(sensor.T_scene));
      g.fillStyle = themeColour(colourName(sensor));
      g.strokeStyle = themeColour("--card");
      g.lineWidth = 1.5;
      g.beginPath();
      if (sensor.camera) g.arc(x, y, 3.2, 0, 2 * Math.PI);
      else g.rect(x - 4.5, y - 4.5, 9, 9);
      g.fill();
      g.stroke();
    }
  }

  drawMeasure(g, scale, width, height) {
    const x = width - 12 - scale,
      y = height - 3;
    g.strokeStyle = g.fillStyle = themeColour("--ink");
    g.lineWidth = 1.5;
    g.beginPath();
    g.moveTo(x, y - 4);
    g.lineTo(x, y);
    g.lineTo(x + scale, y);
    g.lineTo(x + scale, y - 4);
    g.stroke();
    g.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    g.textAlign = "center";
    g.fillText("1 m", x + scale / 2, y - 6);
  }
}

function planSection() {
  if (!sweeps.length || !inRoom) return null;
  const bounds = planBounds(),
    views = planViews.map((view) => new PlanView(view, bounds));
  const key = element(
    "div",
    { class: "legend-line" },
    ...sweeps.map((sensor) => element("span", {}, dot(sensor), sensor.name)),
    element("span", {}, element("i", { class: "square" }), "LiDAR"),
    element("span", {}, element("i", { class: "round" }), "camera"),
  );
  return section(
    sweeps.length > 1 ? "Sweeps laid over each other" : "The sweep in the room",
    sweeps.length > 1
      ? "Each LiDAR\u2019s points in the room by its own extrinsics; surfaces on edge only. Where the LiDARs agree a wall is one line."
      : "The LiDAR\u2019s points in the room by its extrinsics; surfaces on edge only. The grey lines are the map\u2019s edges.",
    key,
    element("div", { class: "plans" }, ...views.map((view) => view.node)),
  );
}
