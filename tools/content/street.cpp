// A street at night after rain: street lamps, shops that are open, signs in colour, lit windows, cars, a little
// moonlight. Some fifty lights of unlike strength, each of which matters somewhere and hardly any everywhere. X runs
// along the street (east), which is 7 m wide between pavements of 2.6 m; the road is y = 0.
#include "tools/content/citadel_parts.h"
#include "tools/content/furniture.h"
#include "tools/content/plants.h"
#include "tools/content/recipes.h"
#include "tools/content/street_parts.h"
#include "tools/content/textures.h"

#include <array>
#include <string>

namespace lambent::content {

namespace {

constexpr double kHalfRoad = 3.5, kHalfStreet = 6.1, kPavement = 0.12; // metres

class StreetBuilder {
 public:
  explicit StreetBuilder(SceneSize size) : full_(size == SceneSize::Full), houses_(full_ ? 6 : 2) {}

  GeneratedScene write(const std::filesystem::path& folder) {
    addGround();
    for (const bool south : {true, false})
      for (int i = 0; i < houses_; ++i)
        addHouse(std::string(south ? "south" : "north") + " house " + std::to_string(i), i * 2 + (south ? 1 : 0),
                 {kFrontWidth * (i + 0.5), kPavement, south ? kHalfStreet : -kHalfStreet}, south ? 0 : 180);
    addHouse("east house", 1, {length() + 4, kPavement, 0}, 90);
    addHouse("west house", 4, {-4, kPavement, 0}, 270);
    addStreetLamps();
    addTrees();
    addCars();
    s_.gltf.addNode({.name = "moon",
                     .translation = {0, 30, 0},
                     .rotation = facing({0.35, -1, 0.28}),
                     .light = s_.gltf.addDirectionalLight("moon", {0.6, 0.75, 1}, 0.05)});
    s_.camera("street", {1.2, 1.7, 4.6}, {12, 2.0, -1.2}, 62);
    s_.camera("middle", {0.5, 1.65, -0.4}, {14, 2.1, 0.6}, 60);
    s_.camera("shop", {8.8, 1.75, -2.9}, {4.2, 1.8, -6.8}, 60);
    return s_.gltf.write(folder, full_ ? "street" : "street-small");
  }

 private:
  double length() const { return kFrontWidth * houses_; }
  uint32_t detail(uint32_t full, uint32_t small) const { return full_ ? full : small; }

  Index textured(const std::string& name, Index texture, const dvec3& tint = dvec3(1)) {
    return s_.gltf.addMaterial({.name = name, .albedo = tint, .texture = texture});
  }
  Index glowing(const std::string& name, const dvec3& color, double radiance) {
    return s_.gltf.addMaterial(
        {.name = name, .albedo = {0.6, 0.6, 0.6}, .emissionColor = color, .emissionRadiance = radiance});
  }
  static Geometry mapped(Geometry g, double tileMetres) {
    mapFromSides(g, tileMetres);
    return g;
  }

