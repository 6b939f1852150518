#include "weft/render/shaders.h"

#include "weft/render/color_map.h"

namespace weft::engine {
namespace {

const char* const kHead = "#version 330 core\n";

// ---- Depth ----

const char* const kDepthVertex = R"(
layout(location = 0) in vec3 position;
uniform mat4 to_clip;

void main() { gl_Position = to_clip * vec4(position, 1.0); }
)";

const char* const kDepthFragment = R"(
void main() {}
)";

// ---- Materials ----

// Numbers of a surface's texel, in four floats that are whole numbers below 2^24:
// the mesh's smooth normal, the normal with the weave, the colour, and the mesh with its material.
const char* const kPacking = R"(
const float kGroundMesh = 255.0;  // index of the ground; meshes are 1 to 254, nothing is 0

struct Material {
  float translucency, sheen, gloss;  // 0 to 1
};

vec2 fold(vec2 v) { return (1.0 - abs(v.yx)) * vec2(v.x < 0.0 ? -1.0 : 1.0, v.y < 0.0 ? -1.0 : 1.0); }

// Octahedral map of unit vectors (Meyer et al. 2010), twelve bits a coordinate.
float pack_normal(vec3 n) {
  vec2 v = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  if (n.z < 0.0) v = fold(v);
  return dot(floor(clamp(0.5 + 0.5 * v, 0.0, 1.0) * 4095.0 + 0.5), vec2(4096.0, 1.0));
}

vec3 unpack_normal(float packed_normal) {
  float x = floor(packed_normal / 4096.0);
  vec2 v = vec2(x, packed_normal - 4096.0 * x) / 4095.0 * 2.0 - 1.0;
  float z = 1.0 - abs(v.x) - abs(v.y);
  if (z < 0.0) v = fold(v);
  return normalize(vec3(v, z));
}

// Square roots of linear light, eight bits a channel.
float pack_color(vec3 c) {
  return dot(floor(sqrt(clamp(c, 0.0, 1.0)) * 255.0 + 0.5), vec3(65536.0, 256.0, 1.0));
}

vec3 unpack_color(float packed_color) {
  vec2 upper = floor(packed_color / vec2(65536.0, 256.0));
  vec3 c = vec3(upper.x, upper.y - 256.0 * upper.x, packed_color - 256.0 * upper.y) / 255.0;
  return c * c;
}

float pack_material(float mesh, Material m) {
  vec3 shares = floor(clamp(vec3(m.translucency, m.sheen, m.gloss), 0.0, 1.0) * 31.0 + 0.5);
  return mesh * 32768.0 + dot(shares, vec3(1024.0, 32.0, 1.0));
}

float mesh_of(float packed_material) { return floor(packed_material / 32768.0); }

Material unpack_material(float packed_material) {
  float rest = packed_material - 32768.0 * mesh_of(packed_material);
  vec2 upper = floor(rest / vec2(1024.0, 32.0));
  return Material(upper.x / 31.0, (upper.y - 32.0 * upper.x) / 31.0, (rest - 32.0 * upper.y) / 31.0);
}
)";

const char* const kMeshVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 fabric;
layout(location = 3) in float value;
uniform mat4 to_clip;
out vec3 world;
out vec3 world_normal;
out vec2 warp_weft;
out float shown_value;

void main() {
  world = position;
  world_normal = normal;
  warp_weft = fabric;
  shown_value = value;
  gl_Position = to_clip * vec4(position, 1.0);
}
)";

const char* const kSolidFragment = R"(
in vec3 world_normal;
uniform vec3 color;   // linear
uniform float mesh;   // index, 1 to 255
uniform float gloss;  // 0 to 1
out vec4 result;

void main() {
  float n = pack_normal(normalize(world_normal));
  result = vec4(n, n, pack_color(color), pack_material(mesh, Material(0.0, 0.0, gloss)));
}
)";

