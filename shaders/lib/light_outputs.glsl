// What a pass finds of the light at its pixels.
layout(location = 0) out vec4 outIrradiance;
#ifdef GLOSSY
layout(location = 1) out vec4 outGlossy; // radiance over glossyTint
#endif

void writeNoLight() {
  outIrradiance = vec4(0.0);
#ifdef GLOSSY
  outGlossy = vec4(0.0);
#endif
}
