// A world in which anything may happen between two frames, the same for the same seed. It is held in a Scene and seen
// through the engine's own extraction, so what is said to have moved or changed is what the engine says.
#pragma once

#include "engine/scene/scene.h"
#include "tests/support/hand_scene.h"

#include <glm/gtc/matrix_transform.hpp>

namespace lambent::test {

/// A closed room of 6×3×6 m. In it boxes (the first a lamp, the last one morphed), sheets (the second one morphed, the
/// third skinned), a lamp, a spot and a sun that is out at first. Objects overlap, touch and pass through each other
/// and the walls.
class RandomWorld {
 public:
  static constexpr int kBoxes = 26, kSheets = 3;

  /// A closed rigid box, as it is shown now.
  struct Solid {
    uint32_t id = 0; // InstanceView::id
    mat4 worldFromObject{1}, objectFromWorld{1};
    vec3 halfSize{0}; // object space
  };

  /// `gap`: metres that objects which touch stay apart. At 0 faces coincide, and which of them a ray meets may change
  /// with every move of anything else.
  explicit RandomWorld(float gap = 0, uint32_t seed = 11) : random_(seed, Stream::Test, 0), gap_(gap) {
    HandScene made;
    const uint32_t wall = made.material({0.7f, 0.6f, 0.5f}), body = made.material({0.3f, 0.6f, 0.4f}, vec3(0), true),
                   lamp = made.material(vec3(0.2f), vec3(20), true);
    made.box(kRoomLo, kRoomHi, wall, true);
    firstBox_ = uint32_t(made.assets.meshes.size());
    for (int i = 0; i < kBoxes; ++i) {
      const vec3 halfSize = 0.1f + 0.5f * number3();
      made.assets.meshes.push_back(block(halfSize, i == 0 ? lamp : body));
      objects_.push_back({.mesh = uint32_t(made.assets.meshes.size() - 1), .halfSize = halfSize, .closed = true});
    }
    addMorphs(made.assets.meshes.back());
    objects_.back().kind = Kind::Morphed;
    for (int i = 0; i < kSheets; ++i) {
      Mesh mesh = sheet(6, body);
      if (i == 1) addMorphs(mesh);
      if (i == 2) addJoints(mesh);
      made.assets.meshes.push_back(std::move(mesh));
      objects_.push_back({.kind = i == 1   ? Kind::Morphed
                                  : i == 2 ? Kind::Skinned
                                           : Kind::Rigid,
                          .mesh = uint32_t(made.assets.meshes.size() - 1),
                          .halfSize = vec3(1, 1, 0.01f),
                          .scale = vec3(0.5f)});
    }
    scene_.assets = std::move(made.assets);
    for (const InstanceView& i : made.instances) {
      const Entity e = walls_.emplace_back(scene_.registry.create());
      scene_.registry.emplace<MeshInstance>(e, i.mesh);
      scene_.registry.emplace<WorldTransform>(e, mat4(1));
    }
    for (Object& o : objects_) {
      o.at = place();
      show(o);
    }
    addLights();
    camera_ = lookAt({0, 1.6f, 2.5f}, {0, 1, 0}, 1);
    rays_ = std::make_unique<EmbreeQuery>(scene_.assets);
  }

  /// The next frame after `edits` random changes. Valid until the next call.
  const SceneView& step(int edits) {
    for (int i = 0; i < edits; ++i) edit();
    view_ = extractor_.extract(scene_, camera_, 0);
    rays_->update(view_);
    return view_;
  }
  const SceneAssets& assets() const { return scene_.assets; }
  const EmbreeQuery& rays() const { return *rays_; }

  bool isWall(uint32_t id) const {
    return std::any_of(walls_.begin(), walls_.end(), [id](Entity e) { return e.id() == id; });
  }
  /// The closed rigid boxes in the present view.
  std::vector<Solid> solids() const {
    std::vector<Solid> out;
    for (const InstanceView& i : view_.instances)
      if (!i.deformed && i.mesh >= firstBox_ && i.mesh < firstBox_ + kBoxes)
        out.push_back(
            {i.id, i.worldFromObject, glm::inverse(i.worldFromObject), scene_.assets.meshes[i.mesh].boundsObject.hi});
    return out;
  }

 private:
  enum class Kind : uint8_t { Rigid, Morphed, Skinned };
  struct Object {
    Kind kind = Kind::Rigid;
    uint32_t mesh = 0;
    vec3 halfSize{0}; // of the mesh
    bool closed = false;
    Entity entity{}; // none while `shown` is false, unless it only lost its mesh
    bool shown = false;
    vec3 at{0};
    quat turn{1, 0, 0, 0};
    vec3 scale{1};
    std::vector<Entity> joints{};
  };
  static constexpr vec3 kRoomLo{-3, 0, -3}, kRoomHi{3, 3, 3};

