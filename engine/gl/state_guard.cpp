#include "engine/gl/state_guard.h"

#include "engine/gl/objects.h"

#include <algorithm>
#include <array>
#include <exception>
#include <iterator>
#include <utility>

namespace lambent::gl {

namespace {

struct Switch {
  GLenum what;
  bool convention;
};
/// Those that have one value for all viewports and targets.
constexpr Switch kSwitches[] = {
    {GL_DEPTH_TEST, false},
    {GL_DEPTH_CLAMP, false},
    {GL_STENCIL_TEST, false},
    {GL_CULL_FACE, false},
    {GL_FRAMEBUFFER_SRGB, false},
    {GL_RASTERIZER_DISCARD, false},
    {GL_PROGRAM_POINT_SIZE, false},
    {GL_TEXTURE_CUBE_MAP_SEAMLESS, true},
    {GL_COLOR_LOGIC_OP, false},
    {GL_PRIMITIVE_RESTART, false},
    {GL_PRIMITIVE_RESTART_FIXED_INDEX, false},
    {GL_MULTISAMPLE, true},
    {GL_SAMPLE_ALPHA_TO_COVERAGE, false},
    {GL_SAMPLE_ALPHA_TO_ONE, false},
    {GL_SAMPLE_COVERAGE, false},
    {GL_SAMPLE_MASK, false},
    {GL_SAMPLE_SHADING, false},
    {GL_POLYGON_OFFSET_FILL, false},
    {GL_POLYGON_SMOOTH, false},
    {GL_DITHER, true},
    {GL_CLIP_DISTANCE0, false},
    {GL_CLIP_DISTANCE1, false},
    {GL_CLIP_DISTANCE2, false},
    {GL_CLIP_DISTANCE3, false},
    {GL_CLIP_DISTANCE4, false},
    {GL_CLIP_DISTANCE5, false},
    {GL_CLIP_DISTANCE6, false},
    {GL_CLIP_DISTANCE7, false},
};

/// Of the compatibility profile, which core contexts know as errors.
constexpr Switch kOldSwitches[] = {
    {GL_ALPHA_TEST, false}, {GL_POLYGON_STIPPLE, false}, {GL_VERTEX_PROGRAM_TWO_SIDE, false}, {GL_POINT_SPRITE, true}};
constexpr GLenum kOldClamps[] = {GL_CLAMP_VERTEX_COLOR, GL_CLAMP_FRAGMENT_COLOR};
struct PixelTransfer {
  GLenum what;
  GLfloat convention;
};
constexpr PixelTransfer kPixelTransfer[] = {{GL_MAP_COLOR, 0},   {GL_RED_SCALE, 1},   {GL_RED_BIAS, 0},
                                            {GL_GREEN_SCALE, 1}, {GL_GREEN_BIAS, 0},  {GL_BLUE_SCALE, 1},
                                            {GL_BLUE_BIAS, 0},   {GL_ALPHA_SCALE, 1}, {GL_ALPHA_BIAS, 0},
                                            {GL_DEPTH_SCALE, 1}, {GL_DEPTH_BIAS, 0}};

bool hasOldState() {
  GLint profile = 0;
  glGetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
  return (profile & GL_CONTEXT_COMPATIBILITY_PROFILE_BIT) != 0;
}

struct PixelStore {
  GLenum what;
  GLint convention;
};
constexpr PixelStore kPixelStore[] = {
    {GL_PACK_ALIGNMENT, 1},      {GL_PACK_SWAP_BYTES, 0},    {GL_PACK_LSB_FIRST, 0},   {GL_PACK_ROW_LENGTH, 0},
    {GL_PACK_IMAGE_HEIGHT, 0},   {GL_PACK_SKIP_PIXELS, 0},   {GL_PACK_SKIP_ROWS, 0},   {GL_PACK_SKIP_IMAGES, 0},
    {GL_UNPACK_ALIGNMENT, 1},    {GL_UNPACK_SWAP_BYTES, 0},  {GL_UNPACK_LSB_FIRST, 0}, {GL_UNPACK_ROW_LENGTH, 0},
    {GL_UNPACK_IMAGE_HEIGHT, 0}, {GL_UNPACK_SKIP_PIXELS, 0}, {GL_UNPACK_SKIP_ROWS, 0}, {GL_UNPACK_SKIP_IMAGES, 0},
};

/// Single numbers, and what sets each. They are restored after what is bound to indices, which changes some of them.
struct Value {
  GLenum what;
  void (*set)(GLint);
};
constexpr Value kValues[] = {
    {GL_ACTIVE_TEXTURE, [](GLint v) { glActiveTexture(GLenum(v)); }},
    {GL_UNIFORM_BUFFER_BINDING, [](GLint v) { glBindBuffer(GL_UNIFORM_BUFFER, GLuint(v)); }},
    {GL_SHADER_STORAGE_BUFFER_BINDING, [](GLint v) { glBindBuffer(GL_SHADER_STORAGE_BUFFER, GLuint(v)); }},
    {GL_DRAW_FRAMEBUFFER_BINDING, [](GLint v) { glBindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(v)); }},
    {GL_READ_FRAMEBUFFER_BINDING, [](GLint v) { glBindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(v)); }},
    {GL_VERTEX_ARRAY_BINDING, [](GLint v) { glBindVertexArray(GLuint(v)); }},
    {GL_DEPTH_FUNC, [](GLint v) { glDepthFunc(GLenum(v)); }},
    {GL_DEPTH_WRITEMASK, [](GLint v) { glDepthMask(GLboolean(v)); }},
    {GL_FRONT_FACE, [](GLint v) { glFrontFace(GLenum(v)); }},
    {GL_CULL_FACE_MODE, [](GLint v) { glCullFace(GLenum(v)); }},
    {GL_PROVOKING_VERTEX, [](GLint v) { glProvokingVertex(GLenum(v)); }},
    {GL_PIXEL_PACK_BUFFER_BINDING, [](GLint v) { glBindBuffer(GL_PIXEL_PACK_BUFFER, GLuint(v)); }},
    {GL_PIXEL_UNPACK_BUFFER_BINDING, [](GLint v) { glBindBuffer(GL_PIXEL_UNPACK_BUFFER, GLuint(v)); }},
    {GL_QUERY_BUFFER_BINDING, [](GLint v) { glBindBuffer(GL_QUERY_BUFFER, GLuint(v)); }},
    {GL_DRAW_INDIRECT_BUFFER_BINDING, [](GLint v) { glBindBuffer(GL_DRAW_INDIRECT_BUFFER, GLuint(v)); }},
    // One that was deleted while in use went for good when another took its place.
    {GL_CURRENT_PROGRAM, [](GLint v) { glUseProgram(glIsProgram(GLuint(v)) ? GLuint(v) : 0); }},
};

