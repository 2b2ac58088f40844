// One storey of an office building: two parallel corridors joined at both ends, four rows of rooms with open doors, 14
// lights. Most rooms have no lamp of their own and see only what comes through their door. X runs along the corridors,
// the floor is y = 0.
#include "tools/content/furniture.h"
#include "tools/content/recipes.h"

namespace lambent::content {

namespace {

// Plan, metres.
constexpr double kPitch = 4.2, kDepth = 5.0;         // of a room, between the middles of its walls
constexpr double kCorridor = 2.4;                    // between the middles of its walls
constexpr double kHalfWall = 0.08, kOuterWall = 0.3; // inner walls are 0.16 m thick
constexpr double kHeight = 2.9, kDoorHeight = 2.1;
constexpr double kSunk = 0.05;                         // walls reach that far into floor and ceiling
constexpr double kAcross = 4 * kDepth + 2 * kCorridor; // from outer wall to outer wall
constexpr double kDoorLo = 0.85, kDoorHi = 1.75;       // x in a room's own frame

/// A row of rooms: z of its door wall, and the turn that takes +Z of a room's frame (door to window side) into it.
struct Row {
  double doorZ, turn, lo, hi; // lo, hi: z of the walls it lies between
};
constexpr std::array<Row, 4> kRows{{
    {kDepth, 180, 0, kDepth},
    {kDepth + kCorridor, 0, kDepth + kCorridor, 2 * kDepth + kCorridor},
    {3 * kDepth + kCorridor, 180, 2 * kDepth + kCorridor, 3 * kDepth + kCorridor},
    {3 * kDepth + 2 * kCorridor, 0, 3 * kDepth + 2 * kCorridor, kAcross},
}};

class Office : public SceneBuilder {
 public:
  explicit Office(const Order& order) : SceneBuilder(order), columns_(full() ? 12 : 3) {
    addShell();
    addRoomWalls();
    addRooms();
    addLights();
    camera("corridor", {0.6, 1.65, kDepth + 0.5 * kCorridor}, {10, 1.5, kDepth + 0.5 * kCorridor});
    camera("room", roomPoint(1, 1, {1.3, 1.6, 0.6}), roomPoint(1, 1, {-0.8, 1.0, 4.0}));
    camera("cross corridor", {length() + 0.5 * kCorridor, 1.65, kDepth}, {length(), 1.4, 3 * kDepth});
  }

 private:
  double length() const { return kPitch * columns_; }

  static dvec3 roomPoint(int column, const Row& row, const dvec3& p) {
    const double sign = row.turn == 0 ? 1 : -1;
    return {kPitch * (column + 0.5) + sign * p.x, p.y, row.doorZ + sign * p.z};
  }
  static dvec3 roomPoint(int column, int row, const dvec3& p) { return roomPoint(column, kRows[size_t(row)], p); }

  void addShell() {
    const double x0 = -kCorridor, x1 = length() + kCorridor, w = kOuterWall, lo = -kSunk, hi = kHeight + kSunk;
    place("floor", box({x0 - w - 0.1, -0.3, -w - 0.1}, {x1 + w + 0.1, 0, kAcross + w + 0.1}), carpet_);
    place("ceiling", box({x0 - w - 0.2, kHeight, -w - 0.2}, {x1 + w + 0.2, kHeight + 0.3, kAcross + w + 0.2}),
          ceiling_);
    Geometry outer = box({x0 - w, lo, -w}, {x1 + w, hi, 0});
    outer.add(box({x0 - w, lo, kAcross}, {x1 + w, hi, kAcross + w}));
    outer.add(box({x0 - w, lo, 0}, {x0, hi, kAcross}));
    outer.add(box({x1, lo, 0}, {x1 + w, hi, kAcross}));
    place("outer walls", outer, white_);
  }

