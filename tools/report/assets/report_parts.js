"use strict";

// What the parts of a calibration's page share: the data as sensors, matrices, SVG, colours, a tip that follows the mouse.

const data = JSON.parse(document.getElementById("data").textContent);
const result = data.result;

const names = Object.keys(result.sensors).sort((a, b) => {
  const kind = (name) => (result.sensors[name].kind === "lidar" ? 1 : 0);
  return kind(a) - kind(b) || a.localeCompare(b, "en", { numeric: true });
});

const degrees = (rad) => (rad * 180) / Math.PI;
const finite = (value) => typeof value === "number" && Number.isFinite(value);

const matrix = {
  multiply: (A, B) => A.map((row) => B[0].map((_, c) => row.reduce((sum, a, k) => sum + a * B[k][c], 0))),
  /** Of a rigid transform. */
  inverse: (T) => {
    const R = [0, 1, 2].map((r) => [0, 1, 2].map((c) => T[c][r]));
    const t = R.map((row) => -row.reduce((sum, a, k) => sum + a * T[k][3], 0));
    return [...R.map((row, r) => [...row, t[r]]), [0, 0, 0, 1]];
  },
  point: (T, p) => [0, 1, 2].map((r) => T[r][0] * p[0] + T[r][1] * p[1] + T[r][2] * p[2] + T[r][3]),
  direction: (T, v) => [0, 1, 2].map((r) => T[r][0] * v[0] + T[r][1] * v[1] + T[r][2] * v[2]),
  /** Degrees about x, y, z with R = Rz Ry Rx. */
  angles: (T) =>
    [Math.atan2(T[2][1], T[2][2]), Math.asin(Math.max(-1, Math.min(1, -T[2][0]))), Math.atan2(T[1][0], T[0][0])].map(degrees),
  translation: (T) => [T[0][3], T[1][3], T[2][3]],
  turn: (T) => degrees(Math.acos(Math.max(-1, Math.min(1, (T[0][0] + T[1][1] + T[2][2] - 1) / 2)))),
};

/** Largest 1-sigma over the axes: { mm, deg }. */
function sigmasOf(covariance) {
  const sigma = covariance.map((row, i) => Math.sqrt(Math.max(0, row[i])));
  return { mm: 1e3 * Math.max(...sigma.slice(0, 3)), deg: degrees(Math.max(...sigma.slice(3))) };
}

// A result without places in the room (a stored record) is drawn about its reference camera, upright.
const inRoom = names.some((name) => result.sensors[name].T_room_sensor);
const upright = [
  [1, 0, 0, 0],
  [0, 0, 1, 0],
  [0, -1, 0, 0],
  [0, 0, 0, 1],
];

const sensors = names.map((name, number) => {
  const told = result.sensors[name],
    camera = told.kind !== "lidar";
  const T_scene = inRoom ? told.T_room_sensor : told.T_rig_sensor && matrix.multiply(upright, told.T_rig_sensor);
  return {
    key: name,
    name,
    number,
    told,
    camera,
    T_scene: T_scene || null,
    T_rig: told.T_rig_sensor || null,
    reference: name === result.rig_frame,
    located: told.located !== false && Boolean(T_scene),
    rings: told.rings || [],
    sigma: told.covariance ? sigmasOf(told.covariance) : null,
    outline: (data.outlines || {})[name] || [],
    picture: (data.pictures || {})[name],
    sweep: (data.sweeps || {})[name],
    projections: (data.projections || {})[name] || {},
  };
});
const sensorOf = new Map(sensors.map((sensor) => [sensor.name, sensor]));
const cameras = sensors.filter((sensor) => sensor.camera),
  lidars = sensors.filter((sensor) => !sensor.camera);
const room = inRoom ? data.room : null;
const markerOf = new Map((room ? room.markers : []).map((marker) => [marker.id, marker]));
const sweeps = lidars.filter((sensor) => sensor.sweep);

const used = (ring) => ring.marker !== undefined && Boolean(ring.predicted_px);
const residualOf = (ring) => [ring.predicted_px[0] - ring.x, ring.predicted_px[1] - ring.y];

