"use strict";

// What is left uncertain: correlations of the extrinsics, and deviations measured in sigmas.

/** The whole joint matrix where the result has it, else every sensor by itself. */
function covarianceBlocks() {
  const joint = result.joint_covariance;
  if (joint) return { owners: joint.sensors, at: (i, j) => joint.matrix[i][j] };
  const owners = sensors.filter((sensor) => sensor.T_rig && !sensor.reference).map((sensor) => sensor.name);
  const at = (i, j) =>
    Math.floor(i / 6) === Math.floor(j / 6) ? result.sensors[owners[Math.floor(i / 6)]].covariance[i % 6][j % 6] : null;
  return { owners, at };
}

const labelRoom = { left: 74, top: 26 }; // px, of the names beside the squares

/** A square for every pair of components, and what it says when pointed at. */
function correlationCells({ owners, at }, cell) {
  const n = 6 * owners.length,
    label = (i) => `${owners[Math.floor(i / 6)]} ${axisNames[i % 6]}`;
  const fill = (share) =>
    `fill:color-mix(in srgb, var(${share < 0 ? "--minus" : "--plus"}) ${Math.round(100 * Math.min(1, Math.abs(share)))}%, var(--card))`;
  const one = (i, j) => {
    if (at(i, j) === null) return null;
    const share = at(i, j) / Math.sqrt(at(i, i) * at(j, j)),
      side = cell - 0.6;
    return svg("rect", {
      x: labelRoom.left + j * cell,
      y: labelRoom.top + i * cell,
      width: side,
      height: side,
      style: fill(share),
      "data-tip": `${label(i)} with ${label(j)}\n${share.toFixed(2)}`,
    });
  };
  return [...Array(n * n).keys()].map((k) => one(Math.floor(k / n), k % n)).filter(Boolean);
}

/** A sensor's name above and beside its squares, and their frame. */
function correlationNames(owners, cell, small) {
  const { left, top } = labelRoom;
  return owners.flatMap((name, b) => {
    const look = { style: `fill:${cssColour(sensorOf.get(name))}`, class: "name" },
      middle = (6 * b + 3) * cell;
    return [
      svg("text", { x: left + middle, y: 16, "text-anchor": "middle", ...look }, name),
      svg("text", { x: small ? left - 8 : 2, y: top + middle + 4, "text-anchor": small ? "end" : "start", ...look }, name),
      svg("rect", {
        x: left + 6 * b * cell - 0.3,
        y: top + 6 * b * cell - 0.3,
        width: 6 * cell,
        height: 6 * cell,
        class: "frame",
      }),
    ];
  });
}

function correlationMap() {
  const blocks = covarianceBlocks(),
    n = 6 * blocks.owners.length;
  if (!n) return null;
  const cell = Math.max(11, Math.min(30, 620 / n)),
    small = cell < 17,
    width = labelRoom.left + n * cell + 4,
    height = labelRoom.top + n * cell + 4;
  const axes = small
    ? []
    : [...Array(n).keys()].map((i) =>
        svg(
          "text",
          { x: labelRoom.left - 6, y: labelRoom.top + (i + 0.68) * cell, "text-anchor": "end", class: "fine" },
          axisNames[i % 6],
        ),
      );
  const picture = svg(
    "svg",
    {
      viewBox: `0 0 ${width} ${height}`,
      class: "correlation",
      style: `max-width:${width}px`,
      role: "img",
      "aria-label": "correlations of the extrinsics",
    },
    ...correlationCells(blocks, cell),
    ...axes,
    ...correlationNames(blocks.owners, cell, small),
  );
  tipOn(picture, (event) => event.target.getAttribute("data-tip"));
  return picture;
}

function correlationSection() {
  const picture = correlationMap();
  if (!picture) return null;
  const lead =
    `What is left uncertain of T_${result.rig_frame}_sensor: position x y z and rotation rx ry rz, each in the sensor\u2019s own axes (a right perturbation). Squares: correlations. Table: one sigma.` +
    (result.joint_covariance ? "" : " Correlations between sensors: `roomcal calibrate --detail` tells them.");
  const key = element(
    "div",
    { class: "key" },
    ...colourBar(["var(--minus)", "var(--card)", "var(--plus)"], ["\u22121", "0", "+1"]),
  );
  return section("Covariance", lead, element("div", { class: "heat" }, element("div", {}, picture, key), sigmaTable()));
}

/** Six deviations in sigmas over bands of one and three sigma. */
function pulls(change) {
  const width = 216,
    height = 46,
    middle = 19,
    scale = 4.6,
    clip = 3.8;
  const dots = change.delta.map((delta, k) => {
    const pull = delta / Math.sqrt(change.covariance[k][k]),
      at = Math.max(-clip, Math.min(clip, pull)),
      x = 18 + k * 36;
    return svg(
      "g",
      {
        "data-tip": `${axisNames[k]}: ${figure(k < 3 ? 1e3 * delta : degrees(delta))} ${k < 3 ? "mm" : "\u00b0"}, ${pull.toFixed(1)} \u03c3`,
      },
      svg("rect", { x: x - 18, y: 0, width: 36, height, fill: "transparent" }),
      svg("line", { x1: x, x2: x, y1: middle, y2: middle - at * scale, class: "stalk" }),
      svg("circle", { cx: x, cy: middle - at * scale, r: 3.4, class: Math.abs(pull) > 3 ? "far" : null }),
      svg("text", { x, y: height - 1, "text-anchor": "middle" }, axisNames[k]),
    );
  });
  const picture = svg(
    "svg",
    { viewBox: `0 0 ${width} ${height}`, class: "pulls", role: "img", "aria-label": "deviations in sigmas" },
    svg("rect", { x: 0, width, y: middle - 3 * scale, height: 6 * scale, class: "three" }),
    svg("rect", { x: 0, width, y: middle - scale, height: 2 * scale, class: "one" }),
    ...dots,
  );
  tipOn(picture, (event) => {
    const group = event.target.closest("[data-tip]");
    return group && group.getAttribute("data-tip");
  });
  return picture;
}
