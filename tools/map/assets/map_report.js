"use strict";

// The page of `roomcal map info --report`: a room map, and what its bake knew if it was given.

const data = JSON.parse(document.getElementById("data").textContent);
const { map, markers, planes } = data;
const bake = data.bake || {};
const statistics = new Map((bake.marker || []).map((m) => [m.id, m]));
const planeColours = ["#4c78a8", "#c2703d", "#54a24b", "#b279a2", "#9d8a3c", "#72b7b2", "#d67195", "#7f8790"];

const rows = markers.map((m) => ({ ...m, key: m.id, ...pickStatistics(statistics.get(m.id)) }));

function pickStatistics(s) {
  if (!s) return {};
  return { held_out_mm: s.held_out_mm, rms_px: s.rms_px, sightings: s.sightings };
}

// What the discs can be coloured by.
const scales = [
  { name: "Uncertainty", unit: "mm", of: (r) => r.sigma_mm, what: "1\u03c3 along the marker's worst axis" },
  { name: "Held-out error", unit: "mm", of: (r) => r.held_out_mm, what: "where two halves of the survey put it" },
  { name: "Residual", unit: "px", of: (r) => r.rms_px, what: "RMS reprojection error" },
  { name: "Sightings", unit: "", of: (r) => r.sightings, what: "images that measured it", more: true },
].filter((scale) => rows.some((r) => scale.of(r) > 0));
scales.push({ name: "Plane", what: "walls and floor, largest first" });

// An imported map often claims one uncertainty for all: that is a number, not a picture.
const varies = (candidate) => {
  const values = candidate.of ? rows.map(candidate.of).filter((v) => Number.isFinite(v)) : [];
  return values.length > 1 && Math.max(...values) > 1.001 * Math.min(...values);
};
const firstScale = Math.max(
  0,
  scales.findIndex((candidate) => varies(candidate) || !candidate.of),
);

let scale = scales[firstScale];
let range = [0, 1];
let stops = [];

function chooseScale(index) {
  scale = scales[index];
  if (!scale.of) return;
  const values = rows.map(scale.of).filter((v) => Number.isFinite(v));
  range = [scale.more ? Math.min(...values) : 0, Math.max(...values)];
  if (range[1] <= range[0]) range[1] = range[0] + 1;
}

function colourOf(row) {
  if (!scale.of) return row.plane < 0 ? "#8a8f94" : planeColours[row.plane % planeColours.length];
  const value = scale.of(row);
  if (!Number.isFinite(value)) return "#8a8f94";
  const share = (value - range[0]) / (range[1] - range[0]);
  return rampColour(scale.more ? 1 - share : share, stops);
}

const tipOf = (row) =>
  [
    `marker ${row.id}`,
    `${row.p.map((v) => v.toFixed(3)).join("  ")} m`,
    row.sigma_mm > 0 ? `uncertainty ${figure(row.sigma_mm)} mm` : "claims to be exact",
    Number.isFinite(row.held_out_mm) ? `held out ${figure(row.held_out_mm)} mm` : null,
    Number.isFinite(row.sightings) ? `${row.sightings} sightings, ${figure(row.rms_px)} px` : null,
  ]
    .filter(Boolean)
    .join("\n");

