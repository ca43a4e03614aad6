// Sampling, as trilobe::Bsdf does it: a cosine for the diffuse term, and half vectors of all lobes from a
// table, for some directions wi, of what they reflect over y = sin^2 theta_h and s, the azimuth of h from
// that of wi as a part of the range in which wo is above the surface.
const int TB_NODES = TB_THETAS_I * TB_PHIS_I;

float tb_values(int node, int row, int k) { return tb_number(TB_VALUES_BASE, (node * TB_ROWS + row) * TB_S + k); }
float tb_y(int row) { return tb_number(TB_Y_BASE, row); }

// Place of wi between the nodes, the end of its half vectors, and the integral of all.
struct TbIncident {
  ivec4 node;
  vec4 weight;
  vec2 azimuth;  // (cos, sin)
  float sin_i, end, total, cosine_part;
};
float tb_of_row(TbIncident at, int row) {
  float sum = 0.0;
  for (int n = 0; n < 4; ++n) sum += at.weight[n] * tb_number(TB_OF_ROW_BASE, at.node[n] * TB_ROWS + row);
  return sum;
}
float tb_cumulated(TbIncident at, int row) {
  float sum = 0.0;
  for (int n = 0; n < 4; ++n) sum += at.weight[n] * tb_number(TB_CUMULATED_BASE, at.node[n] * TB_ROWS + row);
  return sum;
}
int tb_row_of(float y) {
  int low = 0, high = TB_ROWS - 1;
  while (high - low > 1) {
    int middle = (low + high) / 2;
    if (tb_y(middle) <= y) low = middle; else high = middle;
  }
  return low;
}
// The azimuth between h and wi up to which wo is above the surface.
float tb_max_phi(float cos_i, float sin_i, float cos_h, float sin_h) {
  float denominator = 2.0 * sin_h * cos_h * sin_i, numerator = -cos_i * (2.0 * cos_h * cos_h - 1.0);
  if (numerator <= -denominator) return TB_PI;
  return numerator >= denominator ? 0.0 : tb_acos(numerator / denominator);
}
TbIncident tb_incident(vec3 wi) {
  TbIncident at;
  at.sin_i = length(wi.xy);
  bool at_normal = !(at.sin_i > 1e-9);
  at.azimuth = at_normal ? vec2(1.0, 0.0) : wi.xy / at.sin_i;
  float theta = tb_atan2(at.sin_i, wi.z);
  int ring = 0;
  while (ring + 2 < TB_THETAS_I && tb_number(TB_THETA_I_BASE, ring + 1) <= theta) ++ring;
  float begin = tb_number(TB_THETA_I_BASE, ring), end = tb_number(TB_THETA_I_BASE, ring + 1);
  float t = clamp((theta - begin) / (end - begin), 0.0, 1.0);
#if TB_PHIS_I > 1
  float turns = at_normal ? 0.0 : tb_atan2(wi.y, wi.x) * (0.5 / TB_PI);
  float x = (turns - floor(turns)) * float(TB_PHIS_I);
  int low = min(int(x), TB_PHIS_I - 1), high = low + 1 < TB_PHIS_I ? low + 1 : 0;
  float f = x - float(low);
  at.node = ivec4(ring * TB_PHIS_I + low, ring * TB_PHIS_I + high, (ring + 1) * TB_PHIS_I + low,
                  (ring + 1) * TB_PHIS_I + high);
  at.weight = vec4((1.0 - t) * (1.0 - f), (1.0 - t) * f, t * (1.0 - f), t * f);
#else
  at.node = ivec4(ring, ring + 1, ring, ring);
  at.weight = vec4(1.0 - t, t, 0.0, 0.0);
#endif
  // No half vector further than half of theta_i + 90 degrees has a wo above the surface.
  at.end = min((1.0 + at.sin_i) / 2.0, 1.0);
  int row = tb_row_of(at.end);
  float y0 = tb_y(row), part = at.end - y0, width = tb_y(row + 1) - y0;
  float from = tb_of_row(at, row), to = tb_of_row(at, row + 1);
  at.total = tb_cumulated(at, row) + part * (from + (to - from) * part / (2.0 * width));
  // One of a hundred is drawn by the cosine, too, lest something between the nodes be missed.
  float diffuse = TB_PI / 3.0 * (trilobe_diffuse.x + trilobe_diffuse.y + trilobe_diffuse.z) + 0.01 * at.total;
  at.cosine_part = at.total > 0.0 ? diffuse / (diffuse + at.total) : 1.0;
  return at;
}
float tb_value_at(TbIncident at, float y, float s) {
  if (y > at.end) return 0.0;
  int row = tb_row_of(y);
  float y0 = tb_y(row), t = clamp((y - y0) / (tb_y(row + 1) - y0), 0.0, 1.0);
  float x = clamp(s, 0.0, 1.0) * float(TB_S - 1);
  int k = min(int(x), TB_S - 2);
  float f = x - float(k), sum = 0.0;
  for (int n = 0; n < 4; ++n) {
    if (at.weight[n] == 0.0) continue;
    sum += at.weight[n] * mix(mix(tb_values(at.node[n], row, k), tb_values(at.node[n], row, k + 1), f),
                              mix(tb_values(at.node[n], row + 1, k), tb_values(at.node[n], row + 1, k + 1), f), t);
  }
  return sum;
}
float tb_lobes_pdf(vec3 wi, TbIncident at, vec3 wo) {
  vec3 h = wi + wo;
  float size = length(h);
  h /= size;
  float y = dot(h.xy, h.xy), sin_h = sqrt(y), phi_max = tb_max_phi(wi.z, at.sin_i, h.z, sin_h);
  if (!(at.total > 0.0 && phi_max > 0.0 && size > 0.0)) return 0.0;
  float phi = tb_atan2(h.y * at.azimuth.x - h.x * at.azimuth.y, h.x * at.azimuth.x + h.y * at.azimuth.y);
#if TB_PHIS_I > 1
  float s = (phi / phi_max + 1.0) / 2.0;
#else
  float s = abs(phi) / phi_max;
#endif
  return tb_value_at(at, y, s) / at.total * h.z / (2.0 * size * phi_max);
}
// The t up to which a density that goes from a to b has the part u of its integral.
float tb_invert_linear(float a, float b, float u) {
  float twice = u * (a + b), root = a + sqrt(max(a * a + (b - a) * twice, 0.0));
  return root > 0.0 ? min(twice / root, 1.0) : u;
}

