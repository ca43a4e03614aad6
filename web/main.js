// The page of one model: its state, what it draws, and what people do with it.

import {anglesOf, evaluatorOf, formatModel, isNearlyDiffuse, parseModel} from './model.js';
import {brightestDirection, halfCells, probeEnvironment, studioEnvironment} from './environment.js';
import {HARDLY_SEEN, bytesOf, decodeMeasured, differenceMap, parseCsv, parseMerl} from './measured.js';
import {History, checkedEdit, editedModel, hexOf, isEdited, linearOf, noEdit} from './edit.js';
import {CHANNEL_COLORS, LOBE_COLORS, drawDisc, drawHeat, drawLines, drawPolar} from './plots.js';
import {OBJECTS, Renderer} from './renderer.js';

const byId = id => document.getElementById(id);
const contents = JSON.parse(byId('data').textContent);
const shaders = JSON.parse(byId('shaders').textContent);
const DEGREES = 180 / Math.PI;

const VIEWS = {
  compared: [['side', 'Side by side'], ['wipe', 'Wipe'], ['difference', 'Difference'], ['measured', 'Measured'], ['fitted', 'Fitted']],
  alone: [['fitted', 'Fitted']],
};
const LIGHTS = [['environment', 'All around'], ['lamp', 'One lamp']];
const state = {
  view: 'fitted', object: 'sphere', light: 'environment', lamp: [-0.35, 0.4], around: 0, turn: [0, 0], exposure: 0, wipe: 0.5,
  theme: null, size: 0, edit: null, thetaI: 45,
};
let base, model, evaluate, measured = null, history, renderer, environment, heat = null, point = null, seen = null;
let name = contents.name, source = contents.source, verdict = contents;

// ---- Small things ----------------------------------------------------------------------------------------------

