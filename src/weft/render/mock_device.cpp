#include "weft/render/mock_device.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>

#include "weft/render/shaders.h"

namespace weft::engine {
namespace {

void require(bool condition, const std::string& message) {
  if (!condition) throw std::logic_error(message);
}

const char* to_string(Program program) {
  switch (program) {
    case Program::depth:
      return "depth";
    case Program::fabric:
      return "fabric";
    case Program::solid:
      return "solid";
    case Program::sun:
      return "sun";
    case Program::occlusion:
      return "occlusion";
    case Program::blur:
      return "blur";
    case Program::light:
      return "light";
    case Program::surface:
      return "surface";
    case Program::sky:
      return "sky";
    case Program::line:
      return "line";
    case Program::dot:
      break;
  }
  return "dot";
}

/// GLSL's name of each alternative of UniformValue; textures have two.
std::string type_name(const UniformValue& value) {
  if (const Texture* texture = std::get_if<Texture>(&value))
    return texture->part == Texture::Part::comparisons ? "sampler2DShadow" : "sampler2D";
  static const char* const kNames[] = {"int", "float", "vec2", "vec3", "mat4"};
  return kNames[value.index()];
}

/// Names and types of the uniforms in a program's sources.
std::map<std::string, std::string> declared_uniforms(Program program) {
  static const std::regex kDeclaration(R"(uniform\s+(\w+)\s+([^;]+);)"), kName(R"(\w+)");
  const ShaderSource source = shader_source(program);
  std::map<std::string, std::string> uniforms;
  for (const std::string& text : {source.vertex, source.fragment}) {
    for (std::sregex_iterator d(text.begin(), text.end(), kDeclaration), end; d != end; ++d) {
      const std::string names = (*d)[2];
      for (std::sregex_iterator n(names.begin(), names.end(), kName); n != end; ++n)
        uniforms[n->str()] = (*d)[1];
    }
  }
  return uniforms;
}

bool is_finite(const UniformValue& value) {
  const auto check = [](const auto& v) {
    using T = std::decay_t<decltype(v)>;
    if constexpr (std::is_same_v<T, float>) return std::isfinite(v);
    if constexpr (std::is_base_of_v<Eigen::EigenBase<T>, T>) return v.allFinite();
    return true;
  };
  return std::visit(check, value);
}

}  // namespace

const MockDevice::Target& MockDevice::at(TargetId id) const {
  require(id.index >= 0 && id.index < static_cast<int>(targets_.size()), "there is no such target");
  return targets_[static_cast<std::size_t>(id.index)];
}

TargetId MockDevice::target(std::string_view name, const TargetDesc& desc) {
  require(desc.width > 0 && desc.height > 0 && desc.samples > 0, "a target requires pixels and samples");
  const auto known =
      std::find_if(targets_.begin(), targets_.end(), [&](const Target& t) { return t.name == name; });
  const int index = static_cast<int>(known - targets_.begin());
  if (known == targets_.end())
    targets_.push_back({std::string(name), desc});
  else
    known->desc = desc;
  return {index};
}

GeometryId MockDevice::upload(std::span<const float> vertices, std::span<const Triangle> triangles) {
  require(vertices.size() % kFloatsPerVertex == 0, "vertices must have nine floats each");
  require(std::all_of(vertices.begin(), vertices.end(), [](float x) { return std::isfinite(x); }),
          "a vertex is not finite");
  const int count = static_cast<int>(vertices.size()) / kFloatsPerVertex;
  for (const Triangle& triangle : triangles) {
    for (const int v : triangle) require(v >= 0 && v < count, "a triangle's vertex is out of range");
  }
  geometries_.push_back(static_cast<int>(triangles.size()));
  return {static_cast<int>(geometries_.size()) - 1};
}

void MockDevice::begin_pass(TargetId target) {
  log_.push_back("pass " + at(target).name);
  pass_ = target.index;
  num_drawn_ = 0;
}

void MockDevice::check_uniforms(const DrawCall& call) const {
  std::map<std::string, std::string> missing = declared_uniforms(call.program);
  for (const Uniform& uniform : call.uniforms) {
    const std::string name(uniform.name), where = std::string(to_string(call.program)) + "." + name;
    const auto declared = missing.find(name);
    require(declared != missing.end(), where + " is not a uniform, or is set twice");
    require(declared->second == type_name(uniform.value), where + " is a " + declared->second);
    require(is_finite(uniform.value), where + " is not finite");
    missing.erase(declared);
    const Texture* texture = std::get_if<Texture>(&uniform.value);
    if (!texture) continue;
    const TargetDesc& desc = at(texture->target).desc;
    require(desc.samples == 1, where + " has several samples");
    if (texture->part == Texture::Part::colors)
      require(desc.format != TargetDesc::Format::depth, where + " has no colours");
    else
      require(desc.format == TargetDesc::Format::depth || desc.format == TargetDesc::Format::surface,
              where + " has no depths that can be read");
    require(texture->target.index != pass_, where + " is the current render target");
  }
  if (missing.empty()) return;
  throw std::logic_error(std::string(to_string(call.program)) + "." + missing.begin()->first + " is not set");
}

void MockDevice::draw(const DrawCall& call) {
  require(pass_ >= 0, "there is no current render target");
  log_.push_back(std::string("draw ") + to_string(call.program));
  check_uniforms(call);
  if (const GeometryId* id = std::get_if<GeometryId>(&call.what)) {
    require(id->index >= 0 && id->index < static_cast<int>(geometries_.size()), "there is no such geometry");
    num_drawn_ += geometries_[static_cast<std::size_t>(id->index)];
  } else if (const Instances* instances = std::get_if<Instances>(&call.what)) {
    const std::size_t floats = call.program == Program::line ? 6 : 3;
    require(instances->places.size() % floats == 0, "an instance is incomplete");
    num_drawn_ += static_cast<int>(instances->places.size() / floats);
  }
}

void MockDevice::resolve(TargetId from, TargetId to) {
  const Target &a = at(from), &b = at(to);
  log_.push_back("resolve " + a.name + " " + b.name);
  require(a.desc.width == b.desc.width && a.desc.height == b.desc.height && a.desc.format == b.desc.format,
          "targets to resolve differ in size or format");
  require(b.desc.samples == 1, "the resolved target has several samples");
}

Image MockDevice::read(TargetId target) {
  const Target& t = at(target);
  log_.push_back("read " + t.name);
  require(t.desc.format == TargetDesc::Format::color && t.desc.samples == 1,
          "only colours of one sample can be read");
  return Image(t.desc.width, t.desc.height);
}

void MockDevice::show(TargetId target, const WindowPart& part) {
  require(part.size.width > 0 && part.size.height > 0, "a part of the window requires pixels");
  log_.push_back("show " + at(target).name);
}

}  // namespace weft::engine
