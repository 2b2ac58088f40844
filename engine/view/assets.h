// What a scene is made of: meshes, materials, textures. Filled by the importer, or by a host call by call.
#pragma once

#include "engine/core/math.h"

#include <algorithm>
#include <atomic>
#include <string>
#include <utility>
#include <vector>

namespace lambent {

inline constexpr uint32_t kNone = 0xffffffffu;

enum class Wrap : uint8_t { Repeat, MirroredRepeat, ClampToEdge };
/// How a texture is looked up where its texels are smaller than pixels: glTF's minFilter. Auto: what suits the
/// magnifying filter, texels as they are or all levels mixed.
enum class Minify : uint8_t {
  Auto,
  Nearest,
  Linear,
  NearestMipmapNearest,
  LinearMipmapNearest,
  NearestMipmapLinear,
  LinearMipmapLinear
};
enum class AlphaMode : uint8_t { Opaque, Mask, Blend }; // Blend: shaders/shared/coverage.h
/// Which surfaces' alpha is tested: none (masked and blended ones count as solid), those two, or all, which lets the
/// others pass.
enum class AlphaTest : uint8_t { None, Needed, All };

/// 8-bit RGBA image; row 0 is the row at v = 0 (glTF: the top row of the file). `srgb`: colours are sRGB-encoded,
/// alpha is linear. `averageLinear` is the mean linear colour over all texels (alpha in w), `least` the smallest of
/// each channel; measureTexels fills them.
struct TextureImage {
  std::string name;
  int width = 0, height = 0;
  bool srgb = true;
  std::vector<u8vec4> texels; // width * height
  vec4 averageLinear{1};
  u8vec4 least{255};
};

/// A use of an image by a material: which UV set, wrap modes, filter, and KHR_texture_transform as a matrix
/// (uvImage = uvTransform * (uv, 1)).
struct TextureRef {
  uint32_t image = kNone; // index into SceneAssets::images; kNone = no texture (white)
  uint32_t uvSet = 0;     // 0 or 1
  Wrap wrapU = Wrap::Repeat, wrapV = Wrap::Repeat;
  bool nearest = false; // between texels that are larger than pixels; rays look textures up by this alone
  Minify minify = Minify::Auto;
  mat3 uvTransform{1};
};

/// Lambert surface; where the camera sees it, it may be glossy too (roughness and metalness, gather.glossy). Albedo =
/// baseColor (factor) × texture × vertex colour. Emission is radiance, W/(m² sr) per channel, front side only unless
/// doubleSided. Both sides reflect.
struct Material {
  std::string name;
  vec3 baseColor{1};
  float alpha = 1;
  TextureRef baseColorTexture;
  vec3 emission{0}; // emissiveFactor × emissiveStrength
  TextureRef emissiveTexture;
  float roughness = 1, metalness = 0;   // factors, [0,1]; roughness is perceptual: α = roughness²
  TextureRef roughnessMetalnessTexture; // G: roughness, B: metalness
  float dielectricF0 = 0;               // reflectance head-on of what is not metal; 0: 0.04 (index of refraction 1.5)
  float dielectricLobe = 1;             // weight of its glossy part, [0,1]
  TextureRef normalTexture;             // tangent space, where the camera sees it (shaders/shared/normal_map.h)
  float normalScale = 1;
  AlphaMode alphaMode = AlphaMode::Opaque;
  float alphaCutoff = 0.5f;
  bool doubleSided = false;
  bool backHidden = false; // the eye looks through its back, as glTF has it where not doubleSided; light does not

