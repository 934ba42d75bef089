"use strict";

// Tables of a calibration's page: sensors, pairs, refined intrinsics, and poses beside another source's.

const dash = "\u2013";
const number = (name, value, places) => ({
  name,
  value,
  show: (row) =>
    finite(value(row)) ? (places === undefined ? figure(value(row)) : fixed(value(row), places)).replace("-", "\u2212") : dash,
});

/** How far a sensor is from its drawing: { mm, deg }, or null. */
function offDrawing(sensor) {
  if (!sensor.told.nominal || !sensor.T_rig) return null;
  const T = matrix.multiply(matrix.inverse(sensor.told.nominal.T_rig_sensor), sensor.T_rig);
  return { mm: 1e3 * Math.hypot(...matrix.translation(T)), deg: matrix.turn(T) };
}

function sensorTable(choose) {
  const at = (k) => (sensor) => (sensor.T_rig ? 1e3 * sensor.T_rig[k][3] : null),
    angle = (k) => (sensor) => (sensor.T_rig ? matrix.angles(sensor.T_rig)[k] : null);
  const rows = sensors.map((sensor) => ({ ...sensor, off: offDrawing(sensor) }));
  const measured = (sensor) => sensor.sigma && !sensor.reference;
  const columns = [
    { name: "Sensor", word: true, value: (s) => s.number, show: named },
    {
      name: "kind",
      word: true,
      value: (s) => (s.camera ? "camera" : s.told.model || "LiDAR"),
      show: (s) => (s.camera ? "camera" : s.told.model || "LiDAR"),
    },
    ...["x", "y", "z"].map((axis, k) => number(`${axis} mm`, at(k), 2)),
    ...["rx", "ry", "rz"].map((axis, k) => number(`${axis} \u00b0`, angle(k), 3)),
    number("\u03c3 mm", (s) => (measured(s) ? s.sigma.mm : null), 3),
    number("\u03c3 \u00b0", (s) => (measured(s) ? s.sigma.deg : null), 4),
    {
      name: "inliers",
      value: (s) => s.told.inliers ?? null,
      show: (s) => (finite(s.told.inliers) ? `${grouped(s.told.inliers)} of ${grouped(s.told.detections)}` : dash),
    },
    {
      name: "coverage",
      value: (s) => s.told.coverage ?? null,
      show: (s) => (finite(s.told.coverage) ? `${Math.round(100 * s.told.coverage)}\u2009%` : dash),
    },
    {
      name: "RMS",
      value: (s) => s.told.rms_px ?? (finite(s.told.rms_m) ? 1e3 * s.told.rms_m : null),
      show: (s) =>
        finite(s.told.rms_px)
          ? `${figure(s.told.rms_px)}\u2009px`
          : finite(s.told.rms_m)
            ? `${figure(1e3 * s.told.rms_m)}\u2009mm`
            : dash,
    },
    rows.some((s) => s.off) && number("drawing mm", (s) => (s.off ? s.off.mm : null), 1),
    rows.some((s) => s.off) && number("drawing \u00b0", (s) => (s.off ? s.off.deg : null), 2),
  ].filter(Boolean);
  const table = new SortableTable(columns, rows, choose);
  table.node.classList.add("dense");
  return table;
}

/** One sigma, axis by axis. */
function sigmaTable() {
  const rows = sensors.filter((sensor) => sensor.sigma && !sensor.reference);
  const sigma = (k) => (sensor) => {
    const value = Math.sqrt(Math.max(0, sensor.told.covariance[k][k]));
    return k < 3 ? 1e3 * value : degrees(value);
  };
  const columns = [
    { name: "Sensor", word: true, value: (s) => s.number, show: named },
    ...axisNames.map((axis, k) => number(`${axis} ${k < 3 ? "mm" : "\u00b0"}`, sigma(k), k < 3 ? 3 : 4)),
  ];
  const table = new SortableTable(columns, rows, (key) => table.choose(key, false));
  return table.node;
}

/** What a sensor says of itself in words: why it was not located, which directions it does not see. */
function sensorNotes() {
  const said = (result.reasons || []).join("\n");
  const lines = sensors.flatMap((sensor) =>
    [
      sensor.told.failure && !said.includes(sensor.told.failure) && [sensor, sensor.told.failure.replace(`${sensor.name}: `, "")],
      ...(sensor.told.weak_directions || []).map((weak) => [sensor, weak.text]),
      sensor.told.mounting_took_part &&
        (sensor.told.weak_directions || []).length > 0 && [sensor, "its mounting carries what the sweep does not see"],
    ].filter(Boolean),
  );
  return lines.length
    ? element("ul", { class: "advice" }, ...lines.map(([sensor, text]) => element("li", {}, named(sensor), ` ${text}`)))
    : null;
}

function pairRows() {
  const rows = (result.pairs || []).filter(
    (pair) =>
      sensorOf.get(pair.a).camera || (!sensorOf.get(pair.b).camera && sensorOf.get(pair.a).number < sensorOf.get(pair.b).number),
  );
  return rows.map((pair) => ({
    ...pair,
    key: `${pair.a} ${pair.b}`,
    mm: 1e3 * Math.hypot(...matrix.translation(pair.T_a_b)),
    deg: matrix.turn(pair.T_a_b),
    sigma: sigmasOf(pair.covariance),
    px: new Map((pair.pixel_error || []).map((error) => [error.distance_m, error.sigma_px])),
  }));
}

