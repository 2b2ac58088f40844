/* A renderer of its own that takes its light from Lambent. usage: minimal OUT.png [OUT.pfm]
 *
 * Context: EGL without a display. G-buffer: forward depth of 24 bits, octahedral normals in view space, albedo,
 * emission; nothing of it is as Lambent's own. Scene: the Cornell box and a lamp that moves for 30 frames and then
 * stands for 64. docs/embedding.md goes through this file. */
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <lambent.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 320, HEIGHT = 240, MOVING = 30, STANDING = 64 };
static const float kNear = 0.1f, kFar = 50, kFovY = 0.685914f;
static const float kEye[3] = {-0.008f, 1.365f, 5.398f};

static void fail(const char* what, const char* why) {
  fprintf(stderr, "minimal: %s: %s\n", what, why);
  exit(1);
}

/* ---- The host's scene: boxes on four corners, and the emitter below the ceiling. ------------------------------------ */

typedef struct Material {
  float albedo[3], emission[3];
} Material;
static const Material kMaterials[] = {{{0.73f, 0.73f, 0.73f}, {0, 0, 0}},
                                      {{0.63f, 0.065f, 0.05f}, {0, 0, 0}},
                                      {{0.14f, 0.45f, 0.091f}, {0, 0, 0}},
                                      {{0.78f, 0.78f, 0.78f}, {17, 12.002f, 3.995f}}};
typedef struct Box {
  float corners[4][2]; /* x, z, counter-clockwise from above */
  float low, high;
  int material;
} Box;
static const Box kBoxes[] = {
    {{{-1.582f, 1.398f}, {1.582f, 1.398f}, {1.582f, -1.598f}, {-1.582f, -1.598f}}, -0.2f, 0, 0},
    {{{-1.582f, 1.398f}, {1.582f, 1.398f}, {1.582f, -1.598f}, {-1.582f, -1.598f}}, 2.744f, 2.944f, 0},
    {{{-1.582f, -1.398f}, {1.582f, -1.398f}, {1.582f, -1.598f}, {-1.582f, -1.598f}}, 0, 2.744f, 0},
    {{{-1.582f, 1.398f}, {-1.382f, 1.398f}, {-1.382f, -1.398f}, {-1.582f, -1.398f}}, 0, 2.744f, 1},
    {{{1.382f, 1.398f}, {1.582f, 1.398f}, {1.582f, -1.398f}, {1.382f, -1.398f}}, 0, 2.744f, 2},
    {{{0.732f, 1.073f}, {0.972f, 0.273f}, {0.182f, 0.038f}, {-0.068f, 0.828f}}, 0, 0.825f, 0},
    {{{-0.733f, 0.163f}, {0.057f, -0.082f}, {-0.188f, -0.882f}, {-0.978f, -0.632f}}, 0, 1.65f, 0}};
enum { BOXES = sizeof kBoxes / sizeof kBoxes[0], MESHES = BOXES + 1, BOX_VERTICES = 24, MOST_VERTICES = 24 * MESHES };

typedef struct Vertex {
  float position[3], normal[3];
} Vertex;
typedef struct Mesh {
  Vertex vertices[BOX_VERTICES];
  uint32_t indices[36], vertexCount, indexCount;
  int material;
} Mesh;

static void addQuad(Mesh* m, const float a[3], const float b[3], const float c[3], const float d[3]) {
  const float* corners[4] = {a, b, c, d};
  float u[3], v[3], n[3], length;
  uint32_t first = m->vertexCount, i, k;
  for (i = 0; i < 3; ++i) u[i] = b[i] - a[i], v[i] = d[i] - a[i];
  n[0] = u[1] * v[2] - u[2] * v[1], n[1] = u[2] * v[0] - u[0] * v[2], n[2] = u[0] * v[1] - u[1] * v[0];
  length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (k = 0; k < 4; ++k)
    for (i = 0; i < 3; ++i) {
      m->vertices[first + k].position[i] = corners[k][i];
      m->vertices[first + k].normal[i] = n[i] / length;
    }
  for (k = 0; k < 6; ++k) m->indices[m->indexCount++] = first + (uint32_t)("012023"[k] - '0');
  m->vertexCount += 4;
}

