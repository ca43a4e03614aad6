// A model file (docs/file-formats.md), its value for two directions, and the text that it is saved as.

export const CHANNELS = 3;
export const FACTORS = ['D', 'F', 'G'];
const SHARED_BY_PAPER = {
  D: {per_lobe: true, per_channel: false},
  F: {per_lobe: false, per_channel: true},
  G: {per_lobe: true, per_channel: false},
};
const RIGHT = Math.PI / 2;

function fail(text) {
  throw new Error(text);
}

function numbersOf(value, key) {
  if (!Array.isArray(value) || !value.every(x => Number.isFinite(x) && x >= 0)) {
    fail(`key '${key}' must be a list of numbers that are 0 or more`);
  }
  return value;
}

// A table as it stands in the file: whole, or some of its entries, between which it is linear.
function tableOf(value, key) {
  if (Array.isArray(value)) return Float64Array.from(numbersOf(value, key));
  const {size, nodes, values} = value ?? {};
  if (!Number.isInteger(size) || size < 4 || size > 2048 || !Array.isArray(nodes) || nodes.length < 1 ||
      numbersOf(values, key).length !== nodes.length ||
      nodes.some((n, k) => !Number.isInteger(n) || n < 0 || n >= size || (k > 0 && n <= nodes[k - 1]))) {
    fail(`key '${key}' has a table that is none`);
  }
  const table = new Float64Array(size);
  for (let e = 0; e < size; ++e) {
    let k = nodes.findIndex(n => n > e);
    if (k === 0) table[e] = values[0];
    else if (k < 0) table[e] = values[nodes.length - 1];
    else {
      const t = (e - nodes[k - 1]) / (nodes[k] - nodes[k - 1]);
      table[e] = (1 - t) * values[k - 1] + t * values[k];
    }
  }
  return table;
}

export function tableIndex(sharing, lobe, channel) {
  return (sharing.per_lobe ? lobe : 0) * (sharing.per_channel ? CHANNELS : 1) + (sharing.per_channel ? channel : 0);
}

// The angle at which an entry of a table stands [rad].
export function thetaOf({size, phis, theta}, factor, entry) {
  if (phis > 0) return (theta[Math.floor(entry / phis)] * Math.PI) / 180;
  const part = (entry + 0.5) / size;
  return (Math.PI / 2) * (factor === 'D' ? part * part : part);
}

// Whether a lobe reflects about alike in all directions, as in trilobe/model/objective/lobe_light.h.
export function isNearlyDiffuse(model, lobe) {
  const flat = (factor, channel, most) => {
    const values = [];
    model.tables[factor][tableIndex(model.sharing[factor], lobe, channel)].forEach((value, entry) => {
      const theta = thetaOf(model.axes[factor], factor, entry);
      if (theta <= Math.PI / 3) values.push(factor === 'G' ? value / Math.cos(theta) : value);
    });
    const high = Math.max(...values);
    return high > 0 && high <= most * Math.min(...values);
  };
  return [0, 1, 2].every(c => flat('D', c, 2) && flat('G', c, 1.5));
}

// Throws an Error of one line, which says what is wrong, for what is no model.
export function parseModel(text) {
  let json;
  try {
    json = JSON.parse(text);
  } catch {
    fail('not a model: the file is not JSON');
  }
  if (json?.format !== 'trilobe-model') fail(`not a model: key 'format' is not "trilobe-model"`);
  if (json.wavelengths) fail(`a model of ${json.wavelengths.length} wavelengths; this page shows colours, which model.json of the same fit has`);
  if (![1, 2].includes(json.version)) fail(`key 'version' is ${json.version}; this page reads 1 and 2`);
  if (json.version === 1 && json.stretch !== undefined) fail(`key 'stretch' needs "version": 2`);
  const anisotropic = json.kind === 'anisotropic';
  if (!anisotropic && json.kind !== 'isotropic') fail(`key 'kind' is neither "isotropic" nor "anisotropic"`);
  const lobes = json.lobes;
  if (!Number.isInteger(lobes) || lobes < 0 || lobes > 8) fail(`key 'lobes' must be from 0 to 8`);
  const colour = (value, key) => {
    const c = numbersOf(value, key);
    if (c.length !== 1 && c.length !== CHANNELS) fail(`key '${key}' must have 1 or 3 numbers`);
    return c.length === 1 ? [c[0], c[0], c[0]] : [...c];
  };
  const model = {
    anisotropic,
    lobes,
    d: colour(json.d, 'd'),
    s: (Array.isArray(json.s) ? json.s : fail(`key 's' is missing`)).map(row => colour(row, 's')),
    sharing: {},
    tables: {},
    axes: {},
    stretch: Array.from({length: lobes}, () => [0, 0]),
    json,
  };
  if (model.s.length !== lobes) fail(`key 's' must have ${lobes} entries, not ${model.s.length}`);
  for (const factor of FACTORS) {
    const sharing = (model.sharing[factor] = {...SHARED_BY_PAPER[factor], ...json.sharing?.[factor]});
    const levels = [sharing.per_lobe ? lobes : null, sharing.per_channel ? CHANNELS : null].filter(n => n !== null);
    const tables = [];
    const nested = anisotropic && (factor === 'D' || factor === 'G');
    const visit = (value, depth) => {
      if (depth < levels.length) {
        if (!Array.isArray(value) || value.length !== levels[depth]) {
          fail(`key '${factor}' must have ${levels[depth]} entries${depth > 0 ? ' a lobe' : ''}`);
        }
        for (const part of value) visit(part, depth + 1);
      } else if (nested && Array.isArray(value) && value.every(Array.isArray)) {
        tables.push(tableOf(value.flat(), factor));
      } else {
        tables.push(tableOf(value, factor));
      }
    };
    if (lobes > 0) visit(json[factor], 0);
    const size = tables[0]?.length ?? 90;
    if (size < 4 || size > 2048 || tables.some(t => t.length !== size)) fail(`key '${factor}' has tables of other sizes`);
    model.tables[factor] = tables;
    const axis = (model.axes[factor] = {size, phis: 0, theta: null});
    if (nested && lobes > 0) {
      axis.theta = json.theta_nodes?.[factor] ?? [0, 15, 30, 45, 60, 75];
      axis.phis = json.phi_nodes?.[factor]?.length ?? 48;
      if (axis.theta.length * axis.phis !== size) fail(`key '${factor}' does not have an entry for each of its nodes`);
    }
  }
  const stretch = json.stretch;
  if (stretch !== undefined) {
    const all = Array.isArray(stretch) ? stretch : Array.from({length: lobes}, () => stretch);
    const valid = x => Number.isFinite(x) && Math.abs(x) <= 2;
    if (all.length !== lobes || !all.every(e => valid(e?.along) && valid(e?.across))) fail(`key 'stretch' is ill-shaped`);
    model.stretch = all.map(e => [e.along, e.across]);
  }
  return model;
}

