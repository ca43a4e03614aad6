// Draws the object, measured and fitted, into a canvas by WebGL 2. Pictures are summed over the half vectors of each
// pixel's normal, first at few pixels and then at more, a part of them a frame, so that the page stays quick without a
// graphics card, too.

import {packModel, TABLE_WIDTH} from './pack.js';
import {halfCells} from './environment.js';
import {drawSurface} from './surface.js';

const PROLOGUE = '#version 300 es\nprecision highp float; precision highp int; precision highp sampler2D; precision highp sampler3D;\n';
const NO_MODEL = '#define TB_LOBES 0\nuniform sampler2D trilobe_tables;\nconst vec3 trilobe_diffuse = vec3(0.0);\n';
const FULL_SCREEN = 'void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); }';
const MODES = {fitted: 0, measured: 1, wipe: 2, difference: 3};
const COARSEST = 16;  // pixels across of the first picture, or up to twice as many
const JUDGED = 96;    // pixels across of the picture by which materials are judged, whatever the window
const FRAME_MS = 30;
const MOVING_MS = 18;  // for a material under a lamp that moves; about half the pixels across where all take longer

export class Renderer {
  constructor(canvas, shaderText) {
    this.canvas = canvas;
    this.text = shaderText;
    const gl = (this.gl = canvas.getContext('webgl2', {
      alpha: true, antialias: false, preserveDrawingBuffer: true, powerPreference: 'high-performance'}));
    if (!gl) throw new Error('this browser has no WebGL 2');
    if (gl.getExtension('EXT_color_buffer_float')) this.format = gl.RGBA32F;
    else if (gl.getExtension('EXT_color_buffer_half_float')) this.format = gl.RGBA16F;
    else throw new Error('this browser cannot draw into float textures');
    this.isSoftware = /swiftshader|llvmpipe|software|basic render/i.test(gl.getParameter(gl.RENDERER));
    this.programs = {};
    this.levels = [];
    this.size = 0;
    this.patience = 1;  // seconds that a finer picture may take before the page shows that it is being drawn
    this.slice = FRAME_MS;  // that one call of work() may take, about
    this.finer = null;  // the part that is done of all sizes of a picture that takes longer
    this.content = 0;  // counts what was shown; a level that is finished keeps the number of what it shows
    this.rate = 2e6;  // evaluations a second, until it is known better
    this.exposure = 0;
    this.turn = [0, 0];
    this.environmentTurn = 0;
    this.object = 'sphere';
    this.lamp = null;
    this.leastCosine = 0;  // cosine of the largest angle to the eye that was measured
    this.shown = null;
    this.pending = true;
    this.onImage = () => {};
    const cells = new Float32Array(halfCells());
    this.numCells = cells.length / 4;
    this.cells = this.texture(gl.RGBA32F, this.numCells, 1, gl.FLOAT, cells);
    gl.bindVertexArray((this.empty = gl.createVertexArray()));
  }

