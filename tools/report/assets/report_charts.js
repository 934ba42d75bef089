"use strict";

// Charts of a calibration's page: residuals with the curve they should follow, beam offsets, time.

/** Bars and a curve: bins [{ from, to, count }], curve(x) -> count. */
function distribution({ bins, curve, unit, colour, label }) {
  const width = 360,
    height = 168,
    left = 8,
    right = 8,
    top = 12,
    bottom = 30;
  const low = bins[0].from,
    high = bins[bins.length - 1].to;
  const samples = [...Array(121).keys()].map((i) => low + ((high - low) * i) / 120);
  const most = Math.max(1e-9, ...bins.map((bin) => bin.count), ...samples.map(curve));
  const x = (value) => left + ((value - low) / (high - low)) * (width - left - right);
  const y = (count) => height - bottom - (count / most) * (height - top - bottom);
  const bars = bins.map((bin) =>
    svg("rect", {
      x: x(bin.from) + 0.5,
      y: y(bin.count),
      width: Math.max(0.5, x(bin.to) - x(bin.from) - 1),
      height: Math.max(0, y(0) - y(bin.count)),
      style: `fill:${colour}`,
    }),
  );
  const path = samples.map((value, i) => `${i ? "L" : "M"}${x(value).toFixed(1)} ${y(curve(value)).toFixed(1)}`).join("");
  const ticks = [low, low / 2, 0, high / 2, high].map((value, i) =>
    svg(
      "text",
      { x: x(value), y: height - 10, "text-anchor": ["start", "middle", "middle", "middle", "end"][i] },
      `${value > 0 ? "+" : ""}${figure(value).replace("-", "\u2212")}${i === 4 ? `\u2009${unit}` : ""}`,
    ),
  );
  return svg(
    "svg",
    { viewBox: `0 0 ${width} ${height}`, class: "bars distribution", role: "img", "aria-label": label },
    ...bars,
    svg("path", { d: path, class: "expected" }),
    svg("line", { x1: left, x2: width - right, y1: y(0) + 0.5, y2: y(0) + 0.5 }),
    svg("line", { x1: x(0), x2: x(0), y1: y(0), y2: y(0) + 4 }),
    ...ticks,
  );
}

const normalDensity = (value, sigma) => Math.exp((-0.5 * value * value) / (sigma * sigma)) / (sigma * Math.sqrt(2 * Math.PI));

/** Residuals of both axes, and the mixture of normals that the rings' own covariances make. */
function cameraDistribution(sensor, reach) {
  const rings = sensor.rings.filter(used),
    values = rings.flatMap(residualOf);
  const sigmas = rings.flatMap((ring) => [Math.sqrt(ring.residual_cov_px2[0]), Math.sqrt(ring.residual_cov_px2[2])]);
  const count = 30,
    step = (2 * reach) / count;
  const bins = [...Array(count).keys()].map((i) => ({ from: -reach + i * step, to: -reach + (i + 1) * step, count: 0 }));
  let outside = 0;
  for (const value of values) {
    const bin = bins[Math.floor((value + reach) / step)];
    if (bin) bin.count += 1;
    else outside += 1;
  }
  const curve = (x) => step * sigmas.reduce((sum, sigma) => sum + normalDensity(x, sigma), 0);
  const rms = Math.sqrt(values.reduce((sum, v) => sum + v * v, 0) / values.length),
    expected = Math.sqrt(sigmas.reduce((sum, s) => sum + s * s, 0) / sigmas.length);
  return {
    chart: distribution({ bins, curve, unit: "px", colour: cssColour(sensor), label: `residuals of ${sensor.name}` }),
    caption: `${rings.length} rings, RMS ${figure(rms)}\u2009px an axis; claimed ${figure(expected)}${outside ? `; ${outside} beyond` : ""}`,
  };
}

function lidarDistribution(sensor) {
  const { histogram: counts, sigma_m } = sensor.sweep,
    sigma = 1e3 * sigma_m;
  const bins = counts.counts.map((count, i) => ({
    from: counts.low_mm + i * counts.step_mm,
    to: counts.low_mm + (i + 1) * counts.step_mm,
    count,
  }));
  const inside = bins.reduce((sum, bin) => sum + (Math.abs(bin.from + bin.to) / 2 < 3 * sigma ? bin.count : 0), 0);
  return {
    chart: distribution({
      bins,
      curve: (x) => inside * counts.step_mm * normalDensity(x, sigma),
      unit: "mm",
      colour: cssColour(sensor),
      label: `residuals of ${sensor.name}`,
    }),
    caption: `${grouped(sensor.sweep.points)} points, \u03c3 ${figure(sigma)}\u2009mm a range; ${Math.round((100 * counts.outside) / sensor.sweep.points)}\u2009% beyond, or off the map\u2019s surfaces`,
  };
}

