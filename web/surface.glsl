// The normal and the tangent that each pixel sees, of a sphere, a cloth or a flat sample. The cloth is that of
// src/model/appearance/view.cc.
uniform int object;  // 0 sphere, 1 cloth, 2 flat
uniform vec2 turn;   // object about y and x, the cloth's thread, or the sphere's axis about z and x [rad]
uniform float size;  // pixels
layout(location = 0) out vec4 normal;
layout(location = 1) out vec4 tangent;

vec3 fold_at(float u, float v) {
  vec3 fold = vec3(0.0);
  for (int k = 0; k < 3; ++k) {
    vec4 wave = k == 0 ? vec4(0.12, 5.6, 0.9, 0.6) : k == 1 ? vec4(0.055, -2.9, 2.4, 1.7) : vec4(0.022, 9.1, -2.2, 0.9);
    float angle = wave.y * u + wave.z * v + wave.w;
    fold += vec3(wave.x * sin(angle), wave.x * wave.yz * cos(angle));
  }
  return fold;
}

void main() {
  vec2 p = vec2(gl_FragCoord.x / size * 2.0 - 1.0, 1.0 - gl_FragCoord.y / size * 2.0);
  normal = tangent = vec4(0.0);
  if (object == 0) {
    float z2 = 1.0 - dot(p, p);
    if (!(z2 > 0.0)) return;
    vec3 n = vec3(p, sqrt(z2));
    vec3 axis = vec3(sin(turn.x) * cos(turn.y), cos(turn.x) * cos(turn.y), sin(turn.y));
    vec3 along = cross(axis, n);
    normal = vec4(n, 1.0);
    tangent = vec4(along / max(length(along), 1e-12), 0.0);
  } else if (object == 1) {
    const float c = 0.8660254037844386, s = 0.5;  // cosine and sine of the lean, 30 degrees
    float u = p.x, v = p.y / c;
    for (int step = 0; step < 12; ++step) {
      vec3 fold = fold_at(u, v);
      v -= (v * c + fold.x * s - p.y) / (c + fold.z * s);
    }
    vec3 fold = fold_at(u, v), e_v = vec3(0.0, c, -s), up = vec3(0.0, s, c);
    vec3 n = normalize(vec3(-fold.y, 0.0, 0.0) - fold.z * e_v + up);
    vec2 thread = vec2(cos(turn.x), sin(turn.x));
    vec3 x = normalize(vec3(thread.x, 0.0, 0.0) + thread.y * e_v + dot(thread, fold.yz) * up);
    normal = vec4(n, 1.0);
    tangent = vec4(x, 0.0);
  } else {
    float cy = cos(turn.x), sy = sin(turn.x), cx = cos(turn.y), sx = sin(turn.y);
    vec3 x = vec3(cy, sx * sy, -cx * sy), y = vec3(0.0, cx, sx), n = cross(x, y);
    if (!(n.z > 0.02)) return;
    // The place on the sample, a square, over which this pixel is.
    vec3 place = vec3(p, -(n.x * p.x + n.y * p.y) / n.z);
    if (max(abs(dot(place, x)), abs(dot(place, y))) > 0.8) return;
    normal = vec4(n, 1.0);
    tangent = vec4(x, 0.0);
  }
}
