#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <map>

#include "weft/render/device.h"
#include "weft/render/shaders.h"

namespace weft::engine {
namespace {

constexpr int kNumPrograms = 11;

GLuint compile(GLenum kind, const std::string& source) {
  const GLuint shader = glCreateShader(kind);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok) return shader;
  std::array<char, 2048> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw GraphicsError(std::string("shader compilation failed: ") + log.data());
}

GLuint link(const ShaderSource& source) {
  const GLuint program = glCreateProgram();
  const GLuint shaders[] = {compile(GL_VERTEX_SHADER, source.vertex),
                            compile(GL_FRAGMENT_SHADER, source.fragment)};
  for (const GLuint shader : shaders) glAttachShader(program, shader);
  glLinkProgram(program);
  for (const GLuint shader : shaders) glDeleteShader(shader);
  GLint ok = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &ok);
  if (ok) return program;
  std::array<char, 2048> log{};
  glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw GraphicsError(std::string("shader program linking failed: ") + log.data());
}

struct PixelFormat {
  GLenum internal, format, type;
};

PixelFormat pixel_format(TargetDesc::Format format) {
  switch (format) {
    case TargetDesc::Format::depth:
      return {GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT};
    case TargetDesc::Format::pair:
      return {GL_RG16F, GL_RG, GL_FLOAT};
    case TargetDesc::Format::surface:
      return {GL_RGBA32F, GL_RGBA, GL_FLOAT};
    case TargetDesc::Format::color:
      break;
  }
  return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
}

class GlDevice : public Device {
 public:
  GlDevice() {
    if (epoxy_gl_version() < 33) {
      throw GraphicsError("OpenGL 3.3 or later is required, but this is " +
                          std::to_string(epoxy_gl_version() / 10) + "." +
                          std::to_string(epoxy_gl_version() % 10) +
                          "; install a newer graphics driver, or Mesa's software one (libgl1-mesa-dri)");
    }
    for (const bool compares : {false, true}) make_sampler(compares);
    glGenVertexArrays(1, &empty_);
    glGenVertexArrays(1, &instances_);
    glGenBuffers(1, &places_);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
  }

  ~GlDevice() override {
    forget_geometry();
    for (auto& [name, target] : targets_by_name_) drop(targets_[target]);
    for (const GLuint program : programs_) glDeleteProgram(program);
    glDeleteSamplers(2, samplers_.data());
    glDeleteBuffers(1, &places_);
    glDeleteVertexArrays(1, &instances_);
    glDeleteVertexArrays(1, &empty_);
  }

  TargetId target(std::string_view name, const TargetDesc& desc) override {
    const auto known = targets_by_name_.find(std::string(name));
    if (known == targets_by_name_.end()) {
      targets_by_name_.emplace(name, static_cast<int>(targets_.size()));
      targets_.push_back(make(desc));
      return {static_cast<int>(targets_.size()) - 1};
    }
    Target& target = targets_[known->second];
    if (target.desc != desc) {
      drop(target);
      target = make(desc);
    }
    return {known->second};
  }

