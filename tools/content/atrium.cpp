// An atrium: galleries on several storeys around a roofed court, lit by one moving lantern that casts the shadows of
// columns and balustrades all around. The court's middle is the origin, its floor y = 0.
#include "tools/content/furniture.h"
#include "tools/content/recipes.h"

#include <cmath>

namespace lambent::content {

namespace {

constexpr double kBay = 3.4, kGallery = 3.0, kHalfArcade = 0.25, kWall = 0.3; // metres
constexpr double kSpring = 2.6, kArch = 1.8, kSlab = 0.4, kStorey = kSpring + kArch + kSlab;
constexpr double kRail = 0.95;

class Atrium : public SceneBuilder {
 public:
  explicit Atrium(const Order& order)
      : SceneBuilder(order), bays_(full() ? 5 : 3), storeys_(full() ? 4 : 2), court_(0.5 * kBay * bays_),
        outer_(court_ + 2 * kHalfArcade + kGallery) {
    addShell();
    for (int storey = 0; storey < storeys_; ++storey)
      for (int side = 0; side < 4; ++side) addSide(storey, side);
    addCourt();
    addLantern();
    camera("court", {-0.1 * court_, 1.7, 0.85 * court_}, {0.5 * court_, 2.6, -0.6 * court_});
    camera("gallery", {-court_, 1.7, court_ + 1.9}, {court_, 1.6, court_ + 1.2});
    camera("upstairs", {-court_ + 1, kStorey + 1.7, court_ + 0.9}, {0.4 * court_, kStorey - 1, -court_});
  }

 private:
  /// Places a mesh on one side of the court: x along it, z outwards from the middle.
  void onSide(const std::string& name, Index mesh, int side, const dvec3& at, double turn = 0) {
    place(name, mesh, turned(at, 90.0 * side), 90.0 * side + turn);
  }

  void addShell() {
    const double o = outer_ + kWall, top = storeys_ * kStorey;
    place("floor", box({-o - 0.1, -0.3, -o - 0.1}, {o + 0.1, 0, o + 0.1}), paint("floor", {0.5, 0.46, 0.4}));
    place("roof", box({-o - 0.2, top - 0.05, -o - 0.2}, {o + 0.2, top + 0.3, o + 0.2}), plaster_);
    const auto ring = [](double in, double out, double y0, double y1) {
      Geometry g = box({-out, y0, in}, {out, y1, out});
      g.add(box({-out, y0, -out}, {out, y1, -in}));
      g.add(box({in, y0, -in}, {out, y1, in}));
      g.add(box({-out, y0, -in}, {-in, y1, in}));
      return g;
    };
    place("outer walls", ring(outer_, o, -0.05, top), paint("wall", {0.68, 0.52, 0.36}));

    // Gallery floors stand out a little over the arcade.
    const Index slab = mesh("gallery floor", ring(court_ - 0.1, outer_ + 0.1, 0, kSlab), stone_);
    for (int i = 1; i <= storeys_; ++i) place("gallery floor " + std::to_string(i), slab, {0, i * kStorey - kSlab, 0});
    const Index beam = mesh("beam", box({-0.15, -0.3, -court_}, {0.15, 0.02, court_}), timber_);
    for (int i = 1; i < bays_; ++i) place("beam " + std::to_string(i), beam, {(i - 0.5 * bays_) * kBay, top - 0.05, 0});
  }

  void addSide(int storey, int side) {
    const std::string name = "storey " + std::to_string(storey) + " side " + std::to_string(side) + " ";
    const double y = storey * kStorey, z = court_ + kHalfArcade;
    onSide(name + "corner column", column_, side, {-z, y, z});
    onSide(name + "corner", corner_, side, {-z, y + kSpring, z});
    for (int i = 0; i < bays_; ++i) {
      const std::string number = std::to_string(i);
      const double middle = (i + 0.5 - 0.5 * bays_) * kBay;
      if (i > 0) onSide(name + "column " + number, column_, side, {middle - 0.5 * kBay, y, z});
      onSide(name + "arch " + number, arch_, side, {middle, y + kSpring, z}, 180); // the moulding faces the court
      if (storey > 0) onSide(name + "balustrade " + number, balustrade_, side, {middle, y, z});
      if (storey > 0 && (i + side) % 2 == 0)
        onSide(name + "banner " + number, banners_[size_t(i + side + storey) % banners_.size()], side,
               {middle, y + 0.1, court_ - 0.25}, 180);
      if ((i * 3 + side + storey) % 4 == 0) onSide(name + "bench " + number, bench_, side, {middle, y, outer_ - 0.4});
    }
  }

