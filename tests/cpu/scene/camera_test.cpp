// Camera conventions: rays, projection and placement must tell the same story.

#include "tests/cpu/scene/support.h"

#include <algorithm>

namespace lambent::test::camera_test {

CameraView tiltedCamera() {
  CameraView camera = lookAt({1, 2, 3}, {-4, 0.5f, 2}, 0.9f);
  camera.width = 400;
  camera.height = 300;
  return camera;
}

TEST(Camera, CentreRayLooksAtTheTargetAndCornersAreWhereTheyShould) {
  CameraView camera; // at the origin, along -Z
  camera.width = 200;
  camera.height = 100;
  camera.fovY = kPi / 2;
  expectNear(cameraRay(camera, 0.5f, 0.5f).direction, {0, 0, -1});
  expectNear(cameraRay(camera, 0, 0).direction, glm::normalize(vec3(-2, 1, -1))); // left, top
  expectNear(cameraRay(camera, 1, 1).direction, glm::normalize(vec3(2, -1, -1))); // right, bottom
  camera.fovY = 2 * std::atan(0.5f);
  expectNear(cameraRay(camera, 0, 0).direction, glm::normalize(vec3(-1, 0.5f, -1)));
  expectNear(cameraRay(camera, 1, 1).direction, glm::normalize(vec3(1, -0.5f, -1)));
  const CameraRay ray = cameraRay(tiltedCamera(), 0.5f, 0.5f);
  expectNear(ray.origin, {1, 2, 3});
  expectNear(ray.direction, glm::normalize(vec3(-5, -1.5f, -1)));
}

TEST(Camera, ProjectionPutsPointsOfARayAtItsPicturePoint) {
  CameraView perspective = tiltedCamera(), ortho = tiltedCamera();
  perspective.near = 0.1f;
  ortho.orthoHalfHeight = 1.5f;
  for (const CameraView& camera : {perspective, ortho})
    for (const vec2 uv : {vec2(0.5f, 0.5f), vec2(0, 0), vec2(1, 0), vec2(0.2f, 0.9f)}) {
      const CameraRay ray = cameraRay(camera, uv.x, uv.y);
      EXPECT_NEAR(glm::length(ray.direction), 1, 1e-5f);
      const vec4 view = glm::inverse(camera.worldFromView) * vec4(ray.origin + 7.0f * ray.direction, 1);
      const vec4 clip = clipFromView(camera) * view;
      EXPECT_NEAR(clip.x / clip.w, 2 * uv.x - 1, 1e-4f);
      EXPECT_NEAR(clip.y / clip.w, 1 - 2 * uv.y, 1e-4f);
    }
}

TEST(Camera, DepthIsReversedFromOneToZero) {
  CameraView camera;
  camera.near = 0.25f;
  const auto depth = [&](float distance) {
    const vec4 clip = clipFromView(camera, 100) * vec4(0, 0, -distance, 1);
    return clip.z / clip.w;
  };
  EXPECT_FLOAT_EQ(depth(0.25f), 1);
  EXPECT_FLOAT_EQ(depth(0.5f), 0.5f); // near / distance
  EXPECT_NEAR(depth(1e7f), 0, 1e-6f);
  camera.orthoHalfHeight = 2;
  EXPECT_NEAR(depth(0.25f), 1, 1e-6f);
  EXPECT_NEAR(depth(100), 0, 1e-6f);
  EXPECT_NEAR(depth(50.125f), 0.5f, 1e-6f);
}

TEST(Camera, LookAtIsRigidAndUprightAlsoStraightDown) {
  for (const vec3 target : {vec3(3, 1, 2), vec3(0, -5, 0), vec3(0, 5, 0), vec3(0, 0, 0)}) {
    const mat3 r(lookAt({0, 0, 0}, target, 1).worldFromView);
    EXPECT_NEAR(glm::determinant(r), 1, 1e-5f);
    EXPECT_NEAR(glm::length(r[0]), 1, 1e-5f);
    if (glm::length(target) > 0) expectNear(-r[2], glm::normalize(target));
    EXPECT_NEAR(r[0].y, 0, 1e-6f); // right is level
    EXPECT_GE(r[1].y, -1e-6f);
  }
}

TEST(Camera, FileCamerasLoseScaleAndMirroring) {
  TemporaryFolder folder;
  GltfBuilder b = oneTriangle();
  b.json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.2}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0.01}, {"zfar", 50}}}}};
  b.addRoot({{"name", "main"}, {"camera", 0}, {"translation", {1, 2, 3}}, {"scale", {-2, 2, 2}}});
  b.addRoot({{"camera", 1}});
  const Scene scene = b.load(folder);
  const auto cameras = sceneCameras(scene);
  ASSERT_EQ(cameras.size(), 2u);
  EXPECT_EQ(cameras[0].name, "main");
  EXPECT_EQ(cameras[1].name, "camera 1");
  EXPECT_FLOAT_EQ(cameras[0].view.fovY, 0.7f);
  EXPECT_FLOAT_EQ(cameras[0].view.near, 0.2f);
  EXPECT_FLOAT_EQ(cameras[1].view.orthoHalfHeight, 2);
  expectNear(cameras[0].view.position(), {1, 2, 3});
  EXPECT_NEAR(glm::determinant(mat3(cameras[0].view.worldFromView)), 1, 1e-5f);
  expectNear(-vec3(cameras[0].view.worldFromView[2]), {0, 0, -1});
  expectNear(vec3(cameras[0].view.worldFromView[1]), {0, 1, 0});
}

