// Random calls with wrong handles, sizes, values and orders: each ends in a status, and the room still renders.
// LAMBENT_RANDOM_CALLS: how many (default 4000); LAMBENT_RANDOM_SEED.
#include "room.h"
#include "tests/host/contexts.h"

#include <cstdlib>
#include <cstring>
#include <random>

namespace lambent::test {

namespace {

class Caller {
 public:
  Caller(const Room& room, uint32_t seed) : room_(room), random_(seed) { view_ = room.view(8, 6); }

  void call() {
    lambent_device* const d = one(200)   ? nullptr
                              : one(200) ? reinterpret_cast<lambent_device*>(size_t(16))
                                         : room_.device;
    const lambent_scene scene = any(scenes_);
    switch (below(24)) {
    case 0: {
      lambent_scene made = 0;
      if (scenes_.size() < 6) keep(lambent_scene_create(d, out(&made)), made, scenes_);
      break;
    }
    case 1:
      if (one(8)) lambent_scene_destroy(d, any(scenes_)); // the room's own among them: a later call makes do without
      break;
    case 2: {
      lambent_texture_desc t = desc<lambent_texture_desc>(LAMBENT_TEXTURE_DESC);
      t.width = size();
      t.height = size();
      texels_.assign(size_t(std::clamp(t.width, 0, 64)) * size_t(std::clamp(t.height, 0, 64)) * 4, 200);
      t.rgba = t.width <= 64 && t.height <= 64 ? texels_.data() : nullptr;
      if (one(4)) t.gl_texture = below(50);
      t.wrap_u = below(5) - 1;
      lambent_texture made = 0;
      keep(lambent_texture_create(d, scene, maybe(&t), out(&made)), made, textures_);
      break;
    }
    case 3: {
      lambent_material_desc m = desc<lambent_material_desc>(LAMBENT_MATERIAL_DESC);
      for (float& v : m.base_color) v = value();
      for (float& v : m.emission) v = one(3) ? value() : 0;
      m.base_texture = one(3) ? any(textures_) : 0;
      m.alpha_mode = below(4) - one(9);
      if (one(4)) m.alpha = value(), m.alpha_cutoff = value();
      if (one(4)) m.base_uv_set = below(4) - 1, m.base_uv[below(6)] = value();
      lambent_material made = 0;
      if (one(3))
        lambent_material_set(d, scene, any(materials_), maybe(&m));
      else
        keep(lambent_material_create(d, scene, maybe(&m), out(&made)), made, materials_);
      if (one(6)) lambent_material_destroy(d, scene, any(materials_));
      if (one(6)) lambent_texture_destroy(d, scene, any(textures_));
      break;
    }
    case 4:
    case 5: {
      lambent_mesh_desc m = desc<lambent_mesh_desc>(LAMBENT_MESH_DESC);
      m.vertex_count = uint32_t(below(30));
      m.triangle_count = uint32_t(below(20));
      positions_.resize(90);
      indices_.resize(60);
      for (float& p : positions_) p = value();
      for (uint32_t& i : indices_) i = uint32_t(below(int(m.vertex_count) + (one(10) ? 3 : 1) - 1 + 1));
      m.positions = maybe(positions_.data());
      m.indices = maybe(indices_.data());
      m.normals = one(2) ? positions_.data() : nullptr;
      m.uvs = one(2) ? positions_.data() : nullptr;
      m.uvs1 = one(4) ? positions_.data() : nullptr;
      m.material = one(2) ? any(materials_) : 0;
      const lambent_submesh parts[2] = {{0, uint32_t(below(20)), any(materials_)},
                                        {uint32_t(below(20)), 3, any(materials_)}};
      if (one(3)) m.submeshes = parts, m.submesh_count = uint32_t(below(3));
      lambent_mesh made = 0;
      keep(lambent_mesh_create(d, scene, maybe(&m), out(&made)), made, meshes_);
      break;
    }
    case 6:
      lambent_mesh_destroy(d, scene, any(meshes_));
      break;
    case 7:
    case 8: {
      lambent_instance made = 0;
      place();
      if (instances_.size() < 200)
        keep(lambent_instance_create(d, scene, any(meshes_), maybe(matrix_), out(&made)), made, instances_);
      break;
    }
    case 9:
    case 10:
      place();
      lambent_instance_move(d, scene, any(instances_), maybe(matrix_));
      break;
    case 11:
      positions_.resize(90);
      for (float& p : positions_) p = value();
      lambent_instance_deform(d, scene, any(instances_), maybe(positions_.data()), one(2) ? positions_.data() : nullptr,
                              uint32_t(below(31)));
      break;
    case 12:
      lambent_instance_destroy(d, scene, any(instances_));
      break;
    case 13:
    case 14: {
      lambent_light_desc l = desc<lambent_light_desc>(LAMBENT_LIGHT_DESC);
      l.type = below(one(10) ? 9 : 3);
      for (int i = 0; i < 3; ++i) l.position[i] = value(), l.direction[i] = value(), l.intensity[i] = value();
      if (one(3)) l.range = value();
      if (one(3)) l.inner_cone_angle = value(), l.outer_cone_angle = value();
      lambent_light made = 0;
      if (one(2) && lights_.size() < 50)
        keep(lambent_light_create(d, scene, maybe(&l), out(&made)), made, lights_);
      else
        lambent_light_set(d, scene, any(lights_), maybe(&l));
      break;
    }
    case 15:
      lambent_light_destroy(d, scene, any(lights_));
      break;
    case 16: {
      lambent_sky_desc s = desc<lambent_sky_desc>(LAMBENT_SKY_DESC);
      s.type = below(3);
      for (int i = 0; i < 3; ++i) s.radiance[i] = value(), s.towards_sun[i] = value();
      s.turbidity = value();
      lambent_scene_set_sky(d, scene, maybe(&s));
      break;
    }
    case 17: {
      lambent_view_desc v = desc<lambent_view_desc>(LAMBENT_VIEW_DESC);
      v.width = below(20) - 1;
      v.height = below(20) - 1;
      lambent_view made = 0;
      if (one(4) && views_.size() < 6) {
        keep(lambent_view_create(d, scene, maybe(&v), out(&made)), made, views_);
        for (const auto& [setting, number] : {std::pair("smc.vpls", "32"), {"smc.points", "32"}, {"smc.warmup", "1"}})
          lambent_view_set(d, made, setting, number);
      }
      break;
    }
    case 18:
      if (one(6)) lambent_view_destroy(d, any(views_));
      break;
    case 19:
      lambent_view_resize(d, any(views_), below(20) - 1, below(20) - 1);
      break;
    case 20: {
      static const char* const kSettings[] = {"gather.near", "gather.mode", "technique", "smc.vpls", "nothing", ""};
      static const char* const kValues[] = {"1", "8", "full", "interleaved", "lists", "isr", "smc", "-3", "nan", ""};
      char text[40];
      lambent_view_set(d, any(views_), maybe(kSettings[below(6)]), maybe(kValues[below(10)]));
      lambent_view_get(d, any(views_), maybe(kSettings[below(6)]), maybe(text), size_t(below(41)));
      break;
    }
    case 21: {
      if (!one(6)) break; // the dear one
      lambent_frame f = desc<lambent_frame>(LAMBENT_FRAME);
      if (one(4)) f.depth = uint32_t(below(40)), f.normal = uint32_t(below(40));
      if (one(4)) f.indirect_out = uint32_t(below(40));
      if (one(8)) f.world_from_view[below(16)] = value();
      if (one(8)) f.fov_y = value();
      if (one(8)) f.ortho_half_height = value();
      if (one(8)) f.near_plane = value(), f.far_plane = value();
      if (one(8)) f.depth_type = below(5), f.normal_type = below(6);
      if (one(8)) f.x = below(9) - 1, f.y = below(9) - 1;
      if (one(3)) f.origin_top = 1;
      f.world_from_view[14] = 0.9f;
      lambent_output o = desc<lambent_output>(LAMBENT_OUTPUT);
      lambent_render(d, any(views_), maybe(&f), maybe(&o));
      break;
    }
    case 22: {
      float e[2][12];
      positions_.resize(90);
      for (float& p : positions_) p = value();
      lambent_irradiance(d, any(views_), maybe(positions_.data()), maybe(positions_.data() + 30), size_t(below(4)),
                         maybe(e[0]), maybe(e[1]));
      break;
    }
    case 23: {
      size_t count = size_t(below(4));
      lambent_memory_row rows[4];
      lambent_memory(d, maybe(rows), maybe(&count));
      unsigned char bytes[400];
      lambent_defaults(below(12) - 1, maybe(bytes), size_t(below(401)));
      lambent_status_text(below(20) - 5);
      lambent_reload_shaders(d);
      break;
    }
    }
    EXPECT_STRNE(lambent_message(room_.device), nullptr);
  }

