// A glTF file as plain data, between the parser (the only file that knows tinygltf) and the importer's steps. Indices
// are as in the file: they are checked where they are used, through the functions here, so that a defect in something
// the scene does not use does no harm.
#pragma once

#include "engine/scene/components.h"
#include "engine/scene/json_text.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lambent::gltf {

struct BufferView {
  int buffer = -1;
  size_t byteOffset = 0, byteLength = 0, byteStride = 0; // stride 0: tightly packed
};

enum class ComponentType : int { Int8 = 5120, UInt8, Int16, UInt16, UInt32 = 5125, Float32 };

struct Accessor {
  int bufferView = -1; // -1: all zero
  size_t byteOffset = 0, count = 0;
  int componentType = 0; // a ComponentType once checked
  int components = 0;    // 1 for SCALAR … 16 for MAT4
  bool normalized = false;
  bool sparse = false;
  int sparseCount = 0, sparseIndicesView = -1, sparseIndicesOffset = 0, sparseIndicesType = 0;
  int sparseValuesView = -1, sparseValuesOffset = 0;
};

struct Image {
  std::string name, uri;
  int bufferView = -1;
  std::vector<uint8_t> encoded; // empty when the data is in a buffer view or the file could not be read
};

struct Texture {
  int image = -1;
  Wrap wrapU = Wrap::Repeat, wrapV = Wrap::Repeat;
  bool nearest = false;
};

struct TextureUse {
  int texture = -1;
  int texCoord = 0;
  mat3 uvTransform{1};
};

struct Material {
  std::string name, alphaMode;
  vec4 baseColor{1};
  TextureUse baseColorTexture, roughnessMetalnessTexture, emissiveTexture;
  float roughness = 1, metalness = 1;
  vec3 emissive{0};
  float emissiveStrength = 1, alphaCutoff = 0.5f;
  bool doubleSided = false;
  std::vector<std::string> extensions;
};

struct Primitive {
  std::map<std::string, int> attributes;
  int indices = -1, material = -1, mode = 4;
  std::vector<std::map<std::string, int>> targets; // per morph target, its attributes
};

struct Mesh {
  std::string name;
  std::vector<Primitive> primitives;
  std::vector<float> weights; // of morph targets; empty where the file gives none
};

struct Node {
  std::string name;
  std::vector<int> children;
  int mesh = -1, skin = -1, camera = -1, light = -1;
  Transform transform;
  std::vector<float> weights; // instead of the mesh's
};

struct Skin {
  std::string name;
  std::vector<int> joints;
  int inverseBindMatrices = -1;
};

struct Camera {
  std::string name;
  CameraLens lens;
};

struct Light {
  std::string name, type;
  PunctualLight light; // `type` of it not yet set
};

struct Channel {
  int sampler = -1, node = -1;
  std::string path;
};

struct Sampler {
  int input = -1, output = -1;
  std::string interpolation;
};

struct Animation {
  std::string name;
  std::vector<Channel> channels;
  std::vector<Sampler> samplers;
};

struct SceneRoots {
  std::string name;
  std::vector<int> nodes;
};

/// Memory that reading a file may ask for: a few bytes can name millions of elements or texels, and one buffer can be
/// read for every primitive. Counted is what is decoded: elements of accessors, triangles, vertices of one's own,
/// texels, and files read again. The program needs up to four times as much for a moment.
struct Budget {
  static constexpr size_t kBase = size_t(512) << 20, kPerByte = 64;
  size_t read = 0;  // bytes of the file and of those that it names, each once
  size_t spent = 0; // bytes
  /// Takes from the budget; returns false where that is too much.
  bool take(size_t count, size_t each) {
    const size_t left = limit() - std::min(spent, limit());
    const bool fits = each == 0 || count <= left / each;
    spent = fits ? spent + count * each : limit() + 1;
    return fits;
  }
  size_t limit() const { return kBase + kPerByte * read; }
};

struct Document {
  std::filesystem::path file;
  mutable Budget budget;
  std::vector<std::vector<uint8_t>> buffers;
  std::vector<BufferView> bufferViews;
  std::vector<Accessor> accessors;
  std::vector<Image> images;
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Node> nodes;
  std::vector<Skin> skins;
  std::vector<Camera> cameras;
  std::vector<Light> lights;
  std::vector<Animation> animations;
  std::vector<SceneRoots> scenes;
  int defaultScene = -1;
  std::vector<std::string> warnings;

  /// Throws an InputError for `place` in this file, for example "mesh 3 'Wall', primitive 0".
  [[noreturn]] void fail(const std::string& place, const std::string& reason) const;
  /// Takes from the budget, or throws InputError.
  void spend(size_t count, size_t each, const std::string& place) const;
  void warn(std::string text) { warnings.push_back(std::move(text)); }

  /// Returns items[index], or throws an InputError that says which index of `what` is out of range at `place`.
  template <class T>
  const T& at(const std::vector<T>& items, int index, const char* what, const std::string& place) const {
    checkIndex(index, items.size(), what, place);
    return items[size_t(index)];
  }
  void checkIndex(int index, size_t size, const char* what, const std::string& place) const;
};

/// Reads and parses .gltf or .glb with its buffers and encoded images. Refuses what it does not support.
Document readDocument(const std::filesystem::path& file);

/// "mesh 3 'Wall'" or "mesh 3".
std::string label(const char* what, size_t index, const std::string& name);

/// Reads the bytes of a file. Throws InputError when it cannot be read.
std::vector<uint8_t> readFileBytes(const std::filesystem::path& file);

/// Checks what the parser takes on trust: a .glb's chunk sizes, JSON nested so deeply that a parser may run out of
/// stack, keys given twice.
struct Container {
  bool binary = false;
  JsonText json; // what was seen of it
};
Container checkContainer(const std::filesystem::path& file, const std::vector<uint8_t>& bytes);

// Accessors -----------------------------------------------------------------------------------------------------------

/// Reads elements as floats: V is float, vec2, vec3, vec4 or mat4 and must match the accessor's type. Normalised
/// integers are scaled to [0,1] or [-1,1], others converted; zeros where there is no buffer view; sparse values put in.
template <class V> std::vector<V> readAccessor(const Document& doc, int accessor, const std::string& place);
/// Reads elements as unsigned integers (indices, joints), `components` each.
std::vector<uint32_t> readIndices(const Document& doc, int accessor, int components, const std::string& place);

/// The bytes of a buffer view, checked against its buffer.
struct Bytes {
  const uint8_t* data = nullptr;
  size_t size = 0;
};
Bytes viewBytes(const Document& doc, int view, const std::string& place);

} // namespace lambent::gltf