// The same model with other numbers; the tables are copies.
export function copyModel(model) {
  const copy = {...model, d: [...model.d], s: model.s.map(row => [...row]), tables: {}};
  for (const factor of FACTORS) copy.tables[factor] = model.tables[factor].map(t => Float64Array.from(t));
  return copy;
}

export function isStretched(model) {
  return model.stretch.some(([a, b]) => a !== 0 || b !== 0);
}

// The text of a model file, which trilobe reads.
export function formatModel(model, note) {
  const {json} = model;
  const file = {
    format: 'trilobe-model',
    version: isStretched(model) ? 2 : 1,
    kind: json.kind,
    lobes: model.lobes,
    sharing: model.sharing,
  };
  if (isStretched(model)) {
    const all = model.stretch.map(([along, across]) => ({along, across}));
    file.stretch = all.every(e => e.along === all[0].along && e.across === all[0].across) ? all[0] : all;
  }
  for (const key of ['theta_nodes', 'phi_nodes']) if (json[key]) file[key] = json[key];
  file.d = model.d;
  file.s = model.s;
  for (const factor of FACTORS) {
    const {per_lobe, per_channel} = model.sharing[factor];
    const {phis, theta} = model.axes[factor];
    const tables = model.tables[factor].map(table => {
      const list = Array.from(table);
      return phis > 0 ? theta.map((_, a) => list.slice(a * phis, (a + 1) * phis)) : list;
    });
    const ofLobe = m => (per_channel ? tables.slice(m * CHANNELS, (m + 1) * CHANNELS) : tables[m]);
    file[factor] = model.lobes === 0 ? [] : per_lobe ? Array.from({length: model.lobes}, (_, m) => ofLobe(m)) : ofLobe(0);
  }
  if (json.unobserved ?? json.dead) file.unobserved = json.unobserved ?? json.dead;
  file.fit = {...json.fit, ...(note ? {edited: note} : {})};
  return JSON.stringify(file, null, 1).replace(/\[\s+([-\d.e+,\s]+?)\s+\]/g, (_, list) => `[${list.replace(/\s+/g, '')}]`) + '\n';
}

// Place at which tables of so many bins are read: [lower, upper, part].
export function linearPlace(coordinate, bins) {
  const x = Math.min(Math.max(coordinate - 0.5, 0), bins - 1);
  const lower = Math.min(Math.floor(x), bins - 2);
  return [lower, lower + 1, x - lower];
}

function ringPlace(theta, rings) {
  const degrees = (theta * 180) / Math.PI;
  let upper = 0;
  while (upper < rings.length && degrees >= rings[upper]) ++upper;
  if (upper === 0) return [0, 0, 0];
  if (upper === rings.length) return [upper - 1, upper - 1, 0];
  return [upper - 1, upper, (degrees - rings[upper - 1]) / (rings[upper] - rings[upper - 1])];
}

function polarRead(table, axis, theta, w, sine) {
  const [a0, a1, s] = ringPlace(theta, axis.theta);
  let b0 = 0, b1 = 0, t = 0;
  if (axis.phis > 1 && sine > 1e-9) {
    const turns = Math.atan2(w[1], w[0]) / (2 * Math.PI);
    const x = (turns < 0 ? turns + 1 : turns) * axis.phis;
    b0 = Math.min(Math.floor(x), axis.phis - 1);
    b1 = (b0 + 1) % axis.phis;
    t = x - b0;
  }
  const at = (a, b) => table[a * axis.phis + b];
  return (1 - s) * ((1 - t) * at(a0, b0) + t * at(a0, b1)) + s * ((1 - t) * at(a1, b0) + t * at(a1, b1));
}

