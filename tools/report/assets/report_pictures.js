"use strict";

// What each camera saw: its image with rings, enlarged residuals and the LiDARs' points; a click opens it to zoom in.

const pictureShow = { rings: true, residuals: true, lidar: false, ids: false, factor: 100 };
const pictureViews = [];
const redrawPictures = () => pictureViews.forEach((view) => view.draw());

/** So that a large residual is a sixteenth of the picture's shorter side. */
function fittingFactor() {
  const shares = cameras.flatMap((sensor) => {
    const side = Math.min(sensor.told.intrinsics.width_px, sensor.told.intrinsics.height_px);
    return sensor.rings.filter(used).map((ring) => Math.hypot(...residualOf(ring)) / side);
  });
  const large = quantile(shares, 0.9);
  return large > 0 ? Math.max(1, Math.min(10000, roundStep(0.06 / large))) : 1;
}

/** Near and far ends of the distance scale over all images, m. */
function distanceRange() {
  const all = cameras
    .flatMap((sensor) => Object.values(sensor.projections).flatMap((points) => points.filter((_, i) => i % 3 === 2)))
    .map((cm) => cm / 100);
  return all.length ? [Math.floor(2 * quantile(all, 0.005)) / 2, Math.ceil(2 * quantile(all, 0.995)) / 2] : [0, 1];
}
const distances = distanceRange();

// One image on a canvas: the original's pixels times `scale`, moved by `at`.
class PictureView {
  constructor(sensor, canvas) {
    Object.assign(this, { sensor, canvas, zoom: 1, at: [0, 0], targets: [] });
    const { width_px, height_px } = sensor.picture || sensor.told.intrinsics;
    this.size = [width_px, height_px];
    if (sensor.picture) {
      this.image = new Image();
      this.image.onload = () => {
        this.ready = true;
        this.draw();
      };
      this.image.src = sensor.picture.uri;
    }
    keepDrawn(canvas, () => this.draw());
    tipOn(canvas, (event) => this.tipAt(event.offsetX, event.offsetY));
    pictureViews.push(this);
  }

  /** Canvas units a pixel of the original, and where its top left corner is. */
  layout(width, height) {
    const fit = Math.min(width / this.size[0], height / this.size[1]),
      scale = fit * this.zoom;
    return {
      scale,
      left: (width - scale * this.size[0]) / 2 + this.at[0],
      top: (height - scale * this.size[1]) / 2 + this.at[1],
    };
  }

  draw() {
    if (!this.canvas.isConnected || this.canvas.clientWidth === 0) return;
    const { g, width, height } = freshCanvas(this.canvas),
      { scale, left, top } = this.layout(width, height);
    this.place = (x, y) => [left + (x + 0.5) * scale, top + (y + 0.5) * scale]; // pixel (0, 0) is a pixel's centre
    this.scale = scale;
    this.targets = [];
    g.fillStyle = themeColour("--tint");
    g.fillRect(left, top, scale * this.size[0], scale * this.size[1]);
    if (this.ready) {
      g.imageSmoothingQuality = "high";
      g.drawImage(this.image, left, top, scale * this.size[0], scale * this.size[1]);
      g.fillStyle = "rgba(12, 16, 18, 0.18)"; // faded a little, so that drawing stands out
      g.fillRect(left, top, scale * this.size[0], scale * this.size[1]);
    }
    if (pictureShow.lidar) this.drawSweeps(g);
    for (const ring of this.sensor.rings) this.drawRing(g, ring);
  }

  drawSweeps(g) {
    const stops = distanceStops(),
      size = Math.max(1.6, Math.min(5, 2.2 * Math.sqrt(this.zoom))),
      [near, far] = distances,
      bins = [...Array(24)].map(() => []);
    for (const points of Object.values(this.sensor.projections)) {
      for (let i = 0; i < points.length; i += 3) {
        const share = (points[i + 2] / 100 - near) / (far - near);
        bins[Math.max(0, Math.min(23, Math.floor(24 * share)))].push(i, points);
      }
    }
    bins.forEach((bin, k) => {
      g.fillStyle = rampColour((k + 0.5) / 24, stops);
      for (let j = 0; j < bin.length; j += 2) {
        const i = bin[j],
          points = bin[j + 1],
          [x, y] = this.place(points[i], points[i + 1]);
        g.fillRect(x - size / 2, y - size / 2, size, size);
      }
    });
  }

