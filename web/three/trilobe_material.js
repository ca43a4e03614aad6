// A material of three.js by the GLSL that Trilobe writes of a model:
//
//   trilobe convert model.json --out=model.glsl
//
//   import {trilobeMaterial} from './trilobe_material.js';
//   const source = await (await fetch('model.glsl')).text();
//   scene.add(new THREE.Mesh(geometry, trilobeMaterial(renderer, source)));
//
// Directional, point and spot lights shine on it, with shadows, as on any other material, and so does
// scene.environment. Ambient, hemisphere and area lights, and light probes, do not. A brushed material's grain follows
// the geometry's tangents, or its first coordinates uv. WebGLRenderer only; made for three.js 0.168.
import * as THREE from 'three';

// Replaces three's own lighting, after that has been declared. Directions of the model have z along the normal.
const LIGHT = `
vec3 trilobe_above(vec3 w) { return normalize(vec3(w.xy, max(w.z, 1e-3))); }

vec3 trilobe_direct(IncidentLight light, mat3 frame, vec3 to_eye) {
  vec3 wi = light.direction * frame;
  return wi.z > 0.0 ? trilobe_eval(wi, trilobe_above(to_eye * frame)) * wi.z * light.color : vec3(0.0);
}

#ifdef USE_ENVMAP
uniform sampler2D trilobe_drawn;
uniform sampler2D trilobe_weights;

// 0 to 1, of a pixel. (PCG, whose grain has no direction.)
float trilobe_random(uvec2 at) {
  uint state = (at.y << 16 ^ at.x) * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
  return float((word >> 22) ^ word) / 4294967296.0;
}

// By directions that the model draws, each of which stands for a cone of the size that its density says, and its
// neighbours: three's blurred environments, of which the one for a roughness r is as blurred as a cone of 2 r^2 radians.
// A pixel takes the row of a theta_o next to its own, by chance, so that no ring is seen between them.
vec3 trilobe_environment(mat3 frame, vec3 to_eye) {
  vec3 sum = vec3(0.0), wo = trilobe_above(to_eye * frame);
  float by_chance = trilobe_random(uvec2(gl_FragCoord.xy));
  ivec2 size = textureSize(trilobe_drawn, 0);
  int row = int(acos(min(wo.z, 1.0)) * (2.0 / PI) * float(TRILOBE_THETAS - 1) + by_chance);
  float turn = length(wo.xy) > 1e-6 ? atan(wo.y, wo.x) : 0.0;
#if TRILOBE_PHIS > 1
  int step_ = int(floor(turn / PI2 * float(TRILOBE_PHIS) + trilobe_random(uvec2(gl_FragCoord.yx) + 32768u)));
  row = row * TRILOBE_PHIS + (step_ + TRILOBE_PHIS) % TRILOBE_PHIS;
  turn = 0.0;
#endif
  mat2 around = mat2(cos(turn), sin(turn), -sin(turn), cos(turn));
  int first = int(by_chance * 7919.0);
  for (int k = 0; k < TRILOBE_SAMPLES; ++k) {
    ivec2 at = ivec2((first + k) % size.x, row);
    vec4 drawn = texelFetch(trilobe_drawn, at, 0);
    if (!(drawn.w > 0.0)) continue;
    vec3 wi = vec3(around * drawn.xy, drawn.z);
    float cone = 2.0 * sqrt(1.0 / (PI * drawn.w * float(TRILOBE_SAMPLES)));
    vec3 to_light = envMapRotation * inverseTransformDirection(frame * wi, viewMatrix);
    sum += texelFetch(trilobe_weights, at, 0).rgb *
           textureCubeUV(envMap, to_light, min(sqrt(cone / 2.0), 1.0)).rgb;
  }
  return sum * envMapIntensity / float(TRILOBE_SAMPLES);
}
#endif

#undef RE_Direct
#undef RE_Direct_RectArea
#undef RE_IndirectDiffuse
#undef RE_IndirectSpecular
#define RE_Direct(light, position, normal_, to_eye, coat, material_, reflected) \\
  reflected.directSpecular += trilobe_direct(light, trilobe_frame, to_eye)
`;

const FRAME = `
vec3 trilobe_x = normalize(tbn[0] - normal * dot(tbn[0], normal));
mat3 trilobe_frame = mat3(trilobe_x, cross(normal, trilobe_x), normal);
`;

const ENVIRONMENT = `
#ifdef USE_ENVMAP
reflectedLight.indirectSpecular += trilobe_environment(trilobe_frame, geometryViewDir);
#endif
`;

