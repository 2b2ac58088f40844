// A host's context in which no binding point is free and no state is as a new context has it, and all of that as
// numbers by name. Written apart from StateGuard's own lists, so that what one forgets the other names. Raw OpenGL, for
// the objects of engine/gl keep to the binding points that they may use.
#pragma once

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace lambent::test {

struct TextureTarget {
  GLenum target, binding;
  const char* name;
};
inline constexpr TextureTarget kTextureTargets[] = {
    {GL_TEXTURE_1D, GL_TEXTURE_BINDING_1D, "1D"},
    {GL_TEXTURE_2D, GL_TEXTURE_BINDING_2D, "2D"},
    {GL_TEXTURE_3D, GL_TEXTURE_BINDING_3D, "3D"},
    {GL_TEXTURE_1D_ARRAY, GL_TEXTURE_BINDING_1D_ARRAY, "1D array"},
    {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY, "2D array"},
    {GL_TEXTURE_RECTANGLE, GL_TEXTURE_BINDING_RECTANGLE, "rectangle"},
    {GL_TEXTURE_CUBE_MAP, GL_TEXTURE_BINDING_CUBE_MAP, "cube"},
    {GL_TEXTURE_CUBE_MAP_ARRAY, GL_TEXTURE_BINDING_CUBE_MAP_ARRAY, "cube array"},
    {GL_TEXTURE_BUFFER, GL_TEXTURE_BINDING_BUFFER, "buffer"},
    {GL_TEXTURE_2D_MULTISAMPLE, GL_TEXTURE_BINDING_2D_MULTISAMPLE, "2D multisample"},
    {GL_TEXTURE_2D_MULTISAMPLE_ARRAY, GL_TEXTURE_BINDING_2D_MULTISAMPLE_ARRAY, "2D multisample array"},
};

/// A switch, and how a host may have it that no pass expects.
struct HostSwitch {
  GLenum what;
  const char* name;
  bool odd;
};
#define SWITCH(what, odd)                                                                                              \
  HostSwitch { what, #what, odd }
inline constexpr HostSwitch kHostSwitches[] = {
    SWITCH(GL_DEPTH_TEST, true),
    SWITCH(GL_DEPTH_CLAMP, true),
    SWITCH(GL_STENCIL_TEST, true),
    SWITCH(GL_CULL_FACE, true),
    SWITCH(GL_FRAMEBUFFER_SRGB, true),
    SWITCH(GL_RASTERIZER_DISCARD, true),
    SWITCH(GL_PROGRAM_POINT_SIZE, true),
    SWITCH(GL_TEXTURE_CUBE_MAP_SEAMLESS, false),
    SWITCH(GL_COLOR_LOGIC_OP, true),
    SWITCH(GL_PRIMITIVE_RESTART, true),
    SWITCH(GL_PRIMITIVE_RESTART_FIXED_INDEX, true),
    SWITCH(GL_MULTISAMPLE, false),
    SWITCH(GL_SAMPLE_ALPHA_TO_COVERAGE, true),
    SWITCH(GL_SAMPLE_ALPHA_TO_ONE, true),
    SWITCH(GL_SAMPLE_COVERAGE, true),
    SWITCH(GL_SAMPLE_MASK, true),
    SWITCH(GL_SAMPLE_SHADING, true),
    SWITCH(GL_POLYGON_OFFSET_FILL, true),
    SWITCH(GL_POLYGON_OFFSET_LINE, true),
    SWITCH(GL_POLYGON_OFFSET_POINT, true),
    SWITCH(GL_POLYGON_SMOOTH, true),
    SWITCH(GL_LINE_SMOOTH, true),
    SWITCH(GL_DITHER, false),
    SWITCH(GL_CLIP_DISTANCE0, true),
    SWITCH(GL_CLIP_DISTANCE1, true),
    SWITCH(GL_CLIP_DISTANCE2, true),
    SWITCH(GL_CLIP_DISTANCE3, true),
    SWITCH(GL_CLIP_DISTANCE4, true),
    SWITCH(GL_CLIP_DISTANCE5, true),
    SWITCH(GL_CLIP_DISTANCE6, true),
    SWITCH(GL_CLIP_DISTANCE7, true),
};
#undef SWITCH

inline constexpr std::pair<GLenum, const char*> kBufferTargets[] = {
    {GL_ARRAY_BUFFER, "array buffer"},
    {GL_ATOMIC_COUNTER_BUFFER, "atomic counter buffer"},
    {GL_COPY_READ_BUFFER, "copy read buffer"},
    {GL_COPY_WRITE_BUFFER, "copy write buffer"},
    {GL_DISPATCH_INDIRECT_BUFFER, "dispatch indirect buffer"},
    {GL_DRAW_INDIRECT_BUFFER, "draw indirect buffer"},
    {GL_PIXEL_PACK_BUFFER, "pixel pack buffer"},
    {GL_PIXEL_UNPACK_BUFFER, "pixel unpack buffer"},
    {GL_QUERY_BUFFER, "query buffer"},
    {GL_SHADER_STORAGE_BUFFER, "storage buffer"},
    {GL_TEXTURE_BUFFER, "texture buffer"},
    {GL_TRANSFORM_FEEDBACK_BUFFER, "feedback buffer"},
    {GL_UNIFORM_BUFFER, "uniform buffer"},
};

inline constexpr GLenum kPixelStores[] = {
    GL_PACK_ROW_LENGTH,  GL_PACK_IMAGE_HEIGHT,  GL_PACK_SKIP_PIXELS,    GL_PACK_SKIP_ROWS,
    GL_PACK_SKIP_IMAGES, GL_UNPACK_ROW_LENGTH,  GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_PIXELS,
    GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_IMAGES,                                              // any number
    GL_PACK_SWAP_BYTES,  GL_PACK_LSB_FIRST,     GL_UNPACK_SWAP_BYTES,   GL_UNPACK_LSB_FIRST, // a flag
    GL_PACK_ALIGNMENT,   GL_UNPACK_ALIGNMENT,
};

inline int limitOf(GLenum what, int most) {
  GLint value = 0;
  glGetIntegerv(what, &value);
  return std::min(value, most);
}
/// Binding points of a kind: as many as there are, but no more than a test has time for.
inline int hostUnits() { return limitOf(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS, 192); }
inline int hostUniforms() { return limitOf(GL_MAX_UNIFORM_BUFFER_BINDINGS, 96); }
inline int hostStorages() { return limitOf(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, 96); }
inline int hostCounters() { return limitOf(GL_MAX_ATOMIC_COUNTER_BUFFER_BINDINGS, 16); }
inline int hostImages() { return limitOf(GL_MAX_IMAGE_UNITS, 64); }
inline int hostFeedbacks() { return limitOf(GL_MAX_TRANSFORM_FEEDBACK_BUFFERS, 8); }
inline int hostViewports() { return limitOf(GL_MAX_VIEWPORTS, 32); }
inline int hostTargets() { return limitOf(GL_MAX_DRAW_BUFFERS, 32); }
inline int hostAttributes() { return limitOf(GL_MAX_VERTEX_ATTRIBS, 32); }

using Snapshot = std::map<std::string, std::vector<double>>;

inline Snapshot snapshot() {
  Snapshot s;
  const auto number = [&](const std::string& name, GLenum what, int count = 1) {
    std::vector<double> values(16);
    glGetDoublev(what, values.data());
    values.resize(size_t(count));
    s[name] = values;
  };
#define NUMBER(what, ...) number(#what, what __VA_OPT__(, ) __VA_ARGS__)
  NUMBER(GL_CURRENT_PROGRAM), NUMBER(GL_PROGRAM_PIPELINE_BINDING), NUMBER(GL_VERTEX_ARRAY_BINDING);
  NUMBER(GL_DRAW_FRAMEBUFFER_BINDING), NUMBER(GL_READ_FRAMEBUFFER_BINDING), NUMBER(GL_RENDERBUFFER_BINDING);
  NUMBER(GL_DEPTH_FUNC), NUMBER(GL_DEPTH_WRITEMASK), NUMBER(GL_FRONT_FACE), NUMBER(GL_CULL_FACE_MODE);
  NUMBER(GL_CLIP_ORIGIN), NUMBER(GL_CLIP_DEPTH_MODE), NUMBER(GL_POLYGON_MODE), NUMBER(GL_PROVOKING_VERTEX);
  NUMBER(GL_POINT_SIZE), NUMBER(GL_POINT_FADE_THRESHOLD_SIZE), NUMBER(GL_POINT_SPRITE_COORD_ORIGIN);
  NUMBER(GL_LINE_WIDTH), NUMBER(GL_LOGIC_OP_MODE), NUMBER(GL_BLEND_COLOR, 4), NUMBER(GL_POLYGON_OFFSET_FACTOR);
  NUMBER(GL_POLYGON_OFFSET_UNITS), NUMBER(GL_PRIMITIVE_RESTART_INDEX), NUMBER(GL_PATCH_VERTICES);
  NUMBER(GL_PATCH_DEFAULT_INNER_LEVEL, 2), NUMBER(GL_PATCH_DEFAULT_OUTER_LEVEL, 4), NUMBER(GL_MIN_SAMPLE_SHADING_VALUE);
  NUMBER(GL_SAMPLE_COVERAGE_VALUE), NUMBER(GL_SAMPLE_COVERAGE_INVERT), NUMBER(GL_CLAMP_READ_COLOR);
  NUMBER(GL_STENCIL_FUNC), NUMBER(GL_STENCIL_REF), NUMBER(GL_STENCIL_VALUE_MASK), NUMBER(GL_STENCIL_WRITEMASK);
  NUMBER(GL_STENCIL_FAIL), NUMBER(GL_STENCIL_PASS_DEPTH_FAIL), NUMBER(GL_STENCIL_PASS_DEPTH_PASS);
  NUMBER(GL_STENCIL_BACK_FUNC), NUMBER(GL_STENCIL_BACK_REF), NUMBER(GL_STENCIL_BACK_VALUE_MASK);
  NUMBER(GL_STENCIL_BACK_WRITEMASK), NUMBER(GL_STENCIL_BACK_FAIL), NUMBER(GL_STENCIL_BACK_PASS_DEPTH_FAIL);
  NUMBER(GL_STENCIL_BACK_PASS_DEPTH_PASS), NUMBER(GL_STENCIL_CLEAR_VALUE), NUMBER(GL_COLOR_CLEAR_VALUE, 4);
  NUMBER(GL_DEPTH_CLEAR_VALUE), NUMBER(GL_LINE_SMOOTH_HINT), NUMBER(GL_POLYGON_SMOOTH_HINT);
  NUMBER(GL_TEXTURE_COMPRESSION_HINT), NUMBER(GL_FRAGMENT_SHADER_DERIVATIVE_HINT), NUMBER(GL_ACTIVE_TEXTURE);
  NUMBER(GL_ARRAY_BUFFER_BINDING), NUMBER(GL_ELEMENT_ARRAY_BUFFER_BINDING), NUMBER(GL_ATOMIC_COUNTER_BUFFER_BINDING);
  NUMBER(GL_COPY_READ_BUFFER_BINDING), NUMBER(GL_COPY_WRITE_BUFFER_BINDING),
      NUMBER(GL_DISPATCH_INDIRECT_BUFFER_BINDING);
  NUMBER(GL_DRAW_INDIRECT_BUFFER_BINDING), NUMBER(GL_PIXEL_PACK_BUFFER_BINDING), NUMBER(GL_PIXEL_UNPACK_BUFFER_BINDING);
  NUMBER(GL_QUERY_BUFFER_BINDING), NUMBER(GL_SHADER_STORAGE_BUFFER_BINDING), NUMBER(GL_TEXTURE_BUFFER_BINDING);
  NUMBER(GL_TRANSFORM_FEEDBACK_BUFFER_BINDING), NUMBER(GL_UNIFORM_BUFFER_BINDING);
  NUMBER(GL_TRANSFORM_FEEDBACK_BINDING), NUMBER(GL_TRANSFORM_FEEDBACK_ACTIVE), NUMBER(GL_TRANSFORM_FEEDBACK_PAUSED);
  NUMBER(GL_DEBUG_GROUP_STACK_DEPTH);
#undef NUMBER
  for (const GLenum what : kPixelStores) number("pixel store " + std::to_string(what), what);
  for (const HostSwitch& w : kHostSwitches) s[w.name] = {double(glIsEnabled(w.what))};
  for (const GLenum what : {GL_DEBUG_OUTPUT, GL_DEBUG_OUTPUT_SYNCHRONOUS})
    s["debug output " + std::to_string(what)] = {double(glIsEnabled(what))};

  const auto indexed = [&](const std::string& name, GLenum what, int indices, int count = 1) {
    for (int i = 0; i < indices; ++i) {
      std::vector<double> values(16);
      glGetDoublei_v(what, GLuint(i), values.data());
      values.resize(size_t(count));
      s[name + " " + std::to_string(i)] = values;
    }
  };
  indexed("viewport", GL_VIEWPORT, hostViewports(), 4), indexed("scissor", GL_SCISSOR_BOX, hostViewports(), 4);
  indexed("depth range", GL_DEPTH_RANGE, hostViewports(), 2);
  indexed("blend source", GL_BLEND_SRC_RGB, hostTargets());
  indexed("blend source alpha", GL_BLEND_SRC_ALPHA, hostTargets());
  indexed("blend destination", GL_BLEND_DST_RGB, hostTargets());
  indexed("blend destination alpha", GL_BLEND_DST_ALPHA, hostTargets());
  indexed("blend equation", GL_BLEND_EQUATION_RGB, hostTargets());
  indexed("blend equation alpha", GL_BLEND_EQUATION_ALPHA, hostTargets());
  indexed("color mask", GL_COLOR_WRITEMASK, hostTargets(), 4);
  indexed("sample mask", GL_SAMPLE_MASK_VALUE, limitOf(GL_MAX_SAMPLE_MASK_WORDS, 4));
  for (int i = 0; i < hostViewports(); ++i)
    s["scissor test " + std::to_string(i)] = {double(glIsEnabledi(GL_SCISSOR_TEST, GLuint(i)))};
  for (int i = 0; i < hostTargets(); ++i) s["blend " + std::to_string(i)] = {double(glIsEnabledi(GL_BLEND, GLuint(i)))};

  const auto ranges = [&](const std::string& name, GLenum binding, GLenum start, GLenum size, int indices) {
    for (int i = 0; i < indices; ++i) {
      GLint buffer = 0;
      GLint64 from = 0, bytes = 0;
      glGetIntegeri_v(binding, GLuint(i), &buffer);
      glGetInteger64i_v(start, GLuint(i), &from);
      glGetInteger64i_v(size, GLuint(i), &bytes);
      s[name + " " + std::to_string(i)] = {double(buffer), double(from), double(bytes)};
    }
  };
  ranges("uniform buffer", GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE, hostUniforms());
  ranges("storage buffer", GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER_START,
         GL_SHADER_STORAGE_BUFFER_SIZE, hostStorages());
  ranges("atomic counter buffer", GL_ATOMIC_COUNTER_BUFFER_BINDING, GL_ATOMIC_COUNTER_BUFFER_START,
         GL_ATOMIC_COUNTER_BUFFER_SIZE, hostCounters());
  ranges("feedback buffer", GL_TRANSFORM_FEEDBACK_BUFFER_BINDING, GL_TRANSFORM_FEEDBACK_BUFFER_START,
         GL_TRANSFORM_FEEDBACK_BUFFER_SIZE, hostFeedbacks());
  for (int i = 0; i < hostFeedbacks(); ++i) {
    GLint buffer = 0;
    glGetTransformFeedbacki_v(0, GL_TRANSFORM_FEEDBACK_BUFFER_BINDING, GLuint(i), &buffer);
    s["feedback buffer of the default object " + std::to_string(i)] = {double(buffer)};
  }
  for (int i = 0; i < hostImages(); ++i) {
    std::vector<double>& values = s["image unit " + std::to_string(i)];
    for (const GLenum what : {GL_IMAGE_BINDING_NAME, GL_IMAGE_BINDING_LEVEL, GL_IMAGE_BINDING_LAYERED,
                              GL_IMAGE_BINDING_LAYER, GL_IMAGE_BINDING_ACCESS, GL_IMAGE_BINDING_FORMAT}) {
      GLint value = 0;
      glGetIntegeri_v(what, GLuint(i), &value);
      values.push_back(value);
    }
  }
  GLint active = 0;
  glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
  for (int unit = 0; unit < hostUnits(); ++unit) {
    glActiveTexture(GLenum(GL_TEXTURE0 + unit));
    const std::string name = "texture unit " + std::to_string(unit) + " ";
    for (const TextureTarget& t : kTextureTargets) number(name + t.name, t.binding);
    number(name + "sampler", GL_SAMPLER_BINDING);
  }
  glActiveTexture(GLenum(active));
  for (int i = 0; i < hostAttributes(); ++i) {
    std::vector<double> value(4);
    glGetVertexAttribdv(GLuint(i), GL_CURRENT_VERTEX_ATTRIB, value.data());
    s["vertex attribute " + std::to_string(i)] = value;
  }
  for (const GLenum target : {GL_TIME_ELAPSED, GL_SAMPLES_PASSED, GL_ANY_SAMPLES_PASSED, GL_PRIMITIVES_GENERATED,
                              GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN}) {
    GLint query = 0;
    glGetQueryiv(target, GL_CURRENT_QUERY, &query);
    s["query " + std::to_string(target)] = {double(query)};
  }
  return s;
}

inline void expectUnchanged(const Snapshot& before, const std::string& after) {
  const Snapshot now = snapshot();
  for (const auto& [name, values] : before) EXPECT_EQ(now.at(name), values) << name << " changed by " << after;
}

/// All of it, taken by objects of a host.
class HostState {
 public:
  HostState() {
    glCreateBuffers(1, &buffer_);
    glNamedBufferStorage(buffer_, 1 << 16, nullptr, 0);
    textures_.resize(std::size(kTextureTargets) * size_t(hostUnits()));
    for (size_t t = 0; t < std::size(kTextureTargets); ++t)
      glCreateTextures(kTextureTargets[t].target, hostUnits(), textures_.data() + t * size_t(hostUnits()));
    samplers_.resize(size_t(hostUnits()));
    glCreateSamplers(hostUnits(), samplers_.data());
    // Comparisons, wraps and filters that would spoil what a pass reads.
    for (const GLuint sampler : samplers_) {
      glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
      glSamplerParameteri(sampler, GL_TEXTURE_COMPARE_FUNC, GL_NEVER);
      for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
        glSamplerParameteri(sampler, wrap, GL_MIRRORED_REPEAT);
      glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
      glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    }
    images_.resize(size_t(hostImages()));
    glCreateTextures(GL_TEXTURE_2D_ARRAY, hostImages(), images_.data());
    for (const GLuint image : images_) glTextureStorage3D(image, 2, GL_R32F, 4, 4, 4);
    glCreateTextures(GL_TEXTURE_2D, 2, targets_);
    glCreateFramebuffers(2, framebuffers_);
    for (int i = 0; i < 2; ++i) {
      glTextureStorage2D(targets_[i], 1, GL_RGBA8, 8, 8);
      glNamedFramebufferTexture(framebuffers_[i], GL_COLOR_ATTACHMENT0, targets_[i], 0);
    }
    glCreateRenderbuffers(1, &renderbuffer_);
    glCreateVertexArrays(1, &vertices_);
    glVertexArrayElementBuffer(vertices_, buffer_);
    glCreateTransformFeedbacks(1, &feedback_);
    for (int i = 0; i < hostFeedbacks(); ++i)
      glTransformFeedbackBufferRange(feedback_, GLuint(i), buffer_, 256 * (i + 1), 64);
    glCreateProgramPipelines(1, &pipeline_);
    glCreateQueries(GL_TIME_ELAPSED, 1, &query_);
    const char* text = "#version 450\nout gl_PerVertex { vec4 gl_Position; };\nvoid main() { gl_Position = vec4(0); }\n";
    program_ = glCreateShaderProgramv(GL_VERTEX_SHADER, 1, &text);
  }
  HostState(const HostState&) = delete;

  void poison() {
    poisoned_ = true;
    const auto offset = [](int i) { return GLintptr(256) * (1 + i % 200); };
    glUseProgram(program_);
    glBindProgramPipeline(pipeline_);
    glBindVertexArray(vertices_);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffers_[0]);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffers_[1]);
    glBindRenderbuffer(GL_RENDERBUFFER, renderbuffer_);
    for (int i = 0; i < hostFeedbacks(); ++i) glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, GLuint(i), buffer_);
    glBindTransformFeedback(GL_TRANSFORM_FEEDBACK, feedback_);
    for (int i = 0; i < hostUniforms(); ++i) glBindBufferRange(GL_UNIFORM_BUFFER, GLuint(i), buffer_, offset(i), 256);
    glBindBufferBase(GL_UNIFORM_BUFFER, 2, buffer_); // the whole of it, however large
    for (int i = 0; i < hostStorages(); ++i)
      glBindBufferRange(GL_SHADER_STORAGE_BUFFER, GLuint(i), buffer_, offset(i), 256);
    for (int i = 0; i < hostCounters(); ++i)
      glBindBufferRange(GL_ATOMIC_COUNTER_BUFFER, GLuint(i), buffer_, offset(i), 64);
    for (const auto& [target, name] : kBufferTargets) glBindBuffer(target, buffer_);
    for (int unit = 0; unit < hostUnits(); ++unit) {
      for (size_t t = 0; t < std::size(kTextureTargets); ++t)
        glBindTextureUnit(GLuint(unit), textures_[t * size_t(hostUnits()) + size_t(unit)]);
      glBindSampler(GLuint(unit), samplers_[size_t(unit)]);
    }
    for (int i = 0; i < hostImages(); ++i)
      glBindImageTexture(GLuint(i), images_[size_t(i)], i % 2, GL_FALSE, i % 4, GL_READ_WRITE, GL_R32F);
    glActiveTexture(GL_TEXTURE5);

    set(true);
    for (int v = 0; v < hostViewports(); ++v) {
      const GLuint i = GLuint(v);
      glViewportIndexedf(i, float(v), 2, 3, 4 + float(v));
      glScissorIndexed(i, v, 1, 2, 3);
      glDepthRangeIndexed(i, 0.25, 0.5 + 0.01 * v);
      v % 2 ? glEnablei(GL_SCISSOR_TEST, i) : glDisablei(GL_SCISSOR_TEST, i);
    }
    for (int t = 0; t < hostTargets(); ++t) {
      const GLuint i = GLuint(t);
      t % 3 ? glEnablei(GL_BLEND, i) : glDisablei(GL_BLEND, i);
      glBlendFuncSeparatei(i, t % 2 ? GL_DST_COLOR : GL_ONE_MINUS_DST_ALPHA, GL_ZERO, GL_CONSTANT_ALPHA, GL_SRC_ALPHA);
      glBlendEquationSeparatei(i, GL_FUNC_REVERSE_SUBTRACT, t % 2 ? GL_MAX : GL_MIN);
      glColorMaski(i, GL_FALSE, t % 2, GL_TRUE, GL_FALSE);
    }
    glStencilFuncSeparate(GL_FRONT, GL_NEVER, 3, 0x0f);
    glStencilFuncSeparate(GL_BACK, GL_GREATER, 5, 0xf0);
    glStencilMaskSeparate(GL_FRONT, 0x33);
    glStencilMaskSeparate(GL_BACK, 0x44);
    glStencilOpSeparate(GL_FRONT, GL_INCR, GL_DECR, GL_INVERT);
    glStencilOpSeparate(GL_BACK, GL_ZERO, GL_KEEP, GL_INCR_WRAP);
    for (int i = 0; i < hostAttributes(); ++i) glVertexAttrib4f(GLuint(i), 0.1f + float(i), 0.2f, 0.3f, 0.4f);
    for (int i = 0; i < 2; ++i) glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, -1, "host");
    glBeginQuery(GL_TIME_ELAPSED, query_);
  }

  /// All as a new context has it; viewports of one pixel.
  ~HostState() {
    if (poisoned_) reset();
    glDeleteProgram(program_);
    glDeleteQueries(1, &query_);
    glDeleteProgramPipelines(1, &pipeline_);
    glDeleteTransformFeedbacks(1, &feedback_);
    glDeleteVertexArrays(1, &vertices_);
    glDeleteRenderbuffers(1, &renderbuffer_);
    glDeleteFramebuffers(2, framebuffers_);
    glDeleteTextures(2, targets_);
    glDeleteTextures(GLsizei(images_.size()), images_.data());
    glDeleteSamplers(GLsizei(samplers_.size()), samplers_.data());
    glDeleteTextures(GLsizei(textures_.size()), textures_.data());
    glDeleteBuffers(1, &buffer_);
  }

 private:
  /// What has one value in the whole context: as no pass expects it, or as a new context has it.
  static void set(bool odd) {
    for (const HostSwitch& w : kHostSwitches) {
      const bool on = w.odd == odd && w.what != GL_TEXTURE_CUBE_MAP_SEAMLESS; // which is off at first
      on ? glEnable(w.what) : glDisable(w.what);
    }
    glBlendColor(odd ? 0.1f : 0, odd ? 0.2f : 0, odd ? 0.3f : 0, odd ? 0.4f : 0);
    glLogicOp(odd ? GL_XOR : GL_COPY);
    glDepthFunc(odd ? GL_NOTEQUAL : GL_LESS);
    glDepthMask(odd ? GL_FALSE : GL_TRUE);
    glClipControl(odd ? GL_UPPER_LEFT : GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    glFrontFace(odd ? GL_CW : GL_CCW);
    glCullFace(odd ? GL_FRONT : GL_BACK);
    glPolygonMode(GL_FRONT_AND_BACK, odd ? GL_LINE : GL_FILL);
    glPolygonOffset(odd ? 3 : 0, odd ? 7 : 0);
    glProvokingVertex(odd ? GL_FIRST_VERTEX_CONVENTION : GL_LAST_VERTEX_CONVENTION);
    glPointSize(odd ? 5 : 1);
    glPointParameterf(GL_POINT_FADE_THRESHOLD_SIZE, odd ? 3 : 1);
    glPointParameteri(GL_POINT_SPRITE_COORD_ORIGIN, odd ? GL_LOWER_LEFT : GL_UPPER_LEFT);
    glLineWidth(odd ? 1.5f : 1);
    glPrimitiveRestartIndex(odd);
    glPatchParameteri(GL_PATCH_VERTICES, odd ? 4 : 3);
    const float levels[2][4] = {{1, 1, 1, 1}, {2, 3, 4, 5}};
    for (const GLenum which : {GL_PATCH_DEFAULT_INNER_LEVEL, GL_PATCH_DEFAULT_OUTER_LEVEL})
      glPatchParameterfv(which, levels[odd]);
    glSampleCoverage(odd ? 0.25f : 1, odd);
    glSampleMaski(0, odd ? 0 : ~0u);
    glMinSampleShading(odd ? 0.5f : 0);
    glClampColor(GL_CLAMP_READ_COLOR, odd ? GL_TRUE : GL_FIXED_ONLY);
    glClearColor(odd ? 0.5f : 0, odd ? 0.6f : 0, odd ? 0.7f : 0, odd ? 0.8f : 0);
    glClearDepth(odd ? 0.3 : 1);
    glClearStencil(odd ? 9 : 0);
    for (const GLenum what :
         {GL_LINE_SMOOTH_HINT, GL_POLYGON_SMOOTH_HINT, GL_TEXTURE_COMPRESSION_HINT, GL_FRAGMENT_SHADER_DERIVATIVE_HINT})
      glHint(what, odd ? GL_NICEST : GL_DONT_CARE);
    for (size_t i = 0; i < std::size(kPixelStores); ++i)
      glPixelStorei(kPixelStores[i], i < 10 ? odd * (GLint(i) + 2) : i < 14 ? odd : odd ? 8 : 4);
  }

  void reset() const {
    glEndQuery(GL_TIME_ELAPSED);
    for (int i = 0; i < 2; ++i) glPopDebugGroup();
    for (int i = 0; i < hostAttributes(); ++i) glVertexAttrib4f(GLuint(i), 0, 0, 0, 1);
    set(false);
    glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    glStencilMask(~0u);
    glStencilFunc(GL_ALWAYS, 0, ~0u);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_ONE, GL_ZERO);
    glDisable(GL_BLEND);
    glDepthRange(0, 1);
    glViewport(0, 0, 1, 1);
    glScissor(0, 0, 1, 1);
    glDisable(GL_SCISSOR_TEST);
    for (int i = 0; i < hostImages(); ++i) glBindImageTexture(GLuint(i), 0, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R8);
    for (int unit = 0; unit < hostUnits(); ++unit) {
      glBindTextureUnit(GLuint(unit), 0);
      glBindSampler(GLuint(unit), 0);
    }
    glActiveTexture(GL_TEXTURE0);
    for (int i = 0; i < hostCounters(); ++i) glBindBufferBase(GL_ATOMIC_COUNTER_BUFFER, GLuint(i), 0);
    for (int i = 0; i < hostStorages(); ++i) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GLuint(i), 0);
    for (int i = 0; i < hostUniforms(); ++i) glBindBufferBase(GL_UNIFORM_BUFFER, GLuint(i), 0);
    glBindTransformFeedback(GL_TRANSFORM_FEEDBACK, 0);
    for (int i = 0; i < hostFeedbacks(); ++i) glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, GLuint(i), 0);
    for (const auto& [target, name] : kBufferTargets) glBindBuffer(target, 0);
    glBindRenderbuffer(GL_RENDERBUFFER, 0);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glBindVertexArray(0);
    glBindProgramPipeline(0);
    glUseProgram(0);
  }

  bool poisoned_ = false;
  GLuint buffer_ = 0, targets_[2] = {}, framebuffers_[2] = {}, renderbuffer_ = 0, vertices_ = 0, feedback_ = 0;
  GLuint pipeline_ = 0, query_ = 0, program_ = 0;
  std::vector<GLuint> textures_, samplers_, images_;
};

} // namespace lambent::test
