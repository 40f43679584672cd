// Make what rigtri/viewer ships of src: page.js, and the licences of what is in it.
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
const out = resolve(values.out ?? join(here, '..', 'rigtri', 'viewer'));
const { build } = createRequire(join(modules, 'esbuild', 'package.json'))('esbuild');

const wanted = JSON.parse(readFileSync(join(here, 'package.json'), 'utf8')).devDependencies;
for (const [name, version] of Object.entries(wanted)) {
  const found = JSON.parse(readFileSync(join(modules, name, 'package.json'), 'utf8')).version;
  if (found !== version) throw new Error(`${name} ${version} is wanted, ${found} is installed`);
}

const result = await build({
  absWorkingDir: here,
  entryPoints: ['src/page.js'],
  nodePaths: [modules],
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2022',
  charset: 'ascii',
  legalComments: 'none',
  write: false,
});
const code = result.outputFiles[0].text;
// In a page these would end the script, or hide its end.
if (/<\/script|<!--/i.test(code)) throw new Error('the bundle cannot stand in a page as it is');
writeFileSync(join(out, 'page.js'), code);

const licences = [
  ['three.js', 'three', 'LICENSE'],
  ['meshoptimizer (its decoder)', 'meshoptimizer', 'LICENSE.md'],
];
const told = licences.map(([title, name, file]) => {
  const text = readFileSync(join(modules, name, file), 'utf8').trim();
  return `${title} ${wanted[name]}\n\n${text}\n`;
});
const head = 'page.js holds, beside code of rigtri, code of these, each under its own licence:\n';
writeFileSync(join(out, 'page.js.LICENSES.txt'), [head, ...told].join('\n----\n\n'));
