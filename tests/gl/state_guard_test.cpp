// A host with settings of its own: frames inside its context find their conventions and leave its state as it was.
#include "engine/gl/state_guard.h"
#include "gi/viewer/viewer.h"
#include "gl_fixture.h"
#include "tests/support/images.h"

#include <chrono>
#include <cstring>
#include <map>

namespace lambent::test {

namespace {

using Snapshot = std::map<std::string, std::vector<double>>;

/// Written apart from the guard's own lists, so that what one forgets the other may name.
Snapshot snapshot() {
  Snapshot s;
  const auto number = [&](const char* name, GLenum what, int count = 1) {
    std::vector<double> values(16);
    glGetDoublev(what, values.data());
    values.resize(size_t(count));
    s[name] = values;
  };
  const auto indexed = [&](const std::string& name, GLenum what, int indices, int count = 1) {
    for (int i = 0; i < indices; ++i) {
      std::vector<double> values(16);
      glGetDoublei_v(what, GLuint(i), values.data());
      values.resize(size_t(count));
      s[name + " " + std::to_string(i)] = values;
    }
  };
#define NUMBER(what, ...) number(#what, what __VA_OPT__(, ) __VA_ARGS__)
  NUMBER(GL_CURRENT_PROGRAM), NUMBER(GL_VERTEX_ARRAY_BINDING), NUMBER(GL_DRAW_FRAMEBUFFER_BINDING);
  NUMBER(GL_READ_FRAMEBUFFER_BINDING), NUMBER(GL_VIEWPORT, 4), NUMBER(GL_SCISSOR_BOX, 4), NUMBER(GL_DEPTH_RANGE, 2);
  NUMBER(GL_DEPTH_FUNC), NUMBER(GL_DEPTH_WRITEMASK), NUMBER(GL_COLOR_WRITEMASK, 4), NUMBER(GL_FRONT_FACE);
  NUMBER(GL_CULL_FACE_MODE), NUMBER(GL_CLIP_ORIGIN), NUMBER(GL_CLIP_DEPTH_MODE), NUMBER(GL_POLYGON_MODE);
  NUMBER(GL_POINT_SIZE), NUMBER(GL_LINE_WIDTH), NUMBER(GL_LOGIC_OP_MODE), NUMBER(GL_BLEND_COLOR, 4);
  NUMBER(GL_STENCIL_FUNC), NUMBER(GL_STENCIL_REF), NUMBER(GL_STENCIL_VALUE_MASK), NUMBER(GL_STENCIL_WRITEMASK);
  NUMBER(GL_STENCIL_FAIL), NUMBER(GL_STENCIL_PASS_DEPTH_FAIL), NUMBER(GL_STENCIL_PASS_DEPTH_PASS);
  NUMBER(GL_STENCIL_BACK_FUNC), NUMBER(GL_STENCIL_BACK_REF), NUMBER(GL_STENCIL_BACK_VALUE_MASK);
  NUMBER(GL_STENCIL_BACK_WRITEMASK), NUMBER(GL_STENCIL_BACK_FAIL), NUMBER(GL_STENCIL_BACK_PASS_DEPTH_FAIL);
  NUMBER(GL_STENCIL_BACK_PASS_DEPTH_PASS), NUMBER(GL_COLOR_CLEAR_VALUE, 4), NUMBER(GL_DEPTH_CLEAR_VALUE);
  NUMBER(GL_PACK_ALIGNMENT), NUMBER(GL_PACK_ROW_LENGTH), NUMBER(GL_PACK_SKIP_PIXELS), NUMBER(GL_PACK_SKIP_ROWS);
  NUMBER(GL_UNPACK_ALIGNMENT), NUMBER(GL_UNPACK_ROW_LENGTH), NUMBER(GL_UNPACK_SKIP_PIXELS);
  NUMBER(GL_UNPACK_SKIP_ROWS), NUMBER(GL_UNPACK_IMAGE_HEIGHT), NUMBER(GL_UNPACK_SKIP_IMAGES);
  NUMBER(GL_PIXEL_PACK_BUFFER_BINDING), NUMBER(GL_PIXEL_UNPACK_BUFFER_BINDING), NUMBER(GL_ARRAY_BUFFER_BINDING);
  NUMBER(GL_DRAW_INDIRECT_BUFFER_BINDING), NUMBER(GL_UNIFORM_BUFFER_BINDING), NUMBER(GL_COPY_READ_BUFFER_BINDING);
  NUMBER(GL_SHADER_STORAGE_BUFFER_BINDING), NUMBER(GL_TRANSFORM_FEEDBACK_BINDING), NUMBER(GL_ACTIVE_TEXTURE);
  NUMBER(GL_TRANSFORM_FEEDBACK_ACTIVE), NUMBER(GL_TRANSFORM_FEEDBACK_PAUSED), NUMBER(GL_RENDERBUFFER_BINDING);
#undef NUMBER
  for (const GLenum what : {GL_DEPTH_TEST,
                            GL_DEPTH_CLAMP,
                            GL_STENCIL_TEST,
                            GL_CULL_FACE,
                            GL_FRAMEBUFFER_SRGB,
                            GL_RASTERIZER_DISCARD,
                            GL_PROGRAM_POINT_SIZE,
                            GL_TEXTURE_CUBE_MAP_SEAMLESS,
                            GL_COLOR_LOGIC_OP,
                            GL_PRIMITIVE_RESTART,
                            GL_PRIMITIVE_RESTART_FIXED_INDEX,
                            GL_MULTISAMPLE,
                            GL_SAMPLE_ALPHA_TO_COVERAGE,
                            GL_SAMPLE_COVERAGE,
                            GL_SAMPLE_MASK,
                            GL_SAMPLE_SHADING,
                            GL_POLYGON_OFFSET_FILL,
                            GL_DITHER,
                            GL_CLIP_DISTANCE0,
                            GL_CLIP_DISTANCE3,
                            GL_BLEND,
                            GL_SCISSOR_TEST,
                            GL_DEBUG_OUTPUT})
    s["enabled " + std::to_string(what)] = {double(glIsEnabled(what))};
  indexed("viewport", GL_VIEWPORT, 16, 4), indexed("scissor", GL_SCISSOR_BOX, 16, 4);
  indexed("depth range", GL_DEPTH_RANGE, 16, 2), indexed("blend source", GL_BLEND_SRC_RGB, 8);
  indexed("blend destination", GL_BLEND_DST_ALPHA, 8), indexed("blend equation", GL_BLEND_EQUATION_RGB, 8);
  indexed("color mask", GL_COLOR_WRITEMASK, 8, 4), indexed("uniform buffer", GL_UNIFORM_BUFFER_BINDING, 16);
  indexed("uniform buffer start", GL_UNIFORM_BUFFER_START, 16);
  indexed("uniform buffer size", GL_UNIFORM_BUFFER_SIZE, 16);
  indexed("storage buffer", GL_SHADER_STORAGE_BUFFER_BINDING, 8);
  indexed("storage buffer start", GL_SHADER_STORAGE_BUFFER_START, 8);
  for (GLuint i = 0; i < 16; ++i) s["scissor test " + std::to_string(i)] = {double(glIsEnabledi(GL_SCISSOR_TEST, i))};
  for (GLuint i = 0; i < 8; ++i) s["blend " + std::to_string(i)] = {double(glIsEnabledi(GL_BLEND, i))};
  GLint active = 0;
  glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
  for (int unit = 0; unit < 16; ++unit) {
    glActiveTexture(GLenum(GL_TEXTURE0 + unit));
    for (const GLenum what :
         {GL_TEXTURE_BINDING_1D, GL_TEXTURE_BINDING_2D, GL_TEXTURE_BINDING_3D, GL_TEXTURE_BINDING_2D_ARRAY,
          GL_TEXTURE_BINDING_CUBE_MAP, GL_TEXTURE_BINDING_CUBE_MAP_ARRAY, GL_TEXTURE_BINDING_BUFFER,
          GL_TEXTURE_BINDING_2D_MULTISAMPLE, GL_SAMPLER_BINDING})
      number(("unit " + std::to_string(unit) + " " + std::to_string(what)).c_str(), what);
  }
  glActiveTexture(GLenum(active));
  std::vector<double> attribute(4);
  glGetVertexAttribdv(3, GL_CURRENT_VERTEX_ATTRIB, attribute.data());
  s["attribute 3"] = attribute;
  return s;
}

/// Everything as a host might have it and no pass of ours would.
struct OddHost {
  gl::Texture flat{"host/flat", {.width = 4, .height = 4}};
  gl::Texture array{"host/array", {.kind = gl::TextureKind::Array, .width = 4, .height = 4, .layers = 3}};
  gl::Framebuffer drawn{"host/drawn", {&flat}}, read{"host/read", {&flat}};
  gl::VertexArray vertices{"host/vertices"};
  gl::Sampler sampler{"host/sampler"};
  gl::Buffer buffer{"host/buffer", 4096, nullptr};

