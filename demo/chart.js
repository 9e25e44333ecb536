'use strict';
/* Curves on canvases. The future lies under a veil, whose edge is now. */

/** Room beside a plot, px. On the left there is more where the numbers of the axis need it. */
const EDGE = { left: 46, right: 8, top: 6, bottom: 20 };

/** Steps of an axis: 1, 2 or 5 times a power of ten, `count` at most. */
function ticks(least, most, count) {
  const raw = (most - least) / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((n) => n * power).find((n) => n >= 0.999 * raw);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const found = [];
  for (let n = Math.ceil(least / step - 1e-9); n * step <= most + 1e-9 * step; n += 1) {
    found.push(fixed(n * step, digits));
  }
  return found;
}

/** The least and the largest value of curves. NaN is left out. */
function range(curves) {
  let [least, most] = [Infinity, -Infinity];
  for (const values of curves) {
    for (const value of values) {
      if (value < least) least = value;
      if (value > most) most = value;
    }
  }
  return [least, most];
}

class Chart {
  /** `leastSpan` is what the axis spans at least: less is the rounding of the steps, which is no curve. */
  constructor({ title, unit, along, alongUnit, keys, isMark, leastSpan = 0, data }) {
    Object.assign(this, { title, unit, along, alongUnit, keys, isMark, leastSpan, data });
    const make = (tag, name, ...kids) => {
      const made = document.createElement(tag);
      made.className = name;
      made.append(...kids);
      return made;
    };
    this.canvas = document.createElement('canvas');
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', title);
    this.veil = make('div', isMark ? 'veil mark' : 'veil');
    const keyed = keys.map(({ name, colour, isDashed }) => {
      const key = make('span', isDashed ? 'key dashed' : 'key', name);
      key.style.setProperty('--colour', `var(--${colour})`);
      return key;
    });
    const caption = make('figcaption', '', make('h2', '', `${title}, ${unit}`), ...keyed);
    this.plot = make('div', 'plot', this.canvas, make('div', 'window', this.veil));
    $('charts').append(make('figure', 'panel chart', caption, this.plot));
    // A chart out of sight is drawn once it comes into sight, or nothing changes for a while.
    this.isSeen = false;
    this.isDue = true;
    new IntersectionObserver(([{ isIntersecting }]) => {
      this.isSeen = isIntersecting;
      if (shown && isIntersecting && this.isDue) this.draw();
    }).observe(this.canvas);
  }

  /** Draws the curves of what is planned anew, once they are in sight. */
  renew() {
    this.isDue = true;
    if (this.isSeen) this.draw();
  }

  draw() {
    this.isDue = false;
    const { x, curves } = this.data(shown);
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight];
    const density = Math.min(devicePixelRatio || 1, 2);
    this.canvas.width = Math.round(width * density);
    this.canvas.height = Math.round(height * density);
    const pen = this.canvas.getContext('2d');
    pen.scale(density, density);
    let [least, most] = range(curves);
    const short = (this.leastSpan - (most - least)) / 2;
    if (short > 0) [least, most] = [least - short, most + short];
    const room = 0.06 * (most - least) || 1;
    [least, most] = [least - room, most + room];
    const [from, to] = [x[0], x[x.length - 1]];
    pen.font = '12px system-ui, sans-serif';
    const across = ticks(least, most, 5);
    const left = Math.ceil(Math.max(EDGE.left, ...across.map((tick) => pen.measureText(grouped(tick)).width + 10)));
    this.plot.style.setProperty('--left', `${left}px`);
    const [w, h] = [width - left - EDGE.right, height - EDGE.top - EDGE.bottom];
    const [sx, sy] = [w / (to - from), h / (most - least)];
    const px = (value) => left + (value - from) * sx;
    const py = (value) => EDGE.top + (most - value) * sy;
    pen.fillStyle = colours.soft;
    pen.strokeStyle = colours.line;
    pen.lineWidth = 1;
    pen.textAlign = 'right';
    pen.textBaseline = 'middle';
    for (const tick of across) {
      const y = Math.round(py(Number(tick))) + 0.5;
      pen.beginPath();
      pen.moveTo(left, y);
      pen.lineTo(width - EDGE.right, y);
      pen.stroke();
      pen.fillText(grouped(tick), left - 6, Math.min(y, height - EDGE.bottom - 4));
    }
    pen.textAlign = 'center';
    pen.textBaseline = 'bottom';
    const along = ticks(from, to, Math.max(2, Math.floor(w / 80)));
    along.forEach((tick, n) => {
      const isLast = n === along.length - 1;
      const text = isLast ? `${grouped(tick)} ${this.alongUnit}` : grouped(tick);
      const half = pen.measureText(text).width / 2;
      pen.fillText(text, Math.min(px(Number(tick)), width - half - 1), height);
    });
    pen.lineJoin = 'round';
    curves.forEach((values, n) => {
      const { colour, isDashed, isWide } = this.keys[n];
      pen.strokeStyle = colours[colour];
      pen.lineWidth = isWide ? 3.5 : 1.6;
      pen.setLineDash(isDashed ? [5, 4] : []);
      pen.beginPath();
      let isOpen = false;
      for (let i = 0; i < values.length; i += 1) {
        // NaN leaves a gap.
        if (Number.isNaN(values[i])) isOpen = false;
        else if (isOpen) pen.lineTo(px(x[i]), py(values[i]));
        else {
          pen.moveTo(px(x[i]), py(values[i]));
          isOpen = true;
        }
      }
      pen.stroke();
    });
    pen.setLineDash([]);
  }

  /** Says in words what the curves show. */
  tell() {
    const [least, most] = range(this.data(shown).curves);
    const digits = most - least < 1 ? 3 : 1;
    const names = this.keys.map(({ name }) => name).join(', ');
    this.canvas.setAttribute('aria-label', `${this.title}${this.along}: ${names}; from ` +
      `${fixed(least, digits)} to ${fixed(most, digits)} ${this.unit}`);
  }
}
