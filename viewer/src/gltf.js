// glTF and VRM by three's own loader, and what it cannot read told instead of ending all.

import { BufferGeometry, Float32BufferAttribute, Group, LoadingManager } from 'three';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

import { bytesOf, Files, LACKING } from './carried.js';

/**
 * A model: the object that holds all, its clips in the file's order, and the object of a node's key,
 * its index in the file. tell: what cannot be shown. wrong: what should have been, and is counted.
 */
export async function loadGltf(model, tell, wrong) {
  const files = new Files(model.files);
  const manager = new LoadingManager();
  manager.setURLModifier((uri) => files.address(uri));
  // What is lacking is told already.
  manager.onError = (uri) => uri !== LACKING && wrong(`${model.name}: this browser cannot read ${files.named(uri)}`);
  const loader = new GLTFLoader(manager).setDRACOLoader(new NoDraco(tell));
  if (model.meshopt) loader.setMeshoptDecoder((await import('meshoptimizer/decoder')).MeshoptDecoder);
  loader.register((parser) => new NoBasis(parser, tell));
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

/** In the place of a decoder of Draco: meshes without points, so that joints and clips are seen. */
class NoDraco {
  constructor(tell) {
    this.tell = tell;
  }

  preload() {
    return this;
  }

  decodeDracoFile(buffer, done, attributes) {
    this.tell('Meshes that are compressed with Draco are not shown; joints and clips are');
    const geometry = new BufferGeometry();
    for (const name of Object.keys(attributes)) geometry.setAttribute(name, new Float32BufferAttribute([], 3));
    geometry.setIndex([]);
    done(geometry);
  }
}

/** In the place of a decoder of KTX2: no texture, where the file has no other for it. */
class NoBasis {
  constructor(parser, tell) {
    Object.assign(this, { name: 'KHR_texture_basisu', parser, tell });
  }

  loadTexture(index) {
    const texture = this.parser.json.textures[index];
    if (texture.source !== undefined || !texture.extensions?.[this.name]) return null;
    this.tell('Textures in KTX2 are not shown');
    return Promise.resolve(null);
  }
}
