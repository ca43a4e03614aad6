// The picture where the browser has no WebGL 2, in place of a Renderer: the spheres that the program drew into the page.
// They neither turn nor follow an edit. The rest of the page needs no WebGL.

import {deltaE} from './judge.js';
import {linearOfCode} from './edit.js';

// Colours of differences, as in show.glsl.
const STOPS = [[0, [255, 255, 255]], [1, [255, 237, 160]], [2, [254, 178, 76]], [5, [227, 26, 28]], [10, [60, 0, 30]]];
function colorOf(delta) {
  const k = Math.min(Math.max(STOPS.findIndex(([most]) => delta <= most) - 1, 0), STOPS.length - 2), last = delta >= STOPS.at(-1)[0];
  const [[from, a], [to, b]] = last ? [STOPS.at(-2), STOPS.at(-1)] : [STOPS[k], STOPS[k + 1]], t = Math.min((delta - from) / (to - from), 1);
  return a.map((x, c) => Math.round(x + t * (b[c] - x)));
}

// Where the two halves of a picture differ.
function differenceOf(image) {
  const size = image.height, whole = new OffscreenCanvas(2 * size, size), made = new OffscreenCanvas(size, size);
  const context = whole.getContext('2d'), found = new ImageData(size, size);
  context.drawImage(image, 0, 0);
  const {data} = context.getImageData(0, 0, 2 * size, size);
  const linear = at => [0, 1, 2].map(c => linearOfCode(data[at + c]));
  for (let row = 0; row < size; ++row) {
    for (let column = 0; column < size; ++column) {
      const at = 4 * (2 * row * size + column);
      found.data.set([...colorOf(deltaE(linear(at), linear(at + 4 * size), 1)), 255], 4 * (row * size + column));
    }
  }
  made.getContext('2d').putImageData(found, 0, 0);
  return made;
}

export class StillPicture {
  // In an element, above its other canvas. `spheres`: a PNG file in base64, of the measured and the fitted sphere, or of
  // the fitted one alone; or undefined. `why` there is no other picture; `onLoad` is called when it can be shown.
  constructor(place, spheres, why, onLoad) {
    Object.assign(this, {isStill: true, why, shown: null, pending: false, finer: null, levels: [], object: 'sphere', turn: [0, 0]});
    this.canvas = Object.assign(document.createElement('canvas'), {className: 'still'});
    place.querySelector('canvas').after(this.canvas);
    this.image = null;
    this.isHeld = Boolean(spheres);
    if (!spheres) return;
    const image = new Image();
    image.addEventListener('load', () => {
      this.image = image;
      onLoad();
    });
    image.src = `data:image/png;base64,${spheres}`;
  }

  // What a Renderer does for its picture.
  setEnvironment() {}
  setModel() {}
  setMeasured() {}
  setSize() {}
  restart() {}
  work() { return false; }

  get holdsBoth() { return this.image ? this.image.width === 2 * this.image.height : false; }

  // The part of the picture for a mode, or null. `valid`: which of the two are of what the page shows now.
  partOf(mode, valid) {
    const {image} = this;
    if (!image || !valid[mode]) return null;
    if (mode === 'difference') return this.holdsBoth ? [(this.difference ??= differenceOf(image)), 0] : null;
    if (mode === 'measured') return this.holdsBoth ? [image, 0] : null;
    return [image, this.holdsBoth ? image.height : 0];
  }

  // As Renderer.show.
  show(panels, {wipe, mark, valid, width, height}) {
    const {canvas} = this, context = canvas.getContext('2d');
    Object.assign(canvas, {width, height});
    context.imageSmoothingQuality = 'high';
    for (const {mode, x, y, size} of panels) {
      const sphere = () => context.arc(x + size / 2, y + size / 2, size / 2, 0, 7);
      for (const [part, left, right] of mode === 'wipe' ? [['measured', 0, wipe], ['fitted', wipe, 1]] : [[mode, 0, 1]]) {
        const found = this.partOf(part, valid);
        context.save();
        context.beginPath();
        context.rect(x + left * size, y, (right - left) * size, size);
        context.clip();
        context.beginPath();
        sphere();
        context.strokeStyle = '#8889';
        if (!found) context.stroke();
        context.clip();
        if (found) context.drawImage(found[0], found[1], 0, found[0].height, found[0].height, x, y, size, size);
        context.restore();
      }
      if (!mark) continue;
      for (const [color, thick] of [['#fff', 5], ['#000', 2]]) {
        context.beginPath();
        context.arc(x + ((mark[0] + 1) / 2) * size, y + ((1 - mark[1]) / 2) * size, 7, 0, 7);
        Object.assign(context, {strokeStyle: color, lineWidth: thick});
        context.stroke();
      }
    }
  }

  surfaceAt(x, y) {
    const z2 = 1 - x * x - y * y;
    if (z2 <= 0) return null;
    const z = Math.sqrt(z2), across = Math.hypot(x, z);
    return {normal: [x, y, z], tangent: across > 1e-6 ? [z / across, 0, -x / across] : [1, 0, 0]};
  }
}
