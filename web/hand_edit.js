// A table of the model changed by hand: a value at an angle, with a smooth bump around it.

import {element} from './dom.js';
import {FACTORS, tableIndex, thetaOf} from './model.js';
import {CHANNEL_NAMES} from './plots.js';

const MOST_CHANGES = 200;
const degreesOf = (axis, factor, entry) => (thetaOf(axis, factor, entry) * 180) / Math.PI;

// Valid changes of a list from a link: [{factor, table, theta, width, add}...], angles in degrees.
export function checkedHand(list, model) {
  const valid = c => FACTORS.includes(c?.factor) && Number.isInteger(c.table) && model.tables[c.factor][c.table] !== undefined &&
    [c.theta, c.width, c.add].every(Number.isFinite) && c.theta >= 0 && c.theta <= 90 && c.width >= 0 && c.width <= 90;
  return Array.isArray(list) ? list.filter(valid).slice(-MOST_CHANGES).map(({factor, table, theta, width, add}) => ({factor, table, theta, width, add})) : [];
}

// The entry nearest to an angle.
function entryAt(axis, factor, theta) {
  let best = 0;
  for (let e = 1; e < axis.size; ++e) {
    if (Math.abs(degreesOf(axis, factor, e) - theta) < Math.abs(degreesOf(axis, factor, best) - theta)) best = e;
  }
  return best;
}

// Adds the changes to a model's tables: all of `add` at the entry nearest to theta, and less up to `width` from it.
export function applyHand(model, list) {
  for (const {factor, table, theta, width, add} of list) {
    const axis = model.axes[factor], values = model.tables[factor][table], middle = degreesOf(axis, factor, entryAt(axis, factor, theta));
    for (let e = 0; e < axis.size; ++e) {
      const far = Math.abs(degreesOf(axis, factor, e) - middle);
      const part = far < 1e-9 ? 1 : far < width ? 0.5 + 0.5 * Math.cos((Math.PI * far) / width) : 0;
      values[e] = Math.max(0, values[e] + add * part);
    }
  }
}

function tablesOf(model) {
  return FACTORS.flatMap(factor => {
    const {per_lobe: perLobe, per_channel: perChannel} = model.sharing[factor];
    return (perLobe ? model.s.map((_, m) => m) : [0]).flatMap(m => (perChannel ? [0, 1, 2] : [0]).map(c => {
      const words = [perLobe && `lobe ${m + 1}`, perChannel && CHANNEL_NAMES[c]].filter(Boolean);
      return {factor, table: tableIndex(model.sharing[factor], m, c), text: `${factor}${words.length > 0 ? ` of ${words.join(', ')}` : ''}`};
    }));
  });
}

// The rows of the panel. `modelNow()` is the model with all changes; `change` gets one more.
export function handRows(base, modelNow, change) {
  const tables = tablesOf(base), number = (id, properties) => element('input', {type: 'number', id, step: 'any', ...properties});
  const select = element('select', {id: 'hand-table', ariaLabel: 'Table'}, ...tables.map(({text}, k) => element('option', {value: k, textContent: text})));
  const theta = number('hand-theta', {min: 0, max: 90, value: 10, ariaLabel: 'Angle of the entry, degrees'});
  const width = number('hand-width', {min: 0, max: 90, value: 5, ariaLabel: 'Width of the change, degrees'});
  const value = number('hand-value', {min: 0, ariaLabel: 'Value of the entry'});
  const button = element('button', {type: 'button', id: 'hand-set', textContent: 'Set', ariaLabel: 'Set the value of the entry'});
  const now = () => {
    const {factor, table} = tables[select.value], model = modelNow();
    return model.tables[factor][table][entryAt(model.axes[factor], factor, Number(theta.value))];
  };
  const refresh = () => document.activeElement !== value && (value.value = String(+now().toPrecision(4)));
  for (const input of [select, theta]) input.addEventListener('input', refresh);
  const set = () => {
    const {factor, table} = tables[select.value], add = Number(value.value) - now();
    if (![theta, width, value].every(input => input.value !== '' && input.checkValidity()) || add === 0) return;
    change({factor, table, theta: Number(theta.value), width: Number(width.value), add});
  };
  button.addEventListener('click', set);
  value.addEventListener('keydown', event => event.key === 'Enter' && set());
  return {rows: [['table', select, ''], ['at θ [°]', theta, ''], ['value', value, button], ['up to ± [°]', width, '']], refresh};
}
