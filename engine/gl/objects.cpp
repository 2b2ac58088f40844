#include "engine/gl/objects.h"

#include "engine/core/error.h"
#include "engine/core/free_memory.h"
#include "engine/core/memory.h"
#include "engine/gl/context.h"

#include <cmath>
#include <limits>

namespace lambent::gl {

namespace {

constexpr GLenum kTargets[] = {GL_TEXTURE_2D, GL_TEXTURE_2D_ARRAY, GL_TEXTURE_CUBE_MAP_ARRAY}; // by TextureKind

uint64_t bytesOf(const TextureDesc& desc) {
  uint64_t texels = 0;
  for (int level = 0; level < desc.levels; ++level)
    texels += uint64_t(std::max(1, desc.width >> level)) * std::max(1, desc.height >> level);
  return texels * desc.layers * (desc.kind == TextureKind::CubeArray ? 6 : 1) * texelBytes(desc.format);
}

template <class Create> GLuint make(Create create) {
  GLuint name = 0;
  create(1, &name);
  return name;
}

/// A CPU driver grants any size and takes the memory only when drawn to: then it is too late to refuse.
void refuseBeyondMemory(const TextureDesc& desc, const std::string& label) {
  constexpr uint64_t kSmall = uint64_t(64) << 20; // reading /proc takes time
  const uint64_t bytes = bytesOf(desc);
  if (bytes > kSmall && drawnByCpu() && bytes > freeMemory())
    throw RunError("graphics memory: " + label + " needs " + moreThanIsLeft(double(bytes), "fewer lights or texels"));
}

/// Throws RunError when the GPU has no room for it.
GLuint makeTexture(const TextureDesc& desc, const std::string& label) {
  refuseBeyondMemory(desc, label);
  GLuint name = 0;
  glCreateTextures(kTargets[int(desc.kind)], 1, &name);
  if (desc.kind != TextureKind::Flat)
    glTextureStorage3D(name, desc.levels, desc.format, desc.width, desc.height,
                       desc.layers * (desc.kind == TextureKind::CubeArray ? 6 : 1));
  else
    glTextureStorage2D(name, desc.levels, desc.format, desc.width, desc.height);
  if (glGetError() == GL_OUT_OF_MEMORY) {
    glDeleteTextures(1, &name);
    throw RunError("graphics memory: " + label + " needs " + std::to_string(bytesOf(desc) >> 20) + " MiB (" +
                   std::to_string(desc.width) + "x" + std::to_string(desc.height) + ", " + std::to_string(desc.layers) +
                   " layers), which the driver refuses (fewer lights or texels)");
  }
  const GLint filter = desc.linear ? GL_LINEAR : GL_NEAREST;
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, desc.levels > 1 ? GL_LINEAR_MIPMAP_LINEAR : filter);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, filter);
  for (GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTextureParameteri(name, wrap, GL_CLAMP_TO_EDGE);
  if (desc.depthCompare) {
    glTextureParameteri(name, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTextureParameteri(name, GL_TEXTURE_COMPARE_FUNC, desc.compareGreater ? GL_GEQUAL : GL_LEQUAL);
  }
  return name;
}

GLuint makeBuffer(uint64_t bytes, const void* data, GLbitfield flags) {
  const GLuint name = make(glCreateBuffers);
  glNamedBufferStorage(name, GLsizeiptr(bytes), data, flags);
  return name;
}

/// Deletes names of a kind of object, which is as for glObjectLabel.
PFNGLDELETETEXTURESPROC deletionOf(GLenum kind) {
  struct Deletion {
    GLenum kind;
    PFNGLDELETETEXTURESPROC* function;
  };
  constexpr Deletion kDeletions[] = {{GL_TEXTURE, &glDeleteTextures},
                                     {GL_BUFFER, &glDeleteBuffers},
                                     {GL_FRAMEBUFFER, &glDeleteFramebuffers},
                                     {GL_VERTEX_ARRAY, &glDeleteVertexArrays},
                                     {GL_SAMPLER, &glDeleteSamplers},
                                     {GL_TRANSFORM_FEEDBACK, &glDeleteTransformFeedbacks},
                                     {GL_QUERY, &glDeleteQueries}};
  for (const Deletion& d : kDeletions)
    if (d.kind == kind) return *d.function;
  checkFailed("a kind of object of this project", kind, 0, __FILE__, __LINE__);
}

} // namespace

int texelBytes(GLenum format) {
  switch (format) {
  case GL_R8:
    return 1;
  case GL_DEPTH_COMPONENT16:
    return 2;
  case GL_RGBA8:
  case GL_RG16:
  case GL_SRGB8_ALPHA8:
  case GL_R32F:
  case GL_R32UI:
  case GL_DEPTH24_STENCIL8:
  case GL_DEPTH_COMPONENT32F:
    return 4;
  case GL_RGBA16:
  case GL_RGBA16F:
  case GL_RG32F:
    return 8;
  case GL_RGBA32F:
  case GL_RGBA32UI:
    return 16;
  }
  checkFailed("a texture format of this project", format, 0, __FILE__, __LINE__);
}

std::vector<std::pair<std::string, uint64_t>> memoryByOwner() {
  std::vector<std::pair<std::string, uint64_t>> owners;
  for (const MemoryAccount::Row& row : MemoryAccount::current().rows())
    if (row.gpu) owners.emplace_back(row.owner, row.bytes);
  return owners;
}

namespace detail {

Object::Object(GLenum kind, GLuint name, const std::string& label, uint64_t bytes)
    : kind_(kind), name_(name), bytes_(bytes), owner_(label.substr(0, label.find('/'))) {
  if (!label.empty()) glObjectLabel(kind, name, GLsizei(label.size()), label.c_str());
  if (bytes_ == 0) return;
  account_ = &MemoryAccount::current();
  account_->enter(owner_, true, int64_t(bytes_));
}

Object::~Object() {
  if (name_ == 0) return;
  if (kind_ != 0) deletionOf(kind_)(1, &name_); // else it is somebody else's
  if (account_) account_->enter(owner_, true, -int64_t(bytes_));
}

void Object::swap(Object& other) noexcept {
  std::swap(kind_, other.kind_);
  std::swap(name_, other.name_);
  std::swap(bytes_, other.bytes_);
  std::swap(owner_, other.owner_);
  std::swap(account_, other.account_);
}

} // namespace detail

Texture::Texture(const std::string& label, const TextureDesc& desc)
    : Object(GL_TEXTURE, makeTexture(desc, label), label, bytesOf(desc)), desc_(desc) {}

Texture Texture::borrowed(GLuint name) {
  Texture texture(0, name, {}); // of no kind: not ours to delete
  texture.desc_ = {.width = 0, .height = 0};
  if (!glIsTexture(name)) return texture;
  GLint width = 0, height = 0, format = 0;
  glGetTextureLevelParameteriv(name, 0, GL_TEXTURE_WIDTH, &width);
  glGetTextureLevelParameteriv(name, 0, GL_TEXTURE_HEIGHT, &height);
  glGetTextureLevelParameteriv(name, 0, GL_TEXTURE_INTERNAL_FORMAT, &format);
  texture.desc_ = {.format = GLenum(format), .width = width, .height = height};
  return texture;
}

/// Mesa 22.3 does not tell the target in compatibility contexts (an error), so there all but rectangles and single
/// faces and layers are told by what they have.
bool Texture::readsAsFlat() const {
  const auto ofLevel = [&](GLenum what) {
    GLint value = 0;
    glGetTextureLevelParameteriv(name(), 0, what, &value);
    return value;
  };
  if (ofLevel(GL_TEXTURE_BUFFER_DATA_STORE_BINDING) != 0 || ofLevel(GL_TEXTURE_SAMPLES) != 0) return false;
  GLint profile = 0, target = GL_TEXTURE_2D;
  glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
  if (profile & GL_CONTEXT_CORE_PROFILE_BIT) glGetTextureParameteriv(name(), GL_TEXTURE_TARGET, &target);
  if (target != GL_TEXTURE_2D || ofLevel(GL_TEXTURE_DEPTH) > 1) return false;
  const GLint red = ofLevel(GL_TEXTURE_RED_TYPE);
  return red != GL_INT && red != GL_UNSIGNED_INT;
}

bool Texture::readsOtherThanLevel0() const {
  GLint base = 0, mode = GL_DEPTH_COMPONENT;
  glGetTextureParameteriv(name(), GL_TEXTURE_BASE_LEVEL, &base);
  glGetTextureParameteriv(name(), GL_DEPTH_STENCIL_TEXTURE_MODE, &mode);
  return base != 0 || mode != GL_DEPTH_COMPONENT;
}

bool Texture::comparesDepths() const {
  GLint compare = 0;
  glGetTextureParameteriv(name(), GL_TEXTURE_COMPARE_MODE, &compare);
  return compare != GL_NONE;
}

Texture::Rounding Texture::rounding() const {
  const bool depth = isDepth();
  GLint bits = 0, type = 0;
  glGetTextureLevelParameteriv(name(), 0, depth ? GL_TEXTURE_DEPTH_SIZE : GL_TEXTURE_RED_SIZE, &bits);
  glGetTextureLevelParameteriv(name(), 0, depth ? GL_TEXTURE_DEPTH_TYPE : GL_TEXTURE_RED_TYPE, &type);
  if (type == GL_FLOAT) return {0, bits >= 32 ? 0x1p-24f : bits >= 16 ? 0x1p-10f : 0x1p-5f};
  return {std::ldexp(0.5f, type == GL_SIGNED_NORMALIZED ? 1 - bits : -bits), 0};
}

bool Texture::isDepth() const {
  GLint depth = 0;
  glGetTextureLevelParameteriv(name(), 0, GL_TEXTURE_DEPTH_SIZE, &depth);
  return depth > 0;
}

uint32_t mostBufferTexels() {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  return uint32_t(most);
}

Texture Texture::ofBuffer(const std::string& label, GLenum format, const Buffer& buffer) {
  Texture texture(GL_TEXTURE, make([](GLsizei n, GLuint* names) { glCreateTextures(GL_TEXTURE_BUFFER, n, names); }),
                  label);
  glTextureBuffer(texture.name(), format, buffer.name());
  return texture;
}

void bindTexture(int unit, GLuint texture) {
  CHECK_LT(unit, kTextureUnits);
  glBindTextureUnit(GLuint(unit), texture);
}

void bindSampler(int unit, GLuint sampler) {
  CHECK_LT(unit, kTextureUnits);
  glBindSampler(GLuint(unit), sampler);
}

void Texture::bind(int unit) const { bindTexture(unit, name()); }

void Texture::limitLevels(int first, int last) const {
  glTextureParameteri(name(), GL_TEXTURE_BASE_LEVEL, first);
  glTextureParameteri(name(), GL_TEXTURE_MAX_LEVEL, last);
}

void Texture::readBytes(int level, int layer, GLenum format, GLenum type, size_t bytes, void* to) const {
  CHECK_LE(bytes, size_t(std::numeric_limits<GLsizei>::max()));
  if (layer == kAllLayers)
    glGetTextureImage(name(), level, format, type, GLsizei(bytes), to);
  else
    glGetTextureSubImage(name(), level, 0, 0, layer, width(), height(), 1, format, type, GLsizei(bytes), to);
  ++detail::countsSoFar().readBacks;
}

void Texture::clear() const { glClearTexImage(name(), 0, GL_RGBA, GL_FLOAT, nullptr); }

Buffer::Buffer(const std::string& label, uint64_t bytes, const void* data, GLbitfield flags)
    : Object(GL_BUFFER, makeBuffer(bytes, data, flags), label, bytes) {}

void Buffer::readBytes(uint64_t offset, uint64_t size, void* to) const {
  CHECK_LE(offset + size, bytes());
  glGetNamedBufferSubData(name(), GLintptr(offset), GLsizeiptr(size), to);
  ++detail::countsSoFar().readBacks;
}

void Buffer::bindUniform(int binding) const {
  CHECK_LT(binding, kUniformBindings);
  glBindBufferBase(GL_UNIFORM_BUFFER, GLuint(binding), name());
}

void Buffer::bindUniform(int binding, uint64_t offset, uint64_t size) const {
  CHECK_LT(binding, kUniformBindings);
  CHECK_LE(offset + size, bytes());
  glBindBufferRange(GL_UNIFORM_BUFFER, GLuint(binding), name(), GLintptr(offset), GLsizeiptr(size));
}

void Buffer::bindStorage(int binding) const {
  CHECK_LT(binding, kStorageBindings);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GLuint(binding), name());
}

