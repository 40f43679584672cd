// node rewrite.mjs FOLDER SOURCE TARGET COUNT prints the seconds that glTF-Transform takes to read and write a
// file once, warm, on average, and the seconds of processors. FOLDER is where npm installed
// @gltf-transform/core. With COUNT 0 it does so once, as a script of a new process.
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, source, target, count] = process.argv.slice(2);
const require = createRequire(join(resolve(folder), "here.js"));
const { Logger, NodeIO } = await import(pathToFileURL(require.resolve("@gltf-transform/core")));
const io = new NodeIO().setLogger(new Logger(Logger.Verbosity.SILENT));
const repeat = Number(count);
// Until the compiler of node has seen all that runs often.
const WARM_UP = repeat ? Math.min(10, 2 + repeat) : 1;
let start, used;
for (let k = 0; k < repeat + WARM_UP; k++) {
  if (k == WARM_UP) [start, used] = [performance.now(), process.cpuUsage()];
  await io.write(target, await io.read(source));
}
if (repeat) {
  const wall = (performance.now() - start) / 1000;
  const { user, system } = process.cpuUsage(used);
  console.log("SECONDS", wall / repeat, (user + system) / 1e6 / repeat);
}
