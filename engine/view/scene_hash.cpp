#include "engine/view/scene_hash.h"

namespace lambent {

namespace {

void add(Hash& hash, const TextureRef& t) {
  hash.value(t.image);
  hash.value(t.uvSet);
  hash.value(t.wrapU);
  hash.value(t.wrapV);
  hash.value(t.nearest);
  if (t.minify != Minify::Auto) hash.value(t.minify);
  hash.bytes(&t.uvTransform, sizeof t.uvTransform);
}

void add(Hash& hash, const SceneAssets& assets, bool glossy, bool normalMaps) {
  for (const Mesh& mesh : assets.meshes) {
    hash.values(mesh.positions);
    hash.values(mesh.normals);
    hash.values(mesh.uv0);
    hash.values(mesh.uv1);
    hash.values(mesh.colors);
    if (normalMaps) hash.values(mesh.tangents);
    hash.values(mesh.triangles);
    for (const Primitive& p : mesh.primitives) hash.value(p.firstTriangle), hash.value(p.material);
  }
  for (const Material& m : assets.materials) {
    hash.value(m.baseColor);
    hash.value(m.alpha);
    add(hash, m.baseColorTexture);
    hash.value(m.emission);
    add(hash, m.emissiveTexture);
    hash.value(m.alphaMode);
    hash.value(m.alphaCutoff);
    hash.value(m.doubleSided);
    hash.value(m.backHidden);
    if (glossy) {
      hash.value(m.roughness);
      hash.value(m.metalness);
      hash.value(m.dielectricF0);
      hash.value(m.dielectricLobe);
      add(hash, m.roughnessMetalnessTexture);
    }
    if (normalMaps) {
      add(hash, m.normalTexture);
      hash.value(m.normalScale);
    }
  }
  for (const TextureImage& image : assets.images) {
    if (!image.srgb && !glossy && !normalMaps) continue;
    hash.value(image.width);
    hash.value(image.srgb);
    hash.values(image.texels);
  }
}

} // namespace

void addGeometry(Hash& hash, const SceneView& view, bool glossy, bool normalMaps) {
  if (view.assets) add(hash, *view.assets, glossy, normalMaps);
  for (const InstanceView& i : view.instances) {
    hash.value(i.mesh);
    hash.bytes(&i.worldFromObject, sizeof i.worldFromObject);
    if (!i.deformed) continue;
    hash.values(i.deformed->positions);
    hash.values(i.deformed->normals);
    if (normalMaps) hash.values(i.deformed->tangents);
  }
}

} // namespace lambent
