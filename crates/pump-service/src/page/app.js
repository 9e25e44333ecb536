// The page of `dose serve`. Data from the service become text nodes and attributes, and never markup.
'use strict';

/* Elements. */

const $ = (id) => document.getElementById(id);

/** Builds an element. `props`: attributes, `text`, and listeners as `onclick`. */
function fill(node, props, kids) {
	for (const [name, value] of Object.entries(props || {})) {
		if (value == null || value === false) continue;
		if (name === 'text') node.textContent = value;
		else if (name.startsWith('on')) on(node, name.slice(2), value);
		else node.setAttribute(name, value === true ? '' : value);
	}
	node.append(...kids.flat(Infinity).filter((kid) => kid != null && kid !== false && kid !== ''));
	return node;
}
/** A button sends no form unless it is told to. */
const h = (tag, props, ...kids) => fill(document.createElement(tag), tag === 'button' ? { type: 'button', ...props } : props, kids);
const s = (tag, props, ...kids) => fill(document.createElementNS('http://www.w3.org/2000/svg', tag), props, kids);

const div = (name, ...kids) => h('div', { class: name }, kids);
const para = (text) => h('p', { text });
const line = (name, text, more) => h('p', { class: name, text, ...more });
const aside = (text) => line('hint', text);
const bad = (text) => line('error', text);
const alarm = (text) => line('error', text, { role: 'alert' });
const head2 = (text) => h('h2', { text });
const inRow = (...kids) => div('row', kids);
const head1 = (text) => h('h1', { tabindex: '-1', text });
const on = (node, ...what) => node.addEventListener(...what);
const formOf = (send, props, ...kids) => h('form', { novalidate: true, ...props, onsubmit: (event) => { event.preventDefault(); send(); } }, kids);
const press = (text, onclick, more) => h('button', { text, onclick, ...more });
const firstly = (text, onclick) => press(text, onclick, { class: 'first' });
const submit = (text) => h('button', { type: 'submit', class: 'first', text });
const moreOf = (...kids) => h('details', {}, h('summary', { text: 'More options' }), kids);
const fields = (...kids) => div('fields', kids);
const danger = (...kids) => div('notice bad', kids);
const inPath = encodeURIComponent;
const block = (...kids) => h('section', { class: 'panel' }, kids);

const place = (node, ...kids) => node.replaceChildren(...kids);
function say(node, text) {
	if (node.textContent !== text) node.textContent = text;
}
function attr(node, name, value) {
	if (node.getAttribute(name) !== value) node.setAttribute(name, value);
}
/** Replaces the children of a node if `key` has changed. */
function remake(node, key, make) {
	key = JSON.stringify(key);
	if (node.made === key) return;
	node.made = key;
	place(node, ...[make()].flat().filter(Boolean));
}
const main = $('main');
const looks = document.body.classList;
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
let ids = 0;
const newId = () => `n${++ids}`;

/* Numbers and times in words. */

const minus = (text) => text.replace('-', '−');
const fixed = (value, decimals) => minus(value.toFixed(decimals));
/** Decimals that show an uncertainty with two digits. */
const decimalsOf = (u) => (u > 0 ? Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(u)))) : 2);
const short = (value, digits = 4) => minus(String(Number(value.toPrecision(digits))));
const ml = (value, u) => (value == null ? '–' : u > 0 ? fixed(value, decimalsOf(u)) : short(value));
const range = (least, most) => `${fixed(least, 2)} to ${fixed(most, 2)}`;
const spread = (u) => fixed(u, decimalsOf(u));
const small = (value) => (Math.abs(value) >= 1 ? `${fixed(value, 2)} mL` : `${fixed(value * 1000, 1).replace(/^−(0\.0)$/, '$1')} µL`);
const local = new Intl.DateTimeFormat('sv', { dateStyle: 'short', timeStyle: 'medium' });
/** The local time of a date, of its text, or of ms since 1970, as 2026-11-27 06:30:00. */
const date = (at) => local.format(new Date(at));
function span(seconds) {
	const n = Math.max(0, Math.round(seconds));
	if (n < 60) return `${n} s`;
	if (n < 3600) return `${Math.floor(n / 60)} min${n < 600 && n % 60 ? ` ${n % 60} s` : ''}`;
	if (n < 48 * 3600) return `${Math.floor(n / 3600)} h ${Math.round((n % 3600) / 60)} min`;
	return `${Math.round(n / 86400)} days`;
}
/** A number alone gets the unit that the form names. */
const withUnit = (text, unit) => (/^\s*[-+−]?(\d+\.?\d*|\.\d+)\s*$/.test(text) ? text.trim() + unit : text.trim());

/* Requests. */

const ANYWAY = 'Use it although it is far from what was expected';