  lambent_view view() const { return view_; }

 private:
  int below(int n) { return int(random_() % uint32_t(std::max(n, 1))); }
  bool one(int in) { return below(in) == 0; }
  int size() { return one(10) ? below(100000) - 10 : 1 + below(16); }
  float value() {
    static const float kOdd[] = {0, -1, 1e30f, -1e30f, 1e-30f, INFINITY, NAN, 1e12f};
    return one(20) ? kOdd[below(8)] : 2 * float(random_()) / 4294967295.0f - 0.5f;
  }
  template <class T> T* maybe(T* pointer) { return one(40) ? nullptr : pointer; }
  uint64_t* out(uint64_t* made) { return one(60) ? nullptr : made; }
  uint64_t any(const std::vector<uint64_t>& of) {
    if (one(12) || of.empty()) return one(2) ? random_() : (uint64_t(random_()) << 32 | random_());
    return of[size_t(below(int(of.size())))];
  }
  void keep(lambent_status status, uint64_t made, std::vector<uint64_t>& in) {
    if (status == LAMBENT_OK && made != 0) in.push_back(made);
    EXPECT_NE(status, LAMBENT_DEVICE_LOST) << lambent_message(room_.device);
  }
  void place() {
    std::memcpy(matrix_, kIdentity, sizeof matrix_);
    for (int i = 12; i < 15; ++i) matrix_[i] = value();
    if (one(4)) matrix_[below(16)] = value();
  }
  template <class Desc> Desc desc(lambent_kind kind) {
    Desc d;
    lambent_defaults(kind, &d, sizeof d);
    if (one(30)) d.size = size_t(below(300));
    return d;
  }

