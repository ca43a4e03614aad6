// The numbers under the pointer.

import {DEGREES, byId, element, short, shortAngle} from './dom.js';
import {halfCells} from './environment.js';
import {anglesOf} from './model.js';
import {hasMeasured, hasSamples, lightDirection, page, state} from './page_state.js';
import {nearestSample} from './samples.js';

const NEAR = 7.5;  // degrees from a sample within which it is told, as trilobe/model/measurement/measured_share.h has it

const cells = halfCells();
export function albedo(theta) {
  const wo = [Math.sin(theta), 0, Math.cos(theta)], sum = [0, 0, 0];
  for (let k = 0; k < cells.length; k += 4) {
    const h = [cells[k], cells[k + 1], cells[k + 2]], along = wo[0] * h[0] + wo[2] * h[2];
    const wi = h.map((x, a) => 2 * along * x - wo[a]);
    if (!(along > 0 && wi[2] > 0)) continue;
    const {rho} = page.evaluate(wi, wo);
    for (let c = 0; c < 3; ++c) sum[c] += rho[c] * wi[2] * 4 * along * cells[k + 3];
  }
  return sum;
}

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

// Again, after the light, the object or a file has changed.
export function lookAgain() {
  if (page.point) lookAt(page.point.at);
  else showNumbers();
}

// What was measured there: {title, rho, at}, rho null if nothing was, `at` the directions of the nearest sample.
function measuredAt(point) {
  if (!hasSamples()) return {title: 'ρ measured', rho: point && page.measured.rho(point.wi, point.wo)};
  const nearest = point && nearestSample(page.measured, point.wi, point.wo);
  if (!nearest || nearest.degrees > NEAR) return {title: 'ρ measured', rho: null, why: point ? `no sample within ${NEAR}°` : ''};
  return {title: `ρ measured ${shortAngle(nearest.degrees)} away`, rho: nearest.sample.rho, at: nearest.sample};
}

const rowOf = (title, ...values) => element('tr', {}, element('th', {textContent: title, scope: 'row'}),
                                            ...values.map(v => element('td', {textContent: v})));
function wideRow(title, value) {
  const row = rowOf(title, value);
  row.lastChild.colSpan = 3;
  return row;
}

export function showNumbers() {
  const {point} = page, lit = point?.lit ? point : null, at = lit?.angles;
  if (point) byId('readout').classList.remove('empty');
  byId('point-hint').textContent = !point ? 'Point at the object.' : point.lit
    ? `Light: the ${state.light === 'lamp' ? 'lamp' : 'brightest of the environment'}.` : 'In the shade of the light.';
  const angle = x => shortAngle(x * DEGREES);
  const rows = [];
  rows.push(wideRow('angles', at ? `θh ${angle(at.theta_h)}, θd ${angle(at.theta_d)}, θi ${angle(at.theta_i)}, θo ${angle(at.theta_o)}` : '–'));
  rows.push(rowOf('1/sr', 'R', 'G', 'B'));
  const fitted = lit ? page.evaluate(lit.wi, lit.wo).rho : null, none = [NaN, NaN, NaN];
  if (hasMeasured()) {
    const {title, rho, at: there, why} = measuredAt(lit);
    rows.push(rho ? rowOf(title, ...rho.map(short)) : wideRow(title, lit ? why ?? 'not measured' : '–'));
    if (there) rows.push(rowOf('ρ fitted there', ...page.evaluate(there.wi, there.wo).rho.map(short)));
  }
  rows.push(rowOf('ρ fitted', ...(fitted ?? none).map(short)));
  const white = at ? albedo(at.theta_o) : none;
  rows.push(rowOf('albedo at θo', ...white.map(x => (Number.isFinite(x) ? x.toFixed(3) : '–'))));
  const mean = white.reduce((a, b) => a + b, 0);
  rows.push(wideRow('pdf of wi', fitted && mean > 0 ? `${short((fitted.reduce((a, b) => a + b, 0) * lit.wi[2]) / mean)} /sr` : '–'));
  byId('numbers').replaceChildren(...rows);
  announce();
}

// The same as one sentence for those who hear the page, once the pointer rests.
let timer = 0;
function announce() {
  clearTimeout(timer);
  if (!page.point) return;
  timer = setTimeout(() => {
    byId('heard').textContent = Array.from(byId('numbers').rows, row => Array.from(row.cells, c => c.textContent).join(' ')).join('; ');
  }, 600);
}