/** A message in local times, without its clauses that name commands: the page has buttons for what they do. */
function plain(text) {
	text = text.replace(/\d{4}-\d\d-\d\dT[\d:]+(Z|[+-]\d\d:\d\d)/g, date);
	const kept = text.split('; ').filter((part) => !/`dose (safety|resume|accept|status|vessel|calibrate)/.test(part));
	return kept.length ? kept.join('; ') : text;
}
class Refused extends Error {
	constructor(report, status) {
		super(plain(report.message).replace('add --anyway', `tick “${ANYWAY}” under “More options”`));
		Object.assign(this, { code: report.code, kind: report.kind, key: report.key, status });
	}
}

const unknownOf = ({ status }) => ({ code: 1, kind: 'service', message: `the service answered with status ${status}` });

async function call(method, path, { body, key, match, timeout = 8000 } = {}) {
	const headers = method === 'GET' ? {} : { 'Content-Type': 'application/json' };
	if (key) headers['Idempotency-Key'] = key;
	if (match) headers['If-Match'] = `"${match}"`;
	const answer = await fetch(path, { method, headers, body, signal: AbortSignal.timeout(timeout), cache: 'no-store' });
	const text = await answer.text();
	let data = null;
	try { data = JSON.parse(text); } catch { /* An answer of a proxy. */ }
	if (answer.ok) return data;
	if (answer.status === 401 && path !== '/login') showLogin();
	throw new Refused(data?.message ? data : unknownOf(answer), answer.status);
}

const get = (path) => call('GET', `/api/v1/${path}`);

/** Keys of the orders whose answer is not known, by their words. */
const keys = new Map();
/** Gives an order. A lost answer is asked for again with the same key, so that nothing is done twice. */
async function give(path, body) {
	const text = JSON.stringify(body);
	const words = path + text;
	const key = keys.get(words) || crypto.getRandomValues(new BigUint64Array(2)).join('-');
	keys.set(words, key);
	for (let tries = 0; ; tries += 1) {
		try {
			const order = await call('POST', path, { body: text, key, timeout: 40000 });
			keys.delete(words);
			return order;
		} catch (error) {
			const isAnswer = error instanceof Refused && ![408, 502, 503, 504].includes(error.status);
			if (isAnswer) keys.delete(words);
			if (isAnswer || tries === 3) throw error;
		}
		await sleep(400 * 2 ** tries);
	}
}
async function ended(order) {
	while (order.state === 'running') {
		await sleep(400);
		order = await get(`orders/${inPath(order.id)}`).catch((error) => {
			if (error instanceof Refused) throw error;
			return order;
		});
	}
	return order;
}
const ofPump = (name, rest) => `/api/v1/pumps/${inPath(name)}/${rest}`;

/* What is known. */

const pumps = new Map();
const all = () => [...pumps.values()];
let racks = [];
let version = '';
let notes = [];
/** Milliseconds since 1970. */
const ms = () => Date.now();
let isLive = false;
let heard = ms();
let source = null;
let retryMs = 500;
let retryTimer = 0;
let needsLogin = false;

const TASKS = { dose: 'Dosing', prime: 'Priming', purge: 'Purging', run: 'Running', resume: 'Delivering the rest of a dose',
	accept: 'Accepting', clear: 'Clearing', stand: 'Putting to stand', emptied: 'Emptying', calibrate: 'Calibrating', rack: 'Running in a rack',
	retract: 'Retracting' };
const STANDING = ['accept', 'clear', 'stand', 'emptied', 'calibrate'];
const isDose = (report) => report?.schema === 'dose/1';

/** The doses of an order with the names of their pumps: those of a rack are within its report. */
const dosesOf = (order) => (order.reports || []).flatMap((report) => {
	if (isDose(report)) return [{ name: order.pump, report }];
	if (!report || report.schema !== 'rack/1') return [];
	return report.pumps.flatMap((pump) => pump.doses.map((one) => ({ name: pump.name, report: one.dose })));
});

function take(view) {
	const pump = pumps.get(view.name) || { name: view.name, panels: new Set(), refused: new Map(), last: null, fault: null, motion: null };
	pumps.set(view.name, pump);
	const stoodBefore = pump.view?.status?.safety.stand;
	pump.view = view;
	const isHeld = view.status?.in_use_by;
	if (view.order) {
		const old = pump.motion?.order === view.order ? pump.motion : { order: view.order };
		pump.motion = { ...old, task: view.task, plan: view.plan || old.plan };
		const told = view.progress;
		if (told?.state === 'moving' && !old.progress) pump.motion.progress = told;
	} else if (!isHeld || !pump.motion?.ofRack) {
		pump.motion = null;
	}
	const stand = view.status?.safety.stand;
	if (stand && pump.known && !stoodBefore) alertOf(standWords(pump));
	pump.known = true;
	return pump;
}

function takeProgress(told) {
	const pump = pumps.get(told.name);
	if (!pump) return;
	if (!pump.motion || pump.motion.order !== told.order) {
		pump.motion = { order: told.order, task: pump.view.order === told.order ? pump.view.task : 'rack',
			ofRack: pump.view.order !== told.order };
	}
	const motion = pump.motion;
	if (told.state === 'begun') {
		Object.assign(motion, { plan: told.plan, progress: null, wait: null });
		forget(pump);
	} else if (told.state === 'waiting') {
		motion.wait = { until: ms() + told.next_s * 1000, number: told.number, count: told.count };
		motion.progress = null;
	} else if (told.state === 'moving') {
		if (motion.progress?.steps === told.steps && told.steps === told.of_steps) return;
		const wasMoving = motion.progress && !motion.wait;
		Object.assign(motion, { progress: told, wait: null });
		for (const panel of pump.panels) panel.head.sample(told.angle_deg, performance.now());
		if (wasMoving) return later(pump);
	}
	refresh(pump);
}

/** Pumps that have turned on, and time from one shown to the next: many pumps never fill a frame. */
const changed = new Set();
const APART_MS = 40;
let shows = false;
function later(pump) {
	changed.add(pump);
	if (shows) return;
	shows = true;
	setTimeout(showNext, 0);
}
function showNext() {
	const [pump] = changed;
	if (!pump) {
		shows = false;
		return;
	}
	changed.delete(pump);
	for (const panel of pump.panels) {
		panel.figures();
		if (pump.motion?.progress) panel.head.go(performance.now());
	}
	tellProgress();
	setTimeout(showNext, APART_MS);
}

function takeOrder(order) {
	const own = pumps.get(order.pump);
	const isOver = order.state !== 'running';
	takeReports(order);
	if (!isOver) {
		if (!own) return;
		Object.assign(own.view, { order: order.id, task: order.task });
		if (own.motion?.order !== order.id) own.motion = { order: order.id, task: order.task, isPlan: isDry(order) };
		return refresh(own);
	}
	tellEnd(order);
	const of = own ? [own] : all().filter((pump) => pump.motion?.order === order.id);
	for (const pump of of) {
		if (pump.motion?.order === order.id) pump.motion = null;
		if (pump.view.order === order.id) Object.assign(pump.view, { order: null, task: null, plan: null, progress: null, silent_since: null, stop_asked: null });
		const { error } = order;
		if (order.state === 'failed' && error && error.kind !== 'stopped') {
			pump.fault = { time: order.ended, message: plain(error.message) };
			alertOf(`${pump.name} failed: ${pump.fault.message}`);
		} else if (!isDry(order)) {
			if (order.state === 'done') forget(pump);
			const stopped = error?.kind === 'stopped';
			const dose = pump.last?.order === order.id ? `, ${volumeWords(pump.last.report)}` : '';
			politely(`${pump.name}: ${order.task} ${stopped ? 'stopped' : order.state}${dose}`, true);
		}
		refresh(pump);
	}
}
/** Takes away what was said of a pump before it moved, or before another order was carried out. */
function forget(pump) {
	pump.fault = null;
	for (const said of pump.refused.keys()) place(said);
	pump.refused.clear();
}
const isDry = (order) => order.options?.['dry-run'];

/** Forms that tell the end of their order, by the order. */
const taken = new Map();
function tellTaken(said, order, words) {
	if (order.state === 'failed') throw orderError(order);
	const isDone = order.state === 'done';
	const line = para(isDone ? `Done: ${words}.` : `The service has the order: ${words}.`);
	place(said, line);
	if (!isDone) taken.set(order.id, { said, line, words });
}
function tellEnd(order) {
	const form = taken.get(order.id);
	taken.delete(order.id);
	if (!form) return;
	const isStopped = order.error?.kind === 'stopped';
	const how = order.state === 'done' ? 'Done' : isStopped ? 'Stopped' : 'Not done';
	const pump = pumps.get(order.pump);
	const { last } = pump || {};
	const volume = order.state !== 'done' && last?.order === order.id ? `; ${volumeWords(last.report)}` : '';
	say(form.line, `${how}: ${form.words}${volume}.`);
	// A later refusal has taken the line's place.
	if (!pump || order.state === 'done' || !form.line.isConnected) return;
	// The rest is offered above the form, where a phone does not show it.
	pump.leads = isStopped;
	pump.refused.set(form.said, {});
}
async function askTaken() {
	for (const id of [...taken.keys()]) {
		const order = await get(`orders/${inPath(id)}`).catch(() => null);
		if (!order || order.state === 'running') continue;
		takeReports(order);
		tellEnd(order);
		pumps.forEach(refresh);
	}
}

function takeReports(order) {
	for (const { name, report } of dosesOf(order)) {
		if (report.delivered_ml == null || !report.time) continue;
		const pump = pumps.get(name);
		if (!pump || (pump.last && new Date(pump.last.report.time) > new Date(report.time))) continue;
		pump.last = { report, order: order.id, ended: order.ended, stopped: order.error?.kind === 'stopped',
			resumed: order.task === 'resume' };
	}
}

async function readLast() {
	const paths = [...pumps.keys()].map((name) => `limit=5&pump=${inPath(name)}`).concat('limit=10');
	for (const path of paths) {
		const orders = await get(`orders?${path}`).catch(() => []);
		(orders || []).forEach(takeReports);
	}
	pumps.forEach(refresh);
}

/* Live regions. */

let politeAt = 0;
function politely(text, isNews) {
	// Progress is told rarely, and the end of an order at once.
	const now = ms();
	if (!isNews && now - politeAt < 10000) return;
	politeAt = now;
	say($('polite'), text);
}
function alertOf(text) {
	place($('alert'), para(text));
}
function tellProgress() {
	if (ms() - politeAt < 10000) return;
	const moving = all().filter((pump) => pump.motion?.progress);
	politely(moving.map((pump) => `${pump.name}: ${readOf(pump).words}`).join('. '));
}

/* The stream. */

function connect() {
	clearTimeout(retryTimer);
	source?.close();
	source = new EventSource('/events');
	const hear = (name, take) => on(source, name, (event) => {
		heard = ms();
		take(event.data ? JSON.parse(event.data) : null);
	});
	hear('hello', hello);
	hear('pump', (view) => {
		refresh(take(view));
		onLog?.();
	});
	hear('progress', takeProgress);
	hear('order', takeOrder);
	hear('note', takeNote);
	hear('input', () => { onInputs?.(); });
	hear('alive', () => {});
	source.onerror = () => {
		lose();
		if (source.readyState === EventSource.CLOSED) retry();
	};
}
function retry() {
	clearTimeout(retryTimer);
	retryTimer = setTimeout(begin, retryMs);
	retryMs = Math.min(8000, retryMs * 2);
}
async function begin() {
	try {
		const login = await call('GET', '/login', { timeout: 4000 });
		needsLogin = login.needed;
		$('logout').hidden = !login.needed || !login.may;
		if (login.needed && !login.may) return showLogin();
		connect();
	} catch {
		lose();
		retry();
	}
}
function lose(isExpected) {
	if (!isExpected && !looks.contains('lost')) alertOf('Connection lost. Reconnecting.');
	isLive = false;
	looks.add('lost');
	showLink();
}
function showLink() {
	say($('link').firstElementChild, isLive ? 'Live' : `Reconnecting…${pumps.size ? ` Values as of ${date(heard).slice(11)}` : ''}`);
}
function hello(told) {
	if (looks.contains('lost')) {
		politely('Connected again.', true);
		place($('alert'));
	}
	isLive = true;
	retryMs = 500;
	looks.remove('lost');
	const names = told.pumps.map((pump) => pump.name);
	const isSame = names.join('\n') === [...pumps.keys()].join('\n') && racks.join('\n') === told.racks.join('\n');
	for (const name of pumps.keys()) if (!names.includes(name)) pumps.delete(name);
	for (const pump of pumps.values()) pump.motion = null;
	for (const view of told.pumps) take(view);
	const isOlder = version && version !== told.version;
	({ racks, version } = told);
	$('about').textContent = `pump-dose ${version}${isOlder ? '; this page is older: reload it' : ''}`;
	readLast();
	askTaken();
	onInputs?.();
	onLog?.();
	if (onNotes) watchNotes(100, onNotes);
	if (isSame && main.dataset.view) pumps.forEach(refresh);
	else show();
	showLink();
}
function takeNote(note) {
	notes = [note, ...notes].slice(0, 200);
	const text = noteWords(note);
	if (note.kind === 'guard') alertOf(text);
	else politely(text, true);
	onNotes?.();
}
let onNotes = null;
let onInputs = null;
let onLog = null;
let onPump = null;
const noteWords = (note) => `${note.pump ? `${note.pump}: ` : ''}${plain(note.text)}`;
/** Reads the last events, and shows them now and when another comes. `fail` tells that they cannot be read. */
function watchNotes(most, showNotes, fail = () => {}) {
	onNotes = showNotes;
	showNotes();
	get(`notes?limit=${most}`).then((told) => {
		notes = told;
		if (onNotes === showNotes) showNotes();
	}).catch(fail);
}

// A stream can end without a word, as when a phone leaves its network. Silence is asked about.
setInterval(async () => {
	if (!isLive || document.hidden || ms() - heard < 2500) return;
	try {
		await call('GET', '/login', { timeout: 1500 });
		if (ms() - heard > 20000) connect();
	} catch {
		lose();
		connect();
	}
}, 1000);
on(window, 'offline', () => lose());
on(window, 'pageshow', (event) => { if (event.persisted) begin(); });
on(window, 'online', () => { if (!isLive) begin(); });
// A hidden page leaves its connection to the others: a browser has six for a service.
let hiddenTimer = 0;
on(document, 'visibilitychange', () => {
	clearTimeout(hiddenTimer);
	if (document.hidden) {
		hiddenTimer = setTimeout(() => { source?.close(); source = null; }, 20000);
	} else if (!source || source.readyState === EventSource.CLOSED) {
		lose(true);
		begin();
	}
});

/* Stop. */

let stopRun = 0;
/** Stops a pump, or all, and tells what has come of it. */
async function stopAll(pump) {
	const run = ++stopRun;
	const tell = (text, isBad) => {
		if (run === stopRun) place($('stop-said'), line(isBad ? 'bad' : '', text));
	};
	tell('Stopping…');
	for (let tries = 1; run === stopRun; tries += 1) {
		try {
			const { asked, stopped } = await call('POST', pump ? ofPump(pump.name, 'stop') : '/api/v1/stop', { body: '{}', timeout: 2500 });
			const others = (pump ? [pump] : all()).filter((one) => !one.motion && one.view.status?.in_use_by).map((one) => one.name).join(', ');
			const also = others && ` In use by another program, which this page cannot stop: ${others}.`;
			let orders = [];
			let left = asked.length > stopped.length;
			const named = (is) => orders.filter(is).map((order) => order.pump || order.rack).join(', ');
			while (left && run === stopRun) {
				orders = await Promise.all(asked.map((id) => get(`orders/${id}`)));
				left = named(({ state }) => state === 'running');
				if (!left) break;
				tell(`NOT stopped yet: ${left}. The service ends what does not answer.${also}`, true);
				await sleep(400);
			}
			const killed = named(({ error }) => error?.kind === 'killed');
			const isBad = killed || also;
			tell((killed ? `Did not answer, and was ended: ${killed}. Look whether the motor stands.`
				: asked.length ? `Stopped ${asked.length} order${asked.length > 1 ? 's' : ''}.` : 'Nothing was moving.') + also, isBad);
			await sleep(isBad ? 30000 : 6000);
			if (run === stopRun) place($('stop-said'));
			return;
		} catch (error) {
			if (error instanceof Refused && error.status === 401) return tell('Not stopped: log in first.', true);
			tell('NOT stopped: the service cannot be reached. If a pump must stop now, switch it off by hand. ' +
				(tries < 20 ? `Trying again (${tries} of 20).` : 'The button tries again.'), true);
			if (tries === 20) return;
			// The stream may hold the last free connection.
			if (tries === 2 && source) { source.close(); lose(); retry(); }
			await sleep(Math.min(2000, 200 * tries));
		}
	}
}
function stopButton(text, act, isCalm) {
	const button = h('button', { class: isCalm ? 'stop calm' : 'stop', text });
	bindStop(button, act);
	return button;
}
/** A stop acts when it is pressed, not when it is let go. A finger on a button that scrolls away may mean to scroll. */
function bindStop(button, act) {
	let pressed = 0;
	on(button, 'pointerdown', (event) => {
		if (event.button !== 0 || (event.pointerType === 'touch' && button.id !== 'stop')) return;
		pressed = ms();
		act();
	});
	on(button, 'click', () => {
		if (ms() - pressed > 1000) act();
		pressed = 0;
	});
}
bindStop($('stop'), stopAll);
let escapeAt = 0;
on(document, 'keydown', (event) => {
	if (event.key !== 'Escape' || event.repeat || event.isComposing) return;
	const now = ms();
	if (now - escapeAt < 1000) {
		escapeAt = 0;
		stopAll();
	} else {
		escapeAt = now;
	}
}, true);

/* The turning head. */

const calm = matchMedia('(prefers-reduced-motion: reduce)');

/** Longest time for which a head turns on without a new measurement, in ms. */
const GUESSED = 500;

/** A head that turns at the measured rate, from what is shown now. The browser's compositor does not let a busy page make it jerk. */
class Head {
	constructor(rollers) {
		this.pitch = 360 / rollers;
		this.rollers = rollers;
		this.base = this.rate = this.at = 0;
		this.from = this.to = null;
		this.begun = this.lasts = 0;
		this.motion = null;
		this.known = null;
		this.wheel = s('svg', { viewBox: '-60 -60 120 120', 'aria-hidden': 'true' });
		this.rotor = div('rotor', this.wheel);
		this.unsure = s('text', { class: 'unsure', y: 8, text: '?' });
		const tube = 'M-40 58V0A40 40 0 0 1 40 0V58';
		const bed = s('svg', { viewBox: '-60 -60 120 120', 'aria-hidden': 'true' },
			s('path', { class: 'bed', d: 'M-49 8V0A49 49 0 0 1 49 0V8' }),
			s('path', { class: 'tube', d: tube }), s('path', { class: 'lumen', d: tube }),
			s('text', { class: 'port', x: -54, y: 57, text: 'in' }), s('text', { class: 'port', x: 54, y: 57, text: 'out' }),
			this.unsure);
		this.el = h('div', { class: 'head', role: 'img' }, bed, this.rotor);
	}

	know(known) {
		if (this.known === known) return;
		this.known = known;
		this.unsure.setAttribute('visibility', known ? 'hidden' : 'visible');
		if (!known) {
			place(this.wheel, s('circle', { class: 'hatched', r: 27 }));
			return;
		}
		const parts = [];
		for (let i = 0; i < this.rollers; i += 1) {
			parts.push(s('g', { transform: `rotate(${i * this.pitch})` }, s('line', { class: 'arm', x2: 33 }),
				s('circle', { class: 'roller', r: 7.5, cx: 34 }), s('circle', { class: 'pin', r: 1.8, cx: 34 })));
		}
		place(this.wheel, ...parts, s('circle', { class: 'hub', r: 9 }));
	}

	/** The angle nearest to `near` at which the picture is that of `angle`. */
	like(angle, near, by) {
		return angle + by * Math.round((near - angle) / by);
	}

	shown(now) {
		const part = this.lasts ? Math.min(1, Math.max(0, (now - this.begun) / this.lasts)) : 1;
		return this.from + (this.to - this.from) * part;
	}

	stand(angle) {
		const now = performance.now();
		const isFirst = this.to == null;
		this.base = isFirst ? angle : this.like(angle, this.shown(now), this.pitch);
		this.rate = this.at = 0;
		if (isFirst || calm.matches) this.put(this.base);
		else this.turn(this.base, now, 120);
	}

	sample(angle, now) {
		if (this.at && now - this.at < 1000) {
			if (now - this.at < 20) return;
			angle = this.like(angle, this.base + this.rate * (now - this.at), 360);
			const rate = (angle - this.base) / (now - this.at);
			this.rate = this.rate ? 0.6 * this.rate + 0.4 * rate : rate;
		} else {
			angle = this.like(angle, this.to == null ? angle : this.shown(now), this.pitch);
			this.rate = 0;
		}
		this.base = angle;
		this.at = now;
	}

	/** Turns on from what is shown, as the last measurements tell. */
	go(now) {
		if (calm.matches || !this.at) return;
		if (this.to == null) this.put(this.base);
		// A motion that is right and goes on for a while is left alone.
		const isRight = Math.abs(this.base + this.rate * (now - this.at) - this.shown(now)) < 1.5;
		if (isRight && this.begun + this.lasts - now > 200) return;
		this.turn(this.base + this.rate * (now + GUESSED - this.at), now, GUESSED);
	}

	turn(to, now, lasts) {
		this.from = this.shown(now);
		Object.assign(this, { to, begun: now, lasts });
		const at = (angle) => ({ transform: `rotate(${angle.toFixed(2)}deg)` });
		const motion = this.rotor.animate([at(this.from), at(to)], { duration: lasts, fill: 'forwards' });
		this.motion?.cancel();
		this.motion = motion;
		motion.onfinish = () => this.put(to);
	}

	put(angle) {
		this.from = this.to = angle;
		this.lasts = 0;
		this.rotor.style.transform = `rotate(${(angle % 360).toFixed(2)}deg)`;
		this.motion?.cancel();
		this.motion = null;
	}
}

/* What a pump is shown to do. */

function standWords(pump) {
	const stand = pump.view.status.safety.stand;
	const since = date(stand.since);
	if (stand.limit === 'ordered') return `${pump.name} was ordered to stand, ${since}: ${stand.reason}`;
	const limit = stand.limit === 'vessel' ? 'limit of the vessel' : 'limit of 24 h';
	return `${pump.name} stands at its ${limit} since ${since}: ${short(stand.used_ml)} mL were ` +
		`pumped, ${stand.planned_ml ? `${short(stand.planned_ml)} mL more were planned, ` : ''}` +
		`${short(stand.allowed_ml)} mL are allowed.`;
}

/** The log's line of a motion that was stopped says what it was. */
const unfinishedWord = ({ status: { unfinished: open }, last }) => (open.until_stopped ? 'run'
	: last && Date.parse(last.time) === 1000 * open.began_unix_s ? last.purpose : 'dose');
function stateOf(pump) {
	const { view, motion } = pump;
	const { status } = view;
	if (motion) {
		if (view.silent_since) return ['fault', `No word from its worker for ${span((ms() - new Date(view.silent_since)) / 1000)}`];
		if (view.stop_asked) return ['fault', 'Not stopped yet'];
		if (motion.isPlan) return ['wait', 'Planning'];
		if (motion.wait) {
			const left = span((motion.wait.until - ms()) / 1000);
			return ['wait', `Waiting: dose ${motion.wait.number} of ${motion.wait.count} begins in ${left}`];
		}
		const purpose = motion.task === 'dose' || motion.task === 'rack' ? motion.plan?.purpose : null;
		const word = motion.task === 'rack' ? TASKS.rack : TASKS[purpose] || TASKS[motion.task] || 'Busy';
		if (motion.progress) return ['move', word];
		return ['wait', STANDING.includes(motion.task) || motion.task === 'rack' ? word : `${word}: beginning`];
	}
	if (!status) return ['fault', 'The record cannot be read'];
	if (status.in_use_by) return ['wait', `${status.unfinished ? 'Another program moves it' : 'In use'}: ${status.in_use_by}`];
	if (status.safety.stand) return ['stand', status.safety.stand.limit === 'ordered' ? 'Put to stand' : 'Stands at a limit'];
	if (status.unfinished) return ['open', `A ${unfinishedWord(view)} is unfinished`];
	return ['ready', 'Ready'];
}

/** Its spaces do not break, so that no line ends within it. */
const plusMinus = ({ expanded_uncertainty_ml: u }) => `±\u00a0${spread(u)}\u00a0mL (k\u00a0=\u00a02)`;
const volumeWords = (report) => `${ml(report.delivered_ml, report.expanded_uncertainty_ml)} mL delivered`;
/** Giver of a dose: an order's origin, `schedule NAME`; null for a program beside the service. */
const giver = ({ origin }) => ({ http: 'HTTP', mqtt: 'MQTT' }[origin] || origin || '');
const loggedWords = (dose) => `${volumeWords(dose)}${dose.resumed ? ' (the rest)' : ''}, ${date(dose.time)}, ${dose.end}, by ${giver(dose) || 'a program'}`;
/** A share of a rack's step is told as `24mL, 2 of 3`, so its own volume comes first. */
const isEndless = ({ asked }) => asked === 'until stopped';
const askedWords = ({ asked, requested_ml: own }) => (asked && !asked.includes(' of ') ? asked
	: `${short(own)} mL${asked ? ` (${asked})` : ''}`);
const purposeWord = (purpose) => (purpose === 'calibrate' ? 'calibration run' : purpose === 'retract' ? 'retraction' : purpose);

/** The volume in large numerals: figure, words below it, and the bar. */
const ENDS = { weighed: ', weighed', stopped: ', stopped', fault: ', failed', 'cut-off': ', cut off' };
/** The later of the log's last dose and the last report of an order: the log is read a moment later. */
function newest(logged, last) {
	if (!last || (logged && new Date(logged.time) >= new Date(last.report.time))) return logged;
	const { report, stopped, resumed } = last;
	return { ...report, end: report.completed ? 'done' : stopped ? 'stopped' : 'fault', resumed };
}
/** When a motion ends, by its share that is done; empty for one that runs until it is stopped. */
function endWords({ motion: { plan, progress } }) {
	if (!plan || progress.of_ml == null || !progress.of_steps) return '';
	const left = plan.motion_s * Math.max(0, 1 - Math.abs(progress.steps / progress.of_steps)) + (plan.settle_s || 0);
	return left < 1 ? '' : `ends ${endOf(left)}, ${span(left)} left`;
}
/** The time of day so many seconds from now, with its date if that is another one. */
function endOf(seconds) {
	const text = date(ms() + 1000 * seconds);
	return text.slice(0, 10) === date(ms()).slice(0, 10) ? text.slice(11, 16) : text.slice(0, 16);
}
function readOf(pump) {
	const { view, motion, last } = pump;
	const unfinished = view.status?.unfinished;
	if (motion?.progress) {
		const { plan } = motion;
		const { delivered_ml: delivered, of_ml: of } = motion.progress;
		const u = plan ? plan.expanded_uncertainty_ml : 0;
		// The record still has the dose as it was before its rest.
		const rest = motion.task === 'resume' && of != null && unfinished;
		const before = rest ? 0.5 * (rest.delivered_least_ml + rest.delivered_most_ml) : 0;
		const whole = rest || plan;
		const asked = of == null ? 'so far' : !whole ? `of ${ml(of, u)} mL` : `of ${askedWords(whole)} requested`;
		const sure = plan && of != null ? `, ${plusMinus(plan)} at the end` : '';
		const figure = fixed(before + delivered, of == null ? 2 : decimalsOf(u));
		const time = endWords(pump);
		return { figure, below: `${asked}${sure}${rest ? `; ${ml(before, u)} mL before` : ''}`, time, words: `${figure} mL ${asked}${time && `, ${time}`}`,
			bar: of == null ? null : { at: before + delivered, asked: whole ? whole.requested_ml : of, of: before + of, u } };
	}
	if (motion?.plan && !motion.wait) {
		const { plan } = motion;
		return { figure: ml(0, plan.expanded_uncertainty_ml), below: isEndless(plan) ? 'until stopped' : `of ${askedWords(plan)} requested` };
	}
	if (unfinished && !motion) {
		const { delivered_least_ml: least, delivered_most_ml: most, requested_ml: asked } = unfinished;
		const isSure = Math.abs(most - least) < 0.0005 * Math.max(1, Math.abs(most));
		const what = unfinished.until_stopped ? 'delivered by a run' : `delivered of ${short(asked)} mL requested`;
		return { figure: isSure ? fixed(most, 2) : range(least, most), below: `${what}; ${view.status.in_use_by ? 'another program moves it' : 'unfinished'}`,
			bar: unfinished.until_stopped ? null : { at: 0.5 * (least + most), asked, of: asked, u: 0.5 * Math.abs(most - least) } };
	}
	const done = newest(view.last, last);
	if (done) {
		const whole = done === view.last && view.whole;
		const { delivered_ml: at, delivered_least_ml: least, delivered_most_ml: most, requested_ml: asked, expanded_uncertainty_ml: u, time } = whole || done;
		const isRest = done.resumed && !whole;
		const what = `${isRest ? 'the rest of' : `last ${purposeWord(done.purpose)}:`} ${askedWords({ ...done, requested_ml: asked })}${isRest || isEndless(done) ? '' : ' requested'}`;
		const parts = whole ? `; ${ml(whole.before_ml, u)} mL before and ${ml(done.delivered_ml, u)} mL now` : '';
		return { figure: least == null ? ml(at, u) : range(least, most),
			below: `${what}${least == null && u ? `, ${plusMinus(whole || done)}` : ''}${ENDS[done.end] || ''}${parts}; began ${date(time)}`,
			bar: isRest || done.purpose === 'run' ? null : { at, asked, of: asked, u: u || 0 } };
	}
	return { figure: '–', below: 'no dose is on record' };
}

const pressuresOf = (plan, when) => ['Inlet', 'Outlet'].map((name) => {
	const [least, most, u] = ['min', 'max', 'pressure_uncertainty'].map((of) => plan[`${name.toLowerCase()}_${of}_kpa`]);
	return [name + when, least == null ? 'unknown: the pump file does not describe this line'
		: `${fixed(least, 1)} to ${fixed(most, 1)} kPa${u == null ? '' : ` ± ${fixed(u, 1)}`}`];
});

function angleWords({ view, motion }) {
	const { status } = view;
	if (!status.angle_known) return 'unknown';
	const isTurning = motion?.progress;
	const angle = isTurning ? motion.progress.angle_deg : status.angle_deg;
	const within = status.half_width_deg > 0.005 && !isTurning ? ` ± ${short(status.half_width_deg, 2)}°` : '';
	return `${fixed(((angle % 360) + 360) % 360, 1)}°${within}`;
}

function factsOf(pump, isWide) {
	const { view, motion, last } = pump;
	const { status } = view;
	if (!status) return [];
	const plan = motion?.plan || last?.report;
	const within = status.carry_half_width_ml > 0 ? ` ± ${small(status.carry_half_width_ml)}` : '';
	const facts = [['Angle', angleWords(pump)], ['Carry', `${small(status.carry_ml)}${within}`],
		...(plan ? pressuresOf(plan, motion?.plan ? '' : ', last') : [['Pressures', 'predicted with the next plan']])];
	const { wear, safety } = status;
	const life = [[status.tube_life_ml, wear.volume_ml, 'mL'], [status.tube_life_h, wear.motion_s / 3600, 'h'],
		[status.tube_life_revolutions, wear.revolutions, 'rev']].filter(([of]) => of != null);
	facts.push(['Tube', life.length ? life.map(([of, used, unit]) => `${short(used)} of ${short(of)} ${unit}`).join(', ')
		: `${short(wear.volume_ml)} mL pumped, ${short(wear.revolutions)} rev; no life stated`]);
	const limit = (used, left, of) => `${used}${of == null ? '; no limit' : `, ${short(left)} mL left of ${short(of)} mL`}`;
	facts.push([safety.cleared ? `Since it was cleared, ${date(safety.cleared)}` : 'Last 24 h', limit(`${short(safety.day_ml)} mL pumped`, safety.day_left_ml, safety.max_ml_per_day)],
		['Vessel', limit(`${short(safety.received_ml)} mL received`, safety.vessel_left_ml, safety.vessel_ml)]);
	if (safety.under_way_ml) facts.push(['Under way', `up to ${short(safety.under_way_ml)} mL more`]);
	if (safety.clock_behind_s) facts.push(['Clock', `${span(safety.clock_behind_s)} behind the record: no volume becomes free`]);
	if (!isWide) return facts;
	if (plan) facts.push(['Flow', `${short(plan.cruise_flow_ml_s)} mL/s at ${short(plan.cruise_speed_rpm)} r/min`]);
	facts.push(['Calibration', status.calibration ? `number ${status.calibration.version} of ${status.calibration.date.slice(0, 10)}`
		: 'none; volumes are those of the model']);
	if (status.unfinished_calibration) facts.push(['Also', 'a guided calibration by the command is unfinished']);
	facts.push(['Rollers', `${view.rollers}, ${short(view.pitch_deg)}° apart; 0° is where one begins to leave the outlet`],
		['Motor', view.simulated ? `simulated (${view.driver})` : `${view.driver}${view.port ? ` at ${view.port}` : ''}`],
		['Record', status.folder]);
	return facts;
}

function showFacts(list, facts) {
	const names = facts.map(([name]) => name).join('\n');
	if (list.names !== names) {
		list.names = names;
		place(list, ...facts.flatMap(([name]) => [h('dt', { text: name }), h('dd', {}, h('span', { class: name === 'Angle' ? 'line' : null }))]));
	}
	facts.forEach(([, value], i) => say(list.children[2 * i + 1].firstChild, value));
}

/* Forms. */

const isBusy = ({ motion, view: { status } }) => Boolean(motion || status?.in_use_by);
function showError(said, error, pump) {
	const kids = [];
	if (!(error instanceof Refused)) kids.push(bad('The service did not answer, so the order may have begun: look at the pump. The same button asks again, and does not dose twice.'));
	else {
		kids.push(bad((error.code === 3 ? 'In use: ' : '') + error.message));
		if (pump && error.code === 4) kids.push(...unfinishedActions(pump));
		if (pump && error.code === 5) kids.push(...standActions(pump));
		if (/weighed/.test(error.message) && error.kind === 'changed') kids.push(inRow(firstly('Dose again', () => { closeAll(); calibrate(pump); })));
	}
	place(said, h('div', { class: 'notice bad', role: 'alert' }, kids));
	if (!pump) return;
	pump.refused.set(said, { code: error.code });
	refresh(pump);
}

async function once(button, act, fail) {
	if (button.getAttribute('aria-disabled') === 'true') return;
	attr(button, 'aria-disabled', 'true');
	await act().catch(fail);
	attr(button, 'aria-disabled', 'false');
}
const send = (button, said, pump, word, body, done) => once(button, async () => {
	pump?.refused.delete(said);
	place(said, para('Sent…'));
	await done(await give(pump ? ofPump(pump.name, word) : word, body));
	// A pump does not stand for a plan that is refused, so there is nothing to clear.
}, (error) => showError(said, error, body.options?.['dry-run'] && error.code === 5 ? null : pump));
const saidBox = () => h('div', { class: 'said', 'aria-live': 'polite' });
async function completed(order) {
	order = await ended(order);
	if (order.state !== 'done') throw orderError(order);
	return order;
}
function orderError(order) {
	const error = order.error || { code: order.code, message: `the order ended with exit code ${order.code}` };
	return new Refused(error, 422);
}

function field(label, placeholder, props = {}) {
	const id = newId();
	const hintId = props.hint ? `${id}h` : null;
	const { hint, ...rest } = props;
	const input = h('input', { type: 'text', id, name: label.toLowerCase(), autocomplete: 'off', autocapitalize: 'off',
		spellcheck: 'false', 'aria-describedby': hintId, placeholder: placeholder || null, ...rest });
	const el = div('grow', h('label', { for: id, text: label }), input,
		hint && line('hint', hint, { id: hintId }));
	return { el, input };
}
function check(label) {
	const input = h('input', { type: 'checkbox' });
	return { el: h('label', { class: 'check' }, input, h('span', { text: label })), input };
}
function choice(label, options) {
	const id = newId();
	const input = h('select', { id }, options.map(([value, text]) => h('option', { value, text })));
	return { el: h('div', {}, h('label', { for: id, text: label }), input), input };
}

function planList(report) {
	const facts = [
		['Volume', `${ml(report.planned_ml, report.expanded_uncertainty_ml)} mL ${plusMinus(report)}`],
		['Time', `${short(report.motion_s)} s${report.settle_s ? `, then ${short(report.settle_s, 2)} s to settle` : ''}`],
		['Flow', `${short(report.cruise_flow_ml_s)} mL/s at ${short(report.cruise_speed_rpm)} r/min`],
		...pressuresOf(report, ''),
		['Carry after it', small(report.carry_ml)],
	];
	if (report.limited_by !== 'none') facts.push(['Limited by', report.limited_by.replaceAll('_', ' ')]);
	if (!report.phase.known) facts.push(['Angle', 'unknown: the plan suits every angle']);
	const list = h('dl', { class: 'facts' });
	showFacts(list, facts);
	return [list, warningsOf(report)];
}
function warningsOf(report) {
	const warnings = (report.warnings || []).map((text) => h('li', { text: String(text).replace('`dose calibrate run`', '“Calibrate…”') }));
	return warnings.length ? h('ul', { class: 'plain' }, warnings) : null;
}
function showPlans(said, order) {
	const heading = h('h3', { text: 'Plan (nothing has moved)', tabindex: '-1' });
	const doses = dosesOf(order);
	const parts = doses.map(({ name, report }) => [
		doses.length > 1 ? line('what', `${name}: ${askedWords(report)}`) : null, planList(report)]);
	place(said, div('plan', heading, parts.flat(2)));
	heading.focus();
}

const text = (box, unit) => (unit ? withUnit(box.input.value, unit) : box.input.value.trim());

const ML = { ul: 1e-3, ml: 1, l: 1000, g: 1 };
const SECONDS = { s: 1, min: 60, h: 3600, d: 86400 };
/** A number with a usual unit; NaN for what only the command can read. */
function quantity(text, units) {
	const [, number, unit] = /^[-+−]?([\d.]+)\s*(\S+)$/.exec((text || '').trim()) || [];
	return Number(number) * units[(unit || '').toLowerCase()];
}
/** About how long a dose takes, s, by its words alone. */
function roughly(pump, { volume, options }) {
	if (options.repeat) return NaN;
	if (options.within) return quantity(options.within, SECONDS);
	const [flow, per] = (options.rate || '').split('/');
	return quantity(volume, ML) / (options.rate ? quantity(flow, ML) / SECONDS[per?.trim()] : pump.view.default_flow_ml_s);
}
/** Doses, but plans one that may be long first, and asks once more before one that takes over an hour: it may be a slip. */
function sendDose(button, said, pump, body, done) {
	const go = (by) => send(by, said, pump, 'dose', body, done);
	if (roughly(pump, body) < 1200) return go(button);
	const { repeat, every, ...options } = body.options;
	return send(button, said, pump, 'dose', { volume: body.volume, options: { ...options, 'dry-run': true } }, async (order) => {
		const [{ report }] = dosesOf(await completed(order));
		const [count, one] = [Number(repeat) || 1, report.motion_s + (report.settle_s || 0)];
		const lasts = one + (count - 1) * Math.max(one, quantity(every, SECONDS) || 0);
		if (lasts <= 3600) return setTimeout(() => go(button), 0);
		const sure = firstly(`Dose for ${span(lasts)}`, () => go(sure));
		askFirst(said, `This takes ${span(lasts)}, until ${endOf(lasts)}. Nothing moves yet.`, sure);
	});
}

function doseForm(pump, isWide) {
	const volume = field('Volume', '25mL', { required: true, hint: isWide ? 'A number alone is in mL. 25g doses by mass; a minus sign reverses.' : null });
	const said = saidBox();
	const button = submit('Dose');
	const parts = { rate: null };
	let more = null;
	let plan = null;
	if (isWide) {
		Object.assign(parts, {
			rate: field('Rate', `${short(pump.view.default_flow_ml_s)}mL/s`, { hint: 'A number alone is in mL/s; max is the fastest.' }),
			within: field('Within', '10s'), retract: field('Retract', '0.1mL'),
			temperature: field('Temperature', '20degC'), fluid: field('Fluid', 'water'),
			repeat: field('Number of doses', '5'), every: field('One every', '30s'),
			'max-per-day': field('Most in 24 h', '50mL'),
			finish: choice('End', [['', 'as configured'], ['any', 'anywhere'], ['low-flow', 'at low flow']]),
			ramps: choice('Ramps', [['', 'as configured'], ['line', 'gentle on the line'], ['fastest', 'fastest']]),
		});
		parts.smooth = check('Smooth flow');
		parts.reverse = check('Reverse');
		const { rate, smooth, ...others } = parts;
		more = moreOf(fields(Object.values(others).map((part) => part.el)));
		plan = press('Plan', () => {
			if (isEmpty()) return;
			send(plan, said, pump, 'dose', body(true), async (order) => {
				showPlans(said, await completed(order));
			});
		});
	}
	const body = (dry) => {
		const options = {};
		for (const [name, part] of Object.entries(parts)) {
			if (!part) continue;
			if (part.input.type === 'checkbox') { if (part.input.checked) options[name] = true; }
			else if (text(part)) options[name] = text(part, { rate: 'mL/s', retract: 'mL', 'max-per-day': 'mL' }[name]);
		}
		if (dry) options['dry-run'] = true;
		return { volume: text(volume, 'mL'), options };
	};
	const isEmpty = () => !text(volume) && (needs(volume, said, 'Enter a volume, such as 25mL.'), true);
	const start = (by) => sendDose(by, said, pump, body(false), (order) => {
		tellTaken(said, order, `dose ${order.volume}`);
	});
	return formOf(() => {
		if (isEmpty()) return;
		if (isWide || !/^[-−]/.test(text(volume))) return start(button);
		const sure = firstly('Dose in reverse', () => start(sure));
		askFirst(said, `The minus sign has ${pump.name} run in reverse. Nothing moves yet.`, sure);
	}, { 'aria-label': `Dose with ${pump.name}` }, isWide ? fields(volume.el, parts.rate.el) : inRow(volume.el, button),
	isWide && parts.smooth.el, more, isWide && inRow(button, plan), said);
}
/** Asks before a button does what may be a slip. */
function askFirst(said, words, sure) {
	place(said, div('notice', para(words), inRow(sure)));
	sure.focus();
}
function needs(box, said, words) {
	place(said, alarm(words));
	box.input.focus();
}

function plainForm(pump, word, label, hint, boxes, bodyOf) {
	const said = saidBox();
	const button = h('button', { type: 'submit', text: label });
	return formOf(() => {
		const missing = boxes.find((box) => box.input.required && !text(box));
		if (missing) return needs(missing, said, 'Fill this in first.');
		send(button, said, pump, word, bodyOf(), (order) => {
			tellTaken(said, order, word);
		});
	}, { 'aria-label': `${label}: ${pump.name}` }, h('h3', { text: label }), aside(hint),
	inRow(boxes.map((box) => box.el), button), said);
}

function orderButton(pump, word, label, isFirst, bodyOf, done) {
	const said = saidBox();
	const button = press(label, () => send(button, said, pump, word, bodyOf ? bodyOf() : {}, (order) => {
		tellTaken(said, order, word);
		if (done) done(order);
	}), { class: isFirst && 'first' });
	return { button, said };
}
/** The dose that a button was made for, so that no other one is resumed or accepted. */
const meant = (open) => () => ({ options: open?.number ? { dose: open.number } : {} });
function unfinishedActions(pump) {
	const unfinished = pump.view.status?.unfinished;
	const isOverTime = unfinished?.over_time;
	const resume = orderButton(pump, 'resume', 'Resume', true, meant(unfinished));
	const accept = press('Accept…', () => askAccept(pump));
	const words = isOverTime ? 'Its time has passed, so the rest cannot be delivered. Accept leaves it as it is.'
		: unfinished?.until_stopped ? 'Resume goes on with the run. Accept leaves it as it is.'
			: 'Resume delivers the rest. Accept leaves it as it is.';
	return [para(words), inRow(isOverTime ? null : resume.button, accept), resume.said];
}
const emptiedButton = (pump) => press('Vessel emptied…', () => askEmptied(pump));
function standActions(pump) {
	const { stand } = pump.view.status?.safety || {};
	const emptied = stand?.limit === 'vessel' && emptiedButton(pump);
	return [para('The pump will not move until somebody clears it.'),
		inRow(emptied, firstly('Clear…', () => askClear(pump)))];
}

/* Dialogs. Each has the stop, since it covers the page's. */

function dialog(title, kids, first) {
	const id = newId();
	const box = h('dialog', { 'aria-labelledby': id }, h('h2', { id, text: title }), kids,
		div('row stops', first, press('Close', () => box.close()), stopButton('Stop all', stopAll)));
	on(box, 'close', () => box.remove());
	document.body.append(box);
	box.showModal();
	return box;
}
const closeAll = () => document.querySelectorAll('dialog').forEach((box) => box.close());

/** The volume and the time of an unfinished dose. */
const openWords = (pump) => `${readOf(pump).figure} mL ${readOf(pump).below}; begun ${date(1000 * pump.view.status.unfinished.began_unix_s)}.`;
function askAccept(pump) {
	const open = pump.view.status?.unfinished;
	const { button, said } = orderButton(pump, 'accept', 'Accept', true, meant(open), () => box.close());
	const step = div('step', open && para(openWords(pump)),
		para('The rest is not delivered, and the carry starts again at 0.'), inRow(button), said);
	const box = dialog(`Accept the ${open ? unfinishedWord(pump.view) : 'dose'} of ${pump.name}?`, [step]);
	on(box, 'close', () => { onPump = null; });
	onPump = () => {
		const isIt = !isBusy(pump) && pump.view.status?.unfinished?.number === open?.number;
		if (isIt || button.ariaDisabled === 'true') return;
		onPump = null;
		place(step, bad('This dose is not unfinished any more: somebody has resumed or accepted it.'));
	};
}
function askEmptied(pump) {
	const act = orderButton(pump, 'emptied', 'The vessel is empty', true, null, () => box.close());
	const box = dialog(`Vessel of ${pump.name}`, [
		para('Empty the receiving vessel first. The record then counts from 0 mL. A pump that stands at a limit still has to be cleared.'),
		inRow(act.button), act.said]);
}
function askClear(pump) {
	const name = field('Name of the pump', '', { required: true, hint: `Type ${pump.name}, so that no other pump is cleared.` });
	const reason = field('Reason', 'the tank was changed', { required: true });
	const by = field('Your name', '', { required: true });
	const said = saidBox();
	const button = submit('Clear the pump');
	const box = dialog(`Clear ${pump.name}`, [para(pump.view.status?.safety.stand ? standWords(pump) : ''),
		formOf(() => {
			if (text(name) !== pump.name) return needs(name, said, `Type the name of this pump: ${pump.name}`);
			const missing = [reason, by].find((box) => !text(box));
			if (missing) return needs(missing, said, 'Fill this in first.');
			send(button, said, null, ofPump(pump.name, 'clear'), { reason: text(reason), by: text(by) }, async (order) => {
				await completed(order);
				box.close();
				politely(`${pump.name} is cleared.`, true);
			});
		}, {}, name.el, reason.el, by.el, inRow(button), said)]);
}

/** Asks which calibration doses use: `old` is that before the present one. */
async function askCalibration(pump, old) {
	const which = choice('Doses use', [['none', 'none: the volumes of the model']]);
	const use = orderButton(pump, 'calibrate/use', 'Use it', true, () => ({ calibration: which.input.value }), () => box.close());
	const box = dialog(`Calibration of ${pump.name}`, [which.el, inRow(use.button), use.said]);
	try {
		const { active, calibrations } = await get(`pumps/${inPath(pump.name)}/calibrations`);
		which.input.append(...calibrations.map(({ version, date: day, displacement }) => h('option', { value: version,
			text: `number ${version} of ${day.slice(0, 10)}${displacement ? `, factor ${short(displacement.factor, 5)}` : ''}${version === active ? ', in use' : ''}` })));
		which.input.value = old || 'none';
	} catch (error) {
		showError(use.said, error);
	}
}

function calibrate(pump) {
	const step = div('step');
	const box = dialog(`Calibrate ${pump.name}`, [step]);
	const steps = 3;
	on(box, 'close', () => { onPump = null; });
	const put = (number, title, ...kids) => {
		const heading = h('h3', { text: `${number ? `Step ${number} of ${steps}: ` : ''}${title}`, tabindex: '-1' });
		place(step, heading, ...kids.flat().filter(Boolean));
		heading.focus();
	};
	const first = () => {
		const volume = field('Volume', '', { value: '10mL', required: true, hint: 'The more revolutions the head makes, the better the calibration.' });
		const said = saidBox();
		const button = submit('Dose');
		const logged = pump.view.last;
		const isWhole = logged?.purpose === 'dose' && ['done', 'weighed'].includes(logged.end) && !pump.view.status?.unfinished;
		put(1, 'dose', para('Put an empty vessel on the scale under the outlet, and tare the scale. The line must be full.'),
			formOf(() => {
				sendDose(button, said, pump, { volume: text(volume, 'mL'), options: {} }, second);
			}, {}, volume.el, inRow(button), said),
			isWhole && [aside(`Last dose: ${loggedWords(logged)}.`), press('Weigh the last dose instead', () => third(logged, String(logged.number), loggedWords(logged)))]);
	};
	const second = async (order) => {
		const figure = h('p', { class: 'big' });
		put(2, 'wait', para('The pump doses. Leave the scale alone.'), figure);
		const timer = setInterval(() => {
			const read = readOf(pump);
			place(figure, read.figure, h('small', { text: ' mL' }));
		}, 200);
		try {
			order = await ended(order);
		} catch (error) {
			const said = saidBox();
			put(2, 'it is not known how the dose ended', said);
			return showError(said, error, pump);
		} finally {
			clearInterval(timer);
		}
		if (!box.isConnected) return;
		if (order.state === 'done') {
			const report = order.reports.filter(isDose).pop();
			return third(report, order.id, volumeWords(report));
		}
		const said = saidBox();
		const resume = firstly('Resume', () => send(resume, said, pump, 'resume', {}, second));
		put(2, 'the dose was not completed', bad(orderError(order).message),
			order.state === 'failed' && inRow(resume, press('Accept…', () => { box.close(); askAccept(pump); })), said);
	};
	const third = ({ delivered_ml: dosed, expanded_uncertainty_ml: u, time }, dose, words) => {
		onPump = () => {
			const { last: other } = pump.view;
			if (!other || [other.order, String(other.number)].includes(dose) || Date.parse(other.time) < Date.parse(time)) return;
			onPump = null;
			put(0, 'Another dose was made since', bad(`${loggedWords(other)}. A reading would be of both.`),
				para('Empty the vessel, and tare the scale.'), inRow(firstly('Dose again', first)));
		};
		const reading = field('Reading', '23.8g', { required: true, hint: 'Type every digit that the scale shows: the last one tells how fine the scale is. A number alone is in g.' });
		const anyway = check(ANYWAY);
		const anew = check('Start a new calibration with it');
		const said = saidBox();
		const button = submit('Calibrate');
		put(3, 'weigh', para(`${words}. Wait until the last drop has fallen.`),
			formOf(() => {
				if (!text(reading)) return needs(reading, said, 'Enter the reading, such as 23.8g.');
				const body = { reading: text(reading, 'g'), options: { dose, anyway: anyway.input.checked, anew: anew.input.checked, 'dry-run': true } };
				const old = pump.view.status?.calibration?.version;
				const go = (by) => send(by, said, pump, 'calibrate', body, async (order) => {
					const made = (await completed(order)).reports.find((one) => one?.schema === 'calibration/1');
					if (!body.options['dry-run']) return last(made, old);
					body.options['dry-run'] = false;
					const percent = made?.next_weighing?.dose_percent;
					const isPoor = body.reading.replace(/\D/g, '').length < 3 || (made?.used !== false && u && percent > 110 * u / Math.abs(dosed));
					if (!isPoor) return setTimeout(() => go(by), 0);
					const sure = firstly('Save it all the same', () => go(sure));
					askFirst(said, `Nothing is saved yet. By ${body.reading}${percent ? ` one dose would be ± ${short(percent, 2)} %` : ''}. ` +
						'Type every digit that the scale shows.', sure);
				});
				go(button);
			}, {}, reading.el, moreOf(anyway.el, anew.el), inRow(button), said));
		reading.input.focus();
		onPump();
	};
	const last = (made, old) => {
		onPump = null;
		const facts = [];
		if (made?.displacement) {
			facts.push(['Factor', `${short(made.displacement.factor, 5)} ± ${short(2 * made.displacement.factor_standard, 2)} (k = 2)`],
				['Revolution', `${short(made.revolution_ml * made.displacement.factor)} mL`], ['Doses weighed', String(made.runs.length)]);
		}
		if (made?.next_weighing) {
			const next = made.next_weighing;
			facts.push(['Uncertainty now', `one dose ± ${short(next.dose_percent, 2)} %, the mean of many ± ${short(next.mean_percent, 2)} %`],
				['After one more', `one dose ± ${short(next.then_dose_percent, 2)} %, the mean of many ± ${short(next.then_mean_percent, 2)} %`]);
		}
		const list = h('dl', { class: 'facts' });
		showFacts(list, facts);
		const used = made?.used === false
			? 'Not in use yet: the model is still more accurate than this calibration. Weigh one more dose.'
			: 'Doses use it from now on.';
		put(0, 'Calibration saved', para(used), list, made && warningsOf(made),
		inRow(firstly('Weigh one more dose', first), press('Use another calibration…', () => {
			box.close();
			askCalibration(pump, old);
		})));
	};
	first();
}

/* A pump's panel, as a card or as a view. */

class Panel {
	constructor(pump, isWide) {
		this.pump = pump;
		this.isWide = isWide;
		const { view } = pump;
		this.head = new Head(view.rollers);
		this.state = line('state');
		this.notice = div('notices');
		this.figure = h('p', { class: 'big' }, h('span'), h('small', { text: ' mL' }));
		this.below = line('what');
		this.time = line('time', null, { hidden: true });
		this.full = div('full');
		this.band = div('band');
		this.mark = div('mark');
		this.bar = h('div', { class: 'bar', 'aria-hidden': 'true' }, this.band, this.full, this.mark);
		this.facts = h('dl', { class: 'facts' });
		this.warnings = h('div');
		const title = isWide ? h('h1', { tabindex: '-1', text: pump.name })
			: h('h2', {}, h('a', { href: `#/pump/${inPath(pump.name)}`, text: pump.name }));
		this.sim = line('sim', 'Simulated: no motor moves', { hidden: !view.simulated });
		const top = [div('titled', title, this.sim), line('what', view.title), this.state,
			this.notice, div('face', this.head.el,
				div('read', this.figure, this.bar, this.below, this.time))];
		const stop = this.stop = stopButton(`Stop ${pump.name}`, () => stopAll(pump), true);
		if (!isWide) {
			this.el = h('article', { class: 'panel', 'aria-label': pump.name }, top, doseForm(pump, false),
				inRow(stop, h('a', { class: 'button', href: `#/pump/${inPath(pump.name)}`, text: 'Prime, run, calibrate, plan' })), this.facts);
			return;
		}
		const [prime, purge] = [1, 2].map(() => field('Volume', '20mL', { required: true }));
		const [rate, time] = [field('Rate', `such as ${short(view.default_flow_ml_s)}mL/s`, { required: true }), field('For', '10min', { hint: 'With its unit: s, min or h.' })];
		const log = h('div');
		this.log = pumpLog([pump.name], log, '30d', 10);
		this.el = div('wide', h('p', {}, h('a', { href: '#/', text: '← All pumps' })),
			h('section', { class: 'panel', 'aria-label': pump.name }, top, this.warnings, stop),
			div('two',
				h('div', {}, block(head2('Dose'), doseForm(pump, true)),
					block(head2('Care'),
						para('Weigh a dose, so that the next ones are right.'),
						inRow(press('Calibrate…', () => calibrate(pump)), press('Use another calibration…', () => askCalibration(pump)),
							emptiedButton(pump)))),
				block(head2('State'), this.facts),
				block(head2('Line'),
					plainForm(pump, 'prime', 'Prime', 'Fills the line. The carry stays as it is.', [prime], () => ({ volume: text(prime, 'mL'), options: {} })),
					plainForm(pump, 'purge', 'Purge', 'Empties the line. A negative volume runs backwards.', [purge], () => ({ volume: text(purge, 'mL'), options: {} })),
					plainForm(pump, 'run', 'Run', 'Runs at a rate for a time. Without a time it runs until it is stopped.', [rate, time], () => {
						const options = { rate: text(rate, 'mL/s') };
						if (text(time)) options.for = text(time);
						return { options };
					}))),
			block(head2('Last doses'), log));
	}

	update() {
		const { pump } = this;
		const { view, motion, fault } = pump;
		const { status } = view;
		const [state, words] = stateOf(pump);
		attr(this.el, 'data-state', state);
		say(this.state, words);
		this.sim.hidden = !view.simulated;
		this.stop.classList.toggle('calm', !motion);
		const unfinished = !motion && status && !status.in_use_by && status.unfinished;
		// A dose that was resumed and stopped again is named by its first part.
		const begun = view.whole && view.last.end !== 'done' ? view.whole.time : unfinished && 1000 * unfinished.began_unix_s;
		const stand = status?.safety.stand;
		const busy = isBusy(pump);
		remake(this.notice, [view.error, fault, stand, unfinished && [unfinished.began_unix_s, unfinished.delivered_most_ml], busy], () => [
			view.error && danger(bad(view.error)),
			fault && danger(bad(`The last order failed: ${fault.message}`)),
			stand && !busy && danger(bad(standWords(pump)), standActions(pump)),
			unfinished && div('notice',
				para(`A ${unfinishedWord(view)} of ${date(begun)} is unfinished.`),
				unfinishedActions(pump)),
		]);
		if (this.isWide && unfinished && pump.leads) {
			pump.leads = false;
			this.notice.scrollIntoView({ block: 'center' });
		}
		// A refusal goes once its reason, which the pump's record may tell later than the answer, has gone.
		for (const [said, reason] of pump.refused) {
			const isSo = { 3: busy, 4: status?.unfinished && !motion, 5: stand }[reason.code];
			if (status && !isSo && reason.seen) {
				place(said);
				pump.refused.delete(said);
			}
			reason.seen ||= isSo;
		}
		this.figures();
		showFacts(this.facts, factsOf(pump, this.isWide));
		const angleKnown = Boolean(status?.angle_known);
		this.head.know(angleKnown);
		if (!motion?.progress && angleKnown) {
			if (this.stoodAt !== status.angle_deg || this.wasTurning) this.head.stand(status.angle_deg);
			this.stoodAt = status.angle_deg;
		}
		this.wasTurning = Boolean(motion?.progress);
		const where = !angleKnown ? '; the angle is unknown' : this.wasTurning ? '' : ` at ${fixed(status.angle_deg, 1)}°`;
		attr(this.head.el, 'aria-label', `Pump head with ${view.rollers} rollers, ${this.wasTurning ? 'turning' : 'standing'}${where}`);
		if (this.isWide) {
			const report = pump.last && !motion ? pump.last.report : null;
			remake(this.warnings, report?.warnings, () => report && warningsOf(report));
			const shown = lastOf(pump);
			if (!motion && this.logged !== shown) {
				this.logged = shown;
				this.log();
			}
		}
	}

	figures() {
		const { pump } = this;
		const read = readOf(pump);
		say(this.figure.firstChild, read.figure);
		const { length } = read.figure;
		if (this.long !== length) {
			this.long = length;
			this.figure.classList.toggle('long', length > 8);
			this.figure.style.setProperty('--n', length);
		}
		say(this.below, read.below);
		say(this.time, read.time || '');
		this.time.hidden = !read.time;
		this.bar.hidden = !read.bar;
		if (read.bar) this.drawBar(read.bar);
		if (pump.view.status && this.facts.children[1]) say(this.facts.children[1].firstChild, angleWords(pump));
	}

	drawBar({ at, asked, of, u }) {
		const whole = 1.03 * (Math.max(Math.abs(asked), Math.abs(of)) + u) || 1;
		const part = (value) => Math.min(1, Math.max(0, Math.abs(value) / whole));
		this.full.style.transform = `scaleX(${part(at).toFixed(4)})`;
		const key = `${asked} ${of} ${u}`;
		if (this.bar.key === key) return;
		this.bar.key = key;
		const low = part(Math.max(0, Math.abs(of) - u));
		this.band.style.left = `${100 * low}%`;
		this.band.style.right = `${100 * (1 - part(Math.abs(of) + u))}%`;
		this.mark.style.left = `calc(${100 * part(asked)}% - 1px)`;
	}
}

