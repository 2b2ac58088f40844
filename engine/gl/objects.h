// OpenGL objects as move-only values: labelled, made with direct state access, immutable storage. A label starts with
// its owner ("vpl maps/faces"), under which its memory is counted.
#pragma once

#include "engine/core/memory.h"
#include "engine/gl/counts.h"

#include <epoxy/gl.h>

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lambent::gl {

/// Binding points of each kind that passes may use, from 0 on: those that StateGuard keeps for the host. All that binds
/// goes through the functions below, which stop the program where a pass goes further (tools/check_layers forbids
/// OpenGL's own).
inline constexpr int kTextureUnits = 14, kUniformBindings = 4, kStorageBindings = 8;
/// By name, 0 included: for what a table holds.
void bindTexture(int unit, GLuint texture);
void bindSampler(int unit, GLuint sampler);

/// Bytes of textures and buffers in the present account, by owner (the label up to '/'), ascending by name.
std::vector<std::pair<std::string, uint64_t>> memoryByOwner();

namespace detail {

/// Owns one GL name and its share of the memory count.
class Object {
 public:
  Object() = default;
  Object(GLenum kind, GLuint name, const std::string& label, uint64_t bytes);
  Object(Object&& other) noexcept { swap(other); }
  Object& operator=(Object&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Object();

  explicit operator bool() const { return name_ != 0; }
  GLuint name() const { return name_; }
  uint64_t bytes() const { return bytes_; }

 private:
  void swap(Object& other) noexcept;

  GLenum kind_ = 0; // as for glObjectLabel
  GLuint name_ = 0;
  uint64_t bytes_ = 0;
  std::string owner_;
  MemoryAccount* account_ = nullptr;
};

} // namespace detail

enum class TextureKind { Flat, Array, CubeArray };

struct TextureDesc {
  TextureKind kind = TextureKind::Flat;
  GLenum format = GL_RGBA8; // sized
  int width = 1, height = 1;
  int layers = 1; // array layers; cubes, not faces, for CubeArray
  int levels = 1;
  bool linear = false;       // minification and magnification filter
  bool depthCompare = false; // for shadow samplers; lit where reference ≥ stored when `compareGreater`, else ≤
  bool compareGreater = false;
};

class Buffer;

class Texture : public detail::Object {
 public:
  Texture() = default;
  Texture(const std::string& label, const TextureDesc& desc);
  /// Wraps a texture that another owner keeps alive: never deleted, its memory not counted.
  static Texture borrowed(GLuint name);
  /// Says whether a shader's sampler2D reads its values: two dimensions, no integers.
  bool readsAsFlat() const;
  /// Says whether look-ups begin at another level than 0, or find stencils.
  bool readsOtherThanLevel0() const;
  /// Says whether it compares depths, where no sampler is bound beside it.
  bool comparesDepths() const;
  /// What a depth, or a red, of value v may be off by: absolute + relative |v|. (GPUs may cut halves.)
  struct Rounding {
    float absolute = 0, relative = 0;
  };
  Rounding rounding() const;
  bool isDepth() const; // else depths are in its red channel
  /// Reads the texels of a buffer, which must outlive it.
  static Texture ofBuffer(const std::string& label, GLenum format, const Buffer& buffer);

  const TextureDesc& desc() const { return desc_; }
  int width() const { return desc_.width; }
  int height() const { return desc_.height; }
  void bind(int unit) const;
  /// Sets all texels of level 0 to zero. Colour formats only.
  void clear() const;
  /// Samplers see only these levels, numbered from `first`: while another one is drawn into, reading is well defined.
  void limitLevels(int first, int last) const;

  /// Copies all texels of a level to `texels`, whose size must be theirs in `format` and `type`. Waits for the GPU, as
  /// all that reads back.
  template <class T> void read(std::span<T> texels, GLenum format, GLenum type, int level = 0) const {
    readBytes(level, kAllLayers, format, type, texels.size_bytes(), texels.data());
  }
  /// Copies the texels of one layer of level 0.
  template <class T> void readLayer(int layer, std::span<T> texels, GLenum format, GLenum type) const {
    readBytes(0, layer, format, type, texels.size_bytes(), texels.data());
  }

 private:
  static constexpr int kAllLayers = -1;
  void readBytes(int level, int layer, GLenum format, GLenum type, size_t bytes, void* to) const;

  Texture(GLenum kind, GLuint name, const std::string& label) : Object(kind, name, label, 0) {}

  TextureDesc desc_;
};

/// Texels that a texture of a buffer may have.
uint32_t mostBufferTexels();

/// Bytes of one texel of a sized format. Only formats that this project uses.
int texelBytes(GLenum format);

class Buffer : public detail::Object {
 public:
  Buffer() = default;
  /// `data` may be null. `flags` as for glNamedBufferStorage. What the CPU changes later goes through a Ring.
  Buffer(const std::string& label, uint64_t bytes, const void* data, GLbitfield flags = 0);

  template <class T> static Buffer of(const std::string& label, std::span<const T> data, GLbitfield flags = 0) {
    return Buffer(label, data.size_bytes(), data.data(), flags);
  }
  /// Copies the bytes from `offset` on to `values`.
  template <class T> void read(uint64_t offset, std::span<T> values) const {
    readBytes(offset, values.size_bytes(), values.data());
  }
  void bindUniform(int binding) const;
  void bindUniform(int binding, uint64_t offset, uint64_t bytes) const;
  /// Binds the buffer for shaders to write into. What reads it next needs a barrier.
  void bindStorage(int binding) const;

 private:
  void readBytes(uint64_t offset, uint64_t bytes, void* to) const;
};

class Framebuffer : public detail::Object {
 public:
  Framebuffer() = default;
  explicit Framebuffer(const std::string& label);
  /// Whole textures, or one mip level of each, as attachments; null: none at that location. A depth format with stencil
  /// is attached as both. Aborts when incomplete: formats are ours, so that is a bug.
  Framebuffer(const std::string& label, std::initializer_list<const Texture*> colors, const Texture* depth = nullptr,
              int level = 0);

  /// Without attachments: for draws that only capture. A context without a window has no complete framebuffer of its
  /// own.
  static Framebuffer empty(const std::string& label);

  /// Attaches one layer (cube face: 6·cube + face) as depth, or as the first colour.
  void attachDepthLayer(const Texture& texture, int layer) const;
  void attachColorLayer(const Texture& texture, int layer) const;
  void bind() const;
};

class VertexArray : public detail::Object {
 public:
  VertexArray() = default;
  explicit VertexArray(const std::string& label);
};

class Sampler : public detail::Object {
 public:
  Sampler() = default;
  explicit Sampler(const std::string& label);
};

/// What transform feedback writes to a buffer, and how much that was (for glDrawTransformFeedback).
class TransformFeedback : public detail::Object {
 public:
  TransformFeedback() = default;
  TransformFeedback(const std::string& label, const Buffer& target);
  void bind() const;
  static void unbind();
};

class Query : public detail::Object {
 public:
  Query() = default;
  explicit Query(GLenum target);

  /// Returns the result if the GPU has come to it.
  std::optional<uint64_t> known() const;
  /// Returns the result; waits for it, and counts as a wait whether the GPU was there already or not: on another
  /// machine it would not have been.
  uint64_t result() const;
};

/// Mark: every fragment that is kept sets the stencil to 1. Marked: only where it is 1.
enum class Stencil { Off, Mark, Marked };

/// All fixed-function state a pass depends on; `apply` sets every field, so nothing leaks from pass to pass.
struct PipelineState {
  bool depthTest = false;
  bool depthWrite = false;
  GLenum depthFunc = GL_GREATER;
  bool add = false;        // destination + source
  bool blendAlpha = false; // source over
  bool multiply = false;   // destination × source
  Stencil stencil = Stencil::Off;
  bool colors = true;                      // off: fragments are counted, or write to buffers
  bool depthClamp = false;                 // casters outside the depth range are kept at its ends
  int x = 0, y = 0, width = 0, height = 0; // viewport and scissor
  void apply() const;
};

/// Reads RGB of the lower left width × height pixels of what the window is about to show, from the lowest row up.
std::vector<uint8_t> readWindow(int width, int height);

} // namespace lambent::gl