  GeometryId upload(std::span<const float> vertices, std::span<const Triangle> triangles) override {
    Geometry geometry;
    glGenVertexArrays(1, &geometry.array);
    glBindVertexArray(geometry.array);
    glGenBuffers(2, geometry.buffers);
    glBindBuffer(GL_ARRAY_BUFFER, geometry.buffers[0]);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data(),
                 GL_STREAM_DRAW);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, geometry.buffers[1]);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size_bytes()), triangles.data(),
                 GL_STREAM_DRAW);
    const int sizes[] = {3, 3, 2, 1}, offsets[] = {0, 3, 6, 8};
    for (GLuint a = 0; a < 4; ++a) {
      glEnableVertexAttribArray(a);
      glVertexAttribPointer(a, sizes[a], GL_FLOAT, GL_FALSE, kFloatsPerVertex * sizeof(float),
                            reinterpret_cast<const void*>(offsets[a] * sizeof(float)));
    }
    geometry.num_indices = static_cast<GLsizei>(3 * triangles.size());
    geometries_.push_back(geometry);
    return {static_cast<int>(geometries_.size()) - 1};
  }

  void forget_geometry() override {
    for (Geometry& geometry : geometries_) {
      glDeleteBuffers(2, geometry.buffers);
      glDeleteVertexArrays(1, &geometry.array);
    }
    geometries_.clear();
  }

  void begin_pass(TargetId id) override {
    const Target& target = targets_.at(id.index);
    glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
    glViewport(0, 0, target.desc.width, target.desc.height);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_CULL_FACE);
    glClearColor(0, 0, 0, 0);
    glClearDepth(1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  }

  void draw(const DrawCall& call) override {
    const GLuint program = linked(call.program);
    glUseProgram(program);
    int unit = 0;
    for (const Uniform& uniform : call.uniforms) set(program, uniform, unit);
    if (std::holds_alternative<WholeTarget>(call.what)) {
      glBindVertexArray(empty_);
      glDrawArrays(GL_TRIANGLES, 0, 3);
    } else if (const GeometryId* id = std::get_if<GeometryId>(&call.what)) {
      const Geometry& geometry = geometries_.at(id->index);
      glBindVertexArray(geometry.array);
      glDrawElements(GL_TRIANGLES, geometry.num_indices, GL_UNSIGNED_INT, nullptr);
    } else {
      draw_instances(std::get<Instances>(call.what), call.program == Program::line ? 2 : 1);
    }
  }

  void resolve(TargetId from, TargetId to) override {
    const Target &source = targets_.at(from.index), &target = targets_.at(to.index);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, source.framebuffer);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target.framebuffer);
    const int w = source.desc.width, h = source.desc.height;
    glBlitFramebuffer(0, 0, w, h, 0, 0, w, h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }

  Image read(TargetId id) override {
    const Target& target = targets_.at(id.index);
    Image image(target.desc.width, target.desc.height);
    std::vector<std::uint8_t> rows(image.rgba.size());
    glBindFramebuffer(GL_READ_FRAMEBUFFER, target.framebuffer);
    glReadPixels(0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE, rows.data());
    const std::size_t row = 4 * static_cast<std::size_t>(image.width);
    for (int y = 0; y < image.height; ++y)
      std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(row * (image.height - 1 - y)), row,
                  image.pixel(0, y));
    undo_premultiplication(image);
    return image;
  }

  void show(TargetId id, const WindowPart& part) override {
    const Target& from = targets_.at(id.index);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, from.framebuffer);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glDisable(GL_SCISSOR_TEST);
    const bool is_scaled = from.desc.width != part.size.width || from.desc.height != part.size.height;
    glBlitFramebuffer(0, 0, from.desc.width, from.desc.height, part.x, part.y, part.x + part.size.width,
                      part.y + part.size.height, GL_COLOR_BUFFER_BIT, is_scaled ? GL_LINEAR : GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
  }

 private:
  struct Target {
    TargetDesc desc;
    GLuint framebuffer = 0, textures[2] = {0, 0}, renderbuffers[2] = {0, 0};  // colours, depths
  };

  struct Geometry {
    GLuint array = 0, buffers[2] = {0, 0};
    GLsizei num_indices = 0;
  };

  /// Lazy linking: drivers compile a program at its first use.
  GLuint linked(Program program) {
    GLuint& known = programs_[static_cast<std::size_t>(program)];
    if (known == 0) known = link(shader_source(program));
    return known;
  }

  void make_sampler(bool compares) {
    GLuint& sampler = samplers_[compares];
    glGenSamplers(1, &sampler);
    glSamplerParameteri(sampler, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glSamplerParameteri(sampler, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    const GLint filter = GL_LINEAR;
    glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, filter);
    glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, filter);
    if (!compares) return;
    glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  }

  static GLuint make_renderbuffer(const TargetDesc& desc, GLenum format, GLenum attachment) {
    GLuint buffer = 0;
    glGenRenderbuffers(1, &buffer);
    glBindRenderbuffer(GL_RENDERBUFFER, buffer);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, desc.samples > 1 ? desc.samples : 0, format, desc.width,
                                     desc.height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
    return buffer;
  }

  static GLuint make_texture(const TargetDesc& desc, const PixelFormat& format, GLenum attachment) {
    GLuint texture = 0;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format.internal), desc.width, desc.height, 0,
                 format.format, format.type, nullptr);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
    glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture, 0);
    return texture;
  }

  /// One sample: a texture that programs can read. Several: renderbuffers with depth.
  static Target make(const TargetDesc& desc) {
    Target target{.desc = desc};
    glGenFramebuffers(1, &target.framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
    const PixelFormat format = pixel_format(desc.format);
    const bool is_depth = desc.format == TargetDesc::Format::depth;
    if (desc.samples > 1) {
      target.renderbuffers[0] = make_renderbuffer(desc, format.internal, GL_COLOR_ATTACHMENT0);
    } else {
      target.textures[is_depth] =
          make_texture(desc, format, is_depth ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0);
    }
    if (is_depth) {
      glDrawBuffer(GL_NONE);
      glReadBuffer(GL_NONE);
    } else if (desc.format == TargetDesc::Format::surface) {
      target.textures[1] = make_texture(desc, pixel_format(TargetDesc::Format::depth), GL_DEPTH_ATTACHMENT);
    } else if (desc.format == TargetDesc::Format::color) {
      target.renderbuffers[1] = make_renderbuffer(desc, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT);
    }
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE) return target;
    throw GraphicsError("the graphics driver rejects a picture of " + std::to_string(desc.width) + "x" +
                        std::to_string(desc.height) + " pixels with " + std::to_string(desc.samples) +
                        " samples; use a smaller one");
  }

  static void drop(Target& target) {
    glDeleteFramebuffers(1, &target.framebuffer);
    glDeleteTextures(2, target.textures);
    glDeleteRenderbuffers(2, target.renderbuffers);
  }

  void set(GLuint program, const Uniform& uniform, int& unit) {
    const GLint at = glGetUniformLocation(program, std::string(uniform.name).c_str());
    if (const int* i = std::get_if<int>(&uniform.value)) {
      glUniform1i(at, *i);
    } else if (const float* f = std::get_if<float>(&uniform.value)) {
      glUniform1f(at, *f);
    } else if (const auto* v2 = std::get_if<Eigen::Vector2f>(&uniform.value)) {
      glUniform2fv(at, 1, v2->data());
    } else if (const auto* v3 = std::get_if<Eigen::Vector3f>(&uniform.value)) {
      glUniform3fv(at, 1, v3->data());
    } else if (const auto* m = std::get_if<Eigen::Matrix4f>(&uniform.value)) {
      glUniformMatrix4fv(at, 1, GL_FALSE, m->data());
    } else {
      const Texture& texture = std::get<Texture>(uniform.value);
      glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
      const Target& target = targets_.at(texture.target.index);
      glBindTexture(GL_TEXTURE_2D, target.textures[texture.part != Texture::Part::colors]);
      glBindSampler(static_cast<GLuint>(unit), samplers_[texture.part == Texture::Part::comparisons]);
      glUniform1i(at, unit++);
    }
  }

  /// Each instance has `places_each` attributes of three floats, drawn as a strip of two triangles.
  void draw_instances(const Instances& instances, int places_each) {
    glBindVertexArray(instances_);
    glBindBuffer(GL_ARRAY_BUFFER, places_);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(instances.places.size_bytes()),
                 instances.places.data(), GL_STREAM_DRAW);
    const GLsizei stride = static_cast<GLsizei>(3 * sizeof(float)) * places_each;
    for (GLuint a = 0; a < 2; ++a) {
      if (static_cast<int>(a) >= places_each) {
        glDisableVertexAttribArray(a);
        continue;
      }
      glEnableVertexAttribArray(a);
      glVertexAttribPointer(a, 3, GL_FLOAT, GL_FALSE, stride,
                            reinterpret_cast<const void*>(3 * sizeof(float) * a));
      glVertexAttribDivisor(a, 1);
    }
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4,
                          static_cast<GLsizei>(instances.places.size()) / (3 * places_each));
  }

  /// Resolving with empty samples has multiplied colour by coverage.
  static void undo_premultiplication(Image& image) {
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
      const int alpha = image.rgba[i + 3];
      if (alpha == 0 || alpha == 255) continue;
      for (std::size_t c = 0; c < 3; ++c)
        image.rgba[i + c] =
            static_cast<std::uint8_t>(std::min(255, (255 * image.rgba[i + c] + alpha / 2) / alpha));
    }
  }

  std::array<GLuint, kNumPrograms> programs_{};  // 0: not linked yet
  std::array<GLuint, 2> samplers_{};
  std::map<std::string, int> targets_by_name_;
  std::vector<Target> targets_;
  std::vector<Geometry> geometries_;
  GLuint empty_ = 0, instances_ = 0, places_ = 0;
};

}  // namespace

std::unique_ptr<Device> make_gl_device() { return std::make_unique<GlDevice>(); }

}  // namespace weft::engine