/// Every target of a texture unit: binding no texture to a unit empties them all.
constexpr GLenum kTextureTargets[] = {
    GL_TEXTURE_BINDING_1D,
    GL_TEXTURE_BINDING_2D,
    GL_TEXTURE_BINDING_3D,
    GL_TEXTURE_BINDING_1D_ARRAY,
    GL_TEXTURE_BINDING_2D_ARRAY,
    GL_TEXTURE_BINDING_RECTANGLE,
    GL_TEXTURE_BINDING_CUBE_MAP,
    GL_TEXTURE_BINDING_CUBE_MAP_ARRAY,
    GL_TEXTURE_BINDING_BUFFER,
    GL_TEXTURE_BINDING_2D_MULTISAMPLE,
    GL_TEXTURE_BINDING_2D_MULTISAMPLE_ARRAY,
};

/// That passes ask.
constexpr GLenum kQueries[] = {GL_SAMPLES_PASSED, GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN};

constexpr int kMostViewports = 16, kMostTargets = 16;
constexpr GLuint kColorAttribute = 3; // GpuScene sets it for vertices without colour

GLint get(GLenum what) {
  GLint value = 0;
  glGetIntegerv(what, &value);
  return value;
}
GLint get(GLenum what, int index) {
  GLint value = 0;
  glGetIntegeri_v(what, GLuint(index), &value);
  return value;
}
GLint query(GLenum target) {
  GLint value = 0;
  glGetQueryiv(target, GL_CURRENT_QUERY, &value);
  return value;
}
void set(GLenum what, bool on) { on ? glEnable(what) : glDisable(what); }
void set(GLenum what, int index, bool on) { on ? glEnablei(what, GLuint(index)) : glDisablei(what, GLuint(index)); }

