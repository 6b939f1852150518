#include "weft/render/shaders.h"

namespace weft::engine {
namespace {

const char* const kHead = "#version 330 core\n";

// ---- Meshes ----

const char* const kMeshVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 fabric;
uniform mat4 to_clip;
out vec3 world;
out vec3 world_normal;
out vec2 warp_weft;

void main() {
  world = position;
  world_normal = normal;
  warp_weft = fabric;
  gl_Position = to_clip * vec4(position, 1.0);
}
)";

const char* const kDepthVertex = R"(
layout(location = 0) in vec3 position;
uniform mat4 to_clip;

void main() { gl_Position = to_clip * vec4(position, 1.0); }
)";

const char* const kDepthFragment = R"(
void main() {}
)";

// Surface shading: sun through the shadow map, sky and ground through ambient occlusion. Cloth is lit from
// both sides, is translucent, and has a soft sheen at grazing angles.
const char* const kSurfaceFragment = R"(
in vec3 world;
in vec3 world_normal;
in vec2 warp_weft;
uniform vec3 eye;
uniform vec3 color;           // linear
uniform float check_size;     // [m]
uniform vec3 to_sun, sun, sky, ground;
uniform float exposure;
uniform mat4 to_shadow;       // world to the shadow map's texture
uniform float shadow_texel;   // side of a texel of the shadow map in the world [m], 0: no shadows
uniform float shadow_size;    // texels on a side
uniform sampler2DShadow shadow_compare;
uniform sampler2D shadow_depth;
uniform float shadow_depth_range;  // [m]
uniform sampler2D occlusion;
uniform vec2 pixel;           // pixel size in the occlusion texture's coordinates
uniform vec3 horizon;
uniform vec2 fade;            // distances where the ground's fade into the horizon begins and ends [m]
out vec4 result;

const int kFabric = 0, kSolid = 1, kGround = 2;  // values of KIND, one program each
const float kSunSize = 0.06;  // the light's width as seen from its target: soft shadows

// Uniform samples of a disc.
const vec2 kDisc[16] = vec2[](
    vec2(0.177, 0.000), vec2(-0.226, 0.207), vec2(0.035, -0.394), vec2(0.285, 0.371),
    vec2(-0.522, -0.092), vec2(0.495, -0.315), vec2(-0.165, 0.616), vec2(-0.316, -0.608),
    vec2(0.685, 0.250), vec2(-0.712, 0.294), vec2(0.343, -0.734), vec2(0.254, 0.809),
    vec2(-0.765, -0.443), vec2(0.897, -0.197), vec2(-0.548, 0.779), vec2(-0.126, -0.976));

// Sun visibility in [0, 1]. Loops end early where nothing or everything is occluded: software drivers skip
// the rest of a loop, but execute both sides of a branch.
float sunlight(vec3 n) {
  const int kLooks = 6, kTaps = 12;
  vec4 place = to_shadow * vec4(world + 4.0 * shadow_texel * n, 1.0);
  bool outside = any(lessThan(place.xy, vec2(0.0))) || any(greaterThan(place.xy, vec2(1.0)));
  place.z -= shadow_texel / shadow_depth_range;
  // Depth bias along the tangent plane, against self-shadowing.
  vec3 across = mat3(to_shadow) * n;
  vec2 slope = clamp(-across.xy / min(across.z, -1e-6), -4.0, 4.0);
  // Random rotation per pixel: grain is less visible than bands (interleaved gradient noise, Jimenez 2014).
  float angle = 6.2832 * fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
  mat2 turn = mat2(cos(angle), sin(angle), -sin(angle), cos(angle));
  // Blocker distance: the farther, the softer the shadow.
  float map_side = shadow_texel * shadow_size, blockers = 0.0, gap = 0.0;
  mat2 search = 0.04 / map_side * turn;
  int looks = outside || shadow_texel == 0.0 ? 0 : kLooks;
  for (int i = 0; i < looks; ++i) {
    vec2 beside = search * kDisc[2 * i];
    float depth = texture(shadow_depth, place.xy + beside).r;
    if (depth < min(place.z + dot(slope, beside), 1.0)) {  // the map ends at 1, the ground lies farther
      blockers += 1.0;
      gap += place.z - depth;
    }
  }
  float radius = clamp(kSunSize * gap / max(blockers, 1.0) * shadow_depth_range, 1.2 * shadow_texel, 0.04) / map_side;
  mat2 spread = radius * turn;
  float light = 0.0;
  bool is_clear = blockers == 0.0, is_dark = blockers == float(kLooks);
  int taps = is_clear || is_dark ? 0 : kTaps;
  for (int i = 0; i < taps; ++i) {
    vec2 beside = spread * kDisc[i];
    light += texture(shadow_compare, vec3(place.xy + beside, min(place.z + dot(slope, beside), 1.0)));
  }
  return is_clear ? 1.0 : is_dark ? 0.0 : light / float(kTaps);
}

