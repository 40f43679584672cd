// Lines over the picture: bones, axes, limb triangles, pole vectors, names. They follow the bones as
// they are posed, and are always in front, so that nothing of a rig hides in a mesh.

import { Matrix4, Vector3 } from 'three';

const NEUTRAL = { bone: '#2b2e33', halo: 'rgba(255,255,255,.8)' };
const DARK_NEUTRAL = { bone: '#e6e8ea', halo: 'rgba(0,0,0,.65)' };
const TAU = 2 * Math.PI;
// From this bend on, in radians, a limb itself shows its side.
const CLEAR = Math.PI / 18;
// Lines of a path: many at once are drawn faster, but not all of a crowd's.
const AT_ONCE = 500;
// Names that are longer are shortened beside their joints, as rigtri.text.shortened does it.
const LONGEST = 36;

/** Whether two boxes, left, top, width, height, share any place. */
function meet([x, y, wide, high], [u, v, width, height]) {
  return x < u + width && u < x + wide && y < v + height && v < y + high;
}

export class Overlay {
  /** crowd: there are so many lines that the processor draws them sooner than a graphics card in software. */
  constructor(canvas, crowd) {
    this.canvas = canvas;
    this.pen = canvas.getContext('2d', { willReadFrequently: crowd });
    this.dark = window.matchMedia('(prefers-color-scheme: dark)');
    this.spots = [];
  }

