"use strict";

// Sensors as they are drawn in a scene: cameras as frusta, LiDARs as cans, both with their axes and the markers they used.

let chosenSensor = null;
const axisColours = ["#d8453e", "#3f9f4f", "#3d74d9"];

/** Length of a drawn frustum, m: a part of what is seen, so that it can be seen from anywhere. */
const glyphLength = (scene) => Math.max(0.025, Math.min(0.42, 0.075 * scene.camera.distance));

const pointAlong = (sensor, bearing, length) =>
  matrix.point(
    sensor.T_scene,
    bearing.map((v) => v * length),
  );

function drawFrustum(scene, sensor) {
  const length = glyphLength(scene),
    apex = matrix.translation(sensor.T_scene),
    rim = sensor.outline.map((bearing) => pointAlong(sensor, bearing, length));
  const colour = () => scene.colour(colourName(sensor));
  return [
    ...[0, 8, 16, 24].map((i) => ({ kind: "line", points: [apex, rim[i]], colour, width: 1.3 })),
    { kind: "line", points: [...rim, rim[0]], colour, width: 1.3 },
  ];
}

function drawAxes(scene, sensor) {
  const length = (sensor.camera ? 0.4 : 0.7) * glyphLength(scene),
    at = matrix.translation(sensor.T_scene);
  return [0, 1, 2].map((k) => ({
    kind: "line",
    points: [
      at,
      pointAlong(
        sensor,
        [0, 1, 2].map((j) => (j === k ? 1 : 0)),
        length,
      ),
    ],
    colour: axisColours[k],
    width: 1.8,
  }));
}

/** A LiDAR's can: two circles about its z axis. */
function drawCan(scene, sensor) {
  const r = 0.16 * glyphLength(scene),
    h = 0.12 * glyphLength(scene),
    colour = () => scene.colour(colourName(sensor));
  const circle = (z) =>
    [...Array(25).keys()].map((i) =>
      pointAlong(sensor, [Math.cos((i * Math.PI) / 12) * r, Math.sin((i * Math.PI) / 12) * r, z], 1),
    );
  return [-h, h].map((z) => ({ kind: "line", points: circle(z), colour, width: 1.6 }));
}

function sensorTip(sensor) {
  const told = sensor.told,
    lines = [`${sensor.name}${sensor.reference ? ", the rig\u2019s reference" : ""}`];
  if (sensor.T_rig)
    lines.push(
      `at ${matrix
        .translation(sensor.T_rig)
        .map((v) => fixed(1e3 * v, 2))
        .join("  ")} mm`,
    );
  if (sensor.sigma && !sensor.reference) lines.push(`\u03c3 ${figure(sensor.sigma.mm)} mm, ${fixed(sensor.sigma.deg, 4)}\u00b0`);
  if (finite(told.rms_px)) lines.push(`${told.inliers} rings, ${figure(told.rms_px)} px`);
  if (finite(told.rms_m)) lines.push(`${told.inliers} points, ${figure(1e3 * told.rms_m)} mm`);
  return lines.join("\n");
}

function addSensor(scene, sensor) {
  const at = matrix.translation(sensor.T_scene);
  scene.add({
    kind: "group",
    at,
    layer: "sensors",
    parts: () => [...(sensor.camera ? drawFrustum(scene, sensor) : drawCan(scene, sensor)), ...drawAxes(scene, sensor)],
  });
  scene.add({
    kind: "point",
    at,
    size: 4,
    colour: () => scene.colour(colourName(sensor)),
    layer: "sensors",
    tip: () => sensorTip(sensor),
    key: sensor.key,
  });
  scene.add({ kind: "label", at, text: sensor.name, colour: () => scene.colour(colourName(sensor)), layer: "sensors" });
  scene.add({
    kind: "group",
    at,
    layer: "sensors",
    parts: () =>
      chosenSensor === sensor.key
        ? sensor.rings
            .filter((ring) => used(ring) && markerOf.has(ring.marker))
            .map((ring) => ({
              kind: "line",
              points: [at, markerOf.get(ring.marker).p],
              colour: scene.colour(colourName(sensor)),
              width: 0.8,
              alpha: 0.6,
            }))
        : [],
  });
}
