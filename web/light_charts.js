// Charts of light from one angle: where the material sends it in the plane of incidence, and how much in all.

import {ALBEDO_DEGREES} from './albedo.js';
import {DEGREES, byId, pageColor, short} from './dom.js';
import {keptAlbedos, keptSlices} from './kept.js';
import {hasMeasured, hasSamples, isMeasuredAnisotropic, lobeColor, maxAngle, page, referenceWord, state} from './page_state.js';
import {drawLobe} from './lobe.js';
import {CHANNEL_COLORS, CHANNEL_NAMES, drawPolar} from './plots.js';
import {samplesInPlane} from './samples.js';
import {chartOf} from './state_chart.js';

const MEASURED_COLOR = '#e5674a';
const PLANE_TICKS = [-90, -60, -30, 0, 30, 60, 90].map(v => [v, `${v < 0 ? '−' : ''}${Math.abs(v)}°`]);

const slice = chartOf('slice', 'slice', 'slice', ['theta_o_deg', 'rho_per_sr'], 'θo');
const albedoChart = chartOf('albedo', 'albedo', 'albedo', ['theta_deg', 'albedo'], 'θ');

// theta_o [degrees], positive on the side of the mirror direction; close around it, where peaks are.
function outgoingDegrees() {
  const near = [-4, -3, -2, -1.5, -1, -0.7, -0.5, -0.35, -0.2, -0.1, 0, 0.1, 0.2, 0.35, 0.5, 0.7, 1, 1.5, 2, 3, 4].map(x => state.thetaI + x);
  const all = [...Array.from({length: 90}, (_, k) => 2 * k - 89), ...near].filter(x => Math.abs(x) <= 89.5);
  return [...new Set(all)].sort((a, b) => a - b);
}
// In the plane that the page shows, which contains the normal; the light's own plane is turned by lightPhi about it.
function outgoing(degrees) {
  const sine = Math.sin(degrees / DEGREES), phi = (state.lightPhi + state.planePhi) / DEGREES;
  return [sine * Math.cos(phi), sine * Math.sin(phi), Math.cos(degrees / DEGREES)];
}
function incoming() {
  const theta = state.thetaI / DEGREES, phi = state.lightPhi / DEGREES;
  return [-Math.sin(theta) * Math.cos(phi), -Math.sin(theta) * Math.sin(phi), Math.cos(theta)];
}
const planeWord = () => (state.planePhi === 0 ? 'the plane of incidence' : `the plane at ${state.planePhi}° from that of incidence`);

// Curves of a channel each, fitted and measured: of rows [[degrees, rgb]...].
function channelSeries(fitted, measured) {
  const ofChannel = (rows, c) => ({color: CHANNEL_COLORS[c], points: rows.map(([degrees, rgb]) => [degrees, rgb[c]])});
  return [0, 1, 2].flatMap(c => [
    {label: CHANNEL_NAMES[c], ...ofChannel(fitted, c)},
    ...(measured.length > 0 ? [{label: `${referenceWord()}, ${CHANNEL_NAMES[c]}`, dots: true, key: c === 0 ? referenceWord() : null, ...ofChannel(measured, c)}] : []),
  ]);
}

// {fitted: [[degrees, {rho, lobes}]...], measured: [[degrees, rho]...], known: whether a direction was measured}.
function inPlane() {
  const {measured} = page, theta = state.thetaI / DEGREES, wi = incoming();
  const fitted = outgoingDegrees().map(degrees => [degrees, page.evaluate(wi, outgoing(degrees))]);
  if (hasSamples()) {
    return {fitted, measured: samplesInPlane(measured, theta, state.planePhi / DEGREES), known: degrees => Math.max(Math.abs(degrees), state.thetaI) <= maxAngle()};
  }
  const found = !hasMeasured() ? [] : Array.from({length: 90}, (_, k) => 2 * k - 89)
    .map(degrees => [degrees, measured.rho(wi, outgoing(degrees))]).filter(([, rho]) => rho);
  const angles = new Set(found.map(([degrees]) => degrees));
  return {fitted, measured: found, known: degrees => (hasMeasured() ? angles.has(degrees) : Math.max(Math.abs(degrees), state.thetaI) <= maxAngle())};
}

