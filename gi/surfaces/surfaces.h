// Surfaces of the image: drawn, or taken over from a host; and the pyramid of their smooth patches.
#pragma once

#include "engine/gl/ring.h"
#include "gi/contract/pass_context.h"
#include "gi/contract/patches.h"
#include "gi/contract/surfaces.h"
#include "gi/plan/settings.h"
#include "gi/surfaces/gpu_scene.h"

namespace lambent {

/// The block of a camera; `orthoFar` is the far plane of an orthographic one, metres.
CameraBlock cameraBlock(const CameraView& camera, float orthoFar);

struct SurfaceInputs {
  const GpuScene& scene;
  const CameraView& camera;
  bool glossy = false;                // with `finish`: the passes that follow then add glossy reflection
  bool normalMaps = false;            // with `mappedNormal`
  const HostSurfaces* host = nullptr; // taken over instead of drawing
  bool keep = false;                  // they are those of the last run
  bool previous = false;              // those of the last run stay too
};

/// Checks a host's surfaces. Throws InputError when a texture is missing or does not hold the camera's image.
void checkHost(const HostSurfaces& host, const CameraView& camera);

class SurfacePass {
 public:
  explicit SurfacePass(PassContext context) : context_(context) {}
  GBuffer run(const SurfaceInputs& in);
  /// The scene is another.
  void forget() { depth_ = {}, before_ = {}; }
  /// Returns depth, normals and camera of the run before, where the last one was asked for it; null the first time, at
  /// another size, and of a host's surfaces.
  const GBuffer* previous() const { return before_.depth ? &before_ : nullptr; }

 private:
  GBuffer adopt(const SurfaceInputs& in);
  void convert(const HostSurfaces& host);
  void keepPrevious(bool any);
  void drawBlended(const SurfaceInputs& in);

  PassContext context_;
  gl::Texture depth_, normal_, albedo_, emission_, finish_, mappedNormal_;
  gl::Texture hosts_[5]; // a host's, with our conventions
  gl::Texture black_;    // emission of a host that has none
  gl::Sampler plain_;    // a host's texture may want mipmaps that it does not have
  gl::Framebuffer framebuffer_;
  gl::Texture blended_, solidDepth_; // the depth of what is behind blended surfaces
  gl::Framebuffer blendedFramebuffer_;
  gl::Ring cameras_{"g-buffer/camera"};
  gl::BufferSlice camera_; // of the last run
  gl::Texture depthBefore_, normalBefore_;
  GBuffer before_;
  CameraBlock block_; // of the last run that drew
};

struct PatchInputs {
  const gl::Texture& depth;  // reversed, affine on planes; 0 where nothing is seen
  const gl::Texture& normal; // unit
  glm::ivec2 size;           // pixels
  glm::ivec2 cell;           // of one map; `size` for an image
  int levels = 0;
  float orthoScale = 0;                             // depth range over half the width of maps by parallel rays
  int orthoFrom = 1 << 20;                          // the first of these, row by row; all before it have a perspective
  PatchCriterion criterion = PatchCriterion::Plane; // as MultiresSettings
  int finest = 1;                                   // pixels, as MultiresSettings
  float depthThreshold, normalThreshold;
  bool balance = true; // as MultiresSettings
  bool edges = true;
};

class PatchPass {
 public:
  PatchPass(PassContext context, StageId stage) : context_(context), stage_(stage), name_(key(stage).name) {}
  PatchPyramid run(const PatchInputs& in);
  /// Makes the pyramid of an image.
  PatchPyramid run(const GBuffer& surfaces, const MultiresSettings& settings);

 private:
  PassContext context_;
  StageId stage_;
  std::string name_;
  gl::Texture plane_, normalLo_, normalHi_;
  std::vector<gl::Framebuffer> framebuffers_; // by mip level
};

} // namespace lambent
