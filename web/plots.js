// Small charts on canvases, in the colours of the page.

// Same colours as in factors.png (src/io/pictures/gnuplot.h).
export const LOBE_COLORS = ['#E69F00', '#56B4E9', '#CC79A7', '#8E6BBF', '#8C6D31', '#23939C', '#7D7D7D', '#A8A800'];
export const CHANNEL_COLORS = ['#D55E00', '#009E73', '#0072B2'];
export const CHANNEL_NAMES = ['red', 'green', 'blue'];

function styleOf(canvas) {
  const style = getComputedStyle(canvas);
  return {text: style.getPropertyValue('--muted').trim() || '#666', line: style.getPropertyValue('--line').trim() || '#ccc',
          strong: style.getPropertyValue('--text').trim() || '#111', surface: style.getPropertyValue('--surface').trim() || '#fff'};
}

export function prepare(canvas) {
  const scale = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (width === 0) return null;
  const w = Math.round(width * scale), h = Math.round(height * scale);
  if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, {width: w, height: h});
  const context = canvas.getContext('2d');
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = '11px system-ui, sans-serif';
  context.lineJoin = 'round';
  return {context, width, height};
}

// Lines over what `path` adds to the context's path, within a box.
function hatch(context, color, [left, top, width, height], path, thick = 1, step = 7, slope = 1) {
  context.save();
  context.beginPath();
  path();
  context.clip();
  context.strokeStyle = color;
  context.lineWidth = thick;
  context.setLineDash([]);
  context.beginPath();
  for (let x = left - height; x < left + width + height; x += step) {
    context.moveTo(x, top + height);
    context.lineTo(x + slope * height, top);
  }
  context.stroke();
  context.restore();
}

// Blue where the fit is too dark, over what cannot be seen, to red where it is too bright.
export function logColor(ratio, dark) {
  const x = Math.min(Math.max(ratio / Math.log(1.5), -1), 1), t = Math.abs(x) ** 0.7;
  const end = x < 0 ? [33, 102, 190] : [203, 54, 44], middle = dark ? [44, 48, 54] : [246, 246, 243];
  return middle.map((m, k) => Math.round(m + t * (end[k] - m)));
}

// The difference over (theta_h, theta_d), root of theta_h to the right, with a mark: of bins {size, ratio, hardlySeen}, of
// which those that are hardly seen are hatched, and those that were not measured the other way; or of samples {points}.
export function drawHeat(canvas, map, mark, dark) {
  const made = prepare(canvas);
  if (!made) return;
  const {context, width, height} = made, style = styleOf(canvas), left = 40, right = 8, top = 8, bottom = 20;
  const w = width - left - right, h = height - top - bottom, box = [left, top, w, h];
  const place = (thetaH, thetaD) => [left + Math.sqrt(Math.min(thetaH / 90, 1)) * w, top + (1 - thetaD / 90) * h];
  if (map.points) drawPoints(context, map.points, place, style, dark);
  else drawBins(context, map, box, style, dark);
  context.lineWidth = 1;
  context.strokeStyle = style.line;
  context.strokeRect(left + 0.5, top + 0.5, w - 1, h - 1);
  context.fillStyle = style.text;
  context.textAlign = 'center';
  context.textBaseline = 'top';
  for (const degrees of [0, 2, 10, 30, 60, 90]) {
    context.textAlign = degrees === 90 ? 'right' : 'center';
    context.fillText(`${degrees}°`, left + Math.sqrt(degrees / 90) * w + (degrees === 90 ? 4 : 0), height - bottom + 5);
  }
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  for (const degrees of [0, 30, 60, 90]) context.fillText(`${degrees}°`, left - 5, top + (1 - degrees / 90) * h);
  if (mark) {
    const [x, y] = place(...mark);
    context.lineWidth = 2;
    for (const [color, radius] of [[style.surface, 6.5], [style.strong, 5]]) {
      context.strokeStyle = color;
      context.beginPath();
      context.arc(x, y, radius, 0, 7);
      context.stroke();
    }
  }
}

