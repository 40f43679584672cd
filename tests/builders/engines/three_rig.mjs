// node three_rig.mjs FOLDER JOBS.json: what GLTFLoader of three.js makes of the nodes that rigtri added.
// FOLDER is where npm installed three. JOBS is a list of [file, output.json]. An output has ``things``:
// of every object with userData.rigtri its name, that note, whether it is visible, its world matrix, and
// of what it draws as lines the kind of object, the ends of every line in the world and the colour.
import { readFile, writeFile } from "node:fs/promises";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, jobs] = process.argv.slice(2);
globalThis.self = globalThis;
globalThis.ProgressEvent ??= class extends Event {};
const root = join(resolve(folder), "node_modules", "three");
const from = (path) => import(pathToFileURL(join(root, path)).href);
const THREE = await from("build/three.module.js");
const { GLTFLoader } = await from("examples/jsm/loaders/GLTFLoader.js");
const noPictures = () => ({ name: "no-pictures", loadTexture: async () => new THREE.Texture() });

// As WebGL draws them: LineLoop closes, LineSegments takes two and two, Line all in a row.
function ends(line) {
  const place = line.geometry.attributes.position;
  const at = (i) => new THREE.Vector3().fromBufferAttribute(place, i % place.count).applyMatrix4(line.matrixWorld).toArray();
  const step = line.isLineSegments ? 2 : 1;
  const count = line.isLineLoop ? place.count : place.count - 1;
  const found = [];
  for (let i = 0; i < count; i += step) found.push([at(i), at(i + 1)]);
  return found;
}

function told(thing) {
  const lines = thing.isLine ? { type: thing.type, ends: ends(thing), color: thing.material.color.toArray() } : null;
  const world = thing.matrixWorld.toArray();
  return { name: thing.name, note: thing.userData.rigtri, visible: thing.visible, world, lines };
}

for (const [source, target] of JSON.parse(await readFile(jobs, "utf8"))) {
  const bytes = await readFile(source);
  const content = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  const { scene } = await new GLTFLoader().register(noPictures).parseAsync(content, "");
  scene.updateMatrixWorld(true);
  const things = [];
  scene.traverse((thing) => {
    if (thing.userData.rigtri) things.push(told(thing));
  });
  await writeFile(target, JSON.stringify({ things }));
}
