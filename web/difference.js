// Maps of where a model is too dark or too bright beside its measurement, over (theta_h, theta_d).

import {luminance} from './judge.js';
import {anglesOf} from './model.js';
import {directionsOf} from './measured.js';

const MOST = Math.log(100);  // bound of log ratios, that of black
const logRatio = (fitted, measured) => Math.min(Math.max(Math.log(fitted / measured), -MOST), MOST);

const WITHIN = 10;  // degrees of phi_d, where nothing has bins of it
const isNear = (phi, degrees) => degrees === null || Math.abs(((phi * 180) / Math.PI - degrees + 270) % 180 - 90) <= WITHIN;

function turnedBy([x, y, z], angle) {
  const c = Math.cos(angle), s = Math.sin(angle);
  return [c * x - s * y, s * x + c * y, z];
}

// Mean log ratio of fitted over measured in `size` x `size` bins of (theta_h, theta_d), NaN where nothing was
// measured: {size, ratio: Float32Array, typical, bias, hardlySeen: Uint8Array}. Where it is seen, `bias` is the mean of
// the logs and `typical` that of their sizes. theta_h by its root, as in the tables, which have `size` bins or more: else
// some would be empty. With `phiD` [degrees] of directions about there alone, and hardlySeen as in the map `like`.
export function differenceMap(measured, evaluate, {size = 45, phiD = null, like = null}) {
  const sums = new Float64Array(size * size), weights = new Float64Array(size * size);
  const [light, density, pairs] = [0, 1, 2].map(() => new Float64Array(size * size));
  const absolute = new Float64Array(size * size);
  const add = (wi, wo, rho, bin, solidAngle) => {
    const fitted = luminance(evaluate(wi, wo).rho), seen = luminance(rho), brighter = Math.max(fitted, seen);
    density[bin] += brighter * wi[2] * wo[2];
    light[bin] += brighter * wi[2] * wo[2] * solidAngle;
    ++pairs[bin];
    if (!(seen > 0)) return;
    const log = logRatio(fitted, seen);
    sums[bin] += log;
    weights[bin] += 1;
    absolute[bin] += Math.abs(log);
  };
  // Adds a comparison with another model, at azimuths that spread by the golden angle, as it may be anisotropic.
  const addTurned = (wi, wo, p, bin, solidAngle) => {
    const [i, o] = [wi, wo].map(w => turnedBy(w, p * Math.PI * (3 - Math.sqrt(5))));
    add(i, o, measured.rho(i, o), bin, solidAngle);
  };
  if (measured.kind !== 'nodes') {
    const {shape: [nh, nd, np], rgb, valid, kind} = measured;
    for (let h = 0; h < nh; ++h) {
      const thetaH = ((h + 0.5) / nh) ** 2 * (Math.PI / 2), row = Math.floor(((h + 0.5) / nh) * size) * size;
      for (let d = 0; d < nd; ++d) {
        const thetaD = ((d + 0.5) / nd) * (Math.PI / 2), bin = row + Math.floor(((d + 0.5) / nd) * size);
        const solidAngle = Math.sqrt(thetaH) * Math.sin(thetaH) * Math.sin(thetaD) * Math.cos(thetaD);
        const all = phiD === null ? Array.from({length: np}, (_, p) => p) : [Math.floor((phiD / 180) * np)];
        const known = all.filter(p => kind === 'model' || valid[(h * nd + d) * np + p]);
        for (let n = 0; n < known.length; n += Math.ceil(known.length / 8)) {  // nothing is narrow in phi_d
          const p = known[n], k = (h * nd + d) * np + p;
          const [wi, wo] = directionsOf(thetaH, thetaD, ((p + 0.5) / np) * Math.PI);
          if (!(wi[2] > 0 && wo[2] > 0)) continue;
          if (kind === 'model') addTurned(wi, wo, p, bin, solidAngle);
          else add(wi, wo, [rgb[3 * k], rgb[3 * k + 1], rgb[3 * k + 2]], bin, solidAngle);
        }
      }
    }
  } else {
    const {thetas, phis, rgb, valid} = measured, nodes = thetas * phis;
    const w = Array.from({length: nodes}, (_, n) => {
      const theta = (Math.floor(n / phis) / thetas) * (Math.PI / 2), phi = ((n % phis) / phis) * 2 * Math.PI;
      return [Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta)];
    });
    const step = Math.max(1, Math.round((nodes * nodes) / 30000)) | 1;
    for (let k = 0; k < nodes * nodes; k += step) {
      const i = Math.floor(k / nodes), o = k % nodes;
      if (!valid[k] || !(w[i][2] > 0 && w[o][2] > 0)) continue;
      const at = anglesOf(w[i], w[o]);
      if (!isNear(at.phi_d, phiD)) continue;
      const h = Math.min(Math.floor(Math.sqrt(at.theta_h / (Math.PI / 2)) * size), size - 1);
      const d = Math.min(Math.floor((at.theta_d / (Math.PI / 2)) * size), size - 1);
      add(w[i], w[o], rgb.subarray(3 * k, 3 * k + 3), h * size + d, Math.sqrt((1 - w[i][2] ** 2) * (1 - w[o][2] ** 2)));
    }
  }
  const ratio = Float32Array.from(sums, (s, k) => (weights[k] > 0 ? s / weights[k] : NaN));
  for (let k = 0; k < pairs.length; ++k) density[k] /= Math.max(pairs[k], 1);
  const unseen = like?.hardlySeen ?? hardlySeen(light, density, pairs), ofSeen = list => list.reduce((sum, x, k) => sum + (unseen[k] ? 0 : x), 0);
  const count = ofSeen(weights);
  return {size, ratio, typical: ofSeen(absolute) / count, bias: ofSeen(sums) / count, hardlySeen: unseen};
}

