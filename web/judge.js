// How far apart two pictures are to the eye: CIELAB differences of 1976, and the words for them, by the rule of
// src/model/appearance/verdict.h and seen_error.h.

const MEAN_LUMINANCE = 0.35;
export const luminance = c => 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];

// [name, words, the most of the mean, the most of the 95th percentile].
const RULE = [
  ['none', 'cannot be told apart', 1, 2.3],
  ['hardly', 'hardly visible side by side', 2.3, 5],
  ['visible', 'visible', 5, 10],
  ['plain', 'plainly visible', Infinity, Infinity],
];

// Visibility {name, words} of a difference {mean, at95}.
export function visibilityOf({mean, at95}) {
  const [name, words] = RULE.find(([, , most, most95]) => mean <= most && at95 <= most95);
  return {name, words};
}

function lab(rgb, exposure) {
  const f = t => (t > 0.00885645 ? Math.cbrt(t) : t * 7.787037 + 0.13793103);
  const [r, g, b] = rgb.map(x => Math.min(Math.max(x * exposure, 0), 1));
  const x = f((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505), y = f(luminance([r, g, b]));
  const z = f((0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089);
  return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

export function deltaE(a, b, exposure) {
  const p = lab(a, exposure), q = lab(b, exposure);
  return Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

// {mean, at95} of differences, or null if there are none.
export function summaryOf(differences) {
  if (differences.length === 0) return null;
  const sorted = Float64Array.from(differences).sort();
  return {mean: sorted.reduce((x, y) => x + y, 0) / sorted.length, at95: sorted[Math.min(Math.floor(0.95 * sorted.length), sorted.length - 1)]};
}

// Compares two pictures of RGBA light, where most of the light of both is of measured directions.
export function compareImages(fitted, measured, exposure) {
  const found = [];
  for (let k = 0; k < fitted.length; k += 4) {
    if (!(fitted[k + 3] > 0) || measured[k + 3] < 0.5 * fitted[k + 3]) continue;
    found.push(deltaE([fitted[k], fitted[k + 1], fitted[k + 2]], [measured[k], measured[k + 1], measured[k + 2]], exposure));
  }
  return summaryOf(found);
}

// Compares samples, each as a patch of the brightness rho cos theta_i. The exposure makes the mean of their clipped
// luminances MEAN_LUMINANCE. Null for a black measurement.
export function compareSamples(samples, evaluate) {
  const lights = samples.map(({wi, rho}) => rho.map(x => x * wi[2])), luminances = lights.map(luminance);
  if (!luminances.some(l => l > 0)) return null;
  const mean = exposure => luminances.reduce((sum, l) => sum + Math.min(exposure * l, 1), 0) / luminances.length;
  let low = Math.log2(MEAN_LUMINANCE / luminances.reduce((a, b) => Math.max(a, b))), high = low + 64;
  for (let k = 0; k < 60; ++k) {
    const middle = (low + high) / 2;
    if (mean(2 ** middle) < MEAN_LUMINANCE) low = middle;
    else high = middle;
  }
  return summaryOf(samples.map(({wi, wo}, k) => deltaE(evaluate(wi, wo).rho.map(x => x * wi[2]), lights[k], 2 ** low)));
}
