'use strict';
/* The head. Angles are clockwise from the top; a roller at angle 0 of the model stands where the outlet begins. */

const svg = (tag, attributes, ...kids) => {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...kids);
  return made;
};

/** Most angles of a dose that an animation is given. */
const TURNS = 400;

const head = {
  of: '',

  /** The lengths of a head, mm. Those of a head without a drawing are made up. */
  lengths({ rollers, backplate, tube, rollerRadius, rollerOffset, contact, engagement }) {
    if (backplate) {
      const half = Math.PI / 2 + contact;
      return { rollers, bed: backplate, tube, radius: rollerRadius, offset: rollerOffset, half };
    }
    const pitch = 2 * Math.PI / rollers;
    const radius = Math.min(20, 0.62 * Math.PI * 46 / rollers);
    // The outlet's pulse begins where the inlet's ends, whole pitches apart.
    const most = Math.min(4 * Math.PI / 3, 2 * Math.PI - 2 * engagement);
    const span = Math.max(1, Math.floor(most / pitch + 1e-9)) * pitch;
    return { rollers, bed: 63, tube: 7, radius, offset: 60 - radius, half: span / 2 };
  },

  build(facts) {
    const key = [facts.rollers, facts.backplate].join();
    if (key === this.of) return;
    this.of = key;
    const { rollers, bed, tube, radius, offset, half } = this.lengths(facts);
    const at = (r, angle) => `${(r * Math.sin(angle)).toFixed(2)} ${(-r * Math.cos(angle)).toFixed(2)}`;
    const middle = bed - tube;
    const arc = (r) => `${at(r, -half)}A${r} ${r} 0 ${half > Math.PI / 2 ? 1 : 0} 1 ${at(r, half)}`;
    // Beyond the backplate the tube bends away and leaves downwards.
    const away = 18 * Math.max(0.1, Math.sin(half));
    const leaves = (side) => `C${at2(side, middle, half, away)} ${side * 46} 62 ${side * 46} 80`;
    const path = `M-46 80C-46 62 ${at2(-1, middle, half, away)} ${arc(middle)}${leaves(1)}`;
    this.half = half;
    const still = svg('svg', { viewBox: '-80 -76 160 160', 'aria-hidden': 'true' },
      svg('path', { class: 'bed', d: `M${arc(bed + 2.5)}` }),
      svg('path', { class: 'tube', d: path, 'stroke-width': 2 * tube }),
      svg('path', { class: 'lumen', d: path, 'stroke-width': 1.43 * tube }),
      svg('path', { class: 'zero', d: `M${at(bed + 6, half)}L${at(bed + 11, half)}` }),
      svg('text', { x: (bed + 17) * Math.sin(half) + 1, y: -(bed + 17) * Math.cos(half) + 3 }, '0°'),
      svg('text', { x: -62, y: 80 }, 'in'), svg('text', { x: 64, y: 80 }, 'out'));
    const parts = [];
    for (let n = 0; n < rollers; n += 1) {
      const [x, y] = at(offset, 2 * Math.PI * n / rollers).split(' ');
      parts.push(svg('line', { class: 'arm', x2: x, y2: y }),
        svg('circle', { class: 'roller', r: radius, cx: x, cy: y }),
        svg('circle', { class: 'pin', r: Math.min(3, radius / 3), cx: x, cy: y }));
    }
    const wheel = svg('svg', { viewBox: '-80 -76 160 160', 'aria-hidden': 'true' }, ...parts,
      svg('circle', { class: 'hub', r: 11 }));
    this.rotor = document.createElement('div');
    this.rotor.className = 'rotor';
    // The shaft stands at 80 of 160 from the left, and 76 of 160 from the top.
    this.rotor.style.transformOrigin = '50% 47.5%';
    this.rotor.append(wheel);
    $('head').replaceChildren(still, this.rotor);
  },

  /** The turn over the time of a trace, as a browser's animation has it. */
  turns({ time, angle }, most = TURNS) {
    const last = time.length - 1;
    const step = Math.ceil(last / most);
    const frames = [];
    for (let n = 0; n < last + step; n += step) {
      const row = Math.min(n, last);
      const turned = degrees(this.half + angle[row]).toFixed(3);
      frames.push({ offset: time[row] / time[last], transform: `rotate(${turned}deg)` });
    }
    return frames;
  },
};

/** The point of the tube's tangent beyond the backplate's end on a side, right or left. */
function at2(side, r, half, away) {
  const x = r * Math.sin(half) + away * Math.cos(half);
  const y = -r * Math.cos(half) + away * Math.sin(half);
  return `${(side * x).toFixed(2)} ${y.toFixed(2)}`;
}
