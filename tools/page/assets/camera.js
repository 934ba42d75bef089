"use strict";

// A camera that turns about a point of the room: z up, metres. No library, no state but its own numbers.
class OrbitCamera {
  constructor(centre, radius_m) {
    this.home = { centre: centre.slice(), distance: radius_m * 3.1, yaw: -0.9, pitch: 0.62 };
    this.radius_m = radius_m;
    this.reset();
  }

  reset() {
    Object.assign(this, { ...this.home, centre: this.home.centre.slice() });
  }

  /** Where reset() leads from now on. */
  keepHome() {
    this.home = { centre: this.centre.slice(), distance: this.distance, yaw: this.yaw, pitch: this.pitch };
  }

  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, this.pitch + pitch));
  }

  zoom(factor) {
    this.distance = Math.min(12 * this.radius_m, Math.max(0.15 * this.radius_m, this.distance * factor));
  }

  /** Moves the room by a distance on the screen, px. */
  pan(dx, dy, focal) {
    const { right, up } = this.axes(),
      scale = this.distance / focal;
    for (let k = 0; k < 3; ++k) this.centre[k] += scale * (-dx * right[k] + dy * up[k]);
  }

  axes() {
    const cy = Math.cos(this.yaw),
      sy = Math.sin(this.yaw),
      cp = Math.cos(this.pitch),
      sp = Math.sin(this.pitch);
    return { right: [-sy, cy, 0], up: [-sp * cy, -sp * sy, cp], back: [cp * cy, cp * sy, sp] };
  }

  position() {
    const { back } = this.axes();
    return this.centre.map((c, k) => c + this.distance * back[k]);
  }

  /** A function from room coordinates to [x px, y px, depth m]; depth is not positive behind the eye. */
  projector(width, height) {
    const { right, up, back } = this.axes(),
      [cx, cy, cz] = this.centre,
      focal = this.focal(width, height);
    return (p) => {
      const x = p[0] - cx,
        y = p[1] - cy,
        z = p[2] - cz;
      const depth = this.distance - (x * back[0] + y * back[1] + z * back[2]);
      const scale = focal / Math.max(depth, 1e-3);
      return [
        width / 2 + scale * (x * right[0] + y * right[1] + z * right[2]),
        height / 2 - scale * (x * up[0] + y * up[1] + z * up[2]),
        depth,
      ];
    };
  }

  focal(width, height) {
    return 1.35 * Math.min(width, height);
  }
}
