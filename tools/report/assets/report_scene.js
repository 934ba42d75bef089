"use strict";

// The room in 3-D: markers, planes, sensors, sweeps coloured by residual; a chosen sensor shows its rays.

let sweepColour = "residual";

/** Largest residual of the colour scale, mm: three sigmas of the least accurate LiDAR. */
const residualReach = () => 3e3 * Math.max(...sweeps.map((sensor) => sensor.sweep.sigma_m), 1e-4);

/** Cameras that used each marker. */
function seenBy() {
  const seen = new Map();
  for (const sensor of cameras)
    for (const ring of sensor.rings.filter(used)) seen.set(ring.marker, [...(seen.get(ring.marker) || []), { sensor, ring }]);
  return seen;
}

function addRoom(scene) {
  if (!room) return;
  const seen = seenBy(),
    known = seen.size > 0;
  for (const plane of room.planes)
    if (plane.outline.length > 2) scene.add({ kind: "polygon", points: plane.outline, normal: plane.normal, layer: "planes" });
  for (const line of room.lines)
    scene.add({ kind: "line", points: [line.from, line.to], colour: () => scene.colour("--edge"), width: 1, layer: "planes" });
  for (const marker of room.markers) {
    const by = seen.get(marker.id) || [];
    const colour = () => {
      if (chosenSensor && by.some((one) => one.sensor.key === chosenSensor))
        return scene.colour(colourName(sensorOf.get(chosenSensor)));
      return scene.colour(by.length || !known ? "--seen" : "--unseen");
    };
    const tip = () =>
      [
        `marker ${marker.id}`,
        `${marker.p.map((v) => v.toFixed(3)).join("  ")} m`,
        ...by.map(({ sensor, ring }) => `${sensor.name}: ${figure(Math.hypot(...residualOf(ring)))} px off`),
        ...(known && !by.length ? ["no camera used it"] : []),
      ].join("\n");
    if (marker.n)
      scene.add({ kind: "disc", at: marker.p, normal: marker.n, radius: marker.r || 0.06, colour, layer: "markers", tip });
    else scene.add({ kind: "point", at: marker.p, size: 3.5, colour, layer: "markers", tip });
  }
}

// Points are binned by colour once a change of scale or theme: painting is then a colour and many small squares.
function binnedCloud(scene, sensor) {
  const { points_mm, residual_mm, face } = sensor.sweep,
    reach = residualReach();
  if (sweepColour === "sensor") return [{ colour: scene.colour(colourName(sensor)), list: face.map((_, i) => i) }];
  const stops = residualStops(),
    count = 21,
    bins = [...Array(count)].map((_, k) => ({ colour: rampColour((k + 0.5) / count, stops), list: [] })),
    none = { colour: scene.colour("--unseen"), list: [] };
  const height = sweepColour === "height",
    low = 0,
    high = room ? Math.max(...room.markers.map((m) => m.p[2])) : 3,
    far = distanceStops();
  if (height)
    bins.forEach((bin, k) => {
      bin.colour = rampColour((k + 0.5) / count, far);
    });
  for (let i = 0; i < face.length; ++i) {
    const share = height
      ? (points_mm[3 * i + 2] / 1000 - low) / (high - low)
      : residual_mm[i] === null
        ? null
        : (residual_mm[i] + reach) / (2 * reach);
    if (share === null) none.list.push(i);
    else bins[Math.max(0, Math.min(count - 1, Math.floor(share * count)))].list.push(i);
  }
  return [none, ...bins];
}

function boxOfCloud(points_mm) {
  const range = (k) => {
    const at = points_mm.filter((_, i) => i % 3 === k);
    return [quantile(at, 0.01) / 1000, quantile(at, 0.99) / 1000];
  };
  const ranges = [0, 1, 2].map(range);
  return [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [0, 1, 2].map((k) => ranges[k][(i >> k) & 1]));
}

function addSweep(scene, sensor) {
  const cloud = {
    kind: "cloud",
    layer: "sweeps",
    points_mm: sensor.sweep.points_mm,
    face: sensor.sweep.face,
    normals: sensor.sweep.normals,
    size: 2,
  };
  cloud.rebin = () => {
    cloud.bins = binnedCloud(scene, sensor);
  };
  cloud.rebin();
  scene.add(cloud);
  return cloud;
}

function sceneLegend(scene) {
  const legend = element("div", { class: "legend" });
  legend.update = () => {
    const rows = [];
    if (sweeps.length && !scene.hidden.has("sweeps") && sweepColour === "residual" && room) {
      const reach = residualReach();
      rows.push(
        element("strong", {}, "Sweeps: measured less expected range"),
        ...colourBar(residualStops(), [`\u2212${figure(reach)}`, "0", `+${figure(reach)}\u2009mm`]),
        element("span", { class: "row" }, "grey: on no surface of the map"),
      );
    }
    if (sweeps.length && !scene.hidden.has("sweeps") && sweepColour === "height")
      rows.push(
        element("strong", {}, "Sweeps: height above the floor"),
        ...colourBar(distanceStops(), ["0", `${figure(room ? Math.max(...room.markers.map((m) => m.p[2])) : 3)}\u2009m`]),
      );
    if (room && cameras.some((sensor) => sensor.rings.some(used)))
      rows.push(
        element(
          "span",
          { class: "row" },
          element("span", { class: "swatch", style: "background:var(--seen)" }),
          "marker used by a camera",
        ),
        element("span", { class: "row" }, element("span", { class: "swatch", style: "background:var(--unseen)" }), "not used"),
      );
    legend.replaceChildren(...rows);
    legend.style.display = rows.length ? "" : "none";
  };
  return legend;
}