  void apply(const gl::Program& program) {
    glUseProgram(program.name());
    glBindVertexArray(vertices.name());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, drawn.name());
    glBindFramebuffer(GL_READ_FRAMEBUFFER, read.name());
    for (const GLenum what :
         {GL_DEPTH_TEST, GL_DEPTH_CLAMP, GL_STENCIL_TEST, GL_CULL_FACE, GL_FRAMEBUFFER_SRGB, GL_PROGRAM_POINT_SIZE,
          GL_COLOR_LOGIC_OP, GL_PRIMITIVE_RESTART, GL_PRIMITIVE_RESTART_FIXED_INDEX, GL_SAMPLE_ALPHA_TO_COVERAGE,
          GL_SAMPLE_COVERAGE, GL_SAMPLE_MASK, GL_POLYGON_OFFSET_FILL, GL_CLIP_DISTANCE0, GL_CLIP_DISTANCE3,
          GL_RASTERIZER_DISCARD})
      glEnable(what);
    for (const GLenum what : {GL_TEXTURE_CUBE_MAP_SEAMLESS, GL_MULTISAMPLE, GL_DITHER}) glDisable(what);
    for (GLuint i = 0; i < 16; ++i) {
      glViewportIndexedf(i, float(i), 2, 3, 4 + float(i));
      glScissorIndexed(i, GLint(i), 1, 2, 3);
      glDepthRangeIndexed(i, 0.25, 0.5 + 0.01 * i);
      i % 2 ? glEnablei(GL_SCISSOR_TEST, i) : glDisablei(GL_SCISSOR_TEST, i);
    }
    for (GLuint i = 0; i < 8; ++i) {
      i % 3 ? glEnablei(GL_BLEND, i) : glDisablei(GL_BLEND, i);
      glBlendFuncSeparatei(i, GL_DST_COLOR, GL_ZERO, GL_ONE, GL_SRC_ALPHA);
      glBlendEquationSeparatei(i, GL_FUNC_REVERSE_SUBTRACT, GL_MAX);
      glColorMaski(i, GL_FALSE, i % 2, GL_TRUE, GL_FALSE);
    }
    glDepthFunc(GL_NOTEQUAL);
    glDepthMask(GL_FALSE);
    glClipControl(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    glFrontFace(GL_CW);
    glCullFace(GL_FRONT);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glPolygonOffset(3, 7);
    glPointSize(5);
    glLogicOp(GL_XOR);
    glSampleCoverage(0.25f, GL_TRUE);
    glSampleMaski(0, 0);
    glPrimitiveRestartIndex(1);
    glStencilFuncSeparate(GL_FRONT, GL_NEVER, 3, 0x0f);
    glStencilFuncSeparate(GL_BACK, GL_GREATER, 5, 0xf0);
    glStencilMaskSeparate(GL_FRONT, 0x33);
    glStencilMaskSeparate(GL_BACK, 0x44);
    glStencilOpSeparate(GL_FRONT, GL_INCR, GL_DECR, GL_INVERT);
    glStencilOpSeparate(GL_BACK, GL_ZERO, GL_KEEP, GL_INCR_WRAP);
    for (const GLenum what : {GL_PACK_ALIGNMENT, GL_UNPACK_ALIGNMENT}) glPixelStorei(what, 8);
    for (const GLenum what :
         {GL_PACK_ROW_LENGTH, GL_PACK_SKIP_PIXELS, GL_PACK_SKIP_ROWS, GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_PIXELS,
          GL_UNPACK_SKIP_ROWS, GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_IMAGES})
      glPixelStorei(what, 3);
    for (const GLenum what : {GL_PIXEL_PACK_BUFFER, GL_PIXEL_UNPACK_BUFFER, GL_DRAW_INDIRECT_BUFFER, GL_ARRAY_BUFFER,
                              GL_COPY_READ_BUFFER, GL_SHADER_STORAGE_BUFFER})
      glBindBuffer(what, buffer.name());
    for (GLuint i = 0; i < 6; ++i) glBindBufferRange(GL_UNIFORM_BUFFER, i, buffer.name(), 256 * i, 256);
    glBindBufferBase(GL_UNIFORM_BUFFER, 2, buffer.name());
    for (GLuint i = 0; i < 3; ++i) glBindBufferRange(GL_SHADER_STORAGE_BUFFER, i, buffer.name(), 256 * (i + 1), 256);
    for (GLuint unit = 0; unit < 16; ++unit) {
      glBindTextureUnit(unit, flat.name());
      glBindTextureUnit(unit, array.name());
      glBindSampler(unit, sampler.name());
    }
    glActiveTexture(GL_TEXTURE5);
    glVertexAttrib4f(3, 0.1f, 0.2f, 0.3f, 0.4f);
  }
  ~OddHost() {
    gl::setConventions();
    for (const GLenum what : {GL_ARRAY_BUFFER, GL_COPY_READ_BUFFER, GL_SHADER_STORAGE_BUFFER, GL_DRAW_INDIRECT_BUFFER})
      glBindBuffer(what, 0);
    for (GLuint i = 0; i < 6; ++i) glBindBufferBase(GL_UNIFORM_BUFFER, i, 0);
    for (GLuint i = 0; i < 3; ++i) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, i, 0);
    for (GLuint unit = 0; unit < 16; ++unit) {
      glBindTextureUnit(unit, 0);
      glBindSampler(unit, 0);
    }
    glActiveTexture(GL_TEXTURE0);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glBindVertexArray(0);
    glUseProgram(0);
    glSampleMaski(0, ~0u);
    gl::PipelineState{.width = 1, .height = 1}.apply();
  }
};

void expectSame(const Snapshot& before, const Snapshot& after) {
  for (const auto& [name, values] : before) EXPECT_EQ(after.at(name), values) << name;
}

} // namespace

