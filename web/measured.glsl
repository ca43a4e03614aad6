// A measurement between its values: a table over (phi_d, theta_d, sqrt theta_h), or pairs of nodes.
#if MEASURED_NODES == 0
uniform highp sampler3D measured_table;
vec4 material(vec3 wi, vec3 wo) {
  vec3 h = wi + wo;
  float size = length(h);
  h /= size;
  vec3 between = wi - wo;
  float cos_d = size / 2.0, sin2_h = dot(h.xy, h.xy);
  vec4 angles = tb_acos_one_minus(clamp(vec4(sin2_h / (1.0 + h.z),
                                             dot(between, between) / (4.0 * (1.0 + cos_d)), 0.0, 0.0), 0.0, 1.0));
  // cos theta_o - cos theta_i = 2 sin theta_h sin theta_d cos phi_d; phi_d + 180 degrees is phi_d.
  float sines = 2.0 * sqrt(sin2_h) * sqrt(max(1.0 - cos_d * cos_d, 0.0));
  float phi = tb_acos(sines > 0.0 ? clamp((wo.z - wi.z) / sines, -1.0, 1.0) : 1.0);
  if (h.x * wi.y - h.y * wi.x < 0.0) phi = TB_PI - phi;
  vec4 rho = textureLod(measured_table, vec3(phi / TB_PI, angles.y * (2.0 / TB_PI), sqrt(angles.x * (2.0 / TB_PI))), 0.0);
  return vec4(rho.rgb, rho.a > 0.5 ? 1.0 : 0.0);
}
#else
uniform highp sampler2D measured_nodes;
struct Corners {
  ivec4 node;
  vec4 weight;
};
Corners corners_of(vec3 w) {
  float x = clamp(tb_acos(clamp(w.z, 0.0, 1.0)) * (2.0 / TB_PI) * float(MEASURED_THETAS), 0.0, float(MEASURED_THETAS - 1));
  float turns = tb_atan2(w.y, w.x) * (0.5 / TB_PI), y = (turns - floor(turns)) * float(MEASURED_PHIS);
  int a = min(int(x), MEASURED_THETAS - 1), b = min(int(y), MEASURED_PHIS - 1);
  int above = min(a + 1, MEASURED_THETAS - 1), next = (b + 1) % MEASURED_PHIS;
  float s = x - float(a), t = y - float(b);
  return Corners(ivec4(a * MEASURED_PHIS + b, a * MEASURED_PHIS + next, above * MEASURED_PHIS + b, above * MEASURED_PHIS + next),
                 vec4((1.0 - s) * (1.0 - t), (1.0 - s) * t, s * (1.0 - t), s * t));
}
vec4 material(vec3 wi, vec3 wo) {
  Corners i = corners_of(wi), o = corners_of(wo);
  vec4 rho = vec4(0.0);
  for (int k = 0; k < 4; ++k) {
    for (int l = 0; l < 4; ++l) rho += i.weight[k] * o.weight[l] * texelFetch(measured_nodes, ivec2(o.node[l], i.node[k]), 0);
  }
  float inside = min(wi.z, wo.z) >= MEASURED_MIN_COSINE ? 1.0 : 0.0;
  return vec4(rho.rgb, rho.a > 0.5 ? inside : 0.0);
}
#endif