// The density with which trilobe_sample draws wo [1/sr].
float trilobe_pdf(vec3 wi, vec3 wo) {
  if (!(tb_above(wi) && tb_above(wo))) return 0.0;
  TbIncident at = tb_incident(wi);
  return at.cosine_part * wo.z / TB_PI + (1.0 - at.cosine_part) * tb_lobes_pdf(wi, at, wo);
}

// A direction wo by two numbers in [0, 1], its density [1/sr], and f cos theta_o / pdf; skip it where
// that density is 0.
vec3 trilobe_sample(vec3 wi, vec2 u, out float pdf, out vec3 weight) {
  pdf = 0.0;
  weight = TB_BLACK;
  if (!tb_above(wi)) return TB_BLACK;
  TbIncident at = tb_incident(wi);
  const float below_one = 1.0 - 1.1920929e-7;
  u = clamp(u, 0.0, below_one);
  float part = at.cosine_part, lobes_pdf = 0.0;
  vec3 wo;
  if (u.x < part) {
    float r2 = u.x / part;
    wo = vec3(sqrt(r2) * tb_circle(2.0 * TB_PI * u.y), sqrt(max(1.0 - r2, 1e-37)));
    if (part < 1.0) lobes_pdf = tb_lobes_pdf(wi, at, wo);
  } else {
    float wanted = min((u.x - part) / (1.0 - part), below_one) * at.total, around = 2.0 * u.y - 1.0;
    int low = 0, high = TB_ROWS - 1;
    while (high - low > 1) {
      int middle = (low + high) / 2;
      if (tb_cumulated(at, middle) <= wanted) low = middle; else high = middle;
    }
    float before = tb_cumulated(at, low), mass = tb_cumulated(at, low + 1) - before;
    float t = tb_invert_linear(tb_of_row(at, low), tb_of_row(at, low + 1),
                               mass > 0.0 ? clamp((wanted - before) / mass, 0.0, 1.0) : 0.5);
    float row[TB_S], left = 0.0;
    for (int k = 0; k < TB_S; ++k) {
      row[k] = 0.0;
      for (int n = 0; n < 4; ++n) {
        if (at.weight[n] == 0.0) continue;
        row[k] += at.weight[n] * mix(tb_values(at.node[n], low, k), tb_values(at.node[n], low + 1, k), t);
      }
      left += k == 0 || k == TB_S - 1 ? row[k] / 2.0 : row[k];
    }
#if TB_PHIS_I > 1
    left *= u.y;
#else
    left *= abs(around);
#endif
    int k = 0;
    for (; k < TB_S - 2; ++k) {
      float cell = (row[k] + row[k + 1]) / 2.0;
      if (left < cell) break;
      left -= cell;
    }
    float cell = (row[k] + row[k + 1]) / 2.0;
    float f = tb_invert_linear(row[k], row[k + 1], cell > 0.0 ? clamp(left / cell, 0.0, 1.0) : 0.5);
    float y = min(mix(tb_y(low), tb_y(low + 1), t), at.end), s = (float(k) + f) / float(TB_S - 1);
    float sin_h = sqrt(y), cos_h = sqrt(max(1.0 - y, 0.0)), phi_max = tb_max_phi(wi.z, at.sin_i, cos_h, sin_h);
#if TB_PHIS_I > 1
    float phi = phi_max * (2.0 * s - 1.0);
#else
    float phi = phi_max * (around < 0.0 ? -s : s);
#endif
    vec2 p = sin_h * tb_circle(phi);
    vec3 h = vec3(p.x * at.azimuth.x - p.y * at.azimuth.y, p.x * at.azimuth.y + p.y * at.azimuth.x, cos_h);
    float twice = 2.0 * dot(wi, h);
    wo = twice * h - wi;
    if (phi_max > 0.0 && twice > 0.0) {
      lobes_pdf = mix(row[k], row[k + 1], f) / at.total * cos_h / (2.0 * twice * phi_max);
    }
  }
  if (!(wo.z > 0.0)) return TB_BLACK;  // by rounding, at the horizon
  pdf = part * wo.z / TB_PI + (1.0 - part) * lobes_pdf;
  if (pdf > 0.0) weight = trilobe_eval(wi, wo) * (wo.z / pdf);
  return wo;
}
