// Actions of the pointer and the keys on the picture.

import {byId, tell} from './dom.js';
import {isMeasuredAnisotropic, page, state} from './page_state.js';
import {applyLight, applyObject, placeOf} from './picture.js';
import {lookAgain, lookAt} from './readout.js';

function moveLine(at) {
  state.wipe = Math.min(Math.max((at[0] + 1) / 2, 0), 1);
  byId('wipe').value = state.wipe;
  page.pictureStale = true;
}

function turnObject(by) {
  state.turn = [state.turn[0] + by[0], state.turn[1] + by[1]];
  if (state.object === 'sphere' && !page.model.anisotropic && !isMeasuredAnisotropic()) {
    state.turn = [0, 0];
    tell('A sphere of this material looks alike from all sides; choose another object to turn it.', true);
    return;
  }
  applyObject();
  lookAgain();
}

function press(event) {
  const place = placeOf(event);
  if (!place) return;
  const onLine = state.view === 'wipe' && Math.abs((place.at[0] + 1) / 2 - state.wipe) < 0.04;
  const what = onLine ? 'line' : page.renderer.isStill ? 'point' : event.shiftKey ? 'object' : state.drag;
  page.dragging = {panel: place.panel, what, x: event.clientX, at: place.at, around: state.around, turn: state.turn, moved: false};
  if (!onLine) lookAt(place.at);
}

function drag(event) {
  const place = placeOf(event), {dragging} = page;
  if (!place) return;
  if (!dragging) {
    if (event.pointerType === 'mouse') lookAt(place.at);
    return;
  }
  if (dragging.what === 'line') return moveLine(place.at);
  if (dragging.what === 'point') return lookAt(place.at);
  // A finger that begins to scroll has not moved the light.
  if (!dragging.moved && Math.hypot(...place.at.map((x, k) => x - dragging.at[k])) * place.panel.css < 6) return;
  if (!dragging.moved) byId('canvas').setPointerCapture(event.pointerId);
  dragging.moved = true;
  if (dragging.what === 'object') {
    state.turn = dragging.turn;
    turnObject([1.6 * (place.at[0] - dragging.at[0]), 1.6 * (place.at[1] - dragging.at[1])]);
  } else {
    if (state.light === 'lamp') state.lamp = place.at;
    else state.around = dragging.around - (event.clientX - dragging.x) / (3 * place.panel.css);
    applyLight();
  }
  lookAt(place.at);
}

// A tap sets the lamp.
function release(event) {
  const {dragging} = page;
  if (!dragging) return;
  page.dragging = null;
  if (event.type === 'pointerup' && dragging.what === 'light' && !dragging.moved && state.light === 'lamp') state.lamp = dragging.at;
  if (!['line', 'point'].includes(dragging.what)) applyLight();
}

function pressKey(event) {
  const step = {ArrowLeft: [-0.05, 0], ArrowRight: [0.05, 0], ArrowUp: [0, 0.05], ArrowDown: [0, -0.05]}[event.key];
  if (!step) return;
  event.preventDefault();
  if (event.shiftKey || page.renderer.isStill) {
    const at = page.point?.at ?? [0, 0];
    lookAt(at.map((x, k) => Math.min(Math.max(x + step[k], -1), 1)));
    if (!page.point) lookAt(at);
  } else if (event.altKey || event.ctrlKey || state.drag === 'object') {
    turnObject([2 * step[0], 2 * step[1]]);
  } else {
    if (state.light === 'lamp') state.lamp = state.lamp.map((x, k) => Math.min(Math.max(x + step[k], -0.98), 0.98));
    else state.around -= step[0] / 2;
    applyLight();
  }
}

export function listenToPointer() {
  const canvas = byId('canvas');
  canvas.addEventListener('pointerdown', press);
  canvas.addEventListener('pointermove', drag);
  canvas.addEventListener('pointerup', release);
  canvas.addEventListener('pointercancel', release);
  canvas.addEventListener('keydown', pressKey);
  byId('wipe').addEventListener('input', () => moveLine([2 * byId('wipe').value - 1, 0]));
}