function refresh(pump) {
	for (const panel of pump.panels) panel.update();
	onPump?.();
}
// Counters by themselves: a batch that waits, and a silence.
setInterval(() => pumps.forEach((pump) => { if (pump.motion?.wait || pump.view.silent_since) refresh(pump); }), 1000);

const pairs = (names, own) => [...new Set([...names, own].filter(Boolean))].map((name) => [name, name]);

/* The log. */

function table(caption, heads, rows) {
	// Blocks on a phone lose the roles of a table, so the roles are written.
	return h('table', { role: 'table' }, h('caption', { text: caption }),
		h('thead', { role: 'rowgroup' }, h('tr', { role: 'row' }, heads.map((text) => h('th', { role: 'columnheader', scope: 'col', text })))),
		h('tbody', { role: 'rowgroup' }, rows.map((row) => h('tr', { role: 'row', class: row.isBad && 'bad' },
			row.map((cell, i) => h('td', { role: 'cell', 'data-label': heads[i] }, cell instanceof Node ? cell : cell && h('span', { text: cell })))))));
}

/** Reads a log line by line, and keeps its last `most` doses. */
async function readLog(path, most) {
	const answer = await fetch(path, { cache: 'no-store' });
	if (!answer.ok) {
		if (answer.status === 401) showLogin();
		throw new Refused(await answer.json().catch(() => unknownOf(answer)), answer.status);
	}
	const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
	const kept = [];
	let count = 0;
	let rest = '';
	for (;;) {
		const { done, value } = await reader.read();
		rest += done ? '\n' : value;
		const lines = rest.split('\n');
		rest = lines.pop();
		for (const line of lines) {
			if (!line.includes('"log/1"')) continue;
			kept.push(line);
			count += 1;
		}
		if (kept.length > 2 * most) kept.splice(0, kept.length - most);
		if (done) return { count, doses: kept.slice(-most).map((line) => JSON.parse(line)).reverse() };
	}
}

