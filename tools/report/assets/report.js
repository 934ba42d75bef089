"use strict";

// The page of `roomcal report`, from the verdict down.

const verdicts = {
  PASS: { kind: "pass", mark: "\u2713", means: "Good: may be stored." },
  PASS_ADVISE: { kind: "advise", mark: "\u2713", means: "Good: may be stored. It could be better:" },
  FAIL_RETRY: { kind: "retry", mark: "\u21bb", means: "Not stored. The operator can mend it:" },
  FAIL_SERVICE: { kind: "service", mark: "\u2715", means: "Not stored. It needs service:" },
};

const counted = (count, what) => `${count} ${what}${count === 1 ? "" : "s"}`;

/** What was reached, in a sentence. */
function reached() {
  const part = (list, what) => {
    const located = list.filter((sensor) => sensor.located).length,
      sigma = most(
        list.filter((sensor) => sensor.sigma && !sensor.reference),
        (sensor) => sensor.sigma.mm,
      );
    const share = located === list.length ? counted(located, what) : `${located} of ${counted(list.length, what)}`;
    return list.length ? `${share} located${sigma === null ? "" : ` to ${figure(sigma)}\u2009mm`}` : null;
  };
  const parts = [part(cameras, "camera"), part(lidars, "LiDAR")].filter(Boolean).join(", ");
  return `${parts} (1\u03c3, relative to ${result.rig_frame}).`;
}

function verdictCard() {
  const { kind, mark, means } = verdicts[result.verdict] || { kind: "service", mark: "?", means: "" },
    reasons = result.reasons || [];
  return element(
    "div",
    { class: `verdict ${kind}`, role: "status" },
    element(
      "div",
      { class: "word" },
      element("span", { class: "mark", "aria-hidden": "true" }, mark),
      result.verdict.replaceAll("_", " "),
    ),
    element(
      "div",
      {},
      element("p", {}, element("b", {}, means)),
      reasons.length ? element("ul", {}, ...reasons.map((reason) => element("li", {}, reason))) : null,
      element("p", { class: "reached" }, reached()),
    ),
  );
}

function headLine() {
  const when =
    result.measured_unix_s > 0
      ? new Date(1e3 * result.measured_unix_s).toISOString().slice(0, 16).replace("T", " ") + " UTC"
      : null;
  return [when, result.map && result.map.id ? `room \u201c${result.map.id}\u201d` : null, result.firmware || null]
    .filter(Boolean)
    .join(" \u00b7 ");
}

const most = (list, of) => (list.length ? Math.max(...list.map(of)) : null);

function factList() {
  const subjects = (list) => list.filter((sensor) => sensor.sigma && !sensor.reference),
    located = (list) => `${list.filter((sensor) => sensor.located).length} of ${list.length}`;
  const cam = subjects(cameras),
    lid = subjects(lidars),
    truth = Object.entries(data.truth || {}),
    rings = cameras.reduce((sum, s) => sum + (s.told.inliers || 0), 0);
  const seen = cameras.filter((s) => finite(s.told.rms_px) && s.told.inliers > 0),
    swept = lidars.filter((s) => finite(s.told.rms_m));
  const error = (kind) =>
    most(
      truth.filter(([name]) => sensorOf.get(name).camera === kind),
      ([, change]) => 1e3 * Math.hypot(...change.delta.slice(0, 3)),
    );
  return [
    [located(cameras), "", "cameras located"],
    lidars.length && [located(lidars), "", "LiDARs located"],
    cam.length && [
      figure(most(cam, (s) => s.sigma.mm)),
      "mm",
      `largest \u03c3 of a camera; ${fixed(
        most(cam, (s) => s.sigma.deg),
        4,
      )}\u00b0`,
    ],
    lid.length && [
      figure(most(lid, (s) => s.sigma.mm)),
      "mm",
      `largest \u03c3 of a LiDAR; ${fixed(
        most(lid, (s) => s.sigma.deg),
        4,
      )}\u00b0`,
    ],
    seen.length && [
      figure(Math.sqrt(seen.reduce((sum, s) => sum + s.told.inliers * s.told.rms_px ** 2, 0) / rings)),
      "px",
      `RMS residual of ${grouped(rings)} rings`,
    ],
    swept.length && [figure(1e3 * most(swept, (s) => s.told.rms_m)), "mm", "RMS range residual of LiDARs"],
    result.held_out && [
      figure(result.held_out.median_sigmas),
      "\u03c3",
      `typical miss, ${result.held_out.markers} rings held out`,
    ],
    result.timing_ms && result.timing_ms.total > 0 && [figure(result.timing_ms.total), "ms", "computing, all of it"],
    finite(error(true)) && [figure(error(true)), "mm", "largest true error of a camera"],
    finite(error(false)) && [figure(error(false)), "mm", "largest true error of a LiDAR"],
  ].filter(Boolean);
}