// Threads, visible where a pixel is narrower than they are, and faded out before they could form moiré.
const char* const kFabricFragment = R"(
in vec3 world;
in vec3 world_normal;
in vec2 warp_weft;
in float shown_value;
uniform vec3 color, weft_color;  // linear
uniform float mesh;              // index, 1 to 254
uniform float shows_values;      // 1: colours are those of the values
uniform float check_size;        // 0: none [m]
uniform float weave;             // 1: plain, 2: twill, 3: satin, 4: knit
uniform float thread;            // distance of threads; 0: no weave [m]
uniform float translucency, sheen, gloss;  // 0 to 1
out vec4 result;

// A square wave of period 2 and height 1, averaged over `width`.
float stripe(float x, float width) {
  vec2 ends = vec2(x - 0.5 * width, x + 0.5 * width);
  vec2 area = floor(0.5 * ends) + max(vec2(0.0), 2.0 * fract(0.5 * ends) - 1.0);
  return (area.y - area.x) / width;
}

// Checks of two yarns: light, dark, and between where they cross.
vec3 checks() {
  if (check_size == 0.0) return color;
  vec2 place = warp_weft / check_size;
  vec2 width = max(fwidth(place), vec2(1e-4));
  float dark = stripe(place.x, width.x) + stripe(place.y, width.y);
  return mix(mix(color, vec3(1.0), 0.13), 0.55 * color, 0.5 * dark);
}

float random(vec2 cell) {
  vec3 p = fract(vec3(cell.xyx) * vec3(0.1031, 0.1030, 0.0973));  // Hoskins, hash without sine
  p += dot(p, p.yzx + 33.33);
  return fract((p.x + p.y) * p.z);
}

float noise(vec2 p) {
  vec2 cell = floor(p), f = p - cell;
  f = f * f * (3.0 - 2.0 * f);
  return mix(mix(random(cell), random(cell + vec2(1.0, 0.0)), f.x),
             mix(random(cell + vec2(0.0, 1.0)), random(cell + vec2(1.0, 1.0)), f.x), f.y);
}

// Whether the warp thread is on top where two threads cross.
bool is_warp_up(vec2 cell) {
  float k = weave < 1.5   ? 2.0 * fract(0.5 * (cell.x + cell.y))
            : weave < 2.5 ? 3.0 * fract((cell.x + cell.y) / 3.0)
                          : 5.0 * fract((cell.x + 2.0 * cell.y) / 5.0);
  return k > 0.5;
}

// Height of the surface in thread distances, and whether warp is on top: x; y. Place in threads: warp threads
// run along x.
vec2 relief(vec2 p) {
  if (weave > 3.5) {  // legs of stitches, in columns
    float a = abs(2.0 * fract(p.x) - 1.0), t = fract(p.y + 0.55 * a) - 0.5;
    float across = 2.0 * a - 1.0;
    return vec2(0.5 * sqrt(max(1.0 - across * across, 0.0)) * (1.0 - 2.2 * t * t), 1.0);
  }
  vec2 cell = floor(p), f = p - cell - 0.5;
  bool up = is_warp_up(cell);
  float across = up ? f.y : f.x, along = up ? f.x : f.y;
  vec2 ahead = up ? vec2(along < 0.0 ? -1.0 : 1.0, 0.0) : vec2(0.0, along < 0.0 ? -1.0 : 1.0);
  float dive = is_warp_up(cell + ahead) == up ? 0.0 : 2.0 * along * along;
  return vec2(0.5 * sqrt(max(1.0 - 3.6 * across * across, 0.0)) - 0.6 * dive, up ? 1.0 : 0.0);
}

