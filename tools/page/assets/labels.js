"use strict";

// Names in a scene, so that they can be read: none on another one, none outside the canvas.

const labelSize = 12;

// Where a name may stand beside what it names, the nearest place first, px.
const labelPlaces = [
  [8, -8],
  [8, 16],
  [-8, -8],
  [-8, 16],
  ...[...Array(40).keys()].map((i) => {
    const a = (i * Math.PI) / 5 - Math.PI / 3,
      r = 26 + 13 * Math.floor(i / 10);
    return [r * Math.cos(a), r * Math.sin(a)];
  }),
];

/** From the top down, each in the nearest free place around what it names; one that had to go far gets a leader. */
function paintLabels(scene, g, labels) {
  const taken = [],
    width = scene.canvas.clientWidth,
    height = scene.canvas.clientHeight;
  g.font = `${labelSize}px system-ui, 'DejaVu Sans', sans-serif`;
  const at = labels
    .map((thing) => ({ thing, place: scene.project(thing.at), wide: g.measureText(thing.text).width }))
    .filter(({ place }) => place[2] > 0.01);
  for (const {
    thing,
    place: [x, y],
    wide,
  } of at.sort((a, b) => a.place[1] - b.place[1])) {
    const boxOf = ([dx, dy]) => ({ x: dx < 0 ? x + dx - wide : x + dx, y: y + dy - labelSize, w: wide, h: labelSize + 3 });
    const free = (box) =>
      box.x > 0 &&
      box.y > 0 &&
      box.x + box.w < width &&
      box.y + box.h < height &&
      taken.every((t) => box.x > t.x + t.w + 4 || t.x > box.x + box.w + 4 || box.y > t.y + t.h || t.y > box.y + box.h);
    const offset = labelPlaces.find((place) => free(boxOf(place))) || labelPlaces[0],
      box = boxOf(offset);
    taken.push(box);
    paintLabel(scene, g, thing, box, Math.hypot(...offset) > 20 ? [x, y] : null);
  }
}

function paintLabel(scene, g, thing, box, leader) {
  const colour = typeof thing.colour === "function" ? thing.colour() : thing.colour || scene.colour("--soft");
  if (leader) {
    g.beginPath();
    g.moveTo(...leader);
    g.lineTo(box.x + (leader[0] < box.x ? 0 : leader[0] > box.x + box.w ? box.w : box.w / 2), box.y + box.h / 2);
    g.strokeStyle = colour;
    g.globalAlpha = 0.5;
    g.lineWidth = 1;
    g.stroke();
    g.globalAlpha = 1;
  }
  g.lineWidth = 3;
  g.strokeStyle = scene.colour("--card");
  g.strokeText(thing.text, box.x, box.y + box.h - 4);
  g.fillStyle = colour;
  g.fillText(thing.text, box.x, box.y + box.h - 4);
}
