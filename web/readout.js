// The numbers under the pointer.

import {albedo} from './albedo.js';
import {DEGREES, byId, element, short, shortAngle} from './dom.js';
import {anglesOf} from './model.js';
import {hasMeasured, hasSamples, lightDirection, ownAdjective, page, referenceWord, state} from './page_state.js';
import {nearestSample} from './samples.js';
import {help} from './words.js';

const NEAR = 7.5;  // degrees from a sample within which it is told, as trilobe/model/measurement/measured_share.h has it

// At (x, y) of the object, from -1 to 1.
export function lookAt(at) {
  const surface = page.renderer.surfaceAt(at[0], at[1]);
  if (!surface) {
    page.point = null;
  } else {
    const {normal: n, tangent: x} = surface, y = [n[1] * x[2] - n[2] * x[1], n[2] * x[0] - n[0] * x[2], n[0] * x[1] - n[1] * x[0]];
    const local = w => [x, y, n].map(e => e[0] * w[0] + e[1] * w[1] + e[2] * w[2]);
    const wi = local(lightDirection()), wo = local([0, 0, 1]);
    page.point = {at, wi, wo, lit: wi[2] > 0, angles: wi[2] > 0 ? anglesOf(wi, wo) : null};
  }
  page.chartsStale = page.pictureStale = true;
  showNumbers();
}

// Repeats the readout after the light, the object or a file has changed.
export function lookAgain() {
  if (page.point) lookAt(page.point.at);
  else showNumbers();
}

// Measured value there: {title, rho, at}, rho null if nothing was measured, `at` the directions of the nearest sample.
function measuredAt(point) {
  if (!hasSamples()) return {title: `ρ ${referenceWord()}`, rho: point && page.measured.rho(point.wi, point.wo)};
  const nearest = point && nearestSample(page.measured, point.wi, point.wo);
  if (!nearest || nearest.degrees > NEAR) return {title: 'ρ measured', rho: null, why: point ? `no sample within ${NEAR}°` : ''};
  return {title: `ρ measured ${shortAngle(nearest.degrees)} away`, rho: nearest.sample.rho, at: nearest.sample};
}

const HELP = {angles: 'angles', '1/sr': 'rho', 'albedo at θo': 'albedo', 'pdf of wi': 'pdf'};

function headOf(title) {
  const head = element('th', {scope: 'row'}, title);
  if (HELP[title]) head.append(help(HELP[title]));
  return head;
}

// [title, values]: three of them, or one across.
function showRows(rows) {
  const body = byId('numbers'), titles = rows.map(([title]) => title).join();
  if (body.dataset.titles !== titles) {  // rows stay if they can, and so do explanations
    body.dataset.titles = titles;
    body.replaceChildren(...rows.map(([title]) => element('tr', {}, headOf(title))));
  }
  rows.forEach(([, values], k) => {
    const row = body.rows[k], list = Array.isArray(values) ? values : [values];
    while (row.cells.length > 1) row.lastChild.remove();
    row.append(...list.map(v => element('td', {textContent: v, colSpan: list.length === 1 ? 3 : 1})));
  });
}

export function showNumbers() {
  const {point} = page, lit = point?.lit ? point : null, at = lit?.angles;
  if (point) byId('readout').classList.remove('empty');
  byId('point-hint').textContent = !point ? 'Point at the object.' : point.lit
    ? `Light: the ${state.light === 'lamp' ? 'lamp' : 'brightest of the environment'}.` : 'In the shade of the light.';
  const angle = x => shortAngle(x * DEGREES);
  const fitted = lit ? page.evaluate(lit.wi, lit.wo).rho : null, none = [NaN, NaN, NaN];
  const rows = [['angles', at ? `θh ${angle(at.theta_h)}, θd ${angle(at.theta_d)}, θi ${angle(at.theta_i)}, θo ${angle(at.theta_o)}` : '–'],
                ['1/sr', ['R', 'G', 'B']]];
  if (hasMeasured()) {
    const {title, rho, at: there, why} = measuredAt(lit);
    rows.push([title, rho ? rho.map(short) : lit ? why ?? 'not measured' : '–']);
    if (there) rows.push([`ρ ${ownAdjective()} there`, page.evaluate(there.wi, there.wo).rho.map(short)]);
  }
  rows.push([`ρ ${ownAdjective()}`, (fitted ?? none).map(short)]);
  const white = at ? albedo(at.theta_o) : none, mean = white.reduce((a, b) => a + b, 0);
  rows.push(['albedo at θo', white.map(x => (Number.isFinite(x) ? x.toFixed(3) : '–'))]);
  rows.push(['pdf of wi', fitted && mean > 0 ? `${short((fitted.reduce((a, b) => a + b, 0) * lit.wi[2]) / mean)} /sr` : '–']);
  showRows(rows);
  announce();
}

// The same as one sentence for those who hear the page, once the pointer rests.
let timer = 0;
function announce() {
  clearTimeout(timer);
  if (!page.point) return;
  timer = setTimeout(() => {
    byId('heard').textContent = Array.from(byId('numbers').rows, row => [row.cells[0].firstChild.textContent, ...Array.from(row.cells).slice(1).map(c => c.textContent)].join(' ')).join('; ');
  }, 600);
}