// The bins that an eye hardly sees, as in src/model/appearance/hardly_seen.h: those of the least light for their solid
// angle that together have at most HARDLY_SEEN of the light of all.
export const HARDLY_SEEN = 0.003;
function hardlySeen(light, density, pairs) {
  const most = HARDLY_SEEN * light.reduce((a, b) => a + b, 0), found = new Uint8Array(light.length);
  const order = Array.from(light.keys()).filter(k => pairs[k] > 0).sort((a, b) => density[a] - density[b]);
  let sum = 0;
  for (const k of order) {
    sum += light[k];
    if (sum > most) break;
    found[k] = 1;
  }
  return found;
}

// Differences at samples: {points: [{theta_h, theta_d, log}], typical, bias}.
export function differencePoints({samples}, evaluate, phiD = null) {
  const points = [];
  for (const {wi, wo, rho} of samples) {
    if (!(luminance(rho) > 0)) continue;
    const at = anglesOf(wi, wo);
    if (!isNear(at.phi_d, phiD)) continue;
    points.push({theta_h: at.theta_h, theta_d: at.theta_d, log: logRatio(luminance(evaluate(wi, wo).rho), luminance(rho))});
  }
  const mean = of => points.reduce((sum, p) => sum + of(p.log), 0) / points.length;
  return {points, typical: mean(Math.abs), bias: mean(x => x)};
}

const twoDigits = x => String(+x.toPrecision(2));

// In words: by how much the fit is brighter in the mean, and how far the darker of the two is below the brighter.
export function differenceWords({typical, bias}, elsewhere, what = 'the fit') {
  if (!Number.isFinite(typical)) return '';
  const percent = 100 * (Math.exp(bias) - 1), apart = 100 * (1 - Math.exp(-typical));
  const mean = Math.abs(percent) < 0.05 ? 'as bright' : `${twoDigits(Math.abs(percent))} % too ${percent < 0 ? 'dark' : 'bright'}`;
  return `${elsewhere ? 'Elsewhere' : 'In the mean'} ${what} is ${mean}${elsewhere ? ' in the mean' : ''}; the darker of the two is typically ${twoDigits(apart)} % below the brighter.`;
}