void main() {
  vec3 n = normalize(world_normal);
  if (!gl_FrontFacing) n = -n;
  vec3 base = checks(), shading = n;
  vec2 p = warp_weft / max(thread, 1e-6);
  vec3 dx = dFdx(world), dy = dFdy(world);
  vec2 px = dFdx(p), py = dFdy(p);
  float width = max(length(px), length(py));  // of a pixel [threads]
  float streaks = thread == 0.0 ? 0.0 : 1.0 - smoothstep(1.5, 6.0, width),
        threads = thread == 0.0 ? 0.0 : 1.0 - smoothstep(0.12, 0.32, width);
  // Loops of one turn: software drivers skip a loop, but execute both sides of a branch.
  for (int k = 0; k < (streaks > 0.0 ? 1 : 0); ++k) {  // threads of uneven thickness
    float uneven = noise(p.yx * vec2(0.35, 0.012)) + noise(p * vec2(0.35, 0.012)) - 1.0;
    base *= 1.0 + 0.14 * streaks * uneven;
  }
  for (int k = 0; k < (threads > 0.0 ? 1 : 0); ++k) {
    const float kStep = 0.06;
    vec2 here = relief(p);
    vec2 slope = vec2(relief(p + vec2(kStep, 0.0)).x, relief(p + vec2(0.0, kStep)).x) - here.x;
    slope = clamp(slope / kStep, -1.2, 1.2);
    // Directions of warp and weft in the world, from the derivatives of both.
    float area = px.x * py.y - px.y * py.x;
    vec3 warp = (dx * py.y - dy * px.y) * sign(area), weft = (dy * px.x - dx * py.x) * sign(area);
    warp = normalize(warp + 1e-12 * n.yzx), weft = normalize(weft + 1e-12 * n.zxy);
    shading = normalize(n - 0.7 * threads * (slope.x * warp + slope.y * weft));
    vec3 thread_color = here.y > 0.5 ? vec3(1.0) : weft_color / max(color, vec3(0.02));
    base *= mix(vec3(1.0), thread_color * (0.62 + 0.80 * max(here.x, 0.0)), threads);
  }
  if (weft_color != color && weave < 3.5) {  // from afar, a third of twill is weft
    base = mix(base, mix(base, base * weft_color / max(color, vec3(0.02)), weave < 1.5 ? 0.5 : 0.25),
               thread == 0.0 ? 0.0 : 1.0 - threads);
  }
  if (shows_values > 0.5) base = color_of(shown_value);
  result = vec4(pack_normal(n), pack_normal(shading), pack_color(base),
                pack_material(mesh, Material(translucency, sheen, gloss)));
}
)";

// ---- Whole targets ----

// A number that tells surfaces of other meshes, and at other distances, apart by its fraction: a step of 1/256
// is 0.05 % of the distance.
const char* const kPhase = R"(
float phase_of(float mesh, float distance) { return 5.4 * log2(distance) + 0.382 * mesh; }
)";

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

// Visibility of the sun: percentage-closer soft shadows (Fernando 2005). Bias: along the normal, more where
// light grazes, and along the tangent plane. Four neighbouring pixels sample different points; `light` averages
// them.
const char* const kSunFragment = R"(
in vec2 place;
uniform sampler2D surfaces, depth;
uniform mat4 from_clip;
uniform vec3 to_sun;
uniform mat4 to_shadow;       // world to the shadow map's texture
uniform float shadow_texel;   // side of a texel of the shadow map in the world [m], 0: no shadows
uniform float shadow_size;    // texels on a side
uniform sampler2DShadow shadow_compare;
uniform sampler2D shadow_depth;
uniform float shadow_depth_range;  // [m]
uniform float pixel_angle;         // width of a pixel, as a share of its distance
out vec2 result;  // visibility, distance [m]

const mat2 kGolden = mat2(-0.737369, 0.675490, -0.675490, -0.737369);  // by the golden angle (Vogel 1979)
const float kSunSize = 0.07;  // the light's width as seen from its target: soft shadows
const float kMaxBlur = 0.035, kReach = 0.055;  // of shadows and of the search for what casts them [m]


