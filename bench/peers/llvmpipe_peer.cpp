// Mesa's llvmpipe and this rasterizer on the same scenes, cameras and sizes, frames interleaved in one run. CPU time of
// the process, the smallest of many frames. A frame is clear, draw and finish into an off-screen buffer, without
// reading back.
//
//   build/release/bench/peers/llvmpipe_peer [threads [part of a row's name]]        (Debian: libosmesa6-dev)
//
// More than one thread: wall times of both, and ours with one thread in the same run. Phong rows: the peer runs a
// shader of the same lighting formula in each pixel. Sweep rows: a sheet of right triangles with legs of so many pixels
// that covers the image.
//
// Supersampling in GL is a rendering at 4 times the width and height without the box filter, which favors the peer.
// MSAA is its 4 samples a pixel, the most it has, with the resolve.
#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>
// After it:
#include <GL/glext.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "bench/peers/llvmpipe_phong.h"
#include "raster/renderer.h"
#include "raster/triangulate.h"
#include "tests/support/raster_scenes.h"

namespace {

using namespace pac;
using namespace pac::raster;

struct Timing {
  double cpu_ms = 1e9, wall_ms = 1e9;
};

template <class Frame>
void time_frame(Timing& best, Frame&& frame) {
  const auto wall = std::chrono::steady_clock::now();
  const clock_t cpu = clock();
  frame();
  best.cpu_ms = std::min(best.cpu_ms, 1e3 * static_cast<double>(clock() - cpu) / CLOCKS_PER_SEC);
  best.wall_ms = std::min(best.wall_ms,
                          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - wall).count());
}

