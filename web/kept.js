// Models that are kept in the charts beside the one that is shown, as many as one likes.

import {byId, element, swatch, tell} from './dom.js';
import {evaluatorOf, tableIndex} from './model.js';
import {edited, page} from './page_state.js';

const COLORS = ['#7B3294', '#1B7837', '#8C510A', '#C51B7D', '#01665E', '#4D4D4D'];

// [[degrees, value]...] of a factor: the mean of these tables, and of a ring of nodes its mean.
export function pointsOf(axis, factor, tables) {
  const mean = e => tables.reduce((sum, table) => sum + table[e], 0) / tables.length;
  const ofRing = a => Array.from({length: axis.phis}, (_, b) => mean(a * axis.phis + b)).reduce((x, y) => x + y, 0) / axis.phis;
  return axis.phis > 0 ? axis.theta.map((theta, a) => [theta, ofRing(a)])
    : Array.from(tables[0], (_, e) => [90 * ((e + 0.5) / axis.size) ** (factor === 'D' ? 2 : 1), mean(e)]);
}

// `name`: of its file; one that all models have says less than what was fitted.
export function keepModel(file, model, mark = '') {
  const name = (file === 'model.json' && model.json.fit?.source || file) + mark;
  const names = page.kept.map(kept => kept.name);
  let own = name;
  for (let k = 2; names.includes(own); ++k) own = `${name} ${k}`;
  const free = COLORS.findIndex(color => page.kept.every(kept => kept.color !== color));
  page.kept.push({name: own, model, evaluate: evaluatorOf(model), color: COLORS[Math.max(free, 0)], albedo: []});
  showKept();
}

function showKept() {
  page.chartsStale = true;
  byId('kept').replaceChildren(...page.kept.map(kept => {
    const button = element('button', {type: 'button', textContent: 'remove', ariaLabel: `Remove ${kept.name} from the charts`});
    button.addEventListener('click', () => {
      page.kept = page.kept.filter(other => other !== kept);
      showKept();
    });
    return element('span', {className: 'chip'}, swatch(kept.color), kept.name, button);
  }));
  byId('kept').hidden = page.kept.length === 0;
}

// A line each, of the mean of channels.
const lineOf = ({name, color}, points) => ({label: `${name}, mean`, key: name, color, width: 1.4, dash: [5, 2], points});

// Their curves of a factor, of all lobes or that of the number `lobe`.
export function keptCurves(factor, lobe = '') {
  return page.kept.flatMap(kept => {
    const {model, name} = kept, {per_lobe: perLobe, per_channel: perChannel} = model.sharing[factor];
    const lobes = model.s.map((_, m) => m).filter(m => (perLobe ? lobe === '' || Number(lobe) === m : m === 0));
    return lobes.map((m, k) => {
      const tables = (perChannel ? [0, 1, 2] : [0]).map(c => model.tables[factor][tableIndex(model.sharing[factor], m, c)]);
      return {...lineOf(kept, pointsOf(model.axes[factor], factor, tables)), label: perLobe ? `${name}: lobe ${m + 1}` : name, key: k === 0 ? name : null};
    });
  });
}

const mean = rgb => (rgb[0] + rgb[1] + rgb[2]) / 3;
export const keptSlices = (wi, rows) => page.kept.map(kept => lineOf(kept, rows.map(([degrees, wo]) => [degrees, mean(kept.evaluate(wi, wo).rho)])));
export const keptAlbedos = () => page.kept.filter(({albedo}) => albedo.length > 1)
  .map(kept => lineOf(kept, kept.albedo.map(({degrees, fitted}) => [degrees, mean(fitted)])));

export function listenToKept() {
  byId('keep').addEventListener('click', () => {
    keepModel(page.modelFile.name, page.model, edited() ? ', edited' : '');
    tell('Kept in the charts; open or change another model to see both.', true);
  });
}