  drawRing(g, ring) {
    const [x, y] = this.place(ring.x, ring.y),
      inlier = used(ring);
    this.targets.push({ x, y, ring, reach: Math.max(8, (ring.major_px / 2) * this.scale) });
    if (pictureShow.rings) {
      const [ex, ey] = this.place(...ring.ellipse);
      g.strokeStyle = inlier ? (ring.held_out ? "#58c4ff" : "#45e07a") : "#ffa538";
      g.lineWidth = this.zoom > 1 ? 1.6 : 1.2;
      g.beginPath();
      g.ellipse(ex, ey, (ring.major_px / 2) * this.scale, (ring.minor_px / 2) * this.scale, ring.angle_rad, 0, 2 * Math.PI);
      g.stroke();
    }
    if (inlier && pictureShow.residuals) {
      const [dx, dy] = residualOf(ring),
        f = pictureShow.factor * this.scale;
      g.strokeStyle = "#ff4d5e";
      g.lineWidth = this.zoom > 1 ? 2 : 1.5;
      g.beginPath();
      g.moveTo(x, y);
      g.lineTo(x + f * dx, y + f * dy);
      g.stroke();
      g.fillStyle = "#ff4d5e";
      g.beginPath();
      g.arc(x, y, 1.6, 0, 2 * Math.PI);
      g.fill();
    }
    if (inlier && pictureShow.ids) {
      g.font = "10.5px system-ui, 'DejaVu Sans', sans-serif";
      g.lineWidth = 3;
      g.strokeStyle = "rgba(0, 0, 0, 0.65)";
      g.strokeText(ring.marker, x + 5, y - 5);
      g.fillStyle = "#fff3c4";
      g.fillText(ring.marker, x + 5, y - 5);
    }
  }

  tipAt(x, y) {
    const near = this.targets
      .map((target) => ({ ...target, away: Math.hypot(target.x - x, target.y - y) }))
      .filter((target) => target.away < target.reach)
      .sort((a, b) => a.away - b.away)[0];
    if (!near) return null;
    const { ring } = near,
      lines = [`${figure(ring.x)}, ${figure(ring.y)} px`];
    if (!used(ring))
      return [
        ...lines,
        `not used: ${ring.status === "ok" ? "fits no marker of the map" : ring.status.replaceAll("_", " ")}`,
      ].join("\n");
    const [dx, dy] = residualOf(ring),
      c = ring.residual_cov_px2;
    return [
      `marker ${ring.marker}${ring.held_out ? ", held out once" : ""}`,
      ...lines,
      `residual ${dx.toFixed(4)}, ${dy.toFixed(4)} px`,
      `claimed \u03c3 ${Math.sqrt(c[0]).toFixed(4)}, ${Math.sqrt(c[2]).toFixed(4)} px`,
    ].join("\n");
  }
}

/** The 4 x 4 cells of coverage, filled where an inlier is. */
function coverageIcon(sensor) {
  const { width_px, height_px } = sensor.told.intrinsics,
    filled = new Set();
  sensor.rings
    .filter(used)
    .forEach((ring) => filled.add(4 * Math.floor((4 * ring.y) / height_px) + Math.floor((4 * ring.x) / width_px)));
  return svg(
    "svg",
    { viewBox: "0 0 16 16", class: "cover", role: "img", "aria-label": "parts of the image with rings" },
    ...[...Array(16).keys()].map((i) =>
      svg("rect", {
        x: (i % 4) * 4 + 0.3,
        y: Math.floor(i / 4) * 4 + 0.3,
        width: 3.4,
        height: 3.4,
        rx: 0.6,
        class: filled.has(i) ? "on" : null,
      }),
    ),
  );
}

// The image over the whole window: wheel and pinch zoom, drag moves, Escape closes.
function openPicture(sensor) {
  const canvas = element("canvas", { "aria-label": `image of ${sensor.name}: wheel zooms, drag moves` });
  const dialog = element(
    "dialog",
    { class: "lightbox" },
    canvas,
    element("button", { type: "button", class: "close", "aria-label": "Close", onclick: () => dialog.close() }, "\u2715"),
    element("p", {}, named(sensor), element("span", {}, "Wheel or pinch zooms, drag moves")),
  );
  document.body.append(dialog);
  dialog.showModal();
  dialog.append(pageTip); // what is outside the dialog is under it
  const view = new PictureView(sensor, canvas),
    pointers = new Map();
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
  };
  const zoomAt = (x, y, factor) => {
    const zoom = Math.max(1, Math.min(40, view.zoom * factor)),
      real = zoom / view.zoom,
      cx = canvas.clientWidth / 2,
      cy = canvas.clientHeight / 2;
    view.at = zoom === 1 ? [0, 0] : [x - cx - real * (x - cx - view.at[0]), y - cy - real * (y - cy - view.at[1])];
    view.zoom = zoom;
    view.draw();
  };
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      zoomAt(event.offsetX, event.offsetY, Math.exp(-Math.sign(event.deltaY) * Math.min(120, Math.abs(event.deltaY)) * 0.002));
    },
    { passive: false },
  );
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const before = spread();
    pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
    if (pointers.size > 1 && before > 0) return zoomAt(event.offsetX, event.offsetY, spread() / before);
    if (view.zoom === 1) return;
    view.at = [view.at[0] + event.offsetX - last[0], view.at[1] + event.offsetY - last[1]];
    view.draw();
  });
  for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, (event) => pointers.delete(event.pointerId));
  dialog.addEventListener("close", () => {
    document.body.append(pageTip);
    pageTip.style.display = "none";
    pictureViews.splice(pictureViews.indexOf(view), 1);
    dialog.remove();
  });
  return view;
}