  void addRoomWalls() {
    const double lo = -kSunk, hi = kHeight + kSunk;
    const Index doorWall = mesh("door wall",
                                wallWithOpening({-0.5 * kPitch, lo, -kHalfWall}, {0.5 * kPitch, hi, kHalfWall},
                                                {kDoorLo, lo}, {kDoorHi, kDoorHeight}),
                                white_);
    Geometry leaf = box({kDoorHi + 0.02, 0.01, kHalfWall + 0.02}, {kDoorHi + 0.06, kDoorHeight - 0.02, 0.98});
    leaf.add(box({kDoorHi - 0.04, 1.0, 0.86}, {kDoorHi + 0.03, 1.02, 0.9})); // handle
    const Index door = mesh("door", leaf, wood_);
    place("middle wall", box({0, lo, 0.5 * kAcross - kHalfWall}, {length(), hi, 0.5 * kAcross + kHalfWall}), white_);

    // Walls between rooms end inside the walls that they meet; the first and last of a row also make the corner.
    const auto crossWall = [&](double extra) { return box({-kHalfWall, lo, -extra}, {kHalfWall, hi, kDepth + extra}); };
    const Index corner = mesh("corner wall", crossWall(kHalfWall), white_);
    const std::array<Index, 4> paints{white_, paint("ochre paint", {0.68, 0.46, 0.16}),
                                      paint("blue paint", {0.18, 0.34, 0.58}), paint("red paint", {0.6, 0.16, 0.12})};
    std::vector<Index> painted;
    for (const Index paint : paints)
      painted.push_back(mesh("room wall " + std::to_string(painted.size()), crossWall(0), paint));
    for (size_t r = 0; r < kRows.size(); ++r)
      for (int i = 0; i <= columns_; ++i) {
        const bool end = i == 0 || i == columns_;
        const std::string name = label("", r, i);
        place("wall" + name, end ? corner : painted[(size_t(i) + 2 * r) % painted.size()],
              {kPitch * i, 0, kRows[r].lo});
        if (i == columns_) continue;
        place("door wall" + name, doorWall, roomPoint(i, int(r), dvec3(0)), kRows[r].turn);
        place("door" + name, door, roomPoint(i, int(r), dvec3(0)), kRows[r].turn);
      }
  }

  static std::string label(const char* what, size_t row, int column) {
    return std::string(what) + " " + char('A' + row) + std::to_string(column + 1);
  }

  /// Meshes of one kind of room in the room's frame, one per material.
  using RoomKind = std::vector<Index>;

  RoomKind studyRoom() {
    const std::string n = "study ";
    Geometry wood = moved(turned(table(1.6, 0.75, true), 180), {-0.9, 0, 3.5});
    for (const double x : {-1.35, 0.0})
      wood.add(turned(shelf(1.2, 2.0, 0.32, 5), 180), {x, 0, kDepth - kHalfWall - 0.2});
    Geometry dark = moved(turned(chair(detail(28, 6)), 180), {-0.8, 0, 2.75});
    dark.add(turned(chair(detail(28, 6)), 70), {0.9, 0, 3.5});
    dark.add(turned(screen(), 180), {-0.95, 0.74, 3.75});
    dark.add(turned(screen(), 165), {-0.3, 0.74, 3.75});
    dark.add(keyboard(detail(15, 2)), {-0.8, 0.74, 3.4});
    RoomKind kind{mesh(n + "wood", wood, wood_), mesh(n + "chairs and screens", dark, dark_)};
    const std::array<Index, 3> colors{bookRed_, bookBlue_, bookPale_};
    for (uint32_t k = 0; k < 3; ++k) {
      Geometry row;
      for (const double x : {-1.35, 0.0})
        row.add(turned(books(1.2, 2.0, 0.32, 5, k, full() ? 0.032 : 0.15), 180), {x, 0, kDepth - kHalfWall - 0.2});
      kind.push_back(mesh(n + "books " + std::to_string(k), row, colors[k]));
    }
    addGreen(kind, n);
    return kind;
  }

  RoomKind meetingRoom() {
    const std::string n = "meeting ";
    Geometry wood = moved(table(1.2, 2.2, false), {-0.5, 0, 3.2});
    Geometry dark;
    for (const double z : {2.5, 3.2, 3.9}) {
      dark.add(turned(chair(detail(24, 6)), 90), {0.35, 0, z});
      dark.add(turned(chair(detail(24, 6)), 270), {-1.35, 0, z});
    }
    Geometry pale = box({-1.6, 1.0, kDepth - kHalfWall - 0.04}, {0.9, 2.2, kDepth - kHalfWall - 0.01}); // board
    for (int i = 0; i < 6; ++i)
      pale.add(mug(detail(24, 6)),
               {-0.5 + (i % 2 ? 0.4 : -0.4), 0.74, 2.5 + 0.7 * (i / 2) + 0.1 * hashed(uint32_t(i))});
    RoomKind kind{mesh(n + "table", wood, wood_), mesh(n + "chairs", dark, dark_),
                  mesh(n + "board and mugs", pale, bookPale_)};
    addGreen(kind, n);
    return kind;
  }