function logRow(dose, name) {
	const u = dose.expanded_uncertainty_ml;
	const volume = dose.delivered_least_ml == null ? `${ml(dose.delivered_ml, u)}${u == null ? '' : ` ± ${spread(u)}`} mL`
		: `${range(dose.delivered_least_ml, dose.delivered_most_ml)} mL`;
	const asked = dose.asked || (dose.requested_ml == null ? '' : `${short(dose.requested_ml)} mL`);
	const what = [dose.weighed ? 'calibration' : purposeWord(dose.purpose), dose.resumed && '(rest)', dose.rack && `(rack ${dose.rack})`].filter(Boolean).join(' ');
	const end = [dose.cause ? `${dose.end}: ${dose.cause}` : dose.end, dose.accepted && `accepted by ${giver({ origin: dose.accepted })}`];
	return [...(name ? [name] : []), String(dose.number), date(dose.time) + (dose.clock_went_back ? ' (the clock had gone back)' : ''), what, asked, volume,
		small(dose.carry_ml), end.filter(Boolean).join('; '), String(dose.tube), giver(dose)];
}

/** The end of a pump's log in a word that changes with it, also when a dose is accepted or weighed. */
const lastOf = ({ view: { last, status } }) => [last?.number, last?.end, !status?.unfinished, status?.calibration?.version].join();

