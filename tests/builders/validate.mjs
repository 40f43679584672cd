// node validate.mjs FOLDER FILE... prints, for each file, one line: {"error code": count}
// FOLDER is where npm installed gltf-validator.
import { createRequire } from "node:module";
import { readFile } from "node:fs/promises";
import { basename, dirname, join, resolve } from "node:path";

const [folder, ...files] = process.argv.slice(2);
const validator = createRequire(join(resolve(folder), "here.js"))("gltf-validator");

for (const file of files) {
  const { issues } = await validator.validateBytes(new Uint8Array(await readFile(file)), {
    uri: basename(file),
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(await readFile(join(dirname(file), decodeURIComponent(uri)))),
  });
  const count = {};
  for (const { severity, code } of issues.messages) {
    if (severity === 0) count[code] = (count[code] ?? 0) + 1;
  }
  console.log(JSON.stringify(count));
}