static void makeScene(Mesh meshes[MESHES]) {
  static const float emitter[4][3] = {
      {-0.333f, 2.739f, 0.263f}, {-0.333f, 2.739f, -0.262f}, {0.317f, 2.739f, -0.262f}, {0.317f, 2.739f, 0.263f}};
  int b, k;
  memset(meshes, 0, MESHES * sizeof(Mesh));
  for (b = 0; b < BOXES; ++b) {
    const Box* box = &kBoxes[b];
    float low[4][3], high[4][3];
    for (k = 0; k < 4; ++k) {
      low[k][0] = high[k][0] = box->corners[k][0];
      low[k][2] = high[k][2] = box->corners[k][1];
      low[k][1] = box->low, high[k][1] = box->high;
    }
    meshes[b].material = box->material;
    addQuad(&meshes[b], high[0], high[1], high[2], high[3]);
    addQuad(&meshes[b], low[3], low[2], low[1], low[0]);
    for (k = 0; k < 4; ++k) addQuad(&meshes[b], low[k], low[(k + 1) % 4], high[(k + 1) % 4], high[k]);
  }
  meshes[BOXES].material = 3;
  addQuad(&meshes[BOXES], emitter[0], emitter[1], emitter[2], emitter[3]);
}

/* ---- The host's renderer -------------------------------------------------------------------------------------------- */

static const char* kSurfaceVertex =
    "#version 450\n"
    "layout(location = 0) in vec3 position; layout(location = 1) in vec3 normal;\n"
    "layout(location = 0) uniform mat4 clip_from_view; layout(location = 1) uniform vec3 eye;\n"
    "out vec3 normal_view;\n"
    "void main() { normal_view = normal; gl_Position = clip_from_view * vec4(position - eye, 1.0); }\n";
static const char* kSurfaceFragment =
    "#version 450\n"
    "in vec3 normal_view;\n"
    "layout(location = 2) uniform vec3 albedo; layout(location = 3) uniform vec3 emission;\n"
    "layout(location = 0) out vec2 out_normal; layout(location = 1) out vec4 out_albedo;\n"
    "layout(location = 2) out vec4 out_emission;\n"
    "void main() {\n"
    "  vec3 n = normalize(normal_view);\n"
    "  n /= abs(n.x) + abs(n.y) + abs(n.z);\n"
    "  vec2 folded = (1.0 - abs(n.yx)) * vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);\n"
    "  out_normal = n.z >= 0.0 ? n.xy : folded;\n"
    "  out_albedo = vec4(albedo, 1.0);\n"
    "  out_emission = vec4(gl_FrontFacing ? emission : vec3(0.0), 1.0);\n"
    "}\n";
static const char* kImageVertex =
    "#version 450\n"
    "void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.5, 1.0); }\n";
static const char* kImageFragment =
    "#version 450\n"
    "layout(binding = 0) uniform sampler2D albedo; layout(binding = 1) uniform sampler2D emission;\n"
    "layout(binding = 2) uniform sampler2D indirect; layout(binding = 3) uniform sampler2D direct;\n"
    "out vec4 radiance;\n"
    "void main() {\n"
    "  ivec2 p = ivec2(gl_FragCoord.xy);\n"
    "  vec3 irradiance = texelFetch(indirect, p, 0).rgb + texelFetch(direct, p, 0).rgb;\n"
    "  radiance = vec4(texelFetch(emission, p, 0).rgb + texelFetch(albedo, p, 0).rgb / 3.14159265 * irradiance, 1.0);\n"
    "}\n";

static GLuint makeProgram(const char* vertex, const char* fragment) {
  const char* texts[2];
  GLuint program = glCreateProgram(), shader;
  GLint ok = 0, i;
  char log[1024] = "";
  texts[0] = vertex, texts[1] = fragment;
  for (i = 0; i < 2; ++i) {
    shader = glCreateShader(i == 0 ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER);
    glShaderSource(shader, 1, &texts[i], NULL);
    glCompileShader(shader);
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  glGetProgramiv(program, GL_LINK_STATUS, &ok);
  glGetProgramInfoLog(program, sizeof log, NULL, log);
  if (!ok) fail("program", log);
  return program;
}

static GLuint makeTexture(GLenum format) {
  GLuint texture;
  glCreateTextures(GL_TEXTURE_2D, 1, &texture);
  glTextureStorage2D(texture, 1, format, WIDTH, HEIGHT);
  return texture;
}

static void makeContext(void) {
  static const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
  EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
  EGLContext context;
  if (!eglInitialize(display, NULL, NULL)) fail("EGL", "no display");
  eglBindAPI(EGL_OPENGL_API);
  context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
  if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) fail("EGL", "no OpenGL 4.5 context");
}

typedef struct Renderer {
  GLuint surfaceProgram, imageProgram, vertexArray, emptyArray, surfaces, image;
  GLuint depth, normal, albedo, emission, radiance;
  GLint firstVertex[MESHES];
  GLuint firstIndex[MESHES];
} Renderer;

