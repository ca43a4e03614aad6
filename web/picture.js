// The picture: where its panels are, what stands below them, and when it is drawn again.

import {continueAlbedo} from './albedo.js';
import {byId, element, tell} from './dom.js';
import {drawCharts} from './charts.js';
import {drawAlbedo} from './light_charts.js';
import {compareImages, compareSamples} from './judge.js';
import {contents, drawnParts, edited, hasSamples, isPictured, lampDirection, page, state} from './page_state.js';
import {lookAgain} from './readout.js';
import {captionOf, pictureLabel, showVerdict} from './said.js';
import {StillPicture} from './still.js';

let panels = [], shape = [1, 1];

export function layout() {
  const picture = byId('picture'), canvas = byId('canvas'), width = picture.clientWidth;
  const scale = Math.min(window.devicePixelRatio || 1, 2), gap = 14;
  const modes = state.view === 'side' ? ['measured', 'fitted', 'difference'] : [state.view];
  const columns = modes.length === 1 ? 1 : width < 460 ? 2 : 3, caption = columns === 1 || width / columns > 220 ? 46 : 62;  // one more line
  if (width === 0) return;  // not on a screen
  const size = Math.floor(Math.min((width - gap * (columns + 1)) / columns, modes.length === 1 ? 560 : 620,
                                   Math.max(window.innerHeight * 0.46, 220)));
  const rows = Math.ceil(modes.length / columns), height = rows * (size + caption + gap) + gap / 2;
  canvas.style.height = `${height}px`;
  const [w, h] = [Math.round(width * scale), Math.round(height * scale)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  shape = [width, height];
  panels = modes.map((mode, k) => {
    const row = Math.floor(k / columns), inRow = Math.min(columns, modes.length - row * columns);
    const left = (width - inRow * size - (inRow - 1) * gap) / 2 + (k % columns) * (size + gap);
    const top = gap + row * (size + caption + gap);
    return {mode, left, top, css: size, x: Math.round(left * scale), y: Math.round(top * scale), size: Math.round(size * scale)};
  });
  showCaptions();
  keepInSight();
  page.renderer.setSize(state.size || Math.min(Math.max(Math.round(size * scale), 96), 512));
  page.pictureStale = true;
}

// The picture stays at the top of a window that is high enough to show controls below it; what gets the focus is not
// scrolled to where the picture covers it.
const MOST_COVERED = 0.65;
function keepInSight() {
  const stage = document.querySelector('.stage'), height = Math.ceil(stage.getBoundingClientRect().height);
  const stays = window.innerWidth > 900 && height <= MOST_COVERED * window.innerHeight;
  stage.classList.toggle('stays', stays);
  document.documentElement.style.scrollPadding = stays ? `${height + 8}px 0 8px` : '';
}

function showCaptions() {
  byId('captions').replaceChildren(...panels.map(({mode, left, top, css}) => {
    const [title, text] = captionOf(mode);
    const made = element('div', {}, element('b', {textContent: title}), text);
    // In parts of the picture, which is narrower in print.
    const part = (x, axis) => `${(100 * x) / shape[axis]}%`;
    Object.assign(made.style, {left: part(left, 0), top: part(top + css + 4, 1), width: part(css, 0)});
    return made;
  }));
  byId('canvas').ariaLabel = pictureLabel();
}

// Panel of an event, and the place in it: from -1 to 1, y up.
export function placeOf(event) {
  const box = byId('canvas').getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
  for (const panel of panels) {
    const at = [(2 * (x - panel.left)) / panel.css - 1, 1 - (2 * (y - panel.top)) / panel.css];
    if (page.dragging?.panel === panel || (Math.abs(at[0]) <= 1 && Math.abs(at[1]) <= 1)) return {panel, at};
  }
  return null;
}

// ---- Changes of the picture --------------------------------------------------------------------------------------

function restart() {
  page.renderer.moving = page.dragging !== null || byId('turntable').checked;
  page.renderer.restart();
  if (!hasSamples()) page.seen = null;
  showCaptions();
}

export function applyLight() {
  page.renderer.lamp = state.light === 'lamp' ? lampDirection() : null;
  page.renderer.environmentTurn = state.around;
  restart();
  lookAgain();
}

export function applyObject() {
  page.renderer.object = state.object;
  page.renderer.turn = state.object === 'cloth' ? [state.turn[0], 0] : state.turn;
  restart();
}

function showSeen(seen) {
  page.seen = seen;
  showCaptions();
  showVerdict();
}

// How far apart the two are as shown, of a picture of the size at which that is told.
export function judge(level) {
  const {renderer} = page;
  if (!isPictured() || level.size !== renderer.judgedSize || renderer.moving) return;
  showSeen(compareImages(renderer.numbersOf(level, 0), renderer.numbersOf(level, 1), renderer.exposure));
}

export function drawPicture(mark = page.point?.at ?? null) {
  const {width, height} = byId('canvas');
  page.renderer.show(panels, {wipe: state.wipe, stops: state.exposure, mark, width, height, valid: drawnParts()});
  page.pictureStale = false;
}

// From now on the picture is what the page holds of it.
export function becomeStill(why) {
  if (page.renderer?.isStill) return;
  page.renderer = new StillPicture(byId('picture'), contents.spheres, why, () => {
    layout();
    page.pictureStale = true;
  });
  Object.assign(state, {object: 'sphere', light: 'environment', around: 0, turn: [0, 0], exposure: 0});
  byId('turntable').checked = false;
  for (const id of ['object', 'lights', 'drags', 'exposure', 'turntable']) byId(id).disabled = true;
  byId('keys').textContent = 'Point at the sphere to look closer, or move the point by the arrow keys.';
  byId('still-why').hidden = false;
  byId('still-why').textContent = `The picture stands still here, as ${why}: neither object nor light can be moved. All else works. ` +
    (contents.spheres ? 'The program drew what is shown.' : 'The page holds none that the program drew; one that a newer trilobe writes does.');
}

// ---- Frame by frame ----------------------------------------------------------------------------------------------

function turn(seconds) {
  if (state.object === 'sphere' && state.light === 'lamp') {
    const [x, y] = state.lamp, c = Math.cos(seconds * 0.8), s = Math.sin(seconds * 0.8);
    state.lamp = [x * c - y * s, x * s + y * c];
    applyLight();
  } else if (state.object === 'sphere') {
    state.around = (state.around + seconds * 0.08) % 1;
    applyLight();
  } else {
    state.turn = [state.turn[0] + seconds * 0.6, state.turn[1]];
    applyObject();
  }
}

// How far the picture is, once that takes longer: over all its sizes, so that it never falls.
function progressText({finer, secondsLeft, isSoftware}) {
  if (finer === null) return '';
  const left = finer < 0.03 ? '' : secondsLeft >= 90 ? `, some ${Math.round(secondsLeft / 60)} min left` : secondsLeft >= 10 ? `, some ${Math.round(secondsLeft / 5) * 5} s left` : '';
  return `finer: ${Math.floor(100 * finer)} %${left}${left && isSoftware ? ', as no graphics card helps' : ''}`;
}

function showProgress() {
  const text = progressText(page.renderer);
  if (byId('progress').textContent !== text) byId('progress').textContent = text;
}

// While nobody does anything, the page may wait for the picture.
const IDLE_MS = 600, IDLE_SLICE_MS = 150, BUSY_SLICE_MS = 30;
let lastInput = 0;
export function listenForRest() {
  for (const type of ['pointermove', 'pointerdown', 'keydown', 'input', 'wheel', 'scroll']) {
    window.addEventListener(type, () => (lastInput = performance.now()), {passive: true, capture: true});
  }
}

let before = 0;
let chartsAreDone = false;
function workOnCharts() {
  chartsAreDone = false;
  if (page.chartsStale) drawCharts();
  else if (!page.dragging && continueAlbedo()) drawAlbedo();
  else chartsAreDone = true;
  if (hasSamples() && page.seen === null && !page.dragging) showSeen(compareSamples(page.measured.samples, page.evaluate) ?? false);
}

function workOnPicture() {
  const {renderer} = page;
  const idle = chartsAreDone && renderer.finer !== null && performance.now() - lastInput > IDLE_MS;
  renderer.slice = idle ? IDLE_SLICE_MS : BUSY_SLICE_MS;
  if (renderer.work(!edited())) page.pictureStale = true;
  if (page.pictureStale) drawPicture();
  showProgress();
}

// Charts come first and do not wait for the picture, which takes minutes without a graphics card; nor does an error of
// the one keep the other from being drawn.
export function frame(now) {
  requestAnimationFrame(frame);
  if (byId('turntable').checked) turn(Math.min(now - before, 100) / 1000);
  before = now;
  const errors = [workOnCharts, workOnPicture].map(work => {
    try {
      work();
      return null;
    } catch (error) {
      if (work === workOnPicture) becomeStill(`drawing it failed (${error.message})`);
      return error;
    }
  }).filter(Boolean);
  if (errors.length === 0) return;
  tell(errors[0].message);
  throw errors[0];
}
