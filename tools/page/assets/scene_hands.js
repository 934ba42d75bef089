"use strict";

// What hands do to a scene: drag turns, wheel and pinch zoom, shift-drag moves, a click picks, keys do the same.
class SceneHands {
  constructor(scene) {
    this.scene = scene;
    this.pointers = new Map();
    this.travelled = 0;
    this.listen();
  }

  showTip(x, y) {
    const { tip, canvas } = this.scene, target = this.pointers.size > 0 ? null : this.scene.pick(x, y);
    if (!tip) return;
    tip.style.display = target && target.thing.tip ? "block" : "none";
    if (!target || !target.thing.tip) return;
    tip.textContent = typeof target.thing.tip === "function" ? target.thing.tip() : target.thing.tip;
    tip.style.left = `${canvas.offsetLeft + Math.min(x + 14, canvas.clientWidth - tip.offsetWidth - 8)}px`;
    tip.style.top = `${canvas.offsetTop + Math.min(y + 14, canvas.clientHeight - tip.offsetHeight - 8)}px`;
  }

  listen() {
    const c = this.scene.canvas;
    c.addEventListener("pointerdown", (e) => {
      c.setPointerCapture(e.pointerId);
      this.pointers.set(e.pointerId, [e.offsetX, e.offsetY]);
      this.travelled = 0;
      c.focus({ preventScroll: true });
    });
    c.addEventListener("pointermove", (e) => this.move(e));
    const release = (e) => {
      if (!this.pointers.delete(e.pointerId) || this.travelled > 4 || e.type !== "pointerup") return;
      const target = this.scene.pick(e.offsetX, e.offsetY);
      this.scene.onPick(target ? target.thing.key : null);
    };
    c.addEventListener("pointerup", release);
    c.addEventListener("pointercancel", release);
    c.addEventListener("pointerleave", () => {
      if (this.scene.tip) this.scene.tip.style.display = "none";
    });
    c.addEventListener("contextmenu", (e) => e.preventDefault());
    c.addEventListener("wheel", (e) => this.wheel(e), { passive: false });
    c.addEventListener("keydown", (e) => this.key(e, this.focal()));
  }

  focal() {
    return this.scene.camera.focal(this.scene.canvas.clientWidth, this.scene.canvas.clientHeight);
  }

  move(e) {
    const focal = this.focal();
    const last = this.pointers.get(e.pointerId);
    if (!last) return this.showTip(e.offsetX, e.offsetY);
    const dx = e.offsetX - last[0],
      dy = e.offsetY - last[1],
      before = this.spread();
    this.pointers.set(e.pointerId, [e.offsetX, e.offsetY]);
    this.travelled += Math.hypot(dx, dy);
    if (this.pointers.size > 1) {
      // two fingers: pinch and move
      const after = this.spread();
      if (before > 0 && after > 0) this.scene.camera.zoom(before / after);
      this.scene.camera.pan(dx / 2, dy / 2, focal);
    } else if (e.shiftKey || e.buttons & 6) this.scene.camera.pan(dx, dy, focal);
    else this.scene.camera.turn(-dx * 0.007, dy * 0.007);
    this.scene.schedule();
  }

  wheel(e) {
    e.preventDefault();
    this.scene.camera.zoom(Math.exp(Math.sign(e.deltaY) * Math.min(120, Math.abs(e.deltaY)) * 0.0012));
    this.scene.schedule();
  }

  spread() {
    const [a, b] = [...this.pointers.values()];
    return b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
  }

  key(e, focal) {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[e.key];
    if (step && e.shiftKey) this.scene.camera.pan(20 * step[0], 20 * step[1], focal);
    else if (step) this.scene.camera.turn(0.09 * step[0], -0.09 * step[1]);
    else if (e.key === "+" || e.key === "=") this.scene.camera.zoom(0.88);
    else if (e.key === "-") this.scene.camera.zoom(1 / 0.88);
    else if (e.key === "Home" || e.key === "0") this.scene.camera.reset();
    else return;
    e.preventDefault();
    this.scene.schedule();
  }
}