function pairSection() {
  const rows = pairRows();
  if (!rows.length) return null;
  const distancesTold = [...new Set(rows.flatMap((row) => [...row.px.keys()]))].sort((a, b) => a - b);
  const sensorColumn = (name, side) => ({
    name,
    word: true,
    value: (row) => sensorOf.get(row[side]).number,
    show: (row) => named(sensorOf.get(row[side])),
  });
  const columns = [
    sensorColumn("In", "a"),
    sensorColumn("points of", "b"),
    number("apart mm", (row) => row.mm, 2),
    number("turned \u00b0", (row) => row.deg, 3),
    number("\u03c3 mm", (row) => row.sigma.mm, 3),
    number("\u03c3 \u00b0", (row) => row.sigma.deg, 4),
    ...distancesTold.map((distance) => number(`px at ${distance} m`, (row) => row.px.get(distance), 3)),
  ];
  const table = new SortableTable(columns, rows, (key) => table.choose(key, false));
  return section(
    "Pairs",
    "Pixels: how far off points of the second sensor may appear in the first one\u2019s image, one sigma, by their distance, because of this extrinsic alone.",
    table.node,
  );
}

function intrinsicsSection() {
  const rows = cameras.flatMap((sensor) =>
    Object.entries(sensor.told.intrinsics_sigma || {}).map(([name, told], i) => {
      const k = sensor.told.intrinsics,
        values = [k.fx_px, k.fy_px, k.cx_px, k.cy_px, ...k.distortion];
      const order = ["fx_px", "fy_px", "cx_px", "cy_px"].indexOf(name.endsWith("_px") ? name : `${name}_px`);
      return {
        key: `${sensor.name} ${name}`,
        sensor,
        name,
        value: values[order >= 0 ? order : 4 + Number(name.slice(-1))],
        ...told,
        number: 100 * sensor.number + i,
      };
    }),
  );
  if (!rows.length) return null;
  const small = (name, value) => ({
    name,
    value,
    show: (row) => (finite(value(row)) ? Number(value(row).toPrecision(6)).toString().replace("-", "\u2212") : dash),
  });
  const columns = [
    { name: "Camera", word: true, value: (row) => row.number, show: (row) => named(row.sensor) },
    { name: "parameter", word: true, value: (row) => row.name, show: (row) => row.name },
    small("refined", (row) => row.value),
    small("given", (row) => row.prior),
    { name: "\u03c3", value: (row) => row.sigma, show: (row) => row.sigma.toPrecision(2) },
    { name: "\u03c3 given", value: (row) => row.prior_sigma, show: (row) => row.prior_sigma.toPrecision(2) },
    { name: "told by", word: true, value: (row) => row.told_by, show: (row) => row.told_by },
  ];
  const table = new SortableTable(columns, rows, (key) => table.choose(key, false));
  return section("Intrinsics, refined along", null, table.node);
}

/** changes: { sensor: { comparable, delta, covariance, p_value } }; words: what the columns are called. */
function comparisonTable(changes, words) {
  const rows = sensors
    .filter((sensor) => changes[sensor.name] && !sensor.reference)
    .map((sensor) => {
      const change = changes[sensor.name],
        told = change.comparable;
      return {
        key: sensor.name,
        sensor,
        change,
        mm: told ? 1e3 * Math.hypot(...change.delta.slice(0, 3)) : null,
        deg: told ? degrees(Math.hypot(...change.delta.slice(3))) : null,
        sigma: told ? sigmasOf(change.covariance) : null,
        p_value: told ? change.p_value : null,
      };
    });
  const columns = [
    { name: "Sensor", word: true, value: (row) => row.sensor.number, show: (row) => named(row.sensor) },
    number(`${words.moved} mm`, (row) => row.mm, 3),
    number("\u03c3 mm", (row) => row.sigma && row.sigma.mm, 3),
    number(`${words.turned} \u00b0`, (row) => row.deg, 4),
    number("\u03c3 \u00b0", (row) => row.sigma && row.sigma.deg, 4),
    {
      name: "p",
      value: (row) => row.p_value,
      show: (row) =>
        row.p_value === null
          ? "not comparable"
          : element("span", { class: row.p_value < 0.001 ? "low" : null }, probability(row.p_value)),
    },
    {
      name: "in sigmas, axis by axis",
      word: true,
      value: (row) => row.p_value,
      show: (row) => (row.change.comparable ? pulls(row.change) : dash),
    },
  ];
  const table = new SortableTable(columns, rows, (key) => table.choose(key, false));
  return table.node;
}

function installedSection() {
  const own = result.installed,
    changes = data.installed || (own && own.sensors);
  if (!changes || !Object.keys(changes).length) return null;
  const verdict =
    data.installed || !own
      ? null
      : element(
          "p",
          { class: own.moved ? "say warn" : "say" },
          own.moved ? element("b", {}, own.moved_sensor, " has moved") : element("b", {}, "Nothing has moved"),
          ` (p ${probability(own.p_value)} that chance alone gives as much)`,
        );
  return section(
    "Installed against this shot",
    "How far each sensor is from where the calibration in force has it; p: that nothing moved and chance alone gives as much. Bands: one and three sigma of both together.",
    verdict,
    comparisonTable(changes, { moved: "moved", turned: "turned" }),
  );
}

function truthSection() {
  if (!data.truth || !Object.keys(data.truth).length) return null;
  return section(
    "Beside the truth",
    "The shot was simulated: errors of T_rig_sensor, beside the sigmas that the result claims. Bands: one and three sigma.",
    comparisonTable(data.truth, { moved: "error", turned: "error" }),
  );
}