// A scene in GL buffers: one index range a material.
class GlScene {
 public:
  GlScene(const Scene& scene, const Camera& camera, bool textured, bool lit, bool phong)
      : textured_(textured), lit_(lit), program_(phong ? llvmpipe::make_phong_program(scene, camera) : 0) {
    std::copy_n(&camera.clip_from_world[0][0], 16, matrix_);
    std::copy_n(&camera.eye[0], 3, eye_);
    std::vector<std::vector<uint32_t>> by_material(scene.materials.size());
    PolygonCutter cutter;
    for (const Face& face : scene.mesh.faces)
      for (const CornerTriple& t : cutter.cut(scene.mesh, face))
        for (const uint32_t corner : t.corner)
          by_material[face.material].push_back(scene.mesh.indices[face.first + corner]);
    std::vector<uint32_t> indices;
    for (const auto& part : by_material) {
      ranges_.push_back({indices.size(), part.size()});
      indices.insert(indices.end(), part.begin(), part.end());
    }
    GLuint buffers[2];
    glGenBuffers(2, buffers);
    glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(scene.mesh.vertices.size() * sizeof(Vertex)),
                 scene.mesh.vertices.data(), GL_STATIC_DRAW);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * 4), indices.data(), GL_STATIC_DRAW);
    vertices_ = buffers[0];
    indices_ = buffers[1];
    for (const Material& m : scene.materials) textures_.push_back(m.texture >= 0 ? upload(scene, m) : 0);
    if (lit && !phong) set_lights(scene);
  }

  void draw() const {
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glUseProgram(program_);
    glMatrixMode(GL_PROJECTION);
    glLoadMatrixf(matrix_);
    glMatrixMode(GL_MODELVIEW);
    glLoadIdentity();
    glBindBuffer(GL_ARRAY_BUFFER, vertices_);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
    glEnableClientState(GL_VERTEX_ARRAY);
    glEnableClientState(GL_COLOR_ARRAY);
    const auto at = [](size_t offset) { return reinterpret_cast<const void*>(offset); };
    glVertexPointer(3, GL_FLOAT, sizeof(Vertex), at(offsetof(Vertex, position)));
    glColorPointer(4, GL_UNSIGNED_BYTE, sizeof(Vertex), at(offsetof(Vertex, color)));
    if (textured_) {
      glEnable(GL_TEXTURE_2D);
      glEnableClientState(GL_TEXTURE_COORD_ARRAY);
      glTexCoordPointer(2, GL_FLOAT, sizeof(Vertex), at(offsetof(Vertex, texcoord)));
    } else {
      glDisable(GL_TEXTURE_2D);
      glDisableClientState(GL_TEXTURE_COORD_ARRAY);
    }
    if (lit_) {
      glEnable(GL_LIGHTING);
      glEnable(GL_CULL_FACE);
      glEnableClientState(GL_NORMAL_ARRAY);
      glNormalPointer(GL_FLOAT, sizeof(Vertex), at(offsetof(Vertex, normal)));
    } else {
      glDisable(GL_LIGHTING);
      glDisable(GL_CULL_FACE);
      glDisableClientState(GL_NORMAL_ARRAY);
    }
    for (size_t i = 0; i < ranges_.size(); ++i) {
      if (ranges_[i].second == 0) continue;
      if (textured_) glBindTexture(GL_TEXTURE_2D, textures_[i]);
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(ranges_[i].second), GL_UNSIGNED_INT, at(4 * ranges_[i].first));
    }
    glFinish();
  }

 private:
  static GLuint upload(const Scene& scene, const Material& m) {
    const Texture& texture = scene.textures[static_cast<size_t>(m.texture)];
    GLuint name;
    glGenTextures(1, &name);
    glBindTexture(GL_TEXTURE_2D, name);
    for (size_t i = 0; i < texture.levels.size(); ++i) {
      const ConstRgbaView level = texture.level(i);
      glPixelStorei(GL_UNPACK_ROW_LENGTH, static_cast<GLint>(level.stride / 4));
      glTexImage2D(GL_TEXTURE_2D, static_cast<GLint>(i), GL_RGBA8, level.width, level.height, 0, GL_RGBA,
                   GL_UNSIGNED_BYTE, level.data);
    }
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    return name;
  }
  void set_lights(const Scene& scene) {
    glMatrixMode(GL_MODELVIEW);
    glLoadIdentity();
    const Material& m = scene.materials[0];
    const GLfloat specular[4] = {m.specular.x, m.specular.y, m.specular.z, 1}, zero[4] = {0, 0, 0, 1};
    glMaterialfv(GL_FRONT, GL_SPECULAR, specular);
    glMaterialf(GL_FRONT, GL_SHININESS, static_cast<GLfloat>(m.shininess));
    glColorMaterial(GL_FRONT, GL_AMBIENT_AND_DIFFUSE);
    glEnable(GL_COLOR_MATERIAL);
    for (size_t i = 0; i < scene.lights.size(); ++i) {
      const Light& light = scene.lights[i];
      const auto number = static_cast<GLenum>(GL_LIGHT0 + i);
      const bool point = light.kind == Light::Kind::point;
      const glm::vec3 v = point ? light.position : -light.direction;
      const GLfloat where[4] = {v.x, v.y, v.z, point ? 1.0f : 0.0f};
      const GLfloat color[4] = {light.color.x, light.color.y, light.color.z, 1};
      glLightfv(number, GL_POSITION, where);
      glLightfv(number, GL_DIFFUSE, color);
      glLightfv(number, GL_SPECULAR, color);
      glLightfv(number, GL_AMBIENT, zero);
      glEnable(number);
    }
  }

  bool textured_, lit_;
  GLuint program_;  // 0: fixed function
  GLfloat matrix_[16], eye_[3];
  GLuint vertices_ = 0, indices_ = 0;
  std::vector<std::pair<size_t, size_t>> ranges_;
  std::vector<GLuint> textures_;
};

// Its number; samples 0: without multisampling.
GLuint bind_framebuffer(int width, int height, int samples) {
  GLuint buffers[2], frame;
  glGenRenderbuffers(2, buffers);
  glGenFramebuffers(1, &frame);
  glBindFramebuffer(GL_FRAMEBUFFER, frame);
  const GLenum formats[2] = {GL_RGBA8, GL_DEPTH_COMPONENT24}, places[2] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
  for (int i = 0; i < 2; ++i) {
    glBindRenderbuffer(GL_RENDERBUFFER, buffers[i]);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, formats[i], width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, places[i], GL_RENDERBUFFER, buffers[i]);
  }
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) std::puts("framebuffer incomplete");
  glViewport(0, 0, width, height);
  glEnable(GL_DEPTH_TEST);
  return frame;
}

// What the peer does for a row, and what we do.
enum class Kind : uint8_t {
  plain,         // one sample a pixel, both
  depth,         // the same without color
  supersampled,  // 4x4, both
  shaded_once,   // 4x4 against our 16 samples shaded once a pixel
  multisampled,  // 4x MSAA against the same
};

struct Row {
  const char* name;
  const char* scene;
  bool texture;
  Kind kind;
  int width, height;
  bool phong = false;
  int leg = 0;  // of the scene "sheet", pixels
};