Framebuffer::Framebuffer(const std::string& label) : Object(GL_FRAMEBUFFER, make(glCreateFramebuffers), label, 0) {}

Framebuffer::Framebuffer(const std::string& label, std::initializer_list<const Texture*> colors, const Texture* depth,
                         int level)
    : Framebuffer(label) {
  std::vector<GLenum> targets;
  for (const Texture* color : colors) {
    targets.push_back(color ? GLenum(GL_COLOR_ATTACHMENT0 + targets.size()) : GL_NONE);
    if (color) glNamedFramebufferTexture(name(), targets.back(), color->name(), level);
  }
  if (depth) {
    const bool stencil = depth->desc().format == GL_DEPTH24_STENCIL8;
    glNamedFramebufferTexture(name(), stencil ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT, depth->name(),
                              level);
  }
  glNamedFramebufferDrawBuffers(name(), GLsizei(targets.size()), targets.data());
  CHECK_EQ(glCheckNamedFramebufferStatus(name(), GL_DRAW_FRAMEBUFFER), GLenum(GL_FRAMEBUFFER_COMPLETE));
}

Framebuffer Framebuffer::empty(const std::string& label) {
  Framebuffer framebuffer(label);
  glNamedFramebufferParameteri(framebuffer.name(), GL_FRAMEBUFFER_DEFAULT_WIDTH, 1);
  glNamedFramebufferParameteri(framebuffer.name(), GL_FRAMEBUFFER_DEFAULT_HEIGHT, 1);
  return framebuffer;
}

