#include "weft/render/renderer.h"

#include <algorithm>
#include <cmath>

#include "weft/mesh/vertex_normals.h"

namespace weft::engine {
namespace {

using Vector2f = Eigen::Vector2f;
using Vector3f = Eigen::Vector3f;
using Matrix4f = Eigen::Matrix4f;

constexpr double kGroundSide = 60;        // side of the ground square [m]
constexpr double kOcclusionShare = 0.09;  // radius, as a share of the scene's radius [1]
const Vector3f kHorizon(0.93f, 0.94f, 0.945f), kZenith(0.66f, 0.76f, 0.87f);  // sRGB
constexpr double kSolidGloss = 0.12;                                          // of bodies [1]
const Color kGroundColor = {0.66, 0.65, 0.63};

Vector3f to_vector(const Color& c) { return Eigen::Vector3d(c[0], c[1], c[2]).cast<float>(); }

float to_srgb(double c) {
  return static_cast<float>(c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055);
}

Vector3f to_srgb(const Color& c) { return {to_srgb(c[0]), to_srgb(c[1]), to_srgb(c[2])}; }

std::vector<float> to_places(const std::vector<Vec3>& points) {
  std::vector<float> places;
  places.reserve(3 * points.size());
  for (const Vec3& p : points) {
    for (const double c : p) places.push_back(static_cast<float>(c));
  }
  return places;
}

/// Bounding sphere of the scene without the ground.
struct Extent {
  Vec3 center = Vec3::Zero();
  double radius = 1;
};

Extent find_extent(const Picture& picture) {
  Eigen::AlignedBox3d box;
  for (const DrawnMesh& mesh : picture.meshes) {
    for (std::size_t i = 0; i + 2 < mesh.positions.size(); i += 3)
      box.extend(Eigen::Map<const Vector3f>(&mesh.positions[i]).cast<double>());
  }
  for (const DrawnLines& lines : picture.lines) {
    for (const Vec3& p : lines.ends) box.extend(p);
  }
  if (box.isEmpty()) return {};
  return {box.center(), std::max(0.5 * box.diagonal().norm(), 1e-3)};
}

/// The sun's view of the scene: world to clip space.
struct SunView {
  Mat4 to_clip;
  double width;  // of the view, equal to its depth [m]
};

SunView make_sun_view(const Light& light, const Extent& extent) {
  const Vec3 z = light.to_sun.normalized();
  const Vec3 x = (std::abs(z.y()) < 0.99 ? Vec3(Vec3::UnitY()) : Vec3(Vec3::UnitX())).cross(z).normalized();
  Mat3 axes;
  axes << x.transpose(), z.cross(x).transpose(), -z.transpose();
  Mat4 to_clip = Mat4::Identity();
  to_clip.topLeftCorner<3, 3>() = axes / extent.radius;
  to_clip.topRightCorner<3, 1>() = -axes * extent.center / extent.radius;
  return {to_clip, 2 * extent.radius};
}

std::vector<float> interleave(const DrawnMesh& mesh) {
  const std::vector<float> normals = compute_vertex_normals(mesh.triangles, mesh.positions);
  const std::size_t count = mesh.positions.size() / 3;
  const double first = mesh.range[0], span = std::max(mesh.range[1] - mesh.range[0], 1e-30);
  std::vector<float> vertices(count * kFloatsPerVertex, 0.0f);
  for (std::size_t v = 0; v < count; ++v) {
    float* vertex = vertices.data() + v * kFloatsPerVertex;
    std::copy_n(&mesh.positions[3 * v], 3, vertex);
    std::copy_n(&normals[3 * v], 3, vertex + 3);
    if (!mesh.fabric_coordinates.empty()) std::copy_n(&mesh.fabric_coordinates[2 * v], 2, vertex + 6);
    if (!mesh.values.empty())
      vertex[8] = static_cast<float>(std::clamp((mesh.values[v] - first) / span, 0.0, 1.0));
  }
  return vertices;
}

DrawnMesh make_ground(const Vec3& center, double height) {
  const TriangleMesh square = make_square_mesh({center.x(), height, center.z()}, Vec3::UnitY(), kGroundSide);
  return {.triangles = square.triangles,
          .positions = to_places(square.positions),
          .look = {.color = kGroundColor}};
}

}  // namespace

/// One picture in the render stages.
struct Renderer::Stage {
  Device& device;
  const RenderSettings& settings;
  const Picture& picture;
  PictureSize size;
  Extent extent;
  Matrix4f projection, to_clip, from_clip;
  double near, far;
  std::vector<GeometryId> meshes;
  std::optional<GeometryId> ground;
  SunView sun;
  TargetId shadow, surfaces, sunlight, occlusion, lit;

  Stage(Device& device_, const RenderSettings& settings_, const Picture& picture_, PictureSize size_)
      : device(device_), settings(settings_), picture(picture_), size(size_), extent(find_extent(picture_)) {
    const Camera& camera = picture.camera;
    const double depth_of_center = (extent.center - camera.eye()).dot(camera.forward());
    near = std::max(depth_of_center - 1.5 * extent.radius, 0.02 * extent.radius);
    far = std::max(depth_of_center + 1.5 * extent.radius, 2 * near) + kGroundSide;
    const Mat4 lens = Camera::projection(camera.fov_deg, size.aspect(), near, far);
    projection = lens.cast<float>();
    to_clip = (lens * camera.view()).cast<float>();
    from_clip = (lens * camera.view()).inverse().cast<float>();
    sun = make_sun_view(picture.light, extent);
  }