// Right triangles with legs of `leg` pixels all over the image, in clip space; smooth colors that are final.
Scene sheet(int width, int height, int leg) {
  Scene scene;
  scene.materials.emplace_back();
  scene.materials[0].lit = false;
  Mesh& mesh = scene.mesh;
  const int columns = (width + leg - 1) / leg, rows = (height + leg - 1) / leg;
  for (int y = 0; y <= rows; ++y)
    for (int x = 0; x <= columns; ++x) {
      Vertex v;
      v.position[0] = 2.0f * static_cast<float>(x * leg) / static_cast<float>(width) - 1.0f;
      v.position[1] = 1.0f - 2.0f * static_cast<float>(y * leg) / static_cast<float>(height);
      for (int c = 0; c < 3; ++c) v.color[c] = static_cast<uint8_t>((x * (17 + c) + y * (29 - c)) % 256);
      mesh.vertices.push_back(v);
    }
  const auto add = [&](int a, int b, int c) {
    mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), 3, 0});
    for (const int corner : {a, b, c}) mesh.indices.push_back(static_cast<uint32_t>(corner));
  };
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const int top = y * (columns + 1) + x, below = top + columns + 1;
      add(top, below, top + 1);
      add(top + 1, below, below + 1);
    }
  return scene;
}

struct View {
  Scene scene;
  Camera camera;
};
View make_view(const Row& row) {
  const std::string name = row.scene;
  const float aspect = static_cast<float>(row.width) / static_cast<float>(row.height);
  if (name == "room") return {test_scenes::room(), test_scenes::room_camera(aspect)};
  if (name == "sheet") return {sheet(row.width, row.height, row.leg), Camera{}};
  return {name == "pin" ? test_scenes::bumpy_pin(194, 194) : test_scenes::bumpy_pin(39, 39),
          test_scenes::pin_camera(aspect)};
}

RenderQuality quality_of(const Row& row) {
  RenderQuality quality;
  quality.texture = row.texture;
  if (row.phong) quality.shading = Shading::phong;
  if (row.kind == Kind::supersampled || row.kind == Kind::shaded_once || row.kind == Kind::multisampled)
    quality.samples = 16;
  if (row.kind == Kind::shaded_once || row.kind == Kind::multisampled) quality.shading_samples = 1;
  quality.cull_back_faces = true;
  return quality;
}