function tablesOf(source) {
  const data = /tables RGBA32F (\d+) x (\d+)\n([^*]*)\*\//.exec(source);
  if (!data) throw new Error('this is no file of `trilobe convert model.json --out=model.glsl`');
  const bytes = Uint8Array.from(atob(data[3].replace(/\s/g, '')), c => c.charCodeAt(0));
  const texture = new THREE.DataTexture(
      new Float32Array(bytes.buffer), +data[1], +data[2], THREE.RGBAFormat, THREE.FloatType);
  texture.needsUpdate = true;
  return texture;
}

const DRAW = `
precision highp float;
precision highp sampler2D;
FUNCTIONS
layout(location = 0) out vec4 drawn;
layout(location = 1) out vec4 weights;
void main() {
  int column = int(gl_FragCoord.x), row = int(gl_FragCoord.y);
  float theta = float(row / TRILOBE_PHIS) * (0.5 * 3.14159265 / float(TRILOBE_THETAS - 1));
  float phi = float(row % TRILOBE_PHIS) * (2.0 * 3.14159265 / float(TRILOBE_PHIS));
  vec3 wo = vec3(sin(theta) * vec2(cos(phi), sin(phi)), max(cos(theta), 1e-3));
  // Any that follow each other are spread evenly.
  vec2 u = fract(vec2(0.7548777, 0.5698403) * float(column) + 0.5);
  float pdf;
  vec3 weight, wi = trilobe_sample(normalize(wo), u, pdf, weight);
  drawn = vec4(wi, pdf);
  weights = vec4(weight, 1.0);
}`;

// Directions that the model draws for several wo, with their densities, and their weights: a row for each wo.
function drawDirections(renderer, functions, tables, columns, defines) {
  const target = new THREE.WebGLRenderTarget(columns, defines.TRILOBE_THETAS * defines.TRILOBE_PHIS, {
    count: 2, type: THREE.FloatType, minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter, depthBuffer: false,
  });
  const material = new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3, defines, depthTest: false,
    uniforms: {trilobe_tables: {value: tables}},
    vertexShader: 'in vec3 position; void main() { gl_Position = vec4(position, 1.0); }',
    fragmentShader: DRAW.replace('FUNCTIONS', () => functions),
  });
  const square = new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material);
  square.frustumCulled = false;
  const before = renderer.getRenderTarget();
  renderer.setRenderTarget(target);
  renderer.render(square, new THREE.Camera());
  renderer.setRenderTarget(before);
  square.geometry.dispose();
  material.dispose();
  return target;
}

// Makes a THREE.MeshPhysicalMaterial of the text of a .glsl file. `samples` of each pixel see the environment. Other
// properties are three's, such as normalMap and side; those of the surface's colour and roughness count for nothing.
export function trilobeMaterial(renderer, source, {samples = 32, ...properties} = {}) {
  const tables = tablesOf(source);
  // Without the numbers, which no compiler needs to see; three declares the precision.
  const functions = source.replace(/\/\* tables RGBA32F[^*]*\*\//, '');
  const anisotropic = !/#define TB_PHIS_I 1\n/.test(source);
  const defines = {TRILOBE_THETAS: anisotropic ? 32 : 64, TRILOBE_PHIS: anisotropic ? 32 : 1};
  const drawn = drawDirections(renderer, functions, tables, anisotropic ? 256 : 1024, defines);
  // three makes tangents for materials with an anisotropy.
  const material = new THREE.MeshPhysicalMaterial({...properties, anisotropy: 1});
  Object.assign(material.defines, defines, {TRILOBE_SAMPLES: samples});
  material.onBeforeCompile = shader => {
    const [directions, weights] = drawn.textures;
    Object.assign(shader.uniforms, {
      trilobe_tables: {value: tables}, trilobe_drawn: {value: directions}, trilobe_weights: {value: weights},
    });
    const around = (chunk, before, after) => {
      const include = `#include <${chunk}>`;
      if (!shader.fragmentShader.includes(include)) throw new Error(`this three.js has no ${include} any more`);
      shader.fragmentShader = shader.fragmentShader.replace(include, () => before + include + after);
    };
    around('lights_physical_pars_fragment', '', '\n' + functions + LIGHT);
    around('lights_fragment_begin', FRAME, ENVIRONMENT);
  };
  // Without its own key, three would take the first model's program for all.
  material.customProgramCacheKey = () => functions;
  material.addEventListener('dispose', () => {
    tables.dispose();
    drawn.dispose();
  });
  return material;
}
