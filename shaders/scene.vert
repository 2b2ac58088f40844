#version 450
// Triangles of an instance, for every pass that draws the scene. DEPTH_ONLY leaves out what depth does not need;
// POSITION puts back where it is, ALPHA_BLEND tells whose triangles they are.
layout(location = 0) in vec3 positionObject;
layout(location = 4) in vec4 worldRow0; // rows of worldFromObject, one per instance
layout(location = 5) in vec4 worldRow1;
layout(location = 6) in vec4 worldRow2;
#ifdef ALPHA_BLEND
layout(location = 8) in uint instanceIndex;
layout(location = 6) flat out uint instance;
invariant gl_Position; // what is drawn twice lies at the same depth
#endif
#if !defined(DEPTH_ONLY)
layout(location = 1) in vec3 normalObject;
layout(location = 0) out vec3 normalWorld;
layout(location = 4) flat out float handedness;
#ifdef NORMAL_TEXTURE
layout(location = 7) in vec4 tangentObject; // w: side of the bitangent
layout(location = 5) out vec4 tangentWorld;
#endif
#endif
#if !defined(DEPTH_ONLY) || defined(POSITION)
layout(location = 1) out vec3 positionEye; // world axes, origin at the eye: keeps the derivatives precise
uniform vec3 eye;
#endif
#if !defined(DEPTH_ONLY) || defined(ALPHA_MASK)
layout(location = 2) in vec4 uv01;
layout(location = 3) in vec4 colorVertex;
layout(location = 2) out vec4 uv;
layout(location = 3) out vec4 color;
#endif
uniform mat4 clipFromWorld;

void main() {
#ifdef ALPHA_BLEND
  instance = instanceIndex;
#endif
  vec4 p = vec4(positionObject, 1.0);
  vec3 positionWorld = vec3(dot(worldRow0, p), dot(worldRow1, p), dot(worldRow2, p));
  gl_Position = clipFromWorld * vec4(positionWorld, 1.0);
#if !defined(DEPTH_ONLY)
  // Inverse transpose up to a positive factor: rows of the cofactor matrix times the sign of the determinant.
  vec3 c0 = cross(worldRow1.xyz, worldRow2.xyz), c1 = cross(worldRow2.xyz, worldRow0.xyz),
       c2 = cross(worldRow0.xyz, worldRow1.xyz);
  handedness = dot(worldRow0.xyz, c0) < 0.0 ? -1.0 : 1.0;
  vec3 n = vec3(dot(c0, normalObject), dot(c1, normalObject), dot(c2, normalObject));
  float size = length(n); // may be 0: a file may give normals of no length
  normalWorld = size > 0.0 ? n * (handedness / size) : vec3(0.0);
#ifdef NORMAL_TEXTURE
  vec3 t = tangentObject.xyz;
  tangentWorld =
      vec4(dot(worldRow0.xyz, t), dot(worldRow1.xyz, t), dot(worldRow2.xyz, t), tangentObject.w * handedness);
#endif
#endif
#if !defined(DEPTH_ONLY) || defined(POSITION)
  positionEye = positionWorld - eye;
#endif
#if !defined(DEPTH_ONLY) || defined(ALPHA_MASK)
  uv = uv01;
  color = colorVertex;
#endif
}