// Draws and finishes; MSAA is resolved.
class GlFrame {
 public:
  GlFrame(const Row& row) : row_(row) {
    const int scale = row.kind == Kind::supersampled || row.kind == Kind::shaded_once ? 4 : 1;
    if (row.kind == Kind::multisampled) resolved_ = bind_framebuffer(row.width, row.height, 0);
    drawn_ = bind_framebuffer(scale * row.width, scale * row.height, row.kind == Kind::multisampled ? 4 : 0);
    const GLboolean color = row.kind != Kind::depth;
    glColorMask(color, color, color, color);
  }
  void draw(const GlScene& scene) const {
    glBindFramebuffer(GL_FRAMEBUFFER, drawn_);
    scene.draw();
    if (row_.kind != Kind::multisampled) return;
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
    glBlitFramebuffer(0, 0, row_.width, row_.height, 0, 0, row_.width, row_.height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glFinish();
  }

 private:
  const Row& row_;
  GLuint drawn_ = 0, resolved_ = 0;
};

void compare(const Row& row, int threads) {
  const View view = make_view(row);
  RendererOptions options;
  options.threads = threads;
  auto renderer = Renderer::create(row.width, row.height, options);
  options.threads = 1;
  auto alone = Renderer::create(row.width, row.height, options);
  const RenderQuality quality = quality_of(row);
  RgbImage image(row.width, row.height);
  RenderTargets targets;
  DepthImage depth(row.width, row.height);
  if (row.kind == Kind::depth)
    targets.depth = depth.view();
  else
    targets.color = image.view();
  const GlFrame frame(row);
  const GlScene gl(view.scene, view.camera, row.texture, view.scene.materials[0].lit, row.phong);
  Timing peer, ours, single;
  for (int i = 0; i < 2; ++i) frame.draw(gl);
  const clock_t start = clock();
  for (int i = 0; i < 8 || (i < 60 && clock() - start < CLOCKS_PER_SEC); ++i) {
    time_frame(peer, [&] { frame.draw(gl); });
    time_frame(ours, [&] { (void)renderer->render(view.scene, view.camera, quality, targets); });
    if (threads > 1) time_frame(single, [&] { (void)alone->render(view.scene, view.camera, quality, targets); });
  }
  std::printf("%-32s %9.2f %9.2f %8.2fx %11.2f %9.2f", row.name, peer.cpu_ms, ours.cpu_ms, ours.cpu_ms / peer.cpu_ms,
              peer.wall_ms, ours.wall_ms);
  if (threads > 1) std::printf(" %8.2fx, alone %.2f", single.wall_ms / ours.wall_ms, single.wall_ms);
  if (row.leg > 0) {
    const auto n = static_cast<double>(view.scene.mesh.faces.size());
    std::printf("   %.1f / %.1f Mtri/s", n / peer.cpu_ms / 1e3, n / ours.cpu_ms / 1e3);
  }
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int threads = argc > 1 ? std::atoi(argv[1]) : 1;
  setenv("LP_NUM_THREADS", threads > 1 ? std::to_string(threads).c_str() : "0", 1);
  const OSMesaContext context = OSMesaCreateContextExt(OSMESA_RGBA, 24, 0, 0, nullptr);
  std::vector<uint8_t> dummy(64 * 64 * 4);
  if (context == nullptr || !OSMesaMakeCurrent(context, dummy.data(), GL_UNSIGNED_BYTE, 64, 64)) {
    std::puts("no OSMesa context");
    return 1;
  }
  std::printf("%s, %d thread(s)\n", reinterpret_cast<const char*>(glGetString(GL_RENDERER)), threads);
  std::printf("%-32s %9s %9s %9s %11s %9s\n", "", "peer cpu", "ours cpu", "ratio", "peer wall", "ours wall");
  const Row rows[] = {
      {"room depth 512", "room", false, Kind::depth, 512, 512},
      {"room Gouraud 512", "room", false, Kind::plain, 512, 512},
      {"room trilinear 512", "room", true, Kind::plain, 512, 512},
      {"room Gouraud 4x4 512", "room", false, Kind::supersampled, 512, 512},
      {"room trilinear 4x4 512", "room", true, Kind::supersampled, 512, 512},
      {"room Gouraud once/4x4 512", "room", false, Kind::shaded_once, 512, 512},
      {"room Gouraud once/MSAA4 512", "room", false, Kind::multisampled, 512, 512},
      {"room trilinear once/4x4 512", "room", true, Kind::shaded_once, 512, 512},
      {"room trilinear once/MSAA4 512", "room", true, Kind::multisampled, 512, 512},
      {"pin 75k depth 512", "pin", false, Kind::depth, 512, 512},
      {"pin 75k Gouraud 512", "pin", false, Kind::plain, 512, 512},
      {"pin 75k Gouraud 4x4 512", "pin", false, Kind::supersampled, 512, 512},
      {"pin 75k Gouraud once/4x4 512", "pin", false, Kind::shaded_once, 512, 512},
      {"pin 75k Gouraud once/MSAA4 512", "pin", false, Kind::multisampled, 512, 512},
      {"pin 75k Phong 512", "pin", false, Kind::plain, 512, 512, true},
      {"pin 3k Phong 512", "pin3k", false, Kind::plain, 512, 512, true},
      {"pin 3k Gouraud 512", "pin3k", false, Kind::plain, 512, 512},
      {"pin 3k Gouraud once/4x4 512", "pin3k", false, Kind::shaded_once, 512, 512},
      {"pin 3k Gouraud once/MSAA4 512", "pin3k", false, Kind::multisampled, 512, 512},
      {"room Gouraud 1080", "room", false, Kind::plain, 1920, 1080},
      {"room trilinear 1080", "room", true, Kind::plain, 1920, 1080},
      {"room Gouraud once/4x4 1080", "room", false, Kind::shaded_once, 1920, 1080},
      {"room trilinear once/4x4 1080", "room", true, Kind::shaded_once, 1920, 1080},
      {"pin 75k Gouraud 1080", "pin", false, Kind::plain, 1920, 1080},
      {"pin 75k Phong 1080", "pin", false, Kind::plain, 1920, 1080, true},
      {"sweep 1 px 512", "sheet", false, Kind::plain, 512, 512, false, 1},
      {"sweep 2 px 512", "sheet", false, Kind::plain, 512, 512, false, 2},
      {"sweep 4 px 512", "sheet", false, Kind::plain, 512, 512, false, 4},
      {"sweep 8 px 512", "sheet", false, Kind::plain, 512, 512, false, 8},
      {"sweep 16 px 512", "sheet", false, Kind::plain, 512, 512, false, 16},
      {"sweep 64 px 512", "sheet", false, Kind::plain, 512, 512, false, 64},
      {"sweep 256 px 512", "sheet", false, Kind::plain, 512, 512, false, 256},
  };
  const char* filter = argc > 2 ? argv[2] : "";
  for (const Row& row : rows)
    if (std::string(row.name).find(filter) != std::string::npos) compare(row, threads);
  OSMesaDestroyContext(context);
}
