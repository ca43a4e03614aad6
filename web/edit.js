// Changes of a model that can be undone: of each lobe whether it counts, its strength, tint and roughness; of all how
// F rises; the diffuse colour; and tables by hand.

import {applyHand, checkedHand} from './hand_edit.js';
import {CHANNELS, copyModel, tableIndex} from './model.js';

export function noEdit(model) {
  return {lobes: model.s.map(() => ({on: true, gain: 1, tint: null, rough: 1})), diffuseOn: true, diffuse: null, rise: 1, hand: []};
}

export function isEdited(edit, model) {
  return JSON.stringify(edit) !== JSON.stringify(noEdit(model));
}

// Returns an edit of the form above, whatever a link says: values are clamped to their ranges, invalid ones replaced.
export function checkedEdit(edit, model) {
  const clean = noEdit(model);
  const between = (x, low, high, other) => (Number.isFinite(x) ? Math.min(Math.max(x, low), high) : other);
  const color = x => (typeof x === 'string' && /^#[0-9a-f]{6}$/i.test(x) ? x : null);
  if (!Array.isArray(edit?.lobes) || edit.lobes.length !== model.lobes) return clean;
  clean.lobes = edit.lobes.map(l => ({
    on: l?.on !== false, gain: between(l?.gain, 0, 16, 1), tint: color(l?.tint), rough: between(l?.rough, 0.2, 5, 1)}));
  clean.diffuseOn = edit.diffuseOn !== false;
  clean.diffuse = color(edit.diffuse);
  clean.rise = between(edit.rise, 0, 4, 1);
  clean.hand = checkedHand(edit.hand, model);
  return clean;
}

// Codes of sRGB as light, and back.
export function linearOfCode(byte) {
  const code = byte / 255;
  return code <= 0.04045 ? code / 12.92 : ((code + 0.055) / 1.055) ** 2.4;
}
export const linearOf = hex => [1, 3, 5].map(at => linearOfCode(parseInt(hex.slice(at, at + 2), 16)));
export function hexOf(linear) {
  return '#' + linear.map(x => {
    const c = Math.min(Math.max(x, 0), 1);
    const code = Math.round(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055));
    return code.toString(16).padStart(2, '0');
  }).join('');
}

// D where highlights are `rough` times as wide: D(theta / rough) / rough^2, which keeps what they reflect.
function stretched(table, axis, rough) {
  const out = new Float64Array(table.length), scale = 1 / (rough * rough);
  if (axis.phis === 0) {
    for (let e = 0; e < table.length; ++e) {
      const x = Math.min(Math.max((e + 0.5) / Math.sqrt(rough) - 0.5, 0), table.length - 1);
      const low = Math.min(Math.floor(x), table.length - 2), t = x - low;
      out[e] = scale * ((1 - t) * table[low] + t * table[low + 1]);
    }
    return out;
  }
  const {theta, phis} = axis;
  theta.forEach((degrees, a) => {
    const wanted = degrees / rough;
    let k = theta.findIndex(ring => ring > wanted);
    if (k < 0) k = theta.length - 1;
    const low = Math.max(k - 1, 0), width = theta[k] - theta[low];
    const t = width > 0 ? Math.min(Math.max((wanted - theta[low]) / width, 0), 1) : 0;
    for (let b = 0; b < phis; ++b) out[a * phis + b] = scale * ((1 - t) * table[low * phis + b] + t * table[k * phis + b]);
  });
  return out;
}

// Applies an edit to a model. With `all`, lobes that are off count, too: the model is saved so.
export function editedModel(base, edit, all = false) {
  const model = copyModel(base);
  if (edit.diffuse) model.d = linearOf(edit.diffuse).map(x => x / Math.PI);
  if (!edit.diffuseOn && !all) model.d = [0, 0, 0];
  edit.lobes.forEach((lobe, m) => {
    const tint = lobe.tint ? linearOf(lobe.tint) : null, mean = base.s[m].reduce((a, b) => a + b, 0) / CHANNELS;
    const light = tint ? tint.reduce((a, b) => a + b, 0) / CHANNELS : 1;
    model.s[m] = base.s[m].map((s, c) => (lobe.on || all ? lobe.gain * (tint ? (mean * tint[c]) / Math.max(light, 1e-6) : s) : 0));
  });
  const done = new Set();
  edit.lobes.forEach((lobe, m) => {
    for (let c = 0; c < CHANNELS; ++c) {
      const t = tableIndex(base.sharing.D, m, c);
      if (lobe.rough === 1 || done.has(t)) continue;
      done.add(t);
      model.tables.D[t] = stretched(base.tables.D[t], base.axes.D, lobe.rough);
    }
  });
  if (edit.rise !== 1) {
    model.tables.F = base.tables.F.map(table => table.map(f => Math.max(0, table[0] + edit.rise * (f - table[0]))));
  }
  applyHand(model, edit.hand);
  return model;
}

// States, with a way back and forth. What one control does within a second of its last step is one step.
export class History {
  constructor(state) {
    this.states = [JSON.stringify(state)];
    this.at = 0;
    this.last = {control: null, time: 0};
  }
  push(state, control = null, time = performance.now()) {
    const text = JSON.stringify(state);
    if (text === this.states[this.at]) return;
    const goesOn = control !== null && control === this.last.control && time - this.last.time < 1000;
    this.last = {control, time};
    this.states = [...this.states.slice(0, this.at + (goesOn ? 0 : 1)), text].slice(-200);
    this.at = this.states.length - 1;
  }
  get canUndo() { return this.at > 0; }
  get canRedo() { return this.at + 1 < this.states.length; }
  undo() { return this.go(Math.max(0, this.at - 1)); }
  redo() { return this.go(Math.min(this.states.length - 1, this.at + 1)); }
  go(at) {
    this.last = {control: null, time: 0};
    return JSON.parse(this.states[(this.at = at)]);
  }
}
