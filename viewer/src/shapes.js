// Blend shapes of USD, which three's composer of scenes leaves out: their offsets at the corners of its
// triangles, and what their animation makes of them.

import { Float32BufferAttribute, NumberKeyframeTrack } from 'three';
import { USDComposer } from 'three/examples/jsm/loaders/usd/USDComposer.js';

export class Composer extends USDComposer {
  constructor() {
    super();
    this.shaped = [];
  }

  _buildMesh(path, spec) {
    const mesh = super._buildMesh(path, spec);
    const shapes = this.specsByPath[`${path}.skel:blendShapeTargets`]?.fields.targetPaths ?? [];
    if (!shapes.length || !mesh.geometry.attributes.position) return mesh;
    const corners = this.#corners(path);
    const fields = shapes.map((shape) => this._getAttributes(shape));
    const spread = (name) => fields.map((own) => atCorners(own[name] ?? [], own.pointIndices, corners));
    mesh.geometry.morphTargetsRelative = true;
    mesh.geometry.morphAttributes.position = spread('offsets');
    if (fields.some((own) => own.normalOffsets)) mesh.geometry.morphAttributes.normal = spread('normalOffsets');
    mesh.updateMorphTargets();
    this.shaped.push({ mesh, path });
    return mesh;
  }

  /** Which point of the file each vertex of a mesh is, as the composer has cut its faces. */
  #corners(path) {
    const fields = this._getAttributes(path);
    // It takes a second pair of texture coordinates along: here the number of the point.
    const told = {
      ...fields,
      'primvars:st1': Array.from({ length: (2 * fields.points.length) / 3 }, (_, k) => k >> 1),
      'primvars:st1:indices': fields.faceVertexIndices,
    };
    const subsets = this._getGeomSubsets(path);
    const made = subsets.length ? this._buildGeometryWithSubsets(told, subsets) : this._buildGeometry(path, told);
    const { uv1 } = made.attributes;
    return Array.from({ length: uv1.count }, (_, k) => uv1.getX(k));
  }

  /** The tracks of the weights of all blend shapes; those that hold without samples are set. */
  shapeTracks() {
    const tracks = [];
    const field = (path, name) => this.specsByPath[`${path}.${name}`]?.fields ?? {};
    for (const { mesh, path } of this.shaped) {
      const skeleton = this.skeletons[field(path, 'skel:skeleton').targetPaths?.[0]];
      const order = field(skeleton?.animationPath, 'blendShapes').default ?? [];
      const columns = (field(path, 'skel:blendShapes').default ?? []).map((name) => order.indexOf(name));
      const weights = (values) => mesh.morphTargetInfluences.map((_, k) => values[columns[k]] ?? 0);
      const { default: rest, timeSamples } = field(skeleton?.animationPath, 'blendShapeWeights');
      if (rest?.length === order.length) Object.assign(mesh.morphTargetInfluences, weights(rest));
      const rows = (timeSamples?.times ?? []).map((time, k) => [time, timeSamples.values[k]]);
      const whole = rows.filter(([, values]) => values?.length === order.length);
      if (!whole.length) continue;
      const times = whole.map(([time]) => time / this.fps);
      tracks.push(new NumberKeyframeTrack(`${mesh.uuid}.morphTargetInfluences`, times, whole.flatMap(([, values]) => weights(values))));
    }
    return tracks;
  }
}

/** Offsets of some points, or of all where no numbers are given, at the corners of triangles. */
function atCorners(offsets, numbers, corners) {
  const row = numbers?.length ? new Map([...numbers].map((point, k) => [point, k])) : null;
  const spread = new Float32Array(3 * corners.length);
  corners.forEach((point, corner) => {
    const k = row ? row.get(point) : point;
    for (let i = 0; i < 3; i++) spread[3 * corner + i] = offsets[3 * k + i] ?? 0;
  });
  return new Float32BufferAttribute(spread, 3);
}
