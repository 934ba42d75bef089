"use strict";

const vec = {
  add: (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]],
  sub: (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]],
  dot: (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
  cross: (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]],
  unit: (a) => {
    const n = Math.hypot(...a) || 1;
    return a.map((x) => x / n);
  },
};

// A 3-D scene on a 2-D canvas: things are polygons, discs, lines and points in room coordinates (metres, z up), painted
// far to near. Needs no graphics card. Used by every report: a map's markers, a shot's sensors as frusta.
//
//   const scene = new Scene(canvas);
//   scene.add({ kind: "disc", at, normal, radius, colour, layer, tip, key });
//   scene.add({ kind: "polygon", points, normal, fill, stroke, layer });   // faces turned away are left out
//   scene.add({ kind: "line", points, colour, width, layer, dash });
//   scene.add({ kind: "point", at, colour, size, layer, tip, key });
//   scene.add({ kind: "label", at, text, colour, layer });          // kept apart from each other, with a leader if need be
//   scene.add({ kind: "group", at, parts, layer });                 // parts() -> lines, asked on every draw
//   scene.add({ kind: "cloud", points_mm, face, normals, bins: [{ colour, list }], size, layer });  // flat x y z, mm
//   scene.add({ kind: "patch", points, colour, alpha, width, layer });  // filled, outlined, seen from either side
//   scene.frame(points); scene.draw();
//
// `colour` may be a function, asked on every draw. `onPick(key)` is told what was clicked. Keys: arrows turn, with shift
// they move, + and - zoom, Home resets.
class Scene {
  constructor(canvas, tip) {
    this.canvas = canvas;
    this.tip = tip;
    this.things = [];
    this.hidden = new Set();
    this.chosen = null;
    this.onPick = () => {};
    this.camera = new OrbitCamera([0, 0, 0], 1);
    this.floor = null;
    this.colours = {};
    canvas.tabIndex = 0;
    this.hands = new SceneHands(this);
    new ResizeObserver(() => this.schedule()).observe(canvas);
    document.addEventListener("themechange", () => {
      this.colours = {};
      this.schedule();
    });
  }

  add(thing) {
    this.things.push(thing);
  }

  /** Puts the camera so that all these points are seen. */
  frame(points) {
    const low = [0, 1, 2].map((k) => Math.min(...points.map((p) => p[k]))),
      high = [0, 1, 2].map((k) => Math.max(...points.map((p) => p[k])));
    const radius = Math.max(0.2, Math.hypot(...vec.sub(high, low)) / 2);
    this.camera = new OrbitCamera(
      low.map((v, k) => (v + high[k]) / 2),
      radius,
    );
    this.floor = { low, high };
    this.fit(points);
  }

  // Home: the picture of the points in the middle of the canvas, below a tool bar that lies on it, as large as it goes.
  fit(points) {
    const width = this.canvas.clientWidth || 800,
      height = this.canvas.clientHeight || 500,
      margin = 28;
    const bar = this.canvas.parentElement && this.canvas.parentElement.querySelector(".tools");
    const top = bar ? Math.max(margin, bar.offsetTop + bar.offsetHeight - this.canvas.offsetTop + 12) : margin;
    for (let round = 0; round < 6; ++round) {
      const at = points.map(this.camera.projector(width, height)),
        xs = at.map((p) => p[0]),
        ys = at.map((p) => p[1]);
      const left = Math.min(...xs),
        right = Math.max(...xs),
        up = Math.min(...ys),
        down = Math.max(...ys);
      this.camera.pan(
        width / 2 - (left + right) / 2,
        (top + height - margin) / 2 - (up + down) / 2,
        this.camera.focal(width, height),
      );
      this.camera.zoom(Math.max((right - left) / (width - 2 * margin), (down - up) / (height - top - margin)));
    }
    this.camera.keepHome();
  }

  /** A colour of the theme by its CSS name; asked for every thing, so kept until the theme changes. */
  colour(name) {
    this.colours[name] ||= getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    return this.colours[name];
  }

