"use strict";

// Tables of a map's page: its markers and its planes.

function markerTable(choose) {
  const has = (key) => rows.some((r) => Number.isFinite(r[key]));
  const number = (key, name, show) => ({ name, value: (r) => r[key] ?? null, show: (r) => (show || figure)(r[key]) });
  const columns = [
    {
      name: "Marker",
      word: true,
      value: (r) => r.id,
      show: (r) => element("span", {}, (r.dot = element("span", { class: "dot" })), String(r.id)),
    },
    ...["x", "y", "z"].map((name, k) => ({ name: `${name} m`, value: (r) => r.p[k], show: (r) => fixed(r.p[k], 4) })),
    number("sigma_mm", "1\u03c3 mm"),
    has("held_out_mm") && number("held_out_mm", "held out mm"),
    has("rms_px") && number("rms_px", "residual px"),
    has("sightings") && number("sightings", "sightings", (v) => (Number.isFinite(v) ? String(v) : "\u2013")),
    number("r_mm", "radius mm"),
    { name: "plane", value: (r) => (r.plane < 0 ? null : r.plane), show: (r) => (r.plane < 0 ? "\u2013" : String(r.plane)) },
    number("off_plane_mm", "off plane mm"),
  ].filter(Boolean);
  rows.forEach((r) => {
    r.r_mm = r.r ? 1e3 * r.r : null;
    r.off_plane_mm =
      r.plane < 0 ? null : 1e3 * (planes[r.plane].normal.reduce((s, n, k) => s + n * r.p[k], 0) + planes[r.plane].d_m);
  });
  return new SortableTable(columns, rows, choose);
}

function planeTable() {
  const columns = [
    {
      name: "Plane",
      word: true,
      value: (p) => p.key,
      show: (p) =>
        element(
          "span",
          {},
          element("span", { class: "dot", style: `background:${planeColours[p.key % planeColours.length]}` }),
          String(p.key),
        ),
    },
    { name: "markers", value: (p) => p.markers },
    { name: "RMS mm", value: (p) => p.rms_m * 1e3, show: (p) => figure(p.rms_m * 1e3) },
    { name: "normal", value: (p) => p.normal.join(" "), show: (p) => p.normal.map((v) => fixed(v, 3)).join("  ") },
    { name: "d m", value: (p) => p.d_m, show: (p) => fixed(p.d_m, 4) },
  ];
  return new SortableTable(
    columns,
    planes.map((p, i) => ({ ...p, key: i })),
    () => {},
  ).node;
}
