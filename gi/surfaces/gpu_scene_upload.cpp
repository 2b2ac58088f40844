// Assets into GPU memory: one vertex and one index buffer for all meshes, one uniform buffer for all materials.
#include "engine/core/color.h"
#include "engine/core/error.h"
#include "engine/gl/pulse.h"
#include "gi/surfaces/gpu_scene.h"

#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace lambent {

namespace {

GLenum glMinify(const TextureRef& ref) {
  switch (ref.minify) {
  case Minify::Nearest:
    return GL_NEAREST;
  case Minify::Linear:
    return GL_LINEAR;
  case Minify::NearestMipmapNearest:
    return GL_NEAREST_MIPMAP_NEAREST;
  case Minify::LinearMipmapNearest:
    return GL_LINEAR_MIPMAP_NEAREST;
  case Minify::NearestMipmapLinear:
    return GL_NEAREST_MIPMAP_LINEAR;
  case Minify::LinearMipmapLinear:
    return GL_LINEAR_MIPMAP_LINEAR;
  case Minify::Auto:
    break;
  }
  return ref.nearest ? GL_NEAREST : GL_LINEAR_MIPMAP_LINEAR;
}

GLenum glWrap(Wrap wrap) {
  switch (wrap) {
  case Wrap::Repeat:
    return GL_REPEAT;
  case Wrap::MirroredRepeat:
    return GL_MIRRORED_REPEAT;
  case Wrap::ClampToEdge:
    return GL_CLAMP_TO_EDGE;
  }
  return GL_REPEAT;
}

vec4 uvRow(const TextureRef& ref, int row, float w) {
  return {ref.uvTransform[0][row], ref.uvTransform[1][row], ref.uvTransform[2][row], w};
}

MaterialBlock blockOf(const Material& m) {
  return {
      .baseColor = vec4(m.baseColor, m.alpha),
      .emission = vec4(m.emission, m.alphaMode == AlphaMode::Mask ? m.alphaCutoff : 0),
      .baseUvU = uvRow(m.baseColorTexture, 0, float(m.baseColorTexture.uvSet)),
      .baseUvV = uvRow(m.baseColorTexture, 1, m.doubleSided ? 1.0f : 0.0f),
      .emissiveUvU = uvRow(m.emissiveTexture, 0, float(m.emissiveTexture.uvSet)),
      .emissiveUvV = uvRow(m.emissiveTexture, 1, 0),
      .roughnessMetalness = vec4(m.roughness, m.metalness, m.normalScale, m.dielectricF0),
      .roughnessMetalnessUvU = uvRow(m.roughnessMetalnessTexture, 0, float(m.roughnessMetalnessTexture.uvSet)),
      .roughnessMetalnessUvV = uvRow(m.roughnessMetalnessTexture, 1, m.dielectricLobe),
      .normalUvU = uvRow(m.normalTexture, 0, float(m.normalTexture.uvSet)),
      .normalUvV = uvRow(m.normalTexture, 1, 0),
  };
}

/// How often each alpha is met between texels, as filters see it, at four places around each. In 16ths of 1/255.
struct AlphaHistogram {
  static constexpr int kMost = 255 * 16;
  std::array<uint64_t, kMost + 1> counts{};
  uint64_t total = 0;