  void addGround() {
    const double x0 = -6, x1 = length() + 6;
    const Index road =
        s_.gltf.addMaterial({.name = "wet asphalt",
                             .albedo = {1, 1, 1},
                             .texture = s_.gltf.addTexture(asphalt("asphalt")),
                             .roughnessMetalnessTexture = s_.gltf.addTexture(asphaltFinish("asphalt-finish"))});
    s_.place("road", mapped(box({x0 - 8, -0.4, -14}, {x1 + 8, 0, 14}), 3.0), road);
    Geometry base, kerb;
    for (const double side : {-1.0, 1.0}) {
      const auto strip = [&](double a, double b, double lo, double hi) {
        return box({x0 - lo, lo, std::min(side * a, side * b)}, {x1 + lo, hi, std::max(side * a, side * b)});
      };
      base.add(strip(kHalfRoad + 0.1, kHalfStreet + 8, -0.05, kPavement - 0.015));
      kerb.add(strip(kHalfRoad, kHalfRoad + 0.18, -0.07, kPavement + 0.01));
    }
    for (const double x : {x0, length() + 0.9})
      base.add(box({x, -0.05, -kHalfRoad - 0.2}, {x + 5.1, kPavement - 0.03, kHalfRoad + 0.2}));
    s_.place("pavement base", base, concrete_);
    s_.place("kerb", kerb, stone_);
    const double patch = full_ ? 2.0 : 5.0, width = 2.4;
    const Index slabs = s_.mesh("slabs", cobbles(patch, width, full_ ? 0.2 : 0.8), concrete_);
    for (const bool south : {true, false})
      for (int i = 0; i < int(length() / patch + 0.5); ++i)
        s_.place(std::string(south ? "south" : "north") + " slabs " + std::to_string(i), slabs,
                 {patch * i, kPavement - 0.015, (south ? 1 : -1) * (kHalfRoad + 0.18 + 0.5 * width)});
    Geometry marks;
    for (double x = 1; x + 2 < length(); x += 4) marks.add(box({x, -0.01, -0.07}, {x + 2, 0.005, 0.07}));
    for (int i = 0; i < 7; ++i)
      marks.add(box({8.2, -0.01, -3.2 + 0.93 * i}, {10.6, 0.005, -2.75 + 0.93 * i})); // crossing
    s_.place("road marks", marks, s_.paint("road paint", {0.6, 0.6, 0.58}));
  }

  struct Front {
    std::array<Index, 3> masonry; // brick, two plasters
    Index stonework, woodwork;
  };

  const Front& front(int storeys) {
    Front& f = fronts_[size_t(storeys - 3)];
    if (f.woodwork != kAbsent) return f;
    const std::string name = std::to_string(storeys) + " storeys";
    f.masonry[0] = s_.mesh("brick front " + name, mapped(frontMasonry(storeys), 1.2), brick_);
    f.masonry[1] = s_.gltf.addMeshVariant("pale front " + name, f.masonry[0], pale_);
    f.masonry[2] = s_.gltf.addMeshVariant("green front " + name, f.masonry[0], green_);
    f.stonework = s_.mesh("stonework " + name, frontStonework(storeys), stone_);
    f.woodwork = s_.mesh("woodwork " + name, frontWoodwork(storeys), wood_);
    return f;
  }

  /// A place in the frame of a house that stands at `at`, turned.
  static dvec3 inFrame(const dvec3& at, double turn, const dvec3& p) {
    Geometry point;
    point.addVertex(p, {0, 1, 0});
    return at + turned(point, turn).positions[0];
  }

  void addHouse(const std::string& name, int kind, const dvec3& at, double turn) {
    const int storeys = kind % 3 == 1 ? 3 : 4;
    const Front& f = front(storeys);
    s_.place(name, f.masonry[size_t(kind * 2 + kind / 3) % 3], at, turn);
    s_.place(name + " stonework", f.stonework, at, turn);
    s_.place(name + " woodwork", f.woodwork, at, turn);
    for (int s = 1; s < storeys; ++s)
      for (int w = 0; w < kWindows; ++w) {
        const uint32_t id = uint32_t(kind * 64 + s * 8 + w);
        const double chance = hashed(id, 41);
        const Index mesh = chance < 0.18   ? warmPane_
                           : chance < 0.26 ? coldPane_
                           : chance < 0.31 ? rosePane_
                                           : darkPane_;
        s_.place(name + " pane " + std::to_string(s) + std::to_string(w), mesh, inFrame(at, turn, paneAt(s, w)), turn);
      }
    addShop(name, kind, at, turn);
  }