function sceneTools(scene, legend, clouds, everything) {
  const redraw = () => {
    legend.update();
    scene.schedule();
  };
  const layer = ([key, name]) =>
    toggle(name, !scene.hidden.has(key), (on) => {
      if (on) scene.hidden.delete(key);
      else scene.hidden.add(key);
      redraw();
    });
  const layers = [
    room && ["markers", "Markers"],
    room && ["planes", "Planes"],
    ["sensors", "Sensors"],
    sweeps.length && ["sweeps", "Sweeps"],
    ["grid", "1 m grid"],
  ].filter(Boolean);
  const colours = [room && ["residual", "residual"], ["sensor", "LiDAR"], ["height", "height"]].filter(Boolean);
  const fromAbove = () => {
    scene.frame(everything);
    Object.assign(scene.camera, { yaw: -Math.PI / 2, pitch: Math.PI / 2 });
    scene.fit(everything);
    scene.schedule();
  };
  return element(
    "div",
    { class: "tools" },
    sweeps.length
      ? choice(
          "Colour of sweeps",
          colours.map(([value, text]) => [value, `Sweeps: ${text}`]),
          sweepColour,
          (value) => {
            sweepColour = value;
            clouds.forEach((cloud) => cloud.rebin());
            redraw();
          },
        )
      : null,
    ...layers.map(layer),
    element(
      "button",
      {
        type: "button",
        onclick: () => {
          scene.frame(everything);
          scene.schedule();
        },
      },
      "Whole",
    ),
    element("button", { type: "button", onclick: fromAbove }, "Top"),
  );
}

/** The room with all that was found in it, or null where there is neither a room nor a sweep to draw. */
function roomView(choose) {
  if (!room && !(inRoom && sweeps.length)) return null;
  const canvas = element("canvas", {
      role: "img",
      "aria-label": "The room in 3-D: drag to turn, wheel to zoom, arrow keys to turn",
    }),
    tip = element("div", { class: "tip" });
  const scene = new Scene(canvas, tip);
  addRoom(scene);
  if (!room) sweepColour = "sensor";
  const clouds = sweeps.map((sensor) => addSweep(scene, sensor));
  sensors.filter((sensor) => sensor.located).forEach((sensor) => addSensor(scene, sensor));
  const everything = room
    ? [...room.markers.map((marker) => marker.p), ...room.planes.flatMap((plane) => plane.outline)]
    : sweeps.flatMap((sensor) => boxOfCloud(sensor.sweep.points_mm));
  scene.onPick = (key) => choose(key, true);
  const legend = sceneLegend(scene);
  document.addEventListener("themechange", () => {
    clouds.forEach((cloud) => cloud.rebin());
    legend.update();
    scene.schedule();
  });
  legend.update();
  const start = () => {
    scene.frame(everything);
    scene.draw();
  };
  return {
    scene,
    start,
    node: element(
      "div",
      { class: "view room" },
      sceneTools(scene, legend, clouds, everything),
      canvas,
      legend,
      tip,
      element("p", { class: "hint" }, "Drag turns, wheel zooms, shift-drag moves"),
    ),
  };
}

/** Room and device side by side, and a button for each sensor. */
function sceneSection(choose) {
  const views = [roomView(choose), deviceView(choose)].filter(Boolean),
    located = sensors.filter((sensor) => sensor.located);
  if (!views.length) return null;
  const chips = element(
    "div",
    { class: "chips" },
    ...located.map((sensor) =>
      element(
        "button",
        {
          type: "button",
          "data-key": sensor.key,
          "aria-pressed": "false",
          onclick: () => choose(chosenSensor === sensor.key ? null : sensor.key, false),
        },
        dot(sensor),
        sensor.name,
      ),
    ),
  );
  const lead =
    room && located.length
      ? "Axes of the room and of every sensor: red x, green y, blue z. A sensor\u2019s button shows which markers it used."
      : "Axes of every sensor: red x, green y, blue z.";
  const node = section(
    room ? "In the room" : "The device",
    lead,
    element("div", { class: `scenes${views.length > 1 ? " two" : ""}` }, ...views.map((view) => view.node)),
    chips,
  );
  const show = (key) => {
    chosenSensor = key;
    for (const chip of chips.children) chip.setAttribute("aria-pressed", String(chip.dataset.key === key));
    for (const { scene } of views) {
      scene.chosen = key;
      scene.schedule();
    }
  };
  return { node, scenes: views.map((view) => view.scene), start: () => views.forEach((view) => view.start()), show };
}