// A square wave of period 2 and height 1, averaged over `width`.
float stripe(float x, float width) {
  vec2 ends = vec2(x - 0.5 * width, x + 0.5 * width);
  vec2 area = floor(0.5 * ends) + max(vec2(0.0), 2.0 * fract(0.5 * ends) - 1.0);
  return (area.y - area.x) / width;
}

// Checks of two yarns: light, dark, and between where they cross. Close up, the yarns are visible.
vec3 fabric_color() {
  if (check_size == 0.0) return color;
  vec2 place = warp_weft / check_size;
  vec2 width = max(fwidth(place), vec2(1e-4));
  float dark = stripe(place.x, width.x) + stripe(place.y, width.y);
  vec3 shade = mix(mix(color, vec3(1.0), 0.13), 0.55 * color, 0.5 * dark);
  vec2 yarn = warp_weft * 1200.0;
  float near = 1.0 - smoothstep(0.15, 0.5, max(fwidth(yarn.x), fwidth(yarn.y)));
  return shade * (1.0 - 0.25 * near * (0.5 - 0.5 * cos(6.2832 * yarn.x) * cos(6.2832 * yarn.y)));
}

// Linear up to a shoulder, above which light saturates softly; then sRGB.
vec3 film(vec3 light) {
  const float kShoulder = 0.7;
  vec3 over = max(light - kShoulder, 0.0) / (1.0 - kShoulder);
  vec3 c = min(light, kShoulder) + (1.0 - kShoulder) * over / (1.0 + over);
  // c^(1/2.4) from square roots, within 1e-3: pow() is expensive in software.
  vec3 r2 = sqrt(c), r4 = sqrt(r2), r8 = sqrt(r4);
  vec3 root = 0.585122381 * r2 + 0.783140355 * r4 - 0.368262736 * r8;
  return mix(12.92 * c, 1.0549 * root - 0.0549, step(0.0031308, c));
}

void main() {
  vec3 n = normalize(world_normal), to_eye = normalize(eye - world);
  const bool is_fabric = KIND == kFabric;
  if (is_fabric && !gl_FrontFacing) n = -n;
  vec3 base = is_fabric ? fabric_color() : color;
  float open = texture(occlusion, gl_FragCoord.xy * pixel).r;
  float facing = dot(n, to_sun), lit = sunlight(facing < 0.0 ? -n : n);
  vec3 light = mix(ground, sky, 0.5 + 0.5 * n.y) * open;
  light += sun * lit * max(facing, 0.0) * mix(open, 1.0, 0.5);
  if (is_fabric) {
    light += 0.30 * sqrt(base) * sun * lit * max(-facing, 0.0);
    float grazing = 1.0 - abs(dot(n, to_eye));
    grazing *= grazing;
    light += 0.5 * grazing * grazing * mix(ground, sky, 0.5 + 0.5 * n.y) * open;
  }
  vec3 shine = vec3(0.0);
  if (KIND == kSolid) {
    float s = max(dot(n, normalize(to_sun + to_eye)), 0.0);
    for (int i = 0; i < 5; ++i) s *= s;  // to the 32nd
    shine = 0.12 * s * sun * lit;
  }
  vec3 c = film(exposure * (base * light + shine));
  if (KIND == kGround) c = mix(c, horizon, smoothstep(fade.x, fade.y, length(world.xz - eye.xz)));
  result = vec4(c, 1.0);
}
)";

// ---- Full-screen passes ----

const char* const kScreenVertex = R"(
out vec2 place;  // 0 to 1

void main() {
  place = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
  gl_Position = vec4(2.0 * place - 1.0, 1.0, 1.0);
}
)";

const char* const kSkyFragment = R"(
in vec2 place;
uniform mat4 from_clip;  // to directions in the world
uniform vec3 horizon, zenith;
out vec4 result;

void main() {
  vec4 direction = from_clip * vec4(2.0 * place - 1.0, 1.0, 1.0);
  float up = normalize(direction.xyz).y;
  result = vec4(mix(horizon, zenith, smoothstep(0.0, 0.7, up)), 1.0);
}
)";

// Scalable ambient obscurance (McGuire, Mara, Luebke 2012): visibility of the hemisphere above each point's
// tangent plane.
const char* const kOcclusionFragment = R"(
in vec2 place;
uniform sampler2D depth;
uniform mat4 projection;
uniform vec2 pixel;
uniform float radius;  // [m]
out float result;

vec3 in_view(vec2 at) {
  float z = projection[3][2] / (2.0 * textureLod(depth, at, 0.0).r - 1.0 + projection[2][2]);
  return vec3((2.0 * at - 1.0) * z / vec2(projection[0][0], projection[1][1]), -z);
}

vec3 shorter(vec3 a, vec3 b) { return dot(a, a) < dot(b, b) ? a : b; }