  AlphaHistogram(const std::vector<u8vec4>& texels, int width, int height) : total(4 * texels.size()) {
    for (int y = 0; y < height; ++y)
      for (const int dy : {height - 1, 1}) {
        const u8vec4 *row = &texels[size_t(y) * size_t(width)],
                     *other = &texels[size_t((y + dy) % height) * size_t(width)];
        const auto column = [&](int x) { return 3 * row[x].w + other[x].w; };
        for (int x = 0; x < width; ++x)
          for (const int dx : {width - 1, 1}) ++counts[size_t(3 * column(x) + column((x + dx) % width))];
      }
  }
  /// Of those that pass a test.
  uint64_t from(float alpha) const {
    uint64_t sum = 0;
    for (int i = int(std::ceil(alpha * kMost)); i <= kMost; ++i) sum += counts[size_t(i)];
    return sum;
  }
  /// An alpha that `share` of them have at least, halfway to what the others have at most; 0: they have none.
  float quantile(double share) const {
    uint64_t left = uint64_t(std::llround(share * double(total)));
    for (int i = kMost; i > 0 && left > 0; --i) {
      if (counts[size_t(i)] >= left) {
        int below = i - 1;
        while (below >= 0 && counts[size_t(below)] == 0) --below;
        return 0.5f * float(i + (below < 0 ? i : below)) / kMost;
      }
      left -= counts[size_t(i)];
    }
    return 0;
  }
};

/// In [0, 1), evenly spread over any few texels, also over every second or fourth (Roberts 2018, R2).
float evenlySpread(int x, int y) {
  const double at = 0.7548776662466927 * x + 0.5698402909980532 * y;
  return float(at - std::floor(at));
}

/// Scales alpha in the coarser levels, so that as large a share of each passes the test as of the finest: else a mean
/// of few leaves and much that is empty fails it everywhere (Castaño 2010, "Computing alpha mipmaps"). Where many
/// texels have the same mean, as those of a grille, no factor lets a share of them pass: they are dithered first. The
/// last level has at least 64 texels, and up to 1024 for 8 of the rarer kind, for one texel passes or does not.
void keepCoverage(const gl::Texture& texture, const TextureImage& image, float cutoff) {
  const AlphaHistogram finest(image.texels, image.width, image.height);
  const double share = double(finest.from(cutoff)) / double(finest.total);
  if (share == 1) return;
  const double rarer = std::min(share, 1 - share), alike = std::min(0.02, 0.15 * rarer);
  const int fewest = int(std::clamp(8 / rarer, 64.0, 1024.0));
  const auto keepsShare = [&](const AlphaHistogram& histogram) {
    const float least = histogram.quantile(share);
    return std::abs(double(least > 0 ? histogram.from(least) : 0) / double(histogram.total) - share) <= alike;
  };
  std::vector<u8vec4> texels;
  int last = 0;
  for (int level = 1, width = image.width, height = image.height; width * height >= 4 * fewest; ++level) {
    last = level;
    width = std::max(1, width / 2), height = std::max(1, height / 2);
    texels.resize(size_t(width) * size_t(height));
    gl::pulse();
    texture.read(std::span(texels), GL_RGBA, GL_UNSIGNED_BYTE, level);
    AlphaHistogram histogram(texels, width, height);
    if (!keepsShare(histogram)) {
      for (int i = 0; i < width * height; ++i) // half of what is there, and as much by place
        texels[size_t(i)].w = uint8_t(1 + texels[size_t(i)].w / 2 + int(126 * evenlySpread(i % width, i / width)));
      histogram = AlphaHistogram(texels, width, height);
    }
    const float least = histogram.quantile(share);
    if (!(least > 0 && least < 1)) continue;
    for (u8vec4& t : texels) t.w = uint8_t(std::min(255.0f, std::ceil(float(t.w) * (cutoff / least))));
    glTextureSubImage2D(texture.name(), level, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  }
  glTextureParameteri(texture.name(), GL_TEXTURE_MAX_LEVEL, last);
}

/// Mean of the unit normals of a block of 2×2 texels, each a quarter of the way to the others, as filters see them. Of
/// maps one texel wide or high, of what there is.
vec3 meanOfBlock(const TextureImage& image, int x, int y) {
  const auto at = [&](int column, int row) {
    const u8vec4& t = image.texels[size_t(std::min(row, image.height - 1)) * size_t(image.width) +
                                   size_t(std::min(column, image.width - 1))];
    return vec3(t.x, t.y, t.z) - 127.5f;
  };
  const vec3 a = at(2 * x, 2 * y), b = at(2 * x + 1, 2 * y), c = at(2 * x, 2 * y + 1), d = at(2 * x + 1, 2 * y + 1);
  const auto near = [](const vec3& own, const vec3& beside, const vec3& below, const vec3& across) {
    const vec3 n = 9.0f * own + 3.0f * (beside + below) + across;
    return n * glm::inversesqrt(std::max(glm::dot(n, n), 1e-6f));
  };
  return 0.25f * (near(a, b, c, d) + near(b, a, d, c) + near(c, d, a, b) + near(d, c, b, a));
}

/// Writes into alpha how far the normals of each level's texels differ, as meanNormalLength
/// (shaders/shared/normal_map.h) takes it: 0 at the finest.
void keepSlopes(const gl::Texture& texture, const TextureImage& image) {
  int width = image.width, height = image.height;
  std::vector<vec3> means; // of a level
  std::vector<u8vec4> texels = image.texels;
  for (u8vec4& t : texels) t.w = 0;
  for (int level = 0;; ++level) {
    gl::pulse();
    glTextureSubImage2D(texture.name(), level, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
    if (width == 1 && height == 1) return;
    const size_t right = width > 1, row = size_t(width), down = height > 1 ? row : 0, step = 1 + right;
    const size_t rows = height > 1 ? 2 * row : row;
    width = std::max(1, width / 2), height = std::max(1, height / 2);
    texels.resize(size_t(width) * size_t(height));
    if (level == 0) means.resize(texels.size());
    texture.read(std::span(texels), GL_RGBA, GL_UNSIGNED_BYTE, level + 1);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const size_t from = size_t(y) * rows + size_t(x) * step, to = size_t(y) * size_t(width) + size_t(x);
        means[to] = level == 0
                        ? meanOfBlock(image, x, y)
                        : 0.25f * (means[from] + means[from + right] + means[from + down] + means[from + down + right]);
        texels[to].w = uint8_t(std::lround(255 * std::sqrt(std::max(0.0f, 1 - glm::length(means[to])))));
      }
  }
}

/// Weighs texels by their alpha in the colours of coarser levels: else those of what is not there show around what is.
void keepColours(const gl::Texture& texture, const TextureImage& image) {
  constexpr float kSteps = 4095;
  static const auto linear = [] {
    std::array<float, 256> table;
    for (size_t i = 0; i < table.size(); ++i) table[i] = linearFromSrgb(float(i) / 255);
    return table;
  }();
  static const auto encoded = [] { // of roots
    std::array<uint8_t, size_t(kSteps) + 1> table;
    for (size_t i = 0; i < table.size(); ++i)
      table[i] = uint8_t(std::lround(255 * srgbFromLinear(float(i * i) / (kSteps * kSteps))));
    return table;
  }();
  const auto decode = [&](uint8_t c) { return image.srgb ? linear[c] : float(c) / 255; };
  const auto encode = [&](float c) {
    return image.srgb ? encoded[size_t(std::sqrt(std::min(c, 1.0f)) * kSteps + 0.5f)]
                      : uint8_t(std::min(c, 1.0f) * 255 + 0.5f);
  };
  std::vector<vec4> sums; // of a level: colour times alpha, and alpha
  std::vector<u8vec4> texels;
  for (int level = 1, width = image.width, height = image.height; width > 1 || height > 1; ++level) {
    const size_t right = width > 1, row = size_t(width), down = height > 1 ? row : 0, step = 1 + right;
    const size_t rows = height > 1 ? 2 * row : row;
    width = std::max(1, width / 2), height = std::max(1, height / 2);
    texels.resize(size_t(width) * size_t(height));
    if (level == 1) sums.resize(texels.size());
    const auto at = [&](size_t i) {
      if (level > 1) return sums[i];
      const u8vec4& t = image.texels[i];
      return vec4(decode(t.x), decode(t.y), decode(t.z), 1) * (float(t.w) / 255);
    };
    gl::pulse();
    texture.read(std::span(texels), GL_RGBA, GL_UNSIGNED_BYTE, level);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const size_t from = size_t(y) * rows + size_t(x) * step, to = size_t(y) * size_t(width) + size_t(x);
        const vec4 sum = at(from) + at(from + right) + at(from + down) + at(from + down + right);
        sums[to] = 0.25f * sum;
        if (sum.w > 0)
          for (int c = 0; c < 3; ++c) texels[to][c] = encode(sum[c] / sum.w);
      }
    glTextureSubImage2D(texture.name(), level, 0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  }
}

/// What materials make of an image.
struct ImageUse {
  bool slopes = false; // one has it as its normal map
  bool shares = false; // one is masked or blended by its alpha
  float cutoff = 0;    // alpha of it at least passes the test of one; 0: none tests it
};

gl::Texture uploadImage(const TextureImage& image, const ImageUse& use) {
  gl::pulse();
  const int levels = int(std::bit_width(unsigned(std::max(image.width, image.height))));
  gl::Texture texture("scene/" + image.name.substr(0, 100), {.format = GLenum(image.srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8),
                                                             .width = image.width,
                                                             .height = image.height,
                                                             .levels = levels,
                                                             .linear = true});
  glTextureSubImage2D(texture.name(), 0, 0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE,
                      image.texels.data());
  glGenerateTextureMipmap(texture.name());
  if (use.shares && image.least.w < 255) keepColours(texture, image);
  if (use.cutoff > 0 && use.cutoff <= 1)
    keepCoverage(texture, image, use.cutoff);
  else if (use.slopes)
    keepSlopes(texture, image);
  return texture;
}

/// Declares attribute `location` fed from `buffer`, or leaves it at its current (constant) value when that is empty.
void attribute(const gl::VertexArray& array, GLuint location, const gl::Buffer& buffer, int components, GLenum type,
               bool normalized, int stride) {
  if (!buffer) return;
  glEnableVertexArrayAttrib(array.name(), location);
  glVertexArrayAttribFormat(array.name(), location, components, type, normalized, 0);
  glVertexArrayAttribBinding(array.name(), location, location);
  glVertexArrayVertexBuffer(array.name(), location, buffer.name(), 0, stride);
}

} // namespace

GpuScene::GpuScene(const PassContext& context, const SceneAssets& assets)
    : context_(context), meshRevision_(assets.meshRevision) {
  uploadMeshes(assets);
  uploadMaterials(assets);
}

void GpuScene::takeAssets(const SceneAssets& assets) {
  materialDraws_.clear();
  const bool blended = blends_;
  uploadMaterials(assets);
  if (blends_ != blended) placed_.clear(); // instances then need indices
  if (std::exchange(meshRevision_, assets.meshRevision) == assets.meshRevision) return;
  meshes_.clear();
  deformed_ = {};
  placed_.clear(); // all are placed anew
  items_.clear();
  uploadMeshes(assets);
}

void GpuScene::uploadMeshes(const SceneAssets& assets) {
  std::vector<vec3> positions;
  std::vector<uint64_t> normals, colors, tangents; // four 16-bit values each
  std::vector<vec4> uvs;                           // uv0, uv1
  std::vector<uvec3> triangles;
  bool anyUv = false, anyColor = false, anyTangent = false;
  for (const Mesh& mesh : assets.meshes) {
    anyUv |= !mesh.uv0.empty() || !mesh.uv1.empty();
    anyColor |= !mesh.colors.empty();
    anyTangent |= !mesh.tangents.empty();
  }
  for (const Mesh& mesh : assets.meshes) {
    const uint32_t baseVertex = uint32_t(positions.size()), baseTriangle = uint32_t(triangles.size());
    CHECK_EQ(mesh.normals.size(), mesh.positions.size());
    positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
    triangles.insert(triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
      normals.push_back(glm::packSnorm4x16(vec4(mesh.normals[i], 0)));
      const vec2 uv0 = mesh.uv0.empty() ? vec2(0) : mesh.uv0[i], uv1 = mesh.uv1.empty() ? vec2(0) : mesh.uv1[i];
      if (anyUv) uvs.push_back(vec4(uv0.x, uv0.y, uv1.x, uv1.y));
      if (anyColor) colors.push_back(glm::packUnorm4x16(mesh.colors.empty() ? vec4(1) : mesh.colors[i]));
      if (anyTangent) tangents.push_back(glm::packSnorm4x16(mesh.tangents.empty() ? vec4(0) : mesh.tangents[i]));
    }
    MeshRange& range = meshes_.emplace_back(MeshRange{baseVertex, uint32_t(mesh.positions.size()), {}});
    for (uint32_t i = 0; i < mesh.primitives.size(); ++i)
      if (const Primitive& p = mesh.primitives[i]; p.triangleCount > 0)
        range.primitives.push_back(
            {i, (baseTriangle + p.firstTriangle) * 3, p.triangleCount * 3, baseVertex, p.material, p.boundsObject});
  }
  uvs_ = {};
  colors_ = {};
  tangents_ = {};
  if (positions.empty()) {
    vertexArray_ = gl::VertexArray("scene/vertices"); // nothing to draw, but bound all the same
    return;
  }

  positions_ = gl::Buffer::of<vec3>("scene/positions", positions);
  normals_ = gl::Buffer::of<uint64_t>("scene/normals", normals);
  if (anyUv) uvs_ = gl::Buffer::of<vec4>("scene/uvs", uvs);
  if (anyColor) colors_ = gl::Buffer::of<uint64_t>("scene/colors", colors);
  if (anyTangent) tangents_ = gl::Buffer::of<uint64_t>("scene/tangents", tangents);
  if (!triangles.empty()) indices_ = gl::Buffer::of<uvec3>("scene/indices", triangles);

  vertexArray_ = vertexArrayOf("scene/vertices", positions_, normals_, uvs_, colors_, tangents_);
}

/// Attributes from these buffers, rows of worldFromObject per instance, and the indices of all meshes.
gl::VertexArray GpuScene::vertexArrayOf(const char* label, const gl::Buffer& positions, const gl::Buffer& normals,
                                        const gl::Buffer& uvs, const gl::Buffer& colors,
                                        const gl::Buffer& tangents) const {
  gl::VertexArray array(label);
  attribute(array, 0, positions, 3, GL_FLOAT, false, sizeof(vec3));
  attribute(array, 1, normals, 3, GL_SHORT, true, sizeof(uint64_t));
  attribute(array, 2, uvs, 4, GL_FLOAT, false, sizeof(vec4));
  attribute(array, 3, colors, 4, GL_UNSIGNED_SHORT, true, sizeof(uint64_t));
  attribute(array, 7, tangents, 4, GL_SHORT, true, sizeof(uint64_t));
  for (GLuint row = 0; row < 3; ++row) {
    glEnableVertexArrayAttrib(array.name(), kInstanceBinding + row);
    glVertexArrayAttribFormat(array.name(), kInstanceBinding + row, 4, GL_FLOAT, GL_FALSE, row * sizeof(vec4));
    glVertexArrayAttribBinding(array.name(), kInstanceBinding + row, kInstanceBinding);
  }
  glVertexArrayBindingDivisor(array.name(), kInstanceBinding, 1);
  if (indices_) glVertexArrayElementBuffer(array.name(), indices_.name());
  return array;
}

uint32_t GpuScene::samplerFor(const TextureRef& ref) {
  const uint32_t key =
      uint32_t(ref.wrapU) | uint32_t(ref.wrapV) << 4 | uint32_t(ref.nearest) << 8 | uint32_t(ref.minify) << 9;
  gl::Sampler& sampler = samplers_[key];
  if (!sampler) {
    sampler = gl::Sampler("scene/sampler");
    glSamplerParameteri(sampler.name(), GL_TEXTURE_WRAP_S, GLint(glWrap(ref.wrapU)));
    glSamplerParameteri(sampler.name(), GL_TEXTURE_WRAP_T, GLint(glWrap(ref.wrapV)));
    glSamplerParameteri(sampler.name(), GL_TEXTURE_MIN_FILTER, GLint(glMinify(ref)));
    glSamplerParameteri(sampler.name(), GL_TEXTURE_MAG_FILTER, ref.nearest ? GL_NEAREST : GL_LINEAR);
  }
  return sampler.name();
}

void GpuScene::uploadMaterials(const SceneAssets& assets) {
  std::map<uint32_t, ImageUse> uses;
  for (const Material& m : assets.materials) {
    ImageUse& base = uses[m.baseColorTexture.image];
    base.shares |= m.alphaMode != AlphaMode::Opaque;
    if (m.alphaMode == AlphaMode::Mask && m.alpha > 0 && base.cutoff == 0)
      base.cutoff = m.alphaCutoff / m.alpha; // for an alpha of the file's own
    uses[m.normalTexture.image].slopes = true;
  }
  for (size_t i = 0; i < assets.images.size(); ++i) {
    const TextureImage& image = assets.images[i];
    const bool gone = image.texels.empty();
    if (i == textures_.size()) {
      textures_.push_back(gone ? gl::Texture() : uploadImage(image, uses[uint32_t(i)]));
    }
    if (gone) textures_[i] = {};
  }
  const auto textureOf = [&](const TextureRef& ref) { return ref.image == kNone ? 0 : textures_[ref.image].name(); };
  const auto samplerOf = [&](const TextureRef& ref) { return ref.image == kNone ? 0 : samplerFor(ref); };

  GLint alignment = 256;
  glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
  materialStride_ = (sizeof(MaterialBlock) + alignment - 1) / alignment * alignment;
  std::vector<std::byte> bytes(std::max<size_t>(1, assets.materials.size()) * materialStride_);
  for (size_t i = 0; i < assets.materials.size(); ++i) {
    const Material& m = assets.materials[i];
    const MaterialBlock block = blockOf(m);
    std::memcpy(bytes.data() + i * materialStride_, &block, sizeof block);
    materialDraws_.push_back(
        {textureOf(m.baseColorTexture), textureOf(m.emissiveTexture), textureOf(m.roughnessMetalnessTexture),
         textureOf(m.normalTexture), samplerOf(m.baseColorTexture), samplerOf(m.emissiveTexture),
         samplerOf(m.roughnessMetalnessTexture), samplerOf(m.normalTexture), m.alphaMode, m.backHidden});
  }
  blends_ = assets.blends();
  materials_ = gl::Buffer("scene/materials", bytes.size(), bytes.data(), 0);
}

} // namespace lambent
