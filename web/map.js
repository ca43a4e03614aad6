// The map of where fitted and measured values differ, for all phi_d or one.

import {HARDLY_SEEN, differenceMap, differencePoints, differenceWords} from './difference.js';
import {DEGREES, byId, download, isDark} from './dom.js';
import {hasMeasured, hasSamples, modelFileName, ownWord, page, state} from './page_state.js';
import {drawHeat, drawScale} from './plots.js';

const SCALE = [-33, -20, -10, 0, 10, 25, 50];  // percent

function mapOf(phiD, like) {
  const {measured} = page;
  if (hasSamples()) return differencePoints(measured, page.evaluate, phiD);
  const size = measured.kind === 'nodes' ? 20 : Math.min(45, ...measured.shape.slice(0, 2));
  return differenceMap(measured, page.evaluate, {size, phiD, like});
}

export function drawMap(at) {
  if (!hasMeasured()) return;
  page.heat ??= mapOf(null, null);
  if (state.phiD === null) page.heatAt = null;
  else if (page.heatAt?.phiD !== state.phiD) page.heatAt = {...mapOf(state.phiD, page.heat), phiD: state.phiD};
  const heat = page.heatAt ?? page.heat;
  for (const id of ['heat-csv', 'heat-png']) byId(id).disabled = false;
  drawHeat(byId('heat'), heat, at ? [at.theta_h * DEGREES, at.theta_d * DEGREES] : null, isDark());
  drawScale(byId('heat-scale'), SCALE, isDark());
  const hatched = heat.hardlySeen?.includes(1) ?? false, words = differenceWords(heat, hatched, ownWord());
  byId('typical').textContent = words;
  byId('hardly-seen').hidden = !hatched;
  byId('hardly-share').textContent = `${100 * HARDLY_SEEN} %`;
  byId('unmeasured-key').hidden = !heat.ratio?.some(Number.isNaN);
  byId('map-of').textContent = `${hasSamples() ? 'each sample a point' : 'for all directions'}${state.phiD === null ? '' : `, φd ${state.phiD}°`}:`;
  byId('phi-d').textContent = state.phiD === null ? 'all' : `${state.phiD}°`;
  byId('heat').ariaLabel = `${byId('map-what').textContent}, over θh and θd. ${words}`;
}

// Rows of theta_h, theta_d [degrees] and fitted over measured, at the middles of bins or at samples.
function mapCsv({size, ratio, points}) {
  const rows = points?.map(p => [p.theta_h * DEGREES, p.theta_d * DEGREES, Math.exp(p.log)]) ??
    Array.from(ratio, (log, k) => [90 * ((Math.floor(k / size) + 0.5) / size) ** 2, 90 * ((k % size + 0.5) / size), Math.exp(log)]);
  const text = rows.filter(row => Number.isFinite(row[2])).map(row => row.map(x => +x.toPrecision(5)).join(','));
  return ['theta_h_deg,theta_d_deg,fitted_over_measured', ...text].join('\n') + '\n';
}

export function listenToMap() {
  const change = () => {
    const one = byId('one-phi-d').checked;
    byId('phi-d-slider').disabled = !one;
    state.phiD = one ? Number(byId('phi-d-slider').value) : null;
    page.chartsStale = true;
  };
  byId('one-phi-d').checked = state.phiD !== null;
  byId('phi-d-slider').disabled = state.phiD === null;
  byId('phi-d-slider').value = state.phiD ?? 90;
  byId('one-phi-d').addEventListener('change', change);
  byId('phi-d-slider').addEventListener('input', change);
  byId('heat-csv').addEventListener('click', () => download(mapCsv(page.heatAt ?? page.heat), 'text/csv', `${modelFileName()}_map.csv`));
  byId('heat-png').addEventListener('click', () => byId('heat').toBlob(blob => download(blob, 'image/png', `${modelFileName()}_map.png`)));
}