struct Viewport {
  GLfloat rectangle[4] = {};
  GLdouble depthRange[2] = {};
  GLint scissor[4] = {};
  bool scissored = false;
};

struct Target {
  bool blended = false;
  GLint source = 0, destination = 0, sourceAlpha = 0, destinationAlpha = 0, equation = 0, equationAlpha = 0;
  GLboolean mask[4] = {};
};

struct Face {
  GLint function = 0, reference = 0, mask = 0, writeMask = 0, fail = 0, depthFail = 0, pass = 0;
};

struct Unit {
  GLint textures[std::size(kTextureTargets)] = {};
  GLint sampler = 0;
};

/// A part of a buffer, bound to an index.
struct Range {
  GLint name = 0;
  GLint64 offset = 0, bytes = 0;

  static Range of(GLenum binding, GLenum start, GLenum size, int index) {
    Range r{.name = get(binding, index)};
    glGetInteger64i_v(start, GLuint(index), &r.offset);
    glGetInteger64i_v(size, GLuint(index), &r.bytes);
    return r;
  }
  void bind(GLenum target, int index) const {
    if (bytes > 0)
      glBindBufferRange(target, GLuint(index), GLuint(name), GLintptr(offset), GLsizeiptr(bytes));
    else
      glBindBufferBase(target, GLuint(index), GLuint(name)); // none, or whole
  }
};

Face stencilOf(bool front) {
  return {get(front ? GL_STENCIL_FUNC : GL_STENCIL_BACK_FUNC),
          get(front ? GL_STENCIL_REF : GL_STENCIL_BACK_REF),
          get(front ? GL_STENCIL_VALUE_MASK : GL_STENCIL_BACK_VALUE_MASK),
          get(front ? GL_STENCIL_WRITEMASK : GL_STENCIL_BACK_WRITEMASK),
          get(front ? GL_STENCIL_FAIL : GL_STENCIL_BACK_FAIL),
          get(front ? GL_STENCIL_PASS_DEPTH_FAIL : GL_STENCIL_BACK_PASS_DEPTH_FAIL),
          get(front ? GL_STENCIL_PASS_DEPTH_PASS : GL_STENCIL_BACK_PASS_DEPTH_PASS)};
}

void setStencil(GLenum face, const Face& s) {
  glStencilFuncSeparate(face, GLenum(s.function), s.reference, GLuint(s.mask));
  glStencilMaskSeparate(face, GLuint(s.writeMask));
  glStencilOpSeparate(face, GLenum(s.fail), GLenum(s.depthFail), GLenum(s.pass));
}

} // namespace

struct StateGuard::Saved {
  std::array<bool, std::size(kSwitches)> switches;
  bool old = hasOldState();
  std::array<bool, std::size(kOldSwitches)> oldSwitches;
  std::array<GLint, std::size(kOldClamps)> oldClamps;
  std::array<GLfloat, std::size(kPixelTransfer)> pixelTransfer;
  std::array<GLint, std::size(kPixelStore)> pixelStore;
  std::array<GLint, std::size(kValues)> values;
  std::array<Viewport, kMostViewports> viewports;
  std::array<Target, kMostTargets> targets;
  std::array<Unit, kTextureUnits> units;
  std::array<GLint, std::size(kQueries)> queries;
  std::array<Range, kUniformBindings> uniformBuffers;
  std::array<Range, kStorageBindings> storageBuffers;
  int viewportCount = 0, targetCount = 0;
  GLint clipOrigin = 0, clipDepth = 0, polygonMode[2] = {}, transformFeedback = 0;
  bool feedbackRuns = false;
  Face front, back;
  GLfloat pointSize = 1, color[4] = {};

  int exceptions = std::uncaught_exceptions();

  Saved();
  void restore() const;
  void endWhatWasBegun() const;
};