void main() {
  if (textureLod(depth, place, 0.0).r == 1.0) {
    result = 1.0;
    return;
  }
  vec3 p = in_view(place);
  vec3 across = shorter(in_view(place + vec2(pixel.x, 0.0)) - p, p - in_view(place - vec2(pixel.x, 0.0)));
  vec3 upwards = shorter(in_view(place + vec2(0.0, pixel.y)) - p, p - in_view(place - vec2(0.0, pixel.y)));
  vec3 n = normalize(cross(across, upwards));
  vec2 reach = 0.5 * radius * vec2(projection[0][0], projection[1][1]) / -p.z;
  ivec2 cell = ivec2(gl_FragCoord.xy) & 3;
  float turn = 6.2832 / 16.0 * float(4 * ((cell.x + 2 * cell.y) & 3) + ((2 * cell.x + cell.y) & 3));
  float sum = 0.0;
  const int kSamples = 12;
  for (int i = 0; i < kSamples; ++i) {
    float r = (float(i) + 0.5) / float(kSamples), a = turn + 2.39996323 * float(i);
    vec3 v = in_view(place + r * reach * vec2(cos(a), sin(a))) - p;
    float near = max(radius * radius - dot(v, v), 0.0);
    sum += near * near * near * max((dot(v, n) - 0.03 * radius) / (0.003 * radius * radius + dot(v, v)), 0.0);
  }
  float r6 = pow(radius, 6.0);
  result = max(0.0, 1.0 - 5.0 * radius / r6 * sum / float(kSamples));
}
)";

const char* const kBlurFragment = R"(
in vec2 place;
uniform sampler2D occlusion, depth;
uniform mat4 projection;
uniform vec2 pixel;
out float result;

float depth_at(vec2 at) {
  return projection[3][2] / (2.0 * textureLod(depth, at, 0.0).r - 1.0 + projection[2][2]);
}

void main() {
  float here = depth_at(place), sum = 0.0, weights = 0.0;
  for (int y = -2; y < 2; ++y) {  // as wide as the rotation pattern
    for (int x = -2; x < 2; ++x) {
      vec2 at = place + pixel * vec2(x, y);
      float weight = exp2(-25.0 * abs(depth_at(at) / here - 1.0));
      sum += weight * textureLod(occlusion, at, 0.0).r;
      weights += weight;
    }
  }
  result = sum / max(weights, 1e-4);
}
)";

// ---- Lines and dots ----

const char* const kLineVertex = R"(
layout(location = 0) in vec3 a;
layout(location = 1) in vec3 b;
uniform mat4 to_clip;
uniform vec2 size;    // of the target [pixels]
uniform float width;  // [pixels]

void main() {
  vec4 from = to_clip * vec4(a, 1.0), to = to_clip * vec4(b, 1.0);
  vec2 along = normalize((to.xy / to.w - from.xy / from.w) * size + vec2(1e-6, 0.0));
  vec4 end = gl_VertexID < 2 ? from : to;
  float side = (gl_VertexID & 1) == 0 ? 1.0 : -1.0;
  end.xy += side * width * vec2(-along.y, along.x) / size * end.w;
  end.z -= 0.0005 * end.w;
  gl_Position = end;
}
)";

const char* const kLineFragment = R"(
uniform vec3 color;  // sRGB
out vec4 result;

void main() { result = vec4(color, 1.0); }
)";

const char* const kDotVertex = R"(
layout(location = 0) in vec3 a;
uniform mat4 to_clip;
uniform vec2 size;
uniform float diameter;  // [pixels]
out vec2 corner;

void main() {
  corner = vec2((gl_VertexID & 1) == 0 ? -1.0 : 1.0, gl_VertexID < 2 ? -1.0 : 1.0);
  vec4 center = to_clip * vec4(a, 1.0);
  center.xy += corner * diameter / size * center.w;
  center.z -= 0.001 * center.w;
  gl_Position = center;
}
)";

const char* const kDotFragment = R"(
in vec2 corner;
uniform vec3 color;  // sRGB
out vec4 result;

void main() {
  float r2 = dot(corner, corner);
  if (r2 > 1.0) discard;
  float light = dot(vec3(corner, sqrt(1.0 - r2)), vec3(-0.35, 0.55, 0.75));
  result = vec4(mix(0.7 * color, mix(color, vec3(1.0), 0.35), clamp(light, 0.0, 1.0)), 1.0);
}
)";

}  // namespace

ShaderSource shader_source(Program program) {
  const auto source = [](const char* vertex, const char* fragment, const char* definitions = "") {
    return ShaderSource{std::string(kHead) + vertex, std::string(kHead) + definitions + fragment};
  };
  switch (program) {
    case Program::depth:
      return source(kDepthVertex, kDepthFragment);
    case Program::occlusion:
      return source(kScreenVertex, kOcclusionFragment);
    case Program::blur:
      return source(kScreenVertex, kBlurFragment);
    case Program::sky:
      return source(kScreenVertex, kSkyFragment);
    case Program::fabric:
      return source(kMeshVertex, kSurfaceFragment, "#define KIND kFabric\n");
    case Program::solid:
      return source(kMeshVertex, kSurfaceFragment, "#define KIND kSolid\n");
    case Program::ground:
      return source(kMeshVertex, kSurfaceFragment, "#define KIND kGround\n");
    case Program::line:
      return source(kLineVertex, kLineFragment);
    case Program::dot:
      break;
  }
  return source(kDotVertex, kDotFragment);
}

}  // namespace weft::engine
