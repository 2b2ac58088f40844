// OGRE 1.12 (GL3Plus) as a host: its scene, its render targets, Lambent's light. usage: ogre_host OUT.ppm
//
// OGRE draws normals, albedo and distance into three textures at once; Lambent reads these by their GL names and writes
// irradiance into two more of OGRE's; OGRE composes. A block of the scene moves.
#include <lambent.hpp>

#include <Ogre.h>
#include <OgreRectangle2D.h>

#include <cstdio>
#include <fstream>
#include <iostream>
#include <vector>

namespace {

constexpr int kWidth = 320, kHeight = 180, kMoving = 20, kStanding = 40;
constexpr float kNear = 0.1f, kFovY = 1.0f;

const char* kSurfaceVertex = R"(#version 330
in vec4 vertex; in vec3 normal;
uniform mat4 clip_from_object, world_from_object, view_from_object;
out vec3 normal_world; out float distance_view;
void main() {
  normal_world = transpose(inverse(mat3(world_from_object))) * normal;
  distance_view = -(view_from_object * vertex).z;
  gl_Position = clip_from_object * vertex;
})";
const char* kSurfaceFragment = R"(#version 330
in vec3 normal_world; in float distance_view;
uniform vec4 albedo;
layout(location = 0) out vec4 out_normal; layout(location = 1) out vec4 out_albedo; layout(location = 2) out vec4 out_distance;
void main() { out_normal = vec4(normalize(normal_world), 1.0); out_albedo = albedo; out_distance = vec4(distance_view); })";
const char* kImageVertex = R"(#version 330
in vec4 vertex;
void main() { gl_Position = vec4(vertex.xy, 0.0, 1.0); })";
const char* kImageFragment = R"(#version 330
uniform sampler2D albedo, indirect, direct;
out vec4 color;
void main() {
  ivec2 p = ivec2(gl_FragCoord.xy);
  vec3 light = texelFetch(indirect, p, 0).rgb + texelFetch(direct, p, 0).rgb;
  color = vec4(pow(texelFetch(albedo, p, 0).rgb / 3.14159265 * light, vec3(1.0 / 2.2)), 1.0);
})";

/// A material of two programs.
Ogre::MaterialPtr material(const std::string& name, const char* vertex, const char* fragment) {
  auto& programs = Ogre::HighLevelGpuProgramManager::getSingleton();
  const auto program = [&](const std::string& of, Ogre::GpuProgramType type, const char* text) {
    if (programs.resourceExists(of, Ogre::RGN_DEFAULT)) return;
    const auto made = programs.createProgram(of, Ogre::RGN_DEFAULT, "glsl", type);
    made->setSource(text);
    made->load();
  };
  const std::string v = std::to_string(size_t(vertex)), f = std::to_string(size_t(fragment));
  program(v, Ogre::GPT_VERTEX_PROGRAM, vertex);
  program(f, Ogre::GPT_FRAGMENT_PROGRAM, fragment);
  const Ogre::MaterialPtr made = Ogre::MaterialManager::getSingleton().create(name, Ogre::RGN_DEFAULT);
  Ogre::Pass* const pass = made->getTechnique(0)->getPass(0);
  pass->setVertexProgram(v);
  pass->setFragmentProgram(f);
  pass->setLightingEnabled(false);
  pass->setCullingMode(Ogre::CULL_NONE);
  return made;
}

Ogre::TexturePtr target(const std::string& name, Ogre::PixelFormat format) {
  return Ogre::TextureManager::getSingleton().createManual(name, Ogre::RGN_DEFAULT, Ogre::TEX_TYPE_2D, kWidth, kHeight,
                                                           0, format, Ogre::TU_RENDERTARGET);
}
uint32_t nameOf(const Ogre::TexturePtr& texture) {
  uint32_t name = 0;
  texture->getCustomAttribute("GLID", &name);
  return name;
}

