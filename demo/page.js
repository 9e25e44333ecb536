'use strict';
/* The page: settings, words and the course of time. The planner runs in a worker, so nothing here waits for it. */

const $ = (id) => document.getElementById(id);
const calm = matchMedia('(prefers-reduced-motion: reduce)');

/** The settings of a page without a link: the dose of the README, lines of the paper. */
const USUAL = {
  head: 3, rollers: 6, perRev: 6.3, volume: 25, angle: 17.19, rate: 5, smooth: 0, r: 0.1108, c: 0.0361, l: 0.0042,
};
const NAMES = Object.keys(USUAL);
/** Settings that are choices: head 0 is known by its volume. */
const CHOICES = { head: [3, 2, 0], smooth: [0, 1] };
const HEADS = { 3: 'three-roller', 2: 'two-roller' };

/** Writes a text where it is another one: only then is anything laid out anew. */
const word = (id, text) => {
  const node = $(id);
  if (node.textContent !== text) node.textContent = text;
};
const fixed = (value, digits) => {
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace('-', '') : text;
};
/** Groups the digits before the point of a number by three, from 10,000 on. */
const grouped = (text) => text.replace(/^-?\d{5,}/, (whole) => whole.replace(/\B(?=(\d{3})+$)/g, ','));
/** A number with `digits` behind the point: fewer from 1000 on, so that it keeps to its box. */
const figure = (value, digits) => {
  const more = Math.max(0, Math.floor(Math.log10(Math.abs(value) + 1e-9)) - 2);
  return grouped(fixed(value, Math.max(0, digits - more)));
};
const degrees = (rad) => rad * 180 / Math.PI;

/* Settings: in the form, and in the link. */

let settings = { ...USUAL };

/** Reads a link's words. A word that is no number is left as usual, and said. */
function fromLink() {
  const words = new URLSearchParams(location.hash.slice(1));
  const read = { ...USUAL };
  const wrong = [];
  for (const [name, text] of words) {
    const value = Number(text);
    if (!NAMES.includes(name)) wrong.push(`the link names “${name}”, which is no setting`);
    else if (text.trim() === '' || !Number.isFinite(value)) {
      wrong.push(`${name} is “${text}” in the link; it must be a number, so ${USUAL[name]} is used instead`);
    } else if (CHOICES[name] && !CHOICES[name].includes(value)) {
      wrong.push(`${name} is “${text}” in the link; it must be one of ${CHOICES[name].join(', ')}, so ` +
        `${USUAL[name]} is used instead`);
    } else read[name] = value;
  }
  return { read, wrong };
}

function toLink() {
  // A field that is empty, or no number, is left out.
  const differs = (name) => settings[name] !== USUAL[name] && Number.isFinite(settings[name]);
  const words = NAMES.filter(differs).map((name) => `${name}=${settings[name]}`);
  return `#${words.join('&')}`;
}

function showSettings() {
  for (const name of NAMES) {
    const input = name === 'head' ? $('head-input') : $(name);
    if (name === 'smooth') input.checked = settings.smooth === 1;
    else input.value = settings[name];
  }
  $('line').open = ['r', 'c', 'l'].some((name) => settings[name] !== USUAL[name]);
  showSliders();
}

function showSliders() {
  $('own').hidden = settings.head !== 0;
  const rollers = settings.head || settings.rollers;
  const tops = { angle: 360 / (rollers >= 2 && rollers <= 24 ? rollers : 2) };
  for (const slider of document.querySelectorAll('[data-for]')) {
    const name = slider.dataset.for;
    if (tops[name]) slider.max = tops[name];
    slider.value = settings[name];
  }
}

$('form').addEventListener('input', ({ target }) => {
  const name = target.dataset.for || target.name;
  if (!NAMES.includes(name)) return;
  const slider = document.querySelector(`[data-for="${name}"]`);
  if (target.dataset.for) $(name).value = target.value;
  else if (slider) slider.value = target.value;
  // A field that is empty for a moment is no number, and the page says so.
  settings[name] = name === 'smooth' ? Number(target.checked) : target.value.trim() === '' ? NaN : Number(target.value);
  if (name === 'head' || name === 'rollers') showSliders();
  changed();
});
$('form').addEventListener('submit', (event) => event.preventDefault());
$('usual').addEventListener('click', () => {
  settings = { ...USUAL };
  showSettings();
  changed();
});

