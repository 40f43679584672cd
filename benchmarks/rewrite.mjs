// node rewrite.mjs FOLDER SOURCE TARGET COUNT prints the seconds that glTF-Transform takes to read and write a
// file once, warm, on average, and the seconds of processors. FOLDER is where npm installed @gltf-transform/core.
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, source, target, count] = process.argv.slice(2);
const require = createRequire(join(resolve(folder), "here.js"));
const { Logger, NodeIO } = await import(pathToFileURL(require.resolve("@gltf-transform/core")));
const io = new NodeIO().setLogger(new Logger(Logger.Verbosity.SILENT));
const WARM_UP = 10;
let start, used;
for (let k = 0; k < Number(count) + WARM_UP; k++) {
  if (k == WARM_UP) [start, used] = [performance.now(), process.cpuUsage()];
  await io.write(target, await io.read(source));
}
const wall = (performance.now() - start) / 1000;
const { user, system } = process.cpuUsage(used);
console.log("SECONDS", wall / Number(count), (user + system) / 1e6 / Number(count));
