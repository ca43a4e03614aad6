// Charts of the model's parts: curves of D, F and G, by lobe and channel.

import {DEGREES, byId, element, pageColor, short} from './dom.js';
import {keptCurves, pointsOf} from './kept.js';
import {drawLight} from './light_charts.js';
import {drawMap} from './map.js';
import {FACTORS, tableIndex} from './model.js';
import {contents, lobeColor, maxAngle, page, state} from './page_state.js';
import {CHANNEL_COLORS, CHANNEL_NAMES, drawDisc} from './plots.js';
import {chartOf} from './state_chart.js';

const ROOT_TICKS = [0, 2, 10, 30, 60, 90].map(v => [v, `${v}°`]);
const TICKS = [0, 30, 60, 90].map(v => [v, `${v}°`]);
const CHANNEL_DASHES = [[], [6, 3], [2, 2]];

const charts = {
  D: chartOf('D', 'chart-d', 'D', ['theta_h_deg', 'D_per_sr'], 'θh'),
  F: chartOf('F', 'chart-f', 'F', ['theta_d_deg', 'F'], 'θd'),
  G: chartOf('G', 'chart-g', 'G', ['theta_deg', 'G'], 'θ'),
  trace: chartOf('trace', 'trace', 'trace', ['iteration', 'E'], 'iteration', ''),
};

// ---- Choices -----------------------------------------------------------------------------------------------------

// Fills the choices for a model. A table for each lobe and channel has too many curves for one chart, so that it begins
// with means.
export function makeChartChoices() {
  const {base} = page, many = FACTORS.some(f => base.sharing[f].per_lobe && base.sharing[f].per_channel) && base.lobes > 1;
  const fill = (id, options) => byId(id).replaceChildren(...options.map(([value, textContent]) => element('option', {value, textContent})));
  fill('chart-lobe', [['', 'all lobes'], ...base.s.map((_, m) => [m, `lobe ${m + 1}`])]);
  fill('chart-channel', [['mean', 'mean of channels'], ['each', 'each channel'], ...CHANNEL_NAMES.map((name, c) => [c, name])]);
  byId('chart-channel').value = many ? 'mean' : 'each';
  byId('lobe-row').hidden = base.lobes < 2;
  byId('channel-row').hidden = !FACTORS.some(f => base.sharing[f].per_channel);
}

// The tables of a factor that one curve is of: [[lobe, channel...]...].
function chosen(factor) {
  const {per_lobe: perLobe, per_channel: perChannel} = page.model.sharing[factor];
  const lobe = byId('chart-lobe').value, channel = byId('chart-channel').value;
  const on = page.model.s.map((_, m) => m).filter(m => state.edit.lobes[m].on && (lobe === '' || Number(lobe) === m));
  const channels = !perChannel ? [[0]] : channel === 'mean' ? [[0, 1, 2]] : channel === 'each' ? [[0], [1], [2]] : [[Number(channel)]];
  return (perLobe ? on : on.slice(0, 1)).flatMap(m => channels.map(list => [m, ...list]));
}

// Lobes have their colours, and channels where there is one lobe; where there are both, channels are dashed.
function styleOfCurve(factor, m, channels) {
  const {per_lobe: perLobe, per_channel: perChannel} = page.model.sharing[factor];
  const channel = perChannel && channels.length === 1 ? channels[0] : null;
  const manyLobes = perLobe && byId('chart-lobe').value === '';
  const words = [perLobe && `lobe ${m + 1}`, channel !== null && CHANNEL_NAMES[channel]].filter(Boolean);
  return {
    label: words.join(', ') || (perChannel ? 'mean of channels' : 'all'),
    color: channel !== null && !manyLobes ? CHANNEL_COLORS[channel] : perLobe ? lobeColor(m) : '#888888',
    dash: channel !== null && manyLobes && byId('chart-channel').value === 'each' ? CHANNEL_DASHES[channel] : [],
  };
}

function curvesOf(factor) {
  const {model} = page, axis = model.axes[factor];
  return chosen(factor).map(([m, ...channels]) => {
    const numbers = channels.map(c => tableIndex(model.sharing[factor], m, c)), tables = numbers.map(t => model.tables[factor][t]);
    const untold = numbers.map(t => new Set((model.json.unobserved ?? model.json.dead)?.[factor]?.[t] ?? []));
    return {
      ...styleOfCurve(factor, m, channels),
      points: pointsOf(axis, factor, tables),
      unknown: new Set(axis.phis > 0 ? [] : [...untold[0]].filter(e => untold.every(set => set.has(e)))),
    };
  });
}

// Whether a few values are so far above the others that nothing else would be seen.
function isSpread(series) {
  const values = series.flatMap(s => s.points.map(p => p[1])).sort((a, b) => a - b);
  return values.at(-1) > 100 * values[values.length >> 1];
}

// ---- Drawing -----------------------------------------------------------------------------------------------------

function drawFactor(factor, x, marks) {
  const series = [...curvesOf(factor), ...keptCurves(factor, byId('chart-lobe').value)], known = factor === 'G' ? maxAngle() : Infinity, log = state.log[factor] ?? isSpread(series);
  charts[factor].draw({series, x, y: log ? {log, decades: 7} : {min: 0}, marks, known});
  const at = ({points}, k) => `${short(points[k][1])} at ${short(points[k][0])}°`;
  byId(`chart-${factor.toLowerCase()}`).ariaLabel = `${factor} over ${{D: 'θh', F: 'θd', G: 'θ'}[factor]}. ` + series.map(curve => {
    const last = curve.points.length - 1;
    return `${curve.label}: ${[0, Math.round(last / 2), last].map(k => at(curve, k)).join(', ')}`;
  }).join('; ') + '. Arrows read values.';
}

export function drawCharts() {
  page.chartsStale = false;
  const {model} = page, at = page.point?.angles;
  const marks = list => (at ? list.map(([key, text]) => ({x: at[key] * DEGREES, text})) : []);
  const straight = {min: 0, max: 90, ticks: TICKS};
  if (model.lobes > 0) {
    drawFactor('D', {min: 0, max: 90, ticks: ROOT_TICKS, power: 0.5}, marks([['theta_h', 'θh']]));
    drawFactor('F', straight, marks([['theta_d', 'θd']]));
    drawFactor('G', straight, marks([['theta_i', 'θi'], ['theta_o', 'θo']]));
    if (model.axes.D.phis > 1) {
      const m = Number(byId('disc-lobe').value || 0);
      const [low, high] = drawDisc(byId('disc'), model.tables.D[tableIndex(model.sharing.D, m, 0)], model.axes.D, lobeColor(m),
                                   at ? [at.theta_h * DEGREES, Math.atan2(at.h[1], at.h[0])] : null);
      byId('disc-range').textContent = `D from ${short(low)} (dark) to ${short(high)} /sr (light), in equal ratios; θh from 0° in the middle to 90°`;
    }
  }
  drawLight();
  drawMap(at);
  drawTrace();
}

function drawTrace() {
  const {trace} = contents;
  if (byId('trace-figure').hidden) return;
  const last = trace.at(-1)[0], step = Math.max(1, Math.ceil(last / 5));
  const ticks = Array.from({length: Math.floor(last / step) + 1}, (_, k) => [k * step, String(k * step)]);
  charts.trace.draw({series: [{label: 'E', points: trace.map(([k, , e]) => [k, e]), color: pageColor('--accent')}],
                     x: {min: 0, max: last, ticks}, y: {log: state.log.trace}});
  byId('trace').ariaLabel = `Error over iterations, from ${short(trace[0][2])} to ${short(trace.at(-1)[2])} after ${last}`;
}
