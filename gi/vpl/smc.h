// Sequential Monte Carlo instant radiosity on the CPU (Hedman, Karras, Lehtinen 2017; "paper 1"): the contents page of
// this folder in data-flow order, one .cpp per stage. All stages are deterministic functions of their arguments, for
// any number of threads. World space, metres; radiance in W/(m² sr).
//
//   visible points → indirect visibility → candidates → resample → radiosity → density → replace   (update_vpls.cpp)
#pragma once

#include "engine/core/profile.h"
#include "gi/lighting/dirty_region.h"
#include "gi/lighting/light_set.h"
#include "gi/plan/settings.h"
#include "gi/plan/stages.h"
#include "gi/vpl/kept_paths.h"
#include "gi/vpl/vpl_set.h"

#include <functional>
#include <memory>
#include <optional>

namespace lambent {

/// A point X on a surface that the camera sees.
struct VisiblePoint {
  vec3 position; // off the surface (offsetPoint)
  vec3 normal;   // geometric, towards the camera
};

/// Stage 1. One jittered camera ray per cell of a grid of about `count` cells; rays that leave the scene give no point.
std::vector<VisiblePoint> findVisiblePoints(const RayQuery& rays, const CameraView& camera, int count, uint32_t seed,
                                            uint32_t frame, RayCounts& counts);

/// What is known since the last update.
struct VisibilityUpdate {
  bool camera = true;                        // the camera changed
  const DirtyRegion* moved = &kNothingMoved; // where geometry did
  std::span<const uint8_t> carried = {};     // by slot: this VPL moved with its object; empty: none did
};

/// Stage 2a. Tests VPLs by their mailbox points (paper 1, 3.2.2): in the frustum, camera → point clear, point → VPL
/// clear. Rays are cast only where the camera or something in the way changed. A mailbox point in a place where
/// geometry moved is given up: it may hang in mid-air now. Sets `valid`.
void verifyMailboxes(std::span<Vpl> vpls, const RayQuery& rays, const CameraView& camera,
                     const VisibilityUpdate& update, RayCounts& counts);

/// Stage 2b. For those left: two rounds of up to `raysPerPoint` rays from every visible point to random unverified
/// VPLs. Points go in blocks, and a block skips what earlier blocks verified.
void verifyByPoints(VplSet& set, const RayQuery& rays, std::span<const VisiblePoint> points, int raysPerPoint,
                    uint32_t seed, RayCounts& counts);

/// A point that a ray from a visible point met: a place where a VPL could stand.
struct CandidateHit {
  vec3 position, normal, geometricNormal, albedo;
  vec3 from;             // the visible point (off its surface): the first mailbox
  uint32_t instance = 0; // index into SceneView::instances
  uint32_t primitive = 0, triangle = 0;
  vec2 barycentric{0};
  float share = 1; // as SurfaceHit
};

/// Stage 3. `count` cosine-distributed rays spread evenly over the visible points; misses give no hit.
std::vector<CandidateHit> traceCandidates(const RayQuery& rays, std::span<const VisiblePoint> points, int count,
                                          uint32_t seed, uint32_t frame, RayCounts& counts);

/// A VPL at a hit, of the hit's colour, valid and not yet alive. Rides on the hit's object from now on.
Vpl vplAt(const CandidateHit& hit, const SceneView& view, uint64_t id);

/// Stage 4. Picks up to `count` different hits with probability ∝ area that a hit stands for (1/density of hits,
/// nearest neighbour), so that picks are uniform over the indirectly visible surface (paper 1, 3.2.1). At most 8
/// retries per pick.
struct Resampled {
  std::vector<uint32_t> picks; // indices of hits in pick order
  double area = 0;             // m², estimate of the surface that all hits lie on
};
Resampled resampleUniformInArea(std::span<const CandidateHit> hits, int count, uint32_t seed, uint32_t frame);

/// Stage 5. Reflected radiance of each VPL by `paths` light paths with next-event estimation and multiple importance
/// sampling for emitters (paper 1, 3.2.3). Random numbers depend on the VPL's id alone. `bounces` B ≥ 1: direct light
/// at the VPL plus B − 1 further bounces.
///
/// There are two estimates with numbers of their own. The sampler keeps what looks bright and drops what looks dark, so
/// the noise of the estimate that it judges by is biased upwards in the set that survives (in a room lit by a narrow
/// spot the set brought 45 % too much light when both were one). Rendering uses the other, which no choice has seen.
///
/// With `cells` (one for each VPL, or none) the paths of a VPL start all over its cell, so the result is the mean over
/// the surface that it stands for.
enum class RadianceUse { Rendering, Sampling };

struct RadianceUpdate {
  int paths = 16, bounces = 3;
  uint32_t seed = 1;
  RadianceUse use = RadianceUse::Rendering;
  // Since the kept paths were brought up to date:
  const DirtyRegion* moved = &kNothingMoved; // where geometry changed
  bool lightsChanged = true;                 // emitters on moving objects count
  bool instancesChanged = false;             // added or removed: indices of instances are others
  bool lastRays = false;                     // send the last vertices' rays even when neither emitter nor sky is there
};

/// One estimate. With `kept`, what is left of the paths of last time is used, and the radiance stays where nothing
/// that it depends on changed.
struct RadianceJob {
  Vpl* vpl = nullptr;
  const VplCell* cell = nullptr; // null: all paths start at the VPL
  KeptPaths* kept = nullptr;     // null: from scratch
  int path = -1;                 // only this one of the paths, from scratch: its own estimate, not its share of all
};

struct PathCounts {
  uint64_t paths = 0, traced = 0; // light paths asked for, and those traced
  uint64_t retraced = 0;          // of these, paths that had been traced before: their start or what they touch moved
  uint64_t lit = 0;               // VPLs and candidates whose light was added up again
  uint64_t bounceRays = 0;        // rays that looked for vertices beyond the first
  uint64_t lastRays = 0;          // rays of last vertices, which look for emitters and sky only
  RayCounts rays;
  PathCounts& operator+=(const PathCounts& o) {
    paths += o.paths, traced += o.traced, retraced += o.retraced, lit += o.lit, bounceRays += o.bounceRays,
        lastRays += o.lastRays;
    rays += o.rays;
    return *this;
  }
};

/// Estimates radiance: bit for bit that of an estimate from scratch, whatever was kept.
PathCounts estimateRadiance(std::span<const RadianceJob> jobs, const RayQuery& rays, const LightSet& lights,
                            const RadianceUpdate& update);
/// Estimates radiance from scratch.
void estimateRadiance(std::span<Vpl* const> vpls, const RayQuery& rays, const LightSet& lights, int paths, int bounces,
                      uint32_t seed, RayCounts& counts, RadianceUse use = RadianceUse::Rendering,
                      std::span<const VplCell* const> cells = {});

/// Says whether two points can lie on one piece of surface: not on opposite sides of a thin wall. A right angle counts
/// as the same side, because walls that meet in a corner share its neighbourhood; leaving each other out there would
/// make areas along every edge too large (measured: 15 % more light in an empty room).
inline bool sameSide(const vec3& normalA, const vec3& normalB) { return glm::dot(normalA, normalB) > -0.5f; }

/// A place of a light.
struct DensityPoint {
  vec3 position, normal;
  float share = 1; // of its surface's area that counts: of what blends rays meet a part
};
/// The points of those lights that are alive, and which these are.
struct LivePoints {
  std::vector<DensityPoint> points;
  std::vector<uint32_t> slots;
};
template <class Light> LivePoints livePoints(std::span<const Light> lights) {
  LivePoints live;
  for (uint32_t i = 0; i < lights.size(); ++i)
    if (lights[i].alive) {
      live.points.push_back({lights[i].position, lights[i].normal});
      if constexpr (requires { lights[i].share; }) live.points.back().share = lights[i].share;
      live.slots.push_back(i);
    }
  return live;
}

/// Stage 6. Area that each point stands for, π r_k² / k, with r_k the distance to the k-th nearest of `among` (paper 1,
/// eq. 7 solved for area). A query point that is itself in `among` is passed over when `self` says so. With KnnSide
/// only neighbours on the same side count. Points with
/// fewer than k neighbours get the area of the neighbours they have, scaled, and never more than `areaLimit`, m².
std::vector<float> representedAreas(std::span<const DensityPoint> queries, std::span<const DensityPoint> among,
                                    bool self, int k, DensityEstimator estimator, float areaLimit);
/// k for rendering, paper 1, eq. 8, read as ⌊√(N/32)⌋. The reading ⌊√N/32⌋, 1 at N = 2048, finds 35 % too much light
/// (gi/README.md).
int neighboursForRendering(const SmcSettings& settings);

/// Nearest neighbours of points on a surface.
class NeighbourTree {
 public:
  explicit NeighbourTree(std::span<const DensityPoint> among); // must outlive the tree; positions finite
  ~NeighbourTree();
  /// The `count` nearest of `among`, ascending; returns how many there are. Both spans hold `count`.
  size_t nearest(const vec3& position, size_t count, std::span<uint32_t> index, std::span<float> distance2) const;
  /// Index of the i-th point in the tree's own order (queries in that order are neighbours in memory).
  std::span<const uint32_t> order() const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// Stage 6, not as in the paper. Brings the cells of all VPLs up to date and sets their areas. `moved` lists slots
/// whose VPL is new or stands elsewhere; cells that `dirty` touches are redrawn. Returns the slots whose cell
/// changed, ascending: their radiance changes too.
std::vector<uint32_t> updateCells(VplSet& set, const RayQuery& rays, const DirtyRegion& dirty,
                                  std::span<const uint32_t> moved, float radiusLimit, uint32_t seed, RayCounts& counts);

/// Stage 7. Replaces at most `maxMoves` VPLs: unverified ones first, then the weakest, as many as there are candidates
/// stronger than 95 % of the set (paper 1, 3.2.5). Each pick lowers the area of candidates near it, so winners of one
/// frame do not sit side by side. Empty slots are filled beyond the bound. Slots never change place.
/// Candidates that were taken are marked alive.
VplChanges replaceVpls(VplSet& set, std::vector<Vpl>& candidates, int maxMoves, DensityEstimator estimator);

/// Parts of an update that may be left out or forced (gi/plan/effects.h). By default all is done that changes call for.
struct VplEffects {
  bool replace = true;     // false: slots once filled keep their VPLs, and no candidates are looked for
  bool relight = true;     // false: only VPLs that are new are lit
  bool relightAll = false; // all are lit as if the lights had changed
  bool carryAll = false;   // all are placed as if their objects had moved
  bool lastRays = false;   // see RadianceUpdate
};

/// What one update needs, apart from the set.
struct VplUpdate {
  const SceneView& view;
  const RayQuery& rays;
  const LightSet& lights;
  const SmcSettings& settings;
  uint32_t seed = 1;
  VplSettings vpl = {}; // of the comparators (gi/vpl/sources.h)
  VplEffects effects = {};
  bool settingsChanged = false; // since the last update: of lights or of anything above
};

/// Times and rays of one update, for the frame log.
struct VplUpdateLog {
  std::vector<StageTime> stages;
  double ms = 0; // of the whole update
  RayCounts points, validation, candidates, radiosity, cells;
  PathCounts paths;            // of VPLs and candidates
  uint32_t relit = 0;          // VPLs whose radiance was added up again
  uint32_t relitForChange = 0; // of these, because lights or geometry changed
};

/// Runs all stages once, in place (paper 1, algorithm 1). On a camera cut (most VPLs lost at once) the bound on
/// replacements is lifted and the stages run several times. The first call fills the set and runs warmupOf()
/// iterations; `progress` (may be empty) is called for each.
VplChanges updateVpls(VplSet& set, const VplUpdate& in, VplUpdateLog& log,
                      const std::function<void(int, int)>& progress = {});

/// Moves the VPLs of `view`'s moved objects (of all, if so asked) to their places there, and gives up those whose
/// object is gone. Returns the slots that now stand elsewhere, ascending. updateVpls does it too; a second time changes
/// nothing.
std::vector<uint32_t> carryVpls(VplSet& set, const SceneView& view, bool all);

/// Asks a gather for the light that the receivers' lobes reflect, as well as for irradiance.
struct GlossyGather {
  const SceneView& view;      // camera and materials
  std::vector<vec3> radiance; // filled: W/(m² sr) over glossyTint (shaders/shared/ggx.h)
};

/// Irradiance at the camera's primary hits from all lights with every pair tested by a ray (paper 1, fig. 8 "all VPLs -
/// ray tracing"). Row 0 at the top; zero where the camera sees nothing.
std::vector<vec3> gatherByRays(const RayQuery& rays, const CameraView& camera, std::span<const VirtualLight> lights,
                               const GatherSettings& settings, RayCounts& counts, GlossyGather* glossy = nullptr,
                               const SceneView* normalMaps = nullptr);

/// What the camera sees at points (u, v) of its image, v down, in [0, 1]. Rays start at the near plane, as the
/// rasteriser's, and meet of blended surfaces those that it shows there; or those of the points' keys, where given
/// (shaders/shared/coverage.h).
std::vector<SurfaceHit> surfacesAt(const RayQuery& rays, const CameraView& camera, std::span<const vec2> points,
                                   const SceneView* normalMaps = nullptr, std::span<const uint32_t> keys = {});

/// Computes irradiance at surfaces from all lights, a ray for every pair; zero where there is no surface.
std::vector<vec3> irradianceByRays(const RayQuery& rays, std::span<const SurfaceHit> surfaces,
                                   std::span<const VirtualLight> lights, const GatherSettings& settings,
                                   RayCounts& counts, GlossyGather* glossy = nullptr);

/// Geometry term of a VPL at a receiver as the gather uses it (shaders/lib/vpl_shading.glsl shares the formula):
/// cosines over squared distance, the distance widened by the VPL's own area and the result clamped as the settings
/// say, 1/m². Within 3e-7 of itself for squared distances and areas of 1e-20 to 1e20 m².
float geometryTerm(float cosReceiver, float cosVpl, float distance2, float area, const GatherSettings& settings);

} // namespace lambent