function buildScene(canvas, tip) {
  const scene = new Scene(canvas, tip);
  planes.forEach((plane) => {
    if (plane.outline.length > 2) scene.add({ kind: "polygon", points: plane.outline, normal: plane.normal, layer: "planes" });
  });
  for (const line of data.lines)
    scene.add({ kind: "line", points: [line.from, line.to], colour: () => scene.colour("--accent"), width: 1, layer: "edges" });
  for (const corner of data.corners)
    scene.add({
      kind: "point",
      at: corner,
      colour: () => scene.colour("--accent"),
      size: 3,
      layer: "edges",
      tip: `corner\n${corner.map((v) => v.toFixed(3)).join("  ")} m`,
    });
  const stem = 0.6 * (map.spacing_m ? map.spacing_m.median : 0.2);
  for (const row of rows) {
    const radius = row.r || 0.2 * (map.spacing_m ? map.spacing_m.median : 0.2);
    if (row.n)
      scene.add({
        kind: "disc",
        at: row.p,
        normal: row.n,
        radius,
        stem,
        colour: () => colourOf(row),
        layer: "markers",
        tip: () => tipOf(row),
        key: row.id,
      });
    else
      scene.add({
        kind: "point",
        at: row.p,
        size: 4,
        colour: () => colourOf(row),
        layer: "markers",
        tip: () => tipOf(row),
        key: row.id,
      });
  }
  if (data.path.length > 1) {
    scene.add({
      kind: "line",
      points: data.path.map((v) => v.at),
      colour: () => scene.colour("--soft"),
      width: 1.2,
      dash: [4, 3],
      layer: "path",
    });
    data.path.forEach((v, i) =>
      scene.add({
        kind: "point",
        at: v.at,
        size: i === 0 ? 5 : 2.2,
        colour: () => scene.colour("--soft"),
        layer: "path",
        tip: v.name + (i === 0 ? "\nthe survey began here" : ""),
      }),
    );
  }
  for (const look of data.looks) {
    const colour = () => scene.colour(look.located ? "--ramp-0" : "--ramp-3");
    const tip = `a look with ${look.markers} markers\n${look.located ? `located to ${figure(look.sigma_mm)} mm` : "not located"}`;
    scene.add({ kind: "line", points: [look.at, vec.add(look.at, look.along, 0.18)], colour, width: 1.6, layer: "looks" });
    scene.add({ kind: "point", at: vec.add(look.at, look.along, 0.18), size: 2.6, colour, layer: "looks", tip });
  }
  scene.hidden.add("looks");
  return scene;
}

function legendOf() {
  const legend = element("div", { class: "legend" });
  legend.update = () => {
    legend.replaceChildren(element("strong", {}, scale.name), element("span", {}, scale.what));
    if (!scale.of) {
      planes.forEach((plane, i) =>
        legend.append(
          element(
            "span",
            { class: "row" },
            element("span", { class: "swatch", style: `background:${planeColours[i % planeColours.length]}` }),
            `plane ${i}: ${plane.markers} markers`,
          ),
        ),
      );
      return;
    }
    const ends = scale.more ? [...stops].reverse() : stops,
      [low, high] = range;
    legend.append(
      element("div", { class: "bar", style: `margin-top:6px;background:linear-gradient(to right, ${ends.join(", ")})` }),
      element(
        "div",
        { class: "ticks" },
        ...[low, (low + high) / 2, high].map((v, i) =>
          element("span", {}, figure(v) + (i === 2 && scale.unit ? ` ${scale.unit}` : "")),
        ),
      ),
      element("span", { class: "row" }, `median ${figure(quantile(rows.map(scale.of), 0.5))} ${scale.unit}`),
    );
  };
  return legend;
}

function toolbar(scene, legend) {
  const layers = [
    ["planes", "Planes", planes.length],
    ["normals", "Normals", rows.some((r) => r.n)],
    ["edges", "Edges, corners", data.lines.length + data.corners.length],
    ["path", "Survey path", data.path.length > 1],
    ["looks", "Sample looks", data.looks.length],
    ["grid", "1 m grid", true],
  ].filter((layer) => layer[2]);
  const toggles = layers.map(([key, name]) =>
    element(
      "label",
      {},
      element("input", {
        type: "checkbox",
        checked: !scene.hidden.has(key),
        onchange: (e) => {
          if (e.target.checked) scene.hidden.delete(key);
          else scene.hidden.add(key);
          scene.schedule();
        },
      }),
      name,
    ),
  );
  const choice = element(
    "select",
    {
      "aria-label": "Colour by",
      id: "scale",
      onchange: (e) => {
        chooseScale(Number(e.target.value));
        legend.update();
        repaintDots();
        scene.schedule();
      },
    },
    ...scales.map((s, i) => element("option", { value: i, selected: i === firstScale }, `Colour: ${s.name.toLowerCase()}`)),
  );
  const look = (yaw, pitch) => () => {
    scene.camera.reset();
    if (yaw !== null) Object.assign(scene.camera, { yaw, pitch });
    scene.schedule();
  };
  return element(
    "div",
    { class: "tools" },
    choice,
    ...toggles,
    element("button", { type: "button", onclick: look(null) }, "Whole room"),
    element("button", { type: "button", onclick: look(-Math.PI / 2, Math.PI / 2) }, "From above"),
  );
}

function repaintDots() {
  for (const row of rows) if (row.dot) row.dot.style.background = colourOf(row);
}

