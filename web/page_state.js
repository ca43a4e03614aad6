// State of the page: its files, its model as it is edited, its settings, and the link that holds these.

import {byId, tell} from './dom.js';
import {isEdited} from './edit.js';
import {DEGREE, brightestDirection} from './environment.js';
import {isNearlyDiffuse} from './model.js';
import {LOBE_COLORS} from './plots.js';

export const contents = JSON.parse(byId('data').textContent);

export const VIEWS = {
  compared: [['side', 'Side by side'], ['wipe', 'Wipe'], ['difference', 'Difference'], ['measured', 'Measured'], ['fitted', 'Fitted']],
  alone: [['fitted', 'Fitted']],
};
export const LIGHTS = [['environment', 'All around'], ['lamp', 'One lamp']];
export const OBJECTS = ['sphere', 'knot', 'cloth', 'flat'];
export const DRAGS = [['light', 'Light'], ['object', 'Object']];

// Settings, which a link holds.
export const state = {
  view: 'fitted', object: 'sphere', light: 'environment', lamp: [-0.35, 0.4], around: 0, turn: [0, 0], exposure: 0, wipe: 0.5,
  theme: null, size: 0, edit: null, thetaI: 45, planePhi: 0, lightPhi: 0, lobeTurn: 30, phiD: null, drag: 'light',
  log: {D: true, F: null, G: null, slice: true, albedo: false, trace: true},  // null: by the values
};

// The rest. `model` is `base` with the edit; `measured` a table, nodes or samples, or null. Of each file, its name and
// whether it was dropped on the page; `measured` may also be another model. `seen` is how far apart the two are as
// shown: null while it is not known, false where there is nothing to see.
export const page = {
  base: null, model: null, evaluate: null, measured: null, environment: null, renderer: null, history: null,
  modelFile: {name: contents.name, dropped: false}, measuredFile: contents.measured ? {name: contents.source, dropped: false} : null,
  lightFile: null, point: null, dragging: null, seen: null, heat: null, heatAt: null, albedo: null, kept: [],
  pictureStale: true, chartsStale: true,
};

export const hasMeasured = () => page.measured !== null;
export const hasSamples = () => page.measured?.kind === 'samples';
// Whether there is a picture of what was measured.
export const isPictured = () => hasMeasured() && !hasSamples();
// Whether the picture has views to choose from.
export const hasViews = () => isPictured() && (!page.renderer?.isStill || drawnParts().difference);
// Of which parts the spheres in the page are as they came; a part that came in no file is none.
export function drawnParts() {
  const measured = hasMeasured() && !page.measuredFile.dropped, fitted = !page.modelFile.dropped;
  return {measured, fitted, difference: measured && fitted && isPictured()};
}
export const isModelBeside = () => page.measured?.kind === 'model';
export const isMeasuredAnisotropic = () => page.measured?.kind === 'nodes' || Boolean(page.measured?.model?.anisotropic);
export const edited = () => isEdited(state.edit, page.base);
export const lobesText = model => `${model.lobes} ${model.lobes === 1 ? 'lobe' : 'lobes'}`;
export const lobeName = m => `lobe ${m + 1}${isNearlyDiffuse(page.base, m) ? ' (nearly diffuse)' : ''}`;
export const lobeColor = m => LOBE_COLORS[m % LOBE_COLORS.length];

// Drops results that depend on the model and on what is beside it.
export function forget() {
  page.heat = page.heatAt = page.seen = page.albedo = null;
  page.chartsStale = true;
}

// The largest angle that was measured [degrees], 90 if nothing says less.
export function maxAngle() {
  if (page.measured?.maxTheta) return page.measured.maxTheta / DEGREE;
  return hasMeasured() ? 90 : page.base.json.fit?.max_angle ?? 90;
}

// ---- Names -------------------------------------------------------------------------------------------------------

const droppedFiles = () => [page.modelFile, page.measuredFile].filter(file => file?.dropped).map(file => file.name);

// Whether the page still has the two files that it came with, for which its words on the fit hold.
export const asItCame = () => droppedFiles().length === 0;