function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}
function tell(text, calm = false) {
  byId('message').textContent = text;
  byId('message').classList.toggle('calm', calm);
}
const isDark = () => document.documentElement.dataset.theme === 'dark';
function short(x) {
  if (!Number.isFinite(x)) return '–';
  if (x === 0) return '0';
  return Math.abs(x) >= 1e4 || Math.abs(x) < 1e-3 ? x.toExponential(2) : String(+x.toPrecision(3));
}
const shortDeltaE = x => String(+x.toPrecision(2));  // as in the report's verdict
const grouped = n => n.toLocaleString('en');
function download(bytes, type, file) {
  const link = element('a', {href: URL.createObjectURL(new Blob([bytes], {type})), download: file});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
const pageColor = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const hasMeasured = () => measured !== null;
const lobeName = m => `lobe ${m + 1}${isNearlyDiffuse(base, m) ? ' (nearly diffuse)' : ''}`;
const lobeColor = m => LOBE_COLORS[m % LOBE_COLORS.length];

// ---- State in the address ---------------------------------------------------------------------------------------

function stateText() {
  const kept = {...state, edit: isEdited(state.edit, base) ? state.edit : undefined};
  return btoa(JSON.stringify(kept)).replace(/\+/g, '-').replace(/\//g, '_').replace(/=+$/, '');
}
function takeState(text) {
  try {
    const given = JSON.parse(atob(text.replace(/-/g, '+').replace(/_/g, '/')));
    const pair = x => Array.isArray(x) && x.length === 2 && x.every(Number.isFinite);
    const number = (key, low, high) => {
      if (Number.isFinite(given[key])) state[key] = Math.min(Math.max(given[key], low), high);
    };
    if (VIEWS.compared.some(([v]) => v === given.view)) state.view = given.view;
    if (OBJECTS.includes(given.object)) state.object = given.object;
    if (LIGHTS.some(([l]) => l === given.light)) state.light = given.light;
    if (pair(given.lamp)) state.lamp = given.lamp;
    if (pair(given.turn)) state.turn = given.turn;
    if (['light', 'dark'].includes(given.theme)) state.theme = given.theme;
    number('around', -1, 1);
    number('exposure', -4, 4);
    number('wipe', 0, 1);
    number('size', 0, 512);
    number('thetaI', 0, 85);
    state.edit = given.edit ?? null;
  } catch {
    tell('The link holds no state that this page knows; it shows the model as it is.');
  }
}

// ---- Light -------------------------------------------------------------------------------------------------------

// The lamp stands where the surface with the normal at (x, y) of a sphere mirrors it to the eye.
function lampDirection() {
  let [x, y] = state.lamp;
  const r = Math.hypot(x, y);
  if (r > 0.98) [x, y] = [(0.98 * x) / r, (0.98 * y) / r];
  const z = Math.sqrt(1 - x * x - y * y);
  return [2 * z * x, 2 * z * y, 2 * z * z - 1];
}
function lightDirection() {
  return state.light === 'lamp' ? lampDirection() : brightestDirection(environment, state.around);
}

// ---- Drawing -----------------------------------------------------------------------------------------------------

let panels = [], dirty = true, chartsDirty = true;

function layout() {
  const picture = byId('picture'), canvas = byId('canvas'), width = picture.clientWidth;
  const scale = Math.min(window.devicePixelRatio || 1, 2), gap = 14;
  const modes = state.view === 'side' ? ['measured', 'fitted', 'difference'] : [state.view];
  const columns = modes.length === 1 ? 1 : width < 620 ? 2 : 3, caption = columns === 2 ? 62 : 46;  // one more line
  const size = Math.floor(Math.min((width - gap * (columns + 1)) / columns, modes.length === 1 ? 560 : 620,
                                   Math.max(window.innerHeight * 0.58, 220)));
  const rows = Math.ceil(modes.length / columns), height = rows * (size + caption + gap) + gap / 2;
  canvas.style.height = `${height}px`;
  const [w, h] = [Math.round(width * scale), Math.round(height * scale)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  panels = modes.map((mode, k) => {
    const row = Math.floor(k / columns), inRow = Math.min(columns, modes.length - row * columns);
    const left = (width - inRow * size - (inRow - 1) * gap) / 2 + (k % columns) * (size + gap);
    const top = gap + row * (size + caption + gap);
    return {mode, left, top, css: size, x: Math.round(left * scale), y: Math.round(top * scale), size: Math.round(size * scale)};
  });
  byId('captions').replaceChildren(...panels.map(({mode, left, top, css}) => {
    const [title, text] = captionOf(mode);
    const made = element('div', {}, element('b', {textContent: title}), text);
    Object.assign(made.style, {left: `${left}px`, top: `${top + css + 4}px`, width: `${css}px`});
    return made;
  }));
  renderer.setSize(state.size || Math.min(Math.max(Math.round(size * scale), 96), 512));
  dirty = true;
}

function captionOf(mode) {
  const samples = hasMeasured() ? `${grouped(measured.samples)} samples` : '';
  const edited = isEdited(state.edit, base) ? ', edited' : '';
  const model_ = `${base.lobes} ${base.lobes === 1 ? 'lobe' : 'lobes'}${contents.parameters ? `, ${grouped(contents.parameters)} numbers` : ''}`;
  if (mode === 'measured') return ['Measured', samples];
  if (mode === 'fitted') return [`Fitted${edited}`, model_];
  if (mode === 'wipe') return [`Measured | Fitted${edited}`, 'move the line below the picture, or drag it'];
  // As judged, the one ΔE is the report's; what the page finds itself is of other light, another object or model.
  const mean = asJudged() ? verdict.mean_delta_e : seen?.mean;
  if (!Number.isFinite(mean)) return ['Where they differ', 'to the eye'];
  return ['Where they differ', `ΔE ${shortDeltaE(mean)} in the mean${asJudged() ? '' : ', as shown'}${mean < 1 ? ': not seen' : ''}`];
}

// Whether the picture is that on which the verdict rests.
function asJudged() {
  return Number.isFinite(verdict?.mean_delta_e) && verdict.of_sphere && state.object === 'sphere' && state.light === 'environment' &&
    state.around === 0 && !isEdited(state.edit, base);
}

// The mean CIELAB difference of what is shown.
function compareShown(level) {
  if (!hasMeasured() || level.size > 256) return;
  const a = renderer.numbersOf(level, 0), b = renderer.numbersOf(level, 1), found = [];
  const f = t => (t > 0.00885645 ? Math.cbrt(t) : t * 7.787037 + 0.13793103);
  const lab = (numbers, k) => {
    const [r, g, l] = [0, 1, 2].map(c => Math.min(Math.max(numbers[k + c] * renderer.exposure, 0), 1));
    const x = f((0.4124 * r + 0.3576 * g + 0.1805 * l) / 0.9505), y = f(0.2126 * r + 0.7152 * g + 0.0722 * l);
    const z = f((0.0193 * r + 0.1192 * g + 0.9505 * l) / 1.089);
    return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
  };
  for (let k = 0; k < a.length; k += 4) {
    if (!(a[k + 3] > 0) || b[k + 3] < 0.5 * a[k + 3]) continue;
    const p = lab(a, k), q = lab(b, k);
    found.push(Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]));
  }
  if (found.length === 0) return;
  seen = {mean: found.reduce((x, y) => x + y, 0) / found.length};
  const index = panels.findIndex(p => p.mode === 'difference');
  if (index >= 0) byId('captions').children[index]?.lastChild?.replaceWith(captionOf('difference')[1]);
}

let before = 0;
function frame(now) {
  requestAnimationFrame(frame);
  const turning = byId('turntable').checked;
  if (turning) {
    const step = Math.min(now - before, 100) / 1000;
    if (state.object === 'sphere' && state.light === 'lamp') {
      const [x, y] = state.lamp, c = Math.cos(step * 0.8), s = Math.sin(step * 0.8);
      state.lamp = [x * c - y * s, x * s + y * c];
      applyLight();
    } else if (state.object === 'sphere') {
      state.around = (state.around + step * 0.08) % 1;
      applyLight();
    } else {
      state.turn = [state.turn[0] + step * 0.6, state.turn[1]];
      applyObject();
    }
  }
  before = now;
  try {
    if (renderer.work(!isEdited(state.edit, base))) dirty = true;
    if (dirty) {
      renderer.show(panels, {wipe: state.wipe, stops: state.exposure, mark: point?.at ?? null});
      dirty = false;
    }
    if (chartsDirty && renderer.shown) drawCharts();  // after the first picture, which people wait for
  } catch (error) {
    tell(error.message);
    throw error;
  }
}

function applyLight() {
  renderer.lamp = state.light === 'lamp' ? lampDirection() : null;
  renderer.environmentTurn = state.around;
  renderer.moving = dragging !== null || byId('turntable').checked;
  renderer.restart();
  if (point) lookAt(point.at);
}
function applyObject() {
  renderer.object = state.object;
  renderer.turn = state.object === 'cloth' ? [state.turn[0], 0] : state.turn;
  renderer.moving = dragging !== null || byId('turntable').checked;
  renderer.restart();
}

// ---- Charts ------------------------------------------------------------------------------------------------------

const ROOT_TICKS = [0, 2, 10, 30, 60, 90].map(v => [v, `${v}°`]);
const TICKS = [0, 30, 60, 90].map(v => [v, `${v}°`]);

function curvesOf(factor, axisOf) {
  const axis = model.axes[factor], {per_lobe, per_channel} = model.sharing[factor];
  const shownLobes = state.edit.lobes.map((l, m) => m).filter(m => state.edit.lobes[m].on);
  const series = [], done = new Set();
  for (const m of shownLobes) {
    for (let c = 0; c < 3; ++c) {
      const t = (per_lobe ? m : 0) * (per_channel ? 3 : 1) + (per_channel ? c : 0);
      if (done.has(t)) continue;
      done.add(t);
      const table = model.tables[factor][t];
      const color = per_lobe ? (per_channel ? mixed(lobeColor(m), CHANNEL_COLORS[c]) : lobeColor(m))
                             : per_channel ? CHANNEL_COLORS[c] : '#888888';
      let points;
      if (axis.phis > 0) {
        points = axis.theta.map((theta, a) => [theta, table.subarray(a * axis.phis, (a + 1) * axis.phis).reduce((x, y) => x + y, 0) / axis.phis]);
      } else points = Array.from(table, (v, e) => [axisOf((e + 0.5) / axis.size), v]);
      series.push({points, color, width: 2});
    }
  }
  return series;
}
function mixed(a, b) {
  const parse = hex => [1, 3, 5].map(at => parseInt(hex.slice(at, at + 2), 16));
  const [x, y] = [parse(a), parse(b)];
  return '#' + x.map((v, k) => Math.round((v + y[k]) / 2).toString(16).padStart(2, '0')).join('');
}

function drawCharts() {
  chartsDirty = false;
  const at = point?.angles;
  const marks = list => (at ? list.map(([key, text]) => ({x: at[key] * DEGREES, text})) : []);
  const root = {min: 0, max: 90, ticks: ROOT_TICKS, map: v => Math.sqrt(v)};
  const straight = {min: 0, max: 90, ticks: TICKS};
  if (model.lobes > 0) {
    drawLines(byId('chart-d'), {series: curvesOf('D', x => 90 * x * x), x: root, y: {log: true, decades: 7}, marks: marks([['theta_h', 'θh']])});
    drawLines(byId('chart-f'), {series: curvesOf('F', x => 90 * x), x: straight, y: {min: 0}, marks: marks([['theta_d', 'θd']])});
    drawLines(byId('chart-g'), {series: curvesOf('G', x => 90 * x), x: straight, y: {min: 0}, marks: marks([['theta_i', 'θi'], ['theta_o', 'θo']])});
    if (model.axes.D.phis > 1) {
      const m = Number(byId('disc-lobe').value || 0), {per_lobe, per_channel} = model.sharing.D;
      drawDisc(byId('disc'), model.tables.D[(per_lobe ? m : 0) * (per_channel ? 3 : 1)], model.axes.D, lobeColor(m),
               at ? [at.theta_h * DEGREES, Math.atan2(at.h[1], at.h[0])] : null);
    }
  }
  drawPolarChart();
  if (hasMeasured()) {
    heat ??= differenceMap(measured, evaluate, measured.kind === 'table' ? Math.min(45, ...measured.shape.slice(0, 2)) : 20);
    drawHeat(byId('heat'), heat, at ? [at.theta_h * DEGREES, at.theta_d * DEGREES] : null, isDark());
    const hatched = heat.hardlySeen.includes(1);
    byId('typical').textContent = Number.isFinite(heat.typical)
      ? `Typically ${short(100 * (Math.exp(heat.typical) - 1))} % apart${hatched ? ' elsewhere' : ''}.` : '';
    byId('hardly-seen').hidden = !hatched;
    byId('hardly-share').textContent = `${100 * HARDLY_SEEN} %`;
  }
  if (contents.trace.length > 1) {
    drawLines(byId('trace'), {
      series: [{points: contents.trace.map(([k, , e]) => [k, e]), color: pageColor('--accent'), width: 2}],
      x: {min: 0, max: contents.trace.at(-1)[0], ticks: traceTicks()}, y: {log: true}});
  }
}
function traceTicks() {
  const last = contents.trace.at(-1)[0], step = Math.max(1, Math.ceil(last / 5));
  const ticks = Array.from({length: Math.floor(last / step) + 1}, (_, k) => [k * step, String(k * step)]);
  if (ticks.at(-1)[0] !== last) ticks.push([last, '']);
  return ticks;
}

function drawPolarChart() {
  const theta = state.thetaI / DEGREES, wi = [-Math.sin(theta), 0, Math.cos(theta)];
  const fitted = [], dots = [], ofLobe = model.s.map(() => []);
  for (let degrees = -89; degrees <= 89; ++degrees) {
    const t = degrees / DEGREES, wo = [Math.sin(t), 0, Math.cos(t)];
    const value = evaluate(wi, wo), mean = rgb => ((rgb[0] + rgb[1] + rgb[2]) / 3) * wo[2];
    fitted.push([degrees, mean(value.rho)]);
    value.lobes.forEach((rgb, m) => ofLobe[m].push([degrees, mean(rgb)]));
    const rho = hasMeasured() && degrees % 3 === 0 ? measured.rho(wi, wo) : null;
    if (rho) dots.push([degrees, mean(rho)]);
  }
  drawPolar(byId('polar'), [
    ...ofLobe.map((values, m) => ({values, color: lobeColor(m), width: 1.2})).filter((_, m) => state.edit.lobes[m].on),
    {values: fitted, color: pageColor('--text'), width: 2}, {values: dots, color: '#e5674a', dots: true}], state.thetaI);
  byId('polar-angle').textContent = `${Math.round(state.thetaI)}°`;
}

// ---- Under the pointer --------------------------------------------------------------------------------------------

const cells = halfCells();
function albedo(theta) {
  const wo = [Math.sin(theta), 0, Math.cos(theta)], sum = [0, 0, 0];
  for (let k = 0; k < cells.length; k += 4) {
    const h = [cells[k], cells[k + 1], cells[k + 2]], along = wo[0] * h[0] + wo[2] * h[2];
    const wi = h.map((x, a) => 2 * along * x - wo[a]);
    if (!(along > 0 && wi[2] > 0)) continue;
    const {rho} = evaluate(wi, wo);
    for (let c = 0; c < 3; ++c) sum[c] += rho[c] * wi[2] * 4 * along * cells[k + 3];
  }
  return sum;
}

function lookAt(at) {
  const surface = renderer.surfaceAt(at[0], at[1]);
  if (!surface) {
    point = null;
  } else {
    const {normal: n, tangent: x} = surface, y = [n[1] * x[2] - n[2] * x[1], n[2] * x[0] - n[0] * x[2], n[0] * x[1] - n[1] * x[0]];
    const local = w => [x, y, n].map(e => e[0] * w[0] + e[1] * w[1] + e[2] * w[2]);
    const wi = local(lightDirection()), wo = local([0, 0, 1]);
    point = {at, wi, wo, lit: wi[2] > 0, angles: wi[2] > 0 ? anglesOf(wi, wo) : null};
  }
  chartsDirty = dirty = true;
  showNumbers();
}

function showNumbers() {
  byId('point-hint').textContent = !point ? 'Point at the object.' : point.lit
    ? `Light: the ${state.light === 'lamp' ? 'lamp' : 'brightest of the environment'}.` : 'In the shade of the light.';
  const rows = [];
  const row = (title, ...values) => rows.push(element('tr', {}, element('th', {textContent: title, scope: 'row'}),
                                                      ...values.map(v => element('td', {textContent: v}))));
  const wide = (title, value) => {
    row(title, value);
    rows.at(-1).lastChild.colSpan = 3;
  };
  const at = point?.angles, angle = x => `${(x * DEGREES).toFixed(1)}°`;
  wide('angles', at ? `θh ${angle(at.theta_h)}, θd ${angle(at.theta_d)}, θi ${angle(at.theta_i)}, θo ${angle(at.theta_o)}` : '–');
  row('1/sr', 'R', 'G', 'B');
  const fitted = at ? evaluate(point.wi, point.wo).rho : null, known = at && hasMeasured() ? measured.rho(point.wi, point.wo) : null;
  if (hasMeasured()) row('ρ measured', ...(known ?? [NaN, NaN, NaN]).map(short));
  row('ρ fitted', ...(fitted ?? [NaN, NaN, NaN]).map(short));
  const white = at ? albedo(at.theta_o) : [NaN, NaN, NaN];
  row('albedo at θo', ...white.map(x => (Number.isFinite(x) ? x.toFixed(3) : '–')));
  const mean = white.reduce((a, b) => a + b, 0);
  wide('pdf of wi', fitted && mean > 0 ? `${short((fitted.reduce((a, b) => a + b, 0) * point.wi[2]) / mean)} /sr` : '–');
  byId('numbers').replaceChildren(...rows);
}

// ---- Editing -------------------------------------------------------------------------------------------------------

function applyEdit() {
  model = editedModel(base, state.edit);
  evaluate = evaluatorOf(model);
  heat = null;
  renderer.setModel(model);
  chartsDirty = true;
  showEdits();
  layout();
  if (point) lookAt(point.at);
  else showNumbers();
}
function editTo(change) {
  change(state.edit);
  applyEdit();
}
function settle() {
  history.push(state.edit);
  showButtons();
  showVerdict();
}
function showButtons() {
  byId('undo').disabled = !history.canUndo;
  byId('redo').disabled = !history.canRedo;
  byId('reset').disabled = !isEdited(state.edit, base);
}

function slider(label, value, [min, max, step], text, change) {
  const output = element('output', {textContent: text(value)});
  const input = element('input', {type: 'range', min, max, step, value, ariaLabel: label});
  input.addEventListener('input', () => {
    output.textContent = text(Number(input.value));
    editTo(edit => change(edit, Number(input.value)));
  });
  input.addEventListener('change', settle);
  return {input, output, row: [label.split(': ').at(-1), input, output]};
}

// Made once a model; later only values are set, so that the slider that is held stays.
let edits = [];
function makeEdits() {
  edits = [];
  const times = x => `× ${(2 ** x).toFixed(2)}`;
  const block = (title, color, rows) => element('div', {className: 'lobe', role: 'group', ariaLabel: title},
    element('b', {}, Object.assign(element('i', {className: 'swatch'}), {style: `background:${color}`}), title),
    ...rows.flatMap(r => r.map(x => (typeof x === 'string' ? element('span', {textContent: x}) : x))));
  const color = (label, get, set) => {
    const input = element('input', {type: 'color', ariaLabel: label, value: get()});
    input.addEventListener('input', () => editTo(edit => set(edit, input.value)));
    input.addEventListener('change', settle);
    edits.push(() => (input.value = get()));
    return [label.split(': ').at(-1), input, ''];
  };
  const logSlider = (label, get, set, range) => {
    const made = slider(label, Math.log2(get(state.edit)), range, times, (edit, x) => set(edit, 2 ** x));
    edits.push(() => {
      made.input.value = Math.log2(Math.max(get(state.edit), 2 ** range[0]));
      made.output.textContent = `× ${get(state.edit).toFixed(2)}`;
    });
    return made.row;
  };
  const blocks = base.s.map((s, m) => block(lobeName(m).replace('lobe', 'Lobe'), lobeColor(m), [
    logSlider(`Lobe ${m + 1}: roughness`, e => e.lobes[m].rough, (e, x) => (e.lobes[m].rough = x), [-2, 2, 0.02]),
    logSlider(`Lobe ${m + 1}: strength`, e => e.lobes[m].gain, (e, x) => (e.lobes[m].gain = x), [-4, 4, 0.02]),
    color(`Lobe ${m + 1}: tint`, () => state.edit.lobes[m].tint ?? hexOf(s.map(x => x / Math.max(...s, 1e-12))),
          (e, x) => (e.lobes[m].tint = x)),
  ]));
  const rise = slider('All lobes: rise of F', state.edit.rise, [0, 4, 0.05], x => `× ${x.toFixed(2)}`, (e, x) => (e.rise = x));
  edits.push(() => {
    rise.input.value = state.edit.rise;
    rise.output.textContent = `× ${state.edit.rise.toFixed(2)}`;
  });
  blocks.push(block('All', '#888', [
    ...(base.lobes > 0 ? [rise.row] : []),
    color('Diffuse: diffuse', () => state.edit.diffuse ?? hexOf(base.d.map(x => x * Math.PI)), (e, x) => (e.diffuse = x)),
  ]));
  byId('edits').replaceChildren(...blocks);
  const chip = (title, tone, get, set, text = title) => {
    const input = element('input', {type: 'checkbox', checked: get(), ariaLabel: `${title} on`});
    input.addEventListener('change', () => {
      editTo(e => set(e, input.checked));
      settle();
    });
    edits.push(() => (input.checked = get()));
    const label = element('label', {}, input, Object.assign(element('i'), {style: `background:${tone}`}), text);
    return label;
  };
  const alone = (title, only) => {
    const button = element('button', {type: 'button', textContent: 'only', ariaLabel: `Only ${title}`});
    button.addEventListener('click', () => {
      editTo(e => {
        const already = e.lobes.every((l, m) => l.on === (m === only)) && e.diffuseOn === (only === -1);
        e.lobes.forEach((l, m) => (l.on = already || m === only));
        e.diffuseOn = already || only === -1;
      });
      settle();
    });
    return button;
  };
  const chips = base.s.map((_, m) => {
    const label = chip(`lobe ${m + 1}`, lobeColor(m), () => state.edit.lobes[m].on, (e, on) => (e.lobes[m].on = on), lobeName(m));
    label.append(alone(`lobe ${m + 1}`, m));
    return label;
  });
  const diffuse = chip('diffuse', '#999', () => state.edit.diffuseOn, (e, on) => (e.diffuseOn = on));
  diffuse.append(alone('the diffuse term', -1));
  byId('lobes').replaceChildren(...chips, diffuse);
  byId('disc-lobe').replaceChildren(...base.s.map((_, m) => element('option', {value: m, textContent: m + 1})));
}
function showEdits() {
  for (const refresh of edits) refresh();
  showButtons();
}

// ---- What the page says ---------------------------------------------------------------------------------------------

function showVerdict() {
  byId('name').textContent = name;
  document.title = `${name} · Trilobe`;
  const text = byId('verdict'), parts = [];
  if (verdict?.verdict && hasMeasured()) {
    const bold = element('b', {className: verdict.visibility, textContent: verdict.verdict});
    parts.push('Beside what was measured, the fit: ', bold, `. Colours are ΔE ${shortDeltaE(verdict.mean_delta_e)} apart in the mean, and ` +
      `95 % of ${verdict.of_sphere ? 'the sphere' : 'the samples'} stay below ${shortDeltaE(verdict.delta_e_95)}; less than 1 is not seen side by side.`);
  } else if (hasMeasured()) {
    parts.push(`Measured (${source}) beside the model.`);
  } else if (verdict?.verdict) {
    const bold = element('b', {className: verdict.visibility, textContent: verdict.verdict});
    parts.push('By its samples, the fit beside the measurement: ', bold, '. They stand on no grid, so they make no picture.');
  } else {
    parts.push(`A fitted model of ${base.lobes} ${base.lobes === 1 ? 'lobe' : 'lobes'}. Drop its measurement here (MERL or CSV) to see where they differ.`);
  }
  if (isEdited(state.edit, base)) parts.push(' The model has been changed since.');
  text.replaceChildren(...parts);
  byId('formula').textContent = base.lobes > 0
    ? 'ρ is the diffuse colour and, for each lobe, its strength × D(θh) × F(θd) × G(θi) G(θo) / (cos θi cos θo). Lines mark the point under the pointer.'
    : 'ρ is the diffuse colour alone.';
  const {fit = {}} = base.json, rows = [];
  const row = (title, value) => value !== undefined && value !== '' && value !== 0 &&
    rows.push(element('tr', {}, element('th', {textContent: title, scope: 'row'}), element('td', {textContent: value})));
  row('measured', source || fit.source);
  row('samples', fit.valid_samples ? grouped(fit.valid_samples) : '');
  row('up to', fit.max_angle ? `${fit.max_angle}° from the normal` : '');
  row('form', `${base.anisotropic ? 'anisotropic' : 'isotropic'}, ${base.lobes} ${base.lobes === 1 ? 'lobe' : 'lobes'}${contents.parameters ? `, ${grouped(contents.parameters)} numbers` : ''}`);
  row('solver', fit.solver ? `${fit.solver}${fit.iterations ? `, ${fit.iterations} iterations` : ''}` : '');
  row('stopped', fit.stop_reason);
  row('seconds', fit.seconds ? short(fit.seconds) : '');
  row('PSNR', verdict?.psnr_db ? `${short(verdict.psnr_db)} dB` : '');
  row('by', [fit.program, fit.date].filter(Boolean).join(', '));
  byId('facts').replaceChildren(...rows);
  byId('trace-figure').hidden = contents.trace.length < 2;
  byId('difference').hidden = !hasMeasured();
  for (const id of ['chart-d', 'chart-f', 'chart-g']) byId(id).closest('figure').hidden = base.lobes === 0;
  byId('disc-figure').hidden = !(base.lobes > 0 && base.axes.D.phis > 1);
}

function makeSegments(id, entries, key, change) {
  const legend = byId(id).querySelector('legend');
  byId(id).replaceChildren(legend, ...entries.map(([value, text]) => {
    const input = element('input', {type: 'radio', name: id, value, checked: state[key] === value});
    input.addEventListener('change', () => {
      state[key] = value;
      change();
    });
    return element('label', {}, input, text);
  }));
}

function showView() {
  byId('wipe-row').hidden = state.view !== 'wipe';
  byId('scale').hidden = !['side', 'difference'].includes(state.view);
  layout();
}

// The measurement has come, or gone.
function compared() {
  if (!hasMeasured()) state.view = 'fitted';
  makeSegments('views', hasMeasured() ? VIEWS.compared : VIEWS.alone, 'view', showView);
  byId('views').hidden = !hasMeasured();
  heat = null;
  seen = null;
  renderer.setMeasured(measured);
  showVerdict();
  showView();
}

// ---- Files ------------------------------------------------------------------------------------------------------------

async function openFile(file) {
  try {
    if (file.size > 200e6) throw new Error('the file is larger than 200 MB');
    const head = await file.slice(0, 400).text(), first = head.trimStart();
    if (first.startsWith('{')) {
      if (file.size > 16e6) throw new Error('a model of more than 16 MB');
      takeModel(parseModel(await file.text()));
      if (!hasMeasured()) name = file.name;
      verdict = null;
      contents.parameters = 0;
      contents.trace = [];
      compared();
    } else {
      measured = /theta_i/.test(head) || /\.csv$/i.test(file.name) ? parseCsv(await file.text()) : parseMerl(await file.arrayBuffer());
      source = file.name;
      verdict = null;
      if (!hasView('side')) state.view = 'side';
      compared();
    }
    tell(`Opened ${file.name}.`, true);
  } catch (error) {
    tell(`${file.name}: ${error.message}.`);
  }
}
const hasView = view => state.view === view;

function takeModel(parsed) {
  evaluatorOf(parsed);
  base = parsed;
  state.edit = noEdit(base);
  history = new History(state.edit);
  makeEdits();
  renderer.exposure = 0;
  applyEdit();
}

// ---- Pointer and keys ---------------------------------------------------------------------------------------------------

let dragging = null;

// Where in which panel: from -1 to 1, y up.
function placeOf(event) {
  const box = byId('canvas').getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
  for (const panel of panels) {
    const at = [(2 * (x - panel.left)) / panel.css - 1, 1 - (2 * (y - panel.top)) / panel.css];
    if (dragging?.panel === panel || (Math.abs(at[0]) <= 1 && Math.abs(at[1]) <= 1)) return {panel, at};
  }
  return null;
}

function listen() {
  const canvas = byId('canvas');
  canvas.addEventListener('pointerdown', event => {
    const place = placeOf(event);
    if (!place) return;
    canvas.setPointerCapture(event.pointerId);
    const onLine = state.view === 'wipe' && Math.abs((place.at[0] + 1) / 2 - state.wipe) < 0.04;
    dragging = {panel: place.panel, what: onLine ? 'line' : 'light', x: event.clientX, around: state.around, moved: false};
    if (!onLine) lookAt(place.at);
  });
  canvas.addEventListener('pointermove', event => {
    const place = placeOf(event);
    if (!place) return;
    if (!dragging) {
      if (event.pointerType === 'mouse') lookAt(place.at);
      return;
    }
    if (dragging.what === 'line') {
      state.wipe = Math.min(Math.max((place.at[0] + 1) / 2, 0), 1);
      byId('wipe').value = state.wipe;
      dirty = true;
      return;
    }
    if (Math.abs(event.clientX - dragging.x) > 3) dragging.moved = true;
    if (state.light === 'lamp') state.lamp = place.at;
    else if (dragging.moved) state.around = dragging.around - (event.clientX - dragging.x) / (3 * place.panel.css);
    if (state.object === 'flat' && event.shiftKey) state.turn = [place.at[0] * 1.2, place.at[1] * 1.2];
    if (state.object === 'flat' && event.shiftKey) applyObject();
    applyLight();
    lookAt(place.at);
  });
  const release = () => {
    if (!dragging) return;
    dragging = null;
    applyLight();
  };
  canvas.addEventListener('pointerup', release);
  canvas.addEventListener('pointercancel', release);
  canvas.addEventListener('keydown', event => {
    const step = {ArrowLeft: [-0.05, 0], ArrowRight: [0.05, 0], ArrowUp: [0, 0.05], ArrowDown: [0, -0.05]}[event.key];
    if (!step) return;
    event.preventDefault();
    if (event.shiftKey) {
      const at = point?.at ?? [0, 0];
      lookAt(at.map((x, k) => Math.min(Math.max(x + step[k], -1), 1)));
      if (!point) lookAt(at);
    } else if (event.altKey || event.ctrlKey) {
      state.turn = [state.turn[0] + 2 * step[0], state.turn[1] + 2 * step[1]];
      applyObject();
    } else if (state.light === 'lamp') {
      state.lamp = state.lamp.map((x, k) => Math.min(Math.max(x + step[k], -0.98), 0.98));
      applyLight();
    } else {
      state.around -= step[0] / 2;
      applyLight();
    }
  });
  byId('wipe').addEventListener('input', () => {
    state.wipe = Number(byId('wipe').value);
    dirty = true;
  });
  byId('exposure').addEventListener('input', () => {
    state.exposure = Number(byId('exposure').value);
    byId('stops').textContent = state.exposure > 0 ? `+${state.exposure}` : state.exposure;
    dirty = true;
  });
  byId('object').addEventListener('change', () => {
    state.object = byId('object').value;
    if (state.object === 'flat' && state.turn[0] === 0 && state.turn[1] === 0) state.turn = [0.5, -0.5];
    applyObject();
  });
  byId('turntable').addEventListener('change', applyObject);
  byId('polar-theta').addEventListener('input', () => {
    state.thetaI = Number(byId('polar-theta').value);
    chartsDirty = true;
  });
  byId('disc-lobe').addEventListener('change', () => (chartsDirty = true));
  const go = step => () => {
    state.edit = history[step]();
    applyEdit();
    showVerdict();
  };
  byId('undo').addEventListener('click', go('undo'));
  byId('redo').addEventListener('click', go('redo'));
  byId('reset').addEventListener('click', () => {
    state.edit = noEdit(base);
    applyEdit();
    settle();
  });
  document.addEventListener('keydown', event => {
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== 'z') return;
    event.preventDefault();
    byId(event.shiftKey ? 'redo' : 'undo').click();
  });
  byId('save').addEventListener('click', () => {
    const edited = isEdited(state.edit, base);
    download(formatModel(editedModel(base, state.edit), edited ? 'in a page' : null), 'application/json', `${name.replace(/[^\w.-]+/g, '_')}.json`);
    tell('The model is among your downloads.', true);
  });
  byId('shot').addEventListener('click', () => {
    renderer.show(panels, {wipe: state.wipe, stops: state.exposure, mark: null});
    byId('canvas').toBlob(blob => download(blob, 'image/png', `${name.replace(/[^\w.-]+/g, '_')}.png`));
    dirty = true;
  });
  byId('link').addEventListener('click', async () => {
    window.history.replaceState(null, '', `#${stateText()}`);
    try {
      await navigator.clipboard.writeText(location.href);
      tell('The link is copied: it opens this page as it looks now.', true);
    } catch {
      tell('The address bar holds the link: it opens this page as it looks now.', true);
    }
  });
  byId('open').addEventListener('click', () => byId('file').click());
  byId('file').addEventListener('change', () => {
    if (byId('file').files[0]) openFile(byId('file').files[0]);
    byId('file').value = '';
  });
  const drop = byId('drop');
  document.addEventListener('dragover', event => {
    event.preventDefault();
    drop.hidden = false;
  });
  document.addEventListener('dragleave', event => {
    if (!event.relatedTarget) drop.hidden = true;
  });
  document.addEventListener('drop', event => {
    event.preventDefault();
    drop.hidden = true;
    if (event.dataTransfer.files[0]) openFile(event.dataTransfer.files[0]);
  });
  byId('theme').addEventListener('click', () => {
    state.theme = isDark() ? 'light' : 'dark';
    applyTheme();
  });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', applyTheme);
  new ResizeObserver(() => {
    layout();
    chartsDirty = true;
  }).observe(byId('picture'));
  window.addEventListener('resize', () => (chartsDirty = true));
}