export function bendsOf(values) {
  const last = values.length - 1;
  return Array.from(values, (v, k) => (k === 0 || k === last ? 0 : v - (values[k - 1] + values[k + 1]) / 2));
}

function splineRead(values, bends, [k, next, t]) {
  const u = 1 - t;
  return u * values[k] + t * values[next] + t * u * (u * bends[k] + t * bends[next]);
}

export function splineCosines(size) {
  return Array.from({length: size}, (_, k) => Math.cos(((k + 0.5) / size) * RIGHT));
}

// The angles of two directions [rad], and what else is read by.
export function anglesOf(wi, wo) {
  const h = [wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]];
  const size = Math.hypot(...h);
  for (let k = 0; k < 3; ++k) h[k] /= size;
  const sineH = Math.hypot(h[0], h[1]);
  const sineD = Math.hypot(wi[0] - wo[0], wi[1] - wo[1], wi[2] - wo[2]) / 2;
  const cosD = size / 2, sines = 2 * sineH * sineD;
  const cosPhi = sines > 0 ? Math.min(Math.max((wo[2] - wi[2]) / sines, -1), 1) : 1;
  const phi = Math.acos(cosPhi);
  return {
    h, sineH, cosD, cosPhi,
    theta_h: Math.atan2(sineH, h[2]),
    theta_d: Math.atan2(sineD, cosD),
    phi_d: h[0] * wi[1] - h[1] * wi[0] >= 0 || phi === 0 ? phi : Math.PI - phi,
    theta_i: Math.atan2(Math.hypot(wi[0], wi[1]), wi[2]),
    theta_o: Math.atan2(Math.hypot(wo[0], wo[1]), wo[2]),
  };
}

// A function of (wi, wo) that gives {rho: [3], lobes: [lobes][3]} [1/sr], as the shader has it.
export function evaluatorOf(model) {
  const {axes, tables, lobes} = model;
  const spline = axes.G.phis === 0;
  const cosines = spline ? splineCosines(axes.G.size) : null, cosineBends = spline ? bendsOf(cosines) : null;
  const bends = spline ? tables.G.map(bendsOf) : null;
  return (wi, wo) => {
    if (!(wi[2] > 0 && wo[2] > 0)) return {rho: [0, 0, 0], lobes: model.s.map(() => [0, 0, 0])};
    const at = anglesOf(wi, wo);
    const placeD = stretch => {
      let theta = at.theta_h;
      if (stretch[0] !== 0 || stretch[1] !== 0) {
        const c = Math.max(at.cosD, 1e-4), cos2 = at.cosPhi * at.cosPhi;
        theta = Math.min(theta * Math.sqrt(cos2 * c ** (2 * stretch[0]) + (1 - cos2) * c ** (2 * stretch[1])), RIGHT);
      }
      return linearPlace(axes.D.size * Math.sqrt(theta / RIGHT), axes.D.size);
    };
    const placeF = linearPlace((axes.F.size * at.theta_d) / RIGHT, axes.F.size);
    const between = (table, [a, b, t]) => (1 - t) * table[a] + t * table[b];
    const cache = {};
    const readG = t => {
      if (t in cache) return cache[t];
      let value;
      if (spline) {
        const i = linearPlace((axes.G.size * at.theta_i) / RIGHT, axes.G.size);
        const o = linearPlace((axes.G.size * at.theta_o) / RIGHT, axes.G.size);
        value = (splineRead(tables.G[t], bends[t], i) * splineRead(tables.G[t], bends[t], o)) /
                (splineRead(cosines, cosineBends, i) * splineRead(cosines, cosineBends, o));
      } else {
        value = (polarRead(tables.G[t], axes.G, at.theta_i, wi, Math.hypot(wi[0], wi[1])) *
                 polarRead(tables.G[t], axes.G, at.theta_o, wo, Math.hypot(wo[0], wo[1]))) / Math.max(wi[2] * wo[2], 1e-37);
      }
      return (cache[t] = value);
    };
    const parts = [], rho = [...model.d];
    for (let m = 0; m < lobes; ++m) {
      const place = axes.D.phis > 0 ? null : placeD(model.stretch[m]);
      const part = [0, 0, 0];
      for (let c = 0; c < CHANNELS; ++c) {
        const table = tables.D[tableIndex(model.sharing.D, m, c)];
        const d = place ? between(table, place) : polarRead(table, axes.D, at.theta_h, at.h, at.sineH);
        part[c] = model.s[m][c] * d * between(tables.F[tableIndex(model.sharing.F, m, c)], placeF) *
                  readG(tableIndex(model.sharing.G, m, c));
        rho[c] += part[c];
      }
      parts.push(part);
    }
    return {rho: rho.map(x => Math.max(x, 0)), lobes: parts};
  };
}
