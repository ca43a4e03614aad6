// Light that the eye (+z, far away) sees of a surface: the sum over a part of the half vectors of its normal, each with
// the light that mirrors would send it from there (src/model/appearance/render_environment.cc), or the light of one
// lamp (LAMP 1). `material` is the BRDF, and 1 where its directions were measured.
uniform highp sampler2D normals, tangents, previous, cells;
uniform highp sampler2D mirrored;
uniform int from, to;
uniform bool counted_only;  // counted: of directions that were measured
uniform vec3 lamp_direction, lamp_irradiance;
layout(location = 0) out vec4 sum;

float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

// Turns v by the smallest turn that takes z to the normal.
vec3 turned(vec3 n, vec3 v) {
  float along = (n.x * v.x + n.y * v.y) / (1.0 + n.z);
  return vec3(v.xy - n.xy * along + n.xy * v.z, n.z * v.z - n.x * v.x - n.y * v.y);
}

vec4 reflected(vec3 n, vec3 x, vec3 y, vec3 wo, vec3 light, vec3 irradiance) {
  float cos_i = min(dot(n, light), 1.0);
  if (!(cos_i > 0.0)) return vec4(0.0);
  vec4 rho = material(vec3(dot(light, x), dot(light, y), cos_i), wo);
  if (counted_only) rho.rgb *= rho.a;
  return vec4(rho.rgb * cos_i * irradiance, rho.a * cos_i * luminance(irradiance));
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 surface = texelFetch(normals, at, 0);
  sum = vec4(0.0);
  if (surface.w == 0.0) return;
  vec3 n = surface.xyz, x = texelFetch(tangents, at, 0).xyz, y = cross(n, x);
  float cos_o = min(n.z, 1.0);
  vec3 wo = vec3(x.z, y.z, cos_o);
#if LAMP == 0
  if (from > 0) sum = texelFetch(previous, at, 0);
  for (int k = from; k < to; ++k) {
    vec4 cell = texelFetch(cells, ivec2(k, 0), 0);
    vec3 h = turned(n, cell.xyz);
    if (!(h.z > 0.0)) continue;
    vec3 light = vec3(2.0 * h.z * h.xy, 2.0 * h.z * h.z - 1.0);
    float level = clamp(log2(1.8 * sqrt(max(h.z * cell.w, 1e-12)) * 256.0), 0.0, 8.0);
    vec3 irradiance = textureLod(mirrored, vec2(0.5 + 0.5 * h.x, 0.5 - 0.5 * h.y), level).rgb * (4.0 * h.z * cell.w);
    sum += reflected(n, x, y, wo, light, irradiance);
  }
#else
  sum = reflected(n, x, y, wo, lamp_direction, lamp_irradiance);
#endif
  if (!(cos_o > 0.0)) sum = vec4(0.0);
}
