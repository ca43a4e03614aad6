// The panel in which the model is changed, and the switches of its lobes.

import {makeChartChoices} from './charts.js';
import {byId, element, swatch} from './dom.js';
import {editedModel, hexOf, isEdited, noEdit} from './edit.js';
import {handRows} from './hand_edit.js';
import {evaluatorOf} from './model.js';
import {forget, lobeColor, lobeName, page, state} from './page_state.js';
import {help} from './words.js';

// Set by main.js: what else changes with the model, and what follows a change that is done.
export const onEdit = {change: () => {}, settle: () => {}};

export function applyEdit() {
  page.model = editedModel(page.base, state.edit);
  page.evaluate = evaluatorOf(page.model);
  page.renderer.setModel(page.model);
  forget();
  showEdits();
  onEdit.change();
}
function editTo(change) {
  change(state.edit);
  applyEdit();
}
// `control`: what was moved; a row of its steps is undone as one.
function settle(control) {
  page.history.push(state.edit, control);
  showButtons();
  onEdit.settle();
}
function showButtons() {
  byId('undo').disabled = !page.history.canUndo;
  byId('redo').disabled = !page.history.canRedo;
  byId('reset').disabled = !isEdited(state.edit, page.base);
}
export function showEdits() {
  for (const refresh of refreshes) refresh();
  showButtons();
}

// Made once a model; later only values are set, so that the slider that is held stays.
let refreshes = [];

function slider(label, get, set, [min, max, step], from = x => x, to = x => x) {
  const text = () => `× ${get(state.edit).toFixed(2)}`;
  const output = element('output', {textContent: text()});
  const input = element('input', {type: 'range', min, max, step, value: from(get(state.edit)), ariaLabel: label});
  input.addEventListener('input', () => editTo(edit => set(edit, to(Number(input.value)))));
  input.addEventListener('change', () => settle(label));
  refreshes.push(() => {
    if (Number(input.value) !== from(get(state.edit))) input.value = from(get(state.edit));
    output.textContent = text();
    input.setAttribute('aria-valuetext', text());
  });
  const word = label.split(': ').at(-1);
  return [word === 'rise of F' || label === 'Lobe 1: roughness' ? element('span', {}, word, help(word === 'roughness' ? word : 'rise')) : word, input, output];
}
function logSlider(label, get, set, range) {
  return slider(label, get, set, range, x => Math.log2(Math.max(x, 2 ** range[0])), x => 2 ** x);
}
function colorInput(label, get, set) {
  const input = element('input', {type: 'color', ariaLabel: label, value: get()});
  input.addEventListener('input', () => editTo(edit => set(edit, input.value)));
  input.addEventListener('change', () => settle(label));
  refreshes.push(() => (input.value = get()));
  return [label.split(': ').at(-1), input, ''];
}
function block(title, color, rows) {
  return element('div', {className: 'lobe', role: 'group', ariaLabel: title}, element('b', {}, swatch(color), title),
                 ...rows.flatMap(r => r.map(x => (typeof x === 'string' ? element('span', {textContent: x}) : x))));
}

function chip(title, tone, get, set, text) {
  const input = element('input', {type: 'checkbox', checked: get(), ariaLabel: `${title} on`});
  input.addEventListener('change', () => {
    editTo(e => set(e, input.checked));
    settle(null);
  });
  refreshes.push(() => (input.checked = get()));
  return element('label', {}, input, swatch(tone, ''), text);
}
// Shows this lobe alone (-1: the diffuse term), or all again.
function aloneButton(title, only) {
  const button = element('button', {type: 'button', textContent: 'only', ariaLabel: `Only ${title}`});
  button.addEventListener('click', () => {
    editTo(e => {
      const already = e.lobes.every((l, m) => l.on === (m === only)) && e.diffuseOn === (only === -1);
      e.lobes.forEach((l, m) => (l.on = already || m === only));
      e.diffuseOn = already || only === -1;
    });
    settle(null);
  });
  return button;
}

export function makeEdits() {
  const {base} = page;
  refreshes = [];
  const blocks = base.s.map((s, m) => block(lobeName(m).replace('lobe', 'Lobe'), lobeColor(m), [
    logSlider(`Lobe ${m + 1}: roughness`, e => e.lobes[m].rough, (e, x) => (e.lobes[m].rough = x), [-2, 2, 0.02]),
    logSlider(`Lobe ${m + 1}: strength`, e => e.lobes[m].gain, (e, x) => (e.lobes[m].gain = x), [-4, 4, 0.02]),
    colorInput(`Lobe ${m + 1}: tint`, () => state.edit.lobes[m].tint ?? hexOf(s.map(x => x / Math.max(...s, 1e-12))),
               (e, x) => (e.lobes[m].tint = x)),
  ]));
  blocks.push(block('All', '#888', [
    ...(base.lobes > 0 ? [slider('All lobes: rise of F', e => e.rise, (e, x) => (e.rise = x), [0, 4, 0.05])] : []),
    colorInput('Diffuse: diffuse', () => state.edit.diffuse ?? hexOf(base.d.map(x => x * Math.PI)), (e, x) => (e.diffuse = x)),
  ]));
  if (base.lobes > 0) {
    const {rows, refresh} = handRows(base, () => page.model, change => {
      editTo(e => e.hand.push(change));
      settle(null);
    });
    refreshes.push(refresh);
    blocks.push(block('By hand', 'var(--muted)', rows));
  }
  byId('edits').replaceChildren(...blocks);
  const chips = base.s.map((_, m) => {
    const label = chip(`lobe ${m + 1}`, lobeColor(m), () => state.edit.lobes[m].on, (e, on) => (e.lobes[m].on = on), lobeName(m));
    return element('span', {className: 'chip'}, label, aloneButton(`lobe ${m + 1}`, m));
  });
  const diffuse = chip('diffuse', '#999', () => state.edit.diffuseOn, (e, on) => (e.diffuseOn = on), 'diffuse');
  byId('lobes').replaceChildren(...chips, element('span', {className: 'chip'}, diffuse, aloneButton('the diffuse term', -1)));
  makeChartChoices();
  byId('disc-lobe').replaceChildren(...base.s.map((_, m) => element('option', {value: m, textContent: m + 1})));
}

export function listenToEdits() {
  const go = step => () => {
    state.edit = page.history[step]();
    applyEdit();
    onEdit.settle();
  };
  byId('undo').addEventListener('click', go('undo'));
  byId('redo').addEventListener('click', go('redo'));
  byId('reset').addEventListener('click', () => {
    state.edit = noEdit(page.base);
    applyEdit();
    settle(null);
  });
  document.addEventListener('keydown', event => {
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== 'z') return;
    event.preventDefault();
    byId(event.shiftKey ? 'redo' : 'undo').click();
  });
}