  void addShop(const std::string& name, int kind, const dvec3& at, double turn) {
    static constexpr std::array<const char*, 8> kSigns{"CAFE",    "BOOKS",  "HOTEL",   "BAR",
                                                       "FLORIST", "CINEMA", "TOBACCO", "THEATRE"};
    const auto place = [&](const char* what, Index mesh, const dvec3& p) {
      s_.place(name + what, mesh, inFrame(at, turn, p), turn);
    };
    place(" floor", shopFloor_, {0, 0, 0});
    place(" lining", shopLinings_[size_t(kind) % shopLinings_.size()], {0, 0, 0});
    place(" fittings", fittings_, {0, 0, 0});
    for (size_t k = 0; k < goods_.size(); ++k)
      place((" goods " + std::to_string(k)).c_str(), goods_[k], {-1.45, 0.34, kShopDepth - 0.17});
    const bool open = kind % 4 != 3;
    if (open) {
      place(" ceiling lamp", housing_, {-1.4, kShopHeight - 0.3, 1.6});
      place(" ceiling light", kind % 2 ? warmPanel_ : coldPanel_, {-1.4, kShopHeight - 0.3, 1.6});
    }
    if (kind % 3 != 2) {
      place(" awning", awnings_[0], {0, 0, 0});
      place(" awning stripes", awnings_[size_t(1 + kind % 2)], {0, 0, 0});
    }
    const std::string word = kSigns[size_t(kind) % kSigns.size()];
    place(" sign", s_.mesh(name + " sign", lettering(word), signColors_[size_t(kind) % signColors_.size()]),
          {-0.4, kShopHeight - 0.58, -0.09});
    if (kind % 2 == 0) { // a lantern between window and door
      place(" lantern", lantern_, {1.8, 2.75, -0.3});
      s_.lamp(name + " lantern light", {1, 0.62, 0.3}, 1.6, inFrame(at, turn, {1.8, 2.33, -0.3}));
    }
  }

  void addStreetLamps() {
    const Index post = s_.mesh("street lamp", streetLamp(detail(20, 6)), iron_);
    const Index lens = s_.mesh("lamp lens", lampLens(), glowing("lamp lens", {1, 0.7, 0.36}, 40));
    const int lamps = full_ ? 12 : 4;
    for (int i = 0; i < lamps; ++i) {
      const bool south = i % 2;
      const double x = (i + 0.5) * length() / lamps, z = kHalfRoad + 0.45;
      const dvec3 at(x, kPavement, south ? z : -z);
      const std::string number = std::to_string(i + 1);
      s_.place("street lamp " + number, post, at, south ? 180 : 0);
      s_.place("lamp lens " + number, lens, at, south ? 180 : 0);
      s_.gltf.addNode({.name = "lamp " + number,
                       .translation = at + dvec3(0, kLensHeight - 0.03, south ? -kArm : kArm),
                       .rotation = facing({0, -1, 0}),
                       .light = s_.gltf.addSpotLight("lamp " + number, {1, 0.7, 0.36}, 34, 35, 68)});
    }
  }

  void addTrees() {
    const Plant grown =
        full_ ? tree(14, 7, 14, 4.6, {.rows = 2, .sides = 6}) : tree(7, 4, 5, 4.2, {.rows = 1, .sides = 4});
    const Index trunk = s_.mesh("tree", grown.stems, bark_), leaves = s_.mesh("leaves", grown.leaves, leaf_);
    const int trees = full_ ? 8 : 2;
    for (int i = 0; i < trees; ++i) {
      const bool south = i % 2 == 0;
      const dvec3 at((i + 0.85) * length() / trees, kPavement - 0.03, (south ? 1 : -1) * (kHalfRoad + 0.75));
      s_.place("tree " + std::to_string(i), trunk, at, 77.0 * i);
      s_.place("leaves " + std::to_string(i), leaves, at, 77.0 * i);
      s_.place("tree pit " + std::to_string(i), pit_, at);
    }
  }