/** Fills `box` with the last doses of these pumps. Returns the function that reads them anew. */
function pumpLog(names, box, since, most) {
	const [name, another] = names;
	const path = (of, format) => `${ofPump(of, 'log')}?format=${format}${since ? `&since=${since}` : ''}`;
	const link = (format, ending) => h('a', { class: 'button', href: path(name, format), download: `${name}.${ending}`, text: `Export ${format.toUpperCase()}` });
	const links = another ? aside('Choose one pump to export its log.') : inRow(link('csv', 'csv'), link('json', 'jsonl'));
	const heads = ['No.', 'Time', 'Purpose', 'Asked', 'Delivered', 'Carry', 'End', 'Tube', 'By'];
	let run = 0;
	return async () => {
		const mine = ++run;
		try {
			const logs = await Promise.all(names.map((of) => readLog(path(of, 'json'), most)));
			if (mine !== run) return;
			const count = logs.reduce((sum, log) => sum + log.count, 0);
			const rows = logs.flatMap(({ doses }, i) => doses.map((dose) => ({ at: Date.parse(dose.time), cells: logRow(dose, another && names[i]) })));
			// The log of one pump has its order, whatever its clock said.
			if (another) rows.sort((a, b) => b.at - a.at).splice(most);
			const which = `${count > rows.length ? `The last ${rows.length} of ${count} doses` : 'Doses'} of ${another ? 'all pumps' : name}`;
			const cut = names.map((of) => pumps.get(of)).filter(({ motion, view: { last, status } }) => !motion && status?.unfinished && !(last?.number >= status.unfinished.number));
			place(box, ...cut.map((pump) => bad(`${pump.name}: cut off, ${openWords(pump)} It has its row once the pump is used again.`)), rows.length ? table(`${which}, latest first; ± is k = 2`, another ? ['Pump', ...heads] : heads, rows.map(({ cells }) => cells))
				: para('No dose is on record in this time.'), links);
		} catch (error) {
			if (mine !== run) return;
			place(box, bad(wordsOf(error, 'The log cannot be read: the service does not answer.')), links);
		}
	};
}