  float number() { return random_.next(); }
  vec3 number3() {
    const float x = number(), y = number();
    return {x, y, number()};
  }
  lambent::Sky randomSky() {
    const float what = number();
    if (what < 0.4f) return {};
    if (what < 0.7f) return number3();
    return Sky::daylight(glm::normalize(number3() - vec3(0.5f, 0.1f, 0.5f)), 2 + 6 * number());
  }
  vec3 place() { return glm::mix(kRoomLo + 0.3f, kRoomHi - 0.3f, number3()); }
  quat turned(float most) { return glm::angleAxis(most * (2 * number() - 1), glm::normalize(number3() + 0.01f)); }
  Object& anyObject() { return objects_[random_.below(uint32_t(objects_.size()))]; }

  /// Waves, and a lean to one side.
  static void addMorphs(Mesh& mesh) {
    MorphTarget wave, lean;
    const std::vector<vec3> waved = waves(mesh, 0.2f, 1);
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      wave.positions.push_back(waved[i] - mesh.positions[i]);
      lean.positions.push_back(vec3(0.5f * mesh.positions[i].y, 0, 0.3f * mesh.positions[i].x));
    }
    mesh.morphTargets = {wave, lean};
  }
  /// Two joints, blended along x.
  static void addJoints(Mesh& mesh) {
    JointSet set;
    for (const vec3& p : mesh.positions) {
      const float w = glm::clamp(0.5f + 0.5f * p.x, 0.0f, 1.0f);
      set.joints.push_back({0, 1, 0, 0});
      set.weights.push_back({w, 1 - w, 0, 0});
    }
    mesh.jointSets.push_back(set);
  }

  void addLights() {
    for (const LightType type : {LightType::Point, LightType::Spot, LightType::Directional}) {
      const Entity e = scene_.registry.create();
      PunctualLight light;
      light.type = type;
      light.intensity = type == LightType::Directional ? vec3(0) : vec3(8, 7, 6);
      scene_.registry.emplace<PunctualLight>(e, light);
      scene_.registry.emplace<WorldTransform>(e, lightPose(place()));
      lights_.push_back(e);
    }
  }
  mat4 lightPose(const vec3& at) {
    return glm::translate(mat4(1), at) * glm::mat4_cast(rotationTowards(vec3(number() - 0.5f, -1, number() - 0.5f)));
  }

  void show(Object& o) {
    Registry& r = scene_.registry;
    if (!r.valid(o.entity)) {
      o.entity = r.create();
      r.emplace<WorldTransform>(o.entity);
      if (o.kind == Kind::Morphed) r.emplace<MorphWeights>(o.entity, std::vector<float>{0, 0});
      if (o.kind == Kind::Skinned) {
        Skin skin;
        for (int j = 0; j < 2; ++j) {
          skin.joints.push_back(r.create());
          r.emplace<WorldTransform>(skin.joints.back());
        }
        skin.jointFromBind.assign(2, mat4(1));
        o.joints = skin.joints;
        r.emplace<Skin>(o.entity, std::move(skin));
      }
    }
    r.emplace<MeshInstance>(o.entity, o.mesh);
    o.shown = true;
    move(o);
  }

  void hide(Object& o) {
    o.shown = false;
    if (number() < 0.5f) return scene_.registry.remove<MeshInstance>(o.entity); // it will come back as itself
    for (const Entity j : o.joints) scene_.registry.destroy(j);
    o.joints.clear();
    scene_.registry.destroy(o.entity);
  }

  static mat4 matrix(const vec3& at, const quat& turn, const vec3& scale) {
    return glm::scale(glm::translate(mat4(1), at) * glm::mat4_cast(turn), scale);
  }
  void move(const Object& o) {
    if (!scene_.registry.valid(o.entity)) return;
    scene_.registry.get<WorldTransform>(o.entity).worldFromNode = matrix(o.at, o.turn, o.scale);
    for (const Entity j : o.joints)
      scene_.registry.get<WorldTransform>(j).worldFromNode = matrix(o.at, o.turn, o.scale);
  }

  void edit() {
    const float what = number();
    if (what < 0.30f) return wander(anyObject());
    if (what < 0.36f) return teleport(anyObject());
    if (what < 0.44f) return touch(anyObject());
    if (what < 0.49f) return rescale(anyObject());
    if (what < 0.50f) return swapMesh(objects_[1 + random_.below(kBoxes - 2)]);
    if (what < 0.58f) return deformOne();
    if (what < 0.70f) return relight();
    if (what < 0.73f) return void(scene_.sky = randomSky());
    if (what < 0.86f) return moveCamera();
    Object& o = anyObject();
    if (what < 0.89f && o.shown) hide(o);
    if (what >= 0.89f && !o.shown) show(o);
  }

