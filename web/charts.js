// The charts: what of the model and the measurement they draw.

import {HARDLY_SEEN, differenceMap, differencePoints, differenceWords} from './difference.js';
import {DEGREES, byId, element, isDark, pageColor, short, swatch} from './dom.js';
import {FACTORS, tableIndex} from './model.js';
import {contents, hasMeasured, hasSamples, lobeColor, page, state} from './page_state.js';
import {CHANNEL_COLORS, drawDisc, drawHeat, drawLines, drawPolar} from './plots.js';
import {samplesInPlane} from './samples.js';

const ROOT_TICKS = [0, 2, 10, 30, 60, 90].map(v => [v, `${v}°`]);
const TICKS = [0, 30, 60, 90].map(v => [v, `${v}°`]);
const CHANNEL_NAMES = ['red', 'green', 'blue'];
const MEASURED_COLOR = '#e5674a';

// The largest angle that was measured [degrees], 90 if nothing says less.
export function maxAngle() {
  if (page.measured?.maxTheta) return page.measured.maxTheta * DEGREES;
  return hasMeasured() ? 90 : page.base.json.fit?.max_angle ?? 90;
}

function mixed(a, b) {
  const parse = hex => [1, 3, 5].map(at => parseInt(hex.slice(at, at + 2), 16));
  const [x, y] = [parse(a), parse(b)];
  return '#' + x.map((v, k) => Math.round((v + y[k]) / 2).toString(16).padStart(2, '0')).join('');
}

// One curve a table of a factor that is shown: {label, color, points: [[degrees, value]...], unknown: a set of entries
// that no data told}.
function curvesOf(factor) {
  const {model} = page, axis = model.axes[factor], sharing = model.sharing[factor];
  const wanted = byId('chart-channel').value, curves = new Map();
  for (let m = 0; m < model.lobes; ++m) {
    for (let c = 0; c < 3; ++c) {
      const t = tableIndex(sharing, m, c);
      if (!state.edit.lobes[m].on || curves.has(t) || (sharing.per_channel && wanted !== '' && Number(wanted) !== c)) continue;
      const lobe = sharing.per_lobe ? lobeColor(m) : null, channel = sharing.per_channel ? CHANNEL_COLORS[c] : null;
      const table = model.tables[factor][t], ofRing = a => table.subarray(a * axis.phis, (a + 1) * axis.phis);
      curves.set(t, {
        label: [lobe && `lobe ${m + 1}`, channel && CHANNEL_NAMES[c]].filter(Boolean).join(', ') || 'all',
        color: lobe && channel ? mixed(lobe, channel) : lobe ?? channel ?? '#888888',
        points: axis.phis > 0 ? axis.theta.map((theta, a) => [theta, ofRing(a).reduce((x, y) => x + y, 0) / axis.phis])
                              : Array.from(table, (v, e) => [90 * ((e + 0.5) / axis.size) ** (factor === 'D' ? 2 : 1), v]),
        unknown: new Set(axis.phis > 0 ? [] : (model.json.unobserved ?? model.json.dead)?.[factor]?.[t] ?? []),
      });
    }
  }
  return [...curves.values()];
}

// What no data told is dotted, as in factors.png.
function seriesOf({points, color, unknown}) {
  const dotted = e => unknown.has(e) || unknown.has(e - 1) || unknown.has(e + 1);
  const some = keep => points.map(([x, y], e) => [x, keep(e) ? y : NaN]);
  return [{points: some(e => !unknown.has(e)), color, width: 2}, ...(unknown.size > 0 ? [{points: some(dotted), color, width: 1, dash: [1, 3]}] : [])];
}

function drawFactor(factor, x, y, marks) {
  const curves = curvesOf(factor), canvas = byId(`chart-${factor.toLowerCase()}`);
  const known = factor === 'G' ? maxAngle() : Infinity;
  drawLines(canvas, {series: curves.flatMap(seriesOf), x, y, marks, known});
  const figure = canvas.closest('figure');
  const legend = curves.length > 1 || curves[0]?.label !== 'all' ? curves : [];
  figure.querySelector('.legend').replaceChildren(...legend.map(({label, color}) => element('span', {className: 'key'}, swatch(color), label)),
    ...(curves.some(curve => curve.unknown.size > 0) ? [element('span', {className: 'key', textContent: '··· no data'})] : []));
  const at = ({points}, k) => `${short(points[k][1])} at ${short(points[k][0])}°`;
  canvas.ariaLabel = `${factor} over ${{D: 'θh', F: 'θd', G: 'θ'}[factor]}. ` + curves.map(curve => {
    const last = curve.points.length - 1;
    return `${curve.label}: ${[0, Math.round(last / 2), last].map(k => at(curve, k)).join(', ')}`;
  }).join('; ');
}

