// A glTF file as parsed, and what the importer's steps share. Indices are as in the file: they are checked where they
// are used, through the functions here, so that a defect in something the scene does not use does no harm.
#pragma once

#include "engine/scene/components.h"
#include "engine/scene/file_access.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <tiny_gltf.h>

namespace lambent::gltf {

/// Memory that reading a file may ask for, and triangles that it may show: a few bytes can name millions of elements or
/// texels, and one buffer can be read for every primitive. Counted is what is decoded: elements of accessors,
/// triangles, vertices of one's own, texels, files read again; what rays and OpenGL keep of triangles; and for every
/// node its triangles that shine, its weights of targets, and all of its shape where it is posed.
struct Budget {
  static constexpr size_t kBase = size_t(512) << 20, kPerByte = 64;
  // Beyond these many bytes each may ask for more: 10 MB of a few flat colours are honest textures of 1.3 GB.
  static constexpr size_t kSmall = size_t(3) << 20, kPerByteBeyond = 256;
  size_t read = 0;        // bytes of the file and of those that it names, each once
  size_t spent = 0;       // bytes
  size_t free = SIZE_MAX; // bytes that the machine has left for what is counted
  bool trusted = false;   // may ask for all of that, and show what it likes
  /// Takes from the budget; returns false where that is too much.
  bool take(size_t count, size_t each) {
    const bool fits = each == 0 || count <= left() / each;
    spent = fits ? spent + count * each : limit() + 1;
    return fits;
  }
  size_t left() const { return limit() - std::min(spent, limit()); }
  bool overdrawn() const { return spent > limit(); }
  size_t limit() const { return trusted ? free : std::min(free, bySize()); }
  size_t bySize() const {
    const size_t small = std::min(read, kSmall);
    return kBase + kPerByte * small + kPerByteBeyond * (read - small);
  }

  /// Triangles that nodes show, each as often as it is shown: they are drawn one by one, and a first picture of 60
  /// million takes 29 s of CPU (software Mesa; an 0.8 MB file).
  static constexpr size_t kShownBase = size_t(32) << 20, kShownPerByte = 8;
  size_t shown = 0;
  bool showsTooMuch() const { return !trusted && shown > shownLimit(); }
  size_t shownLimit() const { return kShownBase + kShownPerByte * read; }

  /// Attributes that are decoded from Draco, those too that nothing uses: one of 18 bytes may have a table that
  /// takes 0.4 ms to build.
  static constexpr size_t kDecodedBase = 25000;
  size_t decoded = 0;
  bool decodesTooMuch() const { return !trusted && decoded > decodedLimit(); }
  size_t decodedLimit() const { return kDecodedBase * std::max<size_t>(1, read / kSmall); }
};

struct MaterialFactors {
  vec4 baseColor{1};
  vec3 emissive{0};
};

struct Document {
  std::filesystem::path file;
  std::vector<std::filesystem::path> files; // all that were read: the document itself, and those it names
  mutable Budget budget;
  tinygltf::Model model; // images are still encoded, and empty where their data is in a buffer view or cannot be read
  // Of the model's elements with the same index, checked.
  std::vector<MaterialFactors> materialFactors;
  std::vector<Transform> transforms; // of nodes
  std::vector<CameraLens> lenses;    // of cameras
  std::vector<PunctualLight> lights; // `type` not yet set
  std::vector<std::string> warnings;
  std::map<std::pair<int, int>, int> dracoIndices; // accessors made of indices, by Draco's view and its POSITION
  std::map<int, std::string> viewDefects;          // of compressed buffer views that cannot be decoded

  /// Throws an InputError for `place` in this file, for example "mesh 3 'Wall', primitive 0".
  [[noreturn]] void fail(const std::string& place, const std::string& reason) const;
  /// Takes from the budget, or throws InputError.
  void spend(size_t count, size_t each, const std::string& place) const;
  /// Counts triangles that a node shows, or throws InputError.
  void show(size_t triangles, const std::string& place) const;
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
Document readDocument(const std::filesystem::path& file, FileTrust trust);

/// A member of an object of the file that is a number; else `otherwise`.
float number(const tinygltf::Value& object, const char* key, float otherwise);

/// "mesh 3 'Wall'" or "mesh 3".
std::string label(const char* what, size_t index, const std::string& name);

// Accessors -----------------------------------------------------------------------------------------------------------

/// Reads elements as floats: V is float, vec2, vec3, vec4 or mat4 and must match the accessor's type. Normalised
/// integers are scaled to [0,1] or [-1,1], others converted; zeros where there is no buffer view; sparse values put in.
template <class V> std::vector<V> readAccessor(const Document& doc, int accessor, const std::string& place);
/// Components of an element: 1 for SCALAR … 16 for MAT4.
inline int componentsOf(const tinygltf::Accessor& a) { return tinygltf::GetNumComponentsInType(uint32_t(a.type)); }
/// Reads elements as unsigned integers (indices, joints), `components` each.
std::vector<uint32_t> readIndices(const Document& doc, int accessor, int components, const std::string& place);

/// The bytes of a buffer view, checked against its buffer.
struct Bytes {
  const uint8_t* data = nullptr;
  size_t size = 0;
};
Bytes viewBytes(const Document& doc, int view, const std::string& place);

} // namespace lambent::gltf