/// A box of 10 x 4 x 6 m whose faces' fronts are inside (a room) or outside (an object); without the side at +Z when
/// `open`.
GltfBuilder box(bool inward, bool open) {
  GltfBuilder b;
  std::vector<vec3> corners;
  for (int i = 0; i < 8; ++i) corners.push_back(vec3(i & 1 ? 5 : -5, i & 2 ? 4 : 0, i & 4 ? 3 : -3));
  std::vector<uint16_t> indices = {0, 2, 3, 0, 3, 1, 0, 4, 6, 0, 6, 2, 1, 3, 7,
                                   1, 7, 5, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3};
  if (!open) indices.insert(indices.end(), {4, 5, 7, 4, 7, 6});
  if (inward)
    for (size_t i = 0; i < indices.size(); i += 3) std::swap(indices[i + 1], indices[i + 2]);
  const int positions = b.positions(corners);
  b.addMeshNode({{"attributes", {{"POSITION", positions}}}, {"indices", b.indices(indices)}});
  return b;
}

TEST(DefaultView, ObjectsAreSeenFromOutside) {
  TemporaryFolder folder;
  const Scene scene = box(false, false).load(folder);
  const Aabb bounds = worldBounds(scene);
  for (const auto& [width, height] : {std::pair(320, 180), {100, 100}, {90, 160}, {400, 100}}) {
    CameraView view = defaultView(scene, float(width) / float(height));
    view.width = width, view.height = height;
    EXPECT_GT(view.position().z, bounds.hi.z); // from the front, to the right and above
    EXPECT_GT(view.position().x, bounds.centre().x);
    EXPECT_GT(view.position().y, bounds.centre().y);
    vec2 lo(kInfinity), hi(-kInfinity);
    for (int i = 0; i < 8; ++i) {
      const vec3 corner(i & 1 ? bounds.hi.x : bounds.lo.x, i & 2 ? bounds.hi.y : bounds.lo.y,
                        i & 4 ? bounds.hi.z : bounds.lo.z);
      const vec4 clip = clipFromView(view) * glm::inverse(view.worldFromView) * vec4(corner, 1);
      ASSERT_GT(clip.w, view.near);
      lo = glm::min(lo, vec2(clip) / clip.w);
      hi = glm::max(hi, vec2(clip) / clip.w);
    }
    const int widest = width >= 2 * height && width != 320 ? 1 : 0; // of a box of 10 x 4 x 6 m
    EXPECT_NEAR(hi[widest], 0.9f, 1e-3f) << width;
    EXPECT_NEAR(lo[widest], -0.9f, 1e-3f) << width;
    EXPECT_LT(hi[1 - widest], 0.9f) << width;
    EXPECT_GT(lo[1 - widest], -0.9f) << width;
  }
}