/* Views. */

const SAYS = { waiting: 'waiting for its first word', well: 'alive: all is well', bad: 'not well: ', silent: '' };
function guardSection() {
	const box = h('div');
	const section = h('section', { class: 'panel', hidden: true }, head2('Guard'), box);
	onInputs = async () => {
		const inputs = await get('inputs').catch(() => null);
		if (!inputs || !section.isConnected) return;
		section.hidden = inputs.length === 0;
		const rows = inputs.map(({ name, state, reason, last, pumps: guarded }) => {
			const row = [name, SAYS[state] + (reason || '').replace(`${name}: `, ''), last ? `${span((ms() - new Date(last)) / 1000)} ago` : 'none yet', guarded.join(', ')];
			row.isBad = state === 'bad' || state === 'silent';
			return row;
		});
		place(box, table('Inputs that must say that all is well', ['Input', 'State', 'Last word', 'Pumps'], rows));
	};
	return section;
}
setInterval(() => { if (onInputs && isLive && !document.hidden) onInputs(); }, 5000);

function viewPumps() {
	const cards = all().map((pump) => panelOf(pump, false).el);
	const rackCards = racks.map((name) => {
		const said = saidBox();
		const path = `/api/v1/racks/${inPath(name)}/run`;
		const plan = press('Plan', () => send(plan, said, null, path, { options: { 'dry-run': true } }, async (order) => {
			showPlans(said, await completed(order));
		}), { 'aria-label': `Plan rack ${name}` });
		const run = press('Run…', () => {
			const answer = saidBox();
			const go = firstly('Run the rack', () => send(go, answer, null, path, { options: {} }, (order) => {
				tellTaken(said, order, `rack ${name}`);
				box.close();
			}));
			const box = dialog(`Run rack ${name}?`, [para('Several pumps move by one timetable.'), inRow(go), answer]);
		}, { 'aria-label': `Run rack ${name}` });
		return block(h('h3', { text: name }), inRow(run, plan), said);
	});
	const events = h('ul', { class: 'plain' });
	const section = block(head2('Last events'), events, h('p', {}, h('a', { href: '#/log', text: 'All events' })));
	watchNotes(5, () => {
		section.hidden = notes.length === 0;
		place(events, ...notes.slice(0, 5).map((note) => h('li', { text: `${date(note.time)} ${noteWords(note)}` })));
	});
	return ['Pumps', [head1('Pumps'), div('grid', cards),
		racks.length && [head2('Racks'), div('grid', rackCards)], guardSection(), section]];
}