  Geometry balustrade() const {
    const double half = 0.5 * kBay - 0.31; // between the plinths of two columns
    const uint32_t count = detail(8, 5);
    Geometry g = box({-half, kRail - 0.1, -0.1}, {half, kRail, 0.1});
    for (uint32_t i = 0; i < count; ++i)
      g.add(baluster(kRail - 0.1, detail(16, 6)), {(i + 0.5 - 0.5 * count) * 2 * half / count, 0, 0});
    return g;
  }

  std::array<Index, 3> banners() {
    const Index red = mesh("red banner",
                           cloth({.width = 1.4,
                                  .drop = 2.4,
                                  .folds = 3.5,
                                  .foldDepthTop = 0.02,
                                  .foldDepthBottom = 0.06,
                                  .columns = detail(40, 12),
                                  .rows = detail(12, 4)}),
                           fabric("red cloth", {0.66, 0.06, 0.05}));
    return {red, variant("blue banner", red, fabric("blue cloth", {0.07, 0.16, 0.58})),
            variant("gold banner", red, fabric("gold cloth", {0.76, 0.5, 0.1}))};
  }

  void addCourt() {
    const double reach = 0.55 * court_;
    const Index tub = mesh("tub", pot(0.5, 0.6, detail(48, 12)), stone_);
    const Index palm =
        mesh("palm", fronds(detail(120, 24), 1.3, 0.66, detail(16, 4)), fabric("leaf", {0.1, 0.34, 0.08}));
    for (int side = 0; side < 4; ++side) {
      onSide("tub " + std::to_string(side), tub, side, {reach, 0, reach});
      onSide("palm " + std::to_string(side), palm, side, {reach, 0, reach});
    }
    place("basin", basin(), stone_);
    place("basin water", basinWater(), paint("water", {0.16, 0.34, 0.36}));
  }

  /// Goes around the court at the height of a hand, between the basin and the palms.
  void addLantern() {
    constexpr double kPeriod = 20; // seconds
    const double radius = 0.42 * court_;
    const auto path = [&](double angle) { return dvec3(radius * std::cos(angle), 1.9, radius * std::sin(angle)); };
    animate(lamp("lantern", {1, 0.82, 0.58}, 60, path(0)), kPeriod, path);
  }

  int bays_, storeys_;   // bays of one side
  double court_, outer_; // half the court's side; |x| and |z| of the outer walls' inner faces
  const Index stone_ = paint("stone", {0.66, 0.62, 0.54}), plaster_ = paint("plaster", {0.74, 0.7, 0.62});
  const Index timber_ = paint("timber", {0.33, 0.21, 0.12});
  const Index column_ = mesh("column", column(kSpring, detail(40, 8)), stone_);
  const Index corner_ =
      mesh("corner", box({-kHalfArcade, 0, -kHalfArcade}, {kHalfArcade, kArch, kHalfArcade}), plaster_);
  const Index arch_ = mesh(
      "arch", arch({.bay = kBay, .height = kArch, .thickness = 2 * kHalfArcade, .segments = detail(40, 8)}), plaster_);
  const Index balustrade_ = mesh("balustrade", balustrade(), stone_);
  const Index bench_ =
      mesh("bench", bench({-0.9, 0.38, -0.22}, {0.9, 0.46, 0.22}, {0.63, 0, -0.2}, {0.75, 0.38, 0.2}), timber_);
  const std::array<Index, 3> banners_ = banners();
};

} // namespace

GeneratedScene writeAtrium(const Order& order) { return Atrium(order).write(); }

} // namespace lambent::content