/// Positions and normals of a mesh of OGRE's, told to Lambent.
lambent_mesh tell(const lambent_cpp::Device& device, lambent_scene scene, const Ogre::MeshPtr& mesh,
                  lambent_material material) {
  Ogre::SubMesh* const part = mesh->getSubMesh(0);
  const Ogre::VertexData* const vertices = part->useSharedVertices ? mesh->sharedVertexData : part->vertexData;
  const auto read = [&](Ogre::VertexElementSemantic what) {
    const Ogre::VertexElement* const element = vertices->vertexDeclaration->findElementBySemantic(what);
    const Ogre::HardwareVertexBufferSharedPtr buffer = vertices->vertexBufferBinding->getBuffer(element->getSource());
    auto* const bytes = static_cast<unsigned char*>(buffer->lock(Ogre::HardwareBuffer::HBL_READ_ONLY));
    std::vector<float> values;
    for (size_t i = 0; i < vertices->vertexCount; ++i) {
      float* at = nullptr;
      element->baseVertexPointerToElement(bytes + (vertices->vertexStart + i) * buffer->getVertexSize(), &at);
      values.insert(values.end(), at, at + 3);
    }
    buffer->unlock();
    return values;
  };
  const std::vector<float> positions = read(Ogre::VES_POSITION), normals = read(Ogre::VES_NORMAL);
  const Ogre::HardwareIndexBufferSharedPtr buffer = part->indexData->indexBuffer;
  const bool wide = buffer->getType() == Ogre::HardwareIndexBuffer::IT_32BIT;
  const void* const bytes = buffer->lock(Ogre::HardwareBuffer::HBL_READ_ONLY);
  std::vector<uint32_t> indices;
  for (size_t i = part->indexData->indexStart; i < part->indexData->indexStart + part->indexData->indexCount; ++i)
    indices.push_back(wide ? static_cast<const uint32_t*>(bytes)[i] : static_cast<const uint16_t*>(bytes)[i]);
  buffer->unlock();
  auto desc = lambent_cpp::defaults<lambent_mesh_desc>();
  desc.vertex_count = uint32_t(positions.size() / 3);
  desc.triangle_count = uint32_t(indices.size() / 3);
  desc.positions = positions.data();
  desc.normals = normals.data();
  desc.indices = indices.data();
  desc.material = material;
  return device.mesh(scene, desc);
}

/// Ogre's matrices are row by row.
std::vector<float> columns(const Ogre::Affine3& m) {
  std::vector<float> out;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) out.push_back(float(m[r][c]));
  return out;
}

