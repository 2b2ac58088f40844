// The generated scenes: same bytes on every run, and geometry that light cannot leak through. Reads the written files
// back as raw glTF, so that a mistake in the importer cannot hide one in the writer.
#include "tests/content/written.h"

#include <nlohmann/json.hpp>

namespace lambent::test::content_test {

using nlohmann::json;

/// A written scene and what its accessors hold.
struct Written {
  const WrittenScene& files;
  json gltf;
  std::string buffer;

  explicit Written(const ContentRecipe& recipe)
      : files(written(recipe)), gltf(json::parse(readBytes(files.scene.file))),
        buffer(readBytes(files.folder / gltf["buffers"][0]["uri"].get<std::string>())) {}

  template <class T> std::vector<T> values(const json& accessorIndex) const {
    const json& accessor = gltf["accessors"][accessorIndex.get<size_t>()];
    const json& view = gltf["bufferViews"][accessor["bufferView"].get<size_t>()];
    std::vector<T> out(accessor["count"].get<size_t>());
    EXPECT_GE(view["byteLength"].get<size_t>(), out.size() * sizeof(T));
    std::memcpy(out.data(), buffer.data() + view["byteOffset"].get<size_t>(), out.size() * sizeof(T));
    return out;
  }

  std::vector<uint32_t> indices(const json& accessorIndex) const {
    constexpr int kUnsignedInt = 5125; // glTF's code; the others are 16-bit
    if (gltf["accessors"][accessorIndex.get<size_t>()]["componentType"] == kUnsignedInt)
      return values<uint32_t>(accessorIndex);
    const std::vector<uint16_t> narrow = values<uint16_t>(accessorIndex);
    return {narrow.begin(), narrow.end()};
  }
};

struct Surface {
  std::string name;
  std::vector<vec3> positions, normals;
  std::vector<uint32_t> indices;
  bool sheet = false; // cloth, lattice and emitters are allowed to be open
};

std::vector<Surface> surfaces(const Written& w) {
  std::vector<Surface> out;
  for (const json& mesh : w.gltf["meshes"]) {
    const json& primitive = mesh["primitives"][0];
    const json& material = w.gltf["materials"][primitive["material"].get<size_t>()];
    out.push_back({mesh["name"], w.values<vec3>(primitive["attributes"]["POSITION"]),
                   w.values<vec3>(primitive["attributes"]["NORMAL"]), w.indices(primitive["indices"]),
                   material.value("doubleSided", false) || material.contains("emissiveFactor")});
  }
  return out;
}

class Content : public testing::TestWithParam<ContentRecipe> {};

TEST_P(Content, SameBytesOnEveryRun) {
  const WrittenScene &first = written(GetParam()), second(GetParam());
  ASSERT_EQ(first.scene.written, second.scene.written);
  for (const std::string& name : first.scene.written)
    EXPECT_EQ(readBytes(first.folder / name), readBytes(second.folder / name)) << name;
}

TEST_P(Content, TheRepositoryHoldsWhatTheRecipeWrites) {
  if (!GetParam().bundled) GTEST_SKIP() << "made on demand";
  const WrittenScene& w = written(GetParam());
  for (const std::string& name : w.scene.written) {
    if (std::filesystem::path(name).extension() == ".png") continue; // the encoder's version decides its bytes
    EXPECT_EQ(readBytes(w.folder / name),
              readBytes(std::filesystem::path(LAMBENT_SOURCE_DIR) / "content" / GetParam().name / name))
        << name << " (repeat `lambent content " << GetParam().name << "`)";
  }
}

TEST_P(Content, HasTheSizeThatItsNamePromises) {
  const WrittenScene& w = written(GetParam());
  const bool small = GetParam().name.ends_with("-small");
  if (GetParam().bundled) {
    EXPECT_LT(w.scene.bytes, 2u << 20);
  } else if (small) {
    EXPECT_LE(w.scene.triangles, 30000u);
  } else if (const size_t dash = GetParam().name.rfind('-');
             GetParam().name.ends_with("k") && dash != std::string::npos) {
    const double thousands = std::stod(GetParam().name.substr(dash + 1));
    EXPECT_NEAR(double(w.scene.triangles), 1000 * thousands, 20 * thousands);
  } else if (GetParam().name == "garden") { // thin sheets: more of them would only be smaller than a pixel
    EXPECT_GE(w.scene.triangles, 60000u);
    EXPECT_LE(w.scene.triangles, 120000u);
  } else {
    EXPECT_GE(w.scene.triangles, 250000u);
    EXPECT_LE(w.scene.triangles, 550000u);
  }
}

TEST_P(Content, TrianglesAreFiniteWoundOutwardsAndNotDegenerate) {
  const Written w(GetParam());
  for (const Surface& s : surfaces(w)) {
    SCOPED_TRACE(s.name);
    for (const vec3& n : s.normals) EXPECT_NEAR(glm::length(n), 1.0f, 1e-4f);
    for (size_t i = 0; i < s.indices.size(); i += 3) {
      const auto corner = [&](size_t k) { return s.positions.at(s.indices[i + k]); };
      ASSERT_TRUE(isFinite(corner(0)) && isFinite(corner(1)) && isFinite(corner(2)));
      const vec3 area = 0.5f * glm::cross(corner(1) - corner(0), corner(2) - corner(0));
      ASSERT_GT(glm::length(area), 1e-7f) << "triangle " << i / 3;
      for (size_t k = 0; k < 3; ++k)
        ASSERT_GT(glm::dot(glm::normalize(area), s.normals.at(s.indices[i + k])), 0.2f) << "triangle " << i / 3;
    }
  }
}

TEST_P(Content, SolidsAreClosedAndFaceOutwards) {
  using Point = std::array<long, 3>;
  const Written w(GetParam());
  for (const Surface& s : surfaces(w)) {
    if (s.sheet) continue;
    SCOPED_TRACE(s.name);
    std::map<std::pair<Point, Point>, int> edges; // how often walked one way, minus the other way
    double volume = 0;
    for (size_t i = 0; i < s.indices.size(); i += 3) {
      std::array<Point, 3> corners;
      std::array<glm::dvec3, 3> p;
      for (size_t k = 0; k < 3; ++k) {
        p[k] = s.positions[s.indices[i + k]];
        corners[k] = {std::lround(p[k].x * 1e5), std::lround(p[k].y * 1e5), std::lround(p[k].z * 1e5)};
      }
      volume += glm::dot(p[0], glm::cross(p[1], p[2])) / 6;
      for (size_t k = 0; k < 3; ++k) {
        const Point &a = corners[k], &b = corners[(k + 1) % 3];
        a < b ? ++edges[{a, b}] : --edges[{b, a}];
      }
    }
    EXPECT_GT(volume, 0);
    size_t open = 0;
    for (const auto& [edge, balance] : edges) open += balance != 0;
    EXPECT_EQ(open, 0u) << "open edges";
  }
}

TEST_P(Content, AlbedosArePlausible) {
  const Written w(GetParam());
  for (const json& m : w.gltf["materials"]) {
    const json& surface = m["pbrMetallicRoughness"];
    const json factor = surface.value("baseColorFactor", json::array({1, 1, 1, 1}));
    for (int i = 0; i < 3; ++i) { // of a texture the factor scales what it shows
      EXPECT_GT(factor[size_t(i)].get<float>(), 0.0f) << m["name"];
      EXPECT_LE(factor[size_t(i)].get<float>(), surface.contains("baseColorTexture") ? 1.0f : 0.8f) << m["name"];
    }
  }
}

TEST_P(Content, NodeNamesAreUnique) { // shots address nodes by name
  const Written w(GetParam());
  std::map<std::string, int> count;
  for (const json& node : w.gltf["nodes"]) EXPECT_EQ(++count[node["name"]], 1) << node["name"];
}

INSTANTIATE_TEST_SUITE_P(Recipes, Content, testing::ValuesIn(testedRecipes()),
                         [](const auto& info) { return testName(info.param.name); });

} // namespace lambent::test::content_test
