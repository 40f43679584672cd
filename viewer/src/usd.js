// USD by three's reader of crate files and its composer of scenes, in which bones have the names of
// joints without their paths. Here bones are known by number, stand below the prim of their skeleton,
// and play what it is bound to, whatever they are called.

import {
  AnimationClip,
  InterpolateDiscrete,
  InterpolateLinear,
  Matrix4,
  QuaternionKeyframeTrack,
  VectorKeyframeTrack,
} from 'three';
import { USDCParser } from 'three/examples/jsm/loaders/usd/USDCParser.js';

import { bytesOf } from './carried.js';
import { Composer } from './shapes.js';

/** Three's reader, which takes small vectors of doubles for numbers where they stand in the file's table. */
class Crate extends USDCParser {
  _readInlinedValue(value) {
    const count = { 19: 2, 23: 3, 27: 4 }[value.typeEnum];
    if (!count) return super._readInlinedValue(value);
    const bytes = new Int8Array(new Uint32Array([value.getInlinedValue()]).buffer);
    return [...bytes.subarray(0, count)];
  }
}

const KINDS = [
  ['translations', 'position', VectorKeyframeTrack, 3],
  ['rotations', 'quaternion', QuaternionKeyframeTrack, 4],
  ['scales', 'scale', VectorKeyframeTrack, 3],
];

/**
 * A model: the object that holds all, the object of a node's key, and what makes one clip of all that
 * moves, for USD plays all at once, when the objects of all nodes are there.
 */
export async function loadUsd(model, wrong) {
  const assets = Object.fromEntries(model.files.map((file) => [file.name, bytesOf(file.id)]));
  await Promise.all(model.files.map(({ name }) => checked(name, assets[name], model.name, wrong)));
  const composer = new Composer();
  const root = composer.compose(new Crate().parseData(bytesOf(model.data).buffer), assets);
  await Promise.all(composer.texturePromises);
  delete root.skeleton;
  const objects = new Map();
  byPath(root, '', objects);
  const tracks = [];
  for (const [path, { skeleton, joints, animationPath }] of Object.entries(composer.skeletons)) {
    skeleton.bones.forEach((bone, k) => objects.set(`${path}#${k}`, bone));
    if (animationPath) tracks.push(...jointTracks(composer, animationPath, joints, skeleton.bones));
  }
  tracks.push(...composer.shapeTracks());
  const finish = (nodes) => {
    holdBones(nodes, model.nodes);
    tracks.push(...model.tracks.map((track) => primTrack(track, nodes)));
    return tracks.length ? [new AnimationClip(model.clips[0]?.name ?? 'animation', -1, tracks)] : [];
  };
  return { root, object: (key) => objects.get(key), finish };
}

/** Count an image that the browser cannot read; the composer leaves it out. */
async function checked(name, bytes, file, wrong) {
  try {
    (await createImageBitmap(new Blob([bytes]))).close();
  } catch {
    wrong(`${file}: this browser cannot read the image ${name}`);
  }
}

/** The objects of prims, by path; bones are no prims. */
function byPath(object, path, found) {
  for (const child of object.children) {
    if (child.isBone) continue;
    found.set(`${path}/${child.name}`, child);
    byPath(child, `${path}/${child.name}`, found);
  }
}

/** Put joints below what is above them in the file; the composer puts the topmost below a mesh. */
function holdBones(nodes, facts) {
  facts.forEach((node, k) => {
    const above = nodes[node.parent];
    if (node.joint && above && nodes[k].parent !== above) above.add(nodes[k]);
  });
}

/** The track of a prim, which rigtri has read from its ops. */
function primTrack({ node, path, step, times, values }, nodes) {
  const [, property, Kind] = KINDS.find(([name]) => name === `${path}s`);
  return new Kind(`${nodes[node].uuid}.${property}`, times, values, step ? InterpolateDiscrete : InterpolateLinear);
}

/** The tracks of the joints of a skeleton, from the samples of the animation that it is bound to. */
function jointTracks(composer, path, joints, bones) {
  const order = composer.specsByPath[`${path}.joints`]?.fields.default ?? [];
  const tracks = [];
  for (const [attribute, property, Kind, width] of KINDS) {
    const fields = composer.specsByPath[`${path}.${attribute}`]?.fields ?? {};
    const samples = fields.timeSamples ?? (fields.default ? { times: [0], values: [fields.default] } : null);
    if (!samples) continue;
    const whole = samples.times.map((_, k) => k).filter((k) => samples.values[k]?.length === order.length * width);
    const times = whole.map((k) => samples.times[k] / composer.fps);
    order.forEach((token, place) => {
      const bone = bones[joints.indexOf(token)];
      if (!bone || !times.length) return;
      const values = whole.flatMap((k) => [...samples.values[k].slice(place * width, (place + 1) * width)]);
      tracks.push(new Kind(`${bone.uuid}.${property}`, times, values));
    });
  }
  return tracks;
}

/** The local matrix that rigtri has read for a node that the composer makes no object of. */
export function localOf(node) {
  // Row by row of a row-vector matrix is column by column of three's.
  return new Matrix4().fromArray(node.local);
}