void run(const char* out) {
  Ogre::LogManager logs;
  logs.createLog("", true, false, true); // nothing on the console or disk
  Ogre::Root root("", "", "");
  root.loadPlugin(OGRE_PLUGINS "/RenderSystem_GL3Plus");
  root.setRenderSystem(root.getAvailableRenderers().front());
  root.initialise(false);
  Ogre::NameValuePairList hidden{{"hidden", "true"}};
  root.createRenderWindow("lambent", 64, 64, false, &hidden);
  Ogre::ResourceGroupManager::getSingleton().initialiseAllResourceGroups();

  // The scene: a floor and two walls, a block that moves, a ball.
  Ogre::SceneManager* const scene = root.createSceneManager();
  struct Thing {
    Ogre::SceneManager::PrefabType shape;
    Ogre::Vector3 place, size;
    Ogre::ColourValue color;
    Ogre::SceneNode* node = nullptr;
    Ogre::Entity* entity = nullptr;
    lambent_instance instance = 0;
  };
  using Scene = Ogre::SceneManager;
  std::vector<Thing> things{
      {Scene::PT_CUBE, {0, -0.1f, 0}, {6, 0.2f, 6}, Ogre::ColourValue(0.7f, 0.7f, 0.7f)},
      {Scene::PT_CUBE, {0, 1.5f, -3}, {6, 3, 0.2f}, Ogre::ColourValue(0.7f, 0.7f, 0.7f)},
      {Scene::PT_CUBE, {-3, 1.5f, 0}, {0.2f, 3, 6}, Ogre::ColourValue(0.7f, 0.1f, 0.1f)},
      {Scene::PT_CUBE, {0.8f, 0.5f, -1}, {1, 1, 1}, Ogre::ColourValue(0.2f, 0.5f, 0.2f)},
      {Scene::PT_SPHERE, {-0.9f, 0.7f, 0}, {1.4f, 1.4f, 1.4f}, Ogre::ColourValue(0.8f, 0.8f, 0.8f)}};
  for (size_t i = 0; i < things.size(); ++i) {
    Thing& t = things[i];
    t.entity = scene->createEntity("thing" + std::to_string(i), t.shape);
    const Ogre::MaterialPtr m = material("surface" + std::to_string(i), kSurfaceVertex, kSurfaceFragment);
    const auto vertex = m->getTechnique(0)->getPass(0)->getVertexProgramParameters();
    vertex->setNamedAutoConstant("clip_from_object", Ogre::GpuProgramParameters::ACT_WORLDVIEWPROJ_MATRIX);
    vertex->setNamedAutoConstant("world_from_object", Ogre::GpuProgramParameters::ACT_WORLD_MATRIX);
    vertex->setNamedAutoConstant("view_from_object", Ogre::GpuProgramParameters::ACT_WORLDVIEW_MATRIX);
    m->getTechnique(0)->getPass(0)->getFragmentProgramParameters()->setNamedConstant("albedo", t.color);
    t.entity->setMaterial(m);
    t.node = scene->getRootSceneNode()->createChildSceneNode(t.place);
    t.node->setScale(t.size / 100); // prefabs are 100 across
    t.node->attachObject(t.entity);
  }
  Ogre::Camera* const camera = scene->createCamera("camera");
  Ogre::SceneNode* const eye = scene->getRootSceneNode()->createChildSceneNode(Ogre::Vector3(1.8f, 1.7f, 4.2f));
  eye->attachObject(camera);
  eye->lookAt({-0.3f, 0.8f, 0}, Ogre::Node::TS_WORLD);
  camera->setNearClipDistance(kNear);
  camera->setFarClipDistance(100);
  camera->setFOVy(Ogre::Radian(kFovY));
  camera->setAspectRatio(float(kWidth) / kHeight);

  // Its render targets.
  const Ogre::TexturePtr normal = target("normal", Ogre::PF_FLOAT16_RGBA),
                         albedo = target("albedo", Ogre::PF_FLOAT16_RGBA),
                         distance = target("distance", Ogre::PF_FLOAT32_RGBA),
                         indirect = target("indirect", Ogre::PF_FLOAT16_RGBA),
                         direct = target("direct", Ogre::PF_FLOAT16_RGBA), image = target("image", Ogre::PF_BYTE_RGBA);
  Ogre::MultiRenderTarget* const surfaces = root.getRenderSystem()->createMultiRenderTarget("surfaces");
  surfaces->bindSurface(0, normal->getBuffer()->getRenderTarget());
  surfaces->bindSurface(1, albedo->getBuffer()->getRenderTarget());
  surfaces->bindSurface(2, distance->getBuffer()->getRenderTarget());
  Ogre::Viewport* const seen = surfaces->addViewport(camera);
  seen->setBackgroundColour(Ogre::ColourValue(0, 0, 0, 0)); // distance 0: nothing is seen
  seen->setOverlaysEnabled(false);
  surfaces->setAutoUpdated(false);

  Ogre::SceneManager* const flat = root.createSceneManager(); // composes
  Ogre::Rectangle2D* const whole = new Ogre::Rectangle2D(false);
  whole->setCorners(-1, 1, 1, -1);
  whole->setBoundingBox(Ogre::AxisAlignedBox::BOX_INFINITE);
  const Ogre::MaterialPtr compose = material("compose", kImageVertex, kImageFragment);
  Ogre::Pass* const pass = compose->getTechnique(0)->getPass(0);
  pass->setDepthCheckEnabled(false);
  int unit = 0;
  for (const Ogre::TexturePtr& texture : {albedo, indirect, direct}) {
    pass->createTextureUnitState()->setTexture(texture);
    pass->getFragmentProgramParameters()->setNamedConstant(texture->getName(), unit++);
  }
  whole->setMaterial(compose);
  flat->getRootSceneNode()->createChildSceneNode()->attachObject(whole);
  Ogre::Camera* const flatCamera = flat->createCamera("flat");
  flat->getRootSceneNode()->createChildSceneNode()->attachObject(flatCamera);
  Ogre::RenderTarget* const shown = image->getBuffer()->getRenderTarget();
  shown->addViewport(flatCamera)->setOverlaysEnabled(false);
  shown->setAutoUpdated(false);

  // Lambent, in the context that OGRE made.
  lambent_cpp::Device device;
  const lambent_scene told = device.scene();
  for (Thing& t : things) {
    auto desc = lambent_cpp::defaults<lambent_material_desc>();
    for (int c = 0; c < 3; ++c) desc.base_color[c] = t.color[size_t(c)];
    const lambent_mesh mesh = tell(device, told, t.entity->getMesh(), device.material(told, desc));
    t.instance = device.instance(told, mesh, columns(t.node->_getFullTransform()).data());
  }
  auto lamp = lambent_cpp::defaults<lambent_light_desc>();
  lamp.position[0] = 1.2f, lamp.position[1] = 2.6f, lamp.position[2] = 1.2f;
  for (float& c : lamp.intensity) c = 8;
  device.light(told, lamp);
  auto viewDesc = lambent_cpp::defaults<lambent_view_desc>();
  viewDesc.width = kWidth, viewDesc.height = kHeight;
  const lambent_view view = device.view(told, viewDesc);

  double total = 0;
  for (int i = 0; i < kMoving + kStanding; ++i) {
    Thing& block = things[3];
    block.node->setPosition(0.8f - 0.03f * float(std::min(i, kMoving)), 0.5f, -1);
    scene->getRootSceneNode()->_update(true, false);
    device.check(
        lambent_instance_move(device.get(), told, block.instance, columns(block.node->_getFullTransform()).data()));
    surfaces->update();

    auto frame = lambent_cpp::defaults<lambent_frame>();
    const std::vector<float> place = columns(eye->_getFullTransform());
    std::copy(place.begin(), place.end(), frame.world_from_view);
    frame.fov_y = kFovY;
    frame.near_plane = kNear;
    frame.depth = nameOf(distance);
    frame.depth_type = LAMBENT_DEPTH_LINEAR;
    frame.normal = nameOf(normal);
    frame.origin_top = 1; // OGRE draws textures upside down on OpenGL
    frame.indirect_out = nameOf(indirect);
    frame.direct_out = nameOf(direct);
    total += device.render(view, frame).milliseconds;
    shown->update();
  }
  std::vector<unsigned char> rgb(size_t(3) * kWidth * kHeight);
  shown->copyContentsToMemory(Ogre::Box(0, 0, kWidth, kHeight),
                              Ogre::PixelBox(kWidth, kHeight, 1, Ogre::PF_BYTE_RGB, rgb.data()));
  std::ofstream file(out, std::ios::binary);
  file << "P6\n" << kWidth << " " << kHeight << "\n255\n";
  file.write(reinterpret_cast<const char*>(rgb.data()), std::streamsize(rgb.size()));
  std::printf("%s: OGRE %s, %.0f ms of light a frame\n", out, OGRE_VERSION_NAME, total / (kMoving + kStanding));
}

} // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: ogre_host OUT.ppm\n";
    return 2;
  }
  try {
    run(argv[1]);
  } catch (const std::exception& e) {
    std::cerr << "ogre_host: " << e.what() << "\n";
    return 1;
  }
  return 0;
}
