// Files with many of one thing: the time to load them grows as they do.
#include "tests/cpu/scene/support.h"
#include "tests/support/effort.h"

#include <algorithm>
#include <ctime>

namespace lambent::test::growth_test {

using nlohmann::json;

/// Of all threads of this program, whatever else the machine does.
double cpuSeconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// A triangle, and `count` times what `add` adds.
struct Growing {
  const char* name;
  void (*add)(GltfBuilder& b, int i, int count);
  bool large = false; // it takes more than such a file may ask for
};

json placed(int i) { return json::array({i % 100, i / 100, 0}); }

const Growing kGrowing[] = {
    {"nodes",
     [](GltfBuilder& b, int i, int) {
       b.addRoot({{"mesh", 0}, {"translation", placed(i)}});
     }},
    {"a chain of nodes",
     [](GltfBuilder& b, int i, int count) {
       const int node = i == 0 ? b.addRoot(json::object()) : b.push("nodes", json::object());
       if (i + 1 < count) b.json["nodes"][size_t(node)]["children"] = {node + 1};
     }},
    {"children of one node",
     [](GltfBuilder& b, int i, int) {
       const int node =
           i == 0 ? b.addRoot({{"name", "root"}}) : b.push("nodes", json{{"mesh", 0}, {"translation", placed(i)}});
       if (i > 0) b.json["nodes"][size_t(node - i)]["children"].push_back(node);
     }},
    {"meshes",
     [](GltfBuilder& b, int i, int) {
       b.addRoot({{"mesh", b.push("meshes", json(b.json["meshes"][0]))}, {"translation", placed(i)}});
     }},
    {"primitives",
     [](GltfBuilder& b, int i, int) {
       json& primitives = b.json["meshes"][0]["primitives"];
       json next = primitives[size_t(i % 500)]; // not all in one place
       const float x = float(3 * i);
       if (i < 500) next["attributes"]["POSITION"] = b.positions({{x, 0, 9}, {x + 1, 0, 9}, {x, 1, 9}});
       primitives.push_back(next);
     }},
    {"materials",
     [](GltfBuilder& b, int i, int) {
       json mesh = b.json["meshes"][0];
       mesh["primitives"][0]["material"] = b.push("materials", {{"emissiveFactor", {1, 1, 1}}});
       b.addRoot({{"mesh", b.push("meshes", mesh)}, {"translation", placed(i)}});
     }},
    {"nodes of one name",
     [](GltfBuilder& b, int i, int) {
       b.addRoot({{"name", "alike"}, {"mesh", 0}, {"translation", placed(i)}});
     }},
    {"accessors and their views",
     [](GltfBuilder& b, int, int) {
       b.push("bufferViews", json(b.json["bufferViews"][0]));
       b.push("accessors", json(b.json["accessors"][0]));
     }},
    {"lights",
     [](GltfBuilder& b, int i, int) {
       b.json["extensionsUsed"] = {"KHR_lights_punctual"};
       b.json["extensions"]["KHR_lights_punctual"]["lights"].push_back({{"type", "point"}});
       b.addRoot({{"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
     },
     true},
    {"cameras",
     [](GltfBuilder& b, int, int) {
       const int camera = b.push("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
       b.addRoot({{"camera", camera}});
     }},
    {"channels of an animation",
     [](GltfBuilder& b, int i, int) {
       if (i == 0)
         b.push("animations",
                {{"samplers", {{{"input", b.floats({0, 1})}, {"output", b.floats({1, 1, 1, 2, 1, 1}, "VEC3")}}}},
                 {"channels", json::array()}});
       const int node = b.addRoot({{"mesh", 0}, {"translation", placed(i)}});
       b.json["animations"][0]["channels"].push_back({{"sampler", 0}, {"target", {{"node", node}, {"path", "scale"}}}});
     }},
    {"animations",
     [](GltfBuilder& b, int i, int) {
       static int times, values;
       if (i == 0) times = b.floats({0, 1}), values = b.floats({0, 0, 0, 0, 1, 0}, "VEC3");
       b.push("animations", {{"samplers", {{{"input", times}, {"output", values}}}},
                             {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}});
     }},
    {"keys of an animation",
     [](GltfBuilder& b, int i, int count) {
       if (i > 0) return;
       std::vector<float> times, values;
       for (int k = 0; k < 20 * count; ++k)
         times.push_back(float(k)), values.insert(values.end(), {0, float(k % 7), 0});
       b.animate(0, "translation", b.floats(times), b.floats(values, "VEC3"));
     }},
    {"textures",
     [](GltfBuilder& b, int i, int) {
       constexpr const char* kPixel =
           "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/"
           "pLvAAAAAElFTkSuQmCC";
       if (i == 0) b.push("images", {{"uri", kPixel}});
       b.push("materials",
              {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", b.push("textures", {{"source", 0}})}}}}}});
     }},
    {"addresses with a plus",
     [](GltfBuilder& b, int i, int) {
       b.push("images", {{"uri", "a+" + std::to_string(i) + ".png"}});
     }},
    {"corners that disagree", // about the tangent of the vertex in the middle
     [](GltfBuilder& b, int i, int count) {
       const int n = int(std::sqrt(float(count)));
       if (i == 0) {
         std::vector<vec3> positions{vec3(0)};
         for (const float side : {1.0f, -2.0f})
           for (int k = 0; k < n; ++k) {
             const float angle = (side < 0 ? 1.2f : 0) + float(k) / float(n);
             positions.push_back(side * vec3(-std::cos(angle), 0, std::sin(angle)) * vec3(-1, 1, 1));
           }
         std::vector<vec2> uvs;
         for (const vec3& p : positions) uvs.emplace_back(p.x, p.z);
         std::vector<uint16_t> corners;
         for (int a = 0; a < n; ++a)
           for (int c = 0; c < n; ++c) corners.insert(corners.end(), {0, uint16_t(1 + a), uint16_t(1 + n + c)});
         b.push("images", {{"uri", "none.png"}});
         b.push("textures", {{"source", 0}});
         b.push("materials", {{"normalTexture", {{"index", 0}}}});
         b.addMeshNode({{"attributes",
                         {{"POSITION", b.positions(positions)},
                          {"NORMAL", b.positions(std::vector<vec3>(positions.size(), vec3(0, 1, 0)))},
                          {"TEXCOORD_0", b.accessor(b.view(uvs), 5126, "VEC2", uvs.size())}}},
                        {"indices", b.indices(corners)},
                        {"material", 0}});
       }
     },
     true},
    {"unknown things", [](GltfBuilder& b, int i, int) { b.json["extras"]["key" + std::to_string(i)] = i; }},
};

void PrintTo(const Growing& growing, std::ostream* out) { *out << growing.name; }

class Growth : public testing::TestWithParam<Growing> {};

// Eight times as many take eight times as long, not 64.
TEST_P(Growth, IsLinear) {
  if (kSanitized) GTEST_SKIP() << "sanitizers have costs of their own";
  const auto seconds = [&](int count) {
    GltfBuilder b = oneTriangle();
    for (int i = 0; i < count; ++i) GetParam().add(b, i, count);
    TemporaryFolder folder;
    b.writeGltf(folder / "many.gltf");
    double best = 1e9;
    for (int run = 0; run < 2; ++run) {
      const double begin = cpuSeconds();
      Scene scene = loadScene(folder / "many.gltf", "", {}, {.large = GetParam().large});
      animate(scene, 0.5);
      updateWorldTransforms(scene);
      SceneExtractor().extract(scene, {}, 0);
      best = std::min(best, cpuSeconds() - begin);
    }
    return best;
  };
  constexpr double kMost = 40; // page faults of many materials cost 25
  constexpr int kFew = 1500, kMany = 8 * kFew;
  const double few = seconds(kFew), many = seconds(kMany);
  EXPECT_LT(many, kMost * few + 0.02) << few << " s for " << kFew << ", " << many << " s for " << kMany;
}

INSTANTIATE_TEST_SUITE_P(Files, Growth, testing::ValuesIn(kGrowing), [](const auto& info) {
  std::string name = info.param.name;
  std::erase(name, ' ');
  return name;
});

} // namespace lambent::test::growth_test