  texture(format, width, height, type = this.gl.FLOAT, data = null, filter = this.gl.NEAREST) {
    const {gl} = this, t = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, t);
    gl.texImage2D(gl.TEXTURE_2D, 0, format, width, height, 0, gl.RGBA, type, data);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, filter);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
    return t;
  }

  program(name, fragment, vertex = FULL_SCREEN) {
    const known = this.programs[name];
    if (known?.fragment === fragment) return known;
    const {gl} = this;
    if (known) gl.deleteProgram(known.program);
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, PROLOGUE + text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
      const logs = gl.getAttachedShaders(program).map(s => gl.getShaderInfoLog(s)).join(' ');
      throw new Error(`the shader '${name}' does not compile: ${gl.getProgramInfoLog(program)} ${logs}`);
    }
    const places = {};
    const place = uniform => (places[uniform] ??= gl.getUniformLocation(program, uniform));
    return (this.programs[name] = {program, fragment, place});
  }

  use(made, textures = {}) {
    const {gl} = this;
    gl.useProgram(made.program);
    Object.entries(textures).forEach(([name, [target, t]], unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(target, t);
      gl.uniform1i(made.place(name), unit);
    });
  }

  draw(target, width, height) {
    const {gl} = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    gl.viewport(0, 0, width, height);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  framebuffer(...textures) {
    const {gl} = this, f = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, f);
    textures.forEach((t, k) => gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + k, gl.TEXTURE_2D, t, 0));
    gl.drawBuffers(textures.map((_, k) => gl.COLOR_ATTACHMENT0 + k));
    return f;
  }

  setEnvironment(environment) {
    const {gl} = this;
    if (this.environment) gl.deleteTexture(this.environment);
    this.environment = this.texture(gl.RGBA32F, environment.width, environment.height, gl.FLOAT, environment.data);
    this.mirroredTurn = null;
    this.exposure = 0;
    this.restart();
  }

  // The map that cells read, of the environment as it is turned now.
  mirrored() {
    const {gl} = this;
    if (this.mirroredTurn === this.environmentTurn) return this.mirror;
    if (!this.mirror) {
      this.mirror = this.texture(gl.RGBA16F, 512, 512, gl.FLOAT, null, gl.LINEAR);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAX_LEVEL, 8);
      this.mirrorTarget = this.framebuffer(this.mirror);
    }
    const made = this.program('mirror', NO_MODEL + this.text('bsdf.glsl') + this.text('mirror.glsl'));
    this.use(made, {environment: [gl.TEXTURE_2D, this.environment]});
    gl.uniform1f(made.place('turn'), this.environmentTurn);
    this.draw(this.mirrorTarget, 512, 512);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.mirror);
    gl.generateMipmap(gl.TEXTURE_2D);
    this.mirroredTurn = this.environmentTurn;
    return this.mirror;
  }

  tablesOf({rows, data}) { return this.texture(this.gl.RGBA32F, TABLE_WIDTH, rows, this.gl.FLOAT, data); }
  modelText(packed) {
    return packed.preamble + this.text('bsdf.glsl') +
      'vec4 material(vec3 wi, vec3 wo) { return vec4(trilobe_eval(wi, wo), 1.0); }\n' + this.text('light.glsl');
  }

  setModel(model) {
    const {gl} = this, packed = packModel(model);
    if (this.tables) gl.deleteTexture(this.tables);
    this.tables = this.tablesOf(packed);
    this.model = model;
    this.fittedText = this.modelText(packed);
    this.restart();
  }

  // A table, nodes, or {kind: 'model', model}; or null.
  setMeasured(measured) {
    const {gl} = this;
    this.measured = measured;
    this.exposure = 0;
    if (!measured) return this.restart();
    if (measured.kind === 'model') {
      const packed = packModel(measured.model);
      this.measuredTexture = {trilobe_tables: [gl.TEXTURE_2D, this.tablesOf(packed)]};
      this.measuredText = this.modelText(packed);
      return this.restart();
    }
    const {rgb, valid} = measured, texels = new Float32Array((rgb.length / 3) * 4);
    for (let k = 0; k < valid.length; ++k) {
      for (let c = 0; c < 3; ++c) texels[4 * k + c] = Math.min(rgb[3 * k + c], 65504);  // the most of a half float
      texels[4 * k + 3] = valid[k];
    }
    let defines = '#define MEASURED_NODES 0\n';
    if (measured.kind === 'table') {
      const [h, d, p] = measured.shape, t = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_3D, t);
      gl.texImage3D(gl.TEXTURE_3D, 0, gl.RGBA16F, p, d, h, 0, gl.RGBA, gl.FLOAT, texels);
      for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_3D, name, gl.LINEAR);
      gl.texParameteri(gl.TEXTURE_3D, gl.TEXTURE_WRAP_S, gl.REPEAT);
      for (const name of [gl.TEXTURE_WRAP_T, gl.TEXTURE_WRAP_R]) gl.texParameteri(gl.TEXTURE_3D, name, gl.CLAMP_TO_EDGE);
      this.measuredTexture = {measured_table: [gl.TEXTURE_3D, t]};
    } else {
      const nodes = measured.thetas * measured.phis;
      this.measuredTexture = {measured_nodes: [gl.TEXTURE_2D, this.texture(gl.RGBA32F, nodes, nodes, gl.FLOAT, texels)]};
      defines = `#define MEASURED_NODES 1\n#define MEASURED_THETAS ${measured.thetas}\n#define MEASURED_PHIS ${measured.phis}\n` +
        `#define MEASURED_MIN_COSINE ${(Math.cos(measured.maxTheta) - 1e-5).toFixed(7)}\n`;
    }
    this.measuredText = NO_MODEL + this.text('bsdf.glsl') + defines + this.text('measured.glsl') + this.text('light.glsl');
    this.restart();
  }

  // Sets the width of the object's picture, in pixels. What is finished of it in other sizes stays, so that a window that
  // changes by a scroll bar makes nothing coarser.
  setSize(size) {
    if (size === this.size) return;
    const before = this.levels;
    this.size = size;
    this.levels = [];
    // Halves, but of JUDGED and its doubles, so that it is among them.
    const coarser = s => (s <= JUDGED ? Math.round(s / 2) : JUDGED * 2 ** Math.max(Math.floor(Math.log2((0.7 * s) / JUDGED)), 0));
    for (let s = size; s >= COARSEST; s = coarser(s)) this.levels.unshift(before.find(level => level.size === s) ?? this.makeLevel(s));
    if (this.exposure === 0) ++this.content;
    this.begin();
    for (const level of before) if (!this.levels.includes(level) && level !== this.shown) this.drop(level);
  }

  drop(level) {
    const {gl} = this;
    for (const t of level.textures) gl.deleteTexture(t);
    for (const f of level.framebuffers) gl.deleteFramebuffer(f);
    gl.deleteRenderbuffer(level.depth);
  }

  makeLevel(size) {
    const {gl} = this;
    const make = () => this.texture(this.format, size, size, this.format === gl.RGBA16F ? gl.HALF_FLOAT : gl.FLOAT);
    const [normals, tangents, ...sums] = Array.from({length: 8}, make);
    const surface = this.framebuffer(normals, tangents);
    const depth = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT16, size, size);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
    const targets = sums.map(t => this.framebuffer(t));
    // Two sums by turns a material, and what was finished last of each.
    const side = k => ({textures: sums.slice(3 * k, 3 * k + 3), targets: targets.slice(3 * k, 3 * k + 3), done: 2, last: 0});
    return {size, normals, tangents, surface, sides: [side(0), side(1)], textures: [normals, tangents, ...sums],
            framebuffers: [surface, ...targets], depth, surfaceOf: '', content: -1};
  }

  get judgedSize() { return Math.min(this.size, JUDGED); }

  // Draws all again, as something else is shown.
  restart() {
    ++this.content;
    this.begin();
  }

  begin() {
    this.pending = true;
    this.progress = this.finer = null;
  }

  // Adds the cells from..to to the sum of one material.
  addLight(level, number, from, to, lamp, countedOnly = false) {
    const {gl} = this, side = level.sides[number];
    const define = `#define LAMP ${lamp ? 1 : 0}\n`, kind = lamp ? 'by a lamp' : 'all around';
    const made = number === 0 ? this.program(`fitted ${kind}`, define + this.fittedText)
                              : this.program(`measured ${kind}`, define + this.measuredText);
    const into = side.last === 0 ? 1 : 0;
    const mirrored = this.mirrored();
    this.use(made, {
      normals: [gl.TEXTURE_2D, level.normals],
      tangents: [gl.TEXTURE_2D, level.tangents],
      previous: [gl.TEXTURE_2D, side.textures[side.last]],
      cells: [gl.TEXTURE_2D, this.cells],
      mirrored: [gl.TEXTURE_2D, mirrored],
      trilobe_tables: [gl.TEXTURE_2D, this.tables],
      ...(number === 1 ? this.measuredTexture : {}),
    });
    const model = number === 0 ? this.model : this.measured.model;
    if (model) {
      gl.uniform3fv(made.place('trilobe_diffuse'), model.d);
      if (model.lobes > 0) gl.uniform3fv(made.place('trilobe_specular'), model.s.flat());
    }
    gl.uniform1i(made.place('from'), from);
    gl.uniform1i(made.place('to'), to);
    gl.uniform1i(made.place('counted_only'), countedOnly ? 1 : 0);
    gl.uniform3fv(made.place('lamp_direction'), lamp ?? [0, 0, 1]);
    gl.uniform3fv(made.place('lamp_irradiance'), [3, 3, 3]);
    this.draw(side.targets[into], level.size, level.size);
    side.last = into;
  }

  // Waits for what was drawn.
  sync(level, number) {
    const {gl} = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, level.sides[number].targets[level.sides[number].last]);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.FLOAT, new Float32Array(4));
  }

  // Finished sums are kept apart from those that are being made. A finer picture of the same stays, but for one that is
  // as large as the panel.
  publish(level) {
    for (const side of level.sides) {
      [side.textures[2], side.textures[side.last]] = [side.textures[side.last], side.textures[2]];
      [side.targets[2], side.targets[side.last]] = [side.targets[side.last], side.targets[2]];
    }
    const {shown, size} = this;
    if (shown?.content !== level.content || shown.size <= level.size || level.size === size) this.present(level);
  }

  present(level) {
    const {shown} = this;
    this.shown = level;
    if (shown && !this.levels.includes(shown)) this.drop(shown);
  }

  numbersOf(level, number) {
    const {gl} = this, numbers = new Float32Array(4 * level.size * level.size);
    gl.bindFramebuffer(gl.FRAMEBUFFER, level.sides[number].targets[2]);
    gl.readPixels(0, 0, level.size, level.size, gl.RGBA, gl.FLOAT, numbers);
    return numbers;
  }

  // Both pictures get the exposure that takes the mean luminance of the measured one to 0.35, under the environment, of
  // what was measured alone. Where that is not all, only the two coarsest tell it, as they are drawn once more for it.
  expose(level) {
    let numbers = this.numbersOf(level, this.measured ? 1 : 0);
    if (this.measured) {
      const all = this.numbersOf(level, 0);
      const covered = numbers.every((x, k) => k % 4 !== 3 || x >= 0.9999 * all[k]);
      if (!covered && this.levels.indexOf(level) > 1 && this.exposure > 0) return;
      if (!covered) {
        const side = level.sides[1];
        this.addLight(level, 1, 0, this.numCells, null, true);
        [side.targets[2], side.targets[side.last]] = [side.targets[side.last], side.targets[2]];
        numbers = this.numbersOf(level, 1);
        [side.targets[2], side.targets[side.last]] = [side.targets[side.last], side.targets[2]];
      }
    }
    let sum = 0, count = 0;
    for (let k = 0; k < numbers.length; k += 4) {
      if (!(numbers[k + 3] > 0)) continue;
      sum += 0.2126 * numbers[k] + 0.7152 * numbers[k + 1] + 0.0722 * numbers[k + 2];
      ++count;
    }
    const exposure = sum > 0 ? (0.35 * count) / sum : 1;
    if (Number.isFinite(exposure)) this.exposure = exposure;
  }

  // Does a part of what is left; true where the picture has changed. `exposes`: whether the model is as it was fitted.
  work(exposes) {
    if (!this.pending || this.levels.length === 0) return false;
    const {levels} = this;
    const sides = this.measured ? [0, 1] : [0];
    const exposing = this.exposure === 0;
    const lamp = exposing ? null : this.lamp;
    const cells = lamp ? 1 : this.numCells;
    const costOf = level => level.size ** 2 * 0.7 * cells * sides.length;
    const costFrom = (first, end) => levels.slice(first, end).reduce((sum, each) => sum + costOf(each), 0);
    if (!this.progress) {
      // The most pixels that one frame can do.
      let first = 0;
      const seconds = (lamp ? MOVING_MS * sides.length : FRAME_MS) / 1000;
      while (!exposing && first + 1 < levels.length && costOf(levels[first + 1]) < this.rate * seconds) ++first;
      const judged = levels.findIndex(level => level.size === this.judgedSize);
      if (lamp && this.moving) first = Math.max(first, levels.length - 2, 0);
      else first = Math.min(first, judged);
      const done = levels.findLastIndex(each => each.content === this.content);
      if (done === levels.length - 1) {
        this.present(levels[done]);
        this.pending = false;
        return true;
      }
      first = Math.max(first, done + 1);
      this.progress = {level: first, first, side: 0, cell: 0};
    }
    const {progress} = this, level = levels[progress.level];
    const begin = performance.now();
    drawSurface(this, level);
    while (performance.now() - begin < this.slice) {
      const left = cells - progress.cell;
      const number = sides[progress.side];
      const fits = Math.max(1, Math.floor((this.rate * FRAME_MS) / 1000 / (level.size ** 2 * 0.7)));
      const count = Math.min(left, fits);
      const start = performance.now();
      this.addLight(level, number, progress.cell, progress.cell + count, lamp);
      this.sync(level, number);
      const seconds = (performance.now() - start) / 1000, cost = level.size ** 2 * 0.7 * count;
      // The first call compiles, and says nothing about the rate.
      if (this.measuredRate && cost > 2e4) this.rate = Math.min(Math.max(0.5 * this.rate + (0.5 * cost) / Math.max(seconds, 1e-4), 2e5), 1e10);
      this.measuredRate = true;
      progress.cell += count;
      const whole = costFrom(progress.first, this.moving ? progress.level + 1 : undefined);
      const done = costFrom(progress.first, progress.level) + costOf(level) * (progress.side * cells + progress.cell) / (cells * sides.length);
      this.secondsLeft = (whole - done) / this.rate;
      if (this.finer !== null || this.secondsLeft > this.patience) this.finer = done / whole;
      if (progress.cell < cells) continue;
      progress.cell = 0;
      if (++progress.side < sides.length) continue;
      level.content = exposing && this.lamp ? -1 : this.content;
      this.publish(level);
      if (!lamp && exposes && (exposing || this.environmentTurn === 0) && this.object === 'sphere') this.expose(level);
      else if (exposing) this.expose(level);
      if (exposing && this.lamp) {
        this.begin();  // and now by the lamp
      } else if (progress.level + 1 < levels.length && !this.moving) {
        this.progress = {...progress, level: progress.level + 1, side: 0, cell: 0};
      } else {
        this.pending = false;
        this.finer = null;
      }
      this.onImage(level, this.pending);
      return true;
    }
    return false;
  }

  // `panels`: [{mode, x, y, size}] in pixels of the canvas from its top left.
  show(panels, {wipe, stops, mark}) {
    const {gl, canvas, shown} = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    if (!shown) return;
    const compared = Boolean(this.measured);
    gl.enable(gl.SCISSOR_TEST);
    for (const {mode, x, y, size} of panels) {
      const defines = `#define SHOWN ${MODES[mode]}\n#define EXACT ${Number(size === shown.size)}\n#define COMPARED ${Number(compared)}\n`;
      const made = this.program(`show ${mode} ${size === shown.size} ${compared}`, defines + this.text('show.glsl'));
      this.use(made, {
        normals: [gl.TEXTURE_2D, shown.normals],
        fitted: [gl.TEXTURE_2D, shown.sides[0].textures[2]],
        measured: [gl.TEXTURE_2D, shown.sides[compared ? 1 : 0].textures[2]],
      });
      gl.uniform1i(made.place('round_'), this.object === 'sphere' ? 1 : 0);
      gl.uniform1f(made.place('exposure'), this.exposure * 2 ** stops);
      gl.uniform1f(made.place('size'), shown.size);
      gl.uniform1f(made.place('least_cosine'), this.leastCosine);
      gl.uniform1f(made.place('wipe'), wipe);
      gl.uniform3f(made.place('mark'), mark ? mark[0] : 0, mark ? mark[1] : 0, mark ? 1 : 0);
      const bottom = canvas.height - y - size;
      gl.viewport(x, bottom, size, size);
      gl.scissor(x, bottom, size, size);
      gl.uniform4f(made.place('panel'), x, bottom, size, size);
      gl.drawArrays(gl.TRIANGLES, 0, 3);
    }
    gl.disable(gl.SCISSOR_TEST);
  }

  // The surface at (x, y) from -1 to 1: {normal, tangent}, or null beside the object.
  surfaceAt(x, y) {
    if (!this.shown) return null;
    const {gl} = this, {size, surface} = this.shown;
    const column = Math.floor(((x + 1) / 2) * size), row = Math.floor(((1 - y) / 2) * size);
    if (column < 0 || row < 0 || column >= size || row >= size) return null;
    gl.bindFramebuffer(gl.FRAMEBUFFER, surface);
    const read = k => {
      const numbers = new Float32Array(4);
      gl.readBuffer(gl.COLOR_ATTACHMENT0 + k);
      gl.readPixels(column, row, 1, 1, gl.RGBA, gl.FLOAT, numbers);
      return numbers;
    };
    const normal = read(0);
    if (normal[3] === 0) return null;
    const found = {normal: [...normal.subarray(0, 3)], tangent: [...read(1).subarray(0, 3)]};
    gl.readBuffer(gl.COLOR_ATTACHMENT0);
    return found;
  }
}