  void addGreen(RoomKind& kind, const std::string& name) {
    const dvec3 corner(1.38, 0, 4.28);
    Geometry pots = moved(pot(0.2, 0.36, detail(32, 10)), corner);
    pots.add(pot(0.13, 0.3, detail(24, 8)), {-1.75, 0, 1.0}); // waste bin
    kind.push_back(mesh(name + "pots", pots, clay_));
    kind.push_back(mesh(name + "plant", moved(fronds(detail(48, 12), 0.58, 0.4, detail(10, 3)), corner), leaf_));
  }

  void addRooms() {
    const std::array<RoomKind, 2> kinds{studyRoom(), meetingRoom()};
    for (size_t r = 0; r < kRows.size(); ++r)
      for (int i = 0; i < columns_; ++i) {
        const RoomKind& kind = kinds[(size_t(i) + r) % 3 == 2 ? 1 : 0];
        for (size_t m = 0; m < kind.size(); ++m)
          place(label("furniture", r, i) + " part " + std::to_string(m), kind[m], roomPoint(i, int(r), dvec3(0)),
                kRows[r].turn);
      }
  }

  /// Six emitting panels over the corridors and eight lamps in rooms.
  void addLights() {
    const Index glow = glowing("panel light", {1, 0.95, 0.85}, 12);
    const Index housing = mesh("panel housing", panelHousing(1.2, 0.5), dark_);
    const Index panel = mesh("panel", panelEmitter(1.2, 0.5), glow);
    const double middle = 0.5 * kCorridor, west = -middle, east = length() + middle;
    const std::array<dvec3, 6> places{dvec3(0.18 * length(), kHeight, kDepth + middle),
                                      {0.72 * length(), kHeight, kDepth + middle},
                                      {0.3 * length(), kHeight, 3 * kDepth + 1.5 * kCorridor},
                                      {0.85 * length(), kHeight, 3 * kDepth + 1.5 * kCorridor},
                                      {west, kHeight, 0.5 * kAcross},
                                      {east, kHeight, 0.5 * kAcross}};
    for (size_t i = 0; i < places.size(); ++i) {
      place("panel housing " + std::to_string(i + 1), housing, places[i], i < 4 ? 0 : 90);
      place("panel " + std::to_string(i + 1), panel, places[i], i < 4 ? 0 : 90);
    }

    const Index shade = mesh("lamp shade", lampShade(detail(32, 10)), bookPale_);
    constexpr std::array<dvec3, 3> kWarmToCold{dvec3(1, 0.78, 0.5), dvec3(1, 0.92, 0.8), dvec3(0.8, 0.9, 1)};
    for (int i = 0; i < 8; ++i) {
      const int row = i / 2, column = i % 2 ? columns_ - 1 - row % 2 : row % 2;
      const dvec3 hung = roomPoint(column, row, {0.4, kHeight, 2.3});
      place("lamp shade " + std::to_string(i + 1), shade, hung);
      lamp("lamp " + std::to_string(i + 1), kWarmToCold[size_t(i) % 3], 7, hung - dvec3(0, 0.42, 0));
    }
  }

  int columns_; // rooms in a row
  const Index white_ = paint("white paint", {0.76, 0.74, 0.7}), ceiling_ = paint("ceiling", {0.78, 0.78, 0.76});
  const Index carpet_ = paint("carpet", {0.3, 0.33, 0.36}), wood_ = paint("wood", {0.48, 0.3, 0.16});
  const Index dark_ = paint("dark plastic", {0.1, 0.1, 0.12}), clay_ = paint("clay", {0.55, 0.28, 0.18});
  const Index bookRed_ = paint("red books", {0.5, 0.1, 0.08}), bookBlue_ = paint("blue books", {0.1, 0.2, 0.4});
  const Index bookPale_ = paint("pale books", {0.72, 0.68, 0.58}), leaf_ = fabric("leaf", {0.1, 0.34, 0.08});
};

} // namespace

GeneratedScene writeOffice(const Order& order) { return Office(order).write(); }

} // namespace lambent::content
