// node three_points.mjs FOLDER JOBS.json: what three.js shows, of files that GLTFLoader or USDLoader reads.
// FOLDER is where npm installed three. JOBS is a list of [file, output.json]. An output maps
// "mesh|clip|moment" to the vertices of a mesh in the world, float64 in base64: for every clip at its
// start, a third, two thirds and its end, and once at rest.
import { readFile, writeFile } from "node:fs/promises";
import { dirname, extname, join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, jobs] = process.argv.slice(2);
// Loaders reach for a browser; no picture is drawn here, so what they find may do nothing.
globalThis.self = globalThis;
globalThis.ProgressEvent ??= class extends Event {};
globalThis.document ??= { createElementNS: () => ({ addEventListener() {}, removeEventListener() {} }) };
const root = join(resolve(folder), "node_modules", "three");
const from = (path) => import(pathToFileURL(join(root, path)).href);
const THREE = await from("build/three.module.js");
const { GLTFLoader } = await from("examples/jsm/loaders/GLTFLoader.js");
const { USDLoader } = await from("examples/jsm/loaders/USDLoader.js");
const { MeshoptDecoder } = await from("examples/jsm/libs/meshopt_decoder.module.js");

const SHARES = [0, 1 / 3, 2 / 3, 1];
const noPictures = () => ({ name: "no-pictures", loadTexture: async () => new THREE.Texture() });
const buffer = (bytes) => bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);

async function embedded(text, place) {
  const gltf = JSON.parse(text);
  for (const item of gltf.buffers ?? []) {
    if (item.uri === undefined || item.uri.startsWith("data:")) continue;
    const bytes = await readFile(join(place, decodeURIComponent(item.uri)));
    item.uri = "data:application/octet-stream;base64," + bytes.toString("base64");
  }
  return JSON.stringify(gltf);
}

async function load(file) {
  const bytes = await readFile(file);
  if (extname(file).startsWith(".usd")) {
    const scene = new USDLoader().parse(buffer(bytes));
    return { scene, animations: scene.animations, name: (mesh) => mesh.name };
  }
  const loader = new GLTFLoader().register(noPictures).setMeshoptDecoder(MeshoptDecoder);
  const content = bytes.toString("latin1", 0, 4) === "glTF" ? buffer(bytes) : await embedded(bytes.toString("utf8").replace(/^\uFEFF/, ""), dirname(file));
  const { scene, scenes, animations, parser } = await loader.parseAsync(content, "");
  const all = new THREE.Group();
  for (const one of scenes.length ? scenes : [scene]) all.add(one);
  const name = (mesh) => {
    const { meshes, primitives } = parser.associations.get(mesh) ?? {};
    return `${meshes}.${primitives ?? 0}`;
  };
  return { scene: all, animations, name };
}

function vertices(scene, name, label, found) {
  scene.updateMatrixWorld(true);
  const point = new THREE.Vector3();
  const times = new Map();
  scene.traverse((mesh) => {
    if (!mesh.isMesh && !mesh.isLine && !mesh.isPoints) return;
    mesh.skeleton?.update();
    const place = mesh.geometry.attributes.position;
    const points = new Float64Array(place.count * 3);
    for (let i = 0; i < place.count; i++) {
      if (mesh.isMesh) mesh.getVertexPosition(i, point);
      else point.fromBufferAttribute(place, i);
      point.applyMatrix4(mesh.matrixWorld).toArray(points, 3 * i);
    }
    // Meshes that several nodes show are told apart by their order.
    const key = name(mesh);
    times.set(key, (times.get(key) ?? 0) + 1);
    found[`${key}#${times.get(key)}|${label}`] = Buffer.from(points.buffer).toString("base64");
  });
}

async function evaluate(file) {
  const { scene, animations, name } = await load(file);
  const found = {};
  vertices(scene, name, "rest", found);
  for (const clip of animations) {
    for (const share of SHARES) {
      const mixer = new THREE.AnimationMixer(scene);
      const action = mixer.clipAction(clip).setLoop(THREE.LoopOnce).play();
      action.clampWhenFinished = true;
      action.time = clip.duration * share;
      mixer.update(0);
      vertices(scene, name, `${clip.name}|${share.toFixed(2)}`, found);
      mixer.stopAllAction();
      mixer.uncacheRoot(scene);
    }
  }
  return found;
}

for (const [source, target] of JSON.parse(await readFile(jobs, "utf8"))) {
  await writeFile(target, JSON.stringify(await evaluate(source)));
}