void main() {
  const int kLooks = 8, kTaps = 12;
  ivec2 at = ivec2(gl_FragCoord.xy);
  float z = texelFetch(depth, at, 0).r;
  vec4 h = from_clip * vec4(2.0 * place - 1.0, 2.0 * z - 1.0, 1.0);
  vec3 world = h.xyz / h.w, n = unpack_normal(texelFetch(surfaces, at, 0).r);
  float facing = dot(n, to_sun);
  if (facing < 0.0) n = -n;
  facing = abs(facing);
  float grazing = sqrt(max(1.0 - facing * facing, 0.0));
  vec4 spot = to_shadow * vec4(world + shadow_texel * (1.0 + 2.5 * grazing) * n, 1.0);
  bool outside = any(lessThan(spot.xy, vec2(0.0))) || any(greaterThan(spot.xy, vec2(1.0)));
  vec3 across = mat3(to_shadow) * n;
  vec2 slope = clamp(-across.xy / min(across.z, -1e-6), -4.0, 4.0);
  spot.z -= shadow_texel * (0.5 + 1.5 * grazing) / shadow_depth_range;
  // Sixteen rotations, four well apart in every 2×2 pixels.
  ivec2 cell = at & 3;
  float turn = 6.2832 / 16.0 * float(4 * ((cell.x & 1) + 2 * (cell.y & 1)) + (cell.x >> 1) + 2 * (cell.y >> 1));
  vec2 start = vec2(cos(turn), sin(turn)), beside = start;
  // Blocker distance: the farther, the softer the shadow. Loops end early where the answer is certain.
  float map_side = shadow_texel * shadow_size, blockers = 0.0, gap = 0.0;
  int looks = outside || z == 1.0 || shadow_texel == 0.0 ? 0 : kLooks;
  for (int i = 0; i < looks; ++i) {
    beside = kGolden * beside;
    vec2 place_there = kReach / map_side * float(i) / float(kLooks - 1) * beside;  // one here: thin shadows
    float d = texelFetch(shadow_depth, ivec2((spot.xy + place_there) * shadow_size), 0).r;
    float behind = min(spot.z + dot(slope, place_there), 1.0) - d;  // the map ends at 1, the ground lies farther
    if (behind > 0.0) {
      blockers += 1.0;
      gap += spot.z - d;
    }
  }
  float sharpest = max(1.5 * shadow_texel, 0.8 * pixel_angle / h.w);
  float softness = kSunSize * gap / max(blockers, 1.0) * shadow_depth_range;
  float radius = clamp(softness, sharpest, max(kMaxBlur, sharpest)) / map_side;
  float light = 0.0;
  bool is_clear = blockers == 0.0, is_dark = blockers == float(kLooks);
  int taps = is_clear || is_dark ? 0 : kTaps;
  for (int i = 0; i < taps; ++i) {
    beside = kGolden * beside;
    vec2 place_there = radius * sqrt((float(i) + 0.5) / float(kTaps)) * beside;
    light += texture(shadow_compare, vec3(spot.xy + place_there, min(spot.z + dot(slope, place_there), 1.0)));
  }
  result = vec2(is_clear ? 1.0 : is_dark ? 0.0 : light / float(kTaps), 1.0 / h.w);
}
)";

// Ambient obscurance (after McGuire et al. 2012), at half the resolution: the hemisphere over each point's
// smooth normal. Points farther away than the radius do not count, so that nothing darkens what lies far behind
// it.
const char* const kOcclusionFragment = R"(
in vec2 place;
uniform sampler2D surfaces, depth;
uniform mat4 projection, view;
uniform vec2 pixel;    // of `depth`
uniform float radius;  // [m]
out vec2 result;       // open share, distance [m]

const mat2 kGolden = mat2(-0.737369, 0.675490, -0.675490, -0.737369);  // by the golden angle

float texel(vec2 at) { return texelFetch(depth, ivec2(clamp(at, vec2(0.0), vec2(0.9999)) / pixel), 0).r; }

