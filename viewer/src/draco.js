// Draco's decoder, a script of its own, for only pages with meshes that are compressed so carry it.
// build.mjs puts Draco's own program, DracoDecoderModule, before this.

import wasmBinary from 'three/examples/jsm/libs/draco/gltf/draco_decoder.wasm';

const TYPES = {
  Int8Array: 'DT_INT8', Uint8Array: 'DT_UINT8', Int16Array: 'DT_INT16', Uint16Array: 'DT_UINT16',
  Int32Array: 'DT_INT32', Uint32Array: 'DT_UINT32', Float32Array: 'DT_FLOAT32',
};
// What is given looks like a promise, and would be awaited for ever: so it stands in a list.
const ready = new Promise((done) => { DracoDecoderModule({ wasmBinary, onModuleLoaded: (draco) => done([draco]) }); });

/**
 * The triangles and attributes of a compressed mesh. ids: Draco's number of each attribute, by name;
 * types: what typed array its numbers are to be, by name; others are left out.
 */
export async function decode(bytes, ids, types) {
  const [draco] = await ready;
  const decoder = new draco.Decoder();
  const mesh = new draco.Mesh();
  try {
    const status = decoder.DecodeArrayToMesh(bytes, bytes.byteLength, mesh);
    if (!status.ok() || !mesh.ptr) throw new Error(status.error_msg());
    const index = copied(draco, Uint32Array, 3 * mesh.num_faces(), (size, at) => decoder.GetTrianglesUInt32Array(mesh, size, at));
    const attributes = {};
    for (const [name, id] of Object.entries(ids)) {
      const attribute = types[name] && decoder.GetAttributeByUniqueId(mesh, id);
      if (!attribute?.ptr) continue;
      const width = attribute.num_components();
      const type = draco[TYPES[types[name]]];
      const array = copied(draco, globalThis[types[name]], width * mesh.num_points(), (size, at) =>
        decoder.GetAttributeDataArrayForAllPoints(mesh, attribute, type, size, at));
      attributes[name] = { array, width };
    }
    return { index, attributes };
  } finally {
    draco.destroy(mesh);
    draco.destroy(decoder);
  }
}

/** Numbers that Draco writes into its own memory, taken out of it. */
function copied(draco, Type, count, write) {
  const size = count * Type.BYTES_PER_ELEMENT;
  const at = draco._malloc(size);
  write(size, at);
  // The memory may have grown, and be another, while Draco wrote.
  const found = new Type(draco.HEAPF32.buffer, at, count).slice();
  draco._free(at);
  return found;
}