function drawSlice({fitted, measured}) {
  const kept = keptSlices(incoming(), fitted.map(([degrees]) => [degrees, outgoing(degrees)]));
  const series = [...channelSeries(fitted.map(([degrees, {rho}]) => [degrees, rho]), measured), ...kept];
  const log = state.log.slice, known = hasMeasured() && !hasSamples() ? Infinity : maxAngle();
  slice.draw({series, x: {min: -90, max: 90, ticks: PLANE_TICKS}, y: log ? {log, decades: 6} : {min: 0}, known: known < 90 ? known : Infinity,
              marks: state.planePhi === 0 ? [{x: state.thetaI, text: 'mirror'}] : []});
  const brightest = fitted.reduce((a, b) => (b[1].rho[1] > a[1].rho[1] ? b : a));
  byId('slice').ariaLabel = `ρ in ${planeWord()} over θo, light at ${Math.round(state.thetaI)}°: fitted most in green at ` +
    `${short(brightest[0])}°, ${short(brightest[1].rho[1])} /sr; ${measured.length} ${referenceWord()} values. Arrows read values.`;
}

function drawSide({fitted, measured, known}) {
  const mean = (rgb, degrees) => ((rgb[0] + rgb[1] + rgb[2]) / 3) * Math.cos(degrees / DEGREES);
  const whole = fitted.map(([degrees, {rho}]) => [degrees, mean(rho, degrees)]), dots = measured.map(([degrees, rho]) => [degrees, mean(rho, degrees)]);
  const ofLobe = page.model.s.map((_, m) => fitted.map(([degrees, {lobes}]) => [degrees, mean(lobes[m], degrees)]));
  drawPolar(byId('polar'), [
    ...ofLobe.map((values, m) => ({values, color: lobeColor(m), width: 1.2})).filter((_, m) => state.edit.lobes[m].on),
    {values: whole, color: pageColor('--text'), width: 2}, {values: dots, color: MEASURED_COLOR, dots: true}], state.thetaI, known);
  byId('polar-measured').hidden = dots.length === 0;
  byId('polar-word').textContent = referenceWord();
  const brightest = whole.reduce((a, b) => (b[1] > a[1] ? b : a));
  byId('polar').ariaLabel = `Reflected light in ${planeWord()}, light from ${Math.round(state.thetaI)}°: ` +
    `most at ${short(brightest[0])}°, mean ρ cos θo ${short(brightest[1])} /sr; ${dots.length} measured values`;
}

// Why the chart of albedos is not all that it could be, '' where it is.
function whyAlbedo(rows, measured) {
  if (rows.length < ALBEDO_DEGREES.length) return `Being summed: ${rows.length} of ${ALBEDO_DEGREES.length} angles.`;
  if (!hasMeasured() || measured.length === rows.length) return '';
  if (hasSamples()) return 'Of scattered samples no albedo can be summed.';
  return measured.length > 0 ? 'Dots end where more than a fifth of the light was not measured.'
    : 'No dots: at no angle were four fifths of the light measured.';
}

// As far as it is known.
export function drawAlbedo() {
  const rows = page.albedo ?? [], measured = rows.filter(row => row.measured);
  byId('albedo-why').textContent = whyAlbedo(rows, measured);
  if (rows.length < 2) return;
  const series = [...channelSeries(rows.map(row => [row.degrees, row.fitted]), measured.map(row => [row.degrees, row.measured])), ...keptAlbedos()];
  const high = Math.max(1.02, ...series.flatMap(s => s.points.map(p => p[1]))), log = state.log.albedo;
  albedoChart.draw({series, x: {min: 0, max: 90, ticks: [0, 30, 60, 90].map(v => [v, `${v}°`])}, y: log ? {log, max: high} : {min: 0, max: high},
                    known: maxAngle(), lines: [{y: 1}], marks: page.point?.angles ? [{x: page.point.angles.theta_o * DEGREES, text: 'θo'}] : []});
  const most = rows.reduce((a, b) => (Math.max(...b.fitted) > Math.max(...a.fitted) ? b : a));
  byId('albedo').ariaLabel = `Albedo over θ: fitted at most ${short(Math.max(...most.fitted))}, at ${most.degrees}°; ` +
    `${measured.length} ${referenceWord()} angles. Arrows read values.`;
}

export function drawLight() {
  const plane = inPlane();
  byId('plane-angle').textContent = `${Math.round(state.thetaI)}°`;
  byId('plane-phi-angle').textContent = `${state.planePhi}°`;
  byId('light-phi-angle').textContent = `${state.lightPhi}°`;
  byId('light-phi-row').hidden = !page.model.anisotropic && !isMeasuredAnisotropic();
  for (const place of document.querySelectorAll('.plane-word')) place.textContent = planeWord();
  byId('plane-none').hidden = !hasMeasured() || plane.measured.length > 0;
  drawSide(plane);
  drawSlice(plane);
  drawLobe();
  drawAlbedo();
}