/** Facts in rows without gaps. */
function factStrip() {
  const list = factList(),
    columns = [4, 5, 3].find((n) => list.length % n === 0) || (list.length < 4 ? list.length : 4);
  const node = facts(list);
  node.style.setProperty("--columns", columns);
  return node;
}

function provenance() {
  const map = result.map || {},
    fit = result.joint_fit || {};
  const lines = [
    ["Device", result.device],
    ["Serial", result.device_serial],
    ["Computed by", result.firmware],
    ["Rig frame", result.rig_frame],
    ["Map", map.id],
    ["Map content", map.hash],
    ["Generation", result.generation],
    ["Brought by", result.action],
    ["Temperature", finite(result.temperature_c) ? `${figure(result.temperature_c)}\u2009\u00b0C` : null],
    ["Joint fit", fit.degrees_of_freedom ? `\u03c7\u00b2 ${figure(fit.chi2)} of ${fit.degrees_of_freedom}` : null],
    ["Arena peak", finite(result.arena_peak_bytes) ? `${(result.arena_peak_bytes / 1048576).toFixed(2)} MiB` : null],
    ["Read from", data.source],
  ].filter(([, value]) => value !== undefined && value !== null && value !== "");
  return element(
    "div",
    {},
    element("h2", {}, "Where it comes from"),
    element(
      "dl",
      { class: "times" },
      ...lines.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, String(value))]),
    ),
  );
}

/** What could be on this page and is not, and how to bring it. */
function leftOut() {
  const rings = cameras.some((sensor) => sensor.rings.length);
  return [
    ...(data.notes || []),
    !rings && cameras.length && "no rings and residuals: `roomcal calibrate --detail --json` keeps them",
    !data.pictures && "no images and sweeps: `--shot` brings them",
    !data.room && "no room: `--map` brings it",
    data.room && !room && "the room is not drawn: this record does not say where in it the device stood",
  ].filter(Boolean);
}

function footer() {
  const missing = leftOut();
  return element(
    "footer",
    {},
    missing.length ? element("p", {}, `Left out: ${missing.join("; ")}.`) : null,
    element(
      "p",
      {},
      "T_rig_sensor takes coordinates of the sensor to the rig\u2019s frame; rotations are R = Rz Ry Rx; sigmas are of right perturbations, the largest of three axes. Written by roomcal; this page needs no network.",
    ),
  );
}

function build() {
  let scene = null,
    table = null;
  const choose = (key, scroll) => {
    if (scene) scene.show(key);
    table.choose(key, scroll);
  };
  table = sensorTable((key) => choose(key, false));
  scene = sceneSection(choose);
  document
    .getElementById("page")
    .append(
      ...[
        element("header", {}, element("h1", {}, data.title), element("p", {}, headLine()), themeButton()),
        verdictCard(),
        factStrip(),
        scene && scene.node,
        pictureSection(),
        planSection(),
        residualSection(),
        section(
          "Sensors",
          `T_${result.rig_frame}_sensor: where each sensor sits in the axes of ${result.rig_frame}; rotations R = Rz Ry Rx. \u03c3: one sigma of its worst axis. Drawing: how far off the nominal mounting.`,
          table.node,
          sensorNotes(),
        ),
        truthSection(),
        installedSection(),
        pairSection(),
        correlationSection(),
        intrinsicsSection(),
        beamSection(),
        element("section", { class: "columns" }, provenance(), timingBar()),
        footer(),
      ].filter(Boolean),
    );
  document.body.append(pageTip);
  if (scene) scene.start();
  window.roomcal = {
    scene: scene && scene.scenes[0],
    scenes: scene ? scene.scenes : [],
    table,
    sensors,
    pictureViews,
    openPicture,
  };
}

build();
