// Holds the module of the page to the bits of this machine: `node check.mjs PAGE.html REFERENCE.json`.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { runInThisContext } from 'node:vm';

const [page, reference] = process.argv.slice(2).map((name) => readFileSync(name, 'utf8'));

/** A part of the page, as the browser finds it. */
const part = (id) => page.match(new RegExp(`<script type="text/plain" id="${id}">([^<]*(?:<(?!/script)[^<]*)*)`))[1];

const names = '{ Engine, SETTINGS, FACTS, CAUTIONS, COLUMNS }';
const { Engine, SETTINGS, FACTS, CAUTIONS, COLUMNS } = runInThisContext(`${part('engine')}; (${names})`);
const engine = await Engine.load(part('module'));
const numbers = (words) => new Float64Array(BigUint64Array.from(words, (word) => BigInt(`0x${word}`)).buffer);

/** Compares numbers bit by bit. One that is not a number equals any other such. */
function equal(name, found, words) {
  const expected = numbers(words);
  assert.equal(found.length, expected.length, `${name}: number of values`);
  for (let n = 0; n < found.length; n += 1) {
    assert.ok(Object.is(found[n], expected[n]), `${name}, value ${n}: ${found[n]} here, ${expected[n]} there`);
  }
  return found.length;
}

let compared = 0;
const joined = (columns) => Float64Array.from(columns.flatMap((column) => Array.from(column)));
for (const { name, settings, facts, steps, dt, trace, errors, refusal, cautions } of JSON.parse(reference)) {
  const values = numbers(settings);
  const found = engine.plan(Object.fromEntries(SETTINGS.map((key, n) => [key, values[n]])));
  if (refusal) {
    assert.equal(found.refusal, refusal, name);
    continue;
  }
  assert.equal(found.refusal, undefined, name);
  compared += equal(`${name}, figures`, FACTS.map((key) => found[key]), facts);
  const warned = engine.cautions();
  assert.equal(Boolean(warned), Boolean(cautions), `${name}: cautions of a smooth flow`);
  if (cautions) compared += equal(`${name}, cautions`, CAUTIONS.map((key) => warned[key]), cautions);
  compared += equal(`${name}, step times`, engine.stepTimes(found.steps), steps);
  const waveform = engine.trace(dt);
  compared += equal(`${name}, waveform`, joined(COLUMNS.map((key) => waveform[key])), trace);
  const { angle, constant, planned } = engine.errors();
  compared += equal(`${name}, errors`, joined([angle, constant, planned]), errors);
  // README says so of its doses.
  if (name.startsWith('README')) assert.equal(found.steps, 15287);
  if (name.endsWith('10 mL/s')) assert.equal(found.motion.toFixed(4), '2.6213');
}
assert.ok(compared > 200_000, `${compared} values are many`);
assert.ok(page.length < 215_000, `the page has ${page.length} bytes; fewer than 215,000 are promised`);
console.log(`${compared} numbers have the bits of this machine`);
