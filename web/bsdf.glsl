// A model rho_C = d_C + sum_m s_C^m D^m F_C G^m(wi) G^m(wo) / (cos theta_i cos theta_o) by its tables, for
// shaders with floats of 32 bits. What stands before this text says which form the model has (TB_...),
// declares trilobe_tables, trilobe_diffuse and trilobe_specular. Directions are unit vectors away from
// the surface, z along the normal, x where an anisotropic material's azimuths begin; all is 0 below it.
// Arc functions and sines are polynomials here, since GLSL promises of its own only some 1e-3. The text keeps to
// what HLSL is made of by exchanging words (src/io/pictures/shader_file.cc).
const float TB_PI = 3.14159265358979;
const vec3 TB_BLACK = vec3(0.0, 0.0, 0.0);
const vec4 TB_ONES = vec4(1.0, 1.0, 1.0, 1.0);

vec4 tb_fetch(int i) { return texelFetch(trilobe_tables, ivec2(i & 255, i >> 8), 0); }
float tb_number(int base, int i) { return tb_fetch(base + (i >> 2))[i & 3]; }

// The arc cosines of 1 - y, y in [0, 1]: sqrt(y) times a polynomial (within 3e-9, by Chebyshev points), exact
// near 0 where a cosine says little.
vec4 tb_acos_one_minus(vec4 y) {
  vec4 p = 0.0006993963 * y - 0.0015605804;
  p = p * y + 0.0024679272;
  p = p * y - 0.0003894174;
  p = p * y + 0.0032021336;
  p = p * y + 0.0077852172;
  p = p * y + 0.0265273741;
  p = p * y + 0.1178507074;
  p = p * y + 1.4142135651;
  return sqrt(y) * p;
}
float tb_acos(float x) {
  float a = tb_acos_one_minus(clamp(1.0 - abs(x), 0.0, 1.0) * TB_ONES).x;
  return x < 0.0 ? TB_PI - a : a;
}
float tb_atan2(float y, float x) {
  float a = abs(x), b = abs(y), high = max(a, b);
  float t = high > 0.0 ? min(a, b) / high : 0.0;
  bool large = t > 0.41421356;
  float v = large ? (t - 1.0) / (t + 1.0) : t, z = v * v;
  float angle = (((8.05374449538e-2 * z - 1.38776856032e-1) * z + 1.99777106478e-1) * z -
                 3.33329491539e-1) * z * v + v + (large ? TB_PI / 4.0 : 0.0);
  if (b > a) angle = TB_PI / 2.0 - angle;
  if (x < 0.0) angle = TB_PI - angle;
  return y < 0.0 ? -angle : angle;
}
// (cos, sin) of an angle from -2 pi to 2 pi.
vec2 tb_circle(float angle) {
  float quadrant = floor(angle / (TB_PI / 2.0) + 0.5);
  float x = (angle - quadrant * 1.5707963) - quadrant * 2.6794897e-8, z = x * x;
  float s = ((-1.9515295891e-4 * z + 8.3321608736e-3) * z - 1.6666654611e-1) * z * x + x;
  float c = ((2.443315711809948e-5 * z - 1.388731625493765e-3) * z + 4.166664568298827e-2) * z * z -
            0.5 * z + 1.0;
  int q = int(quadrant) & 3;
  return q == 0 ? vec2(c, s) : q == 1 ? vec2(-s, c) : q == 2 ? vec2(-c, -s) : vec2(s, -c);
}

bool tb_above(vec3 w) { return w.z > 0.0 && w.z < 2.0; }  // false of what is not a number