class StateGuardTest : public GlTest {
 protected:
  static Settings quick(VplSource source) {
    Settings s;
    s.smc.vpls = s.smc.points = 64;
    s.smc.warmup = 2;
    s.shadow.resolution = 32;
    s.rsm.resolution = 32;
    s.vpl.source = source;
    s.vpl.visibility = source == VplSource::Smc ? VplVisibility::Maps : VplVisibility::None;
    s.gather.mode = source == VplSource::Smc ? GatherMode::Interleaved : GatherMode::Splat;
    s.image.exposure = 1;
    return s;
  }
  struct LitRoom : Room {
    LitRoom() {
      LightView light;
      light.position = vec3(0.3f, 0.6f, 0.5f);
      light.intensity = vec3(1);
      scene.lights.push_back(light);
    }
  };
};

TEST_F(StateGuardTest, AFrameLeavesTheHostsStateAndKeepsToItsOwn) {
  const LitRoom room;
  const gl::Program& program = programs.get({.fragment = "present.frag"});
  for (const auto& [maker, source] :
       {std::pair(ShadowMaker::Rays, VplSource::Smc), std::pair(ShadowMaker::Raster, VplSource::Isr)}) {
    Settings settings = quick(source);
    settings.shadow.maker = maker;
    Viewer alone(settings);
    alone.run(room.scene.view());
    const Image expected = alone.read(Buffer::Beauty);
    const Image8 shown = alone.readDisplay(Buffer::Vpls);

    OddHost host;
    host.apply(program);
    const gl::Texture target("host/target", {.width = 64, .height = 48});
    const gl::Framebuffer framebuffer("host/target", {&target});
    const Snapshot before = snapshot();
    {
      Viewer gi(settings);
      gi.run(room.scene.view());
      expectSame(before, snapshot());
      gi.present(Buffer::Beauty, framebuffer.name(), 64, 48);
      expectSame(before, snapshot());
      EXPECT_EQ(gi.readDisplay(Buffer::Vpls).rgb, shown.rgb);
      const Image picture = gi.read(Buffer::Beauty);
      EXPECT_EQ(std::memcmp(picture.pixels.data(), expected.pixels.data(), picture.pixels.size() * sizeof(vec3)), 0);
    }
    expectSame(before, snapshot());
  }
}