  void addCars() {
    const Index body =
        s_.mesh("car body", carBody(),
                s_.gltf.addMaterial({.name = "blue lacquer", .albedo = {0.06, 0.13, 0.32}, .roughness = 0.35}));
    const Index red = s_.gltf.addMeshVariant(
        "red car body", body,
        s_.gltf.addMaterial({.name = "red lacquer", .albedo = {0.45, 0.04, 0.03}, .roughness = 0.35}));
    const Index pale = s_.gltf.addMeshVariant(
        "pale car body", body,
        s_.gltf.addMaterial({.name = "pale lacquer", .albedo = {0.6, 0.6, 0.56}, .roughness = 0.35}));
    const Index glass =
        s_.mesh("car glass", carGlass(),
                s_.gltf.addMaterial({.name = "dark glass", .albedo = {0.03, 0.035, 0.04}, .roughness = 0.3}));
    const Index wheels = s_.mesh("car wheels", carWheels(detail(36, 10)), s_.paint("rubber", {0.03, 0.03, 0.03}));
    const Index head = s_.mesh("headlights", carHeadlights(), glowing("headlight", {1, 0.95, 0.85}, 90));
    const Index tail = s_.mesh("tail lights", carTailLights(), glowing("tail light", {1, 0.05, 0.02}, 14));
    const auto car = [&](const std::string& name, Index shell, const dvec3& at, double turn, bool lit) {
      s_.place(name, shell, at, turn);
      s_.place(name + " glass", glass, at, turn);
      s_.place(name + " wheels", wheels, at, turn);
      if (!lit) return;
      s_.place(name + " headlights", head, at, turn);
      s_.place(name + " tail lights", tail, at, turn);
      for (const bool left : {true, false}) {
        const dvec3 ahead = inFrame(dvec3(0), turn, {1, 0, 0});
        const dvec3 lamp = inFrame(at, turn, {kCarHalfLength + 0.08, kHeadlightY, left ? -kHeadlightZ : kHeadlightZ});
        s_.gltf.addNode(
            {.name = name + (left ? " left beam" : " right beam"),
             .translation = lamp,
             .rotation = facing(ahead + dvec3(0, -0.07, 0)),
             .light = s_.gltf.addSpotLight(name + (left ? " left beam" : " right beam"), {1, 0.95, 0.85}, 60, 8, 24)});
      }
    };
    car("leaving car", red, {full_ ? 13.5 : 12.6, 0, 1.75}, 0, true);
    car("parked car", pale, {5.6, 0, -2.5}, 1, false);
    if (!full_) return;
    car("coming car", body, {31, 0, -1.6}, 180, true);
    car("second parked car", body, {24.5, 0, 2.55}, 179, false);
    car("third parked car", pale, {37.5, 0, 2.5}, 180.5, false);
    car("fourth parked car", red, {44, 0, -2.5}, 0.5, false);
  }

