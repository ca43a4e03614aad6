// A measurement of scattered samples, on no grid: as the page holds it, or of a CSV file.
// {kind: 'samples', samples: [{wi, wo, rho, theta_i, theta_o, between}], count, maxTheta, anisotropic}; angles [rad],
// `between` that of the azimuths, 0 to pi.

import {DEGREE} from './environment.js';
import {anglesOf} from './model.js';
import {bytesOf, directionsOf, tableMeasured} from './measured.js';

const MOST_SAMPLES = 40000;  // that are kept, as in src/io/pictures/page.h

function sampleOf([thetaI, phiI, thetaO, phiO, ...rho]) {
  const direction = (theta, phi) => [Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta)];
  const between = Math.abs(phiO - phiI) % (2 * Math.PI);
  return {wi: direction(thetaI, phiI), wo: direction(thetaO, phiO), rho, theta_i: thetaI, theta_o: thetaO,
          between: Math.min(between, 2 * Math.PI - between)};
}

function samplesMeasured(samples, count, maxTheta, anisotropic) {
  return {kind: 'samples', samples, count, maxTheta, anisotropic, rho: () => null};
}

export function decodeSamples(header) {
  const numbers = new DataView(bytesOf(header.data).buffer);
  const samples = Array.from({length: header.shape[0]}, (_, k) => {
    const row = Array.from({length: 7}, (_, n) => numbers.getFloat32(28 * k + 4 * n, true));
    return sampleOf([...row.slice(0, 4).map(x => x * DEGREE), ...row.slice(4)]);
  });
  return samplesMeasured(samples, header.samples, header.max_theta, header.anisotropic);
}

// Both directions of an isotropic material with light at the azimuth 0.
function turnedToLight(wi, wo) {
  const s = Math.hypot(wi[0], wi[1]), t = Math.hypot(wo[0], wo[1]), c = s * t > 1e-12 ? (wi[0] * wo[0] + wi[1] * wo[1]) / (s * t) : 1;
  return [[s, 0, wi[2]], [t * c, t * Math.sqrt(Math.max(1 - c * c, 0)), wo[2]]];
}

// The nearest sample by {degrees, sample}: the larger angle of the two directions, also with light and eye exchanged.
export function nearestSample({samples, anisotropic}, wi, wo) {
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const of = (a, b) => (anisotropic ? [a, b] : turnedToLight(a, b));
  const [given, exchanged] = [of(wi, wo), of(wo, wi)];
  let best = null, most = -1;
  for (const sample of samples) {
    sample.turned ??= of(sample.wi, sample.wo);
    const [i, o] = sample.turned;
    const near = Math.max(Math.min(dot(given[0], i), dot(given[1], o)), Math.min(dot(exchanged[0], i), dot(exchanged[1], o)));
    if (near > most) [most, best] = [near, sample];
  }
  return best && {degrees: Math.acos(Math.min(most, 1)) / DEGREE, sample: best};
}

// Samples with the light at `thetaI` [rad] in the plane that is turned by `phi` [rad] from that of incidence, to either
// side: [[theta_o, rho]...], theta_o [degrees] positive on the side of the mirror direction. `within` [rad] of both.
export function samplesInPlane({samples}, thetaI, phi = 0, within = 2 * DEGREE) {
  const found = [], turned = phi <= Math.PI / 2 ? phi : Math.PI - phi, forward = phi <= Math.PI / 2;
  for (const {theta_i, theta_o, between, rho} of samples) {
    for (const [i, o] of theta_i === theta_o ? [[theta_i, theta_o]] : [[theta_i, theta_o], [theta_o, theta_i]]) {
      const mirrored = between > Math.PI / 2, off = Math.abs((mirrored ? Math.PI - between : between) - turned);
      if (Math.abs(i - thetaI) > within || Math.sin(o) * Math.sin(off) > Math.sin(within)) continue;
      found.push([(mirrored === forward ? o : -o) / DEGREE, rho]);
    }
  }
  return found;
}

// The angle of light [whole degrees] with most samples in its plane, nearest to 45 among equals.
export function usualThetaI(measured) {
  const angles = new Set(measured.samples.map(s => Math.round(s.theta_i / DEGREE)));
  let best = 45, most = 0;
  for (const degrees of angles) {
    const count = samplesInPlane(measured, degrees * DEGREE).length;
    if (count > most || (count === most && Math.abs(degrees - 45) < Math.abs(best - 45))) [most, best] = [count, degrees];
  }
  return Math.min(best, 85);
}

