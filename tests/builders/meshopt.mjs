// node meshopt.mjs FOLDER < JOBS prints for each job what meshoptimizer encodes and decodes again.
// FOLDER is where npm installed meshoptimizer; the jobs are those of meshopt_streams.py.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const require = createRequire(join(resolve(process.argv[2]), "here.js"));
const { MeshoptDecoder, MeshoptEncoder } = await import(pathToFileURL(require.resolve("meshoptimizer")));
await MeshoptDecoder.ready;
await MeshoptEncoder.ready;

const results = JSON.parse(readFileSync(0, "utf8")).map(({ raw, count, stride, mode, kind, version, level }) => {
  const elements = new Uint8Array(Buffer.from(raw, "base64"));
  const stream =
    mode === "ATTRIBUTES"
      ? MeshoptEncoder.encodeVertexBufferLevel(elements, count, stride, level, version)
      : MeshoptEncoder.encodeGltfBuffer(elements, count, stride, mode);
  const decoded = new Uint8Array(count * stride);
  MeshoptDecoder.decodeGltfBuffer(decoded, count, stride, stream, mode, kind);
  const base64 = (bytes) => Buffer.from(bytes).toString("base64");
  return { stream: base64(stream), decoded: base64(decoded) };
});
console.log(JSON.stringify(results));
