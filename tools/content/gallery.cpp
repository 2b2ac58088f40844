// A gallery of organic forms at a fineness that no pixel needs: sculptures on plinths in three rooms under roof lights
// that throw a grid of soft and hard shadows. Every form curves, so that neighbouring pixels see light from everywhere,
// and the rooms' saturated walls show in the white marble. X runs through the rooms (east), Z to the south, the floor
// is y = 0.
#include "tools/content/forms.h"
#include "tools/content/furniture.h"
#include "tools/content/recipes.h"
#include "tools/content/textures.h"

namespace lambent::content {

namespace {

constexpr int kRooms = 3;
constexpr double kLength = 8.0, kWidth = 7.0, kHeight = 4.6, kWall = 0.4; // of a room inside, metres
constexpr double kPitch = kLength + kWall, kSunk = 0.05;
constexpr double kArchRadius = 1.1, kSpring = 1.9; // of the passages between rooms
constexpr double kEast = kRooms * kPitch - kWall;  // inner face of the east wall
constexpr double kRoofLo = 1.7, kRoofHi = 5.3;     // roof lights: z from, to

class Gallery : public SceneBuilder {
 public:
  explicit Gallery(const Order& order) : SceneBuilder(order) {
    addShell();
    for (int room = 0; room < kRooms; ++room) addRoof(room);
    addSculptures();
    addBenches();
    addLights();
    camera("first room", {0.7, 1.65, 5.9}, {6.2, 1.45, 2.2}, 62);
    camera("enfilade", {1.0, 1.65, 3.5}, {12, 1.6, 3.5}, 60);
    camera("last room", {kEast - 7.2, 1.65, 5.8}, {kEast - 2.6, 1.3, 2.6}, 62);
  }

 private:
  static double roomX(int room) { return kPitch * room; }
  /// Of a room along X: from the middle of one cross wall to that of the next, `outside` beyond the first and the last.
  static std::pair<double, double> extent(int room, double outside) {
    return {roomX(room) - (room ? 0.5 * kWall : outside),
            roomX(room) + kLength + (room + 1 < kRooms ? 0.5 * kWall : outside)};
  }

  void addShell() {
    const double w = kWall, lo = -kSunk, hi = kHeight + kSunk;
    place("floor", mappedFromSides(box({-w - 0.1, -0.3, -w - 0.1}, {kEast + w + 0.1, 0, kWidth + w + 0.1}), 1.8), oak_);
    for (int room = 0; room < kRooms; ++room) {
      const auto [x0, x1] = extent(room, w);
      Geometry walls;
      for (const double z : {-w, kWidth}) walls.add(box({x0, lo, z}, {x1, hi, z + w}));
      if (room == 0) walls.add(box({-w, lo, 0}, {0, hi, kWidth}));
      if (room + 1 == kRooms) walls.add(box({kEast, lo, 0}, {kEast + w, hi, kWidth}));
      place("walls " + std::to_string(room), mappedFromSides(walls, 2.4), paints_[size_t(room)]);
    }
    // The passages: an arch over two pieces of wall.
    Geometry wall = arch({.bay = kWidth + 2 * kSunk,
                          .height = hi - kSpring,
                          .thickness = w,
                          .radius = kArchRadius,
                          .segments = full() ? 64u : 16u});
    wall = moved(wall, {0, kSpring, 0});
    for (const double side : {-1.0, 1.0})
      wall.add(box({side * kArchRadius, lo, -0.5 * w}, {side * (0.5 * kWidth + kSunk), kSpring, 0.5 * w}));
    const Index passage = mesh("passage", mappedFromSides(wall, 2.4), white_);
    for (int i = 1; i < kRooms; ++i)
      place("passage " + std::to_string(i), passage, {roomX(i) - 0.5 * w, 0, 0.5 * kWidth}, 90);
  }

  /// A ceiling with an opening under a box of glass that glows: sky through frosted panes, parted by bars.
  void addRoof(int room) {
    const double top = kHeight + 0.3, out = kWall + 0.05;
    const auto [x0, x1] = extent(room, out);
    const double lo = roomX(room) + 1.6, hi = roomX(room) + kLength - 1.6, z1 = kWidth + out;
    Geometry slab = box({x0, kHeight, -out}, {lo, top, z1});
    slab.add(box({hi, kHeight, -out}, {x1, top, z1}));
    slab.add(box({lo, kHeight, -out}, {hi, top, kRoofLo}));
    slab.add(box({lo, kHeight, kRoofHi}, {hi, top, z1}));
    const std::string number = " " + std::to_string(room);
    place("ceiling" + number, slab, ceiling_);
    Geometry lid = box({lo - 0.3, top + 0.5, kRoofLo - 0.3}, {hi + 0.3, top + 0.6, kRoofHi + 0.3});
    lid.add(box({lo - 0.3, top - 0.01, kRoofLo - 0.3}, {lo, top + 0.51, kRoofHi + 0.3}));
    lid.add(box({hi, top - 0.01, kRoofLo - 0.3}, {hi + 0.3, top + 0.51, kRoofHi + 0.3}));
    for (const double z : {kRoofLo - 0.3, kRoofHi}) lid.add(box({lo, top - 0.01, z}, {hi, top + 0.51, z + 0.3}));
    place("lantern" + number, lid, ceiling_);
    Geometry bars;
    for (int i = 1; i < 6; ++i) {
      const double x = glm::mix(lo, hi, i / 6.0);
      bars.add(box({x - 0.04, kHeight + 0.05, kRoofLo - 0.02}, {x + 0.04, kHeight + 0.22, kRoofHi + 0.02}));
    }
    for (int i = 1; i < 4; ++i) {
      const double z = glm::mix(kRoofLo, kRoofHi, i / 4.0);
      bars.add(box({lo - 0.02, kHeight + 0.07, z - 0.03}, {hi + 0.02, kHeight + 0.2, z + 0.03}));
    }
    place("roof bars" + number, bars, iron_);
    const std::array<dvec3, kRooms> colors{dvec3(0.85, 0.93, 1), dvec3(1, 0.9, 0.75), dvec3(0.8, 0.9, 1)};
    const std::array<double, kRooms> radiances{5, 1.2, 3.5};
    place("roof light" + number, downwardSheet({lo, top + 0.45, kRoofLo}, {hi, top + 0.45, kRoofHi}),
          glowing("roof light" + number, colors[size_t(room)], radiances[size_t(room)], 0.7));
  }