  Vector2f pixel() const {
    return {1.0f / static_cast<float>(size.width), 1.0f / static_cast<float>(size.height)};
  }

  float occlusion_radius() const { return static_cast<float>(kOcclusionShare * extent.radius); }

  /// What the surfaces' texels call a mesh.
  static float number(std::size_t mesh) { return static_cast<float>(1 + mesh % 254); }
  static constexpr float kGroundNumber = 255;

  void upload() {
    device.forget_geometry();
    for (const DrawnMesh& mesh : picture.meshes)
      meshes.push_back(device.upload(interleave(mesh), mesh.triangles));
    if (picture.ground && !picture.transparent) {
      const DrawnMesh square = make_ground(extent.center, *picture.ground);
      ground = device.upload(interleave(square), square.triangles);
    }
  }

  void draw_shadow() {
    const int side = std::max(settings.shadow_size, 1);
    shadow = device.target("shadow", {TargetDesc::Format::depth, side, side});
    device.begin_pass(shadow);
    if (settings.shadow_size == 0) return;
    for (const GeometryId mesh : meshes)
      device.draw({Program::depth, {{"to_clip", Matrix4f(sun.to_clip.cast<float>())}}, mesh});
  }

  void draw_solid(GeometryId geometry, float number, const Color& color, double gloss) {
    device.draw({Program::solid,
                 {{"to_clip", to_clip},
                  {"color", to_vector(color)},
                  {"mesh", number},
                  {"gloss", static_cast<float>(gloss)}},
                 geometry});
  }

  void draw_fabric(GeometryId geometry, float number, const DrawnMesh& mesh) {
    const Look& look = mesh.look;
    const weft::FabricLook& fabric = look.fabric;
    const bool shows_values = !mesh.values.empty();  // their colours change little from light to shadow
    const bool is_woven = fabric.weave != weft::Weave::none && !mesh.fabric_coordinates.empty();
    const Vector3f weft_color = static_cast<float>(fabric.weft_shade) * to_vector(look.color);
    device.draw({Program::fabric,
                 {{"to_clip", to_clip},
                  {"color", to_vector(look.color)},
                  {"weft_color", weft_color},
                  {"mesh", number},
                  {"shows_values", shows_values ? 1.0f : 0.0f},
                  {"check_size", static_cast<float>(look.check_size)},
                  {"weave", static_cast<float>(fabric.weave)},
                  {"thread", is_woven ? static_cast<float>(fabric.thread) : 0.0f},
                  {"translucency", shows_values ? 0.8f : static_cast<float>(fabric.translucency)},
                  {"sheen", shows_values ? 0.0f : static_cast<float>(fabric.sheen)},
                  {"gloss", shows_values ? 0.0f : static_cast<float>(fabric.gloss)}},
                 geometry});
  }

  void draw_surfaces() {
    surfaces = device.target("surfaces", {TargetDesc::Format::surface, size.width, size.height});
    device.begin_pass(surfaces);
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      const DrawnMesh& mesh = picture.meshes[m];
      if (mesh.look.kind == Look::Kind::fabric)
        draw_fabric(meshes[m], number(m), mesh);
      else
        draw_solid(meshes[m], number(m), mesh.look.color, kSolidGloss);
    }
    if (ground) draw_solid(*ground, kGroundNumber, kGroundColor, 0);
  }

  /// Disabled: one pixel of full sunlight.
  void draw_sunlight() {
    Mat4 to_texture = Mat4::Identity();
    to_texture.diagonal().head<3>().setConstant(0.5);
    to_texture.topRightCorner<3, 1>().setConstant(0.5);
    const float texel =
        settings.shadow_size > 0 ? static_cast<float>(sun.width / settings.shadow_size) : 0.0f;
    sunlight = device.target("sunlight", {TargetDesc::Format::pair, size.width, size.height});
    device.begin_pass(sunlight);
    device.draw({Program::sun,
                 {{"surfaces", Texture{surfaces}},
                  {"depth", Texture{surfaces, Texture::Part::depths}},
                  {"from_clip", from_clip},
                  {"to_sun", Vector3f(picture.light.to_sun.cast<float>())},
                  {"to_shadow", Matrix4f((to_texture * sun.to_clip).cast<float>())},
                  {"shadow_texel", texel},
                  {"shadow_size", static_cast<float>(std::max(settings.shadow_size, 1))},
                  {"shadow_compare", Texture{shadow, Texture::Part::comparisons}},
                  {"shadow_depth", Texture{shadow, Texture::Part::depths}},
                  {"shadow_depth_range", static_cast<float>(sun.width)},
                  {"pixel_angle", 2 / (projection(1, 1) * static_cast<float>(size.height))}},
                 WholeTarget{}});
  }

