// Make what rigtri/viewer ships of src: page.js, page.draco.js, and the licences of what is in them.
//
//   npm install --prefix viewer && node viewer/build.mjs
//
// node viewer/build.mjs --modules FOLDER --out FOLDER: take three, meshoptimizer and esbuild from
// FOLDER/node_modules, write elsewhere. The same versions make the same bytes.
import { readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

const here = dirname(fileURLToPath(import.meta.url));
const { values } = parseArgs({ options: { modules: { type: 'string' }, out: { type: 'string' } } });
const modules = join(resolve(values.modules ?? here), 'node_modules');
const out = resolve(values.out ?? join(here, '..', 'rigtri', 'export', 'viewer'));
const { build } = createRequire(join(modules, 'esbuild', 'package.json'))('esbuild');

const wanted = JSON.parse(readFileSync(join(here, 'package.json'), 'utf8')).devDependencies;
for (const [name, version] of Object.entries(wanted)) {
  const found = JSON.parse(readFileSync(join(modules, name, 'package.json'), 'utf8')).version;
  if (found !== version) throw new Error(`${name} ${version} is wanted, ${found} is installed`);
}

/** Bundle a source of ours into a script for pages. before: JavaScript that it finds what it needs in. */
async function script(source, target, before = '', options = {}) {
  const result = await build({
    absWorkingDir: here,
    stdin: { contents: before + readFileSync(join(here, 'src', source), 'utf8'), resolveDir: join(here, 'src') },
    nodePaths: [modules],
    bundle: true,
    minify: true,
    format: 'iife',
    target: 'es2022',
    charset: 'ascii',
    legalComments: 'none',
    logLevel: 'error',
    write: false,
    ...options,
  });
  const code = result.outputFiles[0].text;
  // In a page these would end the script, or hide its end.
  if (/<\/script|<!--/i.test(code)) throw new Error(`${target} cannot stand in a page as it is`);
  writeFileSync(join(out, target), code);
}

await script('page.js', 'page.js');
const wrapper = join(modules, 'three', 'examples', 'jsm', 'libs', 'draco', 'gltf', 'draco_wasm_wrapper.js');
await script('draco.js', 'page.draco.js', readFileSync(wrapper, 'utf8'), {
  globalName: 'rigtriDraco',
  loader: { '.wasm': 'binary' },
  external: ['fs', 'path'],
});

const licences = [
  ['three.js', 'three', 'LICENSE'],
  ['meshoptimizer (its decoder)', 'meshoptimizer', 'LICENSE.md'],
];
const told = licences.map(([title, name, file]) => {
  const text = readFileSync(join(modules, name, file), 'utf8').trim();
  return `${title} ${wanted[name]}\n\n${text}\n`;
});
const draco = 'Draco (its decoder, as three.js has it; in pages that need it)\n\n' +
  'Copyright The Draco Authors. Licensed under the Apache License, Version 2.0:\n' +
  'https://www.apache.org/licenses/LICENSE-2.0, the licence of rigtri itself.\n';
const head = 'The scripts of a page hold, beside code of rigtri, code of these, each under its own licence:\n';
writeFileSync(join(out, 'page.js.LICENSES.txt'), [head, ...told, draco].join('\n----\n\n'));
