// Albedo: the share of light from all around that goes to an eye, or by reciprocity of light from there that is reflected.

import {halfCells} from './environment.js';
import {hasSamples, hasMeasured, page} from './page_state.js';

const albedoCells = halfCells();
const MOST_MISSING = 0.2;  // largest share of the light in unmeasured directions

// At theta from the normal [rad], {fitted: [3], measured: [3] or null}. What was not measured is the fit's in both, so that
// they differ by what is measured alone.
function albedosAt(evaluate, theta, measured) {
  const wo = [Math.sin(theta), 0, Math.cos(theta)], fitted = [0, 0, 0], seen = [0, 0, 0];
  let known = 0, all = 0;
  for (let k = 0; k < albedoCells.length; k += 4) {
    const h = [albedoCells[k], albedoCells[k + 1], albedoCells[k + 2]], along = wo[0] * h[0] + wo[2] * h[2];
    const wi = h.map((x, a) => 2 * along * x - wo[a]);
    if (!(along > 0 && wi[2] > 0)) continue;
    const weight = wi[2] * 4 * along * albedoCells[k + 3], {rho} = evaluate(wi, wo), other = measured?.(wi, wo);
    const light = weight * (rho[0] + rho[1] + rho[2]);
    all += light;
    if (other) known += light;
    for (let c = 0; c < 3; ++c) {
      fitted[c] += rho[c] * weight;
      seen[c] += (other ?? rho)[c] * weight;
    }
  }
  return {fitted, measured: all > 0 && known >= (1 - MOST_MISSING) * all ? seen : null};
}

export const albedo = theta => albedosAt(page.evaluate, theta, null).fitted;

// ---- Albedos over all angles, one at a time -----------------------------------------------------------------------

export const ALBEDO_DEGREES = [...Array.from({length: 18}, (_, k) => 5 * k), 88];

// Adds an angle to page.albedo, [{degrees, fitted, measured}...], or to that of a model kept in the charts; false where all
// have all.
export function continueAlbedo() {
  page.albedo ??= [];
  const done = page.albedo.length;
  if (done === ALBEDO_DEGREES.length) {
    const kept = page.kept.find(({albedo}) => albedo.length < ALBEDO_DEGREES.length);
    const degrees = ALBEDO_DEGREES[kept?.albedo.length];
    kept?.albedo.push({degrees, ...albedosAt(kept.evaluate, (degrees * Math.PI) / 180, null)});
    return kept !== undefined;
  }
  const degrees = ALBEDO_DEGREES[done], rho = hasMeasured() && !hasSamples() ? page.measured.rho : null;
  page.albedo.push({degrees, ...albedosAt(page.evaluate, (degrees * Math.PI) / 180, rho)});
  return true;
}