void Framebuffer::attachDepthLayer(const Texture& texture, int layer) const {
  glNamedFramebufferTextureLayer(name(), GL_DEPTH_ATTACHMENT, texture.name(), 0, layer);
}

void Framebuffer::attachColorLayer(const Texture& texture, int layer) const {
  glNamedFramebufferTextureLayer(name(), GL_COLOR_ATTACHMENT0, texture.name(), 0, layer);
}

void Framebuffer::bind() const { glBindFramebuffer(GL_FRAMEBUFFER, name()); }

VertexArray::VertexArray(const std::string& label) : Object(GL_VERTEX_ARRAY, make(glCreateVertexArrays), label, 0) {}

Sampler::Sampler(const std::string& label) : Object(GL_SAMPLER, make(glCreateSamplers), label, 0) {}

TransformFeedback::TransformFeedback(const std::string& label, const Buffer& target)
    : Object(GL_TRANSFORM_FEEDBACK, make(glCreateTransformFeedbacks), label, 0) {
  glTransformFeedbackBufferBase(name(), 0, target.name());
}

void TransformFeedback::bind() const { glBindTransformFeedback(GL_TRANSFORM_FEEDBACK, name()); }

void TransformFeedback::unbind() { glBindTransformFeedback(GL_TRANSFORM_FEEDBACK, 0); }

