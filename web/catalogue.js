// Many fits on one page: sorted, filtered by name, and up to four of them side by side.

import {drawCompared} from './catalogue_compare.js';
import {element} from './dom.js';

const fits = JSON.parse(document.getElementById('data').textContent);
const figures = Array.from(document.querySelectorAll('main figure'));
const main = document.querySelector('main');

// How they can be ordered: by numbers, the first first.
const ORDERS = [
  ['PSNR, worst first', f => f.psnr_db],
  ['PSNR, best first', f => -f.psnr_db],
  ['ΔE, largest first', f => -f.delta_e],
  ['size, smallest first', f => f.parameters],
  ['anisotropic first', f => -f.anisotropic],
  ['time, longest first', f => -f.seconds],
  ['name', null],
];

const order = element('select', {}, ...ORDERS.map(([text], k) => element('option', {value: k, textContent: text})));
const filter = element('input', {type: 'search', placeholder: 'Filter by name', ariaLabel: 'Filter by name'});
const count = element('output', {});
const compared = element('section', {id: 'compared', ariaLabel: 'Compared'});
const tools = element('div', {className: 'tools'}, filter, element('label', {}, 'Order ', order), count);

function arrange() {
  const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
  const by = ORDERS[order.value][1];
  const sorted = figures.map((figure, k) => ({figure, k, fit: fits[k]}));
  sorted.sort((a, b) => (by ? by(a.fit) - by(b.fit) : 0) || a.fit.name.localeCompare(b.fit.name));
  let shown = 0;
  for (const {figure, fit} of sorted) {
    figure.hidden = !words.every(word => fit.name.toLowerCase().includes(word));
    if (!figure.hidden) ++shown;
  }
  main.replaceChildren(...sorted.map(({figure}) => figure));
  count.textContent = `${shown} of ${figures.length}`;
}

function compare() {
  const chosen = figures.filter(figure => figure.querySelector('input').checked);
  const copies = chosen.map(figure => {
    const copy = figure.cloneNode(true);
    copy.hidden = false;
    copy.querySelector('label').remove();
    return copy;
  });
  const common = element('p', {className: 'hint', textContent: 'Below each pair, its model under one light, with the exposure of the first, and how far it is from the first (white: not seen).'});
  const entries = chosen.map((figure, k) => ({...fits[figures.indexOf(figure)], figure: copies[k]})).filter(({model}) => model);
  compared.replaceChildren(...(entries.length > 1 ? [common] : []), ...copies);
  if (entries.length > 1) drawCompared(entries).catch(error => (common.textContent = `The models are not drawn under one light, as ${error.message}; above are the pictures of the fits.`));
  for (const figure of figures) {
    const box = figure.querySelector('input');
    box.disabled = chosen.length >= 4 && !box.checked;
  }
}

if (figures.length > 0) {
  figures.forEach((figure, k) => {
    const box = element('input', {type: 'checkbox', ariaLabel: `Compare ${fits[k].name}`});
    box.addEventListener('change', compare);
    figure.querySelector('figcaption').append(element('label', {}, box, ' compare'));
  });
  main.before(tools, compared);
  order.addEventListener('change', arrange);
  filter.addEventListener('input', arrange);
  arrange();
}

const root = document.documentElement;
function paint(theme) {
  root.dataset.theme = theme ?? (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
}
document.getElementById('theme').addEventListener('click', () => paint(root.dataset.theme === 'dark' ? 'light' : 'dark'));
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => paint());
paint();
window.catalogue = {order, filter, arrange};
