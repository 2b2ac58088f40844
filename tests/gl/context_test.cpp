// Context, objects, programs, profiler.
#include "engine/gl/context.h"
#include "gl_fixture.h"
#include "shader_copy.h"
#include "shaders/shared/light_record.h"
#include "tests/support/files.h"

namespace lambent::test::context_test {

using ContextTest = GlTest;

TEST_F(ContextTest, TellsWhatItIs) {
  const auto info = context().info();
  ASSERT_GE(info.size(), 5u);
  EXPECT_EQ(info[0].first, "route");
  EXPECT_NE(info[0].second.find("EGL"), std::string::npos);
  EXPECT_EQ(context().handle(), nullptr);
}

TEST_F(ContextTest, OnlyTestsHearOfErrorsAtOnce) {
  EXPECT_TRUE(glIsEnabled(GL_DEBUG_OUTPUT_SYNCHRONOUS));
  {
    const GlContext another = GlContext::headless();
    EXPECT_TRUE(glIsEnabled(GL_DEBUG_OUTPUT));
    EXPECT_FALSE(glIsEnabled(GL_DEBUG_OUTPUT_SYNCHRONOUS));
  }
  context().makeCurrent(); // the end of another one leaves it whole
  EXPECT_TRUE(glIsEnabled(GL_DEBUG_OUTPUT_SYNCHRONOUS));
}

TEST_F(ContextTest, TellsWhichDevicesThereAre) {
  for (const DeviceDescription& device : GlContext::devices()) EXPECT_FALSE(device.name.empty());
}

TEST_F(ContextTest, CountsMemoryByOwner) {
  const auto bytesOf = [](const std::string& owner) {
    for (const auto& [name, bytes] : gl::memoryByOwner())
      if (name == owner) return bytes;
    return uint64_t(0);
  };
  {
    const gl::Texture cube(
        "memory test/cube",
        {.kind = gl::TextureKind::CubeArray, .format = GL_DEPTH_COMPONENT32F, .width = 8, .height = 8, .layers = 2});
    gl::Buffer buffer("memory test/buffer", 100, nullptr);
    EXPECT_EQ(bytesOf("memory test"), 8u * 8 * 4 * 12 + 100);
    const gl::Buffer moved = std::move(buffer);
    EXPECT_EQ(bytesOf("memory test"), 8u * 8 * 4 * 12 + 100);
  }
  EXPECT_EQ(bytesOf("memory test"), 0u);
}

TEST_F(ContextTest, DriversOnTheCpuAreNotAskedForMoreThanIsThere) {
  if (!gl::drawnByCpu()) GTEST_SKIP() << "a device has memory of its own";
  const std::string said = messageOf<RunError>([] {
    gl::Texture("memory test/maps",
                {.kind = gl::TextureKind::Array, .format = GL_RGBA32F, .width = 8192, .height = 8192, .layers = 2048});
  });
  EXPECT_NE(said.find("memory test/maps needs 2200 GB of memory, more than is left"), std::string::npos) << said;
}

TEST_F(ContextTest, ProfilerTimesPassesInOrder) {
  profiler.calibrate();
  {
    const gl::PassScope outer(profiler, key(StageId::Direct));
    const gl::PassScope inner(profiler, key(StageId::LightMaps));
  }
  const std::vector<StageTime> rows = profiler.takeRows();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(std::string(rows[0].stage.name), "light maps");
  EXPECT_EQ(std::string(rows[1].stage.name), "direct");
  EXPECT_TRUE(profiler.takeRows().empty());
}

TEST_F(ContextTest, IncludesGoInOnceAndKeepTheirLines) {
  const ShaderCopy folder;
  folder.write("sub/a.glsl", "#include \"b.glsl\"\nfloat a;\n");
  folder.write("sub/b.glsl", "#ifdef __cplusplus\n#include \"only/for/cpp.h\"\n#endif\nfloat b;\n");
  folder.write("main.frag", "#version 450\n#include \"sub/a.glsl\"\n#include \"sub/b.glsl\"\nfloat c;\n");
  const gl::ShaderText shader = gl::loadShader(folder.path, "main.frag", {"VARIANT 3"});
  ASSERT_EQ(shader.files.size(), 3u);
  EXPECT_NE(shader.text.find("#version 450\n#define VARIANT 3\n#line 2 0\n"), std::string::npos);
  EXPECT_NE(shader.text.find("#line 1 2\n#ifdef __cplusplus\n\n#endif\nfloat b;\n"), std::string::npos) << shader.text;
  EXPECT_NE(shader.text.find("#line 2 1\nfloat a;\n"), std::string::npos) << shader.text;
  EXPECT_EQ(shader.text.find("float b;"), shader.text.rfind("float b;"));
  EXPECT_NE(shader.text.find("#line 4 0\nfloat c;"), std::string::npos);
  EXPECT_EQ(shader.text.find("only/for/cpp"), std::string::npos);

  folder.write("broken.frag", "#version 450\n\n#include \"missing.glsl\"\n");
  const std::string error = messageOf<RunError>([&] { gl::loadShader(folder.path, "broken.frag", {}); });
  EXPECT_NE(error.find("broken.frag:3"), std::string::npos) << error;
  EXPECT_NE(error.find("missing.glsl"), std::string::npos) << error;
}

TEST_F(ContextTest, ReloadKeepsTheLastGoodProgram) {
  const ShaderCopy folder;
  const auto color = [](const char* value) {
    return std::string("#version 450\n#include \"value.glsl\"\nlayout(location = 0) out vec4 c;\nvoid main() { c = ") +
           value + "; }\n";
  };
  folder.write("value.glsl", "const float kValue = 0.25;\n");
  folder.write("color.frag", color("vec4(kValue)"));
  gl::ProgramCache cache(folder.path);
  const gl::Program& program = cache.get({.fragment = "color.frag"});
  const gl::Texture target("test", {.format = GL_RGBA32F, .width = 2, .height = 2});
  const gl::Framebuffer framebuffer("test", {&target});
  const auto drawn = [&] {
    framebuffer.bind();
    gl::PipelineState{.width = 2, .height = 2}.apply();
    program.use();
    gl::drawFullscreen();
    return readTexture(target)[0].x;
  };
  EXPECT_EQ(drawn(), 0.25f);
  EXPECT_TRUE(cache.reloadChanged().empty());

  folder.write("color.frag", color("vec4(nonsense)"));
  std::vector<std::string> messages = cache.reloadChanged();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_NE(messages[0].find("color.frag"), std::string::npos) << messages[0];
  EXPECT_NE(messages[0].find("nonsense"), std::string::npos) << messages[0];
  EXPECT_EQ(drawn(), 0.25f);
  EXPECT_TRUE(cache.reloadChanged().empty()) << "a broken file is tried again only when it changes";

  folder.write("color.frag", color("vec4(2.0 * kValue)"));
  folder.write("value.glsl", "const float kValue = 0.5;\n");
  messages = cache.reloadChanged();
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(drawn(), 1.0f);
}

TEST_F(ContextTest, FirstCompileFailureIsARunErrorWithTheLog) {
  const ShaderCopy folder;
  folder.write("bad.frag", "#version 450\nvoid main() { undeclared = 1; }\n");
  gl::ProgramCache cache(folder.path);
  const std::string error = messageOf<RunError>([&] { cache.get({.fragment = "bad.frag"}); });
  EXPECT_NE(error.find("undeclared"), std::string::npos) << error;
  folder.write("bad.frag", "#version 450\nlayout(location = 0) out vec4 c;\nvoid main() { c = vec4(1); }\n");
  EXPECT_NO_THROW(cache.get({.fragment = "bad.frag"}));
}

/// Byte offset of a member of a uniform block, as the compiler laid it out.
int offsetOf(const gl::Program& program, const char* member) {
  const GLuint index = glGetProgramResourceIndex(program.name(), GL_UNIFORM, member);
  EXPECT_NE(index, GL_INVALID_INDEX) << member;
  const GLenum property = GL_OFFSET;
  GLint offset = -1;
  glGetProgramResourceiv(program.name(), GL_UNIFORM, index, 1, &property, 1, nullptr, &offset);
  return offset;
}

TEST_F(ContextTest, BlocksLieInMemoryAsTheShadersReadThem) {
  const gl::Program& gather = programs.get({.fragment = "gather.frag", .defines = {"SHADOWS"}});
  EXPECT_EQ(offsetOf(gather, "lights[0].powerNormalX"), int(offsetof(VplLight, powerNormalX)));
  EXPECT_EQ(offsetOf(gather, "lights[0].bitangentNormalZ"), int(offsetof(VplLight, bitangentNormalZ)));
  EXPECT_EQ(offsetOf(gather, "camera.worldFromView"), int(offsetof(CameraBlock, worldFromView)));
  EXPECT_EQ(offsetOf(gather, "camera.lens"), int(offsetof(CameraBlock, lens)));
  EXPECT_EQ(offsetOf(gather, "camera.size"), int(offsetof(CameraBlock, size)));
  const gl::Program& doubts = programs.get({.fragment = "direct.frag", .defines = {"SPOT_MAPS", "DOUBTS"}});
  EXPECT_EQ(offsetOf(doubts, "camera.depthError"), int(offsetof(CameraBlock, depthError)));

  const gl::Program& direct = programs.get({.fragment = "direct.frag", .defines = {"SPOT_MAPS"}});
  EXPECT_EQ(offsetOf(direct, "lights[0].directionTexel"), int(offsetof(LightRecord, directionTexel)));
  EXPECT_EQ(offsetOf(direct, "lights[0].coneNear"), int(offsetof(LightRecord, coneNear)));
  EXPECT_EQ(offsetOf(direct, "lights[0].mapFromWorld"), int(offsetof(LightRecord, mapFromWorld)));

  const gl::Program& surface = programs.get(
      {.vertex = "scene.vert", .fragment = "gbuffer.frag", .defines = {"BASE_TEXTURE", "EMISSIVE_TEXTURE"}});
  EXPECT_EQ(offsetOf(surface, "material.emission"), int(offsetof(MaterialBlock, emission)));
  EXPECT_EQ(offsetOf(surface, "material.baseUvV"), int(offsetof(MaterialBlock, baseUvV)));
  EXPECT_EQ(offsetOf(surface, "material.emissiveUvV"), int(offsetof(MaterialBlock, emissiveUvV)));
}

} // namespace lambent::test::context_test