function pictureCaption(sensor) {
  const count = sensor.rings.filter(used).length,
    words = [];
  if (sensor.located && sensor.rings.length) words.push(`${count} of ${sensor.rings.length} rings used`);
  else if (sensor.located) words.push(`${sensor.told.inliers} rings used`);
  if (finite(sensor.told.rms_px)) words.push(`${figure(sensor.told.rms_px)}\u2009px RMS`);
  if (!sensor.located) words.push(sensor.told.failure || "not located");
  return element(
    "figcaption",
    {},
    element("b", {}, named(sensor)),
    element("span", {}, words.join(" \u00b7 ")),
    sensor.rings.some(used) ? coverageIcon(sensor) : null,
  );
}

function pictureTools() {
  const change = (key) => (value) => {
    pictureShow[key] = value;
    legend.update();
    redrawPictures();
  };
  const rings = cameras.some((sensor) => sensor.rings.length),
    inliers = cameras.some((sensor) => sensor.rings.some(used));
  const points = cameras.some((sensor) => Object.keys(sensor.projections).length);
  pictureShow.lidar = points && !inliers;
  const factors = [...new Set([1, 10, 50, 100, 200, 500, 1000, 2000, 5000, pictureShow.factor])].sort((a, b) => a - b);
  const legend = element("div", { class: "legend-line" });
  legend.update = () =>
    legend.replaceChildren(
      ...[
        rings &&
          pictureShow.rings &&
          [
            ["#2fbf62", "used"],
            ["#2f9fe0", "held out once"],
            ["#f0932b", "seen, not used"],
          ].map(([colour, text]) => element("span", {}, element("i", { class: "ring", style: `border-color:${colour}` }), text)),
        inliers &&
          pictureShow.residuals &&
          element("span", {}, element("i", { class: "stroke" }), `seen \u2192 predicted, \u00d7\u2009${pictureShow.factor}`),
        points &&
          pictureShow.lidar &&
          element(
            "span",
            { class: "distances" },
            `${distances[0]}\u2009m`,
            element("i", { class: "bar", style: `background:linear-gradient(to right, ${distanceStops().join(", ")})` }),
            `${distances[1]}\u2009m from the camera`,
          ),
      ]
        .flat()
        .filter(Boolean),
    );
  document.addEventListener("themechange", legend.update);
  legend.update();
  return element(
    "div",
    { class: "bar-tools" },
    element(
      "div",
      { class: "tools inline" },
      rings && toggle("Rings", pictureShow.rings, change("rings")),
      inliers && toggle("Residuals", pictureShow.residuals, change("residuals")),
      inliers &&
        choice(
          "Residuals enlarged",
          factors.map((f) => [f, `\u00d7\u2009${f}`]),
          pictureShow.factor,
          (value) => change("factor")(Number(value)),
        ),
      points && toggle("LiDAR points", pictureShow.lidar, change("lidar")),
      inliers && toggle("Marker ids", pictureShow.ids, change("ids")),
    ),
    legend,
  );
}

function pictureSection() {
  const shown = cameras.filter((sensor) => sensor.picture || sensor.rings.length);
  if (!shown.length) return null;
  pictureShow.factor = fittingFactor();
  const tools = pictureTools();
  const cards = shown.map((sensor) => {
    const canvas = element("canvas", { role: "img", "aria-label": `image of ${sensor.name}` });
    const { width_px, height_px } = sensor.picture || sensor.told.intrinsics;
    const view = new PictureView(sensor, canvas);
    return element(
      "figure",
      { class: "picture", onclick: () => openPicture(view.sensor) },
      element("div", { class: "frame", style: `aspect-ratio:${width_px} / ${height_px}` }, canvas),
      pictureCaption(sensor),
    );
  });
  const tall = shown.every((sensor) => sensor.told.intrinsics.height_px > sensor.told.intrinsics.width_px);
  return section(
    "Images",
    data.pictures ? "Click an image to open it and zoom in." : "`--shot` brings the images; here are the rings alone.",
    tools,
    element("div", { class: `pictures${tall ? " tall" : ""}` }, ...cards),
  );
}
