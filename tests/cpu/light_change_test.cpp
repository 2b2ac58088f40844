// By how much the light of tiles changed: closed cases.
#include "gi/lists/light_change.h"

#include <gtest/gtest.h>

namespace lambent::test::light_change_test {

/// A grid of lights that look down on a place of the floor, and on one next to it.
struct LitPlace {
  std::vector<VirtualLight> lights;
  std::vector<vec3> before;
  std::vector<MovedSphere> moved;
  std::vector<SurfaceHit> places;

  LitPlace() {
    for (int i = 0; i < 100; ++i) {
      VirtualLight& l = lights.emplace_back();
      l.position = vec3(float(i % 10) * 0.4f - 1.8f, 1, float(i / 10) * 0.4f - 1.8f);
      l.normal = l.geometricNormal = vec3(0, -1, 0);
      l.radiance = vec3(1, 2, 3);
      l.area = 0.01f;
      l.alive = true;
      before.push_back(l.radiance);
    }
    see({vec3(0)});
  }
  void see(std::initializer_list<vec3> positions) {
    places.clear();
    for (const vec3& p : positions) {
      SurfaceHit& h = places.emplace_back();
      h.t = 1, h.position = p, h.normal = h.geometricNormal = vec3(0, 1, 0);
    }
  }
  LightChange change() const {
    const std::vector<LightChange> changes = lightChanges(
        {.lights = lights, .before = before, .moved = moved, .places = places, .perTile = int(places.size())});
    EXPECT_EQ(changes.size(), 1u);
    return changes.at(0);
  }
};

TEST(LightChange, SaysWhatLightsThatStayGained) {
  LitPlace place;
  EXPECT_EQ(place.change().share, 0);
  EXPECT_EQ(place.change().gained, 0);
  for (VirtualLight& l : place.lights) l.radiance *= 0.75f;
  EXPECT_NEAR(place.change().gained, -0.25f, 1e-4f);
  EXPECT_NEAR(place.change().share, 0.25f, 1e-4f);
  for (VirtualLight& l : place.lights) l.radiance = vec3(4, 8, 12);
  EXPECT_NEAR(place.change().gained, 0.75f, 1e-4f);
  for (VirtualLight& l : place.lights) l.radiance = vec3(0);
  EXPECT_NEAR(place.change().gained, -1, 1e-4f) << "all went out";
}

/// A light that comes takes area from its neighbours, which is no change of theirs.
TEST(LightChange, LooksAtRadianceNotAtArea) {
  LitPlace place;
  for (VirtualLight& l : place.lights) l.area *= 0.5f;
  EXPECT_EQ(place.change().gained, 0);
  EXPECT_EQ(place.change().share, 0);
}

TEST(LightChange, LightsThatCameAreUnknownNotGained) {
  LitPlace place;
  for (vec3& b : place.before) b = vec3(kOtherLight);
  EXPECT_EQ(place.change().gained, 0);
  EXPECT_NEAR(place.change().share, 1, 1e-4f) << "all others";
  place.before.clear();
  EXPECT_EQ(place.change().share, 1) << "nothing is known";
  LitPlace half;
  for (size_t i = 0; i < 50; ++i) half.before[i] = vec3(kOtherLight);
  EXPECT_NEAR(half.change().share, 0.5f, 0.1f);
}

TEST(LightChange, LightsThatWentAreUnknownToo) {
  LitPlace place;
  for (size_t i = 0; i < 25; ++i) place.lights[i * 4].alive = false;
  EXPECT_NEAR(place.change().share, 0.25f, 1e-4f);
  EXPECT_EQ(place.change().gained, 0);
}

/// Where lights gain and lose alike the sum stays, and what is left is as small as noise.
TEST(LightChange, NoiseOfManyLightsIsLittle) {
  LitPlace place;
  for (size_t i = 0; i < 100; ++i) place.lights[i].radiance *= (i + i / 10) % 2 ? 1.1f : 0.9f;
  EXPECT_LT(std::abs(place.change().gained), 0.01f);
  EXPECT_LT(place.change().share, 0.03f);
  EXPECT_GT(place.change().share, 0.01f);
}

TEST(LightChange, AnotherColourIsAChange) {
  LitPlace place;
  const float bright = luminance(vec3(1, 2, 3));
  for (VirtualLight& l : place.lights) l.radiance = vec3(bright / 0.2126f, 0, 0);
  EXPECT_LT(std::abs(place.change().gained), 1e-3f);
  EXPECT_GT(place.change().share, 0.5f);
}

TEST(LightChange, WhatMovesMayShadeWhatPassesIt) {
  LitPlace place;
  place.moved = {{vec3(0, 5, 0), 0.5f}, {vec3(9, 0.5f, 0), 0.5f}};
  EXPECT_EQ(place.change().share, 0) << "behind the lights, and beside them";
  place.moved = {{vec3(0.6f, 0.5f, 0), 0.5f}};
  const float half = place.change().share;
  EXPECT_GT(half, 0.2f);
  EXPECT_LT(half, 0.8f);
  place.moved.push_back({vec3(-0.6f, 0.5f, 0), 0.5f});
  EXPECT_NEAR(place.change().share, 2 * half, 0.2f) << "both sides";
  place.moved = {{vec3(0, 0.1f, 0), 0.3f}};
  EXPECT_NEAR(place.change().share, 1, 0.1f) << "on it";
  EXPECT_EQ(place.change().gained, 0);
}

TEST(LightChange, TheFirstPlaceThatIsSeenSpeaks) {
  LitPlace place;
  for (size_t i = 0; i < 100; ++i) place.lights[i].radiance *= i % 10 < 5 ? 0.5f : 1.0f;
  place.see({vec3(-1.5f, 0.5f, 0)});
  const float left = place.change().gained;
  place.see({vec3(1.5f, 0.5f, 0), vec3(-1.5f, 0.5f, 0)});
  EXPECT_GT(place.change().gained, left + 0.1f);
  place.places[0] = SurfaceHit{};
  EXPECT_EQ(place.change().gained, left);
  place.places[1] = SurfaceHit{};
  EXPECT_EQ(place.change().share, 0) << "nothing is seen";
}

TEST(LightChange, WhatIsNoNumberIsUnknown) {
  LitPlace place;
  place.before[3] = vec3(std::numeric_limits<float>::quiet_NaN());
  EXPECT_LE(place.change().share, 1);
  EXPECT_GE(place.change().share, 0);
  EXPECT_TRUE(std::isfinite(place.change().gained));
  place.lights[5].radiance = vec3(kInfinity);
  EXPECT_TRUE(std::isfinite(place.change().gained));
}

} // namespace lambent::test::light_change_test
