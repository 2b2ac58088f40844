// What tests of hosts run in: a context of their own, of the core profile.
#pragma once

#include "contexts.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

namespace lambent::test {

/// Skipped where EGL offers no OpenGL 4.5. A GL error that is left fails the test.
class InHost : public testing::Test {
 protected:
  void SetUp() override {
    context = eglHost();
    if (!context) GTEST_SKIP() << "EGL offers no OpenGL 4.5 here";
    context->makeCurrent();
  }
  void TearDown() override {
    if (!context) return;
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
    context->release();
  }
  std::unique_ptr<HostContext> context;
};

} // namespace lambent::test
