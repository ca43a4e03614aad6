// Text of the page: the heading, the verdict, notes and facts.

import {byId, counted, element, grouped, short, shortDeltaE} from './dom.js';
import {visibilityOf} from './judge.js';
import {asItCame, contents, drawnParts, edited, hasMeasured, hasSamples, heading, isModelBeside, isPictured, lobesText, ownTitle, ownWord, page, referenceTitle, state} from './page_state.js';

const NOTABLE_REACH = 2;  // the limit of the program's summary

// How far apart the two are: of the fit as it came the report's, else the page's own, {words, name, mean, at95, of}, or null
// while that is not known.
export function judgement() {
  if (asItCame() && !edited() && contents.verdict) {
    return {words: contents.verdict, name: contents.visibility, mean: contents.mean_delta_e, at95: contents.delta_e_95,
            of: contents.of_sphere ? 'the sphere' : 'the samples'};
  }
  if (!page.seen) return null;
  return {...visibilityOf(page.seen), ...page.seen, of: hasSamples() ? 'the samples' : `the ${state.object} as it is lit now`};
}

// Whether the picture is that on which the report's verdict rests.
export function asJudged() {
  return asItCame() && !edited() && !page.lightFile && Boolean(contents.verdict) && contents.of_sphere && state.object === 'sphere' &&
    state.light === 'environment' && state.around === 0 && state.turn.every(x => x === 0);
}

function verdictParts() {
  const judged = judgement(), parts = [];
  if (!hasMeasured() && !(judged && contents.source)) {
    return [`A fitted model of ${lobesText(page.base)}. Drop its measurement here (MERL or CSV) to see where they differ.`];
  }
  const beside = isModelBeside() ? `Beside ${page.measuredFile.name}` : 'Beside what was measured', what = ownWord();
  parts.push(edited() ? `The model has been changed since. ${beside}, it: ` : `${beside}, ${what}: `);
  if (!judged && page.renderer?.isStill && !hasSamples()) {
    return [`${edited() ? 'The model has been changed since. ' : ''}How far apart pictures of the two are is not told without WebGL 2; the map says where they differ.`];
  }
  if (!judged) return [edited() ? 'The model has been changed since, and is being compared.' : isModelBeside() ? 'The two models are being compared.' : 'Being compared with what was measured.'];
  parts.push(element('b', {className: judged.name, textContent: judged.words}),
             `. Colours are ΔE ${shortDeltaE(judged.mean)} apart in the mean, and 95 % of ${judged.of} stay below ` +
             `${shortDeltaE(judged.at95)}; up to 1 and 2.3 they cannot be told apart.`);
  if (!hasMeasured()) parts.push(' The measurement makes no picture beside a model of this form.');
  return parts;
}

function notes() {
  const {reach} = contents, said = [];
  if (page.measured?.leftOut) said.push(`${counted(page.measured.leftOut, 'row', 'rows')} of the file are below the surface or negative, and left out`);
  if (hasSamples() && page.measured.samples.length < page.measured.count) {
    said.push(`the page holds ${grouped(page.measured.samples.length)} of ${grouped(page.measured.count)} samples`);
  }
  if (!asItCame()) return said;
  const fitted = edited() ? 'as it was fitted: ' : '';
  if (page.measured?.kind === 'nodes') {
    said.push('between its nodes the measurement is linear on this page, which blurs narrow highlights; the verdict takes them as the fit has them');
  }
  if (reach >= NOTABLE_REACH) {
    said.push(`${fitted}between the samples the model reaches ${short(reach)} times the largest measured value`);
  }
  return [...contents.notes.map(note => fitted + note), ...said];
}

export function showVerdict() {
  byId('name').textContent = heading();
  document.title = `${heading()} · Trilobe`;
  byId('verdict').replaceChildren(...verdictParts());
  const said = notes();
  byId('notes').hidden = said.length === 0;
  byId('notes').replaceChildren(...said.map(note => element('li', {textContent: `${note[0].toUpperCase()}${note.slice(1)}.`})));
}

