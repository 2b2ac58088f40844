// A thing that waits for daylight: a node whose name says how much, "altar, goal 0.02" in W/m². What it gets is
// measured by light paths of its own, whatever the image shows, with all that is carried about. Sun, sky and what
// glows count; lamps do not, so that light has to be led there.
#pragma once

#include "game/rules/solids.h"

#include <memory>
#include <string>

namespace lambent {

class Goal {
 public:
  /// The scene's goal; null where no node is one. `scene` must outlive it. After all meshes were added.
  static std::unique_ptr<Goal> find(const Scene& scene);

  /// Takes more paths, of the scene as it stands now; those of an earlier state of the scene no longer count.
  void update();
  /// Resets the goal to how it was at the start.
  void reset();

  const std::string& what() const { return what_; }
  float wanted() const { return wanted_; } // W/m²
  /// Mean over the thing's surface, W/m²: the latest frames' while anything moves, else of all since then.
  float irradiance() const { return float(shown_); }
  float error() const; // standard error of what was measured since anything moved
  /// Says whether the goal is reached by three standard errors, checked whenever the number of passes has doubled. Once
  /// reached, it stays so.
  bool reached() const { return reached_; }

 private:
  /// A place on the surface, by triangle.
  struct Place {
    uint32_t primitive, triangle;
    vec2 barycentric;
  };
  Goal(const Scene& scene, Entity entity, std::string what, float wanted);
  std::vector<SurfaceHit> surfaces() const;

  const Entity entity_;
  const std::string what_;
  const float wanted_;
  Solids solids_; // the player's lack what is carried
  std::vector<Place> places_;
  std::vector<vec3> suns_; // directions and irradiances that the sums are of
  Sky sky_;
  uint32_t frame_ = 0, passes_ = 0;
  double sum_ = 0, squares_ = 0, shown_ = 0; // of passes
  bool reached_ = false;
};

} // namespace lambent