  /// At half the picture's resolution, because occlusion is smooth. Disabled: one pixel of open sky.
  void draw_occlusion() {
    const int width = settings.occlusion ? (size.width + 1) / 2 : 1,
              height = settings.occlusion ? (size.height + 1) / 2 : 1;
    const TargetId rough = device.target("rough occlusion", {TargetDesc::Format::pair, width, height});
    occlusion = device.target("occlusion", {TargetDesc::Format::pair, width, height});
    device.begin_pass(rough);
    const float radius = settings.occlusion ? occlusion_radius() : 0.0f;
    device.draw({Program::occlusion,
                 {{"surfaces", Texture{surfaces}},
                  {"depth", Texture{surfaces, Texture::Part::depths}},
                  {"projection", projection},
                  {"view", Matrix4f(picture.camera.view().cast<float>())},
                  {"pixel", pixel()},
                  {"radius", radius}},
                 WholeTarget{}});
    device.begin_pass(occlusion);
    device.draw(
        {Program::blur, {{"occlusion", Texture{rough}}, {"radius", occlusion_radius()}}, WholeTarget{}});
  }

  void light_surfaces() {
    const Light& light = picture.light;
    const float reach = static_cast<float>(picture.camera.distance + extent.radius);
    lit = device.target("lit", {TargetDesc::Format::color, size.width, size.height});
    device.begin_pass(lit);
    device.draw({Program::light,
                 {{"surfaces", Texture{surfaces}},
                  {"depth", Texture{surfaces, Texture::Part::depths}},
                  {"sunlight", Texture{sunlight}},
                  {"occlusion", Texture{occlusion}},
                  {"from_clip", from_clip},
                  {"eye", Vector3f(picture.camera.eye().cast<float>())},
                  {"to_sun", Vector3f(light.to_sun.cast<float>())},
                  {"sun", to_vector(light.sun)},
                  {"sky", to_vector(light.sky)},
                  {"ground", to_vector(light.ground)},
                  {"exposure", static_cast<float>(light.exposure)},
                  {"horizon", kHorizon},
                  {"fade", Vector2f(1.2f * reach, 4.5f * reach)},
                  {"occlusion_radius", occlusion_radius()}},
                 WholeTarget{}});
  }

  void draw_sky() {
    if (picture.transparent) return;
    Mat4 turn = picture.camera.view();
    turn.topRightCorner<3, 1>().setZero();
    const Mat4 inverse =
        (Camera::projection(picture.camera.fov_deg, size.aspect(), near, far) * turn).inverse();
    device.draw({Program::sky,
                 {{"from_clip", Matrix4f(inverse.cast<float>())}, {"horizon", kHorizon}, {"zenith", kZenith}},
                 WholeTarget{}});
  }

  void draw_lit() {
    const auto draw = [&](GeometryId geometry, float number) {
      device.draw(
          {Program::surface, {{"to_clip", to_clip}, {"lit", Texture{lit}}, {"mesh", number}}, geometry});
    };
    for (std::size_t m = 0; m < meshes.size(); ++m) draw(meshes[m], number(m));
    if (ground) draw(*ground, kGroundNumber);
  }

  void draw_lines_and_dots() {
    const Vector2f pixels(static_cast<float>(size.width), static_cast<float>(size.height));
    for (const DrawnLines& lines : picture.lines) {
      const std::vector<float> places = to_places(lines.ends);
      device.draw({Program::line,
                   {{"to_clip", to_clip},
                    {"size", pixels},
                    {"width", static_cast<float>(lines.width)},
                    {"color", to_srgb(lines.color)}},
                   Instances{places}});
    }
    for (const DrawnDots& dots : picture.dots) {
      const std::vector<float> places = to_places(dots.positions);
      device.draw({Program::dot,
                   {{"to_clip", to_clip},
                    {"size", pixels},
                    {"diameter", static_cast<float>(dots.diameter)},
                    {"color", to_srgb(dots.color)}},
                   Instances{places}});
    }
  }
};

Renderer::Renderer(std::unique_ptr<Device> device, const RenderSettings& settings)
    : device_(std::move(device)), settings_(settings) {}

Renderer::~Renderer() = default;

TargetId Renderer::compose(const Picture& picture, PictureSize size) {
  Stage stage(*device_, settings_, picture, size);
  stage.upload();
  stage.draw_shadow();
  stage.draw_surfaces();
  stage.draw_sunlight();
  stage.draw_occlusion();
  stage.light_surfaces();
  const TargetId rough =
      device_->target("colour", {TargetDesc::Format::color, size.width, size.height, settings_.samples});
  device_->begin_pass(rough);
  stage.draw_lit();
  stage.draw_lines_and_dots();
  stage.draw_sky();
  const TargetId smooth = device_->target("picture", {TargetDesc::Format::color, size.width, size.height});
  device_->resolve(rough, smooth);
  return smooth;
}

Image Renderer::draw(const Picture& picture, PictureSize size) {
  return device_->read(compose(picture, size));
}

void Renderer::show(const Picture& picture, PictureSize size, const WindowPart& part) {
  device_->show(compose(picture, size), part);
}

}  // namespace weft::engine