function residualSection() {
  const seen = cameras.filter((sensor) => sensor.rings.some(used));
  const spread = seen.flatMap((sensor) =>
    sensor.rings
      .filter(used)
      .flatMap((ring) => [
        ...residualOf(ring).map(Math.abs),
        3.2 * Math.sqrt(Math.max(ring.residual_cov_px2[0], ring.residual_cov_px2[2])),
      ]),
  );
  const reach = seen.length ? quantile(spread, 0.98) : 0;
  const charts = [
    ...seen.map((sensor) => ({ sensor, ...cameraDistribution(sensor, reach) })),
    ...sweeps.filter((sensor) => sensor.sweep.histogram).map((sensor) => ({ sensor, ...lidarDistribution(sensor) })),
  ];
  if (!charts.length) return null;
  return section(
    "Residuals",
    "Cameras: predicted less seen ring centre, px, both axes of the image. LiDARs: measured less expected range, mm. Bars: what this shot left. Line: what the claimed uncertainties lead to; bars narrower than it mean a careful claim.",
    element(
      "div",
      { class: "charts" },
      ...charts.map(({ sensor, chart, caption }) =>
        element("figure", {}, element("figcaption", {}, element("b", {}, named(sensor)), element("span", {}, caption)), chart),
      ),
    ),
  );
}

/** Offset of every beam with its sigma. */
function beamChart(sensor) {
  const beams = sensor.told.beam_offsets,
    width = 560,
    height = 150,
    left = 40,
    bottom = 24,
    top = 8;
  const reach = 1e3 * Math.max(...beams.map((beam) => Math.abs(beam.offset_m) + beam.sigma_m), 1e-6);
  const last = Math.max(...beams.map((beam) => beam.beam)),
    x = (beam) => left + ((beam + 0.5) / (last + 1)) * (width - left - 4),
    y = (mm) => top + ((reach - mm) / (2 * reach)) * (height - top - bottom);
  const wide = Math.min(7, ((width - left) / (last + 1)) * 0.34);
  const marks = beams.map((beam) => {
    const mm = 1e3 * beam.offset_m,
      sigma = 1e3 * beam.sigma_m;
    return svg(
      "g",
      { "data-tip": `beam ${beam.beam}\n${figure(mm)} \u00b1 ${figure(sigma)} mm, ${beam.points} points` },
      svg("rect", {
        x: x(beam.beam) - wide,
        y: Math.min(y(mm), y(0)),
        width: 2 * wide,
        height: Math.abs(y(mm) - y(0)),
        style: `fill:${cssColour(sensor)};opacity:0.75`,
      }),
      svg("line", { x1: x(beam.beam), x2: x(beam.beam), y1: y(mm - sigma), y2: y(mm + sigma), class: "whisker" }),
    );
  });
  const step = roundStep(reach * 0.9),
    every = Math.max(1, Math.ceil((last + 1) / 16));
  const grid = [-step, 0, step].flatMap((mm) => [
    svg("line", { x1: left, x2: width, y1: y(mm), y2: y(mm) }),
    svg("text", { x: left - 6, y: y(mm) + 4, "text-anchor": "end" }, figure(mm).replace("-", "\u2212")),
  ]);
  const ticks = beams
    .filter((beam) => beam.beam % every === 0)
    .map((beam) => svg("text", { x: x(beam.beam), y: height - 6, "text-anchor": "middle" }, String(beam.beam)));
  const picture = svg(
    "svg",
    { viewBox: `0 0 ${width} ${height}`, class: "bars beams", role: "img", "aria-label": `beam offsets of ${sensor.name}` },
    ...grid,
    ...marks,
    ...ticks,
  );
  tipOn(picture, (event) => {
    const group = event.target.closest("[data-tip]");
    return group && group.getAttribute("data-tip");
  });
  return picture;
}

function beamSection() {
  const told = lidars.filter((sensor) => (sensor.told.beam_offsets || []).length > 1);
  if (!told.length) return null;
  return section(
    "Beam offsets",
    "What each laser reports too much, estimated along with the pose; mm by laser number, whiskers one sigma.",
    element(
      "div",
      { class: "charts wide" },
      ...told.map((sensor) =>
        element(
          "figure",
          {},
          element("figcaption", {}, element("b", {}, named(sensor)), element("span", {}, sensor.told.model || "")),
          beamChart(sensor),
        ),
      ),
    ),
  );
}

const stages = [
  ["detect", "rings"],
  ["locate", "cameras located"],
  ["locate_lidars", "LiDARs located"],
  ["refine", "joint solution"],
  ["judge", "verdict"],
];

function timingBar() {
  const time = result.timing_ms;
  if (!time || !(time.total > 0)) return null;
  const shown = stages
    .filter(([key]) => time[key] > 0)
    .map(([key, what], i) => ({ what, ms: time[key], colour: `var(--s${i})` }));
  return element(
    "div",
    {},
    element("h2", {}, "Time"),
    element(
      "div",
      { class: "stack", role: "img", "aria-label": "share of each stage" },
      ...shown.map(({ ms, colour }) => element("span", { style: `flex:${ms / time.total} 0 0;background:${colour}` })),
    ),
    element(
      "dl",
      { class: "times" },
      ...shown.flatMap(({ what, ms, colour }) => [
        element("dt", {}, element("span", { class: "dot", style: `background:${colour}` }), what),
        element("dd", {}, `${figure(ms)}\u2009ms`),
      ]),
      element("dt", {}, element("b", {}, "all")),
      element("dd", {}, element("b", {}, `${figure(time.total)}\u2009ms`)),
    ),
  );
}