vec3 in_view(vec2 at) {
  float z = projection[3][2] / (2.0 * texel(at) - 1.0 + projection[2][2]);
  return vec3((2.0 * at - 1.0) * z / vec2(projection[0][0], projection[1][1]), -z);
}

void main() {
  const int kSamples = 12;
  vec2 center = (2.0 * floor(gl_FragCoord.xy) + 0.5) * pixel;
  vec3 p = in_view(center);
  vec3 n = mat3(view) * unpack_normal(texelFetch(surfaces, 2 * ivec2(gl_FragCoord.xy), 0).r);
  int count = texel(center) == 1.0 ? 0 : kSamples;
  vec2 reach = 0.5 * radius * vec2(projection[0][0], projection[1][1]) / -p.z;
  reach *= min(1.0, 0.2 / max(reach.x, reach.y));
  ivec2 cell = ivec2(gl_FragCoord.xy) & 3;
  float turn = 6.2832 / 16.0 * float(4 * ((cell.x + 2 * cell.y) & 3) + ((2 * cell.x + cell.y) & 3));
  vec2 towards = vec2(cos(turn), sin(turn));
  float sum = 0.0;
  for (int i = 0; i < count; ++i) {
    towards = kGolden * towards;
    vec3 v = in_view(center + (float(i) + 0.5) / float(kSamples) * reach * towards) - p;
    float away_sq = dot(v, v), near = max(1.0 - away_sq / (radius * radius), 0.0);
    sum += near * max(dot(v, n) * inversesqrt(away_sq + 1e-12) - 0.12, 0.0);
  }
  result = vec2(max(0.0, 1.0 - 3.4 * sum / float(kSamples)), -p.z);
}
)";

// Mean over the occlusion's pattern of rotations, of points at like distances.
const char* const kBlurFragment = R"(
in vec2 place;
uniform sampler2D occlusion;
uniform float radius;  // of the occlusion [m]
out vec2 result;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(occlusion, 0) - 1;
  vec2 here = texelFetch(occlusion, at, 0).rg;
  float sum = 0.0, weights = 0.0;
  for (int y = -2; y < 2; ++y) {
    for (int x = -2; x < 2; ++x) {
      vec2 there = texelFetch(occlusion, clamp(at + ivec2(x, y), ivec2(0), last), 0).rg;
      float away = 6.0 * (there.y - here.y) / radius;
      float weight = 1.0 / (1.0 + away * away * away * away);
      sum += weight * there.x;
      weights += weight;
    }
  }
  result = vec2(sum / weights, here.y);
}
)";

// Lights every pixel once. Sunlight passes through the shadow, light of the sky and of the ground through the
// occlusion. Cloth is lit from both sides, is translucent, and has a soft sheen at grazing angles.
const char* const kLightFragment = R"(
in vec2 place;
uniform sampler2D surfaces, depth, sunlight, occlusion;
uniform mat4 from_clip;
uniform vec3 eye;
uniform vec3 to_sun, sun, sky, ground;
uniform float exposure;
uniform vec3 horizon;
uniform vec2 fade;            // distances where the ground's fade into the horizon begins and ends [m]
uniform float occlusion_radius;  // [m]
out vec4 result;              // sRGB, and the phase of the surface

// Light from a direction: ground, a bright band at the horizon, sky.
vec3 surroundings(float up) {
  vec3 band = 0.5 * (sky + ground) + 0.12;
  return up < 0.0 ? mix(band, ground, smoothstep(0.0, -0.5, up)) : mix(band, sky, smoothstep(0.0, 0.6, up));
}

// Irradiance on a surface, by its normal's height: the mean of both halves.
vec3 irradiance(float up) { return mix(ground, sky, 0.5 + 0.5 * up); }