TEST(DefaultView, RoomsAreSeenFromInsideAtEyeHeightAlongTheLongerAxis) {
  TemporaryFolder folder;
  const Scene scene = box(true, false).load(folder);
  const CameraView view = defaultView(scene);
  EXPECT_NEAR(view.position().y, 1.6f, 1e-3f);
  EXPECT_LT(view.position().x, -3);
  EXPECT_GT(view.position().x, -5);
  expectNear(-vec3(view.worldFromView[2]), {1, 0, 0});
}

/// Shells of 10 x 4 x 6 m times each scale about the same middle, of many small triangles; in this order.
GltfBuilder shells(const std::vector<float>& scales, int cells = 8) {
  GltfBuilder b;
  std::vector<vec3> corners;
  for (int side = 0; side < 6; ++side)
    for (int i = 0; i < cells * cells; ++i) {
      const auto corner = [&](int u, int v) {
        vec3 p(0);
        p[side / 2] = side % 2 ? 1 : -1;
        p[(side / 2 + 1) % 3] = 2 * float(i % cells + u) / float(cells) - 1;
        p[(side / 2 + 2) % 3] = 2 * float(i / cells + v) / float(cells) - 1;
        return p * vec3(5, 2, 3);
      };
      const vec3 p00 = corner(0, 0), p10 = corner(1, 0), p11 = corner(1, 1), p01 = corner(0, 1);
      if (side % 2)
        corners.insert(corners.end(), {p00, p11, p10, p00, p01, p11});
      else
        corners.insert(corners.end(), {p00, p10, p11, p00, p11, p01});
    }
  const int mesh = b.push("meshes", {{"primitives", {{{"attributes", {{"POSITION", b.positions(corners)}}}}}}});
  for (const float scale : scales) b.addRoot({{"mesh", mesh}, {"scale", {scale, scale, scale}}});
  return b;
}

TEST(DefaultView, MeetsWhatIsNearestWhereverItStandsInTheFile) {
  TemporaryFolder folder;
  const CameraView near = defaultView(shells({1, 1.25f}).load(folder)),
                   far = defaultView(shells({1.25f, 1}).load(folder));
  EXPECT_EQ(near.worldFromView, far.worldFromView);
  EXPECT_LT(std::abs(near.position().x), 5) << "inside the inner one";
  EXPECT_GT(std::abs(near.position().x), 3);
}

/// Those behind one another may be met by every look where the nearest comes last: more than are kept at once.
TEST(DefaultView, IsTheSameOfMoreThanAreKeptAtOnce) {
  TemporaryFolder folder;
  std::vector<float> scales;
  for (int i = 0; i < 24; ++i) scales.push_back(1 + 0.01f * float(i));
  const CameraView near = defaultView(shells(scales, 60).load(folder));
  std::ranges::reverse(scales);
  EXPECT_EQ(defaultView(shells(scales, 60).load(folder)).worldFromView, near.worldFromView);
  EXPECT_LT(std::abs(near.position().x), 5);
}