// Draws the scale of a map's colours, with these percents.
export function drawScale(canvas, percents, dark) {
  const made = prepare(canvas);
  if (!made) return;
  const {context, width} = made, left = 40, w = width - 48, most = Math.log(1.5);
  for (let x = 0; x < w; ++x) {
    context.fillStyle = `rgb(${logColor((2 * (x + 0.5) / w - 1) * most, dark)})`;
    context.fillRect(left + x, 2, 1.5, 9);
  }
  context.fillStyle = styleOf(canvas).text;
  context.textBaseline = 'top';
  percents.forEach((percent, k) => {
    if (width < 360 && k > 0 && k < percents.length - 1 && percent !== 0) return;
    const ends = k === 0 ? '≤ ' : k === percents.length - 1 ? '≥ ' : '', sign = percent < 0 ? '−' : percent > 0 ? '+' : '';
    const x = Math.min(Math.max(Math.log(1 + percent / 100) / most, -1), 1);
    context.textAlign = k === 0 ? 'left' : k === percents.length - 1 ? 'right' : 'center';
    context.fillText(`${ends}${sign}${Math.abs(percent)} %`, left + ((x + 1) / 2) * w, 15);
  });
}

function drawBins(context, {size, ratio, hardlySeen}, box, style, dark) {
  const [left, top, w, h] = box, image = new ImageData(size, size);
  const bins = chosen => ratio.forEach((value, k) => {
    if (chosen(value, k)) context.rect(left + (Math.floor(k / size) / size) * w, top + (1 - ((k % size) + 1) / size) * h, w / size, h / size);
  });
  ratio.forEach((value, k) => {
    const at = 4 * ((size - 1 - (k % size)) * size + Math.floor(k / size));
    if (!Number.isNaN(value)) image.data.set([...logColor(value, dark), 255], at);
  });
  const small = new OffscreenCanvas(size, size);
  small.getContext('2d').putImageData(image, 0, 0);
  context.imageSmoothingEnabled = false;
  context.drawImage(small, left, top, w, h);
  hatch(context, style.surface, box, () => bins((_, k) => hardlySeen[k]), 3);
  hatch(context, style.text, box, () => bins(value => Number.isNaN(value)), 0.7, 6, -1);
}

function drawPoints(context, points, place, style, dark) {
  context.lineWidth = 0.5;
  context.strokeStyle = style.text;
  const radius = points.length > 5000 ? 1.5 : 3;
  for (const {theta_h: thetaH, theta_d: thetaD, log} of points) {
    context.fillStyle = `rgb(${logColor(log, dark)})`;
    context.beginPath();
    context.arc(...place((thetaH * 180) / Math.PI, (thetaD * 180) / Math.PI), radius, 0, 7);
    context.fill();
    if (radius > 2) context.stroke();
  }
}

// Draws light in the plane of incidence: [{values: [[theta_o, value]...], color, dots}], theta_o from -90 to 90 [deg],
// light from the left. Radii are cube roots. Hatched where `known` of theta_o is false.
export function drawPolar(canvas, curves, thetaI, known) {
  const made = prepare(canvas);
  if (!made) return;
  const {context, width, height} = made, style = styleOf(canvas);
  const radius = Math.min(width / 2 - 14, height - 26), cx = width / 2, cy = height - 14;
  const most = curves.reduce((all, c) => c.values.reduce((x, v) => Math.max(x, v[1]), all), 1e-12);
  const place = (theta, value) => {
    const r = radius * Math.cbrt(Math.max(value, 0) / most), t = (theta * Math.PI) / 180;
    return [cx + r * Math.sin(t), cy - r * Math.cos(t)];
  };
  hatch(context, style.line, [cx - radius, cy - radius, 2 * radius, radius], () => {
    for (let degrees = -90; degrees < 90; degrees += 2) {
      if (known(degrees + 1)) continue;
      const [from, to] = [degrees - 90, degrees - 88].map(t => (t * Math.PI) / 180);
      context.moveTo(cx, cy);
      context.arc(cx, cy, radius, from, to);
    }
  });
  context.strokeStyle = style.line;
  context.fillStyle = style.text;
  context.lineWidth = 1;
  context.textAlign = 'left';
  context.textBaseline = 'bottom';
  for (const part of [1, 0.5, 0.1]) {
    context.beginPath();
    context.arc(cx, cy, radius * Math.cbrt(part), Math.PI, 2 * Math.PI);
    context.stroke();
    context.fillText(`${+(part * most).toPrecision(2)} /sr`, cx + 3, cy - radius * Math.cbrt(part));
  }
  context.beginPath();
  context.moveTo(cx - radius - 8, cy);
  context.lineTo(cx + radius + 8, cy);
  context.moveTo(cx, cy);
  context.lineTo(cx, cy - radius);
  context.stroke();
  const t = (thetaI * Math.PI) / 180, [x0, y0] = [cx - radius * Math.sin(t), cy - radius * Math.cos(t)];
  context.strokeStyle = context.fillStyle = '#d9a400';
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(cx, cy);
  context.stroke();
  context.beginPath();
  context.arc(x0, y0, 4, 0, 7);
  context.fill();
  for (const {values, color, dots = false, width: thick = 2, dash = []} of curves) {
    context.strokeStyle = context.fillStyle = color;
    context.lineWidth = thick;
    context.setLineDash(dash);
    context.beginPath();
    values.forEach(([theta, value], k) => {
      const [x, y] = place(theta, value);
      if (dots) {
        context.moveTo(x + 1.8, y);
        context.arc(x, y, 1.8, 0, 7);
      } else if (k === 0) context.moveTo(x, y);
      else context.lineTo(x, y);
    });
    if (dots) context.fill();
    else context.stroke();
  }
  context.setLineDash([]);
}