// Mean of the 2×2 sampling patterns, of points at like distances.
float sun_at(ivec2 at, float distance_here) {
  ivec2 corner = min(at, textureSize(sunlight, 0) - 2);
  float sum = 0.0, weights = 0.0;
  for (int k = 0; k < 4; ++k) {
    vec2 there = texelFetch(sunlight, corner + ivec2(k & 1, k >> 1), 0).rg;
    float away = 60.0 * (there.y / distance_here - 1.0);
    float weight = 1.0 / (1.0 + away * away * away * away);
    sum += weight * there.x;
    weights += weight;
  }
  return sum / weights;
}

// Bilinear, among points at like distances: the occlusion has half the resolution.
float open_at(float distance_here) {
  vec2 texel = gl_FragCoord.xy / 2.0 - 0.25;
  ivec2 corner = ivec2(floor(texel)), last = textureSize(occlusion, 0) - 1;
  vec2 f = texel - vec2(corner);
  float sum = 0.0, weights = 0.0;
  for (int k = 0; k < 4; ++k) {
    ivec2 side = ivec2(k & 1, k >> 1);
    vec2 there = texelFetch(occlusion, clamp(corner + side, ivec2(0), last), 0).rg;
    vec2 share = mix(1.0 - f, f, vec2(side));
    float away = 6.0 * (there.y - distance_here) / occlusion_radius;
    float weight = (share.x * share.y + 0.01) / (1.0 + away * away * away * away);
    sum += weight * there.x;
    weights += weight;
  }
  return sum / weights;
}

// Filmic curve (Narkowicz 2016, a fit of ACES), then sRGB.
vec3 film(vec3 light) {
  vec3 c = clamp(light * (2.51 * light + 0.03) / (light * (2.43 * light + 0.59) + 0.14), 0.0, 1.0);
  // c^(1/2.4) from square roots, within 1e-3: pow() is expensive in software.
  vec3 r2 = sqrt(c), r4 = sqrt(r2), r8 = sqrt(r4);
  vec3 root = 0.585122381 * r2 + 0.783140355 * r4 - 0.368262736 * r8;
  return mix(12.92 * c, 1.0549 * root - 0.0549, step(0.0031308, c));
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 texel = texelFetch(surfaces, at, 0);
  float mesh = mesh_of(texel.a);
  result = vec4(0.0);
  for (int k = 0; k < (mesh > 0.0 ? 1 : 0); ++k) {
    vec4 h = from_clip * vec4(2.0 * place - 1.0, 2.0 * texelFetch(depth, at, 0).r - 1.0, 1.0);
    vec3 world = h.xyz / h.w, to_eye = normalize(eye - world);
    vec3 smooth_normal = unpack_normal(texel.r), n = unpack_normal(texel.g), base = unpack_color(texel.b);
    Material m = unpack_material(texel.a);
    float lit = sun_at(at, 1.0 / h.w), open = open_at(1.0 / h.w);
    float facing = dot(n, to_sun), grazing = abs(dot(smooth_normal, to_sun));
    // Where light grazes, the shadow map decides by chance, and little light arrives.
    lit *= smoothstep(0.0, 0.22, grazing);
    // Light between folds is reflected again by bright cloth (Jimenez et al. 2016).
    vec3 a = 2.0404 * base - 0.3324, b = -4.7951 * base + 0.6417, c = 2.7552 * base + 0.6903;
    vec3 visible = max(vec3(open), ((open * a + b) * open + c) * open);
    vec3 light = irradiance(n.y) * visible;
    light += sun * lit * max(facing, 0.0);
    light += m.translucency * sqrt(base) * (sun * lit * max(-facing, 0.0) + 0.5 * irradiance(-n.y) * open);
    vec3 shine = vec3(0.0);
    for (int j = 0; j < (mesh < kGroundMesh ? 1 : 0); ++j) {
      float rim = 1.0 - max(abs(dot(n, to_eye)), 0.0);
      rim *= rim;
      light += m.sheen * rim * (irradiance(n.y) * open + 0.35 * sun * lit * max(facing + 0.3, 0.0));
      vec3 half_way = normalize(to_sun + to_eye);
      float s = max(dot(n, half_way), 0.0), s4 = s * s * s * s, s16 = s4 * s4 * s4 * s4;
      shine = m.gloss * mix(s16, s16 * s16 * s16, m.gloss) * sun * lit;
      shine += 0.3 * m.gloss * (0.15 + 0.85 * rim * rim) * surroundings(reflect(-to_eye, n).y) * open;
    }
    vec3 seen = exposure * (base * light + shine);
    vec3 color = film(mix(vec3(dot(seen, vec3(0.2126, 0.7152, 0.0722))), seen, 0.93));
    if (mesh == kGroundMesh) color = mix(color, horizon, smoothstep(fade.x, fade.y, length(world.xz - eye.xz)));
    result = vec4(color, (1.0 + 254.0 * fract(phase_of(mesh, 1.0 / h.w))) / 255.0);
  }
}
)";