/** Says what is wrong, or nothing. The figures of the last dose go, and its curves stay, paler. */
function refuse(text) {
  word('refusal', text && shown ? `${text} The pale curves are those of another dose.` : text);
  $('refusal').hidden = !text;
  document.body.classList.toggle('stale', Boolean(text));
  if (!text) return;
  halt();
  clearTimeout(telling);
  telling = setTimeout(drawRest, 400);
  for (const id of ['ours', 'theirs']) word(id, '–');
  for (const id of ['ours-error', 'theirs-error', 'said']) word(id, '');
  for (const id of ['caution', 'command-line']) $(id).hidden = true;
}

let linked = 0;
function changed() {
  clearTimeout(linked);
  linked = setTimeout(() => history.replaceState(null, '', toLink()), 300);
  word('link-said', '');
  $('link-wrong').hidden = true;
  $('link-field').hidden = true;
  ask();
}

$('link').addEventListener('click', async () => {
  history.replaceState(null, '', toLink());
  const link = location.href.split('#')[0] + toLink();
  try {
    await navigator.clipboard.writeText(link);
    word('link-said', 'The link is copied.');
  } catch {
    word('link-said', 'This browser lets no page copy. The link is below, marked.');
    $('link-field').hidden = false;
    $('link-text').value = link;
    $('link-text').focus();
    $('link-text').select();
  }
});
addEventListener('hashchange', openLink);

function openLink() {
  const { read, wrong } = fromLink();
  settings = read;
  showSettings();
  word('link-said', '');
  $('link-wrong').hidden = !wrong.length;
  word('link-wrong', wrong.length ? `Not all of the link was understood: ${wrong.join('; ')}.` : '');
  ask();
}

/* The planner. One question is under way at a time; the latest that waits comes next. */

const source = new Blob([$('engine').textContent], { type: 'text/javascript' });
const planner = new Worker(URL.createObjectURL(source));
let [isBusy, isWaiting] = [true, false];
let errorsOf = '';
let shown = null;
planner.onerror = (error) => refuse(`The planner does not start: ${error.message || 'this browser refuses it'}.`);
planner.onmessage = ({ data }) => {
  isBusy = false;
  if (data.errors) errorsOf = errorsKey(asked);
  const of = asked;
  // The planner goes on while the page draws.
  if (isWaiting) ask();
  if (data.fault) refuse(`The planner failed: ${data.fault}.`);
  else if ('cautions' in data) warn(data.cautions, of);
  else if (!data.isReady) take(data, of);
};
planner.postMessage({ module: $('module').textContent });

/** The settings on which the errors over the start angle depend. */
const errorsKey = ({ head, rollers, perRev, volume }) => [head, rollers, perRev, volume].join();

function ask() {
  const empty = NAMES.find((name) => Number.isNaN(settings[name]));
  if (empty) {
    const label = document.querySelector(`label[for="${empty}"]`).textContent;
    return refuse(`Not planned: “${label}” is empty or no number; type a number.`);
  }
  isWaiting = isBusy;
  if (isBusy) return;
  question(settings);
}

let asked = null;
function question(of, withCautions = false) {
  isBusy = true;
  asked = { ...of };
  planner.postMessage({ settings: asked, withCautions, withErrors: errorsKey(asked) !== errorsOf });
}

function take({ facts, trace, errors, refusal }, of) {
  const reason = refusal || (trace ? '' : 'the dose takes too long to be drawn');
  // The usual dose stands in, paler, where the first one is refused.
  const standsIn = !shown && of.isStandIn;
  if (!standsIn) refuse(reason && `Not planned: ${reason}.`);
  if (reason) {
    if (!shown && !isBusy) question({ ...USUAL, isStandIn: true });
    return;
  }
  shown = { settings: of, facts, trace, errors: errors || shown.errors };
  $('caution').hidden = true;
  head.build(facts);
  draw();
  if (!standsIn) tell();
  rewind();
  if (standsIn) refuse($('refusal').textContent);
}

/* Words. */

