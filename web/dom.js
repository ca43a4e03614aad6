// Small things of a page: its elements, its words, its numbers.

export const DEGREES = 180 / Math.PI;
export const byId = id => document.getElementById(id);

export function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}
export function swatch(color, className = 'swatch') {
  return Object.assign(element('i', {className}), {style: `background:${color}`});
}

export function tell(text, calm = false) {
  byId('message').textContent = text;
  byId('message').classList.toggle('calm', calm);
}

export const isDark = () => document.documentElement.dataset.theme === 'dark';
export const pageColor = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export function short(x) {
  if (!Number.isFinite(x)) return '–';
  if (x === 0) return '0';
  return Math.abs(x) >= 1e4 || Math.abs(x) < 1e-3 ? x.toExponential(2) : String(+x.toPrecision(3));
}
export const shortDeltaE = x => String(+x.toPrecision(2));  // digits of the report's verdict
export const shortAngle = degrees => `${+degrees.toFixed(1)}°`;
export const grouped = n => n.toLocaleString('en');
export const signed = x => `${x < 0 ? '−' : '+'}${short(Math.abs(x))}`;
export const counted = (n, one, many) => `${grouped(n)} ${n === 1 ? one : many}`;

export function download(bytes, type, file) {
  const link = element('a', {href: URL.createObjectURL(new Blob([bytes], {type})), download: file});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