TEST_F(StateGuardTest, TransformFeedbackThatRunsIsPausedMeanwhile) {
  const LitRoom room;
  const gl::Buffer captured("host/captured", 4096, nullptr);
  const gl::TransformFeedback feedback("host/feedback", captured);
  const gl::Program& program = programs.get(
      {.vertex = "splat_refine.vert", .defines = {"FIRST"}, .geometry = "splat_refine.geom", .captured = {"patchOut"}});
  Viewer gi(quick(VplSource::Isr));
  program.use();
  feedback.bind();
  glBeginTransformFeedback(GL_POINTS);
  gi.run(room.scene.view());
  GLint active = 0, paused = 0;
  glGetIntegerv(GL_TRANSFORM_FEEDBACK_ACTIVE, &active);
  glGetIntegerv(GL_TRANSFORM_FEEDBACK_PAUSED, &paused);
  EXPECT_TRUE(active);
  EXPECT_FALSE(paused);
  glEndTransformFeedback();
  gl::TransformFeedback::unbind();
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

TEST_F(StateGuardTest, CostsLittle) {
  const auto begin = std::chrono::steady_clock::now();
  constexpr int kTimes = 200;
  for (int i = 0; i < kTimes; ++i) const gl::StateGuard guard;
  const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
  RecordProperty("guard_us", std::to_string(1000 * ms / kTimes));
  std::printf("a guard takes %.1f us\n", 1000 * ms / kTimes);
  EXPECT_LT(ms / kTimes, 5.0); // far from a frame's time even under sanitizers or a driver that answers slowly
}

} // namespace lambent::test