  struct Kind {
    std::string name;
    Form form;
    double side, height; // of its plinth, metres
    double fine, coarse; // cells of its mesh, metres
  };

  void addSculptures() {
    const std::array<Kind, 6> kinds{Kind{"reclining figure", recliningFigure(), 0, 0.45, 0.0165, 0.08},
                                    {"draped figure", drapedFigure(), 0.8, 0.35, 0.0135, 0.062},
                                    {"pierced form", piercedForm(), 0.64, 0.8, 0.013, 0.065},
                                    {"bird", bird(), 0.42, 0.9, 0.01, 0.05},
                                    {"growth", growth(), 0.66, 0.7, 0.014, 0.07},
                                    {"gourd", gourd(), 0.6, 0.85, 0.012, 0.06}};
    std::array<Index, 6> meshes, plinths;
    for (size_t k = 0; k < kinds.size(); ++k) {
      const Kind& kind = kinds[k];
      meshes[k] = mesh(kind.name, meshed(kind.form, full() ? kind.fine : kind.coarse), marble_);
      plinths[k] =
          mesh(kind.name + " plinth",
               mappedFromSides(k == 0 ? plinth(2.3, 1.0, kind.height) : plinth(kind.side, kind.side, kind.height), 1.1),
               veined_);
    }
    struct Place {
      size_t kind;
      Index material;
      dvec3 at;
      double turn;
    };
    const double b = kPitch, c = 2 * kPitch;
    const std::vector<Place> places{
        {0, marble_, {4.2, 0, 3.3}, 12},     {1, plaster_, {6.6, 0, 1.2}, 205},     {5, bronze_, {1.5, 0, 1.4}, 0},
        {3, gold_, {6.9, 0, 5.8}, 0},        {2, bronze_, {b + 4.0, 0, 1.5}, 20},   {4, marble_, {b + 1.4, 0, 5.7}, 60},
        {1, marble_, {b + 6.6, 0, 5.8}, 20}, {4, plaster_, {c + 1.6, 0, 1.3}, 190}, {2, marble_, {c + 4.3, 0, 3.6}, 75},
        {5, marble_, {c + 6.6, 0, 1.5}, 40}, {3, bronze_, {c + 6.4, 0, 5.6}, 90}};
    std::array<int, 6> count{};
    for (const Place& p : places) {
      const std::string name = kinds[p.kind].name + " " + std::to_string(++count[p.kind]);
      place(name + " plinth", plinths[p.kind], p.at, p.turn);
      const Index mesh = p.material == marble_ ? meshes[p.kind] : variant(name, meshes[p.kind], p.material);
      place(name, mesh, p.at + dvec3(0, kinds[p.kind].height, 0), p.turn);
    }
  }

  void addBenches() {
    const Geometry shape = bench({-0.9, 0.4, -0.25}, {0.9, 0.48, 0.25}, {0.65, -0.01, -0.2}, {0.75, 0.41, 0.2});
    const Index seat = mesh("bench", mappedFromSides(shape, 0.8), oak_);
    place("bench west", seat, {3.6, 0, 6.3});
    place("bench middle", seat, {kPitch + 4.0, 0, 4.2});
    place("bench east", seat, {2 * kPitch + 3.6, 0, 6.4});
  }

  void addLights() {
    spot("warm spot", {1, 0.82, 0.6}, 18, {5.0, kHeight - 0.15, 0.5}, {1.4, -2.6, 0.6});
    spot("middle spot", {1, 0.75, 0.5}, 26, {kPitch + 2.2, kHeight - 0.15, 0.5}, {1.6, -2.8, 0.9});
  }

  const Index oak_ = paint("oak boards", dvec3(1), texture(planks("planks")));
  const Index veined_ = paint("veined marble", dvec3(1), texture(marble("marble")));
  const Index wash_ = texture(plaster("plaster"));
  const std::array<Index, kRooms> paints_{paint("grey blue plaster", {0.62, 0.72, 0.8}, wash_),
                                          paint("red plaster", {0.75, 0.2, 0.16}, wash_),
                                          paint("green plaster", {0.3, 0.6, 0.4}, wash_)};
  const Index white_ = paint("white plaster", dvec3(1), wash_), ceiling_ = paint("ceiling", {0.76, 0.76, 0.74});
  const Index iron_ = paint("iron", {0.12, 0.12, 0.13}), marble_ = paint("white marble", {0.76, 0.74, 0.7});
  const Index plaster_ = paint("warm plaster", {0.7, 0.58, 0.46});
  const Index bronze_ = material({.name = "bronze", .albedo = {0.3, 0.18, 0.08}, .roughness = 0.45});
  const Index gold_ = material({.name = "gold leaf", .albedo = {0.75, 0.5, 0.14}, .roughness = 0.4});
};

} // namespace

GeneratedScene writeGallery(const Order& order) { return Gallery(order).write(); }

} // namespace lambent::content
