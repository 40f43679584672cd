// Camera, light and floor: what the characters stand on, and how they are looked at.

import {
  Box3,
  DirectionalLight,
  GridHelper,
  HemisphereLight,
  Matrix4,
  MeshBasicMaterial,
  PerspectiveCamera,
  Quaternion,
  Scene,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';

// Where to look from: ahead, to its left, above; as shares.
export const VIEWS = {
  'three-quarter': [1, 0.7, 0.35],
  front: [1, 0, 0],
  side: [0, 1, 0],
  top: [0.001, 0, 1],
};

export class Stage {
  constructor(canvas, area) {
    this.canvas = canvas;
    this.area = area;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(30, 1, 0.01, 100);
    const lamp = new DirectionalLight(0xffffff, 2.2);
    lamp.position.set(-0.5, 0.8, 1);
    this.camera.add(lamp);
    this.scene.add(this.camera, new HemisphereLight(0xffffff, 0x8a8f99, 1.8));
    this.faded = new MeshBasicMaterial({ color: 0xff8a1f, transparent: true, opacity: 0.35, depthWrite: false });
    // Behind what is in the same place, so that only what differs has its colour.
    Object.assign(this.faded, { polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8 });
    this.view = 'three-quarter';
    this.stale = true;
  }

  /** Put models on the floor, and look at all of them. */
  show(models) {
    const box = new Box3();
    for (const model of models) {
      this.scene.add(model.root);
      box.union(model.box);
    }
    const middle = box.getCenter(new Vector3());
    const size = box.getSize(new Vector3()).length() || 1;
    const floor = new GridHelper(2 * size, 20, 0x8a8f99, 0x8a8f99);
    floor.material.transparent = true;
    floor.material.opacity = 0.28;
    const { root, facts } = models[0];
    const turn = facts.kind === 'usd' ? root.children[0].quaternion : new Quaternion();
    this.ahead = new Vector3(...facts.facing).applyQuaternion(turn);
    // Of a body that stands on another axis than its file, up is that of the body.
    this.up = new Vector3(...facts.up).applyQuaternion(turn);
    floor.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), this.up);
    const low = this.up.toArray().map((along, axis) => (along < 0 ? box.max : box.min).getComponent(axis));
    floor.position.copy(middle).addScaledVector(this.up, new Vector3(...low).sub(middle).dot(this.up));
    this.scene.add(floor);
    this.camera.up.copy(this.up);
    this.controls = new OrbitControls(this.camera, this.area); // it takes the camera's up as it begins
    this.controls.addEventListener('change', () => { this.stale = true; });
    this.size = size;
    this.frame(models.flatMap((model) => model.cloud()));
  }

  /** Keep points in the picture from now on, as long as nobody has turned the camera. */
  frame(points) {
    const still = !this.cloud || this.#untouched();
    this.cloud = points;
    if (still) this.look(this.view);
  }

  /** Look at all from one of VIEWS. */
  look(name) {
    const [ahead, left, above] = VIEWS[name];
    const aside = new Vector3().crossVectors(this.up, this.ahead);
    const from = this.ahead.clone().multiplyScalar(ahead);
    from.addScaledVector(aside, left).addScaledVector(this.up, above).normalize();
    const middle = new Box3().setFromPoints(this.cloud).getCenter(new Vector3());
    Object.assign(this, { from, view: name });
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(from, this.#distance(from, middle));
    const far = Math.max(this.size, this.camera.position.distanceTo(middle));
    this.camera.near = this.size / 200;
    this.camera.far = far * 20;
    this.controls.minDistance = this.size / 50;
    this.controls.maxDistance = far * 10;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.stale = true;
  }

  /** Go about the upright axis by an angle. */
  turn(angle) {
    const { target } = this.controls;
    this.camera.position.sub(target).applyAxisAngle(this.up, angle).add(target);
    this.controls.update();
  }

  /** Go farther away by a factor. */
  zoom(factor) {
    const { target } = this.controls;
    this.camera.position.sub(target).multiplyScalar(factor).add(target);
    this.controls.update();
  }

  /** How far away all points are in the picture. */
  #distance(from, middle) {
    const turn = new Matrix4().lookAt(from, new Vector3(), this.up).transpose();
    const high = Math.tan((this.camera.fov * Math.PI) / 360);
    const wide = high * this.camera.aspect;
    let far = 0;
    for (const point of this.cloud) {
      const { x, y, z } = point.clone().sub(middle).applyMatrix4(turn);
      far = Math.max(far, z + Math.abs(x) / wide, z + Math.abs(y) / high);
    }
    return far * 1.12 || 1;
  }

  /** Fit the picture to the room it has; whether that has changed. */
  fit() {
    const { clientWidth: wide, clientHeight: high } = this.canvas;
    const ratio = Math.min(window.devicePixelRatio, 2);
    if (this.wide === wide && this.high === high && this.ratio === ratio) return false;
    const before = this.camera.aspect;
    Object.assign(this, { wide, high, ratio });
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(wide, high, false);
    this.camera.aspect = wide / Math.max(high, 1);
    this.camera.updateProjectionMatrix();
    // As long as nobody has turned the camera, all stays in the picture.
    if (this.cloud && before !== this.camera.aspect && this.#untouched()) this.look(this.view);
    return true;
  }

  #untouched() {
    const { position } = this.camera;
    return position.clone().sub(this.controls.target).normalize().distanceTo(this.from) < 1e-6;
  }

  /** Draw the models: which of them, how solid, with the lines of controls or not. */
  draw(models, state) {
    const visible = state.side === 'both' ? models : models.slice(state.side === 'before' ? 1 : 0).slice(0, 1);
    for (const model of models) {
      model.root.visible = visible.includes(model);
      const over = state.side === 'both' && model !== models[0] ? this.faded : null;
      for (const { mesh } of model.points.parts) this.#dress(mesh, state.mesh, over);
      for (const line of model.lines) line.visible = state.controls;
    }
    this.renderer.render(this.scene, this.camera);
    return visible;
  }

  #dress(mesh, look, over) {
    mesh.userData.rigtriOwn ??= mesh.material;
    const own = mesh.userData.rigtriOwn;
    mesh.material = over ? (Array.isArray(own) ? own.map(() => over) : over) : own;
    mesh.layers.mask = look === 'none' ? 0 : 1;
    if (over) return;
    for (const material of [own].flat()) {
      material.userData.rigtriOwn ??= { transparent: material.transparent, opacity: material.opacity };
      const before = material.transparent;
      Object.assign(material, material.userData.rigtriOwn);
      if (look === 'faint') Object.assign(material, { transparent: true, opacity: 0.3 });
      if (material.transparent !== before) material.needsUpdate = true;
    }
  }
}
