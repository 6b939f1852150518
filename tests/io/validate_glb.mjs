// node validate_glb.mjs FILE...: prints the issues that the Khronos validator finds; exit status 1 if any of them
// is an error or a warning. The validator is looked for in the node_modules folder that the environment variable
// WEFT_NODE_MODULES names, else beside this file.

import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import path from 'node:path';

const kSeverities = ['error', 'warning', 'info', 'hint'];
const kMaxShown = 20;

const modules = process.env.WEFT_NODE_MODULES;
const require = createRequire(modules ? path.join(path.resolve(modules), 'x.js') : import.meta.url);
const validator = require(modules ? path.join(path.resolve(modules), 'gltf-validator') : 'gltf-validator');

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error('usage: node validate_glb.mjs FILE...');
  process.exit(2);
}

let failed = false;
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)));
  const { numErrors, numWarnings, numInfos, messages } = report.issues;
  console.log(`${path.basename(file)}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos`);
  for (const { severity, pointer, message } of messages.slice(0, kMaxShown)) {
    console.log(`  ${kSeverities[severity]} ${pointer ?? ''}: ${message}`);
  }
  failed ||= numErrors > 0 || numWarnings > 0;
}
process.exitCode = failed ? 1 : 0;
