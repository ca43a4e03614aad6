// Models side by side under one light and exposure, and how far each is from the first.

import {element, shortDeltaE} from './dom.js';
import {studioEnvironment} from './environment.js';
import {compareImages, visibilityOf} from './judge.js';
import {parseModel} from './model.js';
import {Renderer} from './renderer.js';

const SPHERE = 192;  // pixels; a half of them are drawn without a graphics card

let drawer = null;
function theRenderer() {
  if (!drawer) {
    const shaders = JSON.parse(document.getElementById('shaders').textContent);
    drawer = new Renderer(element('canvas', {width: 2 * SPHERE, height: SPHERE}), file => shaders[file]);
    drawer.setEnvironment(studioEnvironment());
    drawer.slice = 150;
  }
  return drawer;
}

// Draws until nothing is left, or `stale` is true; `draw` is called with each finer picture.
function finish(renderer, stale, draw) {
  return new Promise(done => {
    const step = () => {
      if (renderer.work(false)) draw();
      if (stale() || !renderer.pending) done();
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  });
}

let turns = 0;
// entries: [{name, model, figure}...], two or more: into each figure, its sphere and the difference of that to the first's.
export async function drawCompared(entries) {
  const turn = ++turns, stale = () => turn !== turns;
  const renderer = theRenderer(), first = entries[0], reference = {kind: 'model', model: parseModel(JSON.stringify(first.model))};
  renderer.setSize(renderer.rate > 5e7 ? SPHERE : SPHERE / 2);
  const places = entries.map(({figure}) => {
    const canvas = element('canvas', {width: 2 * SPHERE, height: SPHERE, role: 'img'}), said = element('p', {className: 'common'});
    figure.querySelector('figcaption').before(canvas, said);
    return {canvas, said};
  });
  for (const [k, {name, model}] of entries.entries()) {
    const {canvas, said} = places[k], draw = () => {
      renderer.show([{mode: 'fitted', x: 0, y: 0, size: SPHERE}, {mode: 'difference', x: SPHERE, y: 0, size: SPHERE}], {wipe: 0, stops: 0, mark: null});
      canvas.getContext('2d').clearRect(0, 0, 2 * SPHERE, SPHERE);
      canvas.getContext('2d').drawImage(renderer.canvas, 0, 0);
    };
    renderer.setModel(parseModel(JSON.stringify(model)));
    renderer.setMeasured(reference);  // whose exposure all have
    await finish(renderer, stale, draw);
    if (stale()) return;
    const {mean, at95} = compareImages(renderer.numbersOf(renderer.shown, 0), renderer.numbersOf(renderer.shown, 1), renderer.exposure);
    said.textContent = name === first.name ? 'under the light of all; the first' : `ΔE ${shortDeltaE(mean)} from ${first.name}: ${visibilityOf({mean, at95}).words}`;
    canvas.ariaLabel = `${name}: ${said.textContent}`;
  }
}
