// A chart of lines over an angle, as SVG: its values under the pointer or by the arrow keys, its scale, a part of it, and
// files of it.

import {download, element, short, swatch} from './dom.js';

const SVG_SPACE = 'http://www.w3.org/2000/svg';
const LEFT = 44, RIGHT_EDGE = 10, TOP = 10, BOTTOM = 20;

export function svgElement(tag, attributes = {}, ...children) {
  const made = document.createElementNS(SVG_SPACE, tag);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

function superscript(n) {
  return String(n).replace(/./g, c => ({'-': '⁻'})[c] ?? '⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(c)]);
}

export function niceTicks(low, high, about = 3) {
  const rough = (high - low) / about, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map(m => m * power).find(s => s >= rough * (1 - 1e-9));
  return Array.from({length: Math.floor(high / step) - Math.ceil(low / step) + 1}, (_, k) => (Math.ceil(low / step) + k) * step);
}

// Two or more of a range that has no two powers of ten.
export function fineTicks(low, high) {
  const inside = v => v >= low && v <= high, decade = Math.floor(Math.log10(low));
  let ticks = [0, 1].flatMap(k => [1, 2, 5].map(m => +(m * 10 ** (decade + k)).toPrecision(1))).filter(inside);
  for (let about = 3; ticks.length < 2 && about < 100; about *= 2) ticks = niceTicks(low, high, about).filter(v => v > 0 && inside(v));
  return ticks;
}

// Between the points beside x, or null; of dots the nearest.
function valueAt({points, dots}, x, reach) {
  if (dots) {
    const near = points.reduce((best, p) => (Math.abs(p[0] - x) < Math.abs(best[0] - x) ? p : best), [Infinity, NaN]);
    return Math.abs(near[0] - x) <= reach ? near[1] : null;
  }
  const after = points.findIndex(p => p[0] >= x);
  if (after < 0) return null;
  const [b, a] = [points[after], points[Math.max(after - 1, 0)]];
  if (after === 0 && b[0] > x + reach) return null;
  const t = b[0] > a[0] ? (x - a[0]) / (b[0] - a[0]) : 1, value = (1 - t) * a[1] + t * b[1];
  return Number.isFinite(value) ? value : null;
}

export class LineChart {
  // `svg` in a figure with a .legend. `file`: of downloads; `axes`: the names of x and y in these; `changeScale`:
  // given whether values are logarithmic, where the reader may choose.
  constructor(svg, {file, axes, angle = 'θ', unit = '°', changeScale = null}) {
    Object.assign(this, {svg, file, axes, angle, unit, changeScale, figure: svg.closest('figure'), drawn: null, zoom: null, cursor: null});
    svg.setAttribute('tabindex', '0');
    this.values = element('output', {className: 'values', hidden: true});
    this.waiting = [];  // buttons that need something drawn
    this.figure.append(this.makeTools(), this.values);
    this.listen();
  }

  makeTools() {
    const button = (text, label, click) => {
      const made = element('button', {type: 'button', textContent: text, ariaLabel: label, title: label, disabled: true});
      made.addEventListener('click', click);
      this.waiting.push(made);
      return made;
    };
    const name = this.svg.getAttribute('aria-label');
    this.whole = button('whole', `${name}: the whole range`, () => this.zoomTo(null));
    this.whole.hidden = true;
    const tools = [this.whole, button('CSV', `${name} as CSV`, () => download(this.csv(), 'text/csv', `${this.file()}.csv`)),
                   button('SVG', `${name} as SVG`, () => download(this.svgText(), 'image/svg+xml', `${this.file()}.svg`))];
    if (this.changeScale) {
      this.box = element('input', {type: 'checkbox', ariaLabel: `${name}: logarithmic`});
      this.box.addEventListener('change', () => this.changeScale(this.box.checked));
      tools.unshift(element('label', {}, this.box, 'log'));
    }
    return element('div', {className: 'chart-tools'}, ...tools);
  }

  // ---- Drawing ----

  // series: [{label, color, points: [[x, y]...], unknown: a set of indices that no data told, width, dash, dots, key: in the
  // legend, if not the label; null for none}];
  // x: {min, max, ticks: [[value, text]...], power}; y: {log, min, max, decades}; marks: [{x, text}];
  // lines: [{y, text}]; hatched where x is more than `known` from 0.
  draw(drawn) {
    this.drawn = drawn;
    const {width, height} = this.svg.getBoundingClientRect();
    if (width === 0) return;
    for (const button of this.waiting) button.disabled = false;
    Object.assign(this, {width, height, style: getComputedStyle(this.svg)});
    this.svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
    this.svg.setAttribute('font-family', 'system-ui, sans-serif');
    this.svg.setAttribute('font-size', '11');
    if (this.box) this.box.checked = drawn.y.log;
    this.setScales();
    this.svg.replaceChildren(this.hatching(), this.grid(), this.curves(), this.marks());
    this.showLegend();
    this.showCursor();
  }

  color(name) { return this.style.getPropertyValue(name).trim(); }

  setScales() {
    const {series, x, y} = this.drawn, [from, to] = this.zoom ?? [x.min, x.max], power = x.power ?? 1;
    const of = v => Math.sign(v) * Math.abs(v) ** power, back = u => Math.sign(u) * Math.abs(u) ** (1 / power);
    const values = series.flatMap(s => s.points.filter(p => p[0] >= from && p[0] <= to).map(p => p[1]))
      .filter(v => Number.isFinite(v) && (!y.log || v > 0));
    let low = y.min ?? Math.min(...values), high = y.max ?? Math.max(...values);
    if (values.length === 0) [low, high] = [0.1, 1];
    if (y.log) {
      low = Math.max(Math.min(...values, high), high * 10 ** -(y.decades ?? 12));
      [low, high] = [Math.log10(low), Math.log10(high)];
    }
    if (!(high > low)) [low, high] = [low - 0.5, high + 0.5];
    const padding = 0.04 * (high - low);
    if (y.min === undefined || y.log) low -= padding;
    high += padding;
    const w = this.width - LEFT - RIGHT_EDGE, h = this.height - TOP - BOTTOM;
    Object.assign(this, {from, to, low, high, w, h});
    this.px = v => LEFT + ((of(v) - of(from)) / (of(to) - of(from))) * w;
    this.xAt = p => Math.min(Math.max(back(of(from) + ((p - LEFT) / w) * (of(to) - of(from))), from), to);
    this.py = v => {
      const t = ((y.log ? Math.log10(Math.max(v, 1e-300)) : v) - low) / (high - low);
      return TOP + (1 - Math.min(Math.max(t, -0.5), 1.5)) * h;
    };
  }

  line(x1, y1, x2, y2, attributes) { return svgElement('line', {x1, y1, x2, y2, ...attributes}); }
  text(x, y, text, attributes = {}) {
    return svgElement('text', {x, y, fill: this.color('--muted'), ...attributes}, String(text));
  }

  grid() {
    const {x, y} = this.drawn, {low, high} = this, stroke = this.color('--line'), group = svgElement('g', {});
    const decades = Array.from({length: Math.max(Math.floor(high) - Math.ceil(low) + 1, 0)}, (_, k) => Math.ceil(low) + k);
    const step = Math.ceil(decades.length / 4);
    let rows = decades.length < 5 ? decades : decades.filter(d => d % step === 0);
    rows = rows.map(d => [10 ** d, `10${superscript(d)}`]);
    if (!y.log) rows = niceTicks(low, high).map(v => [v, Math.abs(v) < 1e-12 ? '0' : short(v)]);
    else if (rows.length < 2) rows = fineTicks(10 ** low, 10 ** high).map(v => [v, short(v)]);
    for (const [v, text] of rows) {
      group.append(this.line(LEFT, this.py(v), this.width - RIGHT_EDGE, this.py(v), {stroke}),
                   this.text(LEFT - 5, this.py(v) + 4, text, {'text-anchor': 'end'}));
    }
    const columns = this.zoom ? niceTicks(this.from, this.to, 4).map(v => [v, `${+v.toPrecision(4)}${this.unit}`]) : x.ticks;
    for (const [v, text] of columns) {
      const edge = this.px(v) > this.width - RIGHT_EDGE - 12;
      group.append(this.line(this.px(v), TOP, this.px(v), TOP + this.h, {stroke}),
                   this.text(this.px(v) + (edge ? 4 : 0), this.height - 5, text, {'text-anchor': edge ? 'end' : 'middle'}));
    }
    return group;
  }

  // Lines over what was not measured.
  hatching() {
    const {known = Infinity} = this.drawn, group = svgElement('g', {stroke: this.color('--line'), fill: 'none'});
    for (const [a, b] of [[known, this.to], [this.from, -known]]) {
      const [left, right] = [this.px(Math.max(a, this.from)), this.px(Math.min(b, this.to))];
      for (let p = left; p < right - 3; p += 7) {
        const run = Math.min(right - p, this.h);
        group.append(this.line(p, TOP + this.h, p + run, TOP + this.h - run, {}));
      }
    }
    return group;
  }

  curves() {
    const clip = `${this.svg.id}-clip`;
    const group = svgElement('g', {'clip-path': `url(#${clip})`, fill: 'none', 'stroke-linejoin': 'round'});
    group.append(svgElement('clipPath', {id: clip}, svgElement('rect', {x: LEFT - 2, y: TOP - 4, width: this.w + 4, height: this.h + 6})));
    for (const {y} of this.drawn.lines ?? []) {
      group.append(this.line(LEFT, this.py(y), this.width - RIGHT_EDGE, this.py(y), {stroke: this.color('--text'), 'stroke-dasharray': '6 3'}));
    }
    for (const {points, color, unknown = new Set(), width = 2, dash = [], dots = false} of this.drawn.series) {
      if (dots) {
        const d = points.filter(([x, y]) => x >= this.from && x <= this.to && (!this.drawn.y.log || y > 0))
          .map(([x, y]) => `M${this.px(x).toFixed(1)} ${this.py(y).toFixed(1)}h0`).join('');
        group.append(svgElement('path', {d, stroke: color, 'stroke-width': 4.4, 'stroke-linecap': 'round'}));
        continue;
      }
      const told = e => !unknown.has(e), beside = e => unknown.has(e) || unknown.has(e - 1) || unknown.has(e + 1);
      group.append(svgElement('path', {d: this.path(points, told), stroke: color, 'stroke-width': width, 'stroke-dasharray': dash.join(' ')}));
      if (unknown.size > 0) {
        group.append(svgElement('path', {d: this.path(points, beside), stroke: color, 'stroke-width': 1, 'stroke-dasharray': '1 3'}));
      }
    }
    return group;
  }

  path(points, keep) {
    let pen = false, d = '';
    points.forEach(([x, y], e) => {
      const drawn = keep(e) && Number.isFinite(y) && (!this.drawn.y.log || y > 0);
      if (drawn) d += `${pen ? 'L' : 'M'}${this.px(x).toFixed(1)} ${this.py(y).toFixed(1)}`;
      pen = drawn;
    });
    return d;
  }

  marks() {
    const stroke = this.color('--text'), group = svgElement('g', {});
    for (const {x, text} of this.drawn.marks ?? []) {
      if (x < this.from || x > this.to) continue;
      const right = this.px(x) > this.width - 50;
      group.append(this.line(this.px(x), TOP, this.px(x), TOP + this.h, {stroke, 'stroke-width': 1.2}),
                   this.text(this.px(x) + (right ? -4 : 4), TOP + 9, text, {fill: stroke, 'text-anchor': right ? 'end' : 'start'}));
    }
    return group;
  }

  showLegend() {
    const {series} = this.drawn, entries = series.filter(s => s.key !== null && (series.length > 1 || s.label !== 'all'));
    const sign = s => (s.dots ? swatch(this.color('--muted'), 'swatch round') : s.dash?.length > 0 ? swatch(`repeating-linear-gradient(90deg, ${s.color} 0 ${s.dash[0]}px, transparent 0 ${s.dash[0] + s.dash[1]}px)`)
      : swatch(s.color));
    this.figure.querySelector('.legend').replaceChildren(
      ...entries.map(s => element('span', {className: 'key'}, sign(s), s.key ?? s.label)),
      ...(series.some(s => s.unknown?.size > 0) ? [element('span', {className: 'key', textContent: '··· no data'})] : []));
  }

  // ---- Values ----

  readAt(x) {
    const reach = 0.02 * (this.to - this.from);
    return this.drawn.series.map(s => ({...s, value: valueAt(s, x, reach)})).filter(s => s.value !== null);
  }

  moveCursor(x, heard = false) {
    this.cursor = x;
    this.values.ariaLive = heard ? 'polite' : 'off';
    this.showCursor();
  }

  showCursor() {
    this.svg.querySelector('.cursor')?.remove();
    this.values.hidden = this.cursor === null || !this.drawn;
    if (this.values.hidden) return;
    const x = Math.min(Math.max(this.cursor, this.from), this.to), read = this.readAt(x), at = this.px(x);
    const group = svgElement('g', {class: 'cursor', 'pointer-events': 'none'},
                             this.line(at, TOP, at, TOP + this.h, {stroke: this.color('--accent'), 'stroke-dasharray': '3 2'}));
    for (const {value, color} of read) {
      const y = this.py(value);
      if (y >= TOP - 4 && y <= TOP + this.h + 4) group.append(svgElement('circle', {cx: at, cy: y, r: 3.5, fill: color, stroke: this.color('--surface')}));
    }
    this.svg.append(group);
    this.values.replaceChildren(element('b', {textContent: `${this.angle} ${+x.toFixed(1)}${this.unit}`}),
                                ...read.map(({label, color, value}) => element('span', {}, swatch(color), `${label} ${short(value)}`)));
    // The values stand below the plot, over its buttons, where they cover no curve; many of them move what is below.
    this.values.classList.toggle('many', read.length > 6);
    const box = this.svg.getBoundingClientRect(), outer = this.figure.getBoundingClientRect();
    Object.assign(this.values.style, {top: `${box.bottom - outer.top}px`, left: `${box.left - outer.left}px`, width: `${box.width}px`});
  }

  zoomTo(range) {
    if (!this.drawn) return;
    this.zoom = range;
    this.whole.hidden = range === null;
    this.draw(this.drawn);
  }

  listen() {
    const {svg} = this, place = event => this.xAt(event.clientX - svg.getBoundingClientRect().left);
    let begin = null;
    svg.addEventListener('pointerdown', event => (begin = this.drawn && event.button === 0 ? place(event) : null));
    svg.addEventListener('pointermove', event => this.drawn && this.moveCursor(place(event)));
    svg.addEventListener('pointerleave', () => this.moveCursor(null));
    svg.addEventListener('pointerup', event => {
      if (begin === null) return;
      const range = [begin, place(event)].sort((a, b) => a - b);
      begin = null;
      if (Math.abs(this.px(range[1]) - this.px(range[0])) > 12) this.zoomTo(range);
    });
    svg.addEventListener('dblclick', () => this.zoomTo(null));
    svg.addEventListener('blur', () => this.moveCursor(null));
    svg.addEventListener('keydown', event => this.pressKey(event));
  }

  // Arrows read values; + and - show less and more.
  pressKey(event) {
    if (!this.drawn || event.ctrlKey || event.metaKey) return;
    const middle = this.cursor ?? this.xAt(LEFT + this.w / 2), span = this.to - this.from, {x} = this.drawn;
    const within = (a, b) => [Math.max(a, x.min), Math.min(b, x.max)];
    const step = {ArrowLeft: -1, ArrowRight: 1}[event.key];
    if (step) this.moveCursor(this.xAt(this.px(middle) + 4 * step), true);
    else if (event.key === '+') this.zoomTo(within(middle - span / 4, middle + span / 4));
    else if (event.key === '-') this.zoomTo(span * 2 >= x.max - x.min ? null : within(middle - span, middle + span));
    else if (event.key === 'Escape') this.moveCursor(null);
    else return;
    event.preventDefault();
  }

  // ---- Files ----

  csv() {
    const rows = this.drawn.series.flatMap(({label, points, unknown}) =>
      points.map(([x, y], e) => [`"${label}"`, +x.toPrecision(7), Number.isFinite(y) ? +y.toPrecision(7) : '', unknown?.has(e) ? 1 : 0].join(',')));
    return [['curve', ...this.axes, 'no_data'].join(','), ...rows].join('\n') + '\n';
  }

  // The chart as a file of its own, with its ground, its title and its legend.
  svgText() {
    const copy = this.svg.cloneNode(true), {series} = this.drawn, rows = Math.ceil(series.length / 3), below = 16 * rows + 26;
    copy.querySelector('.cursor')?.remove();
    for (const name of ['id', 'class', 'tabindex', 'role']) copy.removeAttribute(name);
    const height = this.height + below;
    copy.setAttribute('viewBox', `0 0 ${this.width} ${height}`);
    copy.setAttribute('width', this.width);
    copy.setAttribute('height', height);
    copy.prepend(svgElement('rect', {width: this.width, height, fill: this.color('--surface')}));
    copy.append(this.text(LEFT, this.height + 14, `${this.axes[1]} over ${this.axes[0]}`));
    series.forEach(({label, color}, k) => {
      const x = LEFT + ((k % 3) * this.w) / 3, y = this.height + 30 + 16 * Math.floor(k / 3);
      copy.append(svgElement('rect', {x, y: y - 8, width: 9, height: 9, fill: color}), this.text(x + 13, y, label));
    });
    return new XMLSerializer().serializeToString(copy);
  }
}
