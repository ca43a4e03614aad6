// The page of one model: its beginning, and its controls.

import {drawCharts} from './charts.js';
import {DEGREES, byId, download, element, isDark, tell} from './dom.js';
import {listenToFiles} from './files.js';
import {bytesOf, decodeMeasured, directionsOf} from './measured.js';
import {History, checkedEdit, editedModel, noEdit} from './edit.js';
import {listenToEdits, makeEdits, onEdit, showEdits} from './edits.js';
import {probeEnvironment, studioEnvironment} from './environment.js';
import {visibilityOf} from './judge.js';
import {listenToKept} from './kept.js';
import {listenToLobe} from './lobe.js';
import {listenToMap} from './map.js';
import {evaluatorOf, formatModel, isNearlyDiffuse, parseModel} from './model.js';
import {DRAGS, LIGHTS, VIEWS, contents, edited, forget, hasSamples, hasViews, isModelBeside, isPictured, lampDirection, maxAngle, modelFileName, ownTitle, page, referenceTitle, state, stateText, takeState, whatTheLinkHolds} from './page_state.js';
import {applyLight, applyObject, becomeStill, drawPicture, frame, judge, layout, listenForRest} from './picture.js';
import {listenToPointer} from './pointer.js';
import {lookAgain, showNumbers} from './readout.js';
import {Renderer} from './renderer.js';
import {showFacts, showVerdict} from './said.js';
import {decodeSamples, usualThetaI} from './samples.js';
import {listenToHelp} from './words.js';

// Sliders of the plane in which light is shown, and what they set.
const PLANES = [['polar-theta', 'thetaI'], ['light-phi', 'lightPhi'], ['plane-phi', 'planePhi']];

function makeSegments(id, entries, key, change) {
  const legend = byId(id).querySelector('legend');
  byId(id).replaceChildren(legend, ...entries.map(([value, text]) => {
    const input = element('input', {type: 'radio', name: id, value, checked: state[key] === value});
    input.addEventListener('change', () => {
      state[key] = value;
      change();
    });
    return element('label', {}, input, text);
  }));
}

function showView() {
  byId('wipe-row').hidden = state.view !== 'wipe';
  byId('scale').hidden = !['side', 'difference'].includes(state.view);
  layout();
}

// A file has come: all that is shown is of what the page holds now.
function filesChanged() {
  if (!hasViews()) state.view = 'fitted';
  const names = isModelBeside() ? {measured: 'Beside', fitted: 'Model'} : page.modelFile.dropped ? {fitted: 'Model'} : {}, views = hasViews() ? VIEWS.compared : VIEWS.alone;
  makeSegments('views', views.map(([value, text]) => [value, names[value] ?? text]), 'view', showView);
  makeSegments('lights', LIGHTS, 'light', applyLight);
  byId('wipe-left').textContent = referenceTitle();
  byId('wipe-right').textContent = ownTitle();
  byId('map-what').textContent = `${ownTitle()} over ${isModelBeside() ? referenceTitle() : 'measured'}`;
  byId('fit-title').textContent = page.modelFile.dropped ? 'The model' : 'The fit';
  byId('views').hidden = !hasViews();
  byId('guess-key').hidden = page.renderer.isStill || (!isPictured() && maxAngle() >= 90);
  forget();
  page.renderer.leastCosine = maxAngle() < 90 ? Math.cos(maxAngle() / DEGREES) : 0;
  page.renderer.setMeasured(isPictured() ? page.measured : null);
  page.renderer.lamp = state.light === 'lamp' ? lampDirection() : null;
  page.renderer.environmentTurn = state.around;
  showControls();
  showVerdict();
  showFacts();
  showView();
  lookAgain();
}

function showControls() {
  byId('object').value = state.object;
  byId('exposure').value = state.exposure;
  byId('stops').textContent = state.exposure > 0 ? `+${state.exposure}` : state.exposure;
  byId('wipe').value = state.wipe;
  for (const [id, key] of PLANES) byId(id).value = state[key];
}

function applyTheme() {
  const dark = matchMedia('(prefers-color-scheme: dark)').matches;
  document.documentElement.dataset.theme = state.theme ?? (dark ? 'dark' : 'light');
  page.chartsStale = true;
}

// On paper the page is light, and its facts are unfolded.
function listenToPrint() {
  const facts = byId('fit').querySelector('details');
  let open = facts.open;
  window.addEventListener('beforeprint', () => {
    open = facts.open;
    facts.open = true;
    document.documentElement.dataset.theme = 'light';
    drawPicture(null);
    drawCharts();
  });
  window.addEventListener('afterprint', () => {
    facts.open = open;
    page.pictureStale = true;
    applyTheme();
  });
  facts.addEventListener('toggle', () => (page.chartsStale = true));
}

