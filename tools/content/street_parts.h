// What the night street is made of. Fronts of houses: x = 0 is the middle of the front, z = 0 its outer face, +Z goes
// into the house, y = 0 the pavement.
#pragma once

#include "tools/content/shapes.h"

#include <string_view>

namespace lambent::content {

constexpr double kFrontWidth = 10.0, kShopHeight = 3.6, kUpperHeight = 3.1; // metres
constexpr int kWindows = 4;                                                 // on every upper storey
constexpr double kShopDepth = 3.2;

/// Where a window of an upper storey (from 1) has its pane: the middle of its lower edge.
dvec3 paneAt(int storey, int window);

/// Front with windows, the mass behind it, and a shop on the ground floor, hollow and open to the street.
Geometry frontMasonry(int storeys);
/// Sills, bands between the storeys and a cornice.
Geometry frontStonework(int storeys);
/// Window crosses and shop front: posts, transom, door leaf.
Geometry frontWoodwork(int storeys);
/// A window's pane on y = 0, centred on x, facing the street; a shop's fittings: counter, shelves.
Geometry pane();
Geometry shopFittings();
/// Sloped cloth over a shop window, only every second stripe: `odd` or even ones.
Geometry awning(bool odd);
/// Letters of `text`, 0.36 m high, centred on x and standing on y = 0, facing -Z: a sheet.
Geometry lettering(std::string_view text);

/// Street lamp whose pole stands on y = 0 and whose arm reaches `kArm` towards +Z; the lens is a sheet.
constexpr double kArm = 1.4, kLensHeight = 5.6;
Geometry streetLamp(uint32_t segments);
Geometry lampLens();

/// Saloon car along X, its front at +X, wheels on y = 0.
Geometry carBody();
Geometry carGlass();
Geometry carWheels(uint32_t segments);
Geometry carHeadlights(); // sheets
Geometry carTailLights();
constexpr double kCarHalfLength = 2.15, kHeadlightY = 0.64, kHeadlightZ = 0.58;

} // namespace lambent::content