StateGuard::Saved::Saved() {
  for (size_t i = 0; i < switches.size(); ++i) switches[i] = glIsEnabled(kSwitches[i].what);
  for (size_t i = 0; old && i < oldSwitches.size(); ++i) oldSwitches[i] = glIsEnabled(kOldSwitches[i].what);
  for (size_t i = 0; old && i < oldClamps.size(); ++i) oldClamps[i] = get(kOldClamps[i]);
  for (size_t i = 0; old && i < pixelTransfer.size(); ++i) glGetFloatv(kPixelTransfer[i].what, &pixelTransfer[i]);
  for (size_t i = 0; i < pixelStore.size(); ++i) pixelStore[i] = get(kPixelStore[i].what);
  for (size_t i = 0; i < values.size(); ++i) values[i] = get(kValues[i].what);
  viewportCount = std::min(get(GL_MAX_VIEWPORTS), kMostViewports);
  for (int i = 0; i < viewportCount; ++i) {
    Viewport& v = viewports[size_t(i)];
    glGetFloati_v(GL_VIEWPORT, GLuint(i), v.rectangle);
    glGetDoublei_v(GL_DEPTH_RANGE, GLuint(i), v.depthRange);
    glGetIntegeri_v(GL_SCISSOR_BOX, GLuint(i), v.scissor);
    v.scissored = glIsEnabledi(GL_SCISSOR_TEST, GLuint(i));
  }
  targetCount = std::min(get(GL_MAX_DRAW_BUFFERS), kMostTargets);
  for (int i = 0; i < targetCount; ++i) {
    Target& t = targets[size_t(i)];
    t.blended = glIsEnabledi(GL_BLEND, GLuint(i));
    t.source = get(GL_BLEND_SRC_RGB, i);
    t.destination = get(GL_BLEND_DST_RGB, i);
    t.sourceAlpha = get(GL_BLEND_SRC_ALPHA, i);
    t.destinationAlpha = get(GL_BLEND_DST_ALPHA, i);
    t.equation = get(GL_BLEND_EQUATION_RGB, i);
    t.equationAlpha = get(GL_BLEND_EQUATION_ALPHA, i);
    glGetBooleani_v(GL_COLOR_WRITEMASK, GLuint(i), t.mask);
  }
  for (int i = 0; i < kTextureUnits; ++i) {
    glActiveTexture(GLenum(GL_TEXTURE0 + i));
    for (size_t t = 0; t < std::size(kTextureTargets); ++t) units[size_t(i)].textures[t] = get(kTextureTargets[t]);
    units[size_t(i)].sampler = get(GL_SAMPLER_BINDING);
  }
  for (int i = 0; i < kUniformBindings; ++i)
    uniformBuffers[size_t(i)] =
        Range::of(GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE, i);
  for (int i = 0; i < kStorageBindings; ++i)
    storageBuffers[size_t(i)] =
        Range::of(GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER_START, GL_SHADER_STORAGE_BUFFER_SIZE, i);
  clipOrigin = get(GL_CLIP_ORIGIN);
  clipDepth = get(GL_CLIP_DEPTH_MODE);
  glGetIntegerv(GL_POLYGON_MODE, polygonMode);
  glGetFloatv(GL_POINT_SIZE, &pointSize);
  front = stencilOf(true);
  back = stencilOf(false);
  glGetVertexAttribfv(kColorAttribute, GL_CURRENT_VERTEX_ATTRIB, color);
  for (size_t i = 0; i < queries.size(); ++i) queries[i] = query(kQueries[i]);
  transformFeedback = get(GL_TRANSFORM_FEEDBACK_BINDING);
  feedbackRuns = get(GL_TRANSFORM_FEEDBACK_ACTIVE) && !get(GL_TRANSFORM_FEEDBACK_PAUSED);
  if (feedbackRuns) glPauseTransformFeedback(); // else no other program may be used
  glBindTransformFeedback(GL_TRANSFORM_FEEDBACK, 0);
}

/// By a pass that something was thrown out of.
void StateGuard::Saved::endWhatWasBegun() const {
  if (get(GL_TRANSFORM_FEEDBACK_ACTIVE)) glEndTransformFeedback();
  for (size_t i = 0; i < queries.size(); ++i)
    if (query(kQueries[i]) != queries[i]) glEndQuery(kQueries[i]);
}