function panelOf(pump, isWide) {
	const panel = new Panel(pump, isWide);
	pump.panels.add(panel);
	panel.update();
	const told = pump.motion?.progress;
	if (told) panel.head.sample(told.angle_deg, performance.now());
	return panel;
}

function viewPump(name) {
	const pump = pumps.get(name);
	if (!pump) return ['No such pump', [head1('No such pump'),
		h('p', {}, `The configuration has no pump named ${name}. `, h('a', { href: '#/', text: 'All pumps' }))]];
	const panel = panelOf(pump, true);
	panel.log();
	return [name, [panel.el]];
}

function viewLog() {
	const which = choice('Pump', [...(pumps.size > 1 ? [['', 'all pumps']] : []), ...pairs(pumps.keys())]);
	const since = choice('Since', [['1d', '1 day ago'], ['7d', '7 days ago'], ['30d', '30 days ago'], ['', 'the first dose']]);
	since.input.value = '7d';
	const box = h('div');
	const names = () => [...pumps.keys()].filter((name) => [name, ''].includes(which.input.value));
	const lasts = () => names().map((name) => lastOf(pumps.get(name))).join();
	let shown;
	let read = null;
	const load = () => {
		shown = lasts();
		read = pumpLog(names(), box, since.input.value, 200);
		read();
	};
	onLog = () => {
		if (shown === lasts()) return;
		shown = lasts();
		read();
	};
	on(which.input, 'change', load);
	on(since.input, 'change', load);
	const list = h('div');
	const showNotes = () => {
		place(list, notes.length ? table('Events of the service, latest first', ['Time', 'Kind', 'Pump', 'Event'],
			notes.map((note) => [date(note.time), note.kind, note.pump || '', plain(note.text)])) : para('There is no event on record.'));
	};
	watchNotes(100, showNotes,
		() => place(list, bad('The events cannot be read: the service does not answer.')));
	load();
	return ['Log', [head1('Log'),
		block(head2('Doses'), fields(which.el, since.el), box),
		block(head2('Events'), list)]];
}

const optionWords = (entry, is) => Object.entries(entry.options || {}).map(([name, value]) => (value === true ? name : name + is + value));
function entryWords(entry) {
	const what = entry.dose ? `${entry.pump}: dose ${entry.dose}` : entry.prime ? `${entry.pump}: prime ${entry.prime}` : `rack ${entry.rack}`;
	const batch = entry.batch ? `, ${entry.batch.repeat} times${entry.batch.every ? `, one every ${entry.batch.every}` : ''}` : '';
	const options = optionWords(entry, ' ');
	return what + batch + (options.length ? ` (${options.join(', ')})` : '');
}
const listed = (value) => (Array.isArray(value) ? value.join(', ') : value || '');
/** Times of an entry with the zone whose clock has them. */
function timeWords(entry, zone) {
	const parts = [entry.at && `at ${listed(entry.at)}`, entry.every && `every ${entry.every}`,
		entry.between && `from ${entry.between[0]} to ${entry.between[1]}`, entry.anchor && `counted from ${entry.anchor}`,
		entry.days && `on ${listed(entry.days)}`, entry.dates && `on ${listed(entry.dates)}`, entry.from && `since ${entry.from}`,
		entry.until && `until ${entry.until}`, `(${zone || 'zone of the service’s machine'})`];
	return parts.filter(Boolean).join(' ');
}
const ownZone = () => Intl.DateTimeFormat().resolvedOptions().timeZone || 'this device';
const ofEntry = (name) => `/api/v1/schedule/entries/${inPath(name)}`;
const wordsOf = (error, lost = 'The service did not answer: look at the schedule before you try again.') => (error instanceof Refused ? error.message : lost);

function viewSchedule() {
	const box = h('div', {}, para('Reading…'));
	const said = saidBox();
	let told = null;
	const edit = (entry) => editEntry(told, entry, load);
	const add = press('Add an entry…', () => edit(null), { hidden: true });
	const turn = async (entry, enabled) => {
		place(said);
		try {
			await call('PUT', ofEntry(entry.name), { body: JSON.stringify({ ...entry, enabled }), match: told.etag });
			politely(`${entry.name} is switched ${enabled ? 'on' : 'off'}.`, true);
		} catch (error) {
			place(said, alarm(wordsOf(error)));
		}
		load();
	};
	const rowOf = ({ doubt: own, ...entry }, one) => {
		const at = one?.at ? new Date(one.at) : null;
		const isOff = entry.enabled === false;
		const when = isOff ? 'switched off' : !at ? 'no further run' : `${date(at)}, in ${span((at - ms()) / 1000)}`;
		const word = [entry.missed && `missed: ${entry.missed}${entry.missed_within ? ` within ${entry.missed_within}` : ''}`,
			entry.unfinished && `unfinished: ${entry.unfinished}`, entry.busy && `in use: ${entry.busy}`].filter(Boolean).join(', ');
		const doubt = own || one?.doubt;
		const act = (label, run) => press(label, run, { 'aria-label': `${label} ${entry.name}`, 'data-of': entry.name });
		const row = [doubt ? h('span', { class: 'error', text: `${entry.name}: its runs will be refused: ${doubt}` }) : entry.name, when,
			entryWords(entry), timeWords(entry, one?.zone), word,
			h('span', { class: 'row' }, act('Edit…', () => edit(entry)), act(isOff ? 'Switch on' : 'Switch off', () => turn(entry, isOff)))];
		row.isBad = Boolean(doubt);
		return row;
	};
	const put = () => {
		if (!told.schedule) return place(box, para('The service has no schedule. Start it with --schedule FILE.'));
		const next = new Map(told.next.map((one) => [one.entry, one]));
		const at = ({ name }) => { const one = next.get(name); return one?.at ? new Date(one.at).getTime() : Infinity; };
		const entries = [...told.schedule.entry].sort((a, b) => at(a) - at(b) || 0);
		const active = box.contains(document.activeElement) && document.activeElement.dataset.of;
		place(box, told.error ? bad(told.error) : '',
			entries.length ? table(`Next runs, by the clock of this device (${ownZone()})`, ['Entry', 'Next', 'What', 'Times', 'Policy', 'Change'],
				entries.map((entry) => rowOf(entry, next.get(entry.name)))) : para('The schedule has no entry.'),
			aside(`File: ${told.file}. Edits keep its comments.`));
		// The last button of the same entry: the one that was pressed has another name now.
		const again = [...box.querySelectorAll('button')].findLast((button) => button.dataset.of === active);
		again?.focus();
	};
	const load = async () => {
		try {
			told = await get('schedule');
			add.hidden = !told.schedule || told.error;
			put();
		} catch (error) {
			place(box, bad(wordsOf(error)));
		}
	};
	onNotes = load;
	load();
	return ['Schedule', [head1('Schedule'), h('section', { class: 'panel', 'aria-label': 'Next runs' }, box, add, said)]];
}

const WEEK = ['mon', 'tue', 'wed', 'thu', 'fri', 'sat', 'sun'];
const split = (text) => text.split(/[\s,;]+/).filter(Boolean);

