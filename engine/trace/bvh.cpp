#include "engine/trace/bvh.h"

#include "engine/core/error.h"

#if EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace lambent {

namespace {

/// As Embree builds it.
struct TreeNode {
  TreeNode* children[2] = {nullptr, nullptr}; // none: a leaf
  uint32_t count = 0, boxes[7];
};

void* createNode(RTCThreadLocalAllocator allocator, unsigned, void*) {
  return new (rtcThreadLocalAlloc(allocator, sizeof(TreeNode), 16)) TreeNode;
}

void setChildren(void* node, void** children, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i) static_cast<TreeNode*>(node)->children[i] = static_cast<TreeNode*>(children[i]);
}

/// Refitting finds the boxes.
void setBounds(void*, const RTCBounds**, unsigned, void*) {}

void* createLeaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* boxes, size_t count, void*) {
  auto* node = new (rtcThreadLocalAlloc(allocator, sizeof(TreeNode), 16)) TreeNode;
  node->count = uint32_t(count);
  for (size_t i = 0; i < count; ++i) node->boxes[i] = boxes[i].primID;
  return node;
}

void flatten(const TreeNode& from, Bvh& to) {
  const size_t at = to.nodes.size();
  to.nodes.emplace_back();
  if (from.count > 0) {
    to.nodes[at].leaf = uint32_t(to.order.size()) * 8 + from.count;
    to.order.insert(to.order.end(), from.boxes, from.boxes + from.count);
  } else {
    for (const TreeNode* child : from.children)
      if (child) flatten(*child, to);
    to.nodes[at].leaf = 0;
  }
  to.nodes[at].skip = uint32_t(to.nodes.size());
}

} // namespace

struct BvhBuilder::State {
  RTCDevice device = nullptr;
};

BvhBuilder::BvhBuilder() : state_(std::make_unique<State>()) {
  state_->device = rtcNewDevice(nullptr);
  if (!state_->device)
    throw RunError("Embree: no device (error " + std::to_string(int(rtcGetDeviceError(nullptr))) + ")");
}

BvhBuilder::~BvhBuilder() { rtcReleaseDevice(state_->device); }

Bvh BvhBuilder::build(std::span<const Aabb> boxes, uint32_t leafSize) const {
  CHECK(leafSize >= 1 && leafSize <= 7);
  std::vector<RTCBuildPrimitive> primitives;
  for (size_t i = 0; i < boxes.size(); ++i) {
    const Aabb& b = boxes[i];
    if (b.empty() || !isFinite(b.lo) || !isFinite(b.hi)) continue;
    primitives.push_back({b.lo.x, b.lo.y, b.lo.z, 0, b.hi.x, b.hi.y, b.hi.z, uint32_t(i)});
  }
  Bvh out;
  if (primitives.empty()) return out;
  RTCBVH bvh = rtcNewBVH(state_->device);
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.maxLeafSize = leafSize;
  arguments.bvh = bvh;
  arguments.primitives = primitives.data();
  arguments.primitiveCount = arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = createNode;
  arguments.setNodeChildren = setChildren;
  arguments.setNodeBounds = setBounds;
  arguments.createLeaf = createLeaf;
  const auto* root = static_cast<const TreeNode*>(rtcBuildBVH(&arguments));
  if (root) flatten(*root, out);
  rtcReleaseBVH(bvh);
  if (!root)
    throw RunError("Embree: a hierarchy cannot be built (error " +
                   std::to_string(int(rtcGetDeviceError(state_->device))) + ")");
  refit(out, boxes);
  return out;
}

void refit(Bvh& bvh, std::span<const Aabb> boxes) {
  for (size_t i = bvh.nodes.size(); i-- > 0;) {
    BvhNode& node = bvh.nodes[i];
    Aabb box;
    if (node.leaf > 0) {
      for (uint32_t k = 0; k < node.leaf % 8; ++k) box.add(boxes[bvh.order[node.leaf / 8 + k]]);
    } else {
      for (size_t child = i + 1; child < node.skip; child = bvh.nodes[child].skip)
        box.add({bvh.nodes[child].lo, bvh.nodes[child].hi});
    }
    node.lo = box.lo;
    node.hi = box.hi;
  }
}

} // namespace lambent