#if TB_LOBES > 0
// Two neighbours of a table and how far from the first to the second.
struct TbPlace {
  int lower, upper;
  float t;
};
TbPlace tb_place(int lower, int upper, float t) {
  TbPlace at;
  at.lower = lower;
  at.upper = upper;
  at.t = t;
  return at;
}
// Place among bins of unit width, constant beyond the outer centres.
TbPlace tb_linear(float coordinate, int bins) {
  float x = clamp(coordinate - 0.5, 0.0, float(bins - 1));
  int lower = min(int(x), bins - 2);
  return tb_place(lower, lower + 1, x - float(lower));
}
// Place among rings at angles [degrees], four in a texel, ascending, filled up by 1e9.
TbPlace tb_ring(float theta, int base, int rings) {
  float degrees_ = theta * (180.0 / TB_PI), begin = -1.0, end = 1e9;
  int upper = 0;
  for (int i = 0; i < (rings + 3) / 4; ++i) {
    vec4 r = tb_fetch(base + i), below = step(r, degrees_ * TB_ONES);
    upper += int(dot(below, TB_ONES) + 0.5);
    vec4 b = mix(-TB_ONES, r, below), e = mix(r, 1e9 * TB_ONES, below);
    begin = max(begin, max(max(b.x, b.y), max(b.z, b.w)));
    end = min(end, min(min(e.x, e.y), min(e.z, e.w)));
  }
  if (upper == 0) return tb_place(0, 0, 0.0);
  if (upper == rings) return tb_place(rings - 1, rings - 1, 0.0);
  return tb_place(upper - 1, upper, (degrees_ - begin) / (end - begin));
}
TbPlace tb_turn(vec3 w, float sin_theta, int phis) {
  if (phis == 1 || !(sin_theta > 1e-9)) return tb_place(0, 0, 0.0);
  float turns = tb_atan2(w.y, w.x) * (0.5 / TB_PI);
  float x = (turns < 0.0 ? turns + 1.0 : turns) * float(phis);
  int lower = min(int(x), phis - 1);
  return tb_place(lower, lower + 1 < phis ? lower + 1 : 0, x - float(lower));
}
vec4 tb_between(int base, int groups, int group, TbPlace at) {
  return mix(tb_fetch(base + at.lower * groups + group), tb_fetch(base + at.upper * groups + group),
             at.t);
}
vec4 tb_polar(int base, int groups, int group, int phis, TbPlace a, TbPlace b) {
  int low = base + a.lower * phis * groups + group, high = base + a.upper * phis * groups + group;
  return mix(mix(tb_fetch(low + b.lower * groups), tb_fetch(low + b.upper * groups), b.t),
             mix(tb_fetch(high + b.lower * groups), tb_fetch(high + b.upper * groups), b.t), a.t);
}

#define TB_TABLE(PER_LOBE, PER_CHANNEL, m, c) ((PER_LOBE) * (m) * (2 * (PER_CHANNEL) + 1) + (PER_CHANNEL) * (c))
// Up to four tables are one vector; arrays, even of one, are several times as slow without a graphics card.
#if TB_D_GROUPS == 1
#define TB_D_GROUP(g) D
#define TB_D_AT(t) D[(t) % 4]
#else
#define TB_D_GROUP(g) D[g]
#define TB_D_AT(t) D[(t) / 4][(t) % 4]
#endif
#if TB_F_GROUPS == 1
#define TB_F_GROUP(g) F
#define TB_F_AT(t) F[(t) % 4]
#else
#define TB_F_GROUP(g) F[g]
#define TB_F_AT(t) F[(t) / 4][(t) % 4]
#endif
#if TB_G_GROUPS == 1
#define TB_G_GROUP(g) G
#define TB_G_AT(t) G[(t) % 4]
#else
#define TB_G_GROUP(g) G[g]
#define TB_G_AT(t) G[(t) / 4][(t) % 4]
#endif
#define TB_LOBE(m) \
  lobes += trilobe_specular[m] * vec3(TB_D_AT(TB_TABLE(TB_D_PER_LOBE, TB_D_PER_CHANNEL, m, 0)), \
                                      TB_D_AT(TB_TABLE(TB_D_PER_LOBE, TB_D_PER_CHANNEL, m, 1)), \
                                      TB_D_AT(TB_TABLE(TB_D_PER_LOBE, TB_D_PER_CHANNEL, m, 2))) * \
           vec3(TB_F_AT(TB_TABLE(TB_F_PER_LOBE, TB_F_PER_CHANNEL, m, 0)), \
                TB_F_AT(TB_TABLE(TB_F_PER_LOBE, TB_F_PER_CHANNEL, m, 1)), \
                TB_F_AT(TB_TABLE(TB_F_PER_LOBE, TB_F_PER_CHANNEL, m, 2))) * \
           vec3(TB_G_AT(TB_TABLE(TB_G_PER_LOBE, TB_G_PER_CHANNEL, m, 0)), \
                TB_G_AT(TB_TABLE(TB_G_PER_LOBE, TB_G_PER_CHANNEL, m, 1)), \
                TB_G_AT(TB_TABLE(TB_G_PER_LOBE, TB_G_PER_CHANNEL, m, 2)));