export function drawCharts() {
  page.chartsStale = false;
  const {model, measured} = page, at = page.point?.angles;
  const marks = list => (at ? list.map(([key, text]) => ({x: at[key] * DEGREES, text})) : []);
  const straight = {min: 0, max: 90, ticks: TICKS};
  if (model.lobes > 0) {
    byId('channel-row').hidden = !FACTORS.some(f => model.sharing[f].per_lobe && model.sharing[f].per_channel);
    drawFactor('D', {min: 0, max: 90, ticks: ROOT_TICKS, map: v => Math.sqrt(v)}, {log: true, decades: 7}, marks([['theta_h', 'θh']]));
    drawFactor('F', straight, {min: 0}, marks([['theta_d', 'θd']]));
    drawFactor('G', straight, {min: 0}, marks([['theta_i', 'θi'], ['theta_o', 'θo']]));
    if (model.axes.D.phis > 1) {
      const m = Number(byId('disc-lobe').value || 0);
      drawDisc(byId('disc'), model.tables.D[tableIndex(model.sharing.D, m, 0)], model.axes.D, lobeColor(m),
               at ? [at.theta_h * DEGREES, Math.atan2(at.h[1], at.h[0])] : null);
    }
  }
  drawPolarChart();
  if (hasMeasured()) {
    page.heat ??= hasSamples() ? differencePoints(measured, page.evaluate)
      : differenceMap(measured, page.evaluate, measured.kind === 'table' ? Math.min(45, ...measured.shape.slice(0, 2)) : 20);
    drawDifference(page.heat, at ? [at.theta_h * DEGREES, at.theta_d * DEGREES] : null);
  }
  drawTrace();
}

function drawDifference(heat, mark) {
  drawHeat(byId('heat'), heat, mark, isDark());
  const hatched = heat.hardlySeen?.includes(1) ?? false, words = differenceWords(heat, hatched);
  byId('typical').textContent = words;
  byId('hardly-seen').hidden = !hatched;
  byId('hardly-share').textContent = `${100 * HARDLY_SEEN} %`;
  byId('unmeasured-key').hidden = !heat.ratio?.some(Number.isNaN);
  byId('map-of').textContent = hasSamples() ? 'each sample a point:' : 'for all directions:';
  byId('heat').ariaLabel = `Fitted over measured, over θh and θd. ${words}`;
}

function drawTrace() {
  const {trace} = contents;
  if (byId('trace-figure').hidden) return;
  const last = trace.at(-1)[0], step = Math.max(1, Math.ceil(last / 5));
  const ticks = Array.from({length: Math.floor(last / step) + 1}, (_, k) => [k * step, String(k * step)]);
  if (ticks.at(-1)[0] !== last) ticks.push([last, '']);
  drawLines(byId('trace'), {series: [{points: trace.map(([k, , e]) => [k, e]), color: pageColor('--accent'), width: 2}],
                            x: {min: 0, max: last, ticks}, y: {log: true}});
  byId('trace').ariaLabel = `Error over iterations, from ${short(trace[0][2])} to ${short(trace.at(-1)[2])} after ${last}`;
}

function drawPolarChart() {
  const {model, measured} = page, theta = state.thetaI / DEGREES, wi = [-Math.sin(theta), 0, Math.cos(theta)];
  const fitted = [], ofLobe = model.s.map(() => []), mean = (rgb, cosine) => ((rgb[0] + rgb[1] + rgb[2]) / 3) * cosine;
  const outgoing = degrees => [Math.sin(degrees / DEGREES), 0, Math.cos(degrees / DEGREES)];
  for (let degrees = -89; degrees <= 89; ++degrees) {
    const wo = outgoing(degrees), value = page.evaluate(wi, wo);
    fitted.push([degrees, mean(value.rho, wo[2])]);
    value.lobes.forEach((rgb, m) => ofLobe[m].push([degrees, mean(rgb, wo[2])]));
  }
  const dots = [], known = new Set();
  for (let degrees = -89; degrees <= 89; degrees += 2) {
    const rho = hasMeasured() && !hasSamples() ? measured.rho(wi, outgoing(degrees)) : null;
    if (rho) dots.push([degrees, mean(rho, outgoing(degrees)[2])]);
    if (rho || (!(hasMeasured() && !hasSamples()) && Math.max(Math.abs(degrees), state.thetaI) <= maxAngle())) known.add(degrees);
  }
  if (hasSamples()) dots.push(...samplesInPlane(measured, theta).map(([degrees, rho]) => [degrees, mean(rho, Math.cos(degrees / DEGREES))]));
  drawPolar(byId('polar'), [
    ...ofLobe.map((values, m) => ({values, color: lobeColor(m), width: 1.2})).filter((_, m) => state.edit.lobes[m].on),
    {values: fitted, color: pageColor('--text'), width: 2}, {values: dots, color: MEASURED_COLOR, dots: true}],
    state.thetaI, degrees => known.has(degrees));
  byId('polar-angle').textContent = `${Math.round(state.thetaI)}°`;
  byId('polar-measured').hidden = dots.length === 0;
  byId('polar-none').hidden = !hasMeasured() || dots.length > 0;
  const brightest = fitted.reduce((a, b) => (b[1] > a[1] ? b : a));
  byId('polar').ariaLabel = `Reflected light in the plane of incidence, light from ${Math.round(state.thetaI)}°: ` +
    `most at ${brightest[0]}°, mean ρ cos θo ${short(brightest[1])} /sr; ${dots.length} measured values`;
}