function summary() {
  const sigma = rows.map((r) => r.sigma_mm),
    exact = Math.max(...sigma) === 0;
  const size = map.extent_m.max.map((v, k) => (v - map.extent_m.min[k]).toFixed(1));
  const error = bake.error_mm || {},
    reprojection = bake.reprojection || {},
    unique = map.uniqueness,
    coverage = map.quality.coverage;
  return facts([
    [map.markers, "", "markers"],
    [planes.length, "", `planes, worst RMS ${figure(1e3 * Math.max(0, ...planes.map((p) => p.rms_m)))} mm`],
    [size.join(" \u00d7 "), "m", "extent of the markers"],
    exact
      ? ["exact", "", "no uncertainty in the map"]
      : [
          figure(quantile(sigma, 0.5)),
          "mm",
          varies(scales[0]) ? `uncertainty, median; worst ${figure(Math.max(...sigma))}` : "uncertainty, the same for all",
        ],
    Number.isFinite(error.held_out_rms) && [
      figure(error.held_out_rms),
      "mm",
      `held-out error, RMS; expected ${figure(error.expected_rms)}`,
    ],
    reprojection.median_px && [
      reprojection.median_px.map((v) => figure(v)).join(" / "),
      "px",
      "reprojection, median, left / right",
    ],
    unique && [figure(unique.worst_mm), "mm", `between the two most similar places; median ${figure(unique.median_mm)}`],
    map.spacing_m && [figure(1e3 * map.spacing_m.median), "mm", "to the next marker, median"],
    data.looks.length && [Math.round(100 * coverage.located_share), "%", `of ${coverage.views} sample looks find their place`],
    data.looks.length && [
      figure(coverage.median_sigma_mm),
      "mm",
      `a camera's place, 1\u03c3, median; ${figure(coverage.median_sigma_deg)}\u00b0`,
    ],
  ]);
}

function adviceSection() {
  if (!data.advice.length) return null;
  return element(
    "section",
    {},
    element("h2", {}, "Advice"),
    element("ul", { class: "advice" }, ...data.advice.map((a) => element("li", {}, a))),
  );
}

function spreadSection() {
  const shown = scales[firstScale];
  if (!shown.of) return null;
  return element(
    "div",
    {},
    element("h2", {}, `${shown.name} of the markers`),
    histogram(
      rows.map(shown.of).filter((v) => Number.isFinite(v)),
      shown.unit,
    ),
  );
}

function build() {
  const canvas = element("canvas", {
    role: "img",
    "aria-label": "The room in 3-D: drag to turn, wheel to zoom, arrow keys to turn",
  });
  const tip = element("div", { class: "tip" }),
    legend = legendOf();
  const scene = buildScene(canvas, tip);
  const choose = (key, scroll) => {
    scene.chosen = key;
    table.choose(key, scroll);
    scene.schedule();
  };
  const table = markerTable((key) => choose(key, false));
  scene.onPick = (key) => choose(key, true);
  const theme = () => {
    stops = [0, 1, 2, 3].map((i) => scene.colour(`--ramp-${i}`));
    legend.update();
    repaintDots();
  };
  chooseScale(firstScale);
  theme();
  document.addEventListener("themechange", theme);
  const made = map.created_unix_s ? `, made ${new Date(1e3 * map.created_unix_s).toISOString().slice(0, 10)}` : "";
  const spread = spreadSection();
  document
    .getElementById("page")
    .append(
      element("header", {}, element("h1", {}, `Room map ${map.id}`), element("p", {}, `${map.provenance}${made}`), themeButton()),
      summary(),
      element(
        "div",
        { class: "view" },
        canvas,
        toolbar(scene, legend),
        legend,
        tip,
        element("p", { class: "hint" }, "Drag turns, wheel zooms, shift-drag moves; click a marker"),
      ),
      adviceSection() || "",
      element(
        "section",
        { class: spread ? "columns" : null },
        element("div", {}, element("h2", {}, "Planes"), planeTable()),
        spread,
      ),
      element("section", {}, element("h2", {}, "Markers"), table.node),
      element(
        "footer",
        {},
        `Content ${map.content_crc32c}, ${map.bytes} bytes, ${map.triangles} triangles. Written by roomcal; this page needs no network.`,
      ),
    );
  scene.frame([...rows.map((r) => r.p), ...planes.flatMap((p) => p.outline), ...data.corners]);
  scene.draw();
  window.roomcal = { scene, table, rows };
}

build();
