// Files that are dropped on the page or opened: models, two of them beside each other; measurements; and light.

import {byId, tell} from './dom.js';
import {History, noEdit} from './edit.js';
import {applyEdit, makeEdits} from './edits.js';
import {keepModel} from './kept.js';
import {parseMerl} from './measured.js';
import {evaluatorOf, parseModel} from './model.js';
import {forget, hasSamples, page, state} from './page_state.js';
import {parseRadiance} from './radiance.js';
import {parseCsv, usualThetaI} from './samples.js';

function takeModel(name, parsed) {
  evaluatorOf(parsed);
  page.base = parsed;
  page.modelFile = {name, dropped: true};
  state.edit = noEdit(parsed);
  page.history = new History(state.edit);
  makeEdits();
  page.renderer.exposure = 0;
  applyEdit();
}

function takeMeasured(name, measured) {
  page.measured = measured;
  page.measuredFile = {name, dropped: true};
  state.view = 'side';
  if (hasSamples()) state.thetaI = usualThetaI(measured);
}

// In place of a measurement.
function takeModelBeside(name, model) {
  const evaluate = evaluatorOf(model), rho = (wi, wo) => evaluate(wi, wo).rho;
  const distinct = page.modelFile.name !== name ? name : `${name} (${model.json.fit?.source || 'the other'})`;
  takeMeasured(distinct, {kind: 'model', model, rho, shape: [45, 45, 16]});
}

function takeLight(name, environment) {
  page.environment = environment;
  page.lightFile = {name};
  state.light = 'environment';
  state.around = 0;
  page.renderer.setEnvironment(environment);
}

const WHAT_IS_READ = 'a model of trilobe (.json), a MERL measurement (.binary), a table with the header theta_i,phi_i,theta_o,phi_o,r,g,b in degrees (.csv), or light (.hdr)';

// Whether bytes are letters: a MERL file begins with three numbers of four bytes, in which zeros are.
const isText = bytes => bytes.every(byte => byte >= 32 || (byte >= 9 && byte <= 13));

// `shown` follows. Of models that are opened together, `before` came before: the second goes beside the first, and others
// into the charts.
async function openFile(file, before, shown) {
  try {
    if (file.size > 200e6) throw new Error('the file is larger than 200 MB');
    const head = await file.slice(0, 400).text(), first = head.trimStart();
    if (first.startsWith('{')) {
      if (file.size > 16e6) throw new Error('a model of more than 16 MB');
      const model = parseModel(await file.text());
      if (before === 0) takeModel(file.name, model);
      else if (before === 1) takeModelBeside(file.name, model);
      else keepModel(file.name, model);
    } else if (head.startsWith('#?')) {
      takeLight(file.name, parseRadiance(file.name, await file.arrayBuffer()));
    } else if (/theta_i/.test(head) || /\.csv$/i.test(file.name)) {
      takeMeasured(file.name, parseCsv(await file.text()));
    } else if (isText(new Uint8Array(await file.slice(0, 400).arrayBuffer()))) {
      throw new Error(`a text that is none of what this page reads: ${WHAT_IS_READ}. trilobe fit reads more tables`);
    } else {
      takeMeasured(file.name, parseMerl(await file.arrayBuffer()));
    }
    forget();
    shown();
    tell(`Opened ${file.name}.`, true);
    return first.startsWith('{');
  } catch (error) {
    tell(`${file.name}: ${error.message}.`);
    return false;
  }
}

export function listenToFiles(shown) {
  const openAll = async files => {
    let models = 0;
    for (const file of files) models += (await openFile(file, models, shown)) ? 1 : 0;
  };
  byId('open').addEventListener('click', () => byId('file').click());
  byId('file').addEventListener('change', async () => {
    await openAll([...byId('file').files]);
    byId('file').value = '';
  });
  const drop = byId('drop');
  document.addEventListener('dragover', event => {
    event.preventDefault();
    drop.hidden = false;
  });
  document.addEventListener('dragleave', event => {
    if (!event.relatedTarget) drop.hidden = true;
  });
  document.addEventListener('drop', event => {
    event.preventDefault();
    drop.hidden = true;
    openAll([...event.dataTransfer.files]);
  });
}