  bool blends() const { return alphaMode == AlphaMode::Blend; }
  bool emits() const { return maxComponent(emission) > 0; }
  /// Says whether the material is anything but Lambert; a texture may make it so.
  bool glossy() const { return roughness < 1 || metalness > 0 || roughnessMetalnessTexture.image != kNone; }
};

/// A run of triangles of one mesh that share a material.
struct Primitive {
  uint32_t firstTriangle = 0, triangleCount = 0;
  uint32_t material = 0;
  Aabb boundsObject;
  bool flat = false; // normals are the triangles', each with vertices of its own: made again when the mesh is deformed
};

/// Up to four joints per vertex, as indices into the joints of the skin that the mesh is shown with. The weights of a
/// vertex sum to one over all sets of its mesh, or are all zero: such a vertex follows no joint.
struct JointSet {
  std::vector<glm::uvec4> joints;
  std::vector<vec4> weights;
};

/// What full weight of a morph target adds to the vertices, object space. Each empty, or one per vertex.
struct MorphTarget {
  std::vector<vec3> positions, normals;
};

/// Triangle mesh in object space, metres. `normals` always has one unit vector per vertex (made by the importer where
/// the file has none); `uv0`, `uv1`, `colors`, `tangents` are empty or one per vertex (colours linear RGBA; tangents
/// unit, w: bitangent = w · cross(normal, tangent); 0 where no normal map asks for one).
struct Mesh {
  std::string name;
  std::vector<vec3> positions, normals;
  std::vector<vec2> uv0, uv1;
  std::vector<vec4> colors, tangents;
  std::vector<uvec3> triangles; // indices into the vertex arrays; sorted by primitive
  std::vector<Primitive> primitives;
  Aabb boundsObject;
  dvec3 centre{0}; // in the coordinates of its file or host: where all the above counts from (countFromMiddle)
  // How an instance of it may be deformed (deform.h); the vertices above are those of the bind pose, unmorphed.
  std::vector<JointSet> jointSets;
  std::vector<MorphTarget> morphTargets;
};

/// Has positions and boxes count from the middle of the mesh's box. Of vertices that are far from zero, single
/// precision loses more in a transform that brings them back than rays and shadows can bear.
void countFromMiddle(Mesh& mesh);
/// Where an instance stands whose transform is told for the mesh's own coordinates.
dmat4 placeFor(const Mesh& mesh, const dmat4& transform);

/// Which contents an object holds: a number that no other of this process ever had. A copy, and what is moved or
/// assigned to, hold others, for whatever was made of them keeps pointers to the first. Who keeps something made of an
/// object knows by it whether that object is still there, though another may have taken its place in memory. Says
/// nothing else, and so may not enter a result.
class Identity {
 public:
  Identity() = default;
  Identity(const Identity&) {}
  Identity(Identity&& from) noexcept { from.value_ = next(); }
  Identity& operator=(const Identity&) {
    value_ = next();
    return *this;
  }
  Identity& operator=(Identity&& from) noexcept {
    value_ = next();
    from.value_ = next();
    return *this;
  }
  uint64_t value() const { return value_; } // never 0

 private:
  static uint64_t next() {
    static std::atomic<uint64_t> last = 0;
    return ++last;
  }
  uint64_t value_ = next();
};

/// Who reads something on another thread, which whoever changes it waits for. A copy has readers of its own.
class Readers {
 public:
  Readers() = default;
  ~Readers() { wait(); }
  Readers(const Readers&) {}
  Readers& operator=(const Readers&) { return *this; }

  /// One of them, while it lives.
  class Reading {
   public:
    explicit Reading(const Readers& of) : of_(&of) { ++of.count_; }
    Reading(Reading&& from) noexcept : of_(std::exchange(from.of_, nullptr)) {}
    ~Reading() {
      if (of_ && --of_->count_ == 0) of_->count_.notify_all();
    }

   private:
    const Readers* of_;
  };
  bool any() const { return count_ > 0; }
  /// Waits until nobody reads.
  void wait() const {
    for (int n; (n = count_) > 0;) count_.wait(n);
  }

 private:
  mutable std::atomic<int> count_ = 0;
};

/// What is in use never changes under the same identity. What nothing uses may come and go: `revision` then grows,
/// `meshRevision` with meshes, and numbers stay. What has gone has no triangles, or no texels.
struct SceneAssets {
  Identity identity;
  uint64_t revision = 0, meshRevision = 0;
  std::vector<Mesh> meshes;
  std::vector<Material> materials; // never empty once loaded: a default white material is added when needed
  std::vector<TextureImage> images;
  Readers readers; // beside the thread that owns it. Last: what goes waits for them first

  bool blends() const { return std::ranges::any_of(materials, &Material::blends); }
};

/// Bytes of its meshes and textures.
uint64_t bytesOf(const SceneAssets& assets);

/// Linear RGBA of one texel; alpha is never encoded.
vec4 decodeTexel(const u8vec4& texel, bool srgb);

void measureTexels(TextureImage& image);

/// The smallest roughness that the material has anywhere.
float leastRoughness(const SceneAssets& assets, const Material& material);

/// Bilinear (or nearest) lookup of a material's texture at mesh coordinates (before uvTransform), as linear RGBA.
/// White when the reference has no image.
vec4 sampleTexture(const SceneAssets& assets, const TextureRef& ref, vec2 uv);
/// The last of these alone, to the bit.
float sampleAlpha(const SceneAssets& assets, const TextureRef& ref, vec2 uv);

} // namespace lambent
