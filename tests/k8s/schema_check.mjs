// SPDX-License-Identifier: Apache-2.0
// Holds objects (a JSON array on standard input) to the schemas of Kubernetes, cert-manager and the Prometheus operator, as npm's
// kubernetes-models has them. Prints what is wrong, one sentence a line; exit code 1 when something is.
//   node schema_check.mjs FOLDER_OF_NODE_MODULES
import {existsSync, readFileSync} from 'node:fs';
import {pathToFileURL} from 'node:url';

const packages = {
  'cert-manager.io': '@kubernetes-models/cert-manager/cert-manager.io',
  'monitoring.coreos.com': '@kubernetes-models/prometheus-operator/monitoring.coreos.com',
};

// Where `apiVersion` lives: "v1" is in the group of no name, "apps/v1" in its own.
async function model({apiVersion, kind}) {
  const [group, version] = apiVersion.includes('/') ? apiVersion.split('/') : ['', apiVersion];
  const folder = packages[group] ?? `kubernetes-models/${group}`;
  const base = `${process.argv[2]}/${folder}/${version}/${kind}`;
  const file = [`${base}.mjs`, `${base}.js`].find(existsSync);
  if (!file) throw new Error('no such kind');
  return (await import(pathToFileURL(file)))[kind];
}

let wrong = 0;
for (const object of JSON.parse(readFileSync(0, 'utf8'))) {
  try {
    const Model = await model(object);
    new Model(object).validate();
  } catch (error) {
    ++wrong;
    console.log(`${object.kind} ${object.metadata?.name}: ${error.message}`);
  }
}
process.exit(wrong ? 1 : 0);