// Names of all that is shown.
export function heading() {
  const {modelFile, measuredFile} = page;
  return measuredFile && !asItCame() ? `${modelFile.name} beside ${measuredFile.name}` : modelFile.name;
}
// Name of the model that is shown, for a title and within a sentence: a dropped one is no fit of the page.
const isOther = () => page.modelFile.dropped || isModelBeside();
export const ownTitle = () => (isOther() ? page.modelFile.name : 'Fitted');
export const ownWord = () => (isOther() ? page.modelFile.name : 'the fit');
export const ownAdjective = () => (isOther() ? 'modelled' : 'fitted');
// Name of the measurement or model beside, for a title and within a sentence.
export const referenceTitle = () => (isModelBeside() ? page.measuredFile.name : 'Measured');
export const referenceWord = () => (isModelBeside() ? 'beside' : 'measured');
// Name of the model for files, without an extension.
export function modelFileName() {
  const name = page.modelFile.name.replace(/\.json$/i, '').replace(/[^\w.-]+/g, '_');
  return edited() ? `${name}_edited` : name;
}

// ---- The link ----------------------------------------------------------------------------------------------------

export function stateText() {
  const dropped = droppedFiles();
  const kept = {...state, edit: edited() ? state.edit : undefined, dropped: dropped.length > 0 ? dropped : undefined, lightFile: page.lightFile?.name};
  const bytes = new TextEncoder().encode(JSON.stringify(kept));
  return btoa(String.fromCharCode(...bytes)).replace(/\+/g, '-').replace(/\//g, '_').replace(/=+$/, '');
}

export function whatTheLinkHolds() {
  const dropped = [...droppedFiles(), ...[page.lightFile, ...page.kept].filter(Boolean).map(({name}) => name)];
  return dropped.length === 0 ? 'it opens this page as it looks now'
    : `it holds the settings, but not ${dropped.join(' and ')}, to be dropped on the page again`;
}

export function takeState(text) {
  try {
    const bytes = Uint8Array.from(atob(text.replace(/-/g, '+').replace(/_/g, '/')), c => c.charCodeAt(0));
    const given = JSON.parse(new TextDecoder().decode(bytes));
    const pair = x => Array.isArray(x) && x.length === 2 && x.every(Number.isFinite);
    const number = (key, low, high) => {
      if (Number.isFinite(given[key])) state[key] = Math.min(Math.max(given[key], low), high);
    };
    if (VIEWS.compared.some(([v]) => v === given.view)) state.view = given.view;
    if (OBJECTS.includes(given.object)) state.object = given.object;
    if (LIGHTS.some(([l]) => l === given.light)) state.light = given.light;
    if (DRAGS.some(([d]) => d === given.drag)) state.drag = given.drag;
    if (pair(given.lamp)) state.lamp = given.lamp;
    if (pair(given.turn)) state.turn = given.turn;
    if (['light', 'dark'].includes(given.theme)) state.theme = given.theme;
    number('around', -1, 1);
    number('exposure', -4, 4);
    number('wipe', 0, 1);
    number('size', 0, 512);
    number('thetaI', 0, 85);
    number('planePhi', 0, 175);
    number('lightPhi', 0, 355);
    number('lobeTurn', -180, 180);
    number('phiD', 0, 175);
    for (const key of Object.keys(state.log)) if (typeof given.log?.[key] === 'boolean') state.log[key] = given.log[key];
    const dropped = Array.isArray(given.dropped) ? given.dropped.filter(name => typeof name === 'string') : [];
    // An edit is of the model that it was made on.
    state.edit = dropped.length > 0 ? null : given.edit ?? null;
    const missing = typeof given.lightFile === 'string' ? [...dropped, given.lightFile] : dropped;
    if (missing.length > 0) {
      tell(`The link was made with ${missing.join(' and ')}, which it does not hold; drop ${missing.length > 1 ? 'them' : 'it'} here to see the same.`);
    }
  } catch {
    tell('The link holds no state that this page knows; it shows the model as it is.');
  }
}

// ---- Light -------------------------------------------------------------------------------------------------------

// The lamp stands where the surface with the normal at (x, y) of a sphere mirrors it to the eye.
export function lampDirection() {
  let [x, y] = state.lamp;
  const r = Math.hypot(x, y);
  if (r > 0.98) [x, y] = [(0.98 * x) / r, (0.98 * y) / r];
  const z = Math.sqrt(1 - x * x - y * y);
  return [2 * z * x, 2 * z * y, 2 * z * z - 1];
}
export function lightDirection() {
  return state.light === 'lamp' ? lampDirection() : brightestDirection(page.environment, state.around);
}