export function showFacts() {
  const {base, measuredFile, modelFile} = page, {fit = {}} = base.json, rows = [];
  byId('formula').textContent = base.lobes > 0
    ? 'ρ is the diffuse colour and, for each lobe, its strength × D(θh) × F(θd) × G(θi) G(θo) / (cos θi cos θo). Lines mark the point under the pointer.'
    : 'ρ is the diffuse colour alone.';
  const row = (title, value) => value !== undefined && value !== '' && value !== 0 &&
    rows.push(element('tr', {}, element('th', {textContent: title, scope: 'row'}), element('td', {textContent: value})));
  if (modelFile.dropped) row('model', modelFile.name);
  row('fitted to', fit.source);
  row('samples', fit.valid_samples ? grouped(fit.valid_samples) : '');
  row('up to', fit.max_angle ? `${fit.max_angle}° from the normal` : '');
  if (hasMeasured()) row('shown beside', `${measuredFile.name}, ${besideText()}`);
  if (page.lightFile) row('light', page.lightFile.name);
  if (asItCame() && contents.verdict) row('measured', `${short(100 * contents.measured_share)} % of what a renderer reads`);
  row('form', `${base.anisotropic ? 'anisotropic' : 'isotropic'}, ${formText()}`);
  if (!modelFile.dropped && !edited()) contents.ggx.forEach((text, m) => row(`lobe ${m + 1} as GGX`, text));
  if (!modelFile.dropped) row('spectra', contents.wavelengths && `${contents.wavelengths}; shown are their colours`);
  row('solver', fit.solver ? `${fit.solver}${fit.iterations ? `, ${fit.iterations} iterations` : ''}` : '');
  row('stopped', fit.stop_reason);
  row('seconds', fit.seconds ? short(fit.seconds) : '');
  row('PSNR', asItCame() && contents.verdict && contents.psnr_db ? `${short(contents.psnr_db)} dB` : '');
  row('by', [fit.program, fit.date].filter(Boolean).join(', '));
  byId('facts').replaceChildren(...rows);
  byId('trace-figure').hidden = modelFile.dropped || contents.trace.length < 2;
  byId('difference').hidden = !hasMeasured();
  for (const id of ['chart-d', 'chart-f', 'chart-g']) byId(id).closest('figure').hidden = base.lobes === 0;
  byId('disc-figure').hidden = !(base.lobes > 0 && base.axes.D.phis > 1);
}

const besideText = () => (isModelBeside() ? lobesText(page.measured.model) : counted(page.measured.count, 'sample', 'samples'));

function formText() {
  const numbers = page.modelFile.dropped || !contents.parameters ? '' : `, ${grouped(contents.parameters)} numbers`;
  return lobesText(page.base) + numbers;
}

// Caption of a panel: [title, text].
export function captionOf(mode) {
  const changed = edited() ? ', edited' : '';
  const title = ownTitle(), {renderer} = page;
  if (renderer?.isStill && !(renderer.isHeld && drawnParts()[mode === 'wipe' ? 'difference' : mode])) {
    return [mode === 'measured' ? referenceTitle() : mode === 'fitted' ? title : 'Where they differ', 'no picture of it is in the page'];
  }
  if (renderer?.isStill && mode === 'fitted' && changed) return [title, 'as it came, without what was changed'];
  if (mode === 'measured') return [referenceTitle(), besideText()];
  if (mode === 'fitted') return [`${title}${changed}`, formText()];
  if (mode === 'wipe') return [`${referenceTitle()} | ${title}${changed}`, 'move the line below the picture, or drag it'];
  const mean = asJudged() ? contents.mean_delta_e : page.seen?.mean;
  if (!Number.isFinite(mean)) return ['Where they differ', 'to the eye'];
  return ['Where they differ', `ΔE ${shortDeltaE(mean)} in the mean${asJudged() ? '' : ', as shown'}`];
}

// The canvas in words.
export function pictureLabel() {
  const light = page.lightFile ? ` by ${page.lightFile.name}` : '';
  const own = ownTitle().replace('Fitted', 'fitted'), other = isModelBeside() ? referenceTitle() : 'measured';
  const what = {side: `${other}, ${own} and their difference`, wipe: `${other} on the left, ${own} on the right`, difference: `the difference of ${other} and ${own}`,
                measured: other, fitted: own}[state.view];
  const judged = isPictured() ? judgement() : null;
  return `${heading()} on a ${state.object === 'flat' ? 'flat sample' : state.object}: ${what}` +
    `${state.light === 'lamp' ? ', by one lamp' : `, lit all around${light}`}${judged ? `. ΔE ${shortDeltaE(judged.mean)} in the mean: ${judged.words}` : ''}`;
}
