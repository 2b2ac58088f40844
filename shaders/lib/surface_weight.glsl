// How much the surface of a neighbouring pixel is like that of a pixel. After lib/gbuffer.glsl.
uniform float normalPower;
uniform float distanceSigma; // share of the view distance

/// What a neighbour is held to. The height above the pixel's plane needs no rebuilt position: the plane's equation is
/// linear in the pixel, times the neighbour's view distance for a perspective camera.
struct PixelPlane {
  vec3 normal;
  vec2 slope;
  float normalZ, base, height, inverseSigma;
};

bool isOrthographic() { return camera.lens.w > 0.0; }

PixelPlane planeAt(ivec2 pixel, float depth) {
  PixelPlane plane;
  plane.normal = texelFetch(gbufferNormal, pixel, 0).xyz;
  vec3 normalView = plane.normal * mat3(camera.worldFromView); // transpose times: world to view
  vec2 ray = ((vec2(pixel) + 0.5) * camera.size.zw * 2.0 - 1.0) * camera.lens.xy;
  float viewDistance = viewDistanceFromDepth(camera, depth);
  plane.slope = 2.0 * camera.size.zw * camera.lens.xy * normalView.xy;
  plane.normalZ = normalView.z;
  plane.base = dot(normalView.xy, ray) - (isOrthographic() ? 0.0 : normalView.z);
  plane.height = isOrthographic() ? plane.base - normalView.z * viewDistance : plane.base * viewDistance;
  plane.inverseSigma = 1.0 / (distanceSigma * viewDistance);
  return plane;
}

/// alignment^power · exp(-h²/2), with one exponential; `offset` from the plane's pixel to the neighbour.
float surfaceWeight(PixelPlane plane, ivec2 offset, ivec2 neighbour, float neighbourDepth) {
  float distance = viewDistanceFromDepth(camera, neighbourDepth);
  float line = plane.base + dot(plane.slope, vec2(offset));
  float height = isOrthographic() ? line - plane.normalZ * distance : line * distance;
  float deviation = (height - plane.height) * plane.inverseSigma;
  float alignment = max(dot(plane.normal, texelFetch(gbufferNormal, neighbour, 0).xyz), 1e-4);
  return exp2(normalPower * log2(alignment) - 0.7213475 * deviation * deviation);
}
