// Light from everywhere by latitude and longitude, and the half vectors that pictures are summed over: those of
// src/model/appearance/environment.cc and mirrored_environment.cc.

export const DEGREE = Math.PI / 180;

const AREA_LIGHTS = [
  [35, -125, 18, 14, [9.0, 8.2, 7.0]],
  [10, 100, 35, 8, [2.2, 2.6, 3.4]],
  [15, 20, 10, 20, [4.0, 3.6, 4.4]],
];
const SUN = {latitude: 55, longitude: 150, radius: 3, radiance: [220, 200, 170]};

function smoothStep(from, to, x) {
  const t = Math.min(Math.max((x - from) / (to - from), 0), 1);
  return t * t * (3 - 2 * t);
}

// Difference of longitudes [degrees], the nearest way around.
function around(longitude, middle) {
  const x = longitude - middle;
  return x - 360 * Math.round(x / 360);
}

// {width, height, data: RGBA rows from +y down}, the middle column behind the object.
export function studioEnvironment() {
  const width = 512, height = 256, data = new Float32Array(4 * width * height);
  const mix = (at, color, scale) => {
    for (let c = 0; c < 3; ++c) data[at + c] += scale * color[c];
  };
  for (let row = 0; row < height; ++row) {
    const latitude = 90 - (180 * (row + 0.5)) / height;
    const sky = smoothStep(-3, 3, latitude), zenith = smoothStep(0, 90, latitude);
    for (let column = 0; column < width; ++column) {
      const longitude = 360 * ((column + 0.5) / width) - 180, at = 4 * (row * width + column);
      mix(at, [0.25, 0.45, 0.9], sky * zenith);
      mix(at, [0.8, 0.85, 0.9], sky * (1 - zenith));
      mix(at, [0.12, 0.1, 0.08], 1 - sky);
      for (const [lat, lon, halfHeight, halfWidth, radiance] of AREA_LIGHTS) {
        const far = Math.max(Math.abs(latitude - lat) / halfHeight, Math.abs(around(longitude, lon)) / halfWidth);
        if (far < 1.1) mix(at, radiance, 1 - smoothStep(0.9, 1.1, far));
      }
      const distance = Math.hypot(latitude - SUN.latitude,
                                  around(longitude, SUN.longitude) * Math.cos(SUN.latitude * DEGREE));
      if (distance < 1.2 * SUN.radius) mix(at, SUN.radiance, 1 - smoothStep(0.8 * SUN.radius, 1.2 * SUN.radius, distance));
      data[at + 3] = 1;
    }
  }
  return {name: 'studio', width, height, data};
}

// A probe as the page holds it: bytes of RGBE, four a pixel.
export function probeEnvironment({name, width, height}, bytes) {
  const data = new Float32Array(4 * width * height);
  for (let k = 0; k < width * height; ++k) {
    const scale = bytes[4 * k + 3] > 0 ? 2 ** (bytes[4 * k + 3] - 136) : 0;
    for (let c = 0; c < 3; ++c) data[4 * k + c] = bytes[4 * k + c] * scale;
    data[4 * k + 3] = 1;
  }
  return {name, width, height, data};
}

// The direction in the world (x right, y up, z to the eye) from which most light comes: of the brightest pixel.
export function brightestDirection({width, height, data}, turn = 0) {
  let best = 0, most = -1;
  for (let k = 0; k < width * height; ++k) {
    const light = data[4 * k] + data[4 * k + 1] + data[4 * k + 2];
    if (light > most) [most, best] = [light, k];
  }
  const theta = (Math.PI * (Math.floor(best / width) + 0.5)) / height;
  const phi = 2 * Math.PI * (((best % width) + 0.5) / width - 0.5 - turn);
  return [Math.sin(theta) * Math.sin(phi), Math.cos(theta), -Math.sin(theta) * Math.cos(phi)];
}

// Pieces of the half vectors about a normal: x, y, z and the solid angle [sr] of each.
export function halfCells() {
  const rings = 26, cells = [];
  const theta = ring => (Math.PI / 2) * (ring / rings) ** 2.5;
  for (let ring = 0; ring < rings; ++ring) {
    const inner = theta(ring), outer = theta(ring + 1), middle = theta(ring + 0.5);
    const count = 4 * Math.max(2, Math.round(((Math.PI / 2) * Math.sin(middle)) / (outer - inner) / 1.5));
    const angle = (2 * Math.PI * (Math.cos(inner) - Math.cos(outer))) / count;
    for (let k = 0; k < count; ++k) {
      const phi = (2 * Math.PI * k) / count + ring * Math.PI * (3 - Math.sqrt(5));
      cells.push(Math.sin(middle) * Math.cos(phi), Math.sin(middle) * Math.sin(phi), Math.cos(middle), angle);
    }
  }
  return cells;
}