Query::Query(GLenum target)
    : Object(GL_QUERY, make([target](GLsizei n, GLuint* names) { glCreateQueries(target, n, names); }), {}, 0) {}

std::optional<uint64_t> Query::known() const {
  GLuint ready = 0;
  glGetQueryObjectuiv(name(), GL_QUERY_RESULT_AVAILABLE, &ready);
  if (!ready) return std::nullopt;
  GLuint64 value = 0;
  glGetQueryObjectui64v(name(), GL_QUERY_RESULT, &value);
  return value;
}

uint64_t Query::result() const {
  GLuint64 value = 0;
  glGetQueryObjectui64v(name(), GL_QUERY_RESULT, &value);
  ++detail::countsSoFar().waits;
  return value;
}

void PipelineState::apply() const {
  const auto set = [](GLenum what, bool on) { on ? glEnable(what) : glDisable(what); };
  // Depth writes happen only with the test enabled, so a pass that writes without testing uses GL_ALWAYS.
  set(GL_DEPTH_TEST, depthTest);
  glDepthMask(depthWrite ? GL_TRUE : GL_FALSE);
  glDepthFunc(depthFunc);
  set(GL_DEPTH_CLAMP, depthClamp);
  set(GL_BLEND, add || blendAlpha || multiply);
  if (add)
    glBlendFunc(GL_ONE, GL_ONE);
  else if (multiply)
    glBlendFunc(GL_ZERO, GL_SRC_COLOR);
  else
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDisable(GL_CULL_FACE);
  set(GL_STENCIL_TEST, stencil != Stencil::Off);
  glStencilMask(stencil == Stencil::Mark ? 0xffu : 0u);
  glStencilFunc(stencil == Stencil::Mark ? GL_ALWAYS : GL_EQUAL, 1, 0xff);
  glStencilOp(GL_KEEP, GL_KEEP, stencil == Stencil::Mark ? GL_REPLACE : GL_KEEP);
  glDisable(GL_FRAMEBUFFER_SRGB);
  glColorMask(colors, colors, colors, colors);
  glViewport(x, y, width, height);
  glEnable(GL_SCISSOR_TEST);
  glScissor(x, y, width, height);
}

std::vector<uint8_t> readWindow(int width, int height) {
  std::vector<uint8_t> rgb(size_t(3) * width * height);
  GLint bound = 0;
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &bound);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, rgb.data()); // a window's read buffer is its back one
  glBindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(bound));
  ++detail::countsSoFar().readBacks;
  return rgb;
}

} // namespace lambent::gl