async function copyLink() {
  window.history.replaceState(null, '', `#${stateText()}`);
  let where = 'The link is copied';
  try {
    await navigator.clipboard.writeText(location.href);
  } catch {
    where = 'The address bar holds the link';
  }
  tell(`${where}: ${whatTheLinkHolds()}.`, true);
}

function listenToControls() {
  byId('exposure').addEventListener('input', () => {
    state.exposure = Number(byId('exposure').value);
    showControls();
    page.pictureStale = true;
  });
  byId('object').addEventListener('change', () => {
    state.object = byId('object').value;
    state.turn = state.object === 'flat' ? [0.5, -0.5] : [0, 0];
    applyObject();
  });
  byId('turntable').addEventListener('change', applyObject);
  for (const [id, key] of PLANES) {
    byId(id).addEventListener('input', () => {
      state[key] = Number(byId(id).value);
      page.chartsStale = true;
    });
  }
  for (const id of ['disc-lobe', 'chart-lobe', 'chart-channel']) byId(id).addEventListener('change', () => (page.chartsStale = true));
  byId('save').addEventListener('click', () => {
    download(formatModel(editedModel(page.base, state.edit), edited() ? 'in a page' : null), 'application/json', `${modelFileName()}.json`);
    tell('The model is among your downloads.', true);
  });
  byId('shot').addEventListener('click', () => {
    drawPicture(null);
    page.renderer.canvas.toBlob(blob => download(blob, 'image/png', `${modelFileName()}.png`));
    page.pictureStale = true;
  });
  byId('link').addEventListener('click', copyLink);
  byId('theme').addEventListener('click', () => {
    state.theme = isDark() ? 'light' : 'dark';
    applyTheme();
  });
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', applyTheme);
  new ResizeObserver(() => {
    layout();
    page.chartsStale = true;
  }).observe(byId('picture'));
  window.addEventListener('resize', () => (page.chartsStale = true));
}

function listen() {
  listenToControls();
  listenToPointer();
  listenToEdits();
  listenToKept();
  listenToLobe();
  listenToMap();
  listenToHelp();
  listenToFiles(filesChanged);
  listenForRest();
  listenToPrint();
  onEdit.change = () => {
    layout();
    showVerdict();
    lookAgain();
  };
  onEdit.settle = () => {
    showVerdict();
    showFacts();
  };
}

function takeContents() {
  const {measured} = contents;
  if (measured) page.measured = measured.kind === 'samples' ? decodeSamples(measured) : decodeMeasured(measured, measured.data);
  if (isPictured()) state.view = 'side';
  if (hasSamples()) state.thetaI = usualThetaI(page.measured);
  if (location.hash.length > 1) takeState(location.hash.slice(1));
  page.base = parseModel(contents.model);
  state.edit = checkedEdit(state.edit, page.base);
  page.history = new History(noEdit(page.base));
  page.history.push(state.edit);
  page.model = editedModel(page.base, state.edit);
  page.evaluate = evaluatorOf(page.model);
  page.environment = contents.probe ? probeEnvironment(contents.probe, bytesOf(contents.probe.data)) : studioEnvironment();
}

function makeRenderer() {
  const shaders = JSON.parse(byId('shaders').textContent), canvas = byId('canvas');
  try {
    page.renderer = new Renderer(canvas, file => shaders[file]);
  } catch (error) {
    return becomeStill(error.message);
  }
  page.renderer.onImage = level => {
    judge(level);
    lookAgain();
  };
  canvas.addEventListener('webglcontextlost', () => {
    becomeStill('the graphics card has dropped it');
    filesChanged();
  });
}

async function begin() {
  takeContents();
  applyTheme();
  makeRenderer();
  const {renderer} = page;
  renderer.setEnvironment(page.environment);
  renderer.object = state.object;
  renderer.turn = state.object === 'cloth' ? [state.turn[0], 0] : state.turn;
  renderer.lamp = state.light === 'lamp' ? lampDirection() : null;
  renderer.environmentTurn = state.around;
  renderer.setModel(page.model);
  makeSegments('drags', DRAGS, 'drag', () => {});
  makeEdits();
  filesChanged();
  showEdits();
  showNumbers();
  listen();
  requestAnimationFrame(frame);
}

// Objects for tests and for the curious.
window.trilobe = {state, contents, page, get renderer() { return page.renderer; }, get model() { return page.model; },
                  directionsOf, isNearlyDiffuse, visibilityOf};
begin().catch(error => {
  tell(error.message);
  console.warn(error);
});
