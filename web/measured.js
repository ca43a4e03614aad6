// A measurement: a table over (theta_h, theta_d, phi_d), as of MERL, or values at pairs of nodes above an anisotropic
// sample. {kind, rgb: Float32Array, valid: Uint8Array, ...}; rho(wi, wo) gives [r, g, b] or null.

import {anglesOf, linearPlace} from './model.js';

// The Rice code of src/io/pictures/page.h.
export function decodeMeasured(header, text) {
  const bytes = bytesOf(text);
  let at = 0;
  const bit = () => (bytes[at >> 3] >> (at++ & 7)) & 1;
  const number = count => {
    let n = 0;
    for (let k = 0; k < count; ++k) n |= bit() << k;
    return n;
  };
  const rice = low => {
    let high = 0;
    while (bit()) ++high;
    return (high << low) | number(low);
  };
  const pairs = header.shape.reduce((a, b) => a * b, 1), length = header.shape.at(-1), rows = header.shape.at(-2);
  const rgb = new Float32Array(3 * pairs), valid = new Uint8Array(pairs), codes = new Int32Array(pairs);
  for (let k = 0, measured = 1; k < pairs; measured = 1 - measured) {
    const run = rice(5);
    valid.fill(measured, k, k + run);
    k += run;
  }
  for (let c = 0; c < 3; ++c) {
    for (let begin = 0; begin < pairs; begin += length) {
      const first = (begin / length) % rows === 0, low = number(4);
      let left = -1;
      for (let k = begin; k < begin + length; ++k) {
        if (!valid[k]) continue;
        const above = !first && valid[k - length] ? codes[k - length] : -1;
        const expected = left < 0 ? Math.max(above, 0) : above < 0 ? left : (left + above) >> 1;
        const zigzag = rice(low);
        left = codes[k] = expected + (zigzag & 1 ? -((zigzag + 1) >> 1) : zigzag >> 1);
        rgb[3 * k + c] = header.floor * (2 ** (left / header.steps) - 1);
      }
    }
  }
  return header.kind === 'table' ? tableMeasured(header.shape, rgb, valid, {count: header.samples}) : nodesMeasured(header, rgb, valid);
}

export function bytesOf(base64) {
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let k = 0; k < bytes.length; ++k) bytes[k] = text.charCodeAt(k);
  return bytes;
}

// Fills invalid bins by the value of the nearest valid one: along phi_d, which wraps around, else theta_d, else
// theta_h.
function fillFromNearest(rgb, valid, [nh, nd, np]) {
  const known = Uint8Array.from(valid), longest = Math.max(nh, nd, np);
  const from = new Int32Array(longest), distance = new Int32Array(longest);
  const fill = (first, count, stride, cyclic) => {
    let found = 0;
    for (let i = 0; i < count; ++i) found += known[first + i * stride];
    if (found === 0 || found === count) return;
    for (let i = 0; i < count; ++i) {
      from[i] = known[first + i * stride] ? i : -1;
      distance[i] = from[i] < 0 ? 1 << 20 : 0;
    }
    const steps = cyclic ? 2 * count : count;
    const carry = (a, b) => {
      if (distance[a] + 1 >= distance[b]) return;
      distance[b] = distance[a] + 1;
      from[b] = from[a];
    };
    for (let i = 1; i < steps; ++i) carry((i - 1) % count, i % count);
    for (let i = steps - 1; i > 0; --i) carry(i % count, (i - 1) % count);
    for (let i = 0; i < count; ++i) {
      if (from[i] < 0 || distance[i] === 0) continue;
      const to = first + i * stride, source = first + from[i] * stride;
      for (let c = 0; c < 3; ++c) rgb[3 * to + c] = rgb[3 * source + c];
      known[to] = 1;
    }
  };
  for (let i = 0; i < nh * nd; ++i) {
    let missing = false;
    for (let p = 0; p < np && !missing; ++p) missing = !known[i * np + p];
    if (missing) fill(i * np, np, 1, true);
  }
  // By now a row is known for all phi_d or for none.
  const rows = Array.from({length: nh * nd}, (_, i) => known[i * np]);
  for (let h = 0; h < nh; ++h) {
    if (rows.slice(h * nd, (h + 1) * nd).every(Boolean)) continue;
    for (let p = 0; p < np; ++p) fill(h * nd * np + p, nd, np, false);
  }
  if (rows.some((_, i) => i % nd === 0 && !rows.slice(i, i + nd).some(Boolean))) {
    for (let i = 0; i < nd * np; ++i) fill(i, nh, nd * np, false);
  }
}

