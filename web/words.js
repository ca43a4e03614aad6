// Explanations of words: a "?" beside each.

import {element} from './dom.js';

const WORDS = {
  angles: 'θi and θo: of light and eye from the normal. θh: of the half vector, midway between light and eye, from the normal; 0° in the middle of a highlight. θd: from the half vector to the light; 90° for grazing light. φd: around the half vector.',
  rho: 'The BRDF ρ: light to the eye for light that falls on the surface, in 1/sr, for red, green and blue.',
  albedo: 'Of light from all around that goes to this eye, the share; by symmetry also of light from there that is reflected. Above 1 the material would make light.',
  pdf: 'How densely a renderer that draws directions by this model would try this light, in 1/sr.',
  delta: 'ΔE: the difference of two colours to the eye, CIELAB 1976. Up to 1 in the mean nobody sees it.',
  rise: 'F grows towards grazing light (θd 90°): × 0 makes it flat, × 2 lets it rise twice as much above its value at θd 0°.',
  D: 'D(θh), in 1/sr: how many of the tiny mirrors lean by θh. A narrow D is a sharp highlight.',
  F: 'F(θd): how much a tiny mirror reflects, by the angle of the light to it.',
  G: 'G(θ): what is left of light and view where the tiny mirrors hide each other; it counts once for light and once for the eye.',
  roughness: 'Makes the highlight of this lobe so many times as wide, with the same light in all.',
};

// Opens on a click or a key; another click, or Escape, closes it.
export function help(word) {
  const text = element('span', {className: 'word', textContent: WORDS[word]});
  const made = element('details', {className: 'help'}, element('summary', {ariaLabel: `What is this: ${word}`, title: WORDS[word]}), text);
  made.addEventListener('toggle', () => {
    if (!made.open) return;
    // Keeps the text within the window.
    text.style.left = '0';
    const {left, right} = text.getBoundingClientRect(), width = document.documentElement.clientWidth;
    text.style.left = `${Math.max(8 - left, Math.min(0, width - 8 - right))}px`;
  });
  return made;
}

export function listenToHelp() {
  for (const place of document.querySelectorAll('[data-word]')) place.append(help(place.dataset.word));
  const close = except => document.querySelectorAll('.help[open]').forEach(open => open !== except && (open.open = false));
  document.addEventListener('click', event => close(event.target.closest('.help')));
  document.addEventListener('keydown', event => event.key === 'Escape' && close(null));
}
