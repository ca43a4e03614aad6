// A trefoil knot as triangles: positions and normals about the origin, within the unit sphere, and tangents along it.

export function knotMesh(around = 240, across = 28) {
  const vertices = [], indices = [];
  const point = t => {
    const r = 0.46 + 0.2 * Math.cos(3 * t);
    return [r * Math.cos(2 * t), r * Math.sin(2 * t), 0.26 * Math.sin(3 * t)];
  };
  const normalize = v => v.map(x => x / Math.hypot(...v));
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  for (let i = 0; i <= around; ++i) {
    const t = (2 * Math.PI * i) / around, p = point(t), before = point(t - 1e-3), after = point(t + 1e-3);
    const along = normalize(after.map((x, k) => x - before[k]));
    const bend = after.map((x, k) => x + before[k] - 2 * p[k]);
    const side = normalize(cross(along, bend)), out = cross(side, along);
    for (let j = 0; j <= across; ++j) {
      const a = (2 * Math.PI * j) / across;
      const n = side.map((x, k) => Math.cos(a) * x + Math.sin(a) * out[k]);
      vertices.push(...p.map((x, k) => 1.22 * (x + 0.145 * n[k])), ...n, ...along);
    }
  }
  const row = across + 1;
  for (let i = 0; i < around; ++i) {
    for (let j = 0; j < across; ++j) {
      const k = i * row + j;
      indices.push(k, k + 1, k + row, k + 1, k + row + 1, k + row);
    }
  }
  return {vertices: new Float32Array(vertices), indices: new Uint16Array(indices)};
}
