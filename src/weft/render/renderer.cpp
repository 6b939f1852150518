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
  std::vector<float> vertices(count * kFloatsPerVertex, 0.0f);
  for (std::size_t v = 0; v < count; ++v) {
    float* vertex = vertices.data() + v * kFloatsPerVertex;
    std::copy_n(&mesh.positions[3 * v], 3, vertex);
    std::copy_n(&normals[3 * v], 3, vertex + 3);
    if (!mesh.fabric_coordinates.empty()) std::copy_n(&mesh.fabric_coordinates[2 * v], 2, vertex + 6);
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
  Matrix4f projection, to_clip;
  double near, far;
  std::vector<GeometryId> meshes;
  std::optional<GeometryId> ground;
  SunView sun;
  TargetId shadow, depth, occlusion;

  Stage(Device& device_, const RenderSettings& settings_, const Picture& picture_, PictureSize size_)
      : device(device_), settings(settings_), picture(picture_), size(size_), extent(find_extent(picture_)) {
    const Camera& camera = picture.camera;
    const double depth_of_center = (extent.center - camera.eye()).dot(camera.forward());
    near = std::max(depth_of_center - 1.5 * extent.radius, 0.02 * extent.radius);
    far = std::max(depth_of_center + 1.5 * extent.radius, 2 * near) + kGroundSide;
    projection = Camera::projection(camera.fov_deg, size.aspect(), near, far).cast<float>();
    to_clip = (Camera::projection(camera.fov_deg, size.aspect(), near, far) * camera.view()).cast<float>();
    sun = make_sun_view(picture.light, extent);
  }

  void upload() {
    device.forget_geometry();
    for (const DrawnMesh& mesh : picture.meshes)
      meshes.push_back(device.upload(interleave(mesh), mesh.triangles));
    if (picture.ground && !picture.transparent) {
      const DrawnMesh square = make_ground(extent.center, *picture.ground);
      ground = device.upload(interleave(square), square.triangles);
    }
  }

  void draw_depths(const Matrix4f& view, bool with_ground) {
    for (const GeometryId mesh : meshes) device.draw({Program::depth, {{"to_clip", view}}, mesh});
    if (with_ground && ground) device.draw({Program::depth, {{"to_clip", view}}, *ground});
  }

  void draw_shadow() {
    const int side = std::max(settings.shadow_size, 1);
    shadow = device.target("shadow", {TargetDesc::Format::depth, side, side});
    device.begin_pass(shadow);
    if (settings.shadow_size > 0) draw_depths(sun.to_clip.cast<float>(), false);
  }

  /// At half the picture's resolution, because occlusion is smooth. Disabled: one pixel of open sky.
  void draw_occlusion() {
    const int width = settings.occlusion ? (size.width + 1) / 2 : 1,
              height = settings.occlusion ? (size.height + 1) / 2 : 1;
    const Vector2f pixel(1.0f / static_cast<float>(width), 1.0f / static_cast<float>(height));
    depth = device.target("depth", {TargetDesc::Format::depth, width, height});
    const TargetId rough = device.target("rough occlusion", {TargetDesc::Format::gray, width, height});
    occlusion = device.target("occlusion", {TargetDesc::Format::gray, width, height});
    device.begin_pass(depth);
    if (settings.occlusion) draw_depths(to_clip, true);
    device.begin_pass(rough);
    const float reach = static_cast<float>(kOcclusionShare * extent.radius);
    device.draw({Program::occlusion,
                 {{"depth", Texture{depth}}, {"projection", projection}, {"pixel", pixel}, {"radius", reach}},
                 WholeTarget{}});
    device.begin_pass(occlusion);
    device.draw({Program::blur,
                 {{"occlusion", Texture{rough}},
                  {"depth", Texture{depth}},
                  {"projection", projection},
                  {"pixel", pixel}},
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

  void draw_surface(GeometryId geometry, Program program, const Look& look) {
    Mat4 to_texture = Mat4::Identity();
    to_texture.diagonal().head<3>().setConstant(0.5);
    to_texture.topRightCorner<3, 1>().setConstant(0.5);
    const Light& light = picture.light;
    const float texel =
        settings.shadow_size > 0 ? static_cast<float>(sun.width / settings.shadow_size) : 0.0f;
    const float reach = static_cast<float>(picture.camera.distance + extent.radius);
    device.draw(
        {program,
         {{"to_clip", to_clip},
          {"eye", Vector3f(picture.camera.eye().cast<float>())},
          {"color", to_vector(look.color)},
          {"check_size", static_cast<float>(look.check_size)},
          {"to_sun", Vector3f(light.to_sun.cast<float>())},
          {"sun", to_vector(light.sun)},
          {"sky", to_vector(light.sky)},
          {"ground", to_vector(light.ground)},
          {"exposure", static_cast<float>(light.exposure)},
          {"to_shadow", Matrix4f((to_texture * sun.to_clip).cast<float>())},
          {"shadow_texel", texel},
          {"shadow_size", static_cast<float>(std::max(settings.shadow_size, 1))},
          {"shadow_compare", Texture{shadow, true}},
          {"shadow_depth", Texture{shadow}},
          {"shadow_depth_range", static_cast<float>(sun.width)},
          {"occlusion", Texture{occlusion}},
          {"pixel", Vector2f(1.0f / static_cast<float>(size.width), 1.0f / static_cast<float>(size.height))},
          {"horizon", kHorizon},
          {"fade", Vector2f(1.0f * reach, 4.0f * reach)}},
         geometry});
  }

  void draw_surfaces() {
    for (std::size_t m = 0; m < meshes.size(); ++m) {
      const Look& look = picture.meshes[m].look;
      draw_surface(meshes[m], look.kind == Look::Kind::fabric ? Program::fabric : Program::solid, look);
    }
    if (ground) draw_surface(*ground, Program::ground, {.color = kGroundColor});
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
  stage.draw_occlusion();
  const TargetId rough =
      device_->target("colour", {TargetDesc::Format::color, size.width, size.height, settings_.samples});
  device_->begin_pass(rough);
  stage.draw_surfaces();
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