void StateGuard::Saved::restore() const {
  if (std::uncaught_exceptions() > exceptions) endWhatWasBegun();
  for (size_t i = 0; i < switches.size(); ++i) set(kSwitches[i].what, switches[i]);
  for (size_t i = 0; old && i < oldSwitches.size(); ++i) set(kOldSwitches[i].what, oldSwitches[i]);
  for (size_t i = 0; old && i < oldClamps.size(); ++i) glClampColor(kOldClamps[i], GLenum(oldClamps[i]));
  for (size_t i = 0; old && i < pixelTransfer.size(); ++i) glPixelTransferf(kPixelTransfer[i].what, pixelTransfer[i]);
  for (size_t i = 0; i < pixelStore.size(); ++i) glPixelStorei(kPixelStore[i].what, pixelStore[i]);
  for (int i = 0; i < viewportCount; ++i) {
    const Viewport& v = viewports[size_t(i)];
    glViewportIndexedfv(GLuint(i), v.rectangle);
    glDepthRangeIndexed(GLuint(i), v.depthRange[0], v.depthRange[1]);
    glScissorIndexedv(GLuint(i), v.scissor);
    set(GL_SCISSOR_TEST, i, v.scissored);
  }
  for (int i = 0; i < targetCount; ++i) {
    const Target& t = targets[size_t(i)];
    const GLuint index = GLuint(i);
    set(GL_BLEND, i, t.blended);
    glBlendFuncSeparatei(index, GLenum(t.source), GLenum(t.destination), GLenum(t.sourceAlpha),
                         GLenum(t.destinationAlpha));
    glBlendEquationSeparatei(index, GLenum(t.equation), GLenum(t.equationAlpha));
    glColorMaski(index, t.mask[0], t.mask[1], t.mask[2], t.mask[3]);
  }
  for (int i = 0; i < kTextureUnits; ++i) {
    const Unit& u = units[size_t(i)];
    glBindTextureUnit(GLuint(i), 0);
    for (const GLint texture : u.textures)
      if (texture != 0) glBindTextureUnit(GLuint(i), GLuint(texture)); // to the target that it is of
    glBindSampler(GLuint(i), GLuint(u.sampler));
  }
  for (int i = 0; i < kUniformBindings; ++i) uniformBuffers[size_t(i)].bind(GL_UNIFORM_BUFFER, i);
  for (int i = 0; i < kStorageBindings; ++i) storageBuffers[size_t(i)].bind(GL_SHADER_STORAGE_BUFFER, i);
  for (size_t i = 0; i < values.size(); ++i) kValues[i].set(values[i]);
  glClipControl(GLenum(clipOrigin), GLenum(clipDepth));
  glPolygonMode(GL_FRONT_AND_BACK, GLenum(polygonMode[0]));
  glPointSize(pointSize);
  setStencil(GL_FRONT, front);
  setStencil(GL_BACK, back);
  glVertexAttrib4fv(kColorAttribute, color);
  glBindTransformFeedback(GL_TRANSFORM_FEEDBACK, GLuint(transformFeedback));
  if (feedbackRuns) glResumeTransformFeedback();
}

void setConventions() {
  for (const Switch& s : kSwitches) set(s.what, s.convention);
  if (hasOldState()) {
    for (const Switch& s : kOldSwitches) set(s.what, s.convention);
    for (const GLenum clamp : kOldClamps) glClampColor(clamp, GL_FALSE);
    for (const PixelTransfer& t : kPixelTransfer) glPixelTransferf(t.what, t.convention);
  }
  for (const PixelStore& p : kPixelStore) glPixelStorei(p.what, p.convention);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  glBindBuffer(GL_QUERY_BUFFER, 0); // else answers go there
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glDepthRange(0, 1);
  glFrontFace(GL_CCW);
  glProvokingVertex(GL_LAST_VERTEX_CONVENTION);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glPointSize(1);
  glBlendEquation(GL_FUNC_ADD);
  for (int unit = 0; unit < kTextureUnits; ++unit) bindSampler(unit, 0);
}

namespace {
thread_local int guards = 0; // around what this thread does
} // namespace

StateGuard::StateGuard() {
  if (guards == 0) {
    saved_ = std::make_unique<Saved>();
    setConventions();
  }
  ++guards;
}

StateGuard::~StateGuard() {
  --guards;
  if (saved_) saved_->restore();
}

CallOut::CallOut() : depth_(std::exchange(guards, 0)) {}
CallOut::~CallOut() { guards = depth_; }

} // namespace lambent::gl