// Takes the lit colour of each fragment: where the pixel's centre shows another surface, from the neighbour that
// shows this one. Several samples a pixel then smooth the outlines.
const char* const kSurfaceFragment = R"(
uniform sampler2D lit;
uniform float mesh;  // index, 1 to 255
out vec4 result;

// Difference of phases, 0 to 0.5; 1 where nothing is.
float miss(float alpha, float phase) {
  float away = (255.0 * alpha - 1.0) / 254.0 - phase;
  return alpha == 0.0 ? 1.0 : abs(fract(away + 0.5) - 0.5);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(lit, 0) - 1;
  float phase = phase_of(mesh, 1.0 / gl_FragCoord.w);
  vec4 best = texelFetch(lit, at, 0);
  float least = miss(best.a, phase);
  int looks = least > min(2.0 * fwidth(phase), 0.4) + 0.012 ? 4 : 0;
  for (int k = 0; k < looks; ++k) {
    int side = 2 * (k & 1) - 1;
    vec4 there = texelFetch(lit, clamp(at + (k < 2 ? ivec2(side, 0) : ivec2(0, side)), ivec2(0), last), 0);
    float other = miss(there.a, phase);
    best = other < least ? there : best;
    least = min(least, other);
  }
  result = vec4(best.rgb, 1.0);
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

std::string color_map_function() {
  std::string text =
      "vec3 color_of(float share) {\n  float t = clamp(share, 0.0, 1.0);\n  vec3 c = vec3(0.0);\n";
  for (auto row = kColorMap.rbegin(); row != kColorMap.rend(); ++row)
    text += "  c = c * t + vec3(" + std::to_string((*row)[0]) + ", " + std::to_string((*row)[1]) + ", " +
            std::to_string((*row)[2]) + ");\n";
  return text + "  return pow(clamp(c, 0.0, 1.0), vec3(2.2));\n}\n";
}

}  // namespace

ShaderSource shader_source(Program program) {
  const auto source = [](const char* vertex, const std::string& fragment) {
    return ShaderSource{std::string(kHead) + vertex, kHead + fragment};
  };
  const std::string packing = kPacking;
  switch (program) {
    case Program::depth:
      return source(kDepthVertex, kDepthFragment);
    case Program::fabric:
      return source(kMeshVertex, packing + color_map_function() + kFabricFragment);
    case Program::solid:
      return source(kMeshVertex, packing + kSolidFragment);
    case Program::sun:
      return source(kScreenVertex, packing + kSunFragment);
    case Program::occlusion:
      return source(kScreenVertex, packing + kOcclusionFragment);
    case Program::blur:
      return source(kScreenVertex, kBlurFragment);
    case Program::light:
      return source(kScreenVertex, packing + kPhase + kLightFragment);
    case Program::surface:
      return source(kDepthVertex, std::string(kPhase) + kSurfaceFragment);
    case Program::sky:
      return source(kScreenVertex, kSkyFragment);
    case Program::line:
      return source(kLineVertex, kLineFragment);
    case Program::dot:
      break;
  }
  return source(kDotVertex, kDotFragment);
}

}  // namespace weft::engine