// ---- CSV files ---------------------------------------------------------------------------------------------------

const GRIDS = [[90, 30, 36], [60, 18, 24], [45, 15, 18], [30, 12, 12]];

// Many samples of an isotropic material as a table, by the rule of src/model/appearance/picture_data.h; else null.
function tableOfSamples(samples) {
  for (const shape of GRIDS) {
    const [nh, nd, np] = shape, pairs = nh * nd * np;
    let above = 0;
    for (let k = 0; k < pairs; ++k) {
      const h = Math.floor(k / (nd * np)), d = Math.floor(k / np) % nd, p = k % np;
      const [wi, wo] = directionsOf(((h + 0.5) / nh) ** 2 * (Math.PI / 2), ((d + 0.5) / nd) * (Math.PI / 2), ((p + 0.5) / np) * Math.PI);
      if (wi[2] > 0 && wo[2] > 0) ++above;
    }
    if (samples.length < 4 * above) continue;
    const rgb = new Float32Array(3 * pairs), counts = new Uint32Array(pairs), valid = new Uint8Array(pairs);
    for (const {wi, wo, rho} of samples) {
      const at = anglesOf(wi, wo), bin = (x, n) => Math.min(Math.floor(x * n), n - 1);
      const k = (bin(Math.sqrt(at.theta_h / (Math.PI / 2)), nh) * nd + bin(at.theta_d / (Math.PI / 2), nd)) * np + bin(at.phi_d / Math.PI, np);
      ++counts[k];
      for (let c = 0; c < 3; ++c) rgb[3 * k + c] += rho[c];
    }
    let filled = 0;
    counts.forEach((n, k) => {
      if (n === 0) return;
      ++filled;
      valid[k] = 1;
      for (let c = 0; c < 3; ++c) rgb[3 * k + c] /= n;
    });
    if (filled >= 0.6 * above) return tableMeasured(shape, rgb, valid, {count: samples.length});
  }
  return null;
}

// Throws an Error of one line for what it cannot be sure of; the program reads more kinds of files.
export function parseCsv(text) {
  const lines = text.split(/\r?\n/).map((line, k) => [line.split('#')[0].trim(), k + 1]).filter(([line]) => line !== '');
  const names = (lines.shift()?.[0] ?? '').split(',').map(name => name.trim());
  const wanted = ['theta_i', 'phi_i', 'theta_o', 'phi_o', 'r', 'g', 'b'];
  const columns = wanted.map(name => names.indexOf(name));
  if (columns.includes(-1)) throw new Error(`no table that this page reads: its header must have ${wanted.join(', ')}; trilobe fit reads more tables`);
  const samples = [], azimuths = new Set();
  let leftOut = 0;
  for (const [line, number] of lines) {
    const cells = line.split(','), row = columns.map(c => Number(cells[c]));
    if (cells.length !== names.length || !row.every(Number.isFinite)) throw new Error(`row ${number} of the CSV file is no sample`);
    if (row[0] < 0 || row[2] < 0) throw new Error(`row ${number} of the CSV file has a negative angle; which side that is, only the program finds out`);
    if (!(row[0] < 90 && row[2] < 90) || row.slice(4).some(x => x < 0)) {
      ++leftOut;
      continue;
    }
    azimuths.add(row[1] % 360);
    samples.push(sampleOf([...row.slice(0, 4).map(x => x * DEGREE), ...row.slice(4)]));
  }
  if (samples.length === 0) throw new Error('the CSV file has no sample above the surface');
  const most = samples.reduce((x, s) => Math.max(x, s.theta_i, s.theta_o), 0);
  if (most > 0 && most < 1.58 * DEGREE) throw new Error('all angles of the CSV file are below 1.58, as in radians; this page reads degrees');
  const anisotropic = azimuths.size > 1, table = anisotropic ? null : tableOfSamples(samples);
  if (table) return {...table, leftOut};
  const kept = Math.min(samples.length, MOST_SAMPLES);
  const spread = Array.from({length: kept}, (_, k) => samples[Math.floor((k * samples.length) / kept)]);
  return {...samplesMeasured(spread, samples.length, most, anisotropic), leftOut};
}
