#!/usr/bin/env node
// Checks circuits/schema/circuit.schema.json with ajv: every shipped circuit fits it, and it agrees with the compiler on the
// golden cases: what compiles fits, and what has a mistake of shape (E0201, E0202, E0203, E0218, E0222) does not.
// Needs Debian's nodejs and node-ajv. usage: check_schema.js ROOT
'use strict';
const fs = require('fs');
const path = require('path');
// Debian keeps its modules here, where another node does not look.
process.env.NODE_PATH = '/usr/share/nodejs';
require('module')._initPaths();
const Ajv = require('ajv');

const root = process.argv[2];
const schema = JSON.parse(fs.readFileSync(path.join(root, 'circuits/schema/circuit.schema.json'), 'utf8'));
const validate = new Ajv({ allErrors: true }).compile(schema);

// Comments become blanks; strings stay as they are.
function withoutComments(text) {
  return text.replace(/"(?:\\.|[^"\\\n])*"|\/\/[^\n]*|\/\*[\s\S]*?\*\//g, (m) => (m[0] === '"' ? m : ' '));
}

function filesUnder(folder, ending) {
  return fs.readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const full = path.join(folder, entry.name);
    return entry.isDirectory() ? filesUnder(full, ending) : full.endsWith(ending) ? [full] : [];
  });
}

let failures = 0;
function expect(isRight, what, detail) {
  if (!isRight) {
    failures += 1;
    console.log(`${what}\n${detail}`);
  }
}
const why = () => (validate.errors || []).map((e) => `  ${e.dataPath}: ${e.message} ${JSON.stringify(e.params)}`).join('\n');

// A file that extends another leaves out what that one has.
const onlyLeavesOut = () => validate.errors.every((e) => ['required', 'oneOf', 'anyOf'].includes(e.keyword));

let shipped = 0;
for (const file of filesUnder(path.join(root, 'circuits'), '.json')) {
  if (!/\/(schema|heads|protocols)\/|\.test\.json$/.test(file)) {
    const circuit = JSON.parse(withoutComments(fs.readFileSync(file, 'utf8')));
    const fits = validate(circuit) || ('extends' in circuit && onlyLeavesOut());
    expect(fits, `${file} does not fit the schema`, why());
    shipped += 1;
  }
}

// What the schema leaves to the compiler: names across sections, module arguments, rules' and sides' own keys.
const kShape = /\[E0(201|202|203|222)\]/;
const kBeyondSchema = /E0202\]: unknown key `[^`]*` in (rule|exception)|has no `(p|n|file|tau|window|size|V_th)`|`(times|rate)`/;
let good = 0;
let bad = 0;
for (const file of filesUnder(path.join(root, 'tests/golden'), '.case')) {
  const parts = fs.readFileSync(file, 'utf8').split(/^--- (.*)\n/m);
  const part = (name) => (parts.indexOf(name) < 0 ? '' : parts[parts.indexOf(name) + 1]);
  const exit = Number(/^exit: (\d)/m.exec(parts[0])[1]);
  let circuit;
  try {
    circuit = JSON.parse(withoutComments(part('circuit.json')));
  } catch (error) {
    continue; // no circuit of this name, or a case about JSON itself
  }
  const fits = validate(circuit);
  const stderr = part('stderr');
  const shapeLines = stderr.split('\n').filter((line) => kShape.test(line) && line.startsWith('circuit.json'));
  if (exit === 0 && !/run: tectum fmt/.test(parts[0])) {
    expect(fits, `${file} compiles but does not fit the schema`, why());
    good += 1;
  } else if (shapeLines.some((line) => !kBeyondSchema.test(line))) {
    expect(!fits, `${file} has a mistake of shape but fits the schema`, shapeLines.join('\n'));
    bad += 1;
  }
}
console.log(`${shipped} circuits, ${good} good and ${bad} bad cases, ${failures} disagreements`);
process.exit(failures === 0 && shipped > 0 && good > 20 && bad > 10 ? 0 : 1);
