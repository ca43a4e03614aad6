// Where light goes from one direction, as a surface in space: the radius is the cube root of the mean rho cos theta_o, as in
// the chart from the side.

import {DEGREES, byId, pageColor, short} from './dom.js';
import {page, state} from './page_state.js';
import {prepare} from './plots.js';

const ELEVATION = 25 / DEGREES;  // of the eye above the surface
const AZIMUTHS = [-180, -150, -120, -90, -60, -40, -25, -15, -8, -4, -2, 0, 2, 4, 8, 15, 25, 40, 60, 90, 120, 150, 180];

// theta_o [degrees], close around that of the mirror direction, where peaks are.
function rings() {
  const near = [-8, -4, -2, -1, 0, 1, 2, 4, 8].map(x => state.thetaI + x);
  return [...new Set([...Array.from({length: 16}, (_, k) => 6 * k), ...near])].filter(x => x >= 0 && x <= 89).sort((a, b) => a - b);
}

// {points: [ring][azimuth] of [x, y, z], x towards the mirror direction and z up, at most 1 long; most: the largest value}.
function surface() {
  const theta = state.thetaI / DEGREES, turn = state.lightPhi / DEGREES;
  const direction = (t, phi) => [Math.sin(t) * Math.cos(phi), Math.sin(t) * Math.sin(phi), Math.cos(t)];
  const wi = direction(theta, turn + Math.PI);
  const rows = rings().map(degrees => AZIMUTHS.map(azimuth => {
    const t = degrees / DEGREES, phi = azimuth / DEGREES, {rho} = page.evaluate(wi, direction(t, phi + turn));
    return {w: direction(t, phi), value: ((rho[0] + rho[1] + rho[2]) / 3) * Math.cos(t)};
  }));
  const most = rows.flat().reduce((high, {value}) => Math.max(high, value), 1e-12);
  return {points: rows.map(row => row.map(({w, value}) => w.map(x => x * Math.cbrt(Math.max(value, 0) / most)))), most};
}

// As the eye sees it: to the right, up, and towards the eye.
function seen([x, y, z]) {
  const c = Math.cos(state.lobeTurn / DEGREES), s = Math.sin(state.lobeTurn / DEGREES), right = x * c + y * s, far = y * c - x * s;
  return [right, z * Math.cos(ELEVATION) + far * Math.sin(ELEVATION), z * Math.sin(ELEVATION) - far * Math.cos(ELEVATION)];
}

let shown = null;
export function drawLobe() {
  shown = surface();
  showLobe();
  byId('lobe').ariaLabel = `Reflected light in space, light from ${Math.round(state.thetaI)}°: at most ${short(shown.most)} /sr. Arrows turn it.`;
}

function showLobe() {
  const made = prepare(byId('lobe'));
  if (!made || !shown) return;
  const {context, width, height} = made, radius = Math.min(width / 2 - 8, (height - 12) / (1 + Math.sin(ELEVATION)));
  const middle = [width / 2, height - 6 - radius * Math.sin(ELEVATION)];
  const at = p => [middle[0] + radius * p[0], middle[1] - radius * p[1]];
  const line = (points, close) => {
    context.beginPath();
    points.forEach((p, k) => (k === 0 ? context.moveTo(...at(p)) : context.lineTo(...at(p))));
    if (close) context.closePath();
  };
  // The surface, with its half towards which the mirror direction points.
  context.strokeStyle = pageColor('--line');
  line(Array.from({length: 73}, (_, k) => seen([Math.cos(k * 5 / DEGREES), Math.sin(k * 5 / DEGREES), 0])), true);
  context.stroke();
  line([seen([0, 0, 0]), seen([1, 0, 0])]);
  context.stroke();
  const {points} = shown, faces = [];
  for (let r = 0; r + 1 < points.length; ++r) {
    for (let k = 0; k + 1 < AZIMUTHS.length; ++k) {
      const corners = [points[r][k], points[r][k + 1], points[r + 1][k + 1], points[r + 1][k]];
      const [a, b, c, d] = corners, u = b.map((x, j) => x - d[j]), v = c.map((x, j) => x - a[j]);
      const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]], size = Math.hypot(...n);
      const facing = size > 1e-12 ? Math.abs(seen(n)[2]) / size : 1;
      faces.push({corners: corners.map(seen), depth: corners.reduce((sum, p) => sum + seen(p)[2], 0), facing});
    }
  }
  const t = state.thetaI / DEGREES, lamp = seen([-Math.sin(t), 0, Math.cos(t)]);
  const drawLight = () => {
    context.strokeStyle = context.fillStyle = '#d9a400';
    context.lineWidth = 2;
    line([lamp, [0, 0, 0]]);
    context.stroke();
    context.beginPath();
    context.arc(...at(lamp), 4, 0, 7);
    context.fill();
  };
  if (lamp[2] < 0) drawLight();
  context.lineWidth = 0.6;
  for (const {corners, facing} of faces.sort((a, b) => a.depth - b.depth)) {
    line(corners, true);
    context.fillStyle = `color-mix(in srgb, ${pageColor('--accent')} ${Math.round(35 + 50 * facing)}%, ${pageColor('--surface')})`;
    context.strokeStyle = context.fillStyle;
    context.fill();
    context.stroke();
  }
  if (lamp[2] >= 0) drawLight();
}

function turnBy(degrees) {
  state.lobeTurn = (((state.lobeTurn + degrees + 180) % 360) + 360) % 360 - 180;
  showLobe();
}

export function listenToLobe() {
  const canvas = byId('lobe');
  let last = null;
  canvas.addEventListener('pointerdown', event => {
    last = event.clientX;
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener('pointermove', event => {
    if (last === null) return;
    turnBy((event.clientX - last) / 2);
    last = event.clientX;
  });
  for (const type of ['pointerup', 'pointercancel']) canvas.addEventListener(type, () => (last = null));
  canvas.addEventListener('keydown', event => {
    const step = {ArrowLeft: -10, ArrowRight: 10}[event.key];
    if (!step) return;
    event.preventDefault();
    turnBy(step);
  });
}
