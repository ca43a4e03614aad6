// A model as the shader reads it: the same texture and macros as src/io/pictures/shader_file.cc makes, but d and s as uniforms,
// since they change as the model is edited.

import {FACTORS, bendsOf, isStretched, splineCosines} from './model.js';

export const TABLE_WIDTH = 256;

export function packModel(model) {
  const lines = [`#define TB_LOBES ${model.lobes}`];
  const texels = [];
  const define = (name, value) => lines.push(`#define ${name} ${value}`);
  if (model.lobes > 0) {
    for (const factor of FACTORS) {
      const axis = model.axes[factor], sharing = model.sharing[factor], spline = factor === 'G' && axis.phis === 0;
      const tables = [...model.tables[factor]];
      const groups = Math.ceil((tables.length + (spline ? 1 : 0)) / 4);
      const name = `TB_${factor}`;
      define(`${name}_TABLES`, tables.length);
      define(`${name}_GROUPS`, groups);
      define(`${name}_PER_LOBE`, Number(sharing.per_lobe));
      define(`${name}_PER_CHANNEL`, Number(sharing.per_channel));
      define(`${name}_SIZE`, axis.size);
      define(`${name}_PHIS`, axis.phis);
      if (factor === 'D') define('TB_D_ROOT', 1);
      define(`${name}_BASE`, texels.length / 4);
      if (spline) tables.push(splineCosines(axis.size));
      const kinds = spline ? [tables, tables.map(bendsOf)] : [tables];
      for (let e = 0; e < axis.size; ++e) {
        for (let g = 0; g < groups; ++g) {
          for (const kind of kinds) {
            for (let t = 4 * g; t < 4 * g + 4; ++t) texels.push(kind[t]?.[e] ?? 0);
          }
        }
      }
      if (axis.phis > 0) {
        define(`${name}_RINGS`, axis.theta.length);
        define(`${name}_RINGS_BASE`, texels.length / 4);
        texels.push(...axis.theta);
        while (texels.length % 4 !== 0) texels.push(1e9);
      }
    }
    const distinct = [];
    const ofLobe = model.stretch.map(s => {
      let k = distinct.findIndex(d => d[0] === s[0] && d[1] === s[1]);
      if (k < 0) k = distinct.push(s) - 1;
      return k;
    });
    define('TB_STRETCHES', isStretched(model) ? distinct.length : 0);
    if (isStretched(model)) {
      const count = model.tables.D.length;
      const perChannel = model.sharing.D.per_channel ? 3 : 1;
      const of = Array.from({length: count}, (_, t) => (model.sharing.D.per_lobe ? ofLobe[Math.floor(t / perChannel)] : 0));
      lines.push(`const vec2 trilobe_stretch[${distinct.length}] = vec2[${distinct.length}](` +
                 `${distinct.map(([a, b]) => `vec2(${a.toFixed(8)}, ${b.toFixed(8)})`).join(', ')});`);
      lines.push(`const int trilobe_stretch_of[${count}] = int[${count}](${of.join(', ')});`);
    }
  }
  lines.push('uniform highp sampler2D trilobe_tables;', 'uniform vec3 trilobe_diffuse;');
  if (model.lobes > 0) lines.push(`uniform vec3 trilobe_specular[${model.lobes}];`);
  const rows = Math.max(1, Math.ceil(texels.length / (4 * TABLE_WIDTH)));
  const data = new Float32Array(4 * TABLE_WIDTH * rows);
  data.set(texels);
  return {preamble: lines.join('\n') + '\n', data, rows};
}
