// Makes the folder of the page that `octalux export web` copies: our modules, and three.js beside them in one compressed file.
//   node build_page.mjs OUTPUT PACKAGES      PACKAGES: where npm put three
import { cpSync, mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { execFileSync } from 'node:child_process';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

const here = fileURLToPath(new URL('.', import.meta.url)), [output, packages] = process.argv.slice(2), three = join(packages, 'three');
const typescript = createRequire(import.meta.url)(join(packages, 'typescript'));

execFileSync(process.execPath, [join(here, 'build.mjs'), output], { stdio: 'inherit' });
mkdirSync(output, { recursive: true });
for (const name of readdirSync(join(here, 'page'))) {
  if (/\.(js|css|html)$/.test(name)) cpSync(join(here, 'page', name), join(output, name));
}
cpSync(join(three, 'LICENSE'), join(output, 'three.LICENSE'));
// three.js by the names under which modules import it, without its comments.
const MODULES = { three: 'build/three.module.js', 'three/core': 'build/three.core.js' };
for (const addon of ['loaders/GLTFLoader.js', 'utils/BufferGeometryUtils.js', 'utils/SkeletonUtils.js']) {
  MODULES[`three/addons/${addon}`] = `examples/jsm/${addon}`;
}

// Returns a module's text with imports by name in place of those by path.
function moduleText(path) {
  const text = readFileSync(join(three, path), 'utf8').replaceAll("'./three.core.js'", "'three/core'").replace(/'\.\.?\/(?:\w+\/)?(\w+\.js)'/g, (_, file) => {
    const name = Object.keys(MODULES).find((known) => known.endsWith(`/${file}`));
    if (!name) throw new Error(`${path} imports ${file}, which the page does not hold`);
    return `'${name}'`;
  });
  const compilerOptions = { removeComments: true, target: 'ESNext', module: 'ESNext' };
  return typescript.transpileModule(text, { compilerOptions }).outputText;
}

const modules = Object.fromEntries(Object.entries(MODULES).map(([name, path]) => [name, moduleText(path)]));
writeFileSync(join(output, 'three.json.gz'), gzipSync(JSON.stringify(modules), { level: 9 }));
