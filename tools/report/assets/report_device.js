"use strict";

// The device close up: sensors where they were found, and how far each may be off, as ellipsoids enlarged by a factor.

const ellipsoidShare = 0.13,
  neighbourShare = 0.55; // of a kind's largest in the picture, and of the way to the next sensor: seen, and not in the way

/** Eigenvalues and vectors (rows) of a symmetric 3 x 3 matrix, by Jacobi rotations. */
function eigen3(symmetric) {
  const A = symmetric.map((row) => row.slice()),
    V = [
      [1, 0, 0],
      [0, 1, 0],
      [0, 0, 1],
    ];
  for (let sweep = 0; sweep < 12; ++sweep) {
    for (const [p, q] of [
      [0, 1],
      [0, 2],
      [1, 2],
    ]) {
      if (A[p][q] === 0) continue;
      const angle = 0.5 * Math.atan2(2 * A[p][q], A[q][q] - A[p][p]),
        c = Math.cos(angle),
        s = Math.sin(angle);
      for (let k = 0; k < 3; ++k) [A[k][p], A[k][q]] = [c * A[k][p] - s * A[k][q], s * A[k][p] + c * A[k][q]];
      for (let k = 0; k < 3; ++k) [A[p][k], A[q][k]] = [c * A[p][k] - s * A[q][k], s * A[p][k] + c * A[q][k]];
      for (let k = 0; k < 3; ++k) [V[p][k], V[q][k]] = [c * V[p][k] - s * V[q][k], s * V[p][k] + c * V[q][k]];
    }
  }
  return [0, 1, 2].map((k) => ({ value: A[k][k], vector: V[k] }));
}

/** Principal axes of a sensor's position: [{ sigma m, vector in the scene }], or none where nothing is claimed. */
function positionAxes(sensor) {
  if (!sensor.T_scene || !sensor.sigma || sensor.reference) return [];
  return eigen3([0, 1, 2].map((r) => sensor.told.covariance[r].slice(0, 3)))
    .map(({ value, vector }) => ({ sigma: Math.sqrt(Math.max(0, value)), vector: matrix.direction(sensor.T_scene, vector) }))
    .sort((a, b) => b.sigma - a.sigma);
}

/** From a sensor to the nearest other one, m. */
function toNeighbour(sensor) {
  const at = matrix.translation(sensor.T_scene);
  return Math.min(
    ...sensors
      .filter((other) => other.located && other !== sensor)
      .map((other) => Math.hypot(...vec.sub(at, matrix.translation(other.T_scene)))),
  );
}

/** One factor a kind: LiDARs may be off by much more than cameras. */
function ellipsoidFactors(reach_m) {
  const factor = (list) => {
    const sigma = Math.max(0, ...list.flatMap((sensor) => positionAxes(sensor).map((axis) => axis.sigma)));
    const apart = quantile(list.filter((sensor) => sensor.located).map(toNeighbour), 0.5);
    return sigma > 0
      ? Math.max(1, roundStep(Math.min(ellipsoidShare * reach_m, neighbourShare * (apart || reach_m)) / sigma))
      : null;
  };
  return { cameras: factor(cameras), lidars: factor(lidars) };
}

