// What hard cases are made of: the room that they are variations of, two rooms, lamps; and the lists that they stand
// in, one for each question.
#pragma once

#include "tests/hard/hard_case.h"

#include <glm/gtc/matrix_transform.hpp>

namespace lambent::test {

/// A lamp of 1 W/sr in the middle of room() sends 4π W to its 24 m²: three bounces at an albedo of 0.7 make 0.80 W/m²
/// (paths: 0.797 ± 0.0004 from this camera, 0.70 to 0.86 from others).
inline constexpr HardBounds kRoom{0.65, 1.05, 0.5};

/// The room and its lamp `unit` times as large, around `centre`.
void roomOf(HardWorld& w, float unit, const vec3& centre = vec3(0), float light = 1);

/// Maps as fine as leaks ask for: at 32² the texels at a wall's edge let 0.2 to 0.4 % of the light of ir's few lights
/// through, at 64² a quarter of that, at 128² 0.005 %.
void fineMaps(HardWorld& w);

/// Two rooms side by side, a wall of this thickness between them; the lamp in the one that the camera is not in.
void twoRooms(HardWorld& w, float wall);

/// Two rooms of 2 m with a wall of 10 cm between them, and in it a sliding door of 6 cm: 0.8 m by 1.6 m. The lamp of
/// 10 W/sr is in the room that the camera is not in. The door is shut, its edges within the wall.
void doorway(HardWorld& w);
/// The door leaves so many metres free.
void slide(HardWorld& w, float open);

/// So many lamps all over the room, 1 W/sr together.
void lamps(HardWorld& w, int count);

void spot(LightView& light, const vec3& direction, float cosine);

/// Adds a row: `add` one that all techniques show, `some` one that one of each kind shows (ShownBy).
using Add = std::function<HardCase&(const char* name, const char* reason, const HardBounds& bounds,
                                    std::function<void(HardWorld&)> make)>;
void addLightCases(const Add& add, const Add& some);   // where lights are, and how much light there is
void addPlaceCases(const Add& add, const Add& some);   // sizes, distances, walls and eyes
void addSurfaceCases(const Add& add, const Add& some); // triangles, materials, transforms
void addMovingCases(const Add& add, const Add& some);  // what comes, goes and moves
void addSettingCases(const Add& add, const Add& some); // settings at their ends

} // namespace lambent::test