  /** Draw over the picture of a stage. shown: models; of two, the second faintly. */
  draw(stage, shown, state) {
    const { pen, canvas } = this;
    const { wide, high, ratio } = stage;
    if (canvas.width !== Math.round(wide * ratio) || canvas.height !== Math.round(high * ratio)) {
      canvas.width = Math.round(wide * ratio);
      canvas.height = Math.round(high * ratio);
    }
    this.look = { wide, high, near: stage.camera.near };
    this.look.matrix = new Matrix4()
      .multiplyMatrices(stage.camera.projectionMatrix, stage.camera.matrixWorldInverse).elements;
    if (this.colors?.dark !== this.dark.matches) this.colors = this.#palette();
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, wide, high);
    pen.lineCap = pen.lineJoin = 'round';
    [...shown].reverse().forEach((model) => {
      pen.globalAlpha = model === shown[0] ? 1 : 0.45;
      this.#model(model, state, model === shown[0]);
    });
    pen.globalAlpha = 1;
  }

  /** The colours that the page's style has for what they mean, as `rigtri draw` has them. */
  #palette() {
    const style = getComputedStyle(document.documentElement);
    const mark = (name) => style.getPropertyValue(`--mark-${name}`).trim();
    const dark = this.dark.matches;
    const axes = ['x', 'y', 'z'].map(mark);
    const meant = { axes, limb: mark('limb'), pole: mark('pole'), off: mark('crooked'), rule: mark('rule') };
    return { dark, ...(dark ? DARK_NEUTRAL : NEUTRAL), ...meant };
  }

  /** The name and path of the node nearest to a place in the picture, if one is near; of the model in front.
   * Of several in one place, but for rounding, the first: a joint before what stands on it. */
  near(x, y, reach) {
    let best = null;
    let least = reach * reach;
    for (const spot of this.spots) {
      const square = (spot.x - x) ** 2 + (spot.y - y) ** 2;
      if (square < least - (best ? 1 : 0)) [best, least] = [spot, square];
    }
    return best;
  }

  #model(model, state, front) {
    const at = model.nodes.map((_, node) => model.place(node));
    if (state.triangles) for (const limb of model.facts.limbs) this.#limb(model, at, limb);
    if (state.bones) this.#bones(model, at);
    if (state.axes) this.#arrows(model);
    if (!front) return;
    if (state.controls) {
      for (const [from, to] of model.facts.follows) this.#line(at[from], at[to], this.colors.rule, 1, [1, 5]);
    }
    this.spots = [];
    for (const node of [...model.listed, ...(state.controls ? model.facts.marks : [])]) {
      const spot = this.#project(at[node]);
      const { name, path, crooked } = model.facts.nodes[node];
      if (spot) this.spots.push({ name, path, x: spot[0], y: spot[1], off: crooked });
    }
    this.#spots(state);
  }

  #bones(model, at) {
    const ends = [];
    for (const node of model.listed) {
      const { above } = model.facts.nodes[node];
      const line = above >= 0 && this.#ends(at[above], at[node]);
      if (line) ends.push(line);
    }
    this.#strokes(ends, this.colors.bone, 1.5);
  }

  /** The axes of all nodes: lines and heads of one colour are drawn at once, for there may be thousands. */
  #arrows(model) {
    const axis = new Vector3();
    for (let k = 0; k < 3; k++) {
      const ends = [];
      for (const node of model.listed) {
        const { matrixWorld } = model.nodes[node];
        axis.setFromMatrixColumn(matrixWorld, k).normalize().multiplyScalar(model.reach[node]);
        if (!(axis.lengthSq() > 0)) continue;
        const from = new Vector3().setFromMatrixPosition(matrixWorld);
        const line = this.#ends(from, axis.add(from));
        if (line) ends.push(line);
      }
      this.#strokes(ends, this.colors.axes[k], 2);
      this.#heads(ends, this.colors.axes[k]);
    }
  }

  /**
   * A limb ABC: its triangle, P, the point of AC nearest to B, and the way from B to the pole. That is as B is
   * bent from 10° on, else as its side at rest goes with A.
   */
  #limb({ nodes }, at, { joints, pole, side }) {
    const [a, b, c] = joints.map((node) => at[node]);
    const chord = new Vector3().subVectors(c, a);
    const along = new Vector3().subVectors(b, a);
    const share = along.dot(chord) / (chord.lengthSq() || 1);
    const foot = new Vector3().copy(a).addScaledVector(chord, share);
    const limb = along.length() + b.distanceTo(c);
    const out = new Vector3().subVectors(b, foot);
    this.#fill([a, b, c], this.colors.limb);
    this.#line(a, b, this.colors.limb, 2);
    this.#line(b, c, this.colors.limb, 2);
    this.#line(a, c, this.colors.limb, 1.5, [5, 4]);
    const straight = out.length() <= 1e-4 * limb;
    if (!straight) this.#line(foot, b, this.colors.limb, 1.5, [2, 4]);
    this.#dot(foot, 2.5, this.colors.limb);
    if (pole >= 0) {
      this.#line(b, at[pole], this.colors.pole, 1.5, [6, 4]);
      this.#dot(at[pole], 4, this.colors.pole);
      return;
    }
    const clear = !straight && along.angleTo(new Vector3().subVectors(c, b)) > CLEAR;
    if (side && !clear) {
      out.set(...side).transformDirection(nodes[joints[0]].matrixWorld).projectOnPlane(chord.normalize());
    } else if (straight) return;
    this.#arrow(b, out.setLength(0.5 * limb).add(b), this.colors.pole, 1.5, [6, 4]);
  }

  #spots(state) {
    const { pen } = this;
    const marked = [state.hover, state.selected];
    // Joints over what stands on them.
    for (const { path, x, y, off } of [...this.spots].reverse()) {
      const chosen = marked.includes(path);
      if (state.bones || chosen) this.#ring(x, y, chosen ? 6 : off ? 4 : 2.5, chosen, off);
    }
    const size = Math.max(11, Math.min(14, this.look.wide / 60));
    pen.font = `${size}px system-ui, sans-serif`;
    pen.textBaseline = 'middle';
    const taken = [];
    const selected = this.spots.filter(({ path }) => path === state.selected);
    for (const spot of selected) this.#name(spot, size, taken, true);
    if (state.names) for (const spot of this.spots) if (!selected.includes(spot)) this.#name(spot, size, taken);
  }

  /** A name on the right of its spot, or on the left, where there is room; always, where that is asked. */
  #name({ name: whole, x, y }, size, taken, always = false) {
    const { pen } = this;
    const end = (LONGEST - 1) >> 1;
    const name = whole.length > LONGEST
      ? `${whole.slice(0, LONGEST - 1 - end)}…${whole.slice(whole.length - end)}`
      : whole;
    const wide = pen.measureText(name).width;
    const rooms = [x + 8, x - 8 - wide].map((left) => [left, y - size / 2, wide, size]);
    const inside = rooms.filter(([left]) => left >= 0 && left + wide <= this.look.wide);
    const room = inside.find((one) => !taken.some((other) => meet(one, other))) ?? (always ? inside[0] ?? rooms[0] : null);
    if (!room) return;
    taken.push(room);
    pen.lineWidth = 3;
    pen.strokeStyle = this.colors.halo;
    pen.strokeText(name, room[0], y);
    pen.fillStyle = this.colors.bone;
    pen.fillText(name, room[0], y);
  }

  #ring(x, y, radius, open, off) {
    const { pen } = this;
    pen.beginPath();
    pen.arc(x, y, radius, 0, TAU);
    const color = off ? this.colors.off : this.colors.bone;
    pen.fillStyle = color;
    pen.strokeStyle = open ? color : this.colors.halo;
    pen.lineWidth = open ? 2 : 1;
    if (!open) pen.fill();
    pen.stroke();
  }

  #dot(point, radius, color) {
    const spot = this.#project(point);
    if (!spot) return;
    this.pen.beginPath();
    this.pen.arc(spot[0], spot[1], radius, 0, TAU);
    this.pen.fillStyle = color;
    this.pen.fill();
  }

  #fill(points, color) {
    const spots = points.map((point) => this.#project(point));
    if (!spots.every(Boolean)) return;
    const { pen } = this;
    const before = pen.globalAlpha;
    pen.beginPath();
    spots.forEach(([x, y]) => pen.lineTo(x, y));
    pen.globalAlpha = before * 0.22;
    pen.fillStyle = color;
    pen.fill();
    pen.globalAlpha = before;
  }

  #arrow(from, to, color, width, dash = []) {
    const ends = this.#line(from, to, color, width, dash);
    if (ends) this.#heads([ends], color);
  }

  /** The heads of arrows that are long enough in the picture. */
  #heads(lines, color) {
    const { pen } = this;
    pen.fillStyle = color;
    for (let first = 0; first < lines.length; first += AT_ONCE) {
      pen.beginPath();
      for (const [[x, y], [u, v]] of lines.slice(first, first + AT_ONCE)) {
        const long = Math.hypot(u - x, v - y);
        if (long < 3) continue;
        const head = Math.min(7, 0.5 * long);
        const [s, t] = [((u - x) / long) * head, ((v - y) / long) * head];
        pen.moveTo(u, v);
        pen.lineTo(u - s - t * 0.45, v - t + s * 0.45);
        pen.lineTo(u - s + t * 0.45, v - t - s * 0.45);
        pen.closePath();
      }
      pen.fill();
    }
  }

  #line(from, to, color, width, dash = []) {
    const ends = this.#ends(from, to);
    if (ends) this.#strokes([ends], color, width, dash);
    return ends;
  }

  /** Both ends of a line in the picture; null where one is behind the camera. */
  #ends(from, to) {
    const ends = [this.#project(from), this.#project(to)];
    return ends[0] && ends[1] ? ends : null;
  }

  /** Lines of one colour, each with a light around it unless it is dashed. */
  #strokes(lines, color, width, dash = []) {
    const { pen } = this;
    for (let first = 0; first < lines.length; first += AT_ONCE) {
      pen.beginPath();
      for (const [[x, y], [u, v]] of lines.slice(first, first + AT_ONCE)) {
        pen.moveTo(x, y);
        pen.lineTo(u, v);
      }
      pen.setLineDash([]);
      pen.strokeStyle = this.colors.halo;
      pen.lineWidth = width + 2;
      if (!dash.length) pen.stroke();
      pen.setLineDash(dash);
      pen.strokeStyle = color;
      pen.lineWidth = width;
      pen.stroke();
    }
    pen.setLineDash([]);
  }

  /** Where a point is in the picture; null behind the camera. */
  #project({ x, y, z }) {
    const { matrix: e, wide, high, near } = this.look;
    const w = e[3] * x + e[7] * y + e[11] * z + e[15];
    if (!(w > near)) return null;
    const u = (e[0] * x + e[4] * y + e[8] * z + e[12]) / w;
    const v = (e[1] * x + e[5] * y + e[9] * z + e[13]) / w;
    return [((u + 1) / 2) * wide, ((1 - v) / 2) * high];
  }
}
