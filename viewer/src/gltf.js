// glTF and VRM by three's own loader, and what it cannot read told instead of ending all. What a page
// is without was told by rigtri already.

import { BufferAttribute, BufferGeometry, Float32BufferAttribute, Group, LoadingManager } from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

import { bytesOf, Files, LACKING } from './carried.js';

/**
 * A model: the object that holds all, its clips in the file's order, and the object of a node's key,
 * its index in the file. wrong: what should have been shown, and is counted.
 */
export async function loadGltf(model, wrong) {
  const files = new Files(model.files);
  const manager = new LoadingManager();
  manager.setURLModifier((uri) => files.address(uri));
  // What is lacking is told already.
  manager.onError = (uri) => uri !== LACKING && wrong(`${model.name}: this browser cannot read ${files.named(uri)}`);
  const loader = new GLTFLoader(manager).setDRACOLoader(new Draco((text) => wrong(`${model.name}: ${text}`)));
  if (model.decoders.includes('meshopt')) loader.setMeshoptDecoder((await import('meshoptimizer/decoder')).MeshoptDecoder);
  loader.register((parser) => new NoImage(parser));
  const gltf = await loader.parseAsync(bytesOf(model.data).buffer, '');
  const objects = await everyNode(gltf.parser);
  // All that no other node holds, whatever scene it is in: rigtri reads all nodes, too.
  const known = new Set(objects);
  const root = new Group();
  for (const object of objects) if (!known.has(object.parent)) root.add(object);
  return { root, clips: gltf.animations, object: (key) => objects[key] };
}

/** The objects of all nodes; where scenes share nodes, the loader puts copies into some of them. */
function everyNode(parser) {
  return Promise.all((parser.json.nodes ?? []).map((_, k) => parser.getDependency('node', k)));
}

/** What the loader asks for meshes that are compressed with Draco; a broken one has no points. */
class Draco {
  constructor(wrong) {
    this.wrong = wrong;
  }

  preload() {
    return this;
  }

  async decodeDracoFile(buffer, done, ids, types) {
    const geometry = new BufferGeometry();
    try {
      // The script of the decoder, src/draco.js, stands in the pages that need it.
      const { index, attributes } = await globalThis.rigtriDraco.decode(new Int8Array(buffer), ids, types);
      geometry.setIndex(new BufferAttribute(index, 1));
      for (const [name, { array, width }] of Object.entries(attributes)) {
        geometry.setAttribute(name, new BufferAttribute(array, width));
      }
    } catch (error) {
      this.wrong(`a mesh that is compressed with Draco cannot be read: ${error.message}`);
      for (const name of Object.keys(ids)) geometry.setAttribute(name, new Float32BufferAttribute([], 3));
      geometry.setIndex([]);
    }
    done(geometry);
  }
}

/** No texture, instead of no character, where a file has no image for it that three can read. */
class NoImage {
  constructor(parser) {
    Object.assign(this, { name: 'KHR_texture_basisu', parser });
  }

  loadTexture(index) {
    const { source, extensions } = this.parser.json.textures[index];
    const own = extensions?.EXT_texture_webp ?? extensions?.EXT_texture_avif;
    const image = this.parser.json.images?.[own?.source ?? source];
    return image && !isDrawing(image) ? null : Promise.resolve(null);
  }
}

/** Whether an image is SVG, which three cannot read; `rigtri view` has told so. */
function isDrawing(image) {
  return image.mimeType === 'image/svg+xml' || /^data:image\/svg|\.svg$/i.test(image.uri ?? '');
}