let telling = 0;
function tell() {
  const { settings: set, facts } = shown;
  const percent = (error) => {
    const part = 100 * error / set.volume;
    const digits = Math.abs(part) < 0.1 ? 4 : Math.abs(part) < 1 ? 2 : 1;
    return `${part > 0 ? '+' : ''}${fixed(part, digits)} %`;
  };
  const ours = facts.planned - set.volume;
  const theirs = facts.constant - set.volume;
  const steps = (count) => `${grouped(fixed(count, 0))} ${count === 1 ? 'step' : 'steps'}`;
  word('ours', `${figure(facts.planned, 4)} mL`);
  word('ours-error', `${percent(ours)}\n${steps(facts.steps)}`);
  word('theirs', `${figure(facts.constant, 4)} mL`);
  word('theirs-error', `${percent(theirs)}\n${steps(facts.constantSteps)}`);
  clearTimeout(telling);
  // A slider that moves is not told at each place.
  telling = setTimeout(() => {
    const isPublished = ['r', 'c', 'l'].every((name) => set[name] === USUAL[name]);
    $('command-line').hidden = !(HEADS[set.head] && isPublished);
    const angle = Number((set.angle % 360).toFixed(6));
    $('command').textContent = `dose ${set.volume}mL --rate ${set.rate}mL/s --start-angle ${angle}deg+-0deg` +
      `${set.smooth ? ' --smooth' : ''} --pump ${HEADS[set.head]} --dry-run`;
    // The cautions of a smooth flow take longer than the dose, so they are asked for once the settings stand.
    if (set.smooth && !isBusy) question(set, true);
    else say();
    $('head').setAttribute('aria-label', `Pump head with ${facts.rollers} rollers, which stand at ` +
      `${fixed(set.angle, 1)}° when the dose begins and turn by ${fixed(degrees(facts.end - facts.start), 1)}°`);
    drawRest();
  }, 400);
}

/** Says the figures of the dose. The ripple is that of the cruise: start and stop depart from the mean in any case. */
function say(cautions) {
  const { settings: set, facts } = shown;
  const ripple = (percent) => `${fixed(percent, percent < 10 ? 1 : 0)} %`;
  const known = cautions ? `; given how well this pump is known, expect ${ripple(cautions.median)} (median), and at ` +
    `most ${ripple(cautions.most)} in 95 % of such pumps` : '';
  word('said', `${grouped(fixed(facts.motion, 2))} s; inlet ${fixed(facts.inletLeast, 1)} to ` +
    `${fixed(facts.inletMost, 1)} kPa, outlet ${fixed(facts.outletLeast, 1)} to ${fixed(facts.outletMost, 1)} kPa; ` +
    `while cruising, the flow that leaves varies by ${ripple(facts.ripple)} of its mean` +
    `${set.smooth ? ` (${ripple(facts.rippleConstant)} at constant speed)${known}` : ''}.`);
}

/** Warns of a smooth flow as the command does. */
function warn(cautions, of) {
  if (JSON.stringify(of) !== JSON.stringify(shown.settings)) return;
  say(cautions);
  if (!cautions) return;
  const { facts } = shown;
  const ripple = (percent) => `${fixed(percent, percent < 10 ? 1 : 0)} %`;
  const range = (least, most) => `${fixed(least, 2)} to ${fixed(most, 2)} kPa`;
  const said = [];
  if (cautions.isUnsure) {
    said.push('The pulse of this head is not known well enough for a smooth flow: the flow that leaves is expected ' +
      `to vary by ${ripple(cautions.median)} (at most ${ripple(cautions.most)} in 95 % of such pumps), and by ` +
      `${ripple(cautions.even)} at constant speed. Leave the smooth flow out, or measure the roller volume.`);
  }
  if (cautions.isWider) {
    said.push('The smooth flow widens the swing of the inlet pressure: inlet ' +
      `${range(facts.inletLeast, facts.inletMost)}, ${range(cautions.inletLeast, cautions.inletMost)} at constant ` +
      `speed; outlet ${range(facts.outletLeast, facts.outletMost)}, ` +
      `${range(cautions.outletLeast, cautions.outletMost)} at constant speed (absolute).`);
  }
  word('caution', said.join(' '));
  $('caution').hidden = !said.length;
}

/* The curves. */

const overTime = { along: ' over time', alongUnit: 's' };
const charts = [
  new Chart({
    title: 'Error over the start angle', unit: '%', along: '', alongUnit: '°', isMark: true, leastSpan: 0.02,
    keys: [{ name: 'by one constant', colour: 'theirs' }, { name: 'pump-dose', colour: 'ours', isWide: true }],
    data: ({ settings: set, errors }) => ({
      x: errors.angle.map(degrees),
      curves: [errors.constant, errors.planned].map((all) => all.map((error) => 100 * error / set.volume)),
    }),
  }),
  new Chart({
    ...overTime, title: 'Flow', unit: 'mL/s',
    keys: [
      { name: 'at the outlet rollers', colour: 'outlet', isWide: true }, { name: 'leaves the line', colour: 'ours' },
    ],
    data: ({ trace }) => ({ x: trace.time, curves: [trace.qOut, trace.leaves] }),
  }),
  new Chart({
    ...overTime, title: 'Pressure', unit: 'kPa absolute',
    keys: [{ name: 'inlet', colour: 'inlet' }, { name: 'outlet', colour: 'outlet' }],
    data: ({ trace }) => ({ x: trace.time, curves: [trace.pIn, trace.pOut] }),
  }),
  new Chart({
    ...overTime, title: 'Delivered', unit: 'mL',
    keys: [
      { name: 'by one constant, in the end', colour: 'theirs', isDashed: true },
      { name: 'requested', colour: 'ours', isDashed: true }, { name: 'in the vessel', colour: 'outlet' },
    ],
    data: ({ settings: set, facts, trace }) => ({
      x: trace.time,
      curves: [
        trace.time.map(() => facts.constant),
        trace.time.map(() => set.volume),
        trace.vessel,
      ],
    }),
  }),
];