// A table over a hemisphere seen from above: theta outwards, phi around. Returns the range of its colours.
export function drawDisc(canvas, table, axis, color, mark) {
  const made = prepare(canvas);
  if (!made) return [NaN, NaN];
  const {context, width, height} = made, style = styleOf(canvas), size = 160;
  const values = Array.from(table).filter(v => v > 0), high = Math.log(Math.max(...values, 1e-12));
  const low = Math.max(Math.log(Math.min(...values, 1)), high - 9);
  const rgb = [1, 3, 5].map(at => parseInt(color.slice(at, at + 2), 16));
  const image = new ImageData(size, size);
  for (let row = 0; row < size; ++row) {
    for (let column = 0; column < size; ++column) {
      const x = ((column + 0.5) / size) * 2 - 1, y = 1 - ((row + 0.5) / size) * 2, r = Math.hypot(x, y);
      if (r > 1) continue;
      const theta = r * 90, turns = Math.atan2(y, x) / (2 * Math.PI);
      let a = axis.theta.findIndex(t => t > theta);
      if (a < 0) a = axis.theta.length - 1;
      const before = Math.max(a - 1, 0), span = axis.theta[a] - axis.theta[before];
      const s = span > 0 ? Math.min(Math.max((theta - axis.theta[before]) / span, 0), 1) : 0;
      const p = (turns - Math.floor(turns)) * axis.phis, b = Math.floor(p) % axis.phis, t = p - Math.floor(p), c = (b + 1) % axis.phis;
      const at = (i, j) => table[i * axis.phis + j];
      const value = (1 - s) * ((1 - t) * at(before, b) + t * at(before, c)) + s * ((1 - t) * at(a, b) + t * at(a, c));
      const v = value > 0 ? Math.min(Math.max((Math.log(value) - low) / Math.max(high - low, 1e-9), 0), 1) : 0;
      image.data.set([...rgb.map(k => Math.round(v < 0.7 ? (k * v) / 0.7 : k + ((255 - k) * (v - 0.7)) / 0.3)), 255], 4 * (row * size + column));
    }
  }
  const small = new OffscreenCanvas(size, size);
  small.getContext('2d').putImageData(image, 0, 0);
  const side = Math.min(width, height) - 8, x0 = (width - side) / 2, y0 = (height - side) / 2;
  context.drawImage(small, x0, y0, side, side);
  if (!mark) return [Math.exp(low), Math.exp(high)];
  const r = (mark[0] / 90) * (side / 2);
  context.strokeStyle = style.strong;
  context.lineWidth = 2;
  context.beginPath();
  context.arc(x0 + side / 2 + r * Math.cos(mark[1]), y0 + side / 2 - r * Math.sin(mark[1]), 5, 0, 7);
  context.stroke();
  return [Math.exp(low), Math.exp(high)];
}