  const Room& room_;
  std::mt19937 random_;
  lambent_view view_ = 0;
  float matrix_[16];
  std::vector<float> positions_;
  std::vector<uint32_t> indices_;
  std::vector<uint8_t> texels_;
  std::vector<uint64_t> scenes_{room_.scene}, textures_, materials_, meshes_{room_.walls}, instances_{room_.block},
      lights_{room_.lamp}, views_{room_.view(8, 6)};
};

int numberFrom(const char* variable, int otherwise) {
  const char* text = std::getenv(variable);
  return text ? std::atoi(text) : otherwise;
}

} // namespace

TEST(LibraryCalls, RandomOnesEndInAStatus) {
  const auto context = eglHost();
  if (!context) GTEST_SKIP() << "EGL offers no OpenGL 4.5 here";
  context->makeCurrent();
  const int calls = numberFrom("LAMBENT_RANDOM_CALLS", 4000);
  uint32_t seed = uint32_t(numberFrom("LAMBENT_RANDOM_SEED", 1));
  for (int done = 0; done < calls; ++seed) { // a new device from time to time: scenes fill up
    Room room;
    Caller caller(room, seed);
    for (int i = 0; i < 2000 && done < calls; ++i, ++done) caller.call();
    lambent_scene other = 0;
    room.ok(lambent_scene_create(room.device, &other)); // the device lives
  }
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

} // namespace lambent::test