/// A street between high houses is no room: what its sky is above says nothing of units.
TEST(DefaultView, AStreetIsNoRoom) {
  TemporaryFolder folder;
  GltfBuilder b;
  const auto slab = [&](vec3 lo, vec3 hi) {
    std::vector<vec3> corners;
    for (int i = 0; i < 8; ++i) corners.push_back(vec3(i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z));
    const int positions = b.positions(corners);
    b.addMeshNode({{"attributes", {{"POSITION", positions}}},
                   {"indices", b.indices(std::vector<uint16_t>{0, 2, 3, 0, 3, 1, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0,
                                                               1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 4, 5, 7, 4, 7, 6})}});
  };
  slab({-150, -1, -150}, {150, 0, 150});
  for (const float x : {-110.0f, -35.0f, 35.0f, 110.0f}) slab({x - 20, 0, -150}, {x + 20, 150, 150});
  EXPECT_FALSE(roomHeight(b.load(folder)).has_value());
  slab({-150, 150, -150}, {150, 151, 150});
  EXPECT_NEAR(roomHeight(b.load(folder)).value_or(0), 150, 1) << "with a roof it is one";
}

/// A room told in centimetres is as high as it says, and rescaled it is the room told in metres: places, lights,
/// cameras and what is animated.
TEST(DefaultView, ARoomInCentimetresIsRescaled) {
  TemporaryFolder folder;
  EXPECT_FALSE(roomHeight(box(false, false).load(folder)).has_value()) << "an object";
  EXPECT_NEAR(roomHeight(box(true, false).load(folder)).value(), 4, 1e-3f);
  const auto roomOf = [&](float unit) {
    GltfBuilder b = box(true, false);
    b.json["nodes"][0]["scale"] = {unit, unit, unit};
    const int mover = b.addMeshNode(b.json["meshes"][0]["primitives"][0]);
    b.json["nodes"][mover]["scale"] = {0.1 * unit, 0.1 * unit, 0.1 * unit};
    b.animate(mover, "translation", b.floats({0, 1}), b.floats({0, unit, 0, 2 * unit, unit, 0}, "VEC3"));
    b.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.2 * unit}}}}};
    b.addRoot({{"camera", 0}, {"translation", {unit, 2 * unit, 0}}});
    b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"range", 3 * unit}}};
    b.addRoot({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}, {"translation", {0, 3 * unit, 0}}});
    return b.load(folder);
  };
  Scene metres = roomOf(1), centimetres = roomOf(100);
  EXPECT_NEAR(roomHeight(centimetres).value(), 400, 0.1f);
  rescale(centimetres, 0.01f);
  EXPECT_NEAR(roomHeight(centimetres).value(), 4, 1e-3f);
  for (const double time : {0.0, 0.5, 0.9}) {
    animate(metres, time);
    animate(centimetres, time);
    SceneExtractor a, b;
    const SceneView wanted = a.extract(metres, defaultView(metres), time),
                    got = b.extract(centimetres, defaultView(centimetres), time);
    expectNear(got.camera.position(), wanted.camera.position());
    ASSERT_EQ(got.instances.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
      expectNear(got.instances[i].boundsWorld.lo, wanted.instances[i].boundsWorld.lo);
      expectNear(got.instances[i].boundsWorld.hi, wanted.instances[i].boundsWorld.hi);
    }
    ASSERT_EQ(got.lights.size(), 1u);
    expectNear(got.lights[0].position, wanted.lights[0].position);
    EXPECT_NEAR(got.lights[0].range, 3, 1e-4f);
    EXPECT_NEAR(sceneCameras(centimetres).at(0).view.near, 0.2f, 1e-4f);
    expectNear(sceneCameras(centimetres).at(0).view.position(), {1, 2, 0});
  }
}

TEST(DefaultView, StagesAreSeenThroughTheirOpenSide) {
  TemporaryFolder folder;
  const CameraView view = defaultView(box(true, true).load(folder));
  expectNear(-vec3(view.worldFromView[2]), {0, 0, -1});
  EXPECT_GT(view.position().z, 3);
  EXPECT_NEAR(view.position().y, 2, 1e-4f);
}

} // namespace lambent::test::camera_test