/** Draws the charts that a moving slider left out, and tells them. */
function drawRest() {
  for (const chart of shown ? charts : []) {
    chart.tell();
    if (chart.isDue) chart.draw();
  }
}

let colours = {};
function draw() {
  if (!shown) return;
  const style = getComputedStyle(document.documentElement);
  const names = ['soft', 'line', 'inlet', 'outlet', 'ours', 'theirs'];
  colours = Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
  for (const chart of charts) chart.renew();
  const pitches = degrees(shown.facts.start) * shown.facts.rollers / 360;
  const mark = charts.find((chart) => chart.isMark);
  mark.veil.style.transform = `translateX(${(100 * (pitches - Math.floor(pitches))).toFixed(3)}%)`;
}
new ResizeObserver(draw).observe($('charts'));
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', draw);

/* The course of time. The browser's compositor turns the rotor and moves the veils, so a slow processor does not make
   them jerk; only the figures are written here. */

const PAUSE_MS = 700;
const FIGURES_MS = 100;
let motions = [];
let [starting, writing, isRunning] = [0, 0, false];

const total = () => shown.trace.time[shown.trace.time.length - 1];
const now = () => (motions.length ? Math.min(motions[0].currentTime / 1000, total()) : 0);

/** Shows the dose from its begin, and plays it once nothing has changed for a while. */
function rewind() {
  clearTimeout(starting);
  for (const motion of motions) motion.cancel();
  motions = [];
  head.rotor.style.transform = head.turns(shown.trace, 1)[0].transform;
  $('time').max = total();
  // A person who wants no motion sees the whole dose.
  if (calm.matches) seek(total());
  else {
    stand();
    starting = setTimeout(play, PAUSE_MS);
  }
}

/** Moves nothing from now on. */
function halt() {
  clearTimeout(starting);
  if (isRunning) seek(now());
}

/** Makes the motions of the dose. A slider that moves has no time for them. */
function move() {
  if (motions.length) return;
  const timing = { duration: 1000 * total(), fill: 'both' };
  const veils = charts.filter((chart) => !chart.isMark).map(({ veil }) => veil.animate(
    [{ transform: 'translateX(0)' }, { transform: 'translateX(100%)' }], timing));
  motions = [...veils, head.rotor.animate(head.turns(shown.trace), timing)];
  motions[0].onfinish = stand;
}

/** Stands at a time. */
function seek(at) {
  move();
  for (const motion of motions) {
    motion.pause();
    motion.currentTime = 1000 * Math.min(Math.max(at, 0), total());
  }
  stand();
}

function stand() {
  clearInterval(writing);
  isRunning = false;
  word('play', now() >= total() ? 'Play again' : 'Play');
  write();
}

function play() {
  if (isRunning || !shown) return;
  move();
  if (now() >= total()) seek(0);
  isRunning = true;
  for (const motion of motions) motion.play();
  word('play', 'Pause');
  writing = setInterval(write, FIGURES_MS);
}

/** Writes the figures of the moment. */
function write() {
  const { trace } = shown;
  const { time } = trace;
  const at = now();
  let [row, above] = [0, time.length - 1];
  while (above - row > 1) {
    const middle = (row + above) >> 1;
    if (time[middle] <= at) row = middle;
    else above = middle;
  }
  const part = (at - time[row]) / (time[above] - time[row]);
  const of = (column) => column[row] + part * (column[above] - column[row]);
  word('now-volume', figure(of(trace.vessel), 2));
  word('now-time', figure(at, 2));
  word('now-angle', figure(degrees(of(trace.angle)), 1));
  word('now-flow', fixed(of(trace.leaves), 2));
  $('time').value = at;
}

$('play').addEventListener('click', () => {
  clearTimeout(starting);
  if (isRunning) seek(now());
  else play();
});
$('time').addEventListener('input', () => {
  clearTimeout(starting);
  if (shown) seek(Number($('time').value));
});

openLink();
