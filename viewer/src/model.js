// One file as it is shown: three's objects of what rigtri has read, its clips, its points.

import {
  AnimationMixer,
  Box3,
  BufferGeometry,
  Color,
  Float32BufferAttribute,
  Group,
  LineBasicMaterial,
  LineSegments,
  LoopOnce,
  Object3D,
  Vector3,
} from 'three';

import { loadGltf } from './gltf.js';
import { Points } from './points.js';
import { loadUsd, localOf } from './usd.js';

// How many points, about, say how near the camera may come.
const MOST = 4000;
// Where in a clip they are looked at, to keep all of it in the picture.
const MOMENTS = [0, 0.25, 0.5, 0.75, 1];

export class Model {
  /** Load what the page carries of one file. wrong: what should have been shown. */
  static async load(facts, wrong) {
    try {
      const loaded = await (facts.kind === 'usd' ? loadUsd : loadGltf)(facts, wrong);
      return new Model(facts, loaded);
    } catch (error) {
      throw new Error(`three.js cannot show ${facts.name}: ${error.message}`, { cause: error });
    }
  }

  constructor(facts, { root, clips, object, finish }) {
    this.facts = facts;
    this.root = new Group().add(root);
    this.nodes = objects(facts.nodes, object, root);
    this.lines = drawnLines(facts, this.nodes, root);
    this.joints = facts.nodes.map((_, k) => k).filter((k) => facts.nodes[k].joint);
    this.listed = this.joints.length ? this.joints : facts.nodes.map((_, k) => k);
    this.clips = clips ?? finish(this.nodes);
    this.mixer = new AnimationMixer(root);
    this.root.updateMatrixWorld(true);
    this.points = new Points(root);
    root.traverse((one) => { one.frustumCulled = false; });
    this.box = new Box3().setFromPoints(this.cloud());
    this.points.expand(this.box);
    this.size = this.box.getSize(new Vector3()).length() || 1;
    this.reach = this.#reach();
  }

  /** Stand as a clip says at a time, in seconds; clip −1: as at rest. */
  seek(clip, time) {
    if (clip !== this.playing) {
      this.mixer.stopAllAction();
      this.playing = clip;
      if (this.clips[clip]) this.#action(clip).play();
    }
    if (this.clips[clip]) this.#action(clip).time = time;
    this.mixer.update(0);
    this.root.updateMatrixWorld(true);
  }

  /** Some points of all that is seen where it stands now, with the arrows of the nodes. */
  cloud() {
    const cloud = [...this.points.some(MOST), ...this.listed.map((node) => this.place(node))];
    if (this.reach && this.listed.length < MOST) for (const node of this.listed) cloud.push(...this.#tips(node));
    return cloud.length ? cloud : [new Vector3(-0.5, -0.5, -0.5), new Vector3(0.5, 0.5, 0.5)];
  }

  /** The same of some moments of a clip; then it stands as asked. */
  sweep(clip, time, duration) {
    const found = [];
    const moments = duration > 0 ? MOMENTS.map((share) => share * duration) : [0];
    for (const moment of moments) {
      this.seek(clip, moment);
      for (const point of this.cloud()) found.push(point);
    }
    this.seek(clip, time);
    return found;
  }

  #action(clip) {
    const action = this.mixer.clipAction(this.clips[clip]).setLoop(LoopOnce, 1);
    // The end of a clip is shown as its last key says.
    action.clampWhenFinished = true;
    action.paused = false;
    action.enabled = true;
    return action;
  }

  /** Where a node is, in the world. */
  place(node) {
    return new Vector3().setFromMatrixPosition(this.nodes[node].matrixWorld);
  }

  /** Where the arrows of a node end. */
  #tips(node) {
    const { matrixWorld } = this.nodes[node];
    const ends = [0, 1, 2].map((k) => new Vector3().setFromMatrixColumn(matrixWorld, k).setLength(this.reach[node]).add(this.place(node)));
    return ends.filter(({ x, y, z }) => Number.isFinite(x + y + z));
  }

  /** How long the arrows of each node are: a share of the way to the nearest joint that hangs on it. */
  #reach() {
    const { nodes } = this.facts;
    const nearest = new Array(nodes.length).fill(Infinity);
    for (const node of this.listed) {
      const { above } = nodes[node];
      if (above < 0) continue;
      const far = this.place(node).distanceTo(this.place(above));
      if (far > 1e-6 * this.size) nearest[above] = Math.min(nearest[above], far);
    }
    return nodes.map(({ above }, node) => {
      const own = Number.isFinite(nearest[node]) ? nearest[node] : nearest[above] ?? Infinity;
      return Math.min(Math.max(0.4 * own, 0.008 * this.size), 0.05 * this.size);
    });
  }
}

/** The object of every node that rigtri has told of; where three has made none, one that stands as told. */
function objects(nodes, object, root) {
  const found = [];
  for (const node of nodes) {
    let one = object(node.key);
    if (!one) {
      one = new Object3D();
      if (node.local) localOf(node).decompose(one.position, one.quaternion, one.scale);
      (found[node.parent] ?? root).add(one);
    }
    found.push(one);
  }
  return found;
}

/** The lines of controls: those that the loader has read, else those that rigtri has. */
function drawnLines(facts, nodes, root) {
  for (const { node, segments, color } of facts.shapes) {
    const geometry = new BufferGeometry().setAttribute('position', new Float32BufferAttribute(segments, 3));
    nodes[node].add(new LineSegments(geometry, new LineBasicMaterial({ color: new Color(...color) })));
  }
  const lines = [];
  root.traverse((one) => {
    if (!one.isLine) return;
    lines.push(one);
    // A control inside the character must be seen all the same.
    one.renderOrder = 1;
    for (const material of [one.material].flat()) Object.assign(material, { depthTest: false, transparent: true });
  });
  return lines;
}
