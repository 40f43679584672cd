// node three_vrm.mjs FOLDER JOBS.json: what three-vrm makes of node constraints, spring bones and colliders.
// FOLDER is where npm installed three and @pixiv/three-vrm. JOBS is a list of [file, output.json]. An
// output maps "node|step" to the 16 numbers of a node's world matrix, "collider key|step" to a point or
// direction in the world: while the first clip plays from its start, or at rest where there is none,
// with constraints evaluated and springs swinging.
import { readFile, writeFile } from "node:fs/promises";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, jobs] = process.argv.slice(2);
globalThis.self = globalThis;
globalThis.ProgressEvent ??= class extends Event {};
const from = (path) => import(pathToFileURL(join(resolve(folder), "node_modules", path)).href);
const THREE = await from("three/build/three.module.js");
const { GLTFLoader } = await from("three/examples/jsm/loaders/GLTFLoader.js");
const { VRMNodeConstraintLoaderPlugin, VRMSpringBoneLoaderPlugin } = await from(
  "@pixiv/three-vrm/lib/three-vrm.module.js",
);

const STEP = 1 / 60;
const STEPS = 40;
const noPictures = () => ({ name: "no-pictures", loadTexture: async () => new THREE.Texture() });

function record(nodes, colliders, label, found) {
  nodes.forEach((node, k) => (found[`${k}|${label}`] = node.matrixWorld.toArray()));
  colliders.forEach((collider, k) => {
    const place = collider.parent.matrixWorld;
    const { offset, tail, normal } = collider.shape;
    if (offset) found[`collider ${k} offset|${label}`] = offset.clone().applyMatrix4(place).toArray();
    if (tail) found[`collider ${k} tail|${label}`] = tail.clone().applyMatrix4(place).toArray();
    if (normal) found[`collider ${k} normal|${label}`] = normal.clone().transformDirection(place).toArray();
  });
}

async function evaluate(file) {
  const bytes = await readFile(file);
  const loader = new GLTFLoader().register(noPictures);
  loader.register((parser) => new VRMNodeConstraintLoaderPlugin(parser));
  loader.register((parser) => new VRMSpringBoneLoaderPlugin(parser));
  const content = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  const gltf = await loader.parseAsync(content, "");
  const nodes = await gltf.parser.getDependencies("node");
  const { vrmNodeConstraintManager: constraints, vrmSpringBoneManager: springs } = gltf.userData;
  const mixer = new THREE.AnimationMixer(gltf.scene);
  if (gltf.animations.length) mixer.clipAction(gltf.animations[0]).play();
  const found = {};
  for (let step = 0; step < STEPS; step++) {
    mixer.update(step ? STEP : 0);
    // A push, so that springs swing where no clip moves them.
    if (!gltf.animations.length) gltf.scene.position.set(0.3 * Math.sin(step / 3), 0, 0.2 * Math.sin(step / 4));
    gltf.scene.updateMatrixWorld(true);
    constraints?.update();
    gltf.scene.updateMatrixWorld(true);
    springs?.update(STEP);
    gltf.scene.updateMatrixWorld(true);
    if (step % 3 === 0) record(nodes, [...(springs?.colliders ?? [])], step, found);
  }
  found.constraints = constraints?.constraints.size ?? 0;
  found.springs = springs?.joints.size ?? 0;
  return found;
}

for (const [source, target] of JSON.parse(await readFile(jobs, "utf8"))) {
  await writeFile(target, JSON.stringify(await evaluate(source)));
}
