#include "gi/lists/light_columns.h"

#include <algorithm>
#include <cfloat>

namespace lambent {

LightColumns columnsOf(std::span<const VirtualLight> lights, std::span<const uint32_t> order, float disk) {
  constexpr float kLeastDistance = 1e-6f; // between a place and a light, of the lights' extent
  LightColumns c;
  vec3 low(kInfinity), high(-kInfinity);
  for (const uint32_t slot : order) {
    const VirtualLight& l = lights[slot];
    low = glm::min(low, l.position), high = glm::max(high, l.position);
    c.x.push_back(l.position.x), c.y.push_back(l.position.y), c.z.push_back(l.position.z);
    c.nx.push_back(l.normal.x), c.ny.push_back(l.normal.y), c.nz.push_back(l.normal.z);
    c.power.push_back(l.intensity());
    c.widening.push_back(disk * l.area / kPi);
  }
  c.least = std::max(kLeastDistance * kLeastDistance * glm::dot(high - low, high - low), FLT_MIN);
  const size_t whole = (order.size() + kLanes - 1) / kLanes * kLanes;
  for (std::vector<float>* column : {&c.x, &c.y, &c.z, &c.nx, &c.ny, &c.nz, &c.power}) column->resize(whole, 0.0f);
  c.widening.resize(whole, 1.0f);
  return c;
}

} // namespace lambent
