#!/usr/bin/env node
// No key of the language goes untold: what compiler/parse reads by name is in the schema, what the schema has is in the
// manual (compiler/README.md) and has a hover text. usage: check_keys.js ROOT
'use strict';
const fs = require('fs');
const path = require('path');

const root = process.argv[2];
const read = (...parts) => fs.readFileSync(path.join(root, ...parts), 'utf8');
const schema = JSON.parse(read('circuits/schema/circuit.schema.json'));
const manual = read('compiler/README.md');

function described(property) {
  if (!property.$ref) {
    return 'description' in property;
  }
  const target = property.$ref.slice(2).split('/').reduce((node, part) => node[part], schema);
  return 'description' in target;
}

// All `properties` of the schema, wherever they stand; a condition (`if`, `then`) describes nothing anew.
const keysOfSchema = new Set();
const withoutHover = [];
function walk(node, place) {
  if (node === null || typeof node !== 'object') {
    return;
  }
  for (const [name, child] of Object.entries(node)) {
    if (name === 'properties') {
      for (const [key, property] of Object.entries(child)) {
        keysOfSchema.add(key);
        if (!described(property)) {
          withoutHover.push(`${place}/${key}`);
        }
      }
    }
    if (name !== 'if' && name !== 'then') {
      walk(child, `${place}/${name}`);
    }
  }
}
walk(schema, '');

const keysOfManual = new Set([...manual.matchAll(/[`"]([A-Za-z_$0-9]+)[`"]/g)].map((match) => match[1]));

const keysOfParser = new Set();
const kRead = /[.>](?:required_)?(?:name|names|value|values|text|child)\(\s*"([^"]+)"/g;
for (const file of fs.readdirSync(path.join(root, 'compiler/parse')).filter((name) => name.endsWith('.cpp'))) {
  for (const match of read('compiler/parse', file).matchAll(kRead)) {
    keysOfParser.add(match[1]);
  }
}

const missing = (keys, from) => [...keys].filter((key) => !from.has(key)).sort();
const failures = [
  ...missing(keysOfParser, keysOfSchema).map((key) => `the parser reads \`${key}\`, which the schema does not have`),
  ...missing(keysOfSchema, keysOfManual).map((key) => `the schema has \`${key}\`, which the manual does not name`),
  ...withoutHover.map((place) => `${place} of the schema has no description`),
];
failures.forEach((failure) => console.log(failure));
console.log(`${keysOfParser.size} keys of the parser, ${keysOfSchema.size} of the schema, ${failures.length} failures`);
process.exit(failures.length === 0 && keysOfParser.size > 60 ? 0 : 1);