function applyTheme() {
  const dark = matchMedia('(prefers-color-scheme: dark)').matches;
  document.documentElement.dataset.theme = state.theme ?? (dark ? 'dark' : 'light');
  chartsDirty = true;
}

// ---- Begin ------------------------------------------------------------------------------------------------------------------

async function begin() {
  if (contents.measured) state.view = 'side';
  if (location.hash.length > 1) takeState(location.hash.slice(1));
  applyTheme();
  base = parseModel(contents.model);
  state.edit = checkedEdit(state.edit, base);
  history = new History(noEdit(base));
  history.push(state.edit);
  model = editedModel(base, state.edit);
  evaluate = evaluatorOf(model);
  renderer = new Renderer(byId('canvas'), file => shaders[file]);
  renderer.onImage = level => {
    compareShown(level);
    if (point) lookAt(point.at);
  };
  environment = contents.probe ? probeEnvironment(contents.probe, bytesOf(contents.probe.data))
                               : studioEnvironment();
  renderer.setEnvironment(environment);
  if (contents.measured) measured = decodeMeasured(contents.measured, contents.measured.data);
  makeSegments('lights', LIGHTS, 'light', applyLight);
  makeEdits();
  byId('object').value = state.object;
  byId('exposure').value = state.exposure;
  byId('stops').textContent = state.exposure;
  byId('wipe').value = state.wipe;
  byId('polar-theta').value = state.thetaI;
  renderer.object = state.object;
  renderer.turn = state.object === 'cloth' ? [state.turn[0], 0] : state.turn;
  renderer.lamp = state.light === 'lamp' ? lampDirection() : null;
  renderer.environmentTurn = state.around;
  renderer.setModel(model);
  compared();
  showEdits();
  showNumbers();
  listen();
  requestAnimationFrame(frame);
}

// For tests, and for those who look.
window.trilobe = {state, contents, get renderer() { return renderer; }, get model() { return model; }, openFile, isNearlyDiffuse};
begin().catch(error => {
  tell(error.message);
  console.warn(error);
});
