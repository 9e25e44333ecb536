'use strict';
/* The planner: the module of `src/`, loaded from the page itself. The page runs this file in a worker, and `check.mjs`
   in Node.js. */

/** Names of the settings, in the order of `settings.rs`. */
const SETTINGS = ['head', 'rollers', 'perRev', 'volume', 'angle', 'rate', 'smooth', 'r', 'c', 'l'];

/** Names of the figures, in the order of `facts.rs`: mL, s, kPa absolute, rad, mm, percent. */
const FACTS = [
  'steps', 'planned', 'carry', 'motion', 'settle', 'inletLeast', 'inletMost', 'outletLeast', 'outletMost', 'start',
  'end', 'constantSteps', 'constant', 'revolution', 'rollers', 'speed', 'rippleConstant', 'ripple', 'backplate', 'tube',
  'rollerRadius', 'rollerOffset', 'contact', 'engagement',
];

/** Names of the cautions, in the order of `cautions.rs`: percent, kPa absolute; 1 for true. */
const CAUTIONS = [
  'even', 'planned', 'median', 'most', 'isUnsure', 'inletLeast', 'inletMost', 'outletLeast', 'outletMost', 'isWider',
];

/** Names of the columns, in the order of `trace.rs`. */
const COLUMNS = ['time', 'angle', 'speed', 'qIn', 'qOut', 'pIn', 'pOut', 'vessel', 'leaves'];

/** Rows of a trace: enough for each pulse, and no more than there is room for. */
const ROWS = { least: 600, most: 6000, perPulse: 24 };

class Engine {
  /** Loads the module from its gzip as base64. */
  static async load(text) {
    const packed = Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
    const bytes = await new Response(stream).arrayBuffer();
    const { instance } = await WebAssembly.instantiate(bytes, {});
    return new Engine(instance.exports);
  }

  constructor(calls) {
    this.calls = calls;
  }

  /** A copy of numbers of the module's memory. */
  numbers(place, count) {
    return new Float64Array(this.calls.memory.buffer, place, count).slice();
  }

  /** Plans a dose. Returns its figures by name, or `{ refusal }`. */
  plan(settings) {
    const { calls } = this;
    const to = new Float64Array(calls.memory.buffer, calls.settings(), SETTINGS.length);
    to.set(SETTINGS.map((name) => settings[name]));
    if (!calls.plan()) {
      const words = new Uint8Array(calls.memory.buffer, calls.refusal(), calls.refusal_length());
      return { refusal: new TextDecoder().decode(words) };
    }
    const facts = this.numbers(calls.facts(), FACTS.length);
    return Object.fromEntries(FACTS.map((name, n) => [name, facts[n]]));
  }

  /** The cautions of a planned smooth flow, by name; none of another. */
  cautions() {
    if (!this.calls.cautions()) return null;
    const found = this.numbers(this.calls.caution_figures(), CAUTIONS.length);
    return Object.fromEntries(CAUTIONS.map((name, n) => [name, found[n]]));
  }

  /** The waveform of the planned dose every `dt` seconds, by column; none if it is too long. */
  trace(dt) {
    const rows = this.calls.trace(dt);
    if (!rows) return null;
    return Object.fromEntries(COLUMNS.map((name, n) => [name, this.numbers(this.calls.column(n), rows)]));
  }

  /** The errors of the dose over its start angle: rad, mL, mL. */
  errors() {
    const count = this.calls.errors();
    const [angle, constant, planned] = [0, 1, 2].map((n) => this.numbers(this.calls.error_column(n), count));
    return { angle, constant, planned };
  }

  /** The times of every step, s. */
  stepTimes(count) {
    const times = new Float64Array(count);
    for (let made = 0; made < count;) {
      const some = this.calls.steps(made);
      times.set(this.numbers(this.calls.step_times(), some), made);
      made += some;
    }
    return times;
  }

  /** All that the page shows. The errors do not depend on most settings, so they are asked for where they change. */
  answer({ settings, withErrors, withCautions }) {
    const facts = this.plan(settings);
    if (facts.refusal) return { refusal: facts.refusal };
    if (withCautions) return { cautions: this.cautions() };
    const pulses = (facts.end - facts.start) * facts.rollers / (2 * Math.PI);
    const rows = Math.min(ROWS.most, Math.max(ROWS.least, ROWS.perPulse * pulses));
    const trace = this.trace((facts.motion + facts.settle) / rows);
    return { facts, trace, errors: withErrors ? this.errors() : null };
  }
}

if (typeof WorkerGlobalScope !== 'undefined') {
  let engine = null;
  self.onmessage = async ({ data }) => {
    try {
      if (data.module) engine = await Engine.load(data.module);
      else self.postMessage(engine.answer(data));
      if (data.module) self.postMessage({ isReady: true });
    } catch (error) {
      self.postMessage({ fault: String(error) });
    }
  };
}
