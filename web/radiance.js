// A Radiance picture (.hdr; Ward 1991) as light from everywhere by latitude and longitude, as src/io/pictures/image_file.cc
// reads it.

import {probeEnvironment} from './environment.js';

const MOST_COLUMNS = 512;  // the limit of src/io/pictures/page.cc

// {width, height, begin}: `begin` of the pixels.
function radianceHeader(bytes) {
  let at = 0;
  const line = () => {
    const end = bytes.indexOf(10, at);
    if (end < 0) throw new Error('not a Radiance picture: its header does not end');
    const text = new TextDecoder().decode(bytes.subarray(at, end));
    at = end + 1;
    return text;
  };
  let known = false;
  for (let text = line(); text !== ''; text = line()) known ||= text === 'FORMAT=32-bit_rle_rgbe';
  const size = /^-Y (\d+) \+X (\d+)$/.exec(line());
  if (!known || !size) throw new Error('not a Radiance picture of RGBE rows from the top left');
  const [height, width] = [Number(size[1]), Number(size[2])];
  if (width !== 2 * height || height < 2) throw new Error(`the picture is ${width} x ${height} pixels; light by latitude and longitude is twice as wide as high`);
  return {width, height, begin: at};
}

// Bytes of RGBE, four a pixel.
function radiancePixels(bytes, {width, height, begin}) {
  const pixels = new Uint8Array(4 * width * height);
  let at = begin;
  const next = row => {
    if (at >= bytes.length) throw new Error(`row ${row} of the Radiance picture is cut off`);
    return bytes[at++];
  };
  for (let row = 0; row < height; ++row) {
    const first = 4 * row * width;
    if (width < 8 || width >= 1 << 15 || bytes[at] !== 2 || bytes[at + 1] !== 2 || bytes[at + 2] >= 128) {
      for (let k = 0; k < 4 * width; ++k) pixels[first + k] = next(row);
      continue;
    }
    at += 2;
    if (next(row) * 256 + next(row) !== width) throw new Error(`row ${row} of the Radiance picture has another length`);
    for (let c = 0; c < 4; ++c) {
      for (let x = 0; x < width;) {
        const code = next(row), run = code > 128, count = run ? code - 128 : code;
        if (count === 0 || count > width - x) throw new Error(`row ${row} of the Radiance picture is broken`);
        const value = run ? next(row) : 0;
        for (let k = 0; k < count; ++k) pixels[first + 4 * x++ + c] = run ? value : next(row);
      }
    }
  }
  return pixels;
}

// Throws an Error of one line. In at most MOST_COLUMNS: means of pixels.
export function parseRadiance(name, buffer) {
  const bytes = new Uint8Array(buffer), header = radianceHeader(bytes);
  const full = probeEnvironment({name, ...header}, radiancePixels(bytes, header));
  let step = 1;
  while (full.width / step > MOST_COLUMNS && full.width % (2 * step) === 0 && full.height % (2 * step) === 0) step *= 2;
  const width = full.width / step, height = full.height / step, data = new Float32Array(4 * width * height);
  for (let row = 0; row < full.height; ++row) {
    for (let column = 0; column < full.width; ++column) {
      const to = 4 * (Math.floor(row / step) * width + Math.floor(column / step)), from = 4 * (row * full.width + column);
      for (let c = 0; c < 4; ++c) data[to + c] += full.data[from + c] / (step * step);
    }
  }
  if (!data.some((x, k) => k % 4 !== 3 && x > 0)) throw new Error('the picture is black');
  return {name, width, height, data};
}
