// All pixels of an image, row by row.
#pragma once

#include "tests/support/test.h"

namespace lambent::test {

struct Pixel {
  int x, y;
};

class Pixels {
 public:
  class Iterator {
   public:
    Iterator(Pixel at, int firstX, int endX) : at_(at), firstX_(firstX), endX_(endX) {}
    Pixel operator*() const { return at_; }
    Iterator& operator++() {
      if (++at_.x == endX_) at_ = {firstX_, at_.y + 1};
      return *this;
    }
    bool operator!=(const Iterator& other) const { return at_.y != other.at_.y || at_.x != other.at_.x; }

   private:
    Pixel at_;
    int firstX_, endX_;
  };
  Pixels(int width, int height) : first_{0, 0}, end_{width, height} {}
  Pixels(Pixel first, Pixel end) : first_(first), end_(end) {} // up to, not with `end`
  template <class Image> explicit Pixels(const Image& image) : Pixels(image.width, image.height) {}

  Iterator begin() const { return {first_, first_.x, end_.x}; }
  Iterator end() const { return {{first_.x, end_.y}, first_.x, end_.x}; }

 private:
  Pixel first_, end_;
};

} // namespace lambent::test