  void wander(Object& o) {
    o.at = glm::clamp(o.at + 0.2f * (number3() - 0.5f), kRoomLo, kRoomHi);
    o.turn = glm::normalize(turned(0.3f) * o.turn);
    move(o);
  }
  void teleport(Object& o) {
    o.at = place();
    o.turn = turned(kPi);
    move(o);
  }
  /// Face to face with another object, or upright against the floor, the ceiling or a wall.
  void touch(Object& o) {
    const int axis = int(random_.below(3));
    const float side = number() < 0.5f ? -1.0f : 1.0f;
    const Object& other = anyObject();
    if (&other != &o && number() < 0.5f) {
      o.turn = other.turn;
      vec3 step(0);
      step[axis] = side * (o.halfSize[axis] * o.scale[axis] + other.halfSize[axis] * other.scale[axis] + gap_);
      o.at = other.at + other.turn * step;
    } else {
      o.turn = {1, 0, 0, 0};
      o.at[axis] = (side < 0 ? kRoomLo : kRoomHi)[axis] - side * (o.halfSize[axis] * o.scale[axis] + gap_);
    }
    move(o);
  }
  /// To another size, to a point, flat, or to next to nothing; mostly back from there.
  void rescale(Object& o) {
    const float what = number();
    const vec3 usual(o.closed ? 1.0f : 0.5f);
    if (o.scale != usual && what < 0.8f)
      o.scale = usual;
    else if (what < 0.2f)
      o.scale = vec3(0);
    else if (what < 0.3f)
      o.scale[random_.below(3)] = 0;
    else if (what < 0.4f)
      o.scale = vec3(1e-3f);
    else
      o.scale = usual * (0.5f + number3());
    move(o);
  }
  /// A box other than the lamp becomes another, as with levels of detail or things that break.
  void swapMesh(Object& o) {
    o.mesh = firstBox_ + 1 + random_.below(kBoxes - 2);
    o.halfSize = scene_.assets.meshes[o.mesh].boundsObject.hi;
    if (o.shown) scene_.registry.get<MeshInstance>(o.entity).mesh = o.mesh;
  }
  /// Another pose; morphed ones now and then lose their weights altogether and are rigid for a while.
  void deformOne() {
    Object& o = objects_[objects_.size() - 1 - random_.below(kSheets + 1)];
    if (!scene_.registry.valid(o.entity)) return;
    if (o.kind == Kind::Morphed && number() < 0.2f)
      scene_.registry.remove<MorphWeights>(o.entity);
    else if (o.kind == Kind::Morphed)
      scene_.registry.emplace<MorphWeights>(o.entity, std::vector<float>{number() < 0.3f ? 0 : number(), number()});
    for (const Entity j : o.joints)
      scene_.registry.get<WorldTransform>(j).worldFromNode =
          matrix(o.at + 0.2f * (number3() - 0.5f), turned(0.5f) * o.turn, o.scale);
  }
  void relight() {
    const Entity e = lights_[random_.below(uint32_t(lights_.size()))];
    dmat4& pose = scene_.registry.get<WorldTransform>(e).worldFromNode;
    const float what = number();
    if (what < 0.4f)
      pose = lightPose(vec3(pose[3]) + 0.3f * (number3() - 0.5f));
    else if (what < 0.55f)
      pose = lightPose(place());
    else
      scene_.registry.get<PunctualLight>(e).intensity = what < 0.7f ? vec3(0) : 8.0f * number3();
  }
  void moveCamera() {
    if (number() < 0.15f) { // a cut
      camera_ = lookAt(place(), place(), 1);
      return;
    }
    const vec3 eye = glm::clamp(camera_.position() + 0.2f * (number3() - 0.5f), kRoomLo + 0.2f, kRoomHi - 0.2f);
    const quat turn = turned(0.1f) * glm::quat_cast(mat3(camera_.worldFromView));
    camera_.worldFromView = glm::translate(mat4(1), eye) * glm::mat4_cast(glm::normalize(turn));
  }

  Rng random_;
  const float gap_;
  Scene scene_;
  std::vector<Object> objects_; // boxes, then sheets
  uint32_t firstBox_ = 0;       // mesh
  std::vector<Entity> walls_, lights_;
  CameraView camera_;
  SceneExtractor extractor_;
  SceneView view_;
  std::unique_ptr<EmbreeQuery> rays_; // after the meshes are there
};

} // namespace lambent::test
