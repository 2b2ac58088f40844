// Where a pixel's value lies in a texture. Variant SUBSETS: in 16 tiles side by side, tile (x mod 4, y mod 4) with pixel (x, y)
// at (x/4, y/4); else in its own place.
uniform ivec2 tileSize;

ivec2 placeOf(ivec2 pixel) {
#ifdef SUBSETS
  return (pixel & 3) * tileSize + (pixel >> 2);
#else
  return pixel;
#endif
}