const colourName = (sensor) => `--s${sensor.number % 12}`;
const cssColour = (sensor) => `var(${colourName(sensor)})`;
const themeColour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const dot = (sensor) => element("span", { class: "dot", style: `background:${cssColour(sensor)}` });
const named = (sensor) => element("span", {}, dot(sensor), sensor.name);

const svgName = "http://www.w3.org/2000/svg";
/** svg("rect", { x, y }, child, "text") */
function svg(tag, attributes = {}, ...children) {
  const node = document.createElementNS(svgName, tag);
  for (const [key, value] of Object.entries(attributes)) if (value !== null && value !== undefined) node.setAttribute(key, value);
  node.append(...children.filter((child) => child !== null && child !== undefined && child !== false));
  return node;
}

/** A tip beside the mouse while it is over `node`; textOf(event) says what, or null. */
const pageTip = element("div", { class: "tip page-tip" });
function tipOn(node, textOf) {
  node.addEventListener("pointermove", (event) => {
    const text = textOf(event);
    pageTip.style.display = text ? "block" : "none";
    if (!text) return;
    pageTip.textContent = text;
    pageTip.style.left = `${Math.min(event.clientX + 14, innerWidth - pageTip.offsetWidth - 8)}px`;
    pageTip.style.top = `${Math.min(event.clientY + 14, innerHeight - pageTip.offsetHeight - 8)}px`;
  });
  node.addEventListener("pointerleave", () => {
    pageTip.style.display = "none";
  });
}

function section(title, lead, ...content) {
  return element("section", {}, element("h2", {}, title), lead ? element("p", { class: "lead" }, lead) : null, ...content);
}

function toggle(name, on, change) {
  return element(
    "label",
    {},
    element("input", { type: "checkbox", checked: on, onchange: (event) => change(event.target.checked) }),
    name,
  );
}

/** options: [[value, text]] */
function choice(label, options, chosen, change) {
  return element(
    "select",
    { "aria-label": label, onchange: (event) => change(event.target.value) },
    ...options.map(([value, text]) => element("option", { value, selected: String(value) === String(chosen) }, text)),
  );
}

/** The canvas at the screen's own resolution, cleared, one unit a CSS pixel. */
function freshCanvas(canvas) {
  const ratio = window.devicePixelRatio || 1,
    width = canvas.clientWidth,
    height = canvas.clientHeight;
  canvas.width = Math.max(1, Math.round(width * ratio));
  canvas.height = Math.max(1, Math.round(height * ratio));
  const g = canvas.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  return { g, width, height };
}

/** Draws when it has been laid out, resized, or the theme has changed. */
function keepDrawn(canvas, draw) {
  new ResizeObserver(draw).observe(canvas);
  document.addEventListener("themechange", draw);
}

/** 1, 2 or 5 times a power of ten, not above `value`. */
function roundStep(value) {
  const power = 10 ** Math.floor(Math.log10(value)),
    lead = value / power;
  return power * (lead >= 5 ? 5 : lead >= 2 ? 2 : 1);
}

const distanceStops = () => [0, 1, 2, 3, 4].map((i) => themeColour(`--far-${i}`));
const residualStops = () => ["--minus", "--zero", "--plus"].map(themeColour);

/** A colour bar with its ends and middle. */
function colourBar(stops, ticks) {
  return [
    element("div", { class: "bar", style: `background:linear-gradient(to right, ${stops.join(", ")})` }),
    element("div", { class: "ticks" }, ...ticks.map((tick) => element("span", {}, tick))),
  ];
}

/** A p-value: two digits, or a power of ten. */
function probability(value) {
  if (!finite(value)) return "\u2013";
  if (value >= 1e-4) return value >= 0.995 ? "1.00" : value.toPrecision(2);
  const raised = [...String(-Math.floor(Math.log10(Math.max(value, 1e-300))))].map(
    (digit) => "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[digit],
  );
  return `10\u207b${raised.join("")}`;
}

/** 26 109: digits in threes. */
const grouped = (count) => String(count).replace(/\B(?=(\d{3})+$)/g, "\u2009");

const axisNames = ["x", "y", "z", "rx", "ry", "rz"];
