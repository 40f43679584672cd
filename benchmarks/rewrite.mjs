// node rewrite.mjs FOLDER SOURCE TARGET COUNT prints the seconds that glTF-Transform takes to read and write a
// file once, warm: the median, and the seconds of processors. FOLDER is where npm installed @gltf-transform/core.
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, source, target, count] = process.argv.slice(2);
const require = createRequire(join(resolve(folder), "here.js"));
const { Logger, NodeIO } = await import(pathToFileURL(require.resolve("@gltf-transform/core")));
const io = new NodeIO().setLogger(new Logger(Logger.Verbosity.SILENT));
const seconds = [];
let used = 0;
for (let k = 0; k < Number(count) + 10; k++) {
  if (k == 10) used = process.cpuUsage();
  const start = performance.now();
  await io.write(target, await io.read(source));
  seconds.push((performance.now() - start) / 1000);
}
const { user, system } = process.cpuUsage(used);
const median = seconds.slice(10).sort((a, b) => a - b)[Math.floor(Number(count) / 2)];
console.log("SECONDS", median, (user + system) / 1e6 / Number(count));
