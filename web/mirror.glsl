// The environment as mirrors with the normals of a disc send it to the eye (src/model/appearance/mirrored_environment.cc).
uniform highp sampler2D environment;  // latitude and longitude
uniform float turn;                   // rotation of the environment about y, in turns
layout(location = 0) out vec4 seen;

vec3 reflected(vec2 p) {
  float radius = length(p);
  if (radius > 1.0) p *= (radius - 2.0) / radius;  // on the other side
  float z2 = max(1.0 - dot(p, p), 0.0), z = sqrt(z2);
  vec3 light = vec3(2.0 * z * p, 2.0 * z2 - 1.0);
  ivec2 size = textureSize(environment, 0);
  float column = tb_atan2(light.x, -light.z) * (0.5 / TB_PI) + 0.5 + turn;
  ivec2 at = ivec2(vec2(column - floor(column), tb_acos(clamp(light.y, -1.0, 1.0)) / TB_PI) * vec2(size));
  return texelFetch(environment, min(at, size - 1), 0).rgb;
}

void main() {
  vec3 sum = vec3(0.0);
  for (int k = 0; k < 4; ++k) {
    vec2 at = floor(gl_FragCoord.xy) + vec2(float(k % 2) + 0.5, float(k / 2) + 0.5) / 2.0;
    sum += reflected(vec2(at.x / 256.0 - 1.0, 1.0 - at.y / 256.0));
  }
  seen = vec4(sum / 4.0, 1.0);
}