/** Outline as the eye sees it, and the three ellipses through its axes. */
function ellipsoidParts(scene, sensor, axes, factor) {
  const at = matrix.translation(sensor.T_scene),
    colour = scene.colour(colourName(sensor)),
    arms = axes.map(({ sigma, vector }) => vector.map((v) => v * Math.max(sigma * factor, 1e-5)));
  const point = (weights) => weights.reduce((sum, weight, k) => vec.add(sum, arms[k], weight), at);
  const circle = (u, v) =>
    [...Array(49).keys()].map((i) => {
      const c = Math.cos((i * Math.PI) / 24),
        s = Math.sin((i * Math.PI) / 24);
      return point([0, 1, 2].map((k) => c * u[k] + s * v[k]));
    });
  // On the unit sphere that the axes stretch, the outline is the great circle square to the stretched way to the eye.
  const to_eye = vec.unit(arms.map((arm) => vec.dot(arm, vec.sub(scene.eye, at)) / vec.dot(arm, arm)));
  const side = vec.unit(vec.cross(to_eye, Math.abs(to_eye[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0])),
    unit = [
      [1, 0, 0],
      [0, 1, 0],
      [0, 0, 1],
    ];
  return [
    { kind: "patch", points: circle(side, vec.cross(to_eye, side)), colour, alpha: 0.2, width: 1.2 },
    ...[
      [0, 1],
      [0, 2],
      [1, 2],
    ].map(([a, b]) => ({ kind: "line", points: circle(unit[a], unit[b]), colour, width: 0.8, alpha: 0.45 })),
  ];
}

function addEllipsoid(scene, sensor, factors) {
  const axes = positionAxes(sensor),
    factor = sensor.camera ? factors.cameras : factors.lidars;
  if (!axes.length || !factor) return;
  const at = matrix.translation(sensor.T_scene);
  scene.add({ kind: "group", at, layer: "ellipsoids", parts: () => ellipsoidParts(scene, sensor, axes, factor) });
}

/** Where a sensor's drawing reaches. */
function glyphPoints(scene, sensor) {
  const length = glyphLength(scene),
    tips = sensor.outline.map((bearing) => pointAlong(sensor, bearing, length));
  return [
    matrix.translation(sensor.T_scene),
    ...tips,
    ...[0, 1, 2].map((k) =>
      pointAlong(
        sensor,
        [0, 1, 2].map((j) => (j === k ? 0.7 : 0)),
        length,
      ),
    ),
  ];
}

/** A box about the sensors, no smaller than a hand. */
function deviceBox() {
  const at = sensors.filter((sensor) => sensor.located).map((sensor) => matrix.translation(sensor.T_scene));
  if (!at.length) return [];
  const low = [0, 1, 2].map((k) => Math.min(...at.map((q) => q[k])) - 0.035),
    high = [0, 1, 2].map((k) => Math.max(...at.map((q) => q[k])) + 0.035);
  return [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [0, 1, 2].map((k) => (i & (1 << k) ? high[k] : low[k])));
}

function deviceLegend(factors) {
  const times = (kind, factor) => factor && element("span", { class: "row" }, `${kind} \u00d7\u2009${factor}`);
  const shown = [times("cameras", factors.cameras), times("LiDARs", factors.lidars)].filter(Boolean);
  if (!shown.length) return null;
  return element(
    "div",
    { class: "legend" },
    element("strong", {}, "1\u03c3 ellipsoids of position"),
    element("span", {}, `relative to ${result.rig_frame}, enlarged:`),
    ...shown,
  );
}

/** The close-up, or null where no sensor was located. */
function deviceView(choose) {
  const located = sensors.filter((sensor) => sensor.located);
  if (!located.length) return null;
  const canvas = element("canvas", {
      role: "img",
      "aria-label": "The device in 3-D: drag to turn, wheel to zoom, arrow keys to turn",
    }),
    tip = element("div", { class: "tip" });
  const scene = new Scene(canvas, tip),
    box = deviceBox();
  const factors = ellipsoidFactors(Math.hypot(...vec.sub(box[7], box[0])) / 2),
    legend = deviceLegend(factors);
  scene.hidden.add("grid");
  located.forEach((sensor) => addEllipsoid(scene, sensor, factors));
  located.forEach((sensor) => addSensor(scene, sensor));
  scene.onPick = (key) => choose(key, true);
  const layer = (key, name) =>
    toggle(name, true, (on) => {
      if (on) scene.hidden.delete(key);
      else scene.hidden.add(key);
      scene.schedule();
    });
  const tools = element(
    "div",
    { class: "tools" },
    legend && layer("ellipsoids", "Uncertainty"),
    layer("sensors", "Sensors"),
    element(
      "button",
      {
        type: "button",
        onclick: () => {
          scene.camera.reset();
          scene.schedule();
        },
      },
      "Whole",
    ),
  );
  const start = () => {
    scene.frame(box);
    for (let round = 0; round < 4; ++round) scene.fit(located.flatMap((sensor) => glyphPoints(scene, sensor))); // glyphs shrink as the eye comes near
    scene.draw();
  };
  return { scene, start, node: element("div", { class: "view device" }, tools, canvas, legend, tip) };
}
