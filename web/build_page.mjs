// Makes the folder of the page that `octalux export web` copies: our modules, and three.js beside them.
//   node build_page.mjs OUTPUT PACKAGES      PACKAGES: where npm put three
import { cpSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = fileURLToPath(new URL('.', import.meta.url)), [output, packages] = process.argv.slice(2), three = join(packages, 'three');

execFileSync(process.execPath, [join(here, 'build.mjs'), output], { stdio: 'inherit' });
mkdirSync(output, { recursive: true });
for (const name of readdirSync(join(here, 'page'))) {
  if (/\.(js|css|html)$/.test(name)) cpSync(join(here, 'page', name), join(output, name));
}
for (const name of ['three.module.js', 'three.core.js']) cpSync(join(three, 'build', name), join(output, name));
cpSync(join(three, 'LICENSE'), join(output, 'three.LICENSE'));
const addons = ['loaders/GLTFLoader.js', 'utils/BufferGeometryUtils.js', 'utils/SkeletonUtils.js'];
for (const addon of addons) { // side by side in one folder
  const text = readFileSync(join(three, 'examples/jsm', addon), 'utf8').replace(/'\.\.\/\w+\/(\w+\.js)'/g, "'./$1'");
  writeFileSync(join(output, addon.split('/').pop()), text);
}