static void makeRenderer(Renderer* r, const Mesh meshes[MESHES]) {
  static const GLenum targets[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
  GLuint vertices, indices, vertexCount = 0, indexCount = 0;
  int i;
  r->surfaceProgram = makeProgram(kSurfaceVertex, kSurfaceFragment);
  r->imageProgram = makeProgram(kImageVertex, kImageFragment);
  glCreateBuffers(1, &vertices);
  glCreateBuffers(1, &indices);
  glNamedBufferData(vertices, MESHES * sizeof meshes[0].vertices, NULL, GL_STATIC_DRAW);
  glNamedBufferData(indices, MESHES * sizeof meshes[0].indices, NULL, GL_STATIC_DRAW);
  for (i = 0; i < MESHES; ++i) {
    const Mesh* m = &meshes[i];
    r->firstVertex[i] = (GLint)vertexCount;
    r->firstIndex[i] = indexCount;
    glNamedBufferSubData(vertices, vertexCount * sizeof(Vertex), m->vertexCount * sizeof(Vertex), m->vertices);
    glNamedBufferSubData(indices, indexCount * sizeof(uint32_t), m->indexCount * sizeof(uint32_t), m->indices);
    vertexCount += m->vertexCount;
    indexCount += m->indexCount;
  }
  glCreateVertexArrays(1, &r->vertexArray);
  glCreateVertexArrays(1, &r->emptyArray);
  glVertexArrayVertexBuffer(r->vertexArray, 0, vertices, 0, sizeof(Vertex));
  glVertexArrayElementBuffer(r->vertexArray, indices);
  for (i = 0; i < 2; ++i) {
    glEnableVertexArrayAttrib(r->vertexArray, (GLuint)i);
    glVertexArrayAttribFormat(r->vertexArray, (GLuint)i, 3, GL_FLOAT, GL_FALSE, (GLuint)(i * 12));
    glVertexArrayAttribBinding(r->vertexArray, (GLuint)i, 0);
  }
  r->depth = makeTexture(GL_DEPTH_COMPONENT24);
  r->normal = makeTexture(GL_RG16F);
  r->albedo = makeTexture(GL_RGBA16F);
  r->emission = makeTexture(GL_RGBA16F);
  r->radiance = makeTexture(GL_RGBA32F);
  glCreateFramebuffers(1, &r->surfaces);
  glNamedFramebufferTexture(r->surfaces, GL_DEPTH_ATTACHMENT, r->depth, 0);
  glNamedFramebufferTexture(r->surfaces, GL_COLOR_ATTACHMENT0, r->normal, 0);
  glNamedFramebufferTexture(r->surfaces, GL_COLOR_ATTACHMENT1, r->albedo, 0);
  glNamedFramebufferTexture(r->surfaces, GL_COLOR_ATTACHMENT2, r->emission, 0);
  glNamedFramebufferDrawBuffers(r->surfaces, 3, targets);
  glCreateFramebuffers(1, &r->image);
  glNamedFramebufferTexture(r->image, GL_COLOR_ATTACHMENT0, r->radiance, 0);
}

static void drawSurfaces(const Renderer* r, const Mesh meshes[MESHES]) {
  static const float zero[4] = {0, 0, 0, 0}, one = 1;
  const float focal = 1 / tanf(kFovY / 2), span = kFar - kNear;
  float clip_from_view[16] = {0};
  int i;
  clip_from_view[0] = focal * HEIGHT / WIDTH, clip_from_view[5] = focal;
  clip_from_view[10] = -(kFar + kNear) / span, clip_from_view[11] = -1, clip_from_view[14] = -2 * kFar * kNear / span;
  glBindFramebuffer(GL_FRAMEBUFFER, r->surfaces);
  glViewport(0, 0, WIDTH, HEIGHT);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  for (i = 0; i < 3; ++i) glClearBufferfv(GL_COLOR, i, zero);
  glClearBufferfv(GL_DEPTH, 0, &one);
  glUseProgram(r->surfaceProgram);
  glUniformMatrix4fv(0, 1, GL_FALSE, clip_from_view);
  glUniform3fv(1, 1, kEye);
  glBindVertexArray(r->vertexArray);
  for (i = 0; i < MESHES; ++i) {
    glUniform3fv(2, 1, kMaterials[meshes[i].material].albedo);
    glUniform3fv(3, 1, kMaterials[meshes[i].material].emission);
    glDrawElementsBaseVertex(GL_TRIANGLES, (GLsizei)meshes[i].indexCount, GL_UNSIGNED_INT,
                             (const void*)(r->firstIndex[i] * sizeof(uint32_t)), r->firstVertex[i]);
  }
}

static void compose(const Renderer* r, GLuint indirect, GLuint direct) {
  glBindFramebuffer(GL_FRAMEBUFFER, r->image);
  glViewport(0, 0, WIDTH, HEIGHT);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(r->imageProgram);
  glBindTextureUnit(0, r->albedo);
  glBindTextureUnit(1, r->emission);
  glBindTextureUnit(2, indirect);
  glBindTextureUnit(3, direct);
  glBindVertexArray(r->emptyArray);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

/* ---- Lambent -------------------------------------------------------------------------------------------------------- */

static lambent_device* device;
static void check(lambent_status status) {
  if (status != LAMBENT_OK) fail(lambent_status_text(status), lambent_message(device));
}
static void say(void* user, lambent_level level, const char* line) {
  (void)user;
  if (level != LAMBENT_LOG_INFO) fprintf(stderr, "lambent: %s\n", line);
}

/* Tells the scene once. Strided vertices are copied into plain arrays: these are what the library takes. */
static lambent_scene tellScene(const Mesh meshes[MESHES]) {
  static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  lambent_material materials[4];
  lambent_scene scene;
  int i;
  uint32_t k;
  check(lambent_scene_create(device, &scene));
  for (i = 0; i < 4; ++i) {
    lambent_material_desc desc;
    LAMBENT_DEFAULTS(LAMBENT_MATERIAL_DESC, &desc);
    memcpy(desc.base_color, kMaterials[i].albedo, sizeof desc.base_color);
    memcpy(desc.emission, kMaterials[i].emission, sizeof desc.emission);
    check(lambent_material_create(device, scene, &desc, &materials[i]));
  }
  for (i = 0; i < MESHES; ++i) {
    float positions[BOX_VERTICES * 3], normals[BOX_VERTICES * 3];
    lambent_mesh_desc desc;
    lambent_mesh mesh;
    lambent_instance instance;
    for (k = 0; k < meshes[i].vertexCount; ++k) {
      memcpy(positions + 3 * k, meshes[i].vertices[k].position, 12);
      memcpy(normals + 3 * k, meshes[i].vertices[k].normal, 12);
    }
    LAMBENT_DEFAULTS(LAMBENT_MESH_DESC, &desc);
    desc.vertex_count = meshes[i].vertexCount;
    desc.triangle_count = meshes[i].indexCount / 3;
    desc.positions = positions;
    desc.normals = normals;
    desc.indices = meshes[i].indices;
    desc.material = materials[meshes[i].material];
    check(lambent_mesh_create(device, scene, &desc, &mesh));
    check(lambent_instance_create(device, scene, mesh, identity, &instance));
  }
  return scene;
}

/* ---- Images --------------------------------------------------------------------------------------------------------- */

static void put32(uint8_t* at, uint32_t v) { at[0] = (uint8_t)(v >> 24), at[1] = (uint8_t)(v >> 16), at[2] = (uint8_t)(v >> 8), at[3] = (uint8_t)v; }
static void writeChunk(FILE* file, const char* type, const uint8_t* data, uint32_t size) {
  uint32_t crc = 0xffffffffu, i, byte, bit;
  uint8_t number[4];
  put32(number, size);
  fwrite(number, 1, 4, file);
  fwrite(type, 1, 4, file);
  fwrite(data, 1, size, file);
  for (i = 0; i < size + 4; ++i) {
    byte = i < 4 ? (uint8_t)type[i] : data[i - 4];
    crc ^= byte;
    for (bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  put32(number, ~crc);
  fwrite(number, 1, 4, file);
}

/* Without compression: rows are stored as blocks of their own. `rgba` begins with the lowest row. */
static void writePng(const char* name, const float* rgba) {
  enum { ROW = 1 + 3 * WIDTH };
  static uint8_t data[2 + HEIGHT * (5 + ROW) + 4];
  uint8_t header[13] = {0, 0, 0, 0, 0, 0, 0, 0, 8, 2, 0, 0, 0}, *at = data;
  uint32_t a = 1, b = 0;
  int x, y, c, i;
  FILE* file = fopen(name, "wb");
  if (!file) fail(name, "cannot be written");
  put32(header, WIDTH);
  put32(header + 4, HEIGHT);
  *at++ = 0x78, *at++ = 0x01;
  for (y = HEIGHT - 1; y >= 0; --y) {
    uint8_t* row = at + 5;
    at[0] = y == 0, at[1] = ROW & 255, at[2] = ROW >> 8, at[3] = (uint8_t)~at[1], at[4] = (uint8_t)~at[2];
    row[0] = 0;
    for (x = 0; x < WIDTH; ++x)
      for (c = 0; c < 3; ++c) {
        float v = rgba[4 * (y * WIDTH + x) + c];
        v = v < 0 ? 0 : v > 1 ? 1 : v;
        v = v <= 0.0031308f ? 12.92f * v : 1.055f * powf(v, 1 / 2.4f) - 0.055f;
        row[1 + 3 * x + c] = (uint8_t)(255 * v + 0.5f);
      }
    for (i = 0; i < ROW; ++i) a = (a + row[i]) % 65521, b = (b + a) % 65521;
    at += 5 + ROW;
  }
  put32(at, b << 16 | a);
  fwrite("\x89PNG\r\n\x1a\n", 1, 8, file);
  writeChunk(file, "IHDR", header, sizeof header);
  writeChunk(file, "IDAT", data, (uint32_t)sizeof data);
  writeChunk(file, "IEND", NULL, 0);
  if (fclose(file) != 0) fail(name, "cannot be written");
}

static void writePfm(const char* name, const float* rgba) {
  int i;
  FILE* file = fopen(name, "wb");
  if (!file) fail(name, "cannot be written");
  fprintf(file, "PF\n%d %d\n-1\n", WIDTH, HEIGHT);
  for (i = 0; i < WIDTH * HEIGHT; ++i) fwrite(rgba + 4 * i, sizeof(float), 3, file);
  if (fclose(file) != 0) fail(name, "cannot be written");
}

/* ---- All together --------------------------------------------------------------------------------------------------- */

int main(int argc, char** argv) {
  static Mesh meshes[MESHES];
  static float rgba[4 * WIDTH * HEIGHT];
  Renderer renderer;
  lambent_device_desc desc;
  lambent_view_desc viewDesc;
  lambent_light_desc lamp;
  lambent_light light;
  lambent_scene scene;
  lambent_view view;
  double total = 0;
  int frame;
  if (argc < 2) fail("usage", "minimal OUT.png [OUT.pfm]");
  makeContext();
  makeScene(meshes);
  makeRenderer(&renderer, meshes);

  LAMBENT_DEFAULTS(LAMBENT_DEVICE_DESC, &desc);
  desc.log = say;
  check(lambent_create(&desc, &device));
  scene = tellScene(meshes);
  LAMBENT_DEFAULTS(LAMBENT_LIGHT_DESC, &lamp);
  check(lambent_light_create(device, scene, &lamp, &light));
  LAMBENT_DEFAULTS(LAMBENT_VIEW_DESC, &viewDesc);
  viewDesc.width = WIDTH;
  viewDesc.height = HEIGHT;
  check(lambent_view_create(device, scene, &viewDesc, &view));

  for (frame = 0; frame < MOVING + STANDING; ++frame) {
    const float t = frame < MOVING ? (float)frame / MOVING : 1; /* along a quarter of a circle */
    lambent_frame given;
    lambent_output light_on_surfaces;
    lamp.position[0] = 0.8f * sinf(1.5f * t), lamp.position[1] = 1.9f, lamp.position[2] = 0.9f * cosf(1.5f * t);
    check(lambent_light_set(device, scene, light, &lamp));
    drawSurfaces(&renderer, meshes);

    LAMBENT_DEFAULTS(LAMBENT_FRAME, &given);
    memcpy(given.world_from_view + 12, kEye, sizeof kEye); /* it looks along -Z: no rotation */
    given.fov_y = kFovY;
    given.near_plane = kNear;
    given.far_plane = kFar;
    given.depth = renderer.depth;
    given.depth_type = LAMBENT_DEPTH_FORWARD;
    given.normal = renderer.normal;
    given.normal_type = LAMBENT_NORMALS_OCTAHEDRAL;
    given.normal_space = LAMBENT_SPACE_VIEW;
    given.emission = renderer.emission;
    LAMBENT_DEFAULTS(LAMBENT_OUTPUT, &light_on_surfaces);
    check(lambent_render(device, view, &given, &light_on_surfaces));
    if (frame > 0) total += light_on_surfaces.milliseconds;
    compose(&renderer, light_on_surfaces.indirect, light_on_surfaces.direct);
  }
  glGetTextureImage(renderer.radiance, 0, GL_RGBA, GL_FLOAT, sizeof rgba, rgba);
  writePng(argv[1], rgba);
  if (argc > 2) writePfm(argv[2], rgba);
  printf("%s: %d frames, %.1f ms of light each, lamp at %.6f,%.6f,%.6f\n", argv[1], frame, total / (frame - 1),
         lamp.position[0], lamp.position[1], lamp.position[2]);
  lambent_destroy(device);
  return 0;
}