TbPlace tb_place_d(float theta) {
#if TB_D_ROOT == 1
  return tb_linear(float(TB_D_SIZE) * sqrt(theta * (2.0 / TB_PI)), TB_D_SIZE);
#else
  return tb_linear(float(TB_D_SIZE) * (theta * (2.0 / TB_PI)), TB_D_SIZE);
#endif
}

// The lobes alone, of directions above the surface; may be negative where the spline through G is.
vec3 tb_lobes(vec3 wi, vec3 wo) {
  vec3 h = wi + wo;
  float across2 = dot(h.xy, h.xy), size = sqrt(across2 + h.z * h.z);
  if (!(size > 0.0 && size < 4.0)) return TB_BLACK;
  h /= size;
  float sin2_h = across2 / (size * size), cos_d = size / 2.0;
  // 1 - cos = sin^2 / (1 + cos), also of theta_d, whose sine is |wi - wo| / 2.
  vec3 between = wi - wo;
  vec4 angles = tb_acos_one_minus(clamp(vec4(sin2_h / (1.0 + h.z),
                                             dot(between, between) / (4.0 * (1.0 + cos_d)),
                                             dot(wi.xy, wi.xy) / (1.0 + wi.z),
                                             dot(wo.xy, wo.xy) / (1.0 + wo.z)), 0.0, 1.0));
#if TB_D_GROUPS == 1
  vec4 D;
#else
  vec4 D[TB_D_GROUPS];
#endif
#if TB_F_GROUPS == 1
  vec4 F;
#else
  vec4 F[TB_F_GROUPS];
#endif
#if TB_G_GROUPS == 1
  vec4 G;
#else
  vec4 G[TB_G_GROUPS];
#endif
#if TB_D_PHIS > 0
  TbPlace ring_h = tb_ring(angles.x, TB_D_RINGS_BASE, TB_D_RINGS), turn_h = tb_turn(h, sqrt(sin2_h), TB_D_PHIS);
  for (int g = 0; g < TB_D_GROUPS; ++g) {
    TB_D_GROUP(g) = tb_polar(TB_D_BASE, TB_D_GROUPS, g, TB_D_PHIS, ring_h, turn_h);
  }
#elif TB_STRETCHES == 0
  TbPlace at_h = tb_place_d(angles.x);
  for (int g = 0; g < TB_D_GROUPS; ++g) TB_D_GROUP(g) = tb_between(TB_D_BASE, TB_D_GROUPS, g, at_h);
#else
  // cos theta_o - cos theta_i = 2 sin theta_h sin theta_d cos phi_d.
  float sines = 2.0 * sqrt(sin2_h) * sqrt(max(1.0 - cos_d * cos_d, 0.0));
  float cos_phi = sines > 0.0 ? clamp((wo.z - wi.z) / sines, -1.0, 1.0) : 1.0;
  float cos2_phi = cos_phi * cos_phi, log_cosine = log2(max(cos_d, 1e-4));
  for (int k = 0; k < TB_STRETCHES; ++k) {
    vec2 e = trilobe_stretch[k];
    float factor = sqrt(cos2_phi * exp2(2.0 * e.x * log_cosine) +
                        (1.0 - cos2_phi) * exp2(2.0 * e.y * log_cosine));
    TbPlace at_h = tb_place_d(min(angles.x * factor, TB_PI / 2.0));
#if TB_STRETCHES == 1
    for (int g = 0; g < TB_D_GROUPS; ++g) TB_D_GROUP(g) = tb_between(TB_D_BASE, TB_D_GROUPS, g, at_h);
#else
    for (int g = 0; g < TB_D_GROUPS; ++g) {
      vec4 read = tb_between(TB_D_BASE, TB_D_GROUPS, g, at_h), mine;
      for (int t = 0; t < 4; ++t) {
        mine[t] = trilobe_stretch_of[min(4 * g + t, TB_D_TABLES - 1)] == k ? 1.0 : 0.0;
      }
      TB_D_GROUP(g) = k == 0 ? read * mine : TB_D_GROUP(g) + read * mine;
    }
#endif
  }
#endif
  TbPlace at_d = tb_linear(float(TB_F_SIZE) * (angles.y * (2.0 / TB_PI)), TB_F_SIZE);
  for (int g = 0; g < TB_F_GROUPS; ++g) TB_F_GROUP(g) = tb_between(TB_F_BASE, TB_F_GROUPS, g, at_d);
#if TB_G_PHIS > 0
  TbPlace ring_i = tb_ring(angles.z, TB_G_RINGS_BASE, TB_G_RINGS), turn_i = tb_turn(wi, length(wi.xy), TB_G_PHIS);
  TbPlace ring_o = tb_ring(angles.w, TB_G_RINGS_BASE, TB_G_RINGS), turn_o = tb_turn(wo, length(wo.xy), TB_G_PHIS);
  float scale = 1.0 / max(wi.z * wo.z, 1e-37);
  for (int g = 0; g < TB_G_GROUPS; ++g) {
    TB_G_GROUP(g) = tb_polar(TB_G_BASE, TB_G_GROUPS, g, TB_G_PHIS, ring_i, turn_i) *
           (tb_polar(TB_G_BASE, TB_G_GROUPS, g, TB_G_PHIS, ring_o, turn_o) * scale);
  }
#else
  // A spline: values and what bends it, by turns. The table after the last is that of the cosines.
  TbPlace i = tb_linear(float(TB_G_SIZE) * (angles.z * (2.0 / TB_PI)), TB_G_SIZE);
  TbPlace o = tb_linear(float(TB_G_SIZE) * (angles.w * (2.0 / TB_PI)), TB_G_SIZE);
  float ui = 1.0 - i.t, uo = 1.0 - o.t;
  for (int g = 0; g < TB_G_GROUPS; ++g) {
    int at_i = TB_G_BASE + (i.lower * TB_G_GROUPS + g) * 2, at_o = TB_G_BASE + (o.lower * TB_G_GROUPS + g) * 2;
    const int next = 2 * TB_G_GROUPS;
    TB_G_GROUP(g) = (ui * tb_fetch(at_i) + i.t * tb_fetch(at_i + next) +
            i.t * ui * (ui * tb_fetch(at_i + 1) + i.t * tb_fetch(at_i + next + 1))) *
           (uo * tb_fetch(at_o) + o.t * tb_fetch(at_o + next) +
            o.t * uo * (uo * tb_fetch(at_o + 1) + o.t * tb_fetch(at_o + next + 1)));
  }
  float scale = 1.0 / TB_G_AT(TB_G_TABLES);
  for (int g = 0; g < TB_G_GROUPS; ++g) TB_G_GROUP(g) *= scale;
#endif
  vec3 lobes = TB_BLACK;
  TB_LOBE(0)
#if TB_LOBES > 1
  TB_LOBE(1)
#endif
#if TB_LOBES > 2
  TB_LOBE(2)
#endif
#if TB_LOBES > 3
  TB_LOBE(3)
#endif
#if TB_LOBES > 4
  TB_LOBE(4)
#endif
#if TB_LOBES > 5
  TB_LOBE(5)
#endif
#if TB_LOBES > 6
  TB_LOBE(6)
#endif
#if TB_LOBES > 7
  TB_LOBE(7)
#endif
  return lobes;
}
#endif

// The BRDF [1/sr], without a cosine.
vec3 trilobe_eval(vec3 wi, vec3 wo) {
  if (!(tb_above(wi) && tb_above(wo))) return TB_BLACK;
#if TB_LOBES > 0
  return max(trilobe_diffuse + tb_lobes(wi, wo), 0.0);
#else
  return trilobe_diffuse;
#endif
}
