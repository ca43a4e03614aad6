// The normals and tangents of the object that a picture shows, drawn into its textures.

import {knotMesh} from './knot.js';

const KNOT_VERTEX = `layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal_in;
layout(location = 2) in vec3 tangent_in;
uniform mat3 turned_by;
out vec3 n, t;
void main() {
  vec3 p = turned_by * position;
  n = turned_by * normal_in;
  t = turned_by * tangent_in;
  gl_Position = vec4(p.x, -p.y, -p.z * 0.5, 1.0);
}`;
const KNOT_FRAGMENT = `in vec3 n, t;
layout(location = 0) out vec4 normal;
layout(location = 1) out vec4 tangent;
void main() {
  vec3 m = normalize(n);
  if (!(m.z > 0.0)) discard;
  normal = vec4(m, 1.0);
  tangent = vec4(normalize(t - m * dot(m, t)), 0.0);
}`;

function meshOf(gl) {
  const {vertices, indices} = knotMesh(), mesh = {array: gl.createVertexArray(), count: indices.length};
  gl.bindVertexArray(mesh.array);
  gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ARRAY_BUFFER, vertices, gl.STATIC_DRAW);
  for (let k = 0; k < 3; ++k) {
    gl.enableVertexAttribArray(k);
    gl.vertexAttribPointer(k, 3, gl.FLOAT, false, 36, 12 * k);
  }
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, indices, gl.STATIC_DRAW);
  return mesh;
}

export function drawSurface(renderer, level) {
  const {gl, object, turn} = renderer, key = JSON.stringify([object, turn]);
  if (level.surfaceOf === key) return;
  level.surfaceOf = key;
  const [a, b] = turn;
  if (object !== 'knot') {
    const made = renderer.program('surface', renderer.text('surface.glsl'));
    renderer.use(made);
    gl.uniform1i(made.place('object'), {sphere: 0, cloth: 1, flat: 2}[object]);
    gl.uniform2f(made.place('turn'), a, b);
    gl.uniform1f(made.place('size'), level.size);
    renderer.draw(level.surface, level.size, level.size);
    return;
  }
  renderer.knot ??= meshOf(gl);
  const made = renderer.program('knot', KNOT_FRAGMENT, KNOT_VERTEX);
  renderer.use(made);
  const [ca, sa, cb, sb] = [Math.cos(a), Math.sin(a), Math.cos(b), Math.sin(b)];
  gl.uniformMatrix3fv(made.place('turned_by'), false, [ca, sa * sb, -sa * cb, 0, cb, sb, sa, -ca * sb, ca * cb]);
  gl.bindFramebuffer(gl.FRAMEBUFFER, level.surface);
  gl.viewport(0, 0, level.size, level.size);
  gl.bindVertexArray(renderer.knot.array);
  gl.enable(gl.DEPTH_TEST);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.drawElements(gl.TRIANGLES, renderer.knot.count, gl.UNSIGNED_SHORT, 0);
  gl.disable(gl.DEPTH_TEST);
  gl.bindVertexArray(renderer.empty);
}
