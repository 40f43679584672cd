// Where the points of meshes are now: morphed and skinned as the picture has them, but in double
// precision, to be compared.

import { Matrix4, Vector3 } from 'three';

/** All meshes below an object, in its order. */
export class Points {
  constructor(root) {
    this.parts = [];
    root.traverse((object) => {
      if (object.isMesh && object.geometry.attributes.position) this.parts.push(new Part(object));
    });
    this.count = this.parts.reduce((sum, part) => sum + part.count, 0);
  }

  /** Why these and others are no two states of the same points; '' where they are. */
  unlike(other) {
    if (this.parts.length !== other.parts.length) {
      const before = other.parts.length;
      return `${before} ${before === 1 ? 'mesh' : 'meshes'} before, ${this.parts.length} after`;
    }
    const k = this.parts.findIndex((part, place) => part.count !== other.parts[place].count);
    return k < 0 ? '' : `a mesh with ${other.parts[k].count} points before has ${this.parts[k].count} after`;
  }

  /** The largest distance of a point from the same point of others, in the world. */
  farthest(other) {
    let most = 0;
    this.parts.forEach((part, k) => {
      const here = part.world();
      const there = other.parts[k].world();
      for (let i = 0; i < here.length; i += 3) {
        const x = here[i] - there[i];
        const y = here[i + 1] - there[i + 1];
        const z = here[i + 2] - there[i + 2];
        const square = x * x + y * y + z * z;
        if (!(square <= most)) most = square;
      }
    });
    return Math.sqrt(most);
  }

  /** Some of the points, about as many as asked for. */
  some(most) {
    const step = 3 * Math.max(1, Math.ceil(this.count / most));
    const found = [];
    for (const part of this.parts) {
      const points = part.world();
      for (let i = 0; i < points.length; i += step) found.push(new Vector3().fromArray(points, i));
    }
    return found.filter(({ x, y, z }) => Number.isFinite(x + y + z));
  }

  /** Make a box hold all points. */
  expand(box) {
    const point = new Vector3();
    for (const part of this.parts) {
      const points = part.world();
      for (let i = 0; i < points.length; i += 3) {
        point.fromArray(points, i);
        if (Number.isFinite(point.x + point.y + point.z)) box.expandByPoint(point);
      }
    }
  }
}

/** The points of one mesh. */
class Part {
  constructor(mesh) {
    this.mesh = mesh;
    const { position, skinIndex, skinWeight } = mesh.geometry.attributes;
    this.count = position.count;
    this.base = numbers(position, 3);
    this.morphs = (mesh.geometry.morphAttributes.position ?? []).map((attribute) => numbers(attribute, 3));
    const skinned = mesh.isSkinnedMesh && skinIndex && skinWeight;
    this.bones = skinned ? numbers(skinIndex, 4) : null;
    this.weights = skinned ? numbers(skinWeight, 4) : null;
  }

  world() {
    const { mesh } = this;
    const points = this.bones ? this.#skinned(this.#morphed()) : Float64Array.from(this.#morphed());
    const place = mesh.matrixWorld.clone();
    if (this.bones) {
      if (mesh.bindMode !== 'detached') return points;
      place.multiply(mesh.bindMatrixInverse);
    }
    const e = place.elements;
    for (let i = 0; i < points.length; i += 3) moved(points, i, e, points[i], points[i + 1], points[i + 2]);
    return points;
  }

  #morphed() {
    const weights = this.mesh.morphTargetInfluences ?? [];
    if (!this.morphs.some((_, k) => weights[k])) return this.base;
    const points = Float64Array.from(this.base);
    this.morphs.forEach((offsets, k) => {
      const weight = weights[k];
      if (weight) for (let i = 0; i < points.length; i++) points[i] += weight * offsets[i];
    });
    return points;
  }

  #skinned(base) {
    const { skeleton, bindMatrix } = this.mesh;
    const matrices = skeleton.bones.map((bone, k) =>
      new Matrix4().multiplyMatrices(bone.matrixWorld, skeleton.boneInverses[k]).multiply(bindMatrix).elements,
    );
    const points = new Float64Array(base.length);
    const blend = new Float64Array(16);
    for (let v = 0; v < this.count; v++) {
      blend.fill(0);
      for (let k = 4 * v; k < 4 * v + 4; k++) {
        const weight = this.weights[k];
        if (weight === 0) continue;
        const matrix = matrices[this.bones[k]];
        for (let i = 0; i < 16; i++) blend[i] += weight * matrix[i];
      }
      moved(points, 3 * v, blend, base[3 * v], base[3 * v + 1], base[3 * v + 2]);
    }
    return points;
  }
}

/** Write the point x, y, z, moved by a matrix, at a place. */
function moved(points, at, e, x, y, z) {
  points[at] = e[0] * x + e[4] * y + e[8] * z + e[12];
  points[at + 1] = e[1] * x + e[5] * y + e[9] * z + e[13];
  points[at + 2] = e[2] * x + e[6] * y + e[10] * z + e[14];
}

function numbers(attribute, width) {
  const found = new Float64Array(attribute.count * width);
  for (let k = 0; k < attribute.count; k++) {
    for (let i = 0; i < width; i++) found[k * width + i] = attribute.getComponent(k, i);
  }
  return found;
}