  schedule() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.draw();
    });
  }

  draw() {
    const ratio = window.devicePixelRatio || 1,
      width = this.canvas.clientWidth,
      height = this.canvas.clientHeight;
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    const g = this.canvas.getContext("2d");
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, width, height);
    this.project = this.camera.projector(width, height);
    this.eye = this.camera.position();
    this.ink = this.colour("--ink");
    this.targets = [];
    this.drawGrid(g);
    const seen = this.things.filter((t) => !this.hidden.has(t.layer)).map((t) => ({ thing: t, depth: this.depthOf(t) }));
    seen.sort((a, b) => b.depth - a.depth);
    this.labels = [];
    for (const { thing } of seen) this.paint(g, thing);
    paintLabels(this, g, this.labels);
    if (this.chosen !== null)
      this.things.filter((t) => t.key === this.chosen && !this.hidden.has(t.layer)).forEach((t) => this.paintChosen(g, t));
    this.drawAxes(g, height);
  }

  depthOf(thing) {
    if (thing.kind === "polygon") return 1e6 + this.project(thing.points[0])[2]; // walls are behind what hangs on them
    if (thing.kind === "label") return -1e6;
    if (thing.kind === "cloud") return 5e5; // before the walls, behind all else
    const points = thing.points || [thing.at];
    return points.reduce((sum, p) => sum + this.project(p)[2], 0) / points.length;
  }

  paint(g, thing) {
    const colour = typeof thing.colour === "function" ? thing.colour() : thing.colour || this.ink;
    if (thing.kind === "polygon") this.paintPolygon(g, thing);
    if (thing.kind === "patch") this.paintPatch(g, thing, colour);
    if (thing.kind === "disc") this.paintDisc(g, thing, colour);
    if (thing.kind === "line") this.paintLine(g, thing, colour);
    if (thing.kind === "point") this.paintPoint(g, thing, colour);
    if (thing.kind === "label") this.labels.push(thing);
    if (thing.kind === "group") thing.parts().forEach((part) => this.paint(g, part));
    if (thing.kind === "cloud") this.paintCloud(g, thing);
  }

  trace(g, points, close) {
    g.beginPath();
    let started = false;
    for (const point of points) {
      const [x, y, depth] = this.project(point);
      if (depth <= 0.01) {
        if (close) return false;
        started = false;
        continue;
      }
      if (started) g.lineTo(x, y);
      else g.moveTo(x, y);
      started = true;
    }
    if (close) g.closePath();
    return true;
  }

  paintPolygon(g, thing) {
    const away = vec.dot(thing.normal, vec.sub(this.eye, thing.points[0])) < 0;
    if (!this.trace(g, thing.points, true)) return;
    const rgb = this.colour("--plane");
    if (!away) {
      g.fillStyle = `rgba(${rgb}, 0.10)`;
      g.fill();
    }
    g.strokeStyle = `rgba(${rgb}, ${away ? 0.22 : 0.55})`;
    g.lineWidth = 1;
    g.stroke();
  }

  paintPatch(g, thing, colour) {
    if (!this.trace(g, thing.points, true)) return;
    g.globalAlpha = thing.alpha;
    g.fillStyle = g.strokeStyle = colour;
    g.fill();
    g.globalAlpha = 1;
    g.lineWidth = thing.width;
    g.stroke();
  }

  rim(thing) {
    if (!thing.rimPoints) {
      const n = vec.unit(thing.normal),
        u = vec.unit(vec.cross(n, Math.abs(n[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0])),
        v = vec.cross(n, u);
      thing.rimPoints = [...Array(24).keys()].map((i) => {
        const a = (i * Math.PI) / 12;
        return vec.add(vec.add(thing.at, u, thing.radius * Math.cos(a)), v, thing.radius * Math.sin(a));
      });
    }
    return thing.rimPoints;
  }

  paintDisc(g, thing, colour) {
    if (!this.trace(g, this.rim(thing), true)) return;
    const front = vec.dot(thing.normal, vec.sub(this.eye, thing.at)) > 0;
    g.globalAlpha = front ? 1 : 0.16; // seen through the wall it hangs on
    g.fillStyle = colour;
    g.fill();
    g.globalAlpha = 1;
    const [x, y, depth] = this.project(thing.at);
    if (depth <= 0.01) return;
    if (front && thing.stem && !this.hidden.has("normals")) {
      const [ex, ey] = this.project(vec.add(thing.at, thing.normal, thing.stem));
      g.beginPath();
      g.moveTo(x, y);
      g.lineTo(ex, ey);
      g.strokeStyle = colour;
      g.lineWidth = 1.1;
      g.stroke();
    }
    if (front) this.targets.push({ x, y, depth, thing });
  }

  paintLine(g, thing, colour) {
    this.trace(g, thing.points, false);
    g.strokeStyle = colour;
    g.globalAlpha = thing.alpha || 1;
    g.lineWidth = thing.width || 1;
    g.setLineDash(thing.dash || []);
    g.lineJoin = "round";
    g.stroke();
    g.setLineDash([]);
    g.globalAlpha = 1;
  }

  // Points of a surface that is seen from behind are left out, as its wall is. No array a point: there are ten thousands.
  paintCloud(g, { points_mm, face, normals, bins, size = 2 }) {
    const { right, up, back } = this.camera.axes(),
      [cx, cy, cz] = this.camera.centre,
      eye = this.eye;
    const width = this.canvas.clientWidth,
      height = this.canvas.clientHeight,
      focal = this.camera.focal(width, height);
    const turns = 8; // a part of every colour in turn: the last one painted would hide the others
    for (let turn = 0; turn < turns * bins.length; ++turn) {
      const { colour, list } = bins[turn % bins.length],
        first = Math.floor(turn / bins.length);
      g.fillStyle = colour;
      for (let j = first; j < list.length; j += turns) {
        const i = list[j];
        const px = points_mm[3 * i] / 1000,
          py = points_mm[3 * i + 1] / 1000,
          pz = points_mm[3 * i + 2] / 1000,
          n = normals[face[i]];
        if (n && n[0] * (eye[0] - px) + n[1] * (eye[1] - py) + n[2] * (eye[2] - pz) < 0) continue;
        const x = px - cx,
          y = py - cy,
          z = pz - cz,
          depth = this.camera.distance - (x * back[0] + y * back[1] + z * back[2]);
        if (depth <= 0.01) continue;
        const scale = focal / depth;
        g.fillRect(
          width / 2 + scale * (x * right[0] + y * right[1] + z * right[2]) - size / 2,
          height / 2 - scale * (x * up[0] + y * up[1] + z * up[2]) - size / 2,
          size,
          size,
        );
      }
    }
  }

  paintPoint(g, thing, colour) {
    const [x, y, depth] = this.project(thing.at);
    if (depth <= 0.01) return;
    g.beginPath();
    g.arc(x, y, thing.size || 3, 0, 2 * Math.PI);
    g.fillStyle = colour;
    g.fill();
    if (thing.tip) this.targets.push({ x, y, depth, thing });
  }

  paintChosen(g, thing) {
    const [x, y, depth] = this.project(thing.at);
    if (depth <= 0.01) return;
    const size = Math.max(
      9,
      (1.5 * (this.camera.focal(this.canvas.clientWidth, this.canvas.clientHeight) * (thing.radius || 0.05))) / depth,
    );
    g.beginPath();
    g.arc(x, y, size, 0, 2 * Math.PI);
    g.strokeStyle = this.ink;
    g.lineWidth = 2;
    g.stroke();
  }

  // A metre grid on the lowest level: gives the eye a floor and a measure.
  drawGrid(g) {
    if (!this.floor || this.hidden.has("grid")) return;
    const { low, high } = this.floor,
      z = low[2];
    const slack = 0.1,
      from = [Math.floor(low[0] + slack), Math.floor(low[1] + slack)],
      to = [Math.ceil(high[0] - slack), Math.ceil(high[1] - slack)];
    const step = Math.max(1, Math.ceil(Math.max(to[0] - from[0], to[1] - from[1]) / 40));
    g.strokeStyle = this.colour("--grid");
    g.lineWidth = 1;
    for (let x = from[0]; x <= to[0]; x += step) {
      this.trace(
        g,
        [
          [x, from[1], z],
          [x, to[1], z],
        ],
        false,
      );
      g.stroke();
    }
    for (let y = from[1]; y <= to[1]; y += step) {
      this.trace(
        g,
        [
          [from[0], y, z],
          [to[0], y, z],
        ],
        false,
      );
      g.stroke();
    }
  }

  drawAxes(g, height) {
    const { right, up } = this.camera.axes(),
      at = [44, height - 58],
      names = ["x", "y", "z"];
    g.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    g.fillStyle = g.strokeStyle = this.colour("--soft");
    g.lineWidth = 1.4;
    for (let k = 0; k < 3; ++k) {
      const tip = [at[0] + 22 * right[k], at[1] - 22 * up[k]];
      g.beginPath();
      g.moveTo(...at);
      g.lineTo(...tip);
      g.stroke();
      g.fillText(names[k], at[0] + 30 * right[k] - 3, at[1] - 30 * up[k] + 4);
    }
  }

  /** The nearest thing to the eye within reach of a place on the canvas. */
  pick(x, y) {
    let best = null;
    for (const target of this.targets || []) {
      const away = Math.hypot(target.x - x, target.y - y);
      const reach = Math.max(
        8,
        (this.camera.focal(this.canvas.clientWidth, this.canvas.clientHeight) * (target.thing.radius || 0)) / target.depth,
      );
      if (away <= reach && (!best || target.depth < best.depth)) best = target;
    }
    return best;
  }
}