/** Fields of the keys that are not named as their field. */
const FIELDS = { dose: 'volume', prime: 'volume', batch: 'repeat', 'repeat of batch': 'repeat', 'every of batch': 'apart',
	'its time': 'when', 'between or anchor': 'when', 'what it does': 'what' };
/** The form of an entry. It is checked first, which shows its next runs, and then saved. */
function editEntry(told, entry, done) {
	const old = entry || {};
	const parts = {
		name: field('Name', '', { hint: '1 to 64 of a-z, 0-9, - and _' }),
		what: choice('It makes', [['dose', 'a dose'], ['prime', 'a prime'], ['rack', 'a run of a rack']]),
		pump: choice('Pump', pairs(pumps.keys(), old.pump)), rack: choice('Rack', pairs(racks, old.rack)),
		volume: field('Volume', '25mL'), repeat: field('Number of doses', '1', { inputmode: 'numeric' }),
		apart: field('One every', '30s'), options: field('Options', 'rate=5mL/s, smooth'),
		when: choice('When', [['at', 'at times of day'], ['between', 'every so often in a window of the day'], ['anchor', 'every so often from a moment on']]),
		at: field('Times of day', '06:00, 18:00'), every: field('Every', '30min'),
		between: field('Window', '08:00, 20:00', { hint: 'Its first and its last time of day' }),
		anchor: field('First run', '2026-03-01 06:30'),
		days: { input: h('fieldset', { tabindex: '-1' }, h('legend', { text: 'Days; none is every day' })) },
		dates: field('Dates, in place of days', '2026-03-01'),
		from: field('First date', '2026-03-01'), until: field('Last date', '2026-05-31'),
		zone: field('Time zone', told.schedule.zone || 'Europe/Berlin', { hint: 'Without one: that of the file or of the service’s machine' }),
		missed: choice('Missed runs', [['', 'are left out'], ['once', 'are made up for by one'], ['all', 'are all made up for']]),
		missed_within: field('At most so late', '2h'),
		unfinished: choice('An interrupted dose', [['', 'has the run refused'], ['resume', 'is delivered first'], ['accept', 'is accepted']]),
		busy: choice('A pump that moves', [['', 'has the run left out'], ['wait', 'is waited for']]),
		enabled: check('Switched on'),
	};
	const days = WEEK.map((word) => [word, check(word)]);
	const value = (key) => parts[key].input.value.trim();
	const zone = () => value('zone') || told.schedule.zone || 'the service’s machine';
	parts.days.el = parts.days.input;
	parts.days.input.append(inRow(days.map(([, part]) => part.el)));
	const kind = old.rack ? 'rack' : old.prime ? 'prime' : 'dose';
	const batch = old.batch || {};
	const options = optionWords(old, '=').join(', ');
	const shown = { ...old, what: kind, volume: old[kind], repeat: batch.repeat, apart: batch.every, options,
		when: old.anchor ? 'anchor' : old.between ? 'between' : 'at' };
	for (const [key, part] of Object.entries(parts)) if (shown[key] && key !== 'days') part.input.value = listed(shown[key]);
	for (const [word, part] of days) part.input.checked = listed(old.days).includes(word);
	parts.enabled.input.checked = old.enabled !== false;

	const clockOf = aside('');
	const fit = () => {
		const [what, when] = [value('what'), value('when')];
		const on = { pump: what !== 'rack', volume: what !== 'rack', rack: what === 'rack', repeat: what === 'dose', apart: what === 'dose',
			at: when === 'at', every: when !== 'at', between: when === 'between', anchor: when === 'anchor', days: when !== 'anchor',
			dates: when !== 'anchor', missed_within: value('missed') !== '' };
		for (const [key, isOn] of Object.entries(on)) parts[key].el.hidden = !isOn;
		say(clockOf, `Times are by the clock of ${zone()}.`);
	};
	const keys = () => {
		const of = (names) => Object.fromEntries(names.filter((key) => value(key)).map((key) => [key, value(key)]));
		const made = { name: value('name'), ...of(['from', 'until', 'zone', 'missed', 'unfinished', 'busy']) };
		if (!parts.enabled.input.checked) made.enabled = false;
		const [what, when] = [value('what'), value('when')];
		if (what === 'rack') made.rack = value('rack');
		else Object.assign(made, { pump: value('pump'), [what]: withUnit(value('volume'), 'mL') });
		const repeat = value('repeat');
		if (what === 'dose' && (repeat || value('apart'))) {
			made.batch = { repeat: /^\d+$/.test(repeat) ? Number(repeat) : repeat, ...(value('apart') && { every: value('apart') }) };
		}
		const words = value('options').split(/,\s*(?=[a-z][a-z0-9-]*(?:[=,]| \S*\d|$))/).map((word) => word.trim()).filter(Boolean);
		if (words.length) {
			made.options = Object.fromEntries(words.map((word) => { const [, name, value] = /^([^\s=]*)\s*=?\s*(.*)$/.exec(word); return [name, value || true]; }));
		}
		if (when === 'at') made.at = split(value('at'));
		else Object.assign(made, { every: value('every').replace(/\s+/g, '') }, when === 'between' ? { between: split(value('between')) } : { anchor: value('anchor') });
		const week = days.filter(([, part]) => part.input.checked).map(([word]) => word);
		if (when !== 'anchor' && week.length) made.days = week;
		if (when !== 'anchor' && value('dates')) made.dates = split(value('dates'));
		if (made.missed && value('missed_within')) made.missed_within = value('missed_within');
		return made;
	};

	const said = saidBox();
	const id = newId();
	const button = h('button', { type: 'submit', class: 'first', form: id });
	let checked = null;
	const isChecked = (body) => {
		checked = body;
		say(button, body ? 'Save' : 'Show the next runs');
	};
	isChecked(null);
	let marked = null;
	const unmark = () => {
		if (!marked) return;
		marked.words.remove();
		for (const name of ['aria-invalid', 'aria-errormessage']) marked.input.removeAttribute(name);
		marked = null;
	};
	/** Says a refusal beside the field that it is about. */
	const refuse = async (error) => {
		const key = error.key || '';
		const part = parts[FIELDS[key] || (key.endsWith('options') ? 'options' : key)];
		const words = alarm(wordsOf(error));
		words.id = newId();
		if (part) {
			part.el.append(words);
			fill(part.input, { 'aria-invalid': 'true', 'aria-errormessage': words.id }, []);
			marked = { input: part.input, words };
			if (part.el.closest('details')) part.el.closest('details').open = true;
			part.input.focus();
			place(said);
		} else {
			place(said, words);
		}
		if (error.status === 409) told = await get('schedule').catch(() => told);
	};
	const showRuns = ({ next, entry: made }) => {
		const runs = next.map(({ at, words }) => {
			// The words have the time by the clock of the entry, and how a change of the clock moved it.
			const [[, there, moved], here] = [/ at (\S+ \S+) \S+(.*)/.exec(words), date(at)];
			return h('li', { text: `${there}${there === here ? '' : `, here ${here}`}${moved}` });
		});
		place(said, div('plan',
			h('h3', { text: made.enabled === false ? 'It is switched off, so nothing runs' : runs.length ? 'Next runs' : 'It has no further run' }),
			h('ol', { class: 'plain' }, runs), aside(`By the clock of ${zone()}; here is ${ownZone()}. Nothing is saved yet.`)));
		said.scrollIntoView({ block: 'nearest' });
	};
	const ask = (act) => once(button, () => {
		unmark();
		return act();
	}, (error) => {
		isChecked(null);
		return refuse(error);
	});
	const close = (words) => {
		box.close();
		politely(words, true);
		done();
	};
	const save = () => {
		const body = JSON.stringify(keys());
		const isDry = checked !== body;
		ask(async () => {
			const path = (entry ? ofEntry(old.name) : '/api/v1/schedule/entries') + (isDry ? '?dry-run=true' : '');
			const made = await call(entry ? 'PUT' : 'POST', path, { body, match: told.etag });
			if (!isDry) return close(`${made.entry.name} is saved.`);
			isChecked(body);
			showRuns(made);
		});
	};
	const remove = () => {
		const sure = firstly(`Remove ${old.name}`, () => ask(async () => {
			await call('DELETE', ofEntry(old.name), { match: told.etag });
			close(`${old.name} is removed.`);
			main.querySelector('h1').focus();
		}));
		askFirst(said, 'The file loses the entry and the comment above it.', sure);
	};
	const group = (...names) => fields(names.map((name) => parts[name].el));
	const form = formOf(save, { id, oninput: () => {
		isChecked(null);
		fit();
	} }, group('name', 'what', 'pump', 'rack', 'volume', 'when', 'at', 'every', 'between', 'anchor'), clockOf, parts.days.el,
	moreOf(
		group('dates', 'from', 'until', 'zone', 'repeat', 'apart', 'options', 'missed', 'missed_within', 'unfinished', 'busy')),
	parts.enabled.el, entry && inRow(press('Remove…', remove)), said);
	fit();
	const box = dialog(entry ? `Edit ${old.name}` : 'Add an entry', [form], button);
}

function showLogin() {
	if (main.dataset.view === 'login') return;
	closeAll();
	source?.close();
	source = null;
	clearTimeout(retryTimer);
	isLive = false;
	main.dataset.view = 'login';
	looks.remove('lost');
	say($('link').firstElementChild, 'Not logged in');
	const token = field('Token', '', { type: 'password', required: true, autocomplete: 'current-password', hint: 'It is in the file that the service was started with.' });
	const said = saidBox();
	const button = submit('Log in');
	const form = formOf(async () => {
		try {
			await call('POST', '/login', { body: JSON.stringify({ token: token.input.value }) });
			delete main.dataset.view;
			begin();
		} catch (error) {
			needs(token, said, wordsOf(error, 'The service does not answer.'));
		}
	}, {}, token.el, inRow(button), said);
	place(main, h('h1', { text: 'Log in' }), h('section', { class: 'panel', 'aria-label': 'Log in' }, form));
	document.title = 'Log in · pump-dose';
	token.input.focus();
}

function show(isMoved) {
	if (!version) return;
	pumps.forEach((pump) => pump.panels.clear());
	onNotes = onInputs = onLog = null;
	const path = location.hash.replace(/^#/, '') || '/';
	let name = null;
	try { name = path.startsWith('/pump/') ? decodeURIComponent(path.slice(6)) : null; } catch { /* No name. */ }
	const [title, kids] = name != null ? viewPump(name) : path === '/log' ? viewLog() : path === '/schedule' ? viewSchedule() : viewPumps();
	main.dataset.view = path;
	place(main, ...kids.flat().filter(Boolean));
	onInputs?.();
	document.title = `${title} · pump-dose`;
	for (const link of document.querySelectorAll('nav a')) {
		const here = link.getAttribute('href').slice(1) === (name != null ? '/' : path);
		if (here) link.setAttribute('aria-current', name != null ? 'true' : 'page');
		else link.removeAttribute('aria-current');
	}
	if (isMoved !== true) return;
	closeAll();
	scrollTo(0, 0);
	const heading = main.querySelector('h1');
	heading?.focus({ preventScroll: true });
}
// The address names the view, so the link to the content must not change it.
on(document.querySelector('.skip'), 'click', (event) => {
	event.preventDefault();
	main.focus();
});
on(window, 'hashchange', () => { if (main.dataset.view !== 'login') show(true); });
on($('logout'), 'click', async () => {
	await call('POST', '/logout', { body: '{}' }).catch(() => {});
	showLogin();
});
on(calm, 'change', () => { if (version) show(); });
begin();
