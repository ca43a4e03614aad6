// Files that are dropped on the page or opened: models and measurements.

import {byId, tell} from './dom.js';
import {History, noEdit} from './edit.js';
import {applyEdit, makeEdits} from './edits.js';
import {parseMerl} from './measured.js';
import {evaluatorOf, parseModel} from './model.js';
import {hasSamples, page, state} from './page_state.js';
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

// `shown` follows.
async function openFile(file, shown) {
  try {
    if (file.size > 200e6) throw new Error('the file is larger than 200 MB');
    const head = await file.slice(0, 400).text(), first = head.trimStart();
    if (first.startsWith('{')) {
      if (file.size > 16e6) throw new Error('a model of more than 16 MB');
      takeModel(file.name, parseModel(await file.text()));
    } else if (/theta_i/.test(head) || /\.csv$/i.test(file.name)) {
      takeMeasured(file.name, parseCsv(await file.text()));
    } else {
      takeMeasured(file.name, parseMerl(await file.arrayBuffer()));
    }
    shown();
    tell(`Opened ${file.name}.`, true);
  } catch (error) {
    tell(`${file.name}: ${error.message}.`);
  }
}

export function listenToFiles(shown) {
  const openAll = async files => {
    for (const file of files) await openFile(file, shown);
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