export function tableMeasured(shape, rgb, valid, extra) {
  const [nh, nd, np] = shape;
  fillFromNearest(rgb, valid, shape);
  // Linear between the middles of bins; null where the bin was not measured.
  const rho = (wi, wo) => {
    const at = anglesOf(wi, wo);
    const [h, d] = [Math.sqrt(at.theta_h / (Math.PI / 2)) * nh, (at.theta_d / (Math.PI / 2)) * nd];
    const p = (at.phi_d / Math.PI) * np;
    const bin = (x, n) => Math.min(Math.floor(x), n - 1);
    if (!valid[(bin(h, nh) * nd + bin(d, nd)) * np + bin(p, np)]) return null;
    const [h0, h1, s] = linearPlace(h, nh), [d0, d1, t] = linearPlace(d, nd);
    const p0 = Math.floor(p - 0.5), u = p - 0.5 - p0, sum = [0, 0, 0];
    for (const [i, wh] of [[h0, 1 - s], [h1, s]]) {
      for (const [j, wd] of [[d0, 1 - t], [d1, t]]) {
        for (const [k, wp] of [[(p0 + np) % np, 1 - u], [(p0 + 1) % np, u]]) {
          const from = 3 * ((i * nd + j) * np + k);
          for (let c = 0; c < 3; ++c) sum[c] += wh * wd * wp * rgb[from + c];
        }
      }
    }
    return sum;
  };
  return {kind: 'table', shape, rgb, valid, rho, count: extra.count ?? valid.reduce((a, b) => a + b, 0)};
}

function nodesMeasured(header, rgb, valid) {
  const {thetas, phis, max_theta: maxTheta} = header, nodes = thetas * phis;
  const corners = w => {
    const x = Math.min(Math.max((Math.acos(Math.min(w[2], 1)) / (Math.PI / 2)) * thetas, 0), thetas - 1);
    const turns = Math.atan2(w[1], w[0]) / (2 * Math.PI), y = (turns - Math.floor(turns)) * phis;
    const a = Math.floor(x), b = Math.min(Math.floor(y), phis - 1), s = x - a, t = y - b;
    const above = Math.min(a + 1, thetas - 1), next = (b + 1) % phis;
    return [[a * phis + b, (1 - s) * (1 - t)], [a * phis + next, (1 - s) * t],
            [above * phis + b, s * (1 - t)], [above * phis + next, s * t]];
  };
  const least = Math.cos(maxTheta) - 1e-9;
  const rho = (wi, wo) => {
    if (Math.min(wi[2], wo[2]) < least) return null;
    const sum = [0, 0, 0];
    for (const [i, wa] of corners(wi)) {
      for (const [o, wb] of corners(wo)) {
        const k = i * nodes + o;
        if (wa * wb > 0.25 && !valid[k]) return null;
        for (let c = 0; c < 3; ++c) sum[c] += wa * wb * rgb[3 * k + c];
      }
    }
    return sum;
  };
  return {kind: 'nodes', thetas, phis, maxTheta, rgb, valid, rho, count: header.samples};
}

// A MERL .binary file. Throws an Error of one line.
export function parseMerl(buffer) {
  const view = new DataView(buffer);
  const dims = buffer.byteLength >= 12 ? [0, 4, 8].map(at => view.getInt32(at, true)) : [];
  const size = dims.reduce((a, b) => a * b, 1);
  if (dims.length < 3 || dims.some(n => n < 2 || n > 1024) || buffer.byteLength !== 12 + 24 * size) {
    throw new Error('not a MERL file: its size is not what its header says');
  }
  const stored = new Float64Array(buffer.slice(12));
  const scales = [1 / 1500, 1.15 / 1500, 1.66 / 1500];
  const halve = dims[2] % 2 === 0 && dims[2] > 90 ? 2 : 1;
  const shape = [dims[0], dims[1], dims[2] / halve];
  const pairs = size / halve, rgb = new Float32Array(3 * pairs), valid = new Uint8Array(pairs);
  for (let k = 0; k < pairs; ++k) {
    let count = 0;
    for (let part = 0; part < halve; ++part) {
      const at = k * halve + part;
      const values = [0, 1, 2].map(c => stored[c * size + at] * scales[c]);
      if (!values.every(x => Number.isFinite(x) && x >= 0)) continue;
      ++count;
      for (let c = 0; c < 3; ++c) rgb[3 * k + c] += values[c];
    }
    valid[k] = count > 0 ? 1 : 0;
    for (let c = 0; c < 3 && count > 1; ++c) rgb[3 * k + c] /= count;
  }
  if (!valid.includes(1)) throw new Error('the MERL file has no valid bin');
  return tableMeasured(shape, rgb, valid, {});
}

// Two directions by their half and difference angles.
export function directionsOf(thetaH, thetaD, phiD) {
  const sd = Math.sin(thetaD), d = [sd * Math.cos(phiD), sd * Math.sin(phiD), Math.cos(thetaD)];
  const c = Math.cos(thetaH), s = Math.sin(thetaH);
  const turn = ([x, y, z]) => [x * c + z * s, y, z * c - x * s];
  return [turn(d), turn([-d[0], -d[1], d[2]])];
}
