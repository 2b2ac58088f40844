// Doors that swing and lifts that rise when somebody uses them or presses a button. Which nodes do is a table
// (movers.cpp), by the names that the bundled scenes give them.
#pragma once

#include "engine/scene/scene.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace lambent {

class Movers {
 public:
  /// Finds them in the scene and adds their buttons. Before anything is built from the scene's assets.
  explicit Movers(Scene& scene);

  /// Says what using the instance would do, in words; empty: nothing.
  std::string offer(uint32_t instance) const;
  /// Sets what the instance is, or is a button of, in motion. Says whether there is such a thing.
  bool use(uint32_t instance);

  /// Moves what moves, for so many seconds: to be called after the scene was animated. Says whether anything moves.
  bool update(double seconds);
  /// Turns back what moves: somebody is in its way.
  void turnBack();

  /// Puts all back as at the start.
  void reset();

  /// Returns where the used movers are, in stops, by their nodes' names.
  std::map<std::string, double> used() const;
  /// Throws InputError, with `file`, where there is no mover of a name.
  void check(const std::map<std::string, double>& places, const std::string& file) const;
  /// Puts these there at once, and all others as at the start: after the scene was animated. Throws as check.
  void show(const std::map<std::string, double>& places, const std::string& file);
  size_t count() const { return movers_.size(); }
  /// Where the mover with that name is: 0 at its first stop, 1 at its second, and so on. -1: there is none.
  double place(const std::string& node) const;

 private:
  struct Kind;
  struct Mover {
    const Kind* kind;
    Entity entity;
    Transform rest;
    double at = 0, speed = 0; // in stops, and of these per second
    int target = 0, from = 0;
    bool used = false; // until then a shot or an animation may move it
  };
  struct Button {
    Entity entity;
    size_t mover = 0;
    int stop = 0; // kNext: the next one
  };
  static constexpr int kNext = -1;
  static const std::vector<Kind>& kinds();

  void addButtons(size_t mover);
  void step(Mover& mover, double seconds);
  void apply(const Mover& mover);
  void reset(Mover& mover);
  /// What using the instance would move, and the button that the instance is; null: there is none.
  std::pair<const Mover*, const Button*> found(uint32_t instance) const;

  Scene& scene_;
  std::vector<Mover> movers_;
  std::vector<Button> buttons_;
};

} // namespace lambent