  bool full_;
  int houses_;
  SceneBuilder s_;
  const Index bricks_ = s_.gltf.addTexture(bricks("bricks")), plaster_ = s_.gltf.addTexture(plaster("plaster"));
  const Index brick_ = textured("brick", bricks_), pale_ = textured("pale plaster", plaster_, {0.8, 0.74, 0.62});
  const Index green_ = textured("green plaster", plaster_, {0.42, 0.55, 0.5});
  const Index boards_ = textured("boards", s_.gltf.addTexture(planks("planks")));
  const Index concrete_ = s_.paint("concrete", {0.3, 0.3, 0.29}), stone_ = s_.paint("stone", {0.46, 0.43, 0.38});
  const Index wood_ = s_.paint("painted wood", {0.12, 0.16, 0.14}), iron_ = s_.paint("iron", {0.07, 0.08, 0.08});
  const Index bark_ = s_.paint("bark", {0.16, 0.12, 0.09}), leaf_ = s_.fabric("leaf", {0.12, 0.26, 0.07});
  const Index dark_ = s_.paint("dark pane", {0.04, 0.05, 0.06});
  const Index darkPane_ = s_.mesh("dark pane", box({-0.62, -0.01, 0}, {0.62, 1.72, 0.04}), dark_);
  const Index warmPane_ = s_.mesh("warm pane", pane(), glowing("warm window", {1, 0.68, 0.32}, 1.6));
  const Index coldPane_ = s_.gltf.addMeshVariant("cold pane", warmPane_, glowing("cold window", {0.7, 0.85, 1}, 1.2));
  const Index rosePane_ = s_.gltf.addMeshVariant("rose pane", warmPane_, glowing("rose window", {1, 0.4, 0.3}, 1.1));
  const Index shopFloor_ =
      s_.mesh("shop floor", mapped(box({-4.75, -0.08, 0.3}, {4.75, 0.0, kShopDepth + 0.02}), 1.6), boards_);
  const std::array<Index, 3> shopLinings_ = [this] {
    Geometry lining = box({-4.72, -0.02, kShopDepth - 0.02}, {4.72, kShopHeight - 0.28, kShopDepth + 0.02});
    lining.add(box({-4.72, kShopHeight - 0.32, 0.34}, {4.72, kShopHeight - 0.28, kShopDepth}));
    const Index ochre =
        s_.mesh("ochre lining", mapped(lining, 2), textured("ochre plaster", plaster_, {0.9, 0.7, 0.4}));
    return std::array{
        ochre, s_.gltf.addMeshVariant("white lining", ochre, textured("white plaster", plaster_)),
        s_.gltf.addMeshVariant("red lining", ochre, textured("red plaster", plaster_, {0.75, 0.3, 0.22}))};
  }();
  const Index fittings_ = s_.mesh("shop fittings", mapped(shopFittings(), 1.2), boards_);
  const std::array<Index, 3> goods_ = [this] {
    const std::array<dvec3, 3> colors{dvec3(0.55, 0.12, 0.1), dvec3(0.14, 0.28, 0.5), dvec3(0.7, 0.62, 0.4)};
    std::array<Index, 3> meshes;
    for (uint32_t k = 0; k < 3; ++k) {
      const std::string name = "goods " + std::to_string(k);
      meshes[k] =
          s_.mesh(name, turned(books(5.9, 2.35, 0.3, 3, k, full_ ? 0.07 : 0.5), 180), s_.paint(name, colors[k]));
    }
    return meshes;
  }();
  const Index housing_ = s_.mesh("panel housing", panelHousing(2.4, 0.5), iron_);
  const Index warmPanel_ =
      s_.mesh("warm panel", panelEmitter(2.4, 0.5), glowing("warm panel light", {1, 0.8, 0.52}, 9));
  const Index coldPanel_ =
      s_.gltf.addMeshVariant("cold panel", warmPanel_, glowing("cold panel light", {0.85, 0.93, 1}, 8));
  const Index lantern_ = s_.mesh("lantern", lampShade(detail(20, 8)), iron_);
  const std::array<Index, 3> awnings_{
      s_.mesh("awning", awning(false), s_.fabric("pale cloth", {0.7, 0.66, 0.58})),
      s_.mesh("red awning", awning(true), s_.fabric("red cloth", {0.5, 0.08, 0.06})),
      s_.mesh("green awning", awning(true), s_.fabric("green cloth", {0.08, 0.3, 0.16}))};
  const std::array<Index, 5> signColors_{
      glowing("red sign", {1, 0.1, 0.05}, 4), glowing("cyan sign", {0.06, 0.7, 1}, 2.5),
      glowing("amber sign", {1, 0.5, 0.06}, 3), glowing("pink sign", {1, 0.1, 0.5}, 3.5),
      glowing("green sign", {0.1, 1, 0.25}, 2)};
  const Index pit_ =
      s_.mesh("tree pit", box({-0.45, -0.05, -0.45}, {0.45, 0.055, 0.45}), s_.paint("earth", {0.12, 0.09, 0.06}));
  std::array<Front, 2> fronts_{Front{{}, kAbsent, kAbsent}, Front{{}, kAbsent, kAbsent}};
};

} // namespace

GeneratedScene writeStreet(const std::filesystem::path& folder, SceneSize size) {
  return StreetBuilder(size).write(folder);
}

} // namespace lambent::content
