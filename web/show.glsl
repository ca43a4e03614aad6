// A panel of the picture, SHOWN: 0 the fitted material, 1 the measured one, 2 both with a line between, 3 how far apart
// they are to the eye (CIELAB, 1976). EXACT: a pixel of the object is one of the panel. These are macros, since without a
// graphics card what a shader leaves out takes its time, too. Hatched where most of the light is of directions that were
// not measured: with COMPARED as the measurement says, else where the eye is lower than what was measured.
uniform highp sampler2D normals, fitted, measured;
uniform bool round_;
uniform float exposure, size, wipe, least_cosine;
uniform vec4 panel;  // x, y, width, height [pixels]
uniform vec3 mark;   // x, y from -1 to 1, and whether to draw it
layout(location = 0) out vec4 color;

vec3 encoded(vec3 linear) {
  vec3 c = clamp(linear, 0.0, 1.0);
  return mix(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, step(c, vec3(0.0031308)));
}
#if SHOWN == 3
float lab_of(float t) { return t > 0.00885645 ? pow(t, 1.0 / 3.0) : t * 7.787037 + 0.13793103; }
vec3 lab(vec3 c) {
  float x = lab_of(dot(c, vec3(0.4124, 0.3576, 0.1805)) / 0.9505), y = lab_of(dot(c, vec3(0.2126, 0.7152, 0.0722)));
  float z = lab_of(dot(c, vec3(0.0193, 0.1192, 0.9505)) / 1.089);
  return vec3(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z));
}
vec3 color_of(float delta) {
  vec3 stops[5] = vec3[5](vec3(255, 255, 255), vec3(255, 237, 160), vec3(254, 178, 76), vec3(227, 26, 28), vec3(60, 0, 30));
  float at[5] = float[5](0.0, 1.0, 2.0, 5.0, 10.0);
  for (int k = 0; k < 4; ++k) {
    if (delta <= at[k + 1] || k == 3) return mix(stops[k], stops[k + 1], clamp((delta - at[k]) / (at[k + 1] - at[k]), 0.0, 1.0)) / 255.0;
  }
}
#endif

void main() {
  vec2 p = (gl_FragCoord.xy - panel.xy) / panel.zw;
  p.y = 1.0 - p.y;
  vec4 a = vec4(0.0), b = vec4(0.0);
  float weights = 0.0;
  float cover = 0.0;
  ivec2 nearest = clamp(ivec2(p * size), ivec2(0), ivec2(int(size) - 1));
#if EXACT
  if (texelFetch(normals, nearest, 0).w != 0.0) {
    weights = 1.0;
    a = texelFetch(fitted, nearest, 0);
    b = texelFetch(measured, nearest, 0);
    // Edges fade over a pixel.
    for (int k = 0; k < 9; ++k) {
      ivec2 beside = clamp(nearest + ivec2(k % 3 - 1, k / 3 - 1), ivec2(0), ivec2(int(size) - 1));
      cover += texelFetch(normals, beside, 0).w != 0.0 ? 1.0 / 9.0 : 0.0;
    }
    cover = clamp(1.5 * cover - 0.5, 0.1, 1.0);
  }
#else
  vec2 at = p * size - 0.5;
  ivec2 low = ivec2(floor(at));
  vec2 f = at - vec2(low);
  for (int k = 0; k < 4; ++k) {
    ivec2 pixel = low + ivec2(k % 2, k / 2);
    float weight = (k % 2 == 0 ? 1.0 - f.x : f.x) * (k / 2 == 0 ? 1.0 - f.y : f.y);
    if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, ivec2(size)))) continue;
    if (texelFetch(normals, pixel, 0).w == 0.0) continue;
    weights += weight;
#if SHOWN != 1 || COMPARED
    a += weight * texelFetch(fitted, pixel, 0);
#endif
#if SHOWN != 0 || COMPARED
    b += weight * texelFetch(measured, pixel, 0);
#endif
  }
  cover = weights;
#endif
  if (round_) cover = weights > 0.0 ? clamp((1.0 - length(2.0 * p - 1.0)) * panel.z / 2.0 + 0.5, 0.0, 1.0) : 0.0;
  if (cover <= 0.0) {
    color = vec4(0.0);
    return;
  }
  a /= weights;
  b /= weights;
  vec3 shown;
#if COMPARED
  bool known = b.a >= 0.5 * a.a;
#else
  bool known = texelFetch(normals, nearest, 0).z >= least_cosine;
#endif
#if SHOWN == 0
  shown = encoded(exposure * a.rgb);
#elif SHOWN == 1
  shown = encoded(exposure * b.rgb);
#elif SHOWN == 2
  shown = encoded(exposure * (p.x < wipe ? b.rgb : a.rgb));
  if (abs(p.x - wipe) * panel.z < 1.0) shown = vec3(1.0);
#else
  vec3 ca = clamp(exposure * a.rgb, 0.0, 1.0), cb = clamp(exposure * b.rgb, 0.0, 1.0);
  shown = known ? color_of(distance(lab(ca), lab(cb))) : vec3(0.6);
#endif
  if (!known && fract((gl_FragCoord.x + gl_FragCoord.y) / 7.0) < 0.3) {
    shown = mix(shown, vec3(dot(shown, vec3(0.33)) < 0.45 ? 0.9 : 0.1), 0.6);
  }
  if (mark.z == 0.0) {
    color = vec4(shown * cover, cover);
    return;
  }
  float ring = abs(length((2.0 * p - 1.0) - vec2(mark.x, -mark.y)) * panel.z / 2.0 - 7.0);
  shown = mix(shown, mix(vec3(1.0), vec3(0.0), smoothstep(0.8, 1.3, ring)), 1.0 - smoothstep(1.8, 2.4, ring));
  color = vec4(shown * cover, cover);
}
